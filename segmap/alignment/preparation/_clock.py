"""Times that are not those of the scans: a clock that is set, scans that wait for the recorder."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import Array
from ...display import plural
from ...poses.motions import between, compose
from ...scans import LaserScan, Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import Steps, interpolate
from ..points import LEAST_POINTS, PointMap, in_range
from ._blind_steps import register_near
from ._changed import with_fields, with_odometry_rows
from ._odometry import LEAST_REPEATS, equal_runs
from ._pairs import way_of

#: From this share of the scans on it is not the clock: they are in another order.
SHUFFLED_SCANS_SHARE = 0.1
#: Nobody leaves a recorder running for so long that a robot stands, seconds.
LEAP_S = 600.0
#: Scans come together where they are less than this share of the usual time apart; the wheels stand
#: meanwhile where they go less than this share of what they went in the pause before.
TOGETHER_SHARE = 0.1


def with_clock_mended(log: Log) -> Log:
    """Correct clock jumps in a log. Times that are all equal are removed."""
    times, steps = log.times, np.diff(log.times)
    if not len(steps) or not np.isfinite(times).all():
        return log
    if not steps.any():
        return with_fields(log, time=[np.nan] * len(log))
    step_s = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    jumps = np.flatnonzero((steps < 0) | (steps > LEAP_S))
    if not len(jumps):
        return log
    if (count := int((steps < 0).sum())) > SHUFFLED_SCANS_SHARE * len(steps):
        words = f"at {count} of {len(log)} scans time goes back: they may be in another order"
        return replace(log, causes=(*log.causes, Finding(Cause.ORDER, count, words)))
    jump_s = float(steps[jumps[0]])
    words = f"the clock is set {plural(len(jumps), 'time')}, first by {jump_s:+.6g} s at scan "
    words += f"{jumps[0] + 1}: the order of the scans counts"
    steps[jumps] = step_s
    new_times = times[0] + np.r_[0.0, np.cumsum(steps)]
    return with_fields(log, Finding(Cause.CLOCK, jump_s, words), time=new_times.tolist())


def with_waiting_scans_spread(log: Log) -> Log:
    """A log whose scans that waited for the recorder lie evenly in the pause before they came.

    They have the time and the odometry of their arrival: the wheels seem to stand while the robot
    drives on. The pause holds as many usual steps as scans came; scans of several lasers, and some
    that see the robot stand, did not wait.
    """
    times, rows, steps = log.times, log.odometry, np.diff(log.times)
    usual = np.median(steps) if len(steps) and (steps >= 0).all() else np.nan
    together = np.r_[False, steps < TOGETHER_SHARE * usual, False]
    mounts, waited = np.array([scan.sensor_pose for scan in log]), 0
    for first in np.flatnonzero(together[1:] & ~together[:-1]).tolist():
        before, last = first - 1, first + int(np.argmin(together[first + 1 :]))
        count, pause, came = last - before, times[last] - times[before], slice(first, last + 1)
        drive, wait = way_of(between(rows[[before, first]], rows[[first, last]]))
        share, whole = np.arange(1, count + 1) / count, between(rows[before], rows[last])
        one_laser = (mounts[first:last] == mounts[last]).all()
        holds_them = first and steps[before] > usual and pause < 2 * count * usual
        if not (one_laser and holds_them and wait < TOGETHER_SHARE * drive):
            continue
        # Between alike stretches of a corridor the nearest to the even motion counts
        way = _way_between(log[first], log[last], whole * (1 - share[0]))
        if way < TOGETHER_SHARE * drive:
            continue
        times[came] = times[before] + share * pause
        rows[came] = compose(rows[before], share[:, None] * whole)
        waited += count
    if not waited:
        return log
    words = f"{plural(waited, 'scan')} came together after pauses, as if they had waited: their "
    words += "times and odometry are spread over these pauses"
    return with_odometry_rows(log, rows, Finding(Cause.CLOCK, waited, words), time=times.tolist())


def with_readings_spread(log: Log, steps: Steps) -> Log:
    """A log whose wheels were read less often than the laser: between readings it drives evenly.

    Matched steps must move while rows repeat: a robot that stands for each scan repeats them too.
    """
    rows, scans = log.odometry, np.arange(len(log))
    run, moving = equal_runs(rows, steps)
    if len(moving) < LEAST_REPEATS:
        return log
    repeats, readings = np.diff(run, prepend=-1) == 0, np.flatnonzero(np.diff(run, prepend=-1))
    period = int(np.median([1, *np.diff(readings)]))
    until = np.append(readings, len(log) + period)[run + 1] - scans
    at = log.times if (np.diff(log.times) >= 0).all() else scans
    apart = np.diff(at, prepend=-np.inf) > TOGETHER_SHARE * np.ptp(at) / len(at)
    spread = repeats & apart & (until < period)  # longer before the next one it stood
    if not spread.any():
        return log
    rows = interpolate(rows[~spread], np.interp(at, at[~spread], np.arange((~spread).sum())))
    words = f"the odometry is read once in {period} scans: between, the motion is even"
    return with_odometry_rows(log, rows, Finding(Cause.DELAY, period, words))


def _way_between(one: LaserScan, two: LaserScan, guess: Array) -> float:
    """How far the robot went by the walls that both scans see, near a guess `(3,)`; maybe NaN."""
    points, current = in_range(one.points()), in_range(two.points())
    if min(len(points), len(current)) < LEAST_POINTS:
        return np.nan
    match = register_near(PointMap(points), current, guess)
    return np.nan if match is None or match.free is not None else way_of(match.pose[None])[0]
