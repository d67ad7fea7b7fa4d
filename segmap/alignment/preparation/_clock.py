"""Scans that wait for the recorder have times that are not theirs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...display import counted
from ...poses.motions import between, compose
from ...scans import Log
from ...scans.causes import Cause, Finding
from ._pairs import way_of

#: Scans come together where they are less than this share of the usual time apart; the wheels stand
#: meanwhile where they go less than this share of what they went in the pause before.
TOGETHER_SHARE = 0.1


def with_waiting_scans_spread(log: Log) -> Log:
    """A log whose scans that waited for the recorder lie evenly in the pause before they came.

    They have the time and the odometry of their arrival: the wheels seem to stand while the robot
    drives on. Scans of several lasers that come together did not wait.
    """
    times, rows, steps = log.times, log.odometry, np.diff(log.times)
    usual = np.median(steps) if len(steps) and (steps >= 0).all() else np.nan
    together = np.r_[False, steps < TOGETHER_SHARE * usual, False]
    mounts, waited = np.array([scan.sensor_pose for scan in log]), 0
    for first in np.flatnonzero(together[1:] & ~together[:-1]).tolist():
        before, last = first - 1, first + int(np.argmin(together[first + 1 :]))
        if not first or steps[before] <= usual or (mounts[first:last] != mounts[last]).any():
            continue
        drive, wait = way_of(between(rows[[before, first]], rows[[first, last]]))
        if wait < TOGETHER_SHARE * drive:
            share, came = np.arange(1, last - before + 1) / (last - before), slice(first, last + 1)
            times[came] = times[before] + share * (times[last] - times[before])
            whole = between(rows[before], rows[last])
            rows[came] = compose(rows[before], share[:, None] * whole)
            waited += len(share)
    if not waited:
        return log
    words = f"{counted(waited, 'scan')} came together after pauses, as if they had waited: their "
    words += "times and odometry are spread over these pauses"
    scans = (
        replace(scan, time=t, odometry=row if np.isfinite(row).all() else None)
        for scan, t, row in zip(log, times.tolist(), rows, strict=True)
    )
    finding = Finding(Cause.CLOCK, waited, words)
    return replace(log, scans=tuple(scans), causes=(*log.causes, finding))
