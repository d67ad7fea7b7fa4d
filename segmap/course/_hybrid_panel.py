"""Hybrid of a map beside its Hough space, with the origin on a slider."""

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from ..arrays import Array
from ..metrics import grade_quality, quality
from ..panels import Panel, slider, text
from ..plotting import MAP, draw_provenance, group_colors
from ..reduction import Reduction, hough, hybrid
from ..segments import SegmentMap

#: Pixels: two pictures side by side.
WIDTH, HEIGHT = 760, 380


class HybridPanel(Panel):
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

    reduction: Reduction

    def __init__(self, map: SegmentMap, *, distance: float = 0.20, angle: float = 10) -> None:
        self.map = map
        self.distance = slider("distance", distance, 0.05, 0.60, 0.05)
        self.angle = slider("angle", round(angle), 1, 30, 1, "degrees")
        self.origin = slider("origin at x", 0, -100, 100, 1)
        self.count, self.dropped, self.quality = text(), text(), text()
        texts = (self.count, self.dropped, self.quality)
        self._assemble(self.distance, self.angle, self.origin, texts, width=WIDTH, height=HEIGHT)

    def _draw(self, figure: Figure) -> None:
        origin = np.array([self.origin.value, 0.0])
        moved = SegmentMap(self.map.segments - origin, self.map.scan)
        angle = np.radians(self.angle.value)
        found = hybrid(moved, distance=self.distance.value, angle=angle)
        self.reduction = replace(found, segments=found.segments + origin)
        self._tell()
        left, right = figure.subplots(1, 2)
        draw_provenance(self.map, self.reduction, ax=left)
        self._mark(left)
        _draw_hough(moved.segments, found, self.distance.value, self.angle.value, right)

    def _tell(self) -> None:
        kept = quality(self.map, self.reduction)
        gone = np.count_nonzero(self.reduction.parents < 0)
        self.count.value = f"{len(self.reduction)} of {len(self.map)} segments left"
        self.dropped.value = f"{gone} dropped as too short"
        self.quality.value = f"quality {kept:.1%}: {grade_quality(kept)}"

    def _mark(self, ax: Axes) -> None:
        """The origin, where it lies within the picture; else only in words."""
        ax.set_title(f"the map, origin at x = {self.origin.value} m")
        ax.set(xlim=ax.get_xlim(), ylim=ax.get_ylim())
        ax.plot(self.origin.value, 0, "+", color=MAP, markersize=14, markeredgewidth=2)

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
    _draw_boxes(lines, distance, angle, ax)
    ax.autoscale_view()
    ax.set(title="its lines in Hough space", xlabel="theta [degrees]", ylabel="rho [m]")


def _draw_boxes(lines: Array, distance: float, angle: float, ax: Axes) -> None:
    """What agrees with each line, and a cross in the middle of it."""
    colors = group_colors(np.arange(len(lines)))
    theta, rho = np.degrees(lines[:, 1]), lines[:, 0]
    ax.scatter(theta, rho, s=36, c=colors, marker="+", linewidths=1.2)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * [angle, distance]
    boxes = np.stack([theta, rho], -1)[:, None] + corners
    ax.add_collection(PolyCollection(list(boxes), facecolors="none", edgecolors=colors, alpha=0.5))
