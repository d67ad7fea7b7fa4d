"""Panels of the chapters on reduction: a map, and what one method leaves of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from segmap.arrays import Array
from segmap.metrics import (
    grade_quality,
    grade_reduction,
    invented,
    missed,
    quality,
    reduction_rate,
)
from segmap.plotting import (
    ERROR,
    MAP,
    RAW,
    draw_before_after,
    draw_provenance,
    group_colors,
)
from segmap.reduction import (
    Directions,
    Reduction,
    basic_offline,
    basic_online,
    common_directions,
    hough,
    hybrid,
    least_cost,
    mean_shift,
    viewing_sector,
)
from segmap.segments import SegmentMap, midpoint

from ..drawings import say_stretch
from ._lesson import LessonPanel, keyword, note, play, slide, tick

#: Pixels: two pictures side by side.
WIDE = {"width": 760, "height": 380}
#: Around all that is seen in the end, so that the picture stays while the scans pass, metres.
MARGIN = 0.3
#: Of quality, metres.
SCALE = 0.050


class ReductionPanel(LessonPanel):
    """A map and what a method leaves of it, `reduction`; its keywords may be given at first."""

    reduction: Reduction
    count = rate = quality = note()
    pixels = {"height": 440}  # noqa: RUF012

    def __init__(self, map: SegmentMap, **first: float) -> None:
        self.map = map
        self._begin(**first)

    def _draw(self, figure: Figure) -> None:
        self._tell(self.method(self.map, **self.chosen()))
        draw_before_after(self.map, self.reduction, ax=figure.subplots())

    def _tell(self, found: Reduction) -> None:
        self.reduction = found
        rate = reduction_rate(self.map, found)
        self.count.value = f"{len(found)} of {len(self.map)} segments left"
        self.rate.value = f"reduction {rate:.1%}: {grade_reduction(rate)}"
        self.quality.value = "no quality: the map is empty"
        if len(self.map):
            score = quality(self.map, found)
            self.quality.value = f"quality {score:.1%}: {grade_quality(score)}"


class BasicPanel(ReductionPanel):
    """A map and what Basic leaves of it, for each distance and angle (A 4.1).

    Examples
    --------
    >>> panel = BasicPanel(SegmentMap([[(0, 0), (1, 0)], [(1.3, 0), (2, 0)]]))
    >>> panel.count.value
    '2 of 2 segments left'
    >>> panel.distance.value = 0.35
    >>> panel.count.value
    '1 of 2 segments left'
    """

    method = staticmethod(basic_offline)
    distance = keyword(0.05, 0.60, 0.05)
    angle = keyword(1, 45, 1)
    online = tick("scan by scan (on-line)", says=("off-line", "on-line"))
    rows = ("distance", "angle", "online count", "rate quality")
    words = "{online}, {distance:.2f} m, {angle} degrees: {count}"

    def _draw(self, figure: Figure) -> None:
        self.method = basic_online if self.online.value else basic_offline
        super()._draw(figure)


class HybridPanel(ReductionPanel):
    """A map and its Hybrid, and the lines of both in Hough space, in the same colours (A 4.2).

    In the map, inputs are thin, results thick, and a black cross is the origin, which moves along x
    while the map stays. In Hough space an input is a dot and a result a cross amid the box of what
    agrees with it. What the filter dropped is grey.
    """

    method = staticmethod(hybrid)
    distance = keyword(0.05, 0.60, 0.05)
    angle = keyword(1, 30, 1)
    min_length = keyword(0.0, 1.0, 0.05)
    origin = slide(0, -100, 100, 1, label="origin at x")
    dropped = note()
    rows = ("distance", "angle", "min_length", "origin", "count dropped quality")
    words = "{distance:.2f} m, {angle} degrees, origin at {origin} m: {count}"
    pixels = WIDE

    def _draw(self, figure: Figure) -> None:
        x = self.origin.value
        moved = SegmentMap(self.map.segments - (x, 0), self.map.scan)
        reduced = hybrid(moved, **self.chosen())
        self._tell(replace(reduced, segments=reduced.segments + (x, 0)))
        gone = np.count_nonzero(self.reduction.parents < 0)
        self.dropped.value = f"{gone} dropped as too short"
        map_ax, hough_ax = figure.subplots(1, 2)
        draw_provenance(self.map, self.reduction, ax=map_ax)
        map_ax.set(xlim=map_ax.get_xlim(), ylim=map_ax.get_ylim())  # else a far origin counts
        map_ax.set_title(f"the map, origin at x = {x} m")
        map_ax.plot(x, 0, "+", color=MAP, markersize=14, markeredgewidth=2)
        box = [self.angle.value, self.distance.value]
        _draw_hough(moved.segments, reduced, box, hough_ax)


def _draw_hough(segments: Array, reduction: Reduction, box: list[float], ax: Axes) -> None:
    """Lines of inputs and results; inputs by the representative nearest to their result's."""
    lines, parents = hough(reduction.segments), reduction.parents
    near = np.where(parents < 0, np.pi / 2, np.append(lines[:, 1], 0.0)[parents])
    rho, theta = hough(segments, near).T
    ax.scatter(np.degrees(theta), rho, s=9, c=group_colors(parents), linewidths=0)
    colors, centres = group_colors(np.arange(len(lines))), lines[:, ::-1] * (180 / np.pi, 1)
    ax.scatter(centres[:, 0], centres[:, 1], s=36, c=colors, marker="+", linewidths=1.2)
    boxes = list(centres[:, None] + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * box)
    ax.add_collection(PolyCollection(boxes, facecolors="none", edgecolors=colors, alpha=0.5))
    ax.autoscale_view()
    ax.set(title="its lines in Hough space", xlabel="theta [degrees]", ylabel="rho [m]")


