"""A laser that is carried: its scans are written down as they come, and placed on a map."""

from __future__ import annotations

import csv
import time
from collections.abc import Iterable, Iterator
from datetime import datetime
from itertools import chain, islice
from pathlib import Path

import numpy as np

from segmap import readers, warm
from segmap.arrays import Array
from segmap.carried import CASES, CarriedMap
from segmap.display import plural
from segmap.files import rewrite
from segmap.progress import Stopped, announce
from segmap.scans import LaserScan, Log
from segmap.sensors import Newest, SensorError, SpinningLaser, UrgSensor

#: What a Hokuyo is called, of any model; it needs no port.
HOKUYO = "HOKUYO"
#: Columns of the log, a row a beam.
COLUMNS = ("scan", "time_s", "angle_rad_ccw", "range_m")
#: What is to be done is said for so long at least, seconds.
READ_S = 1.0
#: A drive has no end that is known: the share of it that is done says nothing.
SHARE = 0.01


class Driving(str):
    """Words on a drive, and the map that grows."""

    map: CarriedMap
    pose: Array
    advice: str


def new_path() -> Path:
    """Where the log of a drive that begins now is written."""
    return Path(f"live-{datetime.now():%Y%m%d-%H%M%S}.csv")


def drive(model: str, port: str, path: Path, clockwise: bool | None) -> str:
    """Record and map until it is stopped or the laser falls silent: why, or nothing.

    Without one scan there is no file.
    """
    warm.dispatch(CASES)  # before scans wait
    try:
        with open_laser(model, port, clockwise) as laser:
            for words in getattr(laser, "assumed", ()):
                announce(0.0, Driving(f"live: assumed that {words}"))
            with Newest(save_each(laser.scans(), path)) as scans:
                follow(scans)
    except (KeyboardInterrupt, Stopped):
        return ""
    except (SensorError, OSError) as error:  # what was measured stays
        return str(error)
    return ""


def record(model: str, port: str, path: Path, clockwise: bool | None) -> tuple[Log, str]:
    """The log of a drive, and why it ended if it was not stopped; a ValueError without a scan."""
    why = drive(model, port, path, clockwise)
    if not path.exists():
        raise ValueError(why or "it was stopped before a scan came")
    return readers.read(path, on_error="skip"), why


def mirror(path: Path) -> Log:
    """The log of a drive with its angles counted the other way: the file is written anew."""
    with path.open(encoding="ascii", newline="") as old, rewrite(path) as new:
        new.write(next(old).encode())
        for row in csv.reader(old):
            row[2] = f"{-float(row[2]):.6f}"
            new.write(f"{','.join(row)}\n".encode())
    return readers.read(path, on_error="skip")


def open_laser(model: str, port: str, clockwise: bool | None) -> SpinningLaser | UrgSensor:
    """The laser of a model at a port."""
    if model.upper() == HOKUYO:
        return UrgSensor(port or "auto")
    return SpinningLaser(model, port, clockwise=clockwise)


def save_each(scans: Iterable[LaserScan], path: Path) -> Iterator[LaserScan]:
    """The scans, each of them written to a new file before it is handed on."""
    scans = iter(scans)
    first = [*islice(scans, 1)]
    if not first:
        return
    with path.open("x", encoding="ascii", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for k, scan in enumerate(chain(first, scans)):
            delays = np.zeros(len(scan)) if scan.delays is None else scan.delays
            rows = np.column_stack([scan.time + delays, scan.angles, scan.ranges])
            rows = rows[np.argsort(delays, kind="stable")]  # as they were measured
            table.writerows((k, f"{t:.6f}", f"{angle:.6f}", f"{r:.4f}") for t, angle, r in rows)
            file.flush()
            yield scan


def follow(scans: Iterable[LaserScan]) -> None:
    """Place the scans, and announce at each how far the robot came, and what to do with it."""
    map, last, way, advice, until = CarriedMap(), np.zeros(2), 0.0, "", 0.0
    for scan in scans:
        step = map.add(scan)
        way, last = way + float(np.hypot(*(step.pose[:2] - last))), step.pose[:2]
        if map.advice or time.monotonic() > until:
            advice, until = map.advice, time.monotonic() + READ_S
        skipped = getattr(scans, "skipped", 0)
        words = Driving(
            f"live: {plural(len(map.graph), 'scan')}, {way:.2f} m, {advice or 'sure'}"
            + f", {skipped} left out" * bool(skipped)
        )
        words.map, words.pose, words.advice = map, step.pose, advice
        announce(SHARE, words)
