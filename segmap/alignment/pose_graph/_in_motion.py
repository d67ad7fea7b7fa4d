"""A scan of a laser that turned while the robot moved, laid on a map: how it lies, how it moved."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...poses.motions import between, twist
from ...scans import LaserScan
from ...scans.motion import motion_compensated
from .._result import Match
from ..points import AND_ACCELERATION, POSE_AND_VELOCITY, PointMap, in_range, match_moving, way

#: The velocity is supposed to change by so much from scan to scan in any case, metres and radians a
#: second: set before it was tried on the drives and hands that it was judged by.
LEAST_CHANGE = 0.05


class Moved(NamedTuple):
    """How a scan lies in the middle of its turn, carried there, and the motion `(6,)` then."""

    match: Match
    scan: LaserScan
    motion: Array


def turn_of(scan: LaserScan) -> float:
    """Seconds from the first beam to the last; 0 where beams have no times."""
    return 0.0 if scan.delays is None else float(scan.delays.max(initial=0.0))


def at_mid_turn(scan: LaserScan, motion: Array) -> LaserScan:
    """A scan as if all beams had been measured in the middle of its turn, by the motion then."""
    assert scan.delays is not None
    half = turn_of(scan) / 2
    still = motion_compensated(scan, way(motion, scan.delays - half))
    return replace(still, time=scan.time + half)


def even_motion(first: Array, second: Array, seconds: float) -> Array:
    """The motion `(6,)`, without acceleration, that leads from pose to pose in so many seconds."""
    return np.r_[twist(between(first, second)) / seconds, np.zeros(3)]


def laid_in_motion(
    map: PointMap, scan: LaserScan, start: Array, motion: Array, before: Array, overlap: float
) -> Moved:
    """A scan laid with an even motion, then with an uneven one.

    The uneven one counts where it holds as much of the scan. The motion that is supposed errs by
    what its velocity has changed since `before`, `(3,)`; along a direction that no wall faces the
    start holds.
    """
    assert scan.delays is not None
    change = np.abs(motion[:3] - before) + LEAST_CHANGE
    errors = np.r_[change, 2 * change / turn_of(scan)]
    since = (scan.delays - turn_of(scan) / 2)[scan.valid]
    ways, begin = [], start
    for unknowns in (POSE_AND_VELOCITY, AND_ACCELERATION):
        start, motion = match_moving(map, scan.points(), since, start, motion, errors, unknowns)
        still = at_mid_turn(scan, motion)
        points = in_range(still.points())
        match = map.register(points, start, overlap=overlap)
        if match.free is not None or match.turns:
            match = replace(match, pose=map.nearest(points, match.pose, begin))
        ways.append(Moved(match, still, motion))
    return max(reversed(ways), key=lambda moved: moved.match.overlap)
