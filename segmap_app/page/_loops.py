"""The loops of a run: seen, left out where they are false, and forced where one is missing."""

from __future__ import annotations

import base64
from collections.abc import Callable, Sequence
from typing import Any

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure

from segmap.arrays import Array
from segmap.panels.controls import folded
from segmap.plotting import DPI, ERROR, MAP, draw_points, figure_png, map_axes
from segmap.poses import transform

from ..pipeline import Pipeline
from ._choices import WRAP
from ._edits import Edits
from ._shown import LINES

#: Pixels of the longer side of the picture of two scans.
PAIR_SIDE_PIXELS = 360
#: Pixels of the numbers beside and below it.
AXIS_ROOM_PIXELS = (40, 30)
#: What lies within this of a scan is drawn, metres.
NEAR = 15.0
#: Rows that are seen of the list.
ROWS = 6
LISTED = (
    "Places that were found again, the worst match first: by how many standard deviations the map "
    "contradicts it, and how long the way round is. A false one bends the map."
)
MISSING = "One is missing? Click two places of the way on the map, or write their scans:"


class Loops:
    """A list of the loops, the worst first, and two scans that are looked at, or tied.

    `look` is called with the way that was driven and the scans that are looked at, or with none;
    `changed` where a loop was left out or forced. `listed` names loops as `FIRST-SECOND`.
    """

    def __init__(
        self,
        edits: Edits,
        look: Callable[[Array, Sequence[int]], None],
        changed: Callable[[], None],
    ) -> None:
        self._edits, self._look, self._changed = edits, look, changed
        self._outcome: Pipeline | None = None
        auto: Any = {"layout": W.Layout(width="auto"), "style": {"description_width": "initial"}}
        self.listed: Any = W.Select(description="loops", rows=ROWS, **auto)
        self.mend: Any = W.Button(layout=W.Layout(width="auto", align_self="flex-start"))
        number: Any = {"style": {"description_width": "40px"}, "layout": W.Layout(width="130px")}
        self.first, self.second = (
            W.BoundedIntText(description=word, **number) for word in ("scan", "and")
        )
        self.tie: Any = W.Button(description="Close a loop here", layout=W.Layout(width="auto"))
        self.picture: Any = W.HTML()
        hint = W.HTML(f"{LINES}{MISSING}</div>")
        pair = W.Box([self.first, self.second, self.tie], layout=W.Layout(**WRAP))
        parts = [W.HTML(f"{LINES}{LISTED}</div>"), self.listed, self.mend, hint, pair]
        column = W.VBox(parts, layout=W.Layout(flex="1 1 300px", min_width="0"))
        self.box = W.Box([column, self.picture], layout=W.Layout(flex_flow="row wrap"))
        self.open = folded("loops", self.box)
        self.open.layout.display = "none"
        for each in (self.open, self.listed):
            each.observe(self._chosen, names="value")
        for each in (self.first, self.second):
            each.observe(self._seen, names="value")
        self.mend.on_click(self._mend)
        self.tie.on_click(self._tie)

    def show(self, outcome: Pipeline) -> None:
        """List the loops of another run; there is nothing to see where its method has no graph."""
        self._outcome = None  # nothing is drawn until all is listed
        if outcome.alignment.graph is None:
            self.open.value = False
        self.open.layout.display = "none" if outcome.alignment.graph is None else ""
        table = outcome.alignment.loops().sort_values("residual", ascending=False)
        edits, options = self._edits, [(f"{loop}: left out", loop) for loop in self._edits.veto]
        for row in table.itertuples():
            loop = f"{row.first}-{row.second}"
            forced = " (by you)" if loop in edits.tie else ""
            words = f"{loop}{forced}: {row.residual:.2f} sd off, {row.metres:.0f} m round"
            options.append((words, loop))
        self.open.description = f"loops ({len(table)})"
        before = self.listed.value
        self.first.max = self.second.max = len(outcome.log) - 1
        self.listed.options = options
        names = [loop for _, loop in options]
        if names:
            self.listed.value = before if before in names else names[0]
        self._outcome = outcome
        self._chosen()

    def picked(self, scan: int) -> None:
        """A place of the way was clicked: the first one, then the second, and so on."""
        self._take(self.second.value, scan)

    def _chosen(self, change: Any = None) -> None:
        """A loop of the list is looked at."""
        loop = self.listed.value
        if loop is not None:
            out = loop in self._edits.veto
            self.mend.description = "Take it back" if out else "Leave it out"
            self._take(*map(int, loop.split("-")))
        else:
            self._seen()

    def _take(self, first: int, second: int) -> None:
        """Look at two scans: drawn once, when both are named."""
        outcome, self._outcome = self._outcome, None
        self.first.value, self.second.value = first, second
        self._outcome = outcome
        self._seen()

    def _seen(self, change: Any = None) -> None:
        """Show the two scans that the numbers name, here and on the map."""
        if self._outcome is not None and not self.open.value:
            self._look(np.zeros((0, 2)), [])
        elif self._outcome is not None:
            first, second = self.first.value, self.second.value
            self._look(self._outcome.alignment.poses[:, :2], [first, second])
            self.picture.value = overlaid(self._outcome, first, second)

    def _mend(self, button: object) -> None:
        """Leave the chosen loop out, or take it back; a forced one just goes."""
        edits, loop = self._edits, self.listed.value
        if loop is None:
            return
        loops = edits.tie if loop in edits.tie else edits.veto
        loops.remove(loop) if loop in loops else loops.append(loop)
        self._changed()

    def _tie(self, button: object) -> None:
        """Force a loop between the key frames that are nearest to both scans on the way."""
        assert self._outcome is not None and self._outcome.alignment.graph is not None
        frames = np.unique(self._outcome.alignment.graph.edges)
        ends = sorted(
            int(frames[np.abs(frames - each.value).argmin()]) for each in (self.first, self.second)
        )
        loop = "{}-{}".format(*ends)
        if loop not in [option for _, option in self.listed.options]:
            self._edits.tie.append(loop)
            self._changed()


def overlaid(outcome: Pipeline, first: int, second: int) -> str:
    """Two scans over each other, where their poses put them, as HTML."""
    figure = Figure(dpi=DPI, layout="constrained")
    ax = figure.subplots()
    poses = outcome.alignment.poses
    for scan, color, size in ((first, MAP, 6.0), (second, ERROR, 2.0)):
        points = outcome.log[scan].points()
        near = points[np.hypot(*points.T) < NEAR]
        draw_points(transform(poses[scan], near), ax=ax, color=color, size=size)
    map_axes(ax).set(xlabel="", ylabel="")
    sides = np.array([np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())])
    width, height = (
        sides / sides.max() * PAIR_SIDE_PIXELS + AXIS_ROOM_PIXELS
    )  # a narrow corridor: a narrow picture
    figure.set_size_inches(width / DPI, height / DPI)
    apart = float(np.hypot(*(poses[first] - poses[second])[:2]))
    words = f"scan {first} black, scan {second} orange, {apart:.1f} m apart: do their walls agree?"
    png = base64.b64encode(figure_png(figure, finer=2)).decode("ascii")
    style = f"width: {width:.0f}px; max-width: 100%"
    picture = f'<img alt="{words}" style="{style}" src="data:image/png;base64,{png}">'
    return f'<div style="line-height: 1.3">{picture}<br>{words}</div>'
