"""Ranges that no laser for buildings measures: they are in another unit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...scans import Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import odometry_against_steps
from ._blind_steps import blind_steps
from ._odometry import WAY_RATIOS

#: Half of the ranges are never above this in metres.
LONGEST_M = 100.0
#: Units that ranges are taken for, with the metres of each; millimetres where half are above a km.
RANGE_UNITS = {"centimetres": 0.01, "millimetres": 0.001}
#: Scans that are looked at.
RANGE_UNIT_SCANS = 50


def with_ranges_in_metres(log: Log) -> Log:
    """A log whose ranges are in metres: the unit is that in which the wheels go the same way."""
    some = log[:: 1 + len(log) // RANGE_UNIT_SCANS]
    ranges = np.concatenate([np.empty(0), *(scan.ranges[scan.valid] for scan in some)])
    if not len(ranges) or np.median(ranges) <= LONGEST_M:
        return log
    likely = "millimetres" if np.median(ranges) > 10 * LONGEST_M else "centimetres"
    for name, metres in RANGE_UNITS.items():
        converted = _scaled(log, metres)
        if (
            WAY_RATIOS[0]
            < odometry_against_steps(log.odometry, blind_steps(converted)).way
            < WAY_RATIOS[1]
        ):
            words = f"the ranges are in {name}: converted"
            return replace(converted, causes=(*log.causes, Finding(Cause.UNIT, metres, words)))
    words = f"the ranges are taken to be in {likely}, since half of them are above {LONGEST_M:g} m"
    told = Finding(Cause.UNIT, RANGE_UNITS[likely], words, doubtful=True)
    return replace(_scaled(log, RANGE_UNITS[likely]), causes=(*log.causes, told))


def _scaled(log: Log, factor: float) -> Log:
    """A log with its ranges, and its reach, times a factor."""
    scans = (replace(s, ranges=s.ranges * factor, max_range=s.max_range * factor) for s in log)
    return replace(log, scans=tuple(scans))