class MeanShiftPanel(ReductionPanel):
    """A map and its mean shift, and where its pieces climb in the first phase (A 4.3).

    In the map inputs are thin, results thick, each in the colour of the result that holds most of
    it. Beside it every piece is a grey dot, with a line to the place that it climbs to; these are
    coloured by cluster.
    """

    directions: Directions
    method = staticmethod(mean_shift)
    sigma = keyword(0.05, 1.00, 0.05)
    angle = slide(10, 1, 45, 1, "degrees", label="angle like 0.20 m")
    pieces = note()
    rows = ("sigma", "angle", "count pieces quality")
    words = "sigma {sigma:.2f} m, {angle} degrees: {count}"
    pixels = WIDE

    def _draw(self, figure: Figure) -> None:
        scales = {**self.chosen(), "bandwidth": float(self.angle.meant()) / 0.20}
        self._tell(mean_shift(self.map, **scales))
        reduced = self.directions = common_directions(self.map, **scales)
        clusters = f"{len(reduced.theta)} cluster{'s' * (len(reduced.theta) != 1)}"
        self.pieces.value = f"{len(reduced.pieces)} pieces, {clusters}"
        map_ax, pieces_ax = figure.subplots(1, 2, sharex=True, sharey=True)
        draw_provenance(self.map, self.reduction, ax=map_ax).set_title("the map, reduced")
        begin, end = midpoint(reduced.pieces), reduced.centres[:, :2]
        ways = list(np.stack([begin, end], axis=1))
        pieces_ax.add_collection(LineCollection(ways, colors=RAW, linewidths=0.6))
        pieces_ax.scatter(begin[:, 0], begin[:, 1], s=3, color=RAW, linewidths=0)
        pieces_ax.scatter(*end.T, s=20, c=group_colors(reduced.cluster), linewidths=0, zorder=3)
        pieces_ax.set_aspect("equal")
        pieces_ax.set(title="its pieces, and where they climb to", xlabel="x [m]")


class SectorPanel(ReductionPanel):
    """What was seen so far and the map that the viewing sector makes of it, scan by scan (A 2.7.5).

    All that was seen, `map`, is thin and black, the map made of it thick and blue, and an orange
    dot is the sensor, whose places are needed.
    """

    method = staticmethod(viewing_sector)
    scan = slide(lambda p: p.last, lambda p: int(p.map.scan.min()), lambda p: p.last, 1, "")
    play = play("scan")
    distance = keyword(0.02, 0.60, 0.02)
    min_length = keyword(0.0, 1.0, 0.05)
    forget = keyword()
    rejoin = keyword()
    rows = ("play scan", "distance", "min_length", "forget rejoin", "count", "rate quality")
    words = "after scan {scan}: {count}"

    def __init__(self, map: SegmentMap, **first: float) -> None:
        self.whole, self.last = map, int(map.scan.max())
        super().__init__(map, **first)

    def _draw(self, figure: Figure) -> None:
        self.map = self.whole[self.whole.scan <= self.scan.value]
        super()._draw(figure)
        if self.map.sensors is not None:
            (ax,) = figure.axes
            ax.plot(*self.map.sensors[self.scan.value], "o", color=ERROR)
            corners = np.concatenate([self.map.sensors, self.whole.segments.reshape(-1, 2)])
            low, high = np.nanmin(corners, axis=0) - MARGIN, np.nanmax(corners, axis=0) + MARGIN
            ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))


class LeastCostPanel(ReductionPanel):
    """A part of a map and what least cost leaves of it, for each penalty.

    `promised` is the quality that the penalty guarantees, `unseen` metres invented and missed,
    which quality does not see. Scales of x and y differ, so that looks at one wall can be told
    apart.
    """

    method = staticmethod(least_cost)
    penalty = keyword(0.005, 2.0, 0.005)
    distance = keyword(0.01, 0.20, 0.01)
    gap = keyword(0.0, 0.10, 0.01)
    promised = unseen = note()
    rows = ("penalty", "distance", "gap", "count", "rate quality", "promised unseen")
    words = "penalty {penalty:.3f} m: {count}"

    def _draw(self, figure: Figure) -> None:
        super()._draw(figure)
        figure.axes[0].set_aspect("auto")
        say_stretch(figure.axes[0])

    def _tell(self, found: Reduction) -> None:
        super()._tell(found)
        members = (found.parents >= 0).sum()
        spent = self.penalty.value * (members - len(found)) / max(members, 1)
        self.promised.value = f"quality promised {np.exp(-spent / SCALE):.1%}"
        metres = [measure(self.map, found) for measure in (invented, missed)]
        self.unseen.value = f"invented {metres[0]:.2f} m, missed {metres[1]:.2f} m"
