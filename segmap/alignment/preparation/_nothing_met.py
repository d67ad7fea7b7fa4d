"""One number in many beams: drivers write it where a beam met nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...scans import LaserScan, Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import Steps
from ._pairs import LEAST_COMPARISONS, NEAR_M, SEEN_THROUGH_M, compared, directions_of

#: Scans that are looked at, spread over the log.
NOTHING_MET_SCANS = 200
#: A number that means "nothing met" occurs in this share of the scans.
MET_IN_SHARE = 0.25
#: Fewer scans do not tell.
LEAST_TELLING_SCANS = 10
#: So many other ranges are nearer: what rides with the robot is the nearest of all.
NEARER = 0.25
#: Half of the beams beside those that hold it differ by this share of it. Those beside a part of a
#: wall at one distance go on from it.
DIFFERS = 0.02
#: Ranges this near are one, as a share of them.
RANGE_STEP = 0.01


class Look(NamedTuple):
    """What makes a number of a range."""

    width: float  # ranges this near are one number, metres
    share: float  # of all beams so many hold it
    about: float  # of the ranges within this share of it (10 cm at least) ...
    stands_out: float  # ... so many are the number
    largest: bool = False  # it is the largest of all ranges, else the most frequent


NUMBER_PATTERNS = (
    # Far from all others, with a jitter of some millimetres.
    Look(0.02, share=0.003, about=0.1, stands_out=0.98, largest=True),
    # Equal to the millimetre; most for one range in real logs: 0.004, 30 in 100.
    Look(0.001, share=0.03, about=0.01, stands_out=0.3),
)


def without_nothing_met(log: Log) -> Log:
    """A log whose beams hold `inf` where a driver wrote a number for "nothing met", which is told.

    Such a number stands out among the ranges, is none of the nearest, and is met in many scans
    beside beams that see something else. A driver may have several.
    """
    if len(log) < LEAST_TELLING_SCANS:
        return log
    some = log[:: 1 + len(log) // NOTHING_MET_SCANS]
    ranges = np.concatenate([np.empty(0), *(np.where(s.valid, s.ranges, np.nan) for s in some)])
    scan = np.repeat(np.arange(len(some)), [len(s) for s in some])
    causes, numbers = list(log.causes), []
    while (told := _number_among(ranges)) is not None:
        number, width = told
        holds = np.abs(ranges - number) <= width
        if len(np.unique(scan[holds])) < MET_IN_SHARE * len(some):
            break
        words = f"a range of {number:.5g} m means nothing met: {100 * holds.mean():.2g} % of all"
        causes.append(Finding(Cause.NOTHING_MET, number, words))
        numbers.append(told)
        ranges = np.where(holds, np.nan, ranges)
    if not numbers:
        return log

    def put_right(scan: LaserScan) -> LaserScan:
        """The scan with `inf` for each number."""
        holds = [np.abs(scan.ranges - number) <= width for number, width in numbers]
        return replace(scan, ranges=np.where(np.any(holds, 0) & scan.valid, np.inf, scan.ranges))

    return replace(log, scans=tuple(map(put_right, log)), causes=tuple(causes))


def _number_among(ranges: Array) -> tuple[float, float] | None:
    """A number among ranges `(m,)`, NaN where invalid, and how far off it is held, metres."""
    known = np.sort(ranges[np.isfinite(ranges)])
    grid = float(np.median(np.diff(np.unique(known)))) if len(known) > 1 else 0.0
    for look in NUMBER_PATTERNS if len(known) else ():
        begin, end = (np.searchsorted(known, known + side * look.width) for side in (-1, 1))
        most = len(known) - 1 if look.largest else int(np.argmax(end - begin))
        number, held = float(np.median(known[begin[most] : end[most]])), 2 * look.width
        count = int((np.abs(known - number) <= held / 2).sum())
        others = known[np.abs(known - number) > held]
        wide = max(0.1, look.about * number, 5 * grid)
        about = (np.abs(known - number) <= wide).sum()
        edge = np.diff((np.abs(ranges - number) <= held).astype(np.int8)) != 0
        step = np.abs(np.diff(ranges))[edge]
        if (
            count >= max(look.share * len(ranges), look.stands_out * about)
            and (others < number).sum() > NEARER * len(others)
            and (step > DIFFERS * number).sum() > (step <= DIFFERS * number).sum()
        ):
            return number, held
    return None


def without_limit(log: Log, steps: Steps) -> Log:
    """A log with `inf` where beams end at the laser's limit and noise is laid on it, which is told.

    Such a beam moves with no wall: one looks through the point at which it ended, and the beam
    there is as long again. Ranges, by steps of one per cent, are no walls where most comparisons
    say so: 0.7 to 1.0 of such beams, at most 0.2 of walls. Where nothing tells how the robot moved,
    and half of the beams have one range, that makes the map doubtful.
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
    if (count := int(sum(map(np.sum, ends)))) == 0:
        return _at_one_range(log)
    number = float(np.median(np.concatenate([s.ranges[e] for s, e in zip(log, ends, strict=True)])))
    share = 100 * count / sum(map(len, log))
    words = f"a range about {number:.4g} m means nothing met: {share:.2g} % of all, with no wall"
    scans = (
        replace(scan, ranges=np.where(end, np.inf, scan.ranges))
        for scan, end in zip(log, ends, strict=True)
    )
    told = Finding(Cause.NOTHING_MET, number, words)
    return replace(log, scans=tuple(scans), causes=(*log.causes, told))


def _range_steps(ranges: Array) -> NDArray[np.int64]:
    """Ranges of any shape in whole steps of one per cent; 0 where there is none."""
    known = np.where(np.isfinite(ranges) & (ranges > 0), ranges, 1.0)
    return np.rint(np.log(known) / RANGE_STEP).astype(np.int64)


def _at_one_range(log: Log) -> Log:
    """A log of which half of the beams have one range, told if no odometry says that it stands."""
    ranges = np.concatenate([np.empty(0), *(scan.ranges[scan.valid] for scan in log)])
    if not len(ranges):
        return log
    number = float(np.median(ranges))
    many = np.mean(np.abs(_range_steps(ranges) - _range_steps(np.array(number))) < 2)
    if number < NEAR_M or many < 0.5 or np.isfinite(log.odometry).all(1).any():
        return log
    words = (
        f"half of the beams end {number:.3g} m away, and nothing tells whether walls stand there"
    )
    told = Finding(Cause.NOTHING_MET, number, words, doubtful=True)
    return replace(log, causes=(*log.causes, told))
