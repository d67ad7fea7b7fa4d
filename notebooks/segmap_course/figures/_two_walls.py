"""Two walls whose ends are dragged, and the measure D between them."""

from __future__ import annotations

import numpy as np
import traitlets
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.arrays import Array
from segmap.metrics import distance_terms, segment_distance
from segmap.plotting import MAP, RESULT, draw_segments, map_axes

from ._drag_figure import DragFigure, module_text

#: Of a view, around both walls, metres.
_MARGIN_M = 0.6


class DragWalls(DragFigure):
    """Two walls, `(2, 2)` each, metres; `ends` holds the four ends of both.

    Examples
    --------
    >>> figure = DragWalls([(0, 0), (2, 0)], [(0, 0.5), (2, 0.5)])
    >>> figure
    DragWalls(turned 0.00 m, shifted 0.25 m, apart 0.50 m: D = 0.147 m)
    >>> figure.ends = [[0, 0], [2, 0], [2, 0], [3, 0]]
    >>> figure.distance
    0.0
    """

    module = "two_walls"
    _esm = module_text(module)
    ends = traitlets.List(traitlets.List(traitlets.Float())).tag(sync=True)
    #: Left, low, right and top of what is seen, metres.
    view = traitlets.List(traitlets.Float()).tag(sync=True)

    def __init__(self, u: ArrayLike, v: ArrayLike) -> None:
        ends = arrays.segments(np.array([u, v], float), "u and v").reshape(4, 2)
        view = np.concatenate([ends.min(0) - _MARGIN_M, ends.max(0) + _MARGIN_M])
        super().__init__(ends=ends.round(4).tolist(), view=view.round(1).tolist())

    def walls(self) -> Array:
        """Both walls, `(2, 2, 2)`, metres."""
        return np.reshape(np.array(self.ends, float), (2, 2, 2))

    def terms(self) -> dict[str, float]:
        """The three terms by their names, metres, not weighted."""
        values = map(float, distance_terms(*self.walls()))
        return dict(zip(("turned", "shifted", "apart"), values, strict=True))

    @property
    def distance(self) -> float:
        """D of both walls, metres."""
        return float(segment_distance(*self.walls()))

    def __repr__(self) -> str:
        terms = ", ".join(f"{name} {metres:.2f} m" for name, metres in self.terms().items())
        return f"DragWalls({terms}: D = {self.distance:.3f} m)"

    def draw(self, ax: Axes) -> None:
        """Draw both walls with their ends; the three terms and D are the title."""
        for wall, color in zip(self.walls(), (MAP, RESULT), strict=True):
            draw_segments([wall], ax=ax, color=color, width=2.5)
            ax.plot(*wall.T, "o", color=color, markerfacecolor="white", markersize=9)
        x_min, y_min, x_max, y_max = self.view
        title = repr(self)[len("DragWalls(") : -1]
        map_axes(ax).set(xlim=(x_min, x_max), ylim=(y_min, y_max), title=title)
