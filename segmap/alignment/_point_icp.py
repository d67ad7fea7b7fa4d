"""Point ICP (A 2.5.1, [41]): the points of a scan moved onto the walls that other points form."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..scans import Log
from ._frames import not_far
from ._point_map import PointMap
from ._result import Match, check_positive, no_match
from ._runner import Outcome, Trail, alignment_method
from ._walk import Walk, settled


def match_points(
    reference: ArrayLike,
    current: ArrayLike,
    start: ArrayLike = (0.0, 0.0, 0.0),
    *,
    reach: float = 0.6,
) -> Match:
    """Pose of one scan in the frame of another, by point-to-line ICP (A 2.5.1, [41]; Censi 2008).

    Each point seeks its nearest partner; its residual is the offset across the wall that the
    partner's neighbours form, so that points may slide along walls. Residuals weigh by a Cauchy
    function of their share of the spread (the robust trimming: a person walking through counts
    little), partners are sought nearer and nearer, and directions that no wall fixes are left as
    the start has them.

    Parameters
    ----------
    reference, current : (n, 2) and (m, 2) arrays, metres
        Points of two scans, each in its own frame; the reference may be a map of many scans. Points
        of the current scan farther than 100 m from its origin are left out.
    start : (3,) array, metres and radians
        Supposed pose of the current scan in the frame of the reference.
    reach : float, metres
        How far partners are sought at first: more than the start may be wrong by.

    Returns
    -------
    Match
        With the covariance that the Hessian gives, and `free` where a direction is not fixed.
        Not matched where fewer than 40 % of the points find a partner within 0.12 m in the end.

    Raises
    ------
    ValueError
        For arrays of another shape, or coordinates that are not finite.

    Examples
    --------
    >>> corner = np.array([(0.1 * k, 0) for k in range(30)] + [(0, 0.1 * k) for k in range(30)])
    >>> match_points(corner, corner - (0.05, 0.02))
    Match(0.05 m, 0.02 m, 0 deg, overlap 1.00)
    """
    check_positive(reach=reach)
    before, now = _points("reference", reference), not_far(_points("current", current))
    begin = np.array(start, float)
    if begin.shape != (3,) or not np.isfinite(begin).all():
        raise ValueError(f"start must be a finite pose x, y, heading, got {start!r}")
    if min(len(before), len(now)) < 6:
        return no_match(begin, f"too few points: {len(before)} and {len(now)}")
    return settled(PointMap(before), now, begin, reach)


@alignment_method
def point_icp(
    log: Log, *, step: float = 0.5, turn: float = np.radians(30), reach: float = 0.6
) -> Outcome:
    """Lay scan after scan by point-to-line ICP on a map of the last key frames (A 2.5.1, [41]).

    It starts where the odometry puts the scan and ends in the nearest minimum: odometry that is
    wrong by more than `reach` at one step leads it into a wrong one, from which it never returns.

    Parameters
    ----------
    log : Log
        In the order of recording; times do not matter.
    step : float, metres, and turn : float, radians
        A key frame is set where the robot has moved this far from the last one.
    reach : float, metres
        How far partners are sought at first.

    Returns
    -------
    Alignment
        Poses, (k, 3) array, metres and radians. A scan of which too little lies on the map carries
        the odometry step.

    Raises
    ------
    ValueError
        For thresholds that are not positive.

    Examples
    --------
    >>> from segmap import load
    >>> point_icp(load("corridor")[:40])
    Alignment(point_icp: 40 scans, 40 used)
    """
    check_positive(step=step, turn=turn, reach=reach)
    if len(log) == 0:
        return Trail(log).outcome()
    walk = Walk(log, lambda map, points, guess: settled(map, points, guess, reach))
    for scan in range(1, len(log)):
        match = walk.place(scan)
        if walk.far_from_frame(scan, step, turn):
            walk.add_frame(scan, match)
    return walk.outcome()


def _points(name: str, values: ArrayLike) -> Array:
    points = np.array(values, float)
    if points.size == 0:
        return np.empty((0, 2))
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError(f"{name} must have shape (n, 2), got {points.shape}")
    if not np.isfinite(points).all():
        raise ValueError(f"{name} must be finite: leave out beams without return")
    return points
