"""A scan of a laser that turned while the robot moved, laid on a map: how it lies, how it moved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import Array
from ...poses.motions import between, transform, twist
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
#: Where in a turn a jump is sought, shares of the turn from its middle: at the others where the
#: first holds more and something is left over.
JUMP_MOMENTS = 0.0, 0.25, -0.25
#: A velocity jumps by so much (a standard deviation), metres, metres and radians a second.
JUMP_SIGMAS = 1.0, 1.0, 7.0


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
    """The motion `(7,)`, without a change, that leads from pose to pose in so many seconds."""
    return np.r_[twist(between(first, second)) / seconds, np.zeros(3), np.nan]


def laid_in_motion(
    map: PointMap, scan: LaserScan, start: Array, motion: Array, before: Array, overlap: float
) -> tuple[Match, LaserScan, Array]:
    """A scan laid with an even motion, with an uneven one, and with one that jumps.

    The one that holds most of the scan counts, a jump where it holds `LEFT_OVER_SHARE` more. The
    motion that is supposed errs by what its velocity has changed since `before`, `(3,)`, which
    stands until it jumps; along a direction that no wall faces the start holds. Returned are how it
    lies in the middle of its turn, the scan carried there, and the motion `(7,)` then.
    """
    assert scan.delays is not None
    turn, points, ways = turn_of(scan), scan.points(), list[tuple[Match, Array]]()
    since = (scan.delays - turn / 2)[scan.valid]

    def lay(unknowns: int, pose: Array, motion: Array, errors: Array) -> tuple[Array, Array]:
        """The scan laid with so many unknowns: its pose and its motion."""
        pose, motion = match_moving(map, points, since, pose, motion, errors, unknowns)
        carried = in_range(transform(way(motion, since), points[:, None])[:, 0])
        match = map.register(carried, pose, overlap=overlap)
        if match.free is not None or match.turns:
            match = replace(match, pose=map.nearest(carried, match.pose, start))
        ways.append((match, motion))
        return pose, motion

    change = np.abs(motion[:3] - before) + LEAST_CHANGE
    errors = np.r_[change, 2 * change / turn, turn]
    pose, _ = lay(AND_ACCELERATION, *lay(POSE_AND_VELOCITY, start, motion, errors), errors)
    errors = np.r_[np.full(3, LEAST_CHANGE), JUMP_SIGMAS, turn / 2]
    smooth = best = max(reversed(ways), key=lambda each: each[0].overlap)
    for share in JUMP_MOMENTS:
        if best[0].overlap >= 1 - LEFT_OVER_SHARE:
            break
        lay(AND_JUMP, pose, np.r_[before, np.zeros(3), share * turn], errors)
        best = max(best, ways[-1], key=lambda each: each[0].overlap)
        if best is smooth:  # a jump seldom holds more at another moment then, and each is a match
            break
    match, motion = best if best[0].overlap > smooth[0].overlap + LEFT_OVER_SHARE else smooth
    return match, at_mid_turn(scan, motion), motion
