"""A scan that is dragged onto another one, and what pulls at its points."""

from __future__ import annotations

import numpy as np
import scipy
import traitlets
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.alignment.points import PointMap
from segmap.arrays import Array
from segmap.poses import transform

from ..drawings import draw_scans
from ._drag_figure import DragFigure, module_text

#: Of a view, around all points, metres.
_MARGIN_M = 0.3


class DragScan(DragFigure):
    """Two scans, points `(n, 2)` and `(m, 2)` in metres; `pose` is where the second one lies now.

    A residual leads from each point to its nearest point of the first scan within `reach`: across
    that point's wall, or straight to it where `to_walls` is false. Points without a wall are left
    out. `pose` is x, y in metres and the turn in radians, in the frame of the first scan.

    Examples
    --------
    >>> wall = [(0.05 * k, 1.0) for k in range(40)]
    >>> figure = DragScan(wall, wall, (0, 0.1, 0))
    >>> figure
    DragScan(40 of 40 points have a partner, mean residual 10.0 cm to the walls)
    >>> figure.pose = [0, 0, 0]
    >>> round(figure.mean, 9)
    0.0
    """

    module = "scan_on_scan"
    _esm = module_text(module)
    reference = traitlets.List(traitlets.List(traitlets.Float())).tag(sync=True)
    #: Direction of the normal at each point of the reference, radians; None where there is no wall.
    across = traitlets.List(traitlets.Float(allow_none=True)).tag(sync=True)
    scan = traitlets.List(traitlets.List(traitlets.Float())).tag(sync=True)
    pose = traitlets.List(traitlets.Float()).tag(sync=True)
    reach = traitlets.Float().tag(sync=True)
    to_walls = traitlets.Bool(True).tag(sync=True)
    #: Left, low, right and top of what is seen, metres.
    view = traitlets.List(traitlets.Float()).tag(sync=True)

    def __init__(
        self, reference: ArrayLike, scan: ArrayLike, pose: ArrayLike, *, reach: float = 0.6
    ) -> None:
        grid = PointMap(arrays.points(reference, "reference")).grid  # points sorted by cells
        angles = np.arctan2(*grid.normals.T[::-1]).tolist()
        around = np.concatenate(
            [grid.points, transform(arrays.pose(pose, "pose"), np.asarray(scan))]
        )
        super().__init__(
            across=[None if np.isnan(angle) else round(angle, 4) for angle in angles],
            reference=_rounded(grid.points),
            scan=_rounded(arrays.points(scan, "scan")),
            pose=_rounded(np.asarray(pose, float)),
            reach=reach,
            view=_rounded(
                np.concatenate([around.min(0) - _MARGIN_M, around.max(0) + _MARGIN_M]), 1
            ),
        )

    def pulls(self) -> Array:
        """From each point that has a partner to where it is pulled, `(k, 2, 2)`, metres."""
        points = transform(np.array(self.pose, float), np.array(self.scan))
        reference, across = np.array(self.reference), np.array(self.across, float)
        distance, nearest = map(np.asarray, scipy.spatial.cKDTree(reference).query(points))
        near = (distance < self.reach) & ~np.isnan(across[nearest])
        points, partners, angle = points[near], reference[nearest[near]], across[nearest[near]]
        if not self.to_walls:
            return np.stack([points, partners], axis=1)
        normals = np.column_stack([np.cos(angle), np.sin(angle)])
        r = ((points - partners) * normals).sum(axis=1)
        return np.stack([points, points - r[:, None] * normals], axis=1)

    def residuals(self) -> Array:
        """How far each of these points is pulled, metres."""
        return np.asarray(np.hypot(*np.diff(self.pulls(), axis=1)[:, 0].T))

    @property
    def mean(self) -> float:
        """Mean residual, metres; NaN where no point has a partner."""
        return float(self.residuals().mean()) if len(self.residuals()) else np.nan

    def __repr__(self) -> str:
        to = "walls" if self.to_walls else "points"
        return (
            f"DragScan({len(self.residuals())} of {len(self.scan)} points have a partner, "
            f"mean residual {100 * self.mean:.1f} cm to the {to})"
        )

    def draw(self, ax: Axes) -> None:
        """Draw both scans, the residuals, and the robot at the second scan."""
        draw_scans(self.reference, self.scan, self.pose, ax=ax, pulls=self.pulls(), view=self.view)


def _rounded(values: Array, digits: int = 4) -> list[float]:
    return np.round(values, digits).tolist()
