"""Ranges that no laser for buildings measures: they are in another unit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...scans import Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import odometry_against_steps
from ..points import FARTHEST_POINT_M
from ._blind_steps import blind_steps
from ._changed import with_fields
from ._odometry import WAY_RATIOS


def with_ranges_in_metres(log: Log) -> Log:
    """A log whose ranges are in metres: the map is doubtful unless the wheels go the same way."""
    ranges = np.concatenate([np.empty(0), *(scan.ranges[scan.valid] for scan in log)])
    if not len(ranges) or (middle := np.median(ranges)) <= FARTHEST_POINT_M:
        return log
    centimetres = middle <= 10 * FARTHEST_POINT_M
    unit, metres = ("centimetres", 0.01) if centimetres else ("millimetres", 0.001)
    limits = [scan.max_range * metres for scan in log]
    log = with_fields(log, ranges=[scan.ranges * metres for scan in log], max_range=limits)
    way = odometry_against_steps(log.odometry, blind_steps(log)).way
    words = f"the ranges are taken to be in {unit}: half of them are above {FARTHEST_POINT_M:g} m"
    agrees = WAY_RATIOS[0] < way < WAY_RATIOS[1]
    finding = Finding(Cause.UNIT, metres, words, doubtful=not agrees)
    return replace(log, causes=(*log.causes, finding))
