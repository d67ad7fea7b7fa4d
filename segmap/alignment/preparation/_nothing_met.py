"""One number in many beams: drivers write it where a beam met nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...scans import LaserScan, Log
from ...scans.causes import Cause, Finding

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


class Look(NamedTuple):
    """What makes a number of a range."""

    width: float  # ranges this near are one number: metres ...
    relative_width: float  # ... or a share of it, if that is more
    share: float  # of all beams so many hold it
    about: float  # of the ranges within this share of it (10 cm at least) ...
    stands_out: float  # ... so many are the number
    largest: bool = False  # it is the largest of all ranges, else the most frequent


NUMBER_PATTERNS = (
    # Far from all others. No format writes finer steps than a millimetre.
    Look(0.001, 0.0, share=0.003, about=0.1, stands_out=0.98, largest=True),
    # With a jitter of some millimetres; most for 2 cm in real logs: 0.013, 34 in 100.
    Look(0.02, 0.002, share=0.12, about=0.02, stands_out=0.5),
    # Equal to the millimetre; most for one range in real logs: 0.004, 30 in 100.
    Look(0.001, 0.0, share=0.03, about=0.01, stands_out=0.3),
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
    for look in NUMBER_PATTERNS if len(known) else ():
        width = np.maximum(look.width, look.relative_width * known)
        begin, end = (np.searchsorted(known, known + side * width) for side in (-1, 1))
        most = len(known) - 1 if look.largest else int(np.argmax(end - begin))
        number, held = float(np.median(known[begin[most] : end[most]])), 2 * float(width[most])
        count = int((np.abs(known - number) <= held / 2).sum())
        others = known[np.abs(known - number) > held]
        about = (np.abs(known - number) <= max(0.1, look.about * number)).sum()
        edge = np.diff((np.abs(ranges - number) <= held).astype(np.int8)) != 0
        step = np.abs(np.diff(ranges))[edge]
        if (
            count >= max(look.share * len(ranges), look.stands_out * about)
            and (others < number).sum() > NEARER * len(others)
            and (step > DIFFERS * number).sum() > (step <= DIFFERS * number).sum()
        ):
            return number, held
    return None
