"""`segmap live MODEL PORT`: a log and a map of a laser that is carried through the building."""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Iterable, Iterator
from datetime import datetime
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from segmap import warm
from segmap.alignment import LiveGraph, Tracking
from segmap.display import counted
from segmap.files import shown
from segmap.matching import LiveMap
from segmap.scans import LaserScan
from segmap.sensors import Newest, SensorError, SpinningLaser, UrgSensor, ports, spinning_models
from segmap.sensors.__main__ import stop_on_signals

from . import _map
from ._output import Usage, metres, print_error, reason
from .log_options import add_output, examples, switch

#: What a Hokuyo is called, of any model.
HOKUYO = "HOKUYO"
#: Columns of the log, a row a beam.
COLUMNS = ("scan", "time_s", "angle_rad_ccw", "range_m")
#: Seconds from one line to the next.
LINE_S = 1.0
#: A scan that turns by more bends beyond what can be carried back, radians.
FASTEST_TURN_RAD = np.radians(45)
SLOWER = "SLOWER: turn the laser by less than an eighth of a turn a scan"
LOST = "LOST: go back to where the map is, and turn slowly"


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "live",
        help="a log and a map of a laser that you carry: RPLidar, LD19, YDLidar, Hokuyo",
        epilog=examples(
            "live                                    lists serial ports and models",
            "live LD19 /dev/ttyUSB0 -o map.svg       until Control-C; then the map is made",
            "live hokuyo --log drive.csv             the one Hokuyo on USB",
        ),
    )
    command.add_argument("model", nargs="?", metavar="MODEL", help="of the laser, or hokuyo")
    command.add_argument("port", nargs="?", metavar="PORT", help="device, as /dev/ttyUSB0")
    command.add_argument(
        "--log", type=Path, metavar="FILE", help="the log, .csv; default: live-DATE-TIME.csv"
    )
    words = "the angles grow counter-clockwise, seen from above; default: as the maker says"
    switch(command, "--counter-clockwise", help=words)
    add_output(command, _map.SUFFIXES, _map.WRITTEN)
    command.set_defaults(run=live)


def live(given: argparse.Namespace) -> int:
    """Record until Control-C or until the laser falls silent; then map it as `segmap map` does."""
    if given.model is None or not (given.port or is_hokuyo(given)):
        return tell_what_there_is()
    path = given.log or Path(f"live-{datetime.now():%Y%m%d-%H%M%S}.csv")
    if path.suffix.lower() != ".csv" or path.exists():
        raise Usage(f"--log {shown(path)} must be a new file whose name ends in .csv")
    warm.dispatch(["alignment pose_graph", "quadtree all", "matching all"])  # before scans wait
    stop_on_signals()
    ended, before = 0, time.monotonic()
    try:
        with opened(given) as laser, path.open("x", encoding="ascii", newline="") as file:
            for words in getattr(laser, "assumed", ()):
                print(f"assumed: {words}")
            try:
                with Newest(written(laser.scans(), file)) as scans:
                    follow(scans)
            except KeyboardInterrupt:
                print()
    except SensorError as error:  # what was measured stays
        print_error(reason(error))
        ended = 1
    if not path.exists() or path.stat().st_size <= len(",".join(COLUMNS)) + 2:
        path.unlink(missing_ok=True)
        return ended or 1
    print(f"{shown(path)}: {time.monotonic() - before:.0f} s")
    from ._main import main

    outputs = [word for name in given.output for word in ("-o", name)]
    return main(["map", str(path), *outputs]) or ended


def is_hokuyo(given: argparse.Namespace) -> bool:
    """Whether the model is a Hokuyo, which needs no port."""
    return (given.model or "").upper() == HOKUYO


def opened(given: argparse.Namespace) -> SpinningLaser | UrgSensor:
    """The laser that the command names."""
    if is_hokuyo(given):
        return UrgSensor(given.port or "auto")
    clockwise = False if given.counter_clockwise else None
    return SpinningLaser(given.model, given.port, clockwise=clockwise)


def tell_what_there_is() -> int:
    """Serial ports and models, a line each; what was not said is missing, so it is no success."""
    try:
        lines = [f"{port.device}  {port.description}" for port in ports()]
        for line in lines or ["no serial port: is the laser plugged in?"]:
            print(shown(line))
        print(f"models: {HOKUYO.lower()}, {', '.join(spinning_models())}")
    except SensorError as error:  # a package is missing
        print_error(reason(error))
    print_error("name a model and a port: segmap live LD19 /dev/ttyUSB0 -o map.svg")
    return 2


def written(scans: Iterable[LaserScan], file: TextIO) -> Iterator[LaserScan]:
    """The scans, each of them written down before it is handed on."""
    table = csv.writer(file, lineterminator="\n")
    table.writerow(COLUMNS)
    for k, scan in enumerate(scans):
        delays = np.zeros(len(scan)) if scan.delays is None else scan.delays
        rows = np.column_stack([scan.time + delays, scan.angles, scan.ranges])
        rows = rows[np.argsort(delays, kind="stable")]  # as they were measured
        table.writerows((k, f"{t:.6f}", f"{angle:.6f}", f"{r:.4f}") for t, angle, r in rows)
        file.flush()
        yield scan


def follow(scans: Iterable[LaserScan]) -> None:
    """Place the scans, and say each second how far the robot came, and whether it is lost."""
    live = LiveMap(LiveGraph(tracking=Tracking(moving=True)))
    last, way, line, turn = np.zeros(2), 0.0, time.monotonic(), 0.0
    for scan in scans:
        step = live.add(scan)
        if scan.delays is not None and step.motion is not None:
            turn = max(turn, float(np.abs(step.motion[2]) * scan.delays.max(initial=0.0)))
        way, last = way + float(np.hypot(*(step.pose[:2] - last))), step.pose[:2]
        if time.monotonic() - line >= LINE_S:
            line = time.monotonic()
            words = SLOWER if turn > FASTEST_TURN_RAD else "sure" if step.found else LOST
            turn = 0.0
            print(f"{counted(len(live.graph), 'scan')}, {metres(way)}, {words}", flush=True)
