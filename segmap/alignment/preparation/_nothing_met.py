"""One number in many beams: drivers write it where a beam met nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...scans import Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import Steps
from ._changed import with_beams
from ._pairs import (
    LEAST_COMPARISONS,
    NEAR_M,
    SEEN_THROUGH_M,
    compare,
    directions_of,
)

#: Scans that are looked at, spread over the log.
NOTHING_MET_SCANS = 200
#: A number that means "nothing met" occurs in at least this share of all beams.
MET_BEAMS_SHARE = 0.03
#: Half of the beams beside those that hold it differ by this share of it. Those beside a part of a
#: wall at one distance go on from it.
DIFFERS = 0.02
#: Ranges this near are one number, metres.
NUMBER_M = 0.002
#: Where noise is laid on the number, ranges within this share of it are one number.
RANGE_STEP = 0.01


def without_nothing_met(log: Log) -> Log:
    """A log whose beams hold `inf` where a driver wrote a number for "nothing met", which is told.

    Such a number is farther than what rides with the robot, and is met beside beams that see
    something else. A driver may have several.
    """
    some = log[:: 1 + len(log) // NOTHING_MET_SCANS]
    ranges = np.concatenate([np.empty(0), *(np.where(s.valid, s.ranges, np.nan) for s in some)])
    causes: list[Finding] = []
    while (number := _number_among(ranges)) is not None:
        holds = np.abs(ranges - number) <= NUMBER_M
        words = f"a range of {number:.5g} m means nothing met: {100 * holds.mean():.2g} % of all"
        causes.append(Finding(Cause.NOTHING_MET, number, words))
        ranges = np.where(holds, np.nan, ranges)
    if not causes:
        return log
    numbers = np.array([finding.value for finding in causes])
    masks = ((np.abs(s.ranges[:, None] - numbers) <= NUMBER_M).any(1) & s.valid for s in log)
    return with_beams(log, masks, np.inf, *causes)


def _number_among(ranges: Array) -> float | None:
    """The most frequent of ranges `(m,)`, NaN where invalid, where it is a number and no wall."""
    measured = np.sort(ranges[np.isfinite(ranges)])
    if not len(measured):
        return None
    begin, end = (np.searchsorted(measured, measured + side * NUMBER_M / 2) for side in (-1, 1))
    most = int(np.argmax(end - begin))
    number = float(np.median(measured[begin[most] : end[most]]))
    holds = np.abs(ranges - number) <= NUMBER_M
    step = np.abs(np.diff(ranges))[np.diff(holds.astype(np.int8)) != 0]
    is_number = (
        np.count_nonzero(holds) >= MET_BEAMS_SHARE * len(ranges)
        and number > NEAR_M
        and (step > DIFFERS * number).sum() > (step <= DIFFERS * number).sum()
    )
    return number if is_number else None


def without_limit(log: Log, steps: Steps) -> Log:
    """Replace ranges at the laser's limit, with noise on them, by `inf`, and report it.

    From another pose, the end of such a beam is not a wall: other beams pass through it, and end at
    the same range. Ranges, by steps of one per cent, are at the limit if most comparisons say so:
    0.7 to 1.0 of such beams, at most 0.2 of walls. Without odometry, half of the beams at one range
    make the map doubtful.
    """
    directions = directions_of(log)
    if not len(directions):
        return log
    pairs = compare(log, steps, directions)
    off_wall, off_limit = (np.abs(pairs.there - at) for at in (pairs.distance, pairs.seen))
    tells = (np.abs(pairs.distance - pairs.seen) > SEEN_THROUGH_M) & (pairs.seen > NEAR_M)
    tells &= np.minimum(off_wall, off_limit) < SEEN_THROUGH_M
    tells &= pairs.through | (off_wall < off_limit)
    steps_of_range, index = np.unique(_range_steps(pairs.seen[tells]), return_inverse=True)
    votes, against = (np.bincount(index, which) for which in (None, (off_limit < off_wall)[tells]))
    limit_steps = steps_of_range[(votes >= LEAST_COMPARISONS) & (against > votes / 2)]
    masks = [np.isin(_range_steps(scan.ranges), limit_steps) & scan.valid for scan in log]
    at_limit = np.concatenate([scan.ranges[mask] for scan, mask in zip(log, masks, strict=True)])
    if len(at_limit):
        number, share = float(np.median(at_limit)), 100 * len(at_limit) / sum(map(len, log))
        words = f"a range about {number:.4g} m means nothing met: {share:.2g} % of all"
        finding = Finding(Cause.NOTHING_MET, number, f"{words}, with no wall")
        log = with_beams(log, masks, np.inf, finding)
    return _at_one_range(log)


def _range_steps(ranges: Array) -> NDArray[np.int64]:
    """Ranges of any shape in whole steps of one per cent; 0 where there is none."""
    positive = np.where(np.isfinite(ranges) & (ranges > 0), ranges, 1.0)
    return np.rint(np.log(positive) / RANGE_STEP).astype(np.int64)


def _at_one_range(log: Log) -> Log:
    """The log, with a finding if half of its beams have one range and it has no odometry."""
    ranges = np.concatenate([scan.ranges[scan.valid] for scan in log])
    if not len(ranges) or np.isfinite(log.odometry).all(1).any():
        return log
    number = float(np.median(ranges))
    many = np.mean(np.abs(_range_steps(ranges) - _range_steps(np.array(number))) < 2)
    if number < NEAR_M or many < 0.5:
        return log
    words = f"half of the beams end {number:.3g} m away, and nothing tells whether walls are there"
    finding = Finding(Cause.NOTHING_MET, number, words, doubtful=True)
    return replace(log, causes=(*log.causes, finding))
