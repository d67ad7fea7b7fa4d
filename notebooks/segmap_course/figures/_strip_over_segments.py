"""The strip of Fusion over a few segments, and the chain that it holds (A 4.4.1 to 4.4.4)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import traitlets
from matplotlib.axes import Axes

from segmap import arrays
from segmap.arrays import Array, Metres, Segments, checked
from segmap.plotting import RESULT
from segmap.segments import length

from ..drawings import draw_strip
from ..literal import best_strip, chain, in_strip
from ..literal.lines import SAME
from ._drag_figure import DragFigure, module_text

#: Of a view, around all segments, metres.
_MARGIN_M = (0.3, 0.03)


class Chain(NamedTuple):
    """What a strip holds: its segments, those of the chain, and their total length in metres."""

    inside: list[int]
    members: list[int]
    total: float
    #: The segment that takes their place, `(2, 2)`, metres.
    wall: Array
    #: The greatest total of all shifts, metres.
    most: float


class DragStrip(DragFigure):
    """Segments `(n, 2, 2)` along x, and a strip of Fusion parallel to the longest of them.

    `shift` is how far the middle of the strip lies from the longest, at most the `tolerance`, which
    is half its width. Both are dragged, and each segment is. Across, all is drawn ten times larger.

    Examples
    --------
    >>> figure = DragStrip([[(0, 0), (3, 0)], [(1, 0.05), (2, 0.05)]])
    >>> figure
    DragStrip(chain of 1 of 2 segments, 3.00 m; at the best shift 4.00 m)
    >>> figure.shift = 0.01
    >>> figure.measure().members
    [0, 1]
    """

    module = "strip_over_segments"
    _esm = module_text(module)
    #: x and y of both ends of each segment, metres.
    segments = traitlets.List(traitlets.List(traitlets.Float())).tag(sync=True)
    shift = traitlets.Float(0.0).tag(sync=True)
    tolerance = traitlets.Float().tag(sync=True)
    #: Left, low, right and top of what is seen, metres.
    view = traitlets.List(traitlets.Float()).tag(sync=True)

    @checked
    def __init__(self, segments: Segments, *, shift: float = 0.0, tolerance: Metres = 0.04) -> None:
        ends = np.round(arrays.segments(segments), 4)
        margin = np.array(_MARGIN_M) + (0, tolerance)
        view = np.concatenate([ends.min((0, 1)) - margin, ends.max((0, 1)) + margin])
        super().__init__(
            segments=ends.reshape(-1, 4).tolist(),
            shift=shift,
            tolerance=tolerance,
            view=np.round(view, 2).tolist(),
        )

    def measure(self) -> Chain:
        """What the strip holds, and what Fusion makes of it."""
        segments = np.reshape(self.segments, (-1, 2, 2))
        lengths = length(segments).tolist()
        first = int(np.argmax(np.array(lengths) >= max(lengths) - SAME))
        middle, ahead = segments[first].mean(axis=0), np.diff(segments[first], axis=0)[0]
        axes = np.array([ahead, (-ahead[1], ahead[0])]).T / lengths[first]  # along, across
        u, v = np.moveaxis((segments - middle) @ axes, -1, 0).tolist()
        inside = in_strip(v, self.shift, self.tolerance)
        members = chain(u, inside, first)
        best, _ = best_strip(u, v, lengths, first, self.tolerance)
        ends = [w for k in members for w in u[k]]
        wall = middle + np.array([(min(ends), self.shift), (max(ends), self.shift)]) @ axes.T
        total, most = (sum(lengths[k] for k in rows) for rows in (members, best))
        return Chain(inside, members, total, wall, most)

    def __repr__(self) -> str:
        now = self.measure()
        return (
            f"DragStrip(chain of {len(now.members)} of {len(self.segments)} segments, "
            f"{now.total:.2f} m; at the best shift {now.most:.2f} m)"
        )

    def draw(self, ax: Axes) -> None:
        """Draw the strip with its dot, the segments of the chain, black, and others, orange."""
        segments = np.reshape(self.segments, (-1, 2, 2))
        draw_strip(segments, self.shift, self.tolerance, chain=self.measure().members, ax=ax)
        x_min, y_min, x_max, y_max = self.view
        ax.plot(x_min + 0.03 * (x_max - x_min), self.shift, "o", color=RESULT, markersize=9)
        ax.set(xlim=(x_min, x_max), ylim=(y_min, y_max), title=repr(self)[len("DragStrip(") : -1])
