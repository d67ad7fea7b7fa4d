"""Panels of the chapters on Basic, Hybrid, mean shift and Fusion."""

from __future__ import annotations

from dataclasses import replace

import ipywidgets as W
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from segmap.arrays import Array
from segmap.metrics import grade_quality, grade_reduction, quality, reduction_rate
from segmap.panels import Panel, slider, text
from segmap.plotting import MAP, RAW, draw_before_after, draw_provenance, group_colors
from segmap.reduction import (
    Directions,
    Reduction,
    basic_offline,
    basic_online,
    common_directions,
    fusion,
    hough,
    hybrid,
    mean_shift,
)
from segmap.segments import SegmentMap, midpoint

#: Pixels: two pictures side by side.
_WIDE = {"width": 760, "height": 380}
#: Pixels: one map, and a line below it.
TALL = {"height": 440}


class _ReductionPanel(Panel):
    """A map and what a method leaves of it: `reduction` is what is drawn."""

    reduction: Reduction

    def __init__(self, map: SegmentMap) -> None:
        self.map = map
        self.count, self.rate, self.quality = text(), text(), text()

    def _tell(self, found: Reduction) -> None:
        self.reduction = found
        rate = reduction_rate(self.map, found)
        self.count.value = f"{len(found)} of {len(self.map)} segments left"
        self.rate.value = f"reduction {rate:.1%}: {grade_reduction(rate)}"
        self.quality.value = "no quality: the map is empty"
        if len(self.map):
            kept = quality(self.map, found)
            self.quality.value = f"quality {kept:.1%}: {grade_quality(kept)}"


class BasicPanel(_ReductionPanel):
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

    def __init__(
        self, map: SegmentMap, *, distance: float = 0.20, angle: float = np.pi / 18
    ) -> None:
        super().__init__(map)
        self.distance = slider("distance", distance, 0.05, 0.60, 0.05)
        self.angle = slider("angle", round(np.degrees(angle)), 1, 45, 1, "degrees")
        self.online = W.Checkbox(value=False, description="scan by scan (on-line)", indent=False)
        rows = (self.online, self.count), (self.rate, self.quality)
        self._assemble(self.distance, self.angle, *rows, **TALL)

    def _draw(self, figure: Figure) -> None:
        method = basic_online if self.online.value else basic_offline
        distance, angle = self.distance.value, np.radians(self.angle.value)
        self._tell(method(self.map, distance=distance, angle=angle))
        draw_before_after(self.map, self.reduction, ax=figure.subplots())

    def __repr__(self) -> str:
        way = "on-line" if self.online.value else "off-line"
        where = f"{self.distance.value:.2f} m, {self.angle.value} degrees"
        return f"BasicPanel({way}, {where}: {self.count.value})"


class FusionPanel(_ReductionPanel):
    """A map and its fusion: how much is gained and what it costs, for each tolerance (A 4.4).

    Parameters
    ----------
    map : SegmentMap
    tolerance : float, metres
        Half-width of the strip, at first.

    Attributes
    ----------
    tolerance : slider, metres
    count, rate, quality : labels
    reduction : Reduction
        What is drawn.

    Examples
    --------
    >>> panel = FusionPanel(SegmentMap([[(0, 0), (1, 0)], [(0, 0.1), (1, 0.1)]]))
    >>> panel.count.value
    '2 of 2 segments left'
    >>> panel.tolerance.value = 0.06
    >>> panel.count.value
    '1 of 2 segments left'
    """

    def __init__(self, map: SegmentMap, *, tolerance: float = 0.04) -> None:
        super().__init__(map)
        self.tolerance = slider("tolerance", tolerance, 0.01, 0.20, 0.01)
        self._assemble(self.tolerance, self.count, (self.rate, self.quality), **TALL)

    def _draw(self, figure: Figure) -> None:
        self._tell(fusion(self.map, tolerance=self.tolerance.value))
        draw_before_after(self.map, self.reduction, ax=figure.subplots())

    def __repr__(self) -> str:
        return f"FusionPanel(tolerance {self.tolerance.value:.2f} m: {self.count.value})"


class HybridPanel(_ReductionPanel):
    """A map and its Hybrid, and the lines of both in Hough space, in the same colours (A 4.2).

    In the map, inputs are thin, results thick, and a black cross is the origin, which moves along x
    while the map stays. In Hough space an input is a dot and a result a cross amid the box of what
    agrees with it. What the filter dropped is grey.

    Parameters
    ----------
    map : SegmentMap
    distance : float, metres
        At first; also the least length of a segment that joins.
    angle : float, degrees
        At first.

    Attributes
    ----------
    distance : slider, metres
    angle : slider, degrees
    origin : slider, metres
        Where on the x axis of the map the origin lies for the method.
    count, dropped, quality : labels
    reduction : Reduction
        What is drawn.

    Examples
    --------
    >>> panel = HybridPanel(SegmentMap([[(0, 0), (2, 0)], [(1.95, 0), (3.9, 0.2)]]))
    >>> panel.count.value
    '1 of 2 segments left'
    >>> panel.origin.value = 20
    >>> panel.count.value
    '2 of 2 segments left'
    """

    def __init__(self, map: SegmentMap, *, distance: float = 0.20, angle: float = 10) -> None:
        super().__init__(map)
        self.distance = slider("distance", distance, 0.05, 0.60, 0.05)
        self.angle = slider("angle", round(angle), 1, 30, 1, "degrees")
        self.origin = slider("origin at x", 0, -100, 100, 1)
        self.dropped = text()
        texts = (self.count, self.dropped, self.quality)
        self._assemble(self.distance, self.angle, self.origin, texts, **_WIDE)

    def _draw(self, figure: Figure) -> None:
        x, degrees = self.origin.value, self.angle.value
        moved = SegmentMap(self.map.segments - (x, 0), self.map.scan)
        found = hybrid(moved, distance=self.distance.value, angle=np.radians(degrees))
        self._tell(replace(found, segments=found.segments + (x, 0)))
        gone = np.count_nonzero(self.reduction.parents < 0)
        self.dropped.value = f"{gone} dropped as too short"
        left, right = figure.subplots(1, 2)
        draw_provenance(self.map, self.reduction, ax=left).set_title(
            f"the map, origin at x = {x} m"
        )
        left.set(xlim=left.get_xlim(), ylim=left.get_ylim())  # else a far origin counts
        left.plot(x, 0, "+", color=MAP, markersize=14, markeredgewidth=2)
        _draw_hough(moved.segments, found, self.distance.value, degrees, right)

    def __repr__(self) -> str:
        thresholds = f"{self.distance.value:.2f} m, {self.angle.value} degrees"
        return f"HybridPanel({thresholds}, origin at {self.origin.value} m: {self.count.value})"


