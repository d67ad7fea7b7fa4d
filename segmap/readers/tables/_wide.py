"""Tables with a scan a line: angles or an index as head, ROS's own text of a `LaserScan`, or bare.

    %time,field.header.stamp,...,field.angle_min,...,field.ranges0,...    rostopic echo -p /scan
    160,250,laser,-1.57,1.57,0.0087,0,0.1,0.02,5.6,2.0,...               ros2 topic echo --csv
    ranges: [2.0, 2.1, ...]   among other keys, `---` after each scan     rostopic echo /scan
    time,-90,-89,...          directions in degrees or radians
    t,range_mm_0,range_mm_1   an index
    0.1,2.0,2.1,...           nothing but numbers, perhaps a time first

There is no odometry and no truth.

Assumed: the laser sits at the robot's centre; where the file does not say it, the unit of ranges
and times, and over which angle so many beams look.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ...scans import LaserScan, Log
from .._lines import Lines, LogError, float_fields, is_number, time
from .._raw_scans import URG_STEP, beams_of_message, centred, half_turn, place_of, view_of
from .._turns import distance
from ._columns import named, with_units_told
from ._layout import decimal, moment, sample, separator_of, split

#: How a column of rostopic begins.
FIELD = "field."
#: Numbers of a message, in the order in which `ros2 topic echo --csv` writes them.
SINGLE_NUMBERS = (
    *("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time"),
    *("range_min", "range_max"),
)
#: So many ranges in a line make a scan.
LEAST_BEAMS = 6
#: So many numbers in a line without a head do.
LEAST_BARE_BEAMS = 30
#: So many numbers that rise from line to line are times.
LEAST_TIMES = 5
#: So many lines tell what a file is.
WIDE_SAMPLE_LINES = 60
#: Beams of usual lasers -> over how many degrees they look.
VIEWS_DEG = {180: 180, 181: 180, 361: 180, 401: 100, 541: 270, 720: 360, 811: 270, 1080: 270}
VIEWS_DEG |= {1081: 270, 1440: 360, 1141: 285}
URG_BEAMS = (681, 682, 683, 726, 768, 769)


class Wide(NamedTuple):
    """Where in a line a scan's ranges and time stand, and what is known of all of them."""

    separator: str | None
    line: int
    ranges: tuple[int, ...]
    factor: float = 1.0
    time: tuple[tuple[int, float], ...] = ()  #: places that are added, each with its unit
    single: tuple[tuple[str, int], ...] = ()  #: numbers of a message, and their places
    angles: tuple[float, ...] = ()
    told: tuple[str, ...] = ()


def wide_of(path: Path) -> Wide | None:
    """How a file with a scan a line is written; None for another one."""
    lines = [(k, text) for k, text in sample(path, WIDE_SAMPLE_LINES) if text]
    lines = [(k, text) for k, text in lines if not text.startswith("#") or k == lines[0][0]]
    if not lines:
        return None
    separator = separator_of([text for _, text in lines])
    rows = [split(text.lstrip("#"), separator) for _, text in lines]
    pairs = pairwise(rows[:4])
    head = next((k for k, (row, below) in enumerate(pairs) if _is_head(row, below)), None)
    if head is not None:
        names = [name.removeprefix(FIELD) for name in rows[head]]
        return _with_head(separator, lines[head][0], names, rows[head + 1 :])
    return _ros2(separator, rows) or None


def bare_of(path: Path) -> Wide | None:
    """The same for lines of nothing but numbers, as many in each: a guess, and a last resort."""
    lines = [text for _, text in sample(path, WIDE_SAMPLE_LINES) if not text.startswith("#")]
    separator = separator_of(lines)
    rows = [[decimal(f, separator) for f in split(text, separator)] for text in lines]
    width = max(map(len, rows), default=0)
    whole = [row for row in rows if len(row) == width and all(map(is_number, row))]
    if width < LEAST_BARE_BEAMS or 2 * len(whole) <= len(rows):
        return None
    table = np.array(whole, float)
    first = table[:, 0]
    clock = len(first) >= LEAST_TIMES and bool((np.diff(first) > 0).all())
    at: tuple[tuple[int, float], ...] = ()
    told: list[str] = []
    if clock:
        columns, told = with_units_told(named(["time"]), np.repeat(table[:, :1], 3, 0))
        at = ((0, columns.by_role["time"].factor or 1.0),) if "time" in columns.by_role else ()
    places = tuple(range(int(clock), width))
    factor, unit = _unit_of_ranges("", table[:, int(clock) :])
    angles = _view(len(places))
    told += [*unit, view_of(angles), f"lines of {width} numbers are scans"]
    return Wide(separator, 0, places, factor, at, (), tuple(angles), tuple(told))


