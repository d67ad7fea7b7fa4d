"""Panels on lines that err, on the viewing sector, on least cost, and on polylines."""

from __future__ import annotations

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure

from segmap.metrics import invented, missed
from segmap.panels import player, slider, text
from segmap.plotting import ERROR, draw_before_after
from segmap.reduction import least_cost, polyline, viewing_sector, weighted_line_fitting
from segmap.segments import SegmentMap

from ._reduction import TALL, _ReductionPanel

#: Around all that is seen in the end, so that the picture stays while the scans pass, metres.
_MARGIN = 0.3
#: Of quality, metres.
_SCALE = 0.050


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
        self._assemble(self.place, self.heading, *rows, **TALL)

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
        self._assemble((self.play, self.scan), self.distance, self.min_length, *rows, **TALL)

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


class LeastCostPanel(_ReductionPanel):
    """A map and what least cost leaves of it, for each penalty; and what quality does not see.

    Parameters
    ----------
    map : SegmentMap, at least one segment

    Attributes
    ----------
    penalty : slider, metres
        What one segment fewer may cost.
    distance : slider, metres
        A segment that lies farther off its output counts as missed.
    gap : slider, metres
        Bridged at no cost.
    count, rate, quality : labels
    promised : label
        The quality that the penalty guarantees.
    unseen : label
        Metres invented and metres missed.
    reduction : Reduction
        What is drawn.

    Examples
    --------
    >>> panel = LeastCostPanel(SegmentMap([[(0, 0), (2, 0)], [(0, 0.05), (2, 0.05)]]))
    >>> panel.count.value, panel.promised.value
    ('1 of 2 segments left', 'quality promised 60.7%')
    >>> panel.penalty.value = 0.01
    >>> panel.count.value
    '2 of 2 segments left'
    """

    def __init__(self, map: SegmentMap) -> None:
        super().__init__(map)
        self.penalty = slider("penalty", 0.05, 0.005, 0.5, 0.005)
        self.distance = slider("distance", 0.05, 0.01, 0.20, 0.01)
        self.gap = slider("gap", 0.05, 0.0, 0.10, 0.01)
        self.promised, self.unseen = text(), text()
        rows = self.count, (self.rate, self.quality), (self.promised, self.unseen)
        self._assemble(self.penalty, self.distance, self.gap, *rows, **TALL)

    def _draw(self, figure: Figure) -> None:
        thresholds = {name: getattr(self, name).value for name in ("penalty", "distance", "gap")}
        found = least_cost(self.map, **thresholds)
        self._tell(found)
        given = (found.parents >= 0).sum()
        spent = thresholds["penalty"] * (given - len(found)) / max(given, 1)
        self.promised.value = f"quality promised {np.exp(-spent / _SCALE):.1%}"
        metres = [measure(self.map, found) for measure in (invented, missed)]
        self.unseen.value = f"invented {metres[0]:.2f} m, missed {metres[1]:.2f} m"
        draw_before_after(self.map, found, ax=figure.subplots())

    def __repr__(self) -> str:
        return f"LeastCostPanel(penalty {self.penalty.value:.3f} m: {self.count.value})"


class ChainPanel(_ReductionPanel):
    """A map and its polylines, for each tolerance and bridge (A 2.7.10).

    Parameters
    ----------
    map : SegmentMap

    Attributes
    ----------
    tolerance : slider, metres
        How far a segment may lie off its polyline.
    far : slider, metres
        Segments farther apart do not match.
    bridge : slider, metres
        Longer links that nobody saw are left out.
    count, rate, quality : labels
    reduction : Reduction
        What is drawn.

    Examples
    --------
    >>> panel = ChainPanel(SegmentMap([[(0, 0), (2, 0)], [(1, 0.05), (3, 0.05)]], [0, 1]))
    >>> panel.count.value
    '1 of 2 segments left'
    """

    def __init__(self, map: SegmentMap) -> None:
        super().__init__(map)
        self.tolerance = slider("tolerance", 0.05, 0.01, 0.40, 0.01)
        self.far = slider("far", 0.10, 0.02, 0.30, 0.01)
        self.bridge = slider("bridge", 0.30, 0.0, 2.0, 0.1)
        rows = self.bridge, self.count, (self.rate, self.quality)
        self._assemble(self.tolerance, self.far, *rows, **TALL)

    def _draw(self, figure: Figure) -> None:
        thresholds = {name: getattr(self, name).value for name in ("tolerance", "far", "bridge")}
        found = polyline(self.map, **thresholds)
        self._tell(found)
        draw_before_after(self.map, found, ax=figure.subplots())

    def __repr__(self) -> str:
        return f"ChainPanel(tolerance {self.tolerance.value:.2f} m: {self.count.value})"
