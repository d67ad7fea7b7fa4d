"""`segmap info LOG...`: what a log is."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..readers import format_of
from ..scans import LaserScan, Log
from ._logs import add_logs, each_log
from ._targets import Targets
from ._words import counted, line, percent, say


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "info", help="what a log is: scans, beams, field of view, path, odometry, truth, damage"
    )
    add_logs(command)
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> int:
    """Tell of each log; damaged lines are left out and counted."""
    given.skip = True
    return each_log(given, tell_of)


def tell_of(given: argparse.Namespace, log: Log, targets: Targets) -> None:
    """Print what a log is, a line a thing."""
    known = Path(targets.source).exists()
    where = f"{format_of(targets.source)}, {targets.source}" if known else "comes with segmap"
    say(f"{log.name}: {where}")
    line("scans", f"{counted(len(log), 'scan')}{_duration(log)}")
    if len(log):
        line("beams", _beams(log))
        line("view", _view(log))
        line("ranges", _ranges(log))
    line("odometry", _path(log.odometry))
    line("truth", _path(np.full((0, 3), np.nan) if log.truth is None else log.truth))
    if log.skipped:
        line("damaged", f"{counted(log.skipped.lines, 'line')} left out; {log.skipped.reason}")


def _duration(log: Log) -> str:
    times = log.times[np.isfinite(log.times)]
    if len(times) < 2 or not np.ptp(times):
        return ", without times"
    steps = np.diff(times)
    rate = f", {1 / np.median(steps):.3g} a second" if np.median(steps) > 0 else ""
    back = int((steps < 0).sum())
    early = f", {counted(back, 'time')} earlier than the one before" if back else ""
    return f" in {np.ptp(times):.1f} s{rate}{early}"


def _beams(log: Log) -> str:
    counts = sorted({len(scan) for scan in log})
    many = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
    total = sum(len(scan) for scan in log)
    valid = sum(int(scan.valid.sum()) for scan in log) / max(total, 1)
    return f"{many} a scan, {percent(valid)} of them valid"


def _view(log: Log) -> str:
    scan = max(log, key=len)
    places = {tuple(scan.sensor_pose) for scan in log}
    lasers = "" if len(places) == 1 else f", {counted(len(places), 'laser')}"
    if len(scan) < 2:
        return f"{counted(len(scan), 'beam')}{lasers}"
    wide, step = np.ptp(scan.angles), np.median(np.abs(np.diff(scan.angles)))
    return f"{np.degrees(wide):.4g} degrees, {np.degrees(step):.3g} from beam to beam{lasers}"


def _ranges(log: Log) -> str:
    found = np.concatenate([scan.ranges[scan.valid] for scan in log])
    if not len(found):
        return "none is valid"
    near, half, far = np.quantile(found, [0, 0.5, 1])
    most = {_largest(scan) for scan in log} - {""}
    limit = f", the sensor's limit is {most.pop()} m" if len(most) == 1 else ""
    return f"{near:.2f} to {far:.2f} m, half of them below {half:.2f} m{limit}"


def _largest(scan: LaserScan) -> str:
    return f"{scan.max_range:.4g}" if np.isfinite(scan.max_range) else ""


def _path(poses: Array) -> str:
    known = poses[np.isfinite(poses).all(1)]
    if not len(known):
        return "none"
    way = np.hypot(*np.diff(known[:, :2], axis=0).T).sum()
    wide, tall = np.ptp(known[:, :2], axis=0)
    share = "each scan" if len(known) == len(poses) else f"{len(known)} of {len(poses)} scans"
    return f"for {share}; a path of {way:.1f} m, {wide:.1f} m by {tall:.1f} m"