def _is_head(row: Sequence[str], below: Sequence[str]) -> bool:
    """Whether fields are names of many ranges: a prefix and numbers, or directions."""
    places, numbers, prefix = _ranges_in(row)
    least = 1 if any(name.endswith("angle_increment") for name in row) else LEAST_BEAMS
    if len(places) < least or len(row) != len(below) or all(map(is_number, row)):
        return False
    apart = len({*numbers}) == len(numbers) or bool(prefix)
    return apart and any(is_number(below[k].replace(",", ".")) for k in places)


def _ranges_in(names: Sequence[str]) -> tuple[list[int], list[float], str]:
    """Places of the ranges among columns, the numbers in their names, and what these begin with.

    Of several groups that of the ranges counts, else the largest.
    """
    groups: dict[str, list[tuple[int, float]]] = {}
    for place, name in enumerate(names):
        if found := re.fullmatch(r"(.*?)[\[_(\s]*(-?\d+(?:\.\d+)?)[\])°\s]*(deg|rad)?", name):
            groups.setdefault(found[1].lower(), []).append((place, float(found[2])))
    if not groups:
        return [], [], ""
    prefix = max(groups, key=lambda p: (bool(re.match("range|dist|r$|laser", p)), len(groups[p])))
    return [p for p, _ in groups[prefix]], [n for _, n in groups[prefix]], prefix


def _with_head(
    separator: str | None, line: int, names: Sequence[str], rows: Sequence[Sequence[str]]
) -> Wide | None:
    places, numbers, prefix = _ranges_in(names)
    place = {name.lower(): k for k, name in enumerate(names)}
    single = tuple((word, place[word]) for word in SINGLE_NUMBERS if word in place)
    texts = [[decimal(field, separator) for field in row] for row in rows if len(row) == len(names)]
    table = np.array([[float(f) if is_number(f) else np.nan for f in row] for row in texts])
    table, told = table.reshape(-1, len(names)), list[str]()
    if names[0] == "%time":  # nanoseconds
        at: tuple[tuple[int, float], ...] = ((place.get("header.stamp", 0), 1e-9),)
    else:
        others = [name if k not in places else "-" for k, name in enumerate(names)]
        columns, told = with_units_told(named(others), table)
        clock = columns.by_role.get("time")
        at = () if clock is None else ((clock.place, clock.factor or 1.0),)
    if {"angle_min", "angle_increment"} <= {*place}:
        told.append(place_of(np.zeros(3)))
        return Wide(separator, line, tuple(places), 1.0, at, single, (), tuple(told))
    factor, unit = _unit_of_ranges(prefix, table[:, places])
    steps = np.diff(numbers)
    if (steps == 1).all() and numbers[0] in (0, 1) and len(numbers) not in (360, 361):
        angles = _view(len(numbers))
        told.append(view_of(angles))
    else:
        whole = all(number % 1 == 0 for number in numbers)
        is_radians = not whole and np.ptp(numbers) <= 2 * np.pi + 0.1
        angles = np.array(numbers) if is_radians else np.radians(numbers)
        told.append(f"the head holds {'radians' if is_radians else 'degrees'}, counter-clockwise")
    return Wide(separator, line, tuple(places), factor, at, (), tuple(angles), (*told, *unit))


def _unit_of_ranges(prefix: str, values: Array) -> tuple[float, list[str]]:
    """What makes metres of ranges: by what their names begin with, or by the numbers, told."""
    words = named([f"range_{prefix.removeprefix('range')}"]).by_role.get("range")
    if words is not None and words.factor is not None:
        return words.factor, []
    flat = values[np.isfinite(values)]
    flat = flat[flat > 0]
    whole = len(flat) > 0 and (flat == np.floor(flat)).all()
    if len(flat) and (whole or np.median(flat) > 100) and np.median(flat) > 30:
        return 0.001, ["ranges are in millimetres"]
    return 1.0, ["ranges are in metres"]


def _view(count: int) -> Array:
    """Where so many beams of one of the usual lasers point."""
    if count in URG_BEAMS:
        return centred(count, URG_STEP)
    wide = np.radians(VIEWS_DEG.get(count, 360))
    if wide <= np.pi:
        return half_turn(count) if np.isclose(wide, np.pi) else centred(count, wide / (count - 1))
    if wide > 6:  # a whole turn begins ahead
        return np.arange(count) * wide / count
    return centred(count, wide / (count - count % 2))


def _ros2(separator: str | None, rows: Sequence[Sequence[str]]) -> Wide | None:
    """What `ros2 topic echo --csv` writes: seconds, nanoseconds, frame, numbers, ranges.

    Also what `rostopic echo -p` does, without its head: time, number, stamp, frame and so on.
    """
    row = rows[0]
    frame = next((k for k, field in enumerate(row[:4]) if not is_number(field)), 0)
    begin = frame + 1 + len(SINGLE_NUMBERS)
    if separator != "," or frame < 2 or len(row) <= begin:
        return None
    if not all(map(is_number, row[frame + 1 : begin])):
        return None
    first, last, step = map(float, row[frame + 1 : frame + 4])
    count = round((last - first) / step) + 1 if step else 0
    if not 0 < count <= len(row) - begin + 1:
        return None
    places = tuple(range(begin, min(begin + count, len(row))))
    single = tuple((word, frame + 1 + k) for k, word in enumerate(SINGLE_NUMBERS))
    clock = ((0, 1.0), (1, 1e-9)) if frame == 2 else ((2, 1e-9),)
    told = (place_of(np.zeros(3)),)
    return Wide(separator, 0, places, 1.0, clock, single, (), told)


