"""Basic on a map, with its two thresholds on sliders."""

from typing import Any

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure

from ..metrics import grade_quality, grade_reduction, quality, reduction_rate
from ..panels import Panel, slider, text
from ..plotting import draw_before_after
from ..reduction import Reduction, basic_offline, basic_online
from ..segments import SegmentMap


class BasicPanel(Panel):
    """A map and what Basic leaves of it, for each distance and angle (A 4.1).

    Parameters
    ----------
    map : SegmentMap
    distance : float, metres
        Between end points, at first.
    angle : float, radians
        Between lines, at first.

    Attributes
    ----------
    distance : slider, metres
    angle : slider, degrees
    online : box to tick
        Scan by scan instead of all at once.
    count, rate, quality : labels
    reduction : Reduction
        What is drawn.

    Examples
    --------
    >>> panel = BasicPanel(SegmentMap([[(0, 0), (1, 0)], [(1.3, 0), (2, 0)]]))
    >>> panel.count.value
    '2 of 2 segments left'
    >>> panel.distance.value = 0.35
    >>> panel.count.value
    '1 of 2 segments left'
    """

    reduction: Reduction
    online: Any

    def __init__(
        self, map: SegmentMap, *, distance: float = 0.20, angle: float = np.pi / 18
    ) -> None:
        self.map = map
        self.distance = slider("distance", distance, 0.05, 0.60, 0.05)
        self.angle = slider("angle", round(np.degrees(angle)), 1, 45, 1, "degrees")
        self.online = W.Checkbox(value=False, description="scan by scan (on-line)", indent=False)
        self.count, self.rate, self.quality = text(), text(), text()
        rows = (self.online, self.count), (self.rate, self.quality)
        self._assemble(self.distance, self.angle, *rows)

    def _draw(self, figure: Figure) -> None:
        method = basic_online if self.online.value else basic_offline
        distance, angle = self.distance.value, np.radians(self.angle.value)
        self.reduction = method(self.map, distance=distance, angle=angle)
        rate = reduction_rate(self.map, self.reduction)
        kept = quality(self.map, self.reduction)
        self.count.value = f"{len(self.reduction)} of {len(self.map)} segments left"
        self.rate.value = f"reduction {rate:.1%}: {grade_reduction(rate)}"
        self.quality.value = f"quality {kept:.1%}: {grade_quality(kept)}"
        draw_before_after(self.map, self.reduction, ax=figure.subplots())

    def __repr__(self) -> str:
        way = "on-line" if self.online.value else "off-line"
        where = f"{self.distance.value:.2f} m, {self.angle.value} degrees"
        return f"BasicPanel({way}, {where}: {self.count.value})"
