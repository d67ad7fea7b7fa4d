"""Scans that programs write a line each, with where their beams point.

    %time,field.header.stamp,field.angle_min,...,field.ranges0,...   rostopic echo -p of a LaserScan
    sec,nanosec,frame,angle_min,angle_max,angle_increment,...        ros2 topic echo --csv of one
    Time,header.stamp.secs,angle_min,...,ranges_0,...                bagpy
    time,.header.stamp.secs,.angle_min,...,"(1.5, 2.0)",...          rosbag_to_csv
    __time,/scan/angle_min,...,/scan/ranges[0],...                   PlotJuggler
    {"nrays": 361, "theta": [...], "readings": [...], ...}           CSM, the canonical scan matcher

All are in metres, radians and seconds, rostopic's stamps in nanoseconds; `null` of CSM, and what is
below `range_min`, is no measurement. Of CSM the odometry and the true pose are read.

Assumed: a robot's laser sits at its centre.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from itertools import islice
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...scans import LaserScan, Log
from ..lines import HeadError, Lines, LogError, float_fields, is_number, pose_fields, time
from ..raw_scans import beams_of_message, known_truth, or_none, place_of
from ._columns import meaning
from ._layout import fields_of, first_lines

#: Single numbers of a LaserScan.
NUMBERS = re.compile(
    r"(?:.*[./])?((?:angle|range)_(?:min|max)|(?:angle|time)_increment|header[./]stamp(?:[./]\w+)?)"
)
RANGES = re.compile(r"(?:.*[./])?ranges[\[_./]?(\d*)\]?")
NEEDED_NUMBERS = {"angle_min", "angle_increment"}
#: What stands before the ranges in a line of ROS 2: seconds, nanoseconds, the frame, and these.
ROS2_NUMBERS = (
    "angle_min",
    "angle_max",
    "angle_increment",
    "time_increment",
    "scan_time",
    "range_min",
    "range_max",
)
ROS2_BEFORE = 3 + len(ROS2_NUMBERS)
#: Parts of a stamp, each with how many of it are a second.
STAMP_PARTS = {"secs": 1.0, "sec": 1.0, "nsecs": 1e-9, "nanosec": 1e-9}
#: A head stands in one of so many lines.
HEAD_LINES = 10


class MessageForm(NamedTuple):
    """Where in a line the parts of a LaserScan stand."""

    line: int  #: of the head
    separator: str
    numbers: Mapping[str, int]
    ranges: Sequence[int]  #: one, where a cell holds them all
    clock: Sequence[tuple[int, float]]  #: the parts of its time, and how many of each are a second
    frame: int | None  #: of the sensor that measured


def message_form_of(path: Path) -> MessageForm | None:
    """How a file with a LaserScan a line is written; None of another."""
    lines = first_lines(path)[:HEAD_LINES]
    for number, text in lines:
        separator = next((mark for mark in ";\t," if mark in text), ",")
        names = fields_of(text, separator)
        numbers = {m[1]: k for k, name in enumerate(names) if (m := NUMBERS.fullmatch(name))}
        count = {k: m[1] for k, name in enumerate(names) if (m := RANGES.fullmatch(name))}
        ranges = sorted(count, key=lambda k: int(count[k] or 0))  # some sort their names as words
        if ranges and {*numbers} >= NEEDED_NUMBERS:
            beams = [int(count[k] or 0) for k in ranges]
            if beams != [*range(beams[0], beams[0] + len(beams))] or beams[0] > 1:
                what = (
                    f"its ranges are those of {len(beams)} beams between {beams[0]} and {beams[-1]}"
                )
                raise HeadError(path, f"{what}: expected a column of each beam, from 0", number)
            frame = next((k for k, name in enumerate(names) if name.endswith("frame_id")), None)
            return MessageForm(number, separator, numbers, ranges, clock_of(names), frame)
    row = fields_of(lines[0][1], ",") if lines else []
    if len(row) <= ROS2_BEFORE or is_number(row[2]) or not all(map(is_number, row[:2] + row[3:10])):
        return None
    numbers = {name: 3 + k for k, name in enumerate(ROS2_NUMBERS)}
    return MessageForm(0, ",", numbers, (), ((0, 1.0), (1, 1e-9)), 2)


def clock_of(names: Sequence[str]) -> Sequence[tuple[int, float]]:
    """The columns of the time of a message: its stamp first, then when it was recorded."""
    ends = [re.split(r"[./]", name)[-1] for name in names]
    stamped = [k for k, name in enumerate(names) if re.search(r"header[./]stamp", name)]
    parts = [(k, STAMP_PARTS[ends[k]]) for k in stamped if ends[k] in STAMP_PARTS]
    if parts:
        return parts
    if any(name.startswith("field.") for name in names):  # of rostopic
        return [(stamped[0] if stamped else 0, 1e-9)]
    for k, name in enumerate(names):
        column = meaning(name)
        of_bagpy = name == "Time" and any(n.startswith("header.") for n in names)
        if name == "__time" or of_bagpy:
            return [(k, 1.0)]
        if column and column.role == "time" and column.unit:
            return [(k, column.factor)]
    return ()


def read_messages(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a LaserScan a line; lines without ranges are of other topics."""
    form, lines = message_form_of(path), Lines(path, on_error, "\n", comments="")
    assert form is not None
    beyond, frames = 0, dict[str, None]()

    def scan_of(line: list[str]) -> LaserScan | None:
        nonlocal beyond
        if lines.number <= form.line:
            return None
        row = fields_of(line[0], form.separator)
        numbers = {part: _number(row, k) for part, k in form.numbers.items() if "stamp" not in part}
        if form.ranges:
            ranges = [row[k] for k in form.ranges if k < len(row)]
            if len(form.ranges) == 1:
                ranges = re.findall(r"[^\s,()\[\]']+", ranges[0]) if ranges else []
            if len(form.ranges) > 1 and len(row) <= max(form.ranges):
                raise ValueError(f"expected {max(form.ranges) + 1} fields, got {len(row)}")
        else:
            if "..." in row:
                what = "ROS shortened its ranges: `ros2 topic echo --full-length --csv`"
                raise LogError(path, what)
            turn = numbers["angle_max"] - numbers["angle_min"]
            steps = turn / numbers["angle_increment"] if numbers["angle_increment"] else np.nan
            ranges = row[ROS2_BEFORE:]
            if not -0.5 <= steps < len(ranges) - 0.5:
                what = f"of {steps + 1:.0f} from angle_min to angle_max"
                raise ValueError(f"expected the ranges {what}, got {len(ranges)} fields")
            ranges = ranges[: round(steps) + 1]
        if not any(ranges):
            return None
        if form.frame is not None:
            frames.update(dict.fromkeys(row[form.frame : form.frame + 1]))
        far = float_fields([field or "nan" for field in ranges], "ranges")
        rest = dict(range_min=0.0, range_max=np.inf, time_increment=0.0) | numbers
        beams = beams_of_message(SimpleNamespace(**rest, ranges=far))
        beyond += bool(np.isfinite(far).any() and (far[np.isfinite(far)] > beams.max_range).all())
        when = sum(time(row[k], unit=second) for k, second in form.clock) if form.clock else np.nan
        return LaserScan(
            beams.ranges, beams.angles, when, max_range=beams.max_range, delays=beams.delays
        )

    scans = [scan for scan in lines.each(scan_of) if scan is not None]
    if not scans:
        raise lines.no_scan("lines with ranges")
    if len(frames) > 1:
        what = f"its lines are of several sensors, {', '.join(map(repr, frames))}"
        raise LogError(path, f"{what}: expected one a log, so keep the lines of one of them")
    if beyond == len(scans):
        raise LogError(
            path, "all its ranges lie beyond range_max: expected metres, as ROS has them"
        )
    return Log(name, scans, None, lines.skipped)


