"""The panel of the chapter on six ways to find a line."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from segmap.plotting import MAP, RAW, RESULT, draw_points, draw_segments
from segmap.poses import transform
from segmap.segments import length

from .._found_lines import LINE_FINDERS, LINE_SENSORS, near_metres, office_views
from ._lesson import LessonPanel, note, pick, slide


class FinderPanel(LessonPanel):
    """The segments that one of the methods finds in a scan of an office.

    Examples
    --------
    >>> panel = FinderPanel()
    >>> panel.found.value
    '6 segments, precision 1.00, recall 1.00'
    """

    method_name = pick(LINE_FINDERS, "method")
    sensor = pick([sensor.name for sensor in LINE_SENSORS])
    view = slide(0, 0, 10, 1, "")
    gap = slide(0.30, 0.05, 1.0, 0.05)
    tolerance = slide(3, 1, 20, 1, "cm")
    found = note()
    rows = ("method_name sensor", "view gap", "tolerance", "found")
    words = "{method_name}, {sensor}, view {view}: {found}"
    pixels = {"width": 480, "height": 400}  # noqa: RUF012

    def __init__(self) -> None:
        self._begin()

    def _draw(self, figure: Figure) -> None:
        sensor = next(s for s in LINE_SENSORS if s.name == self.sensor.value)
        scan, pose, walls, visible = office_views(sensor, offices=1)[self.view.value]
        name, options = self.method_name.value, {"gap": self.gap.meant()}
        is_tolerant = name != "clusters"
        if is_tolerant:
            options["tolerance"] = self.tolerance.meant()
        segments = transform(pose, LINE_FINDERS[name](scan.points(), **options))
        metres = max(float(length(segments).sum()), 1e-9)
        precision = near_metres(segments, walls) / metres
        recall = near_metres(visible, segments) / length(visible).sum()
        self.found.value = (
            f"{len(segments)} segments, precision {precision:.2f}, recall {recall:.2f}"
        )
        self.tolerance.disabled = not is_tolerant
        points = transform(pose, scan.points())
        ax = draw_segments(walls, ax=figure.subplots(), color=RAW, width=0.6)
        draw_points(points, ax=ax, color=MAP, size=2)
        draw_segments(segments, ax=ax, color=RESULT)
        low, high = points.min(0) - 0.5, points.max(0) + 0.5
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        ax.plot(*np.asarray(pose)[:2], "o", color=MAP)
