"""Point ICP: the points of a scan moved onto the walls that other points form.

A 2.5.1, after Lu and Milios (1997); here with residuals across walls (Censi 2008).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ... import arrays
from ...arrays import Array, Metres, Share, checked
from ...poses.motions import transform
from ...scans.causes import Unmatched
from .._result import Match, no_match
from ._point_map import (
    DESCENT_POINTS,
    LAST,
    MOST_DESCENT_STEPS,
    SCAN_VARIANCE_INFLATION,
    PointMap,
    in_range,
    odd_step,
)


@checked
def match_points(
    reference: ArrayLike,
    current: ArrayLike,
    start: ArrayLike = (0.0, 0.0, 0.0),
    *,
    reach: Metres = 0.6,
    overlap: Share = 0.4,
) -> Match:
    """Pose of one scan in the frame of another, by point-to-line ICP (A 2.5.1; Censi 2008).

    Each point seeks its nearest partner; its residual is the offset across the wall that the
    partner's neighbours form, so that points may slide along walls. Residuals weigh by a Cauchy
    function of their share of the spread: a person walking through counts little. Partners are
    sought nearer and nearer, and directions that no wall fixes are left as the start has them.

    Parameters
    ----------
    reference, current : (n, 2) and (m, 2) arrays, metres
        Points of two scans, each in its own frame; the reference may be a map of many scans. Points
        of the current scan farther than 100 m from its origin are left out.
    start : (3,) array, metres and radians
        Supposed pose of the current scan in the frame of the reference.
    reach
        How far partners are sought at first: more than the start may be wrong by.
    overlap
        Share of the points that must find a partner within 0.12 m in the end.

    Returns
    -------
    Match
        With the covariance that the Hessian gives, and `free` where a direction is not fixed. A
        noise of less than 10 mm is not believed: for a laser that errs by 3 mm its standard
        deviations are three times too large.

    Examples
    --------
    >>> corner = np.array([(0.1 * k, 0) for k in range(30)] + [(0, 0.1 * k) for k in range(30)])
    >>> match_points(corner, corner - (0.05, 0.02))
    Match(0.05 m, 0.02 m, 0 deg, overlap 1.00)
    """
    before, now, begin = _check_inputs(reference, current, start)
    if min(len(before), len(now)) < 6:
        words = f"too few points: {len(before)} and {len(now)}"
        return no_match(begin, Unmatched.TOO_LITTLE_SEEN, words)
    map = PointMap(before)
    return map.register(now, begin, reach=reach, overlap=overlap, inflation=SCAN_VARIANCE_INFLATION)


class PointStep(NamedTuple):
    """One look at how a scan lies on another: which points count, and how far they are off.

    Parameters
    ----------
    pose : (3,) array, metres and radians
        Of the current scan in the frame of the reference.
    reach
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


@checked
def point_steps(
    reference: ArrayLike,
    current: ArrayLike,
    start: ArrayLike = (0.0, 0.0, 0.0),
    *,
    reach: Metres = 0.6,
) -> list[PointStep]:
    """What `match_points` does, step by step, from the start to where it ends (A 2.5.1).

    Returns
    -------
    list of PointStep
        The last has the pose of the match. At most one where fewer than six points find a wall.

    Examples
    --------
    >>> corner = np.array([(0.1 * k, 0) for k in range(30)] + [(0, 0.1 * k) for k in range(30)])
    >>> steps = point_steps(corner, corner - (0.05, 0.02))
    >>> steps[0]
    PointStep(0 m, 0 m, 0 deg, 56 points within 0.6 m)
    >>> steps[-1]
    PointStep(0.05 m, 0.02 m, 0 deg, 56 points within 0.12 m)
    """
    before, now, pose = _check_inputs(reference, current, start)
    if min(len(before), len(now)) < 6:
        return []
    map, steps = PointMap(before), []
    stride, converged = odd_step(len(now), DESCENT_POINTS), False
    for _ in range(MOST_DESCENT_STEPS + 1):
        step = map.descend(now, pose, reach, LAST, stride, rounds=1)
        index = step.rows[:, 5].astype(np.int64)
        points, offsets = transform(pose, now[index]), step.rows[:, 3:4]
        feet = points - offsets * step.rows[:, :2]
        weights = step.rows[:, 4].copy() if len(points) >= 6 else np.ones(len(points))
        steps.append(PointStep(pose, reach, points, feet, weights))
        if converged or len(points) < 6:
            break
        pose, reach, stride, converged = step.pose, step.reach, step.stride, step.converged
    return steps


def _check_inputs(reference: ArrayLike, current: ArrayLike, start: ArrayLike) -> tuple[Array, ...]:
    """Both clouds of points and the start, as the matcher takes them."""
    now = arrays.points(current, "current")
    before, begin = arrays.points(reference, "reference"), arrays.pose(start, "start")
    return before, in_range(now), begin
