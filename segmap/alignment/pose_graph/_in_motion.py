"""A scan of a laser that turned while the robot moved, laid on a map: how it lies, how it moved."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from ...arrays import Array
from ...poses.motions import arc, between, compose, transform, twist
from ...scans import LaserScan
from ...scans.motion import motion_compensated
from .._result import Match
from ..points import (
    AND_ACCELERATION,
    AND_JUMP,
    LAST,
    POSE_AND_VELOCITY,
    PointMap,
    in_range,
    match_moving,
    thinned,
    way,
)

#: The velocity is supposed to change by so much from scan to scan in any case, metres and radians a
#: second: set before it was tried on the drives and hands that it was judged by.
LEAST_CHANGE = 0.05
#: A scan is held as far as its points lie so near to the map, metres.
HELD_M = 0.05
#: A jump of the velocity is sought where a larger share of the scan is not held, and counts where
#: it holds so much more.
LEFT_OVER_SHARE = 0.01
#: Where in a turn a jump is sought, shares of the turn from its middle, and to which turns a scan.
JUMP_MOMENTS = -0.3, 0.0, 0.3
JUMP_TURNS_RAD = -0.7, -0.35, 0.0, 0.35, 0.7
#: By so many points of the scan.
JUMP_POINTS = 100
#: A velocity jumps by so much (a standard deviation), metres, metres and radians a second.
JUMP_SIGMAS = 1.0, 1.0, 7.0

Pair = tuple[Array, Array]


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
    map: PointMap, scan: LaserScan, start: Array, motion: Array, steady: Pair, overlap: float
) -> tuple[Match, LaserScan, Array]:
    """A scan laid with an even motion, with an uneven one, and with one that jumps.

    The one that holds most of the scan counts, a jump where it holds `LEFT_OVER_SHARE` more.
    Without a change pose and velocity were `steady`, `(3,)` each: the motion that is supposed errs
    by what its velocity has changed since, which stands until it jumps. Along a direction that no
    wall faces the start holds. Returned are how it lies in the middle of its turn, the scan carried
    there, and the motion `(7,)` then.
    """
    assert scan.delays is not None
    turn, points, ways = turn_of(scan), scan.points(), list[tuple[float, Match, Array]]()
    since = (scan.delays - turn / 2)[scan.valid]

    def lay(unknowns: int, pose: Array, motion: Array, errors: Array) -> Pair:
        """The scan laid with so many unknowns: its pose and its motion."""
        pose, motion = match_moving(map, points, since, pose, motion, errors, unknowns)
        carried = in_range(transform(way(motion, since), points[:, None])[:, 0])
        match = map.register(carried, pose, overlap=overlap)
        if match.free is not None or match.turns:
            match = replace(match, pose=map.nearest(carried, match.pose, start))
        ways.append((float(map.near(carried, match.pose, HELD_M).mean()), match, motion))
        return pose, motion

    change = np.abs(motion[:3] - steady[1]) + LEAST_CHANGE
    errors = np.r_[change, 2 * change / turn, turn]
    lay(AND_ACCELERATION, *lay(POSE_AND_VELOCITY, start, motion, errors), errors)
    held, match, motion = max(reversed(ways), key=lambda way: way[0])
    if held < 1 - LEFT_OVER_SHARE:
        errors = np.r_[np.full(3, LEAST_CHANGE), JUMP_SIGMAS, turn / 2]
        lay(AND_JUMP, *_likeliest_jump(map, points, since, steady, turn), errors)
        if ways[-1][0] > held + LEFT_OVER_SHARE:
            _, match, motion = ways[-1]
    return match, at_mid_turn(scan, motion), motion


def _likeliest_jump(map: PointMap, points: Array, since: Array, steady: Pair, turn: float) -> Pair:
    """The pose and the motion after which most of the points lie near the map."""
    expected, before = steady
    some, tried = thinned(np.c_[since, points], JUMP_POINTS), list[tuple[float, Array, Array]]()
    since, points = some[:, 0], some[:, 1:]
    for share, turned in product(JUMP_MOMENTS, JUMP_TURNS_RAD):
        motion = np.r_[before, 0.0, 0.0, turned / turn - before[2], share * turn]
        pose = compose(expected, arc(motion[3:6] * max(-motion[6], 0.0)))
        carried = transform(way(motion, since), points[:, None])[:, 0]
        tried.append((float(map.near(carried, pose, LAST).mean()), pose, motion))
    return max(tried, key=lambda each: each[0])[1:]
