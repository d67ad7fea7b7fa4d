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
from ..points import EVEN, UNEVEN, PointMap, in_range, match_moving, way

#: A motion changes by so much from scan to scan in any case, metres and radians a second.
LEAST_CHANGE = 0.05


class Moved(NamedTuple):
    """How a scan lies in the middle of its turn, carried there, and the motion `(6,)` then."""

    match: Match
    scan: LaserScan
    motion: Array


def at_mid_turn(scan: LaserScan, motion: Array) -> LaserScan:
    """A scan as if all beams had been measured in the middle of its turn, by the motion then."""
    assert scan.delays is not None
    half = float(scan.delays.max()) / 2
    still = motion_compensated(scan, way(motion, scan.delays - half))
    return replace(still, time=scan.time + half)


def even_motion(first: Array, second: Array, seconds: float) -> Array:
    """The motion `(6,)`, without acceleration, that leads from pose to pose in so many seconds."""
    return np.r_[twist(between(first, second)) / seconds, np.zeros(3)]


def laid_in_motion(
    map: PointMap, scan: LaserScan, start: Array, motion: Array, before: Array, overlap: float
) -> Moved:
    """A scan laid with an even motion, then with an uneven one.

    The motion that is supposed errs by what it has changed since the one `before`, `(3,)`.
    The uneven one counts where it holds as much of the scan: of a thousand scans one finds a false
    place so.
    """
    assert scan.delays is not None
    turn = float(scan.delays.max())
    change = np.abs(motion[:3] - before) + LEAST_CHANGE
    errors = np.r_[change, 2 * change / turn]
    since = (scan.delays - scan.delays.max() / 2)[scan.valid]
    ways = []
    for unknowns in (EVEN, UNEVEN):
        start, motion = match_moving(map, scan.points(), since, start, motion, errors, unknowns)
        still = at_mid_turn(scan, motion)
        match = map.register(in_range(still.points()), start, overlap=overlap)
        ways.append(Moved(match, still, motion))
    return max(reversed(ways), key=lambda moved: moved.match.overlap)
