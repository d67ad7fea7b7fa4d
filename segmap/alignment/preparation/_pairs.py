"""Pairs of scans between which the robot moved, and what the second sees of the first's points."""

from __future__ import annotations

from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses.motions import between, compose, inverse
from ...scans import Log
from ...scans.odometry import CONTRADICTING_COSINE, Steps, odometry_against_steps
from ._odometry import WAY_RATIOS

#: Ways of the robot between two scans that are compared, metres; a turn counts by `TURN_LEVER_M`.
PAIR_WAYS_M = (0.15, 0.3, 0.6)
TURN_LEVER_M = 0.6
#: Nothing that rides with the robot is farther away than this.
NEAR_M = 3.0
#: A beam that goes on behind a point for so much looks through it; a range that changes by so much
#: is another.
SEEN_THROUGH_M = 0.15
#: All beams this near to the direction of such a beam must look through too: along a wall, a
#: heading that errs moves its points.
SEEN_THROUGH_RAD = np.radians(3)
#: Fewer comparisons of a direction tell nothing.
LEAST_COMPARISONS = 30
#: What moves with the robot does so in this share of the comparisons.
RIDES_SHARE = 0.7


class Compared(NamedTuple):
    """Beams of one scan of each pair against the other scan, `(2 p, n)`; NaN if unknown."""

    seen: Array  # the range, metres
    same_beam: Array  # range of the beam in the same direction of the other laser
    distance: Array  # distance of the point from the other laser
    there: Array  # the range of the beam towards the point
    through: NDArray[np.bool_]  # whether all beams near that go on behind the point


def directions_of(log: Log) -> Array:
    """Equal directions all round for the beams of a log, `(n,)`, radians; none where it has one."""
    angles = max((scan.angles for scan in log), key=len, default=np.empty(0))
    step = float(np.median(np.diff(angles))) if len(angles) > 2 else 0.0
    return angles[0] + step * np.arange(round(2 * np.pi / abs(step))) if step else np.empty(0)


def columns(angles: Array, directions: Array) -> NDArray[np.int64]:
    """Where angles of any shape stand among the directions `(n,)`."""
    step = directions[1] - directions[0]
    return np.rint((angles - directions[0]) / step).astype(np.int64) % len(directions)


def ranges_by_direction(scans: Log, directions: Array) -> Array:
    """`(k, n)`, metres; inf where nothing was met, NaN where nothing is known."""
    table = np.full((len(scans), len(directions)), np.nan)
    for row, scan in zip(table, scans, strict=True):
        met = np.where(scan.ranges >= scan.max_range, np.inf, scan.ranges)
        row[columns(scan.angles, directions)] = np.where(met > 0, met, np.nan)
    return table


def compare(log: Log, steps: Steps, directions: Array) -> Compared:
    """All pairs of scans of a log, each seen from both sides."""
    first, second, motion = _pairs(log, steps)
    place = np.reshape([log[int(k)].sensor_pose for k in first], (-1, 3))
    motion = compose(compose(inverse(place), motion), place)
    one, two = (ranges_by_direction(log[ends], directions) for ends in (first, second))
    sides = zip(_compare_one_way(one, two, inverse(motion), directions),
                _compare_one_way(two, one, motion, directions), strict=True)  # fmt: skip
    return Compared(*(np.vstack(both) for both in sides))


def _compare_one_way(one: Array, two: Array, pose: Array, directions: Array) -> Compared:
    """Ranges `(p, n)` against others; poses `(p, 3)` of the first laser in the second's frame."""
    x, y, turn = (column[:, None] for column in pose.T)
    seen = np.where(np.isfinite(one), one, np.nan)
    x, y = x + seen * np.cos(directions + turn), y + seen * np.sin(directions + turn)
    beside = round(SEEN_THROUGH_RAD / abs(directions[1] - directions[0]))
    nearest = reduce(np.fmin, (np.roll(two, k, 1) for k in range(-beside, beside + 1)))
    at = columns(np.nan_to_num(np.arctan2(y, x)), directions)
    distance, there = np.hypot(x, y), np.take_along_axis(two, at, 1)
    through = np.take_along_axis(nearest, at, 1) - distance > SEEN_THROUGH_M
    return Compared(seen, two, distance, there, through)


def _pairs(log: Log, steps: Steps) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Scans between which the robot moved, and how: by the odometry, else by the steps."""
    rows, against = log.odometry, odometry_against_steps(log.odometry, steps)
    wrong = against.way < WAY_RATIOS[0] or against.way > WAY_RATIOS[1]
    first, second, motion = steps[:3]
    valid = np.flatnonzero(np.isfinite(rows).all(1))
    if len(valid) and not (wrong or against.agreement < CONTRADICTING_COSINE):
        at = np.r_[0.0, np.cumsum(way_of(between(rows[valid[:-1]], rows[valid[1:]])))]
        start = np.unique(np.searchsorted(at, np.linspace(0, at[-1], 100)))
        first = np.tile(start, len(PAIR_WAYS_M))
        second = np.searchsorted(at, np.concatenate([at[start] + far for far in PAIR_WAYS_M]))
        first, second = valid[first[second < len(valid)]], valid[second[second < len(valid)]]
        motion = between(rows[first], rows[second])
    moves = (way_of(motion) > PAIR_WAYS_M[0] / 2) & (way_of(motion) < 2 * PAIR_WAYS_M[-1])
    return first[moves], second[moves], motion[moves]


def way_of(motion: Array) -> Array:
    """How far motions `(m, 3)` go, turns included, `(m,)`, metres."""
    return np.hypot(motion[:, 0], motion[:, 1]) + TURN_LEVER_M * np.abs(motion[:, 2])
