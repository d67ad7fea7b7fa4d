"""A scan of a laser that turned while the robot moved, laid on a map: how it lies, how it moved."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...poses.motions import arc, between, compose, transform, twist
from ...scans import LaserScan
from ...scans.motion import motion_compensated
from .._result import Match
from ..points import (
    AND_ACCELERATION,
    AND_JUMP,
    BENT_REACH_M,
    LAST,
    POSE_AND_VELOCITY,
    PointMap,
    decimate,
    in_range,
    match_moving,
    poses_at,
)

#: The velocity is supposed to change by so much from scan to scan in any case, metres and radians a
#: second: set before it was tried on the drives and hands that it was judged by.
LEAST_CHANGE = 0.05
#: A scan is held as far as its points lie so near to the map, metres.
HELD_M = 0.05
#: A jump of the velocity is sought where a larger share of the scan lies beside the map, not on it,
#: and counts where it holds so much more: less of a real scan is held by chance.
BENT_SHARE = 0.03
#: Jumps are sought at these moments, shares of a turn from its middle.
JUMP_MOMENTS = -0.3, 0.0, 0.3
#: Jumps are sought to these speeds, radians in a turn of the laser.
JUMP_TURNS_RAD = -0.7, -0.35, 0.0, 0.35, 0.7
#: Jumps are sought by so many points of a scan.
JUMP_POINTS = 100
#: A velocity jumps by so much (a standard deviation), metres, metres and radians a second.
JUMP_SIGMAS = 1.0, 1.0, 7.0

#: A pose `(3,)`, and a velocity `(3,)` or a motion `(7,)` there.
Pair = tuple[Array, Array]


class Laid(NamedTuple):
    """A scan laid by one motion: the share of it that is held, and its points in mid-turn."""

    held: float
    match: Match
    motion: Array
    points: Array


def turn_of(scan: LaserScan) -> float:
    """Seconds from the first beam to the last; 0 where beams have no times."""
    return 0.0 if scan.delays is None else float(scan.delays.max(initial=0.0))


def at_mid_turn(scan: LaserScan, motion: Array) -> LaserScan:
    """A scan as if all beams had been measured in the middle of its turn, by the motion then."""
    assert scan.delays is not None
    half = turn_of(scan) / 2
    still = motion_compensated(scan, poses_at(motion, scan.delays - half))
    return replace(still, time=scan.time + half)


def even_motion(first: Array, second: Array, seconds: float) -> Array:
    """The motion `(7,)`, without a change, that leads from pose to pose in so many seconds."""
    return np.r_[twist(between(first, second)) / seconds, np.zeros(3), np.nan]


def laid_in_motion(
    map: PointMap, scan: LaserScan, start: Array, motion: Array, steady: Pair, overlap: float
) -> tuple[Match, LaserScan, Array]:
    """A scan laid with an even motion, with an uneven one, and with one that jumps.

    The one that holds most of the scan counts, a jump where it holds `BENT_SHARE` more.
    Without a change pose and velocity were `steady`, `(3,)` each: the motion that is supposed errs
    by what its velocity has changed since, which stands until it jumps. Along a direction that no
    wall faces the start holds. Returned are how it lies in the middle of its turn, the scan carried
    there, and the motion `(7,)` then.
    """
    assert scan.delays is not None
    turn, points, ways = turn_of(scan), scan.points(), list[Laid]()
    since = (scan.delays - turn / 2)[scan.valid]

    def lay(unknowns: int, pose: Array, motion: Array, errors: Array) -> Pair:
        """The scan laid with so many unknowns: its pose and its motion."""
        pose, motion = match_moving(map, points, since, pose, motion, errors, unknowns)
        carried = in_range(transform(poses_at(motion, since), points[:, None])[:, 0])
        match = map.register(carried, pose, overlap=overlap)
        if match.free is not None or match.turns:
            match = replace(match, pose=map.slide_to(carried, match.pose, start))
        held = float(map.is_near(carried, match.pose, HELD_M).mean())
        ways.append(Laid(held, match, motion, carried))
        return pose, motion

    change = np.abs(motion[:3] - steady[1]) + LEAST_CHANGE
    errors = np.r_[change, 2 * change / turn, turn]
    lay(AND_ACCELERATION, *lay(POSE_AND_VELOCITY, start, motion, errors), errors)
    laid = max(reversed(ways), key=lambda way: way.held)
    if map.is_near(laid.points, laid.match.pose, BENT_REACH_M).mean() > laid.held + BENT_SHARE:
        errors = np.r_[np.full(3, LEAST_CHANGE), JUMP_SIGMAS, turn / 2]
        lay(AND_JUMP, *_likeliest_jump(map, points, since, steady, turn), errors)
        laid = ways[-1] if ways[-1].held > laid.held + BENT_SHARE else laid
    return laid.match, at_mid_turn(scan, laid.motion), laid.motion


def _likeliest_jump(map: PointMap, points: Array, since: Array, steady: Pair, turn: float) -> Pair:
    """The pose and the motion after which most of the points lie near the map."""
    pose, before = steady
    some = decimate(np.c_[since, points], JUMP_POINTS)
    since, points = some[:, 0], some[:, 1:]
    jumps = [
        np.r_[before, 0.0, 0.0, turned / turn - before[2], share * turn]
        for share, turned in product(JUMP_MOMENTS, JUMP_TURNS_RAD)
    ]
    motions, ways = np.array(jumps), np.stack([poses_at(jump, since) for jump in jumps])
    poses = compose(pose, arc(motions[:, 3:6] * np.maximum(-motions[:, 6:], 0.0)))
    ends = transform(compose(poses[:, None], ways), points[:, None])
    near = map.is_near(ends.reshape(-1, 2), np.zeros(3), LAST).reshape(len(jumps), -1)
    best = near.sum(1).argmax()
    return poses[best], motions[best]
