"""The panel of the chapter that asks whether a map is right: a tape that is laid across it."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from segmap.plotting import ERROR, MAP, RESULT, draw_segments
from segmap.poses import transform
from segmap.segments import length
from segmap.simulation import cast_rays

from .._unknown_building import Unknown, unknown_building
from ._lesson import LessonPanel, note, pick, slide

#: Shorter segments are measured to, but not drawn, metres.
SHOWN_M = 1.0


class TapePanel(LessonPanel):
    """A tape from wall to wall in one of the maps, through the place of a scan.

    The case is `unknown_building()` where none is given.

    Examples
    --------
    >>> panel = TapePanel()
    >>> panel.map.value = "C"
    >>> panel.metres.value
    '12.29 m from wall to wall'
    """

    map = pick(("D", "C", "B", "A"))
    scan = slide(48, 0, lambda panel: len(panel.case.log) - 1, 1, "")
    turn = slide(0, -90, 90, 5, "degrees", label="direction")
    metres = sure = note()
    rows = ("map", "scan", "turn", "metres sure")
    words = "map {map}, scan {scan}, {turn} degrees: {metres}, {sure}"
    pixels = {"width": 360, "height": 300}  # noqa: RUF012

    def __init__(self, case: Unknown | None = None) -> None:
        self.case = unknown_building() if case is None else case
        self._begin()

    def _draw(self, figure: Figure) -> None:
        walls, k = self.case.maps[self.map.value].segments, self.scan.value
        alignment = self.case.alignments[self.map.value]
        pose, both = alignment.poses[k], self.turn.meant() + np.array([0, np.pi])
        far = cast_rays(walls, pose, both, max_range=50.0)
        if np.isfinite(far).all():
            self.metres.value = f"{far.sum():.2f} m from wall to wall"
        else:
            self.metres.value = "no wall at an end"
        spread = alignment.spread
        spread_text = "its method does not tell" if spread is None else f"{2 * spread[k]:.2f} m"
        self.sure.value = f"twice the deviation of the scan: {spread_text}"
        long = walls[length(walls) > SHOWN_M]
        ax = draw_segments(long, ax=figure.subplots(), color=MAP, width=0.8)
        ends = np.minimum(far, 20.0)[:, None] * np.stack([np.cos(both), np.sin(both)], -1)
        ax.plot(*transform(pose, ends).T, color=ERROR, linewidth=2)
        ax.plot(*pose[:2], "o", color=RESULT)
