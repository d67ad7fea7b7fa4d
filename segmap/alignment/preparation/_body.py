"""Beams that see what rides with the robot: its own posts, a cable, a person who walks along."""

from __future__ import annotations

from dataclasses import replace
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses.motions import between, compose, inverse
from ...scans import LaserScan, Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import Steps, odometry_against_steps
from ._blind_steps import blind_steps
from ._odometry import WAY_RATIOS

#: Ways of the robot between two scans that are compared, metres; a turn counts by `TURN_LEVER_M`.
PAIR_WAYS_M = (0.15, 0.3, 0.6)
TURN_LEVER_M = 0.6
#: Nothing that rides is farther away than this.
NEAR_M = 3.0
#: A range that changes by less is the same.
SAME_RANGE_M = 0.05
#: A beam that goes on behind a point for so much looks through it; a range that changes by so much
#: is another.
SEEN_THROUGH_M = 0.15
#: All beams this near to its direction must: along a wall, a heading that errs moves its points.
SEEN_THROUGH_RAD = np.radians(3)
#: A direction is compared at least so many times.
LEAST_COMPARISONS = 30
#: What rides is the same and looked through in this share of them.
RIDES_SHARE = 0.7


def without_body(log: Log, steps: Steps) -> Log:
    """A log without the beams that see what rides with the robot: they are NaN, and it is told.

    A beam that rides has the same range while the robot moves or turns, by its odometry where the
    matched `steps` agree with its way, else by these steps. Walls along which the robot drives keep
    their range too; but their points are seen again from the second scan, where one looks through
    the point at which something that rides was. So a direction is left out where at least 0.7 of 30
    comparisons and more say *same range, and looked through* instead of *another range*: 0.95 to
    1.0 of posts, boxes and persons, 0 of walls; a pane of glass along the drive has 0.75. That is
    beside it is left out too, since half of a beam may see it.

    Where neither odometry nor matches say that the robot moved, nothing is left out. If what is
    near stands still for the laser, and the rest of the scans moves, that is told.
    """
    angles = max((scan.angles for scan in log), key=len, default=np.empty(0))
    step = float(np.median(np.diff(angles))) if len(angles) > 2 else 0.0
    if step == 0:
        return log
    directions = angles[0] + step * np.arange(round(2 * np.pi / abs(step)))
    first, second, motion = _pairs(log, steps)
    place = np.reshape([log[int(k)].sensor_pose for k in first], (-1, 3))
    motion = compose(compose(inverse(place), motion), place)
    one, two = (_ranges(log[ends], directions) for ends in (first, second))
    rides, differs = _rides(one, two, inverse(motion), directions)
    rides, differs = np.add((rides, differs), _rides(two, one, motion, directions))
    body = (rides + differs >= LEAST_COMPARISONS) & (rides >= RIDES_SHARE * (rides + differs))
    if not body.any():
        return log if len(first) >= LEAST_COMPARISONS else _seems_to_ride(log, steps, directions)
    wide = body | np.roll(body, 1) | np.roll(body, -1)
    known = (~np.isnan(np.vstack([one, two]))).any(0)
    words = f"{(body & known).sum()} of {known.sum()} beams see the robot itself"
    told = Finding(Cause.BODY, int((body & known).sum()), words, "--keep-body keeps them")
    scans = tuple(_without(scan, wide, directions) for scan in log)
    return replace(log, scans=scans, causes=(*log.causes, told))


