"""Mean shift of a map beside the climbing of its pieces, with both scales on sliders."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ..metrics import grade_quality, quality
from ..panels import Panel, slider, text
from ..plotting import RAW, draw_provenance, group_colors
from ..reduction import Directions, Reduction, common_directions, mean_shift
from ..segments import SegmentMap, midpoint

#: Pixels: two pictures side by side.
WIDTH, HEIGHT = 760, 380


class MeanShiftPanel(Panel):
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

    reduction: Reduction
    directions: Directions

    def __init__(self, map: SegmentMap, *, sigma: float = 0.20, angle: float = 10) -> None:
        self.map = map
        self.sigma = slider("sigma", sigma, 0.05, 1.00, 0.05)
        self.angle = slider("angle like 0.20 m", round(angle), 1, 45, 1, "degrees")
        self.count, self.pieces, self.quality = text(), text(), text()
        texts = (self.count, self.pieces, self.quality)
        self._assemble(self.sigma, self.angle, texts, width=WIDTH, height=HEIGHT)

    def _draw(self, figure: Figure) -> None:
        sigma, bandwidth = self.sigma.value, float(np.radians(self.angle.value)) / 0.20
        self.reduction = mean_shift(self.map, sigma=sigma, bandwidth=bandwidth)
        self.directions = common_directions(self.map, sigma=sigma, bandwidth=bandwidth)
        self._tell()
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        draw_provenance(self.map, self.reduction, ax=left).set_title("the map, reduced")
        _draw_ways(self.directions, right)

    def _tell(self) -> None:
        kept, clusters = quality(self.map, self.reduction), len(self.directions.theta)
        self.count.value = f"{len(self.reduction)} of {len(self.map)} segments left"
        plural = "" if clusters == 1 else "s"
        self.pieces.value = f"{len(self.directions.pieces)} pieces, {clusters} cluster{plural}"
        self.quality.value = f"quality {kept:.1%}: {grade_quality(kept)}"

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
