"""The steps of point-to-line ICP, one by one, for whoever wants to see them."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..angles import wrap
from ..arrays import Array
from ..poses import transform
from . import _points_loops as loops
from ._frames import not_far
from ._point_icp import _points
from ._point_map import FLOOR, PointMap

#: More steps are never made.
ROUNDS = 60


class PointStep(NamedTuple):
    """One look at how a scan lies on another: which points count, and how far they are off.

    Parameters
    ----------
    pose : (3,) array, metres and radians
        Of the current scan in the frame of the reference.
    reach : float, metres
        How far partners were sought.
    points : (m, 2) array, metres
        Those points of the current scan, so placed, that have a wall within reach.
    feet : (m, 2) array, metres
        The nearest place on the wall of each.
    weights : (m,) array
        From 1 for a point on its wall towards 0 for one that is far off, beside the others.
    """

    pose: Array
    reach: float
    points: Array
    feet: Array
    weights: Array

    @property
    def offsets(self) -> Array:
        """Distances to the walls, `(m,)`, metres: the residuals, without sign."""
        away = self.points - self.feet
        return np.hypot(away[:, 0], away[:, 1])

    def __repr__(self) -> str:
        x, y, heading = self.pose.round(4) + 0.0
        where = f"{x:.6g} m, {y:.6g} m, {np.degrees(heading):.4g} deg"
        return f"PointStep({where}, {len(self.points)} points within {self.reach:.2g} m)"


def point_steps(
    reference: ArrayLike,
    current: ArrayLike,
    start: ArrayLike = (0.0, 0.0, 0.0),
    *,
    reach: float = 0.6,
) -> list[PointStep]:
    """What `match_points` does, step by step, from the start to where it ends (A 2.5.1, [41]).

    Parameters
    ----------
    reference, current : (n, 2) and (m, 2) arrays, metres
    start : (3,) array, metres and radians
    reach : float, metres
        As in `match_points`.

    Returns
    -------
    list of PointStep
        The last has the pose of the match. At most one where fewer than six points find a wall.

    Raises
    ------
    ValueError
        As in `match_points`.

    Examples
    --------
    >>> corner = np.array([(0.1 * k, 0) for k in range(30)] + [(0, 0.1 * k) for k in range(30)])
    >>> steps = point_steps(corner, corner - (0.05, 0.02))
    >>> steps[0]
    PointStep(0 m, 0 m, 0 deg, 56 points within 0.6 m)
    >>> steps[-1]
    PointStep(0.05 m, 0.02 m, 0 deg, 56 points within 0.12 m)
    """
    before, now = _points("reference", reference), not_far(_points("current", current))
    if min(len(before), len(now)) < 6:
        return []
    return list(_descent(PointMap(before), now, np.array(start, float), reach))


def _descent(
    map: PointMap, current: Array, pose: Array, reach: float, last: float = 0.12
) -> Iterator[PointStep]:
    """The rounds of `_points_loops.point_to_line`, by the same functions."""
    span = float(np.sqrt((current**2).sum(1).mean())) + 1e-9
    stride, done = 1 + len(current) // 250, False
    for _ in range(ROUNDS + 1):
        rows, _ = loops.residuals(map.cells, map.normals, current, pose, reach, stride)
        weights = np.ones(len(rows))
        if len(rows):
            weights, _ = loops.robust_weights(rows[:, 3], FLOOR)
        yield _seen(map, current[::stride], pose, reach, rows, weights)
        if done or len(rows) < 6:
            return
        move = loops.least_move(*loops.equations(rows, weights), span)
        pose = pose + move
        far = max(float(np.hypot(move[0], move[1])), abs(float(move[2])) * span)
        done = far < 1e-4 and stride == 1 and reach <= last
        if far < 0.02 and reach > last:
            reach = max(0.5 * reach, last)
        elif far < 0.02:
            stride = 1


def _seen(
    map: PointMap, current: Array, pose: Array, reach: float, rows: Array, weights: Array
) -> PointStep:
    """The points behind the rows: those that have a partner, which lies on a wall."""
    points = transform(pose, current)
    partner = np.array([loops.nearest(map.cells, x, y, reach) for x, y in points])
    on_wall = (partner >= 0) & np.isfinite(map.normals[partner, 0])
    points = points[on_wall]
    pose = np.array([*pose[:2], wrap(pose[2])])
    return PointStep(pose, reach, points, points - rows[:, 3:] * rows[:, :2], weights)
