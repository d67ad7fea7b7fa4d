"""Panels of the chapters on the methods that A surveys: lines that err, and the viewing sector."""

from __future__ import annotations

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure

from ..panels import player, slider
from ..plotting import ERROR, draw_before_after
from ..reduction import viewing_sector, weighted_line_fitting
from ..segments import SegmentMap
from ._panels_reduction import _ReductionPanel

#: Around all that is seen in the end, so that the picture stays while the scans pass, metres.
_MARGIN = 0.3


class WeightedPanel(_ReductionPanel):
    """A map and its weighted line fitting, for each error that poses may have (A 2.7.3).

    Parameters
    ----------
    map : SegmentMap
        Best with points and places of the sensor.

    Attributes
    ----------
    place : slider, metres
        Standard deviation of the place of a scan.
    heading : slider, degrees
        Standard deviation of its heading.
    chi2 : slider
    gap : slider, metres
    count, rate, quality : labels
    reduction : Reduction
        What is drawn.

    Examples
    --------
    >>> panel = WeightedPanel(SegmentMap([[(0, 0), (2, 0)], [(1, 0.03), (3, 0.03)]]))
    >>> panel.count.value
    '1 of 2 segments left'
    >>> panel.place.value = 0
    >>> panel.count.value
    '2 of 2 segments left'
    """

    def __init__(self, map: SegmentMap) -> None:
        super().__init__(map)
        self.place = slider("error of place", 0.03, 0.0, 0.20, 0.005)
        self.heading = slider("heading", 0.5, 0.0, 3.0, 0.1, "degrees")
        self.chi2 = slider("chi2", 9.2, 1.0, 30.0, 0.2, "")
        self.gap = slider("gap", 0.30, 0.0, 2.0, 0.05)
        rows = (self.chi2, self.gap, self.count, (self.rate, self.quality))
        self._assemble(self.place, self.heading, *rows)

    def _draw(self, figure: Figure) -> None:
        found = weighted_line_fitting(
            self.map,
            chi2=self.chi2.value,
            gap=self.gap.value,
            sigma_place=self.place.value,
            sigma_heading=np.radians(self.heading.value),
        )
        self._tell(found)
        draw_before_after(self.map, found, ax=figure.subplots())

    def __repr__(self) -> str:
        pose = f"{self.place.value:.3f} m, {self.heading.value:.1f} degrees"
        return f"WeightedPanel(poses within {pose}: {self.count.value})"


class SectorPanel(_ReductionPanel):
    """What was seen so far and the map that the viewing sector makes of it, scan by scan (A 2.7.5).

    All that was seen is thin and black, the map thick and blue, and a red dot is the sensor.

    Parameters
    ----------
    map : SegmentMap
        With the places of the sensor; at least one segment.

    Attributes
    ----------
    scan : slider
        The last scan that was taken.
    play : play button, which moves the slider
    distance, min_length : sliders, metres
    forget, rejoin : boxes to tick
    count, rate, quality : labels
    map : SegmentMap
        What was seen so far.
    reduction : Reduction
        What is drawn.

    Examples
    --------
    >>> door = [[(-2, 3), (2, 3)], [(-2, 3), (-1, 3)], [(1, 3), (2, 3)], [(-2, 5), (2, 5)]]
    >>> panel = SectorPanel(SegmentMap(door, [0, 1, 1, 1], sensors=[(0, 0), (0, 0)]))
    >>> panel.count.value
    '3 of 4 segments left'
    >>> panel.forget.value = False
    >>> panel.count.value
    '2 of 4 segments left'
    """

    def __init__(self, map: SegmentMap) -> None:
        super().__init__(map)
        self.whole, last = map, int(map.scan.max())
        self.scan = slider("scan", last, int(map.scan.min()), last, 1, "")
        self.play = player(self.scan)
        self.distance = slider("distance", 0.10, 0.02, 0.60, 0.02)
        self.min_length = slider("min_length", 0.10, 0.0, 1.0, 0.05)
        self.forget = W.Checkbox(value=True, description="forget", indent=False)
        self.rejoin = W.Checkbox(value=True, description="rejoin", indent=False)
        rows = (self.forget, self.rejoin), self.count, (self.rate, self.quality)
        self._assemble((self.play, self.scan), self.distance, self.min_length, *rows)

    def _draw(self, figure: Figure) -> None:
        self.map = self.whole[self.whole.scan <= self.scan.value]
        found = viewing_sector(
            self.map,
            distance=self.distance.value,
            min_length=self.min_length.value,
            forget=self.forget.value,
            rejoin=self.rejoin.value,
        )
        self._tell(found)
        ax = draw_before_after(self.map, found, ax=figure.subplots())
        if self.map.sensors is not None:
            ax.plot(*self.map.sensors[self.scan.value], "o", color=ERROR)
            corners = np.concatenate([self.map.sensors, self.whole.segments.reshape(-1, 2)])
            low, high = np.nanmin(corners, axis=0) - _MARGIN, np.nanmax(corners, axis=0) + _MARGIN
            ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))

    def __repr__(self) -> str:
        return f"SectorPanel(after scan {self.scan.value}: {self.count.value})"
