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
from ..points import (
    AND_ACCELERATION,
    AND_JUMP,
    POSE_AND_VELOCITY,
    PointMap,
    in_range,
    match_moving,
    way,
)

#: The velocity is supposed to change by so much from scan to scan in any case, metres and radians a
#: second: set before it was tried on the drives and hands that it was judged by.
LEAST_CHANGE = 0.05
#: A jump of the velocity is sought where a larger share of the scan is off the map, and counts
#: where it lays so much more of it there.
LEFT_OVER_SHARE = 0.05
#: Where in a turn a jump is sought first, shares of the turn from its middle.
JUMP_MOMENTS = 0.0, 0.25, -0.25
#: A velocity jumps by so much (a standard deviation), metres, metres and radians a second.
JUMP_SIGMAS = 1.0, 1.0, 7.0


class Moved(NamedTuple):
    """How a scan lies in the middle of its turn, carried there, and the motion `(7,)` then."""

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


def velocity_after(motion: Array, turn: float) -> Array:
    """The velocity `(3,)` at the end of a turn of so many seconds with such a motion `(7,)`."""
    return motion[:3] + motion[3:6] * (turn / 2 if np.isnan(motion[6]) else 1.0)


def even_motion(first: Array, second: Array, seconds: float) -> Array:
    """The motion `(7,)`, without a change, that leads from pose to pose in so many seconds."""
    return np.r_[twist(between(first, second)) / seconds, np.zeros(3), np.nan]


def laid_in_motion(
    map: PointMap, scan: LaserScan, start: Array, motion: Array, before: Array, overlap: float
) -> Moved:
    """A scan laid with an even motion, with an uneven one, and with one that jumps.

    The one that holds most of the scan counts, a jump where it holds `LEFT_OVER_SHARE` more. The
    motion that is supposed errs by what its velocity has changed since `before`, `(3,)`, which
    stands until it jumps; along a direction that no wall faces the start holds.
    """
    assert scan.delays is not None
    turn, ways = turn_of(scan), list[Moved]()
    since = (scan.delays - turn / 2)[scan.valid]

    def lay(unknowns: int, pose: Array, motion: Array, errors: Array) -> tuple[Array, Array]:
        """The scan laid with so many unknowns: its pose and its motion."""
        pose, motion = match_moving(map, scan.points(), since, pose, motion, errors, unknowns)
        still = at_mid_turn(scan, motion)
        points = in_range(still.points())
        match = map.register(points, pose, overlap=overlap)
        if match.free is not None or match.turns:
            match = replace(match, pose=map.nearest(points, match.pose, start))
        ways.append(Moved(match, still, motion))
        return pose, motion

    change = np.abs(motion[:3] - before) + LEAST_CHANGE
    errors = np.r_[change, 2 * change / turn, turn]
    pose, _ = lay(AND_ACCELERATION, *lay(POSE_AND_VELOCITY, start, motion, errors), errors)
    errors = np.r_[np.full(3, LEAST_CHANGE), JUMP_SIGMAS, turn / 2]
    smooth = max(reversed(ways), key=lambda moved: moved.match.overlap)
    for share in JUMP_MOMENTS:
        if max(each.match.overlap for each in ways) >= 1 - LEFT_OVER_SHARE:
            break
        lay(AND_JUMP, pose, np.r_[before, np.zeros(3), share * turn], errors)
    best = max(ways, key=lambda moved: moved.match.overlap)
    return best if best.match.overlap > smooth.match.overlap + LEFT_OVER_SHARE else smooth
