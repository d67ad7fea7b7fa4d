"""Beams that end where no wall is: a driver writes a number, or the limit, for nothing met."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...scans import Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import Steps
from ._pairs import (
    LEAST_COMPARISONS,
    NEAR_M,
    SEEN_THROUGH_M,
    compared,
    directions_of,
    with_beams,
)

#: Ranges this near are one number, metres.
NUMBER_M = 0.002
#: Where noise is laid on a number, ranges within this share of it are one.
RANGE_STEP = 0.01


def without_limit(log: Log, steps: Steps) -> Log:
    """A log with `inf` where beams end at a number that means nothing met, which is told.

    Such a beam moves with no wall: one looks through the point at which it ended, and the beam
    there is as long again. Ranges, by steps of one per cent, are no walls where most comparisons
    say so: 0.7 to 1.0 of such beams, at most 0.2 of walls; where most of these hold one number, it
    alone. Where nothing tells how the robot moved, and half of the beams have one range, that makes
    the map doubtful.
    """
    directions = directions_of(log)
    if not len(directions):
        return log
    pairs = compared(log, steps, directions)
    off_wall, off_limit = (np.abs(pairs.there - at) for at in (pairs.distance, pairs.seen))
    tells = (np.abs(pairs.distance - pairs.seen) > SEEN_THROUGH_M) & (pairs.seen > NEAR_M)
    tells &= np.minimum(off_wall, off_limit) < SEEN_THROUGH_M
    tells &= pairs.through | (off_wall < off_limit)
    steps_of_range, index = np.unique(_range_steps(pairs.seen[tells]), return_inverse=True)
    votes, limit = (np.bincount(index, which) for which in (None, (off_limit < off_wall)[tells]))
    limits = steps_of_range[(votes >= LEAST_COMPARISONS) & (limit > votes / 2)]
    ends = [np.isin(_range_steps(scan.ranges), limits) & scan.valid for scan in log]
    at_limit = np.concatenate([scan.ranges[end] for scan, end in zip(log, ends, strict=True)])
    if len(at_limit):
        number = float(np.median(at_limit))
        if np.median(np.abs(at_limit - number)) <= NUMBER_M:  # no noise is laid on it
            ends = [np.abs(scan.ranges - number) <= NUMBER_M for scan in log]
        share = 100 * sum(map(np.count_nonzero, ends)) / sum(map(len, log))
        words = f"a range of {number:.4g} m means nothing met: {share:.2g} % of all, with no wall"
        finding = Finding(Cause.NOTHING_MET, number, words)
        log = with_beams(log, ends, np.inf, finding)
    return _at_one_range(log)


def _range_steps(ranges: Array) -> NDArray[np.int64]:
    """Ranges of any shape in whole steps of one per cent; 0 where there is none."""
    positive = np.where(np.isfinite(ranges) & (ranges > 0), ranges, 1.0)
    return np.rint(np.log(positive) / RANGE_STEP).astype(np.int64)


def _at_one_range(log: Log) -> Log:
    """A log of which half of the beams have one range, told if no odometry says that it stands."""
    ranges = np.concatenate([scan.ranges[scan.valid] for scan in log])
    if not len(ranges):
        return log
    number = float(np.median(ranges))
    many = np.mean(np.abs(_range_steps(ranges) - _range_steps(np.array(number))) < 2)
    if number < NEAR_M or many < 0.5 or np.isfinite(log.odometry).all(1).any():
        return log
    words = f"half of the beams end {number:.3g} m away, and nothing tells whether walls are there"
    finding = Finding(Cause.NOTHING_MET, number, words, doubtful=True)
    return replace(log, causes=(*log.causes, finding))