def _pairs(log: Log, steps: Steps) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Scans between which the robot moved, and how: by the odometry, else by the steps."""
    rows, way = log.odometry, odometry_against_steps(log.odometry, steps).way
    first, second, motion = steps[:3]
    known = np.flatnonzero(np.isfinite(rows).all(1))
    if len(known) and not (way < WAY_RATIOS[0] or way > WAY_RATIOS[1]):
        at = np.r_[0.0, np.cumsum(_way(between(rows[known[:-1]], rows[known[1:]])))]
        start = np.unique(np.searchsorted(at, np.linspace(0, at[-1], 100)))
        first = np.tile(start, len(PAIR_WAYS_M))
        second = np.searchsorted(at, np.concatenate([at[start] + far for far in PAIR_WAYS_M]))
        first, second = known[first[second < len(known)]], known[second[second < len(known)]]
        motion = between(rows[first], rows[second])
    moves = (_way(motion) > PAIR_WAYS_M[0] / 2) & (_way(motion) < 2 * PAIR_WAYS_M[-1])
    return first[moves], second[moves], motion[moves]


def _way(motion: Array) -> Array:
    """How far motions `(m, 3)` go, turns included, `(m,)`, metres."""
    return np.hypot(motion[:, 0], motion[:, 1]) + TURN_LEVER_M * np.abs(motion[:, 2])


def _columns(angles: Array, directions: Array) -> NDArray[np.int64]:
    """Where angles of any shape stand among the directions `(n,)`, which go all round."""
    step = directions[1] - directions[0]
    return np.rint((angles - directions[0]) / step).astype(np.int64) % len(directions)


def _ranges(scans: Log, directions: Array) -> Array:
    """`(k, n)`, metres; inf where nothing was met, NaN where nothing is known."""
    table = np.full((len(scans), len(directions)), np.nan)
    for row, scan in zip(table, scans, strict=True):
        met = np.where(scan.ranges >= scan.max_range, np.inf, scan.ranges)
        row[_columns(scan.angles, directions)] = np.where(met > 0, met, np.nan)
    return table


def _rides(one: Array, two: Array, pose: Array, directions: Array) -> NDArray[np.int64]:
    """How often each beam has the same range and is looked through, and another, `(2, n)`.

    `one` and `two` are ranges `(p, n)` of pairs of scans, and `pose`, `(p, 3)`, is that of the
    first laser in the frame of the second.
    """
    seen = np.where(one < NEAR_M, one, np.nan)
    x, y, turn = (column[:, None] for column in pose.T)
    x, y = x + seen * np.cos(directions + turn), y + seen * np.sin(directions + turn)
    beside = round(SEEN_THROUGH_RAD / abs(directions[1] - directions[0]))
    nearest = reduce(np.fmin, (np.roll(two, k, 1) for k in range(-beside, beside + 1)))
    at = _columns(np.nan_to_num(np.arctan2(y, x)), directions)
    through = np.take_along_axis(nearest, at, 1) - np.hypot(x, y) > SEEN_THROUGH_M
    change = np.abs(two - seen)
    return np.stack([(through & (change < SAME_RANGE_M)).sum(0), (change > SEEN_THROUGH_M).sum(0)])


def _without(scan: LaserScan, body: NDArray[np.bool_], directions: Array) -> LaserScan:
    """A scan with NaN in the directions `(n,)` of the body."""
    return replace(
        scan, ranges=np.where(body[_columns(scan.angles, directions)], np.nan, scan.ranges)
    )


def _seems_to_ride(log: Log, steps: Steps, directions: Array) -> Log:
    """A log in which something near hardly changes, told if the scans move without it."""
    ranges = _ranges(log, directions)
    middle = np.median(np.where(np.isnan(ranges), np.inf, ranges), 0)
    still = np.isclose(ranges, middle, 0, SAME_RANGE_M).mean(0) > RIDES_SHARE
    still &= middle < NEAR_M
    if not still.any() or len(steps.first) < LEAST_COMPARISONS:
        return log
    rest = replace(log, scans=tuple(_without(scan, still, directions) for scan in log))
    if np.median([0.0, *_way(blind_steps(rest).motion)]) < PAIR_WAYS_M[0] / 2:
        return log
    words = "something near stands still for the laser while the rest of the scans moves"
    why = "it may be the robot itself, and neither odometry nor turns tell"
    told = Finding(Cause.BODY, int(still.sum()), f"{words}: {why}", "--mask FROM:TO", doubtful=True)
    return replace(log, causes=(*log.causes, told))