def read_wide(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a file whose head says what its columns are, or whose lines are those of ROS."""
    found = wide_of(path)
    assert found is not None
    return _scans(path, name, on_error, found)


def read_bare(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read lines of nothing but numbers."""
    found = bare_of(path)
    assert found is not None
    return _scans(path, name, on_error, found)


def _scans(path: Path, name: str, on_error: str, wide: Wide) -> Log:
    lines = Lines(path, on_error, "\n", encoding="utf-8-sig")
    last = max(wide.ranges)

    def scan_of(fields: list[str]) -> LaserScan | None:
        if lines.number <= wide.line:
            return None
        found = [decimal(field, wide.separator) for field in split(fields[0], wide.separator)]
        if len(found) <= last:
            raise ValueError(f"expected {last + 1} columns, got {len(found)}")
        when = [
            time(found[k], unit=unit) if is_number(found[k]) else moment(found[k])
            for k, unit in wide.time
        ]
        texts = [found[k] for k in wide.ranges]
        if wide.single:
            numbers = {word: float_fields([found[k]], word)[0] for word, k in wide.single}
            ranges = float_fields(texts, "ranges")
            beams = beams_of_message(SimpleNamespace(**_MESSAGE | numbers, ranges=ranges))
        else:
            ranges = np.array([distance(text, wide.factor) for text in texts])
            beams = LaserScan(ranges, np.array(wide.angles))
        return replace(beams, time=sum(when) if when else np.nan)

    scans = [scan for scan in lines.each(scan_of) if scan is not None]
    if not scans:
        raise lines.no_scan("a line of a scan below the head")
    return Log(name, scans, None, lines.skipped, assumed=wide.told)


#: What a message says that says nothing.
_MESSAGE: dict[str, Any] = {"range_min": 0.0, "range_max": 0.0, "time_increment": 0.0}


# ------------------------------------------------------------------------ rostopic's own text
#: Ends a message.
END_OF_MESSAGE = "---"


def is_echo(path: Path) -> bool:
    """Whether a file is what `rostopic echo` or `ros2 topic echo` prints of a LaserScan."""
    words = {text.split(":")[0].strip() for _, text in sample(path, WIDE_SAMPLE_LINES)}
    return {"angle_min", "angle_increment"} <= words


def read_echo(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read such a text."""
    lines = Lines(path, on_error, "\n")
    scans: list[LaserScan] = []
    for said in _messages(lines):
        try:
            if "..." in said.get("ranges", ()):
                raise ValueError("its ranges are shortened: `ros2 topic echo --full-length` is not")
            numbers = {w: float_fields(said.get(w, []), w)[0] for w in SINGLE_NUMBERS if w in said}
            ranges = float_fields(said.get("ranges", []), "ranges")
            beams = beams_of_message(SimpleNamespace(**_MESSAGE | numbers, ranges=ranges))
            when = [
                time(said[word][0], unit=unit)
                for word, unit in (("secs", 1), ("sec", 1), ("nsecs", 1e-9), ("nanosec", 1e-9))
                if said.get(word)
            ]
            scans.append(replace(beams, time=sum(when) if when else np.nan))
        except (ValueError, LookupError, AttributeError) as fault:
            lines.damaged(lines.error(f"before it a scan is damaged ({fault})"))
    if not scans:
        raise lines.no_scan("messages of a LaserScan with ranges")
    return Log(name, scans, None, lines.skipped, assumed=(place_of(np.zeros(3)),))


def _messages(lines: Lines) -> Iterator[dict[str, list[str]]]:
    """Values of each message by their names, without the names of what holds them."""
    said: dict[str, list[str]] = {}
    key = ""
    for (text,) in lines:
        if text == END_OF_MESSAGE:
            if said:
                yield said
            said, key = {}, ""
            continue
        if found := re.match(r"-?\s*([A-Za-z_]\w*):\s*(.*)", text):
            key, text = found[1], found[2]
            said.setdefault(key, [])
        values = text.removeprefix("- ") if not text.startswith("[") else text
        said.setdefault(key, []).extend(
            value.replace(".nan", "nan").replace(".inf", "inf")
            for value in (v.strip(" []'\"") for v in values.split(","))
            if value
        )
    if "ranges" in said:
        yield said
    elif said and not lines.first and "angle_min" in said:
        raise LogError(lines.path, "is cut off within a message", lines.number)