def _draw_hough(
    segments: Array, reduction: Reduction, distance: float, angle: float, ax: Axes
) -> None:
    """Lines of inputs and results; inputs by the representative nearest to their result's."""
    lines, parents = hough(reduction.segments), reduction.parents
    near = np.where(parents < 0, np.pi / 2, np.append(lines[:, 1], 0.0)[parents])
    rho, theta = hough(segments, near).T
    ax.scatter(np.degrees(theta), rho, s=9, c=group_colors(parents), linewidths=0)
    colors, centres = group_colors(np.arange(len(lines))), lines[:, ::-1] * (180 / np.pi, 1)
    ax.scatter(centres[:, 0], centres[:, 1], s=36, c=colors, marker="+", linewidths=1.2)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * [angle, distance]
    boxes = list(centres[:, None] + corners)
    ax.add_collection(PolyCollection(boxes, facecolors="none", edgecolors=colors, alpha=0.5))
    ax.autoscale_view()
    ax.set(title="its lines in Hough space", xlabel="theta [degrees]", ylabel="rho [m]")


class MeanShiftPanel(_ReductionPanel):
    """A map and its mean shift, and where its pieces climb in the first phase (A 4.3).

    In the map inputs are thin, results thick, each in the colour of the result that holds most of
    it. Beside it every piece is a grey dot, with a line to the place that it climbs to; these are
    coloured by cluster.

    Parameters
    ----------
    map : SegmentMap
    sigma : float, metres
        At first.
    angle : float, degrees
        What counts as much as 0.20 m, at first.

    Attributes
    ----------
    sigma : slider, metres
    angle : slider, degrees
    count, pieces, quality : labels
    reduction : Reduction
    directions : Directions
        What is drawn.

    Examples
    --------
    >>> panel = MeanShiftPanel(SegmentMap([[(0, 0), (1, 0)], [(0, 0.15), (1, 0.15)]]))
    >>> panel.count.value, panel.pieces.value
    ('2 of 2 segments left', '10 pieces, 1 cluster')
    >>> panel.sigma.value = 0.6
    >>> panel.count.value, panel.pieces.value
    ('1 of 2 segments left', '4 pieces, 1 cluster')
    """

    directions: Directions

    def __init__(self, map: SegmentMap, *, sigma: float = 0.20, angle: float = 10) -> None:
        super().__init__(map)
        self.sigma = slider("sigma", sigma, 0.05, 1.00, 0.05)
        self.angle = slider("angle like 0.20 m", round(angle), 1, 45, 1, "degrees")
        self.pieces = text()
        self._assemble(self.sigma, self.angle, (self.count, self.pieces, self.quality), **_WIDE)

    def _draw(self, figure: Figure) -> None:
        sigma, bandwidth = self.sigma.value, float(np.radians(self.angle.value)) / 0.20
        self._tell(mean_shift(self.map, sigma=sigma, bandwidth=bandwidth))
        self.directions = common_directions(self.map, sigma=sigma, bandwidth=bandwidth)
        clusters = len(self.directions.theta)
        pieces = f"{len(self.directions.pieces)} pieces"
        self.pieces.value = f"{pieces}, {clusters} cluster{'s' * (clusters != 1)}"
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        draw_provenance(self.map, self.reduction, ax=left).set_title("the map, reduced")
        _draw_ways(self.directions, right)

    def __repr__(self) -> str:
        scales = f"sigma {self.sigma.value:.2f} m, {self.angle.value} degrees"
        return f"MeanShiftPanel({scales}: {self.count.value})"


def _draw_ways(found: Directions, ax: Axes) -> None:
    """From the middle of each piece to its centre, in the colour of its cluster."""
    begin, end = midpoint(found.pieces), found.centres[:, :2]
    ways = np.stack([begin, end], axis=1)
    ax.add_collection(LineCollection(list(ways), colors=RAW, linewidths=0.6))
    ax.scatter(begin[:, 0], begin[:, 1], s=3, color=RAW, linewidths=0)
    ax.scatter(end[:, 0], end[:, 1], s=12, c=group_colors(found.cluster), linewidths=0)
    ax.set_aspect("equal")
    ax.set(title="its pieces, and where they climb to", xlabel="x [m]")