def _number(row: Sequence[str], place: int) -> float:
    if place >= len(row):
        raise ValueError(f"expected {place + 1} fields, got {len(row)}")
    return float(float_fields([row[place] or "nan"], "the scan")[0])


def is_csm(path: Path) -> bool:
    """Whether each line is a scan as CSM writes it."""
    rows = [text for (text,) in islice(Lines(path, "skip", "\n"), 1)]
    return (
        bool(rows)
        and rows[0].startswith("{")
        and {'"nrays"', '"readings"'} <= {word.strip() for word in re.findall(r'"\w+"', rows[0])}
    )


def read_csm(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a scan of CSM a line."""
    lines, truth = Lines(path, on_error, "\n"), list[Array]()

    def scan_of(line: list[str]) -> LaserScan:
        try:
            fields = json.loads(line[0])
            ranges, angles = (np.array(fields[key], float) for key in ("readings", "theta"))
            valid = np.array(fields.get("valid", np.ones(len(ranges))), float)
            seconds = [*(fields.get("timestamp") or ["nan"]), 0]
            when = time(str(seconds[0])) + 1e-6 * float(seconds[1])
            odometry, true = (
                pose_fields(
                    [str("nan" if v is None else v) for v in fields.get(key) or [None] * 3], key
                )
                for key in ("odometry", "true_pose")
            )
            scan = LaserScan(np.where(valid > 0, ranges, np.nan), angles, when, or_none(odometry))
        except (KeyError, TypeError, IndexError, AttributeError, RecursionError) as fault:
            raise ValueError(f"expected a scan of CSM ({type(fault).__name__}: {fault})") from fault
        truth.append(true)
        return scan

    scans = list(lines.each(scan_of))
    if not scans:
        raise lines.no_scan("lines of JSON with theta and readings")
    placed = any(scan.odometry is not None for scan in scans)
    assumed = [place_of(np.zeros(3))] * placed
    return Log(name, scans, known_truth(np.array(truth)), lines.skipped, assumed=assumed)
