"""A clock that goes back or leaps: the order in the file counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...display import counted
from ...scans import Log
from ...scans.causes import Cause, Finding

#: From this share of the scans on it is not the clock: they are in another order.
SHUFFLED_SCANS_SHARE = 0.1
#: Nobody leaves a recorder running for so long that a robot stands, seconds.
LEAP_S = 600.0


def with_clock_mended(log: Log) -> Log:
    """A log whose times go on where they went back or leapt; without times that are all equal."""
    times, steps = log.times, np.diff(log.times)
    if not len(steps) or not np.isfinite(times).all():
        return log
    if not steps.any():
        return replace(log, scans=tuple(replace(scan, time=np.nan) for scan in log))
    usual = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    broken = np.flatnonzero((steps < 0) | (steps > max(LEAP_S, 1000 * usual)))
    if not len(broken):
        return log
    if (back := int((steps < 0).sum())) > SHUFFLED_SCANS_SHARE * len(steps):
        words = f"at {back} of {len(log)} scans time goes back: they may be in another order"
        return replace(log, causes=(*log.causes, Finding(Cause.ORDER, back, words)))
    leap = float(steps[broken[0]])
    words = f"the clock is set {counted(len(broken), 'time')}, first by {leap:+.6g} s at scan "
    words += f"{broken[0] + 1}: the order of the scans counts"
    steps[broken] = usual
    mended = times[0] + np.r_[0.0, np.cumsum(steps)]
    scans = tuple(replace(s, time=t) for s, t in zip(log, mended.tolist(), strict=True))
    return replace(log, scans=scans, causes=(*log.causes, Finding(Cause.CLOCK, leap, words)))
