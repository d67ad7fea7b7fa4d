"""Tables with a scan a line: angles or an index as head, ROS's own text of a `LaserScan`, or bare.

    %time,field.header.stamp,...,field.angle_min,...,field.ranges0,...    rostopic echo -p /scan
    160,250,laser,-1.57,1.57,0.0087,0,0.1,0.02,5.6,2.0,...               ros2 topic echo --csv
    ranges: [2.0, 2.1, ...]   among other keys, `---` after each scan     rostopic echo /scan
    time,-90,-89,...          directions in degrees or radians
    t,range_mm_0,range_mm_1   an index
    t,angle_0,range_0,...     directions in each line
    t,x,y,theta,r0,r1,...     the robot's pose by its wheels
    0.1,2.0,2.1,...           nothing but numbers, perhaps a time or their count first

Lists may stand in brackets. There is no truth, and without a pose no odometry.

Assumed: the laser sits at the robot's centre; where the file does not say it, the unit of ranges
and times, and over which angle so many beams look.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...scans import LaserScan, Log
from .._lines import (
    Lines,
    LogError,
    direction_field,
    distance,
    float_fields,
    is_number,
    number_field,
    time,
)
from .._raw_scans import (
    COUNTERCLOCKWISE,
    URG_STEP,
    beams_of_message,
    centred,
    half_turn,
    place_of,
    view_of,
)
from ._columns import BEFORE_NAME, Columns, named, with_units_told
from ._fields import TABLE_COMMENTS, decimal, moment, sample, separator_of, split
from ._rostopic import SHORTENED, SINGLE_NUMBERS, UNSAID_NUMBERS

#: So many ranges in a line make a scan.
LEAST_BEAMS = 6
#: So many numbers in a line without a head do.
LEAST_BARE_BEAMS = 30
#: So many numbers that rise from line to line are times.
LEAST_TIMES = 5
#: A head stands among the first so many lines.
HEAD_ROWS = 20
#: What names of ranges begin with that are not called so.
SCAN_PREFIXES = r"(?i)(laser|lidar|scan|beam|ray|reading|sample|d|l|m|z)?s?[^a-z]*$"
#: And of angles.
ANGLE_PREFIXES = r"(?i)(a|ang)s?[^a-z]*$"
#: Roles of the columns of a pose.
POSE_ROLES = ("x", "y", "heading")
#: So many lines tell what a file is.
WIDE_SAMPLE_LINES = 60
#: Beams of usual lasers -> over how many degrees they look.
VIEWS_DEG = {
    180: 180,
    181: 180,
    360: 360,
    361: 180,
    401: 100,
    541: 270,
    720: 360,
    811: 270,
    1080: 270,
}
VIEWS_DEG |= {1081: 270, 1440: 360, 1141: 285}
URG_BEAMS = (681, 682, 683, 726, 768, 769)
#: Before the ranges of a line that nobody names stand so many other numbers, if any.
MOST_OTHERS = 3


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
    directions: tuple[int, ...] = ()  #: where angles stand in each line
    radian: float = 1.0  #: of these
    pose: tuple[tuple[int, float], ...] = ()  #: places of x, y and heading, each with its unit


def wide_of(path: Path) -> Wide | None:
    """How a file with a scan a line is written; None for another one."""
    lines = [(k, text) for k, text in sample(path, WIDE_SAMPLE_LINES) if text]
    first = lines[0][0] if lines else 0
    lines = [(k, t) for k, t in lines if not t.startswith(TABLE_COMMENTS) or k == first]
    if not lines:
        return None
    separator = separator_of([text for _, text in lines])
    rows = [split(text.lstrip("#"), separator) for _, text in lines]
    found: Wide | str | None
    for k, (row, below) in enumerate(pairwise(rows[:HEAD_ROWS])):
        names = [BEFORE_NAME.sub("", name) for name in _spread(row, below)]
        if _is_head(names, _flat(below)):
            found = _with_head(separator, lines[k][0], names, [*map(_flat, rows[k + 1 :])])
            break
    else:
        k, found = 0, _ros2(separator, rows)
    if isinstance(found, str):
        raise LogError(path, found, lines[k][0])
    return found


def _flat(fields: Sequence[str]) -> list[str]:
    """Fields of a line, those of a list in one cell too."""
    return [part for field in fields for part in _parts(field)]


def _parts(field: str) -> list[str]:
    return re.findall(r"[^\s,()\[\]]+", field) if field.startswith(("(", "[")) else [field]


def _spread(names: Sequence[str], below: Sequence[str]) -> list[str]:
    """Names of columns; of a column whose cells are lists, one for each number of the first."""
    if len(names) != len(below):
        return list(names)
    counts = [len(_parts(field)) for field in below]
    return [
        f"{name}{k}" if count > 1 else name
        for name, count in zip(names, counts, strict=True)
        for k in range(count)
    ]


def bare_of(path: Path) -> Wide | None:
    """The same for lines of nothing but numbers, as many in each: a guess, and a last resort."""
    lines = [t for _, t in sample(path, WIDE_SAMPLE_LINES) if not t.startswith(TABLE_COMMENTS)]
    separator = separator_of(lines)
    rows = [[*map(decimal, split(text, separator))] for text in lines]
    width = max(map(len, rows), default=0)
    whole = [row for row in rows if len(row) == width and all(map(is_number, row))]
    heads = [row for row in rows[:1] if len(row) == width and not any(map(is_number, row))]
    if width < LEAST_BARE_BEAMS or 2 * len(whole) <= len(rows) or heads:
        return None
    table = np.array(whole, float)
    first = table[:, 0]
    clock = len(first) >= LEAST_TIMES and bool((np.diff(first) > 0).all())
    at: tuple[tuple[int, float], ...] = ()
    told: list[str] = []
    if clock:
        columns, told = with_units_told(named(["time"]), np.repeat(table[:, :1], 3, 0))
        at = ((0, columns.by_role["time"].factor or 1.0),) if "time" in columns.by_role else ()
    begin = int(clock)
    counts = [k + 1 for k in (begin, begin + 1) if (table[:, k] == width - k - 1).all()]
    usual, others = {*VIEWS_DEG, *URG_BEAMS}, range(1, MOST_OTHERS + 1)
    other = next((n for n in others if width - begin - n in usual), 0)
    if other and not counts and width - begin not in usual:
        raise LogError(
            path,
            f"lines of {width} numbers, {width - begin - other} of them ranges behind "
            f"{begin + other} others? A line above that names them says so: time_s,x_m,y_m,"
            f"theta_rad, or `-` for what is none of these, and r0,r1,r2,...",
        )
    places = tuple(range(max([begin, *counts]), width))
    factor, unit = _unit_of_ranges("", table[:, places])
    angles = _view(len(places))
    told += [*unit, view_of(angles), f"lines of {width} numbers are scans"]
    return Wide(separator, 0, places, factor, at, (), tuple(angles), tuple(told))


def _is_head(row: Sequence[str], below: Sequence[str]) -> bool:
    """Whether fields are names of many ranges: a prefix and numbers, or directions."""
    places, numbers, prefix, _ = _ranges_in(row)
    least = 1 if any(name.endswith("angle_increment") for name in row) else LEAST_BEAMS
    if len(places) < least or len(row) != len(below) or all(map(is_number, row)):
        return False
    apart = len({*numbers}) == len(numbers) or bool(prefix)
    return apart and any(is_number(below[k].replace(",", ".")) for k in places)


def _ranges_in(names: Sequence[str]) -> tuple[list[int], list[float], str, list[int]]:
    """Places of ranges among columns, the numbers in their names, what these begin with, angles.

    Of several groups that of the ranges counts, else the largest: of two as large, none. Angles,
    as many, may stand in another group.
    """
    groups: dict[str, list[tuple[int, float]]] = {}
    for place, name in enumerate(names):
        if found := re.fullmatch(r"(.*?)[\[_(\s]*(-?\d+(?:\.\d+)?)[\])°\s]*(deg|rad)?", name):
            groups.setdefault(found[1].lower(), []).append((place, float(found[2])))
    roles = {prefix: {*named([prefix.strip("_ ")]).by_role} for prefix in groups}
    turns = [p for p in groups if p and ("angle" in roles[p] or re.match(ANGLE_PREFIXES, p))]
    sizes = {
        prefix: ("range" in roles[prefix] or prefix.startswith("laser"), len(group))
        for prefix, group in groups.items()
        if "range" in roles[prefix] or re.match(SCAN_PREFIXES, prefix)
    }
    first, *others = sorted(sizes, key=lambda prefix: sizes[prefix], reverse=True) or [""]
    if not sizes or any(sizes[other] == sizes[first] for other in others):
        return [], [], "", []
    places, numbers = ([pair[k] for pair in groups[first]] for k in (0, 1))
    angles = [[p for p, _ in groups[t]] for t in turns if len(groups[t]) == len(places)]
    return [*map(int, places)], numbers, first, angles[0] if angles else []


def _with_head(
    separator: str | None, line: int, names: Sequence[str], rows: Sequence[Sequence[str]]
) -> Wide | str:
    """How such a file is written, or why it cannot be read."""
    places, numbers, prefix, directions = _ranges_in(names)
    place = {name.lower(): k for k, name in enumerate(names)}
    single = tuple((word, place[word]) for word in SINGLE_NUMBERS if word in place)
    texts = [[*map(decimal, row)] for row in rows if len(row) == len(names)]
    table = np.array([[float(f) if is_number(f) else np.nan for f in row] for row in texts])
    table, told = table.reshape(-1, len(names)), list[str]()
    pose: tuple[tuple[int, float], ...] = ()
    if names[0] == "%time":  # nanoseconds
        at: tuple[tuple[int, float], ...] = ((place.get("header.stamp", 0), 1e-9),)
    else:
        others = ["-" if k in {*places, *directions} else name for k, name in enumerate(names)]
        columns, told = with_units_told(_as_pose(named(others)), table)
        clock = columns.by_role.get("time")
        at = () if clock is None else ((clock.place, clock.factor or 1.0),)
        if (turn := columns.by_role.get("angle")) and np.isfinite(table[:, turn.place]).any():
            return (
                f"a column of angles and {len(places)} of ranges, a scan each: expected a scan a "
                f"line; pandas.read_csv(path, header=None).T.to_csv('turned.csv', index=False, "
                f"header=False) turns it"
            )
        if {*POSE_ROLES} <= {*columns.by_role}:
            found = [columns.by_role[role] for role in POSE_ROLES]
            pose = tuple((column.place, column.factor or 1.0) for column in found)
            told.append(place_of(np.zeros(3)))
    if {"angle_min", "angle_increment"} <= {*place}:
        told.append(place_of(np.zeros(3)))
        return Wide(separator, line, tuple(places), 1.0, at, single, (), tuple(told))
    factor, unit = _unit_of_ranges(prefix, table[:, places])
    if directions:
        flat = table[:, directions].reshape(-1, 1)
        first = re.sub(r"(?i)^(a|ang)s?(?=[^a-z])", "angle", names[directions[0]])
        column = with_units_told(named([first.rstrip("0123456789 _[](")]), flat)[0]
        radian = column.by_role["angle"].factor or 1.0
        told += [*unit, f"angles are in {'radians' if radian == 1 else 'degrees'}"]
        more = (*told, COUNTERCLOCKWISE), tuple(directions), radian, pose
        return Wide(separator, line, tuple(places), factor, at, (), (), *more)
    steps = np.diff(numbers)
    if (steps == 1).all() and numbers[0] in (0, 1) and len(numbers) not in (360, 361):
        angles = _view(len(numbers))
        told.append(view_of(angles))
    else:
        whole = all(number % 1 == 0 for number in numbers)
        is_radians = not whole and np.ptp(numbers) <= 2 * np.pi + 0.1
        angles = np.array(numbers) if is_radians else np.radians(numbers)
        told.append(f"the head holds {'radians' if is_radians else 'degrees'}, counter-clockwise")
    said = tuple(angles), (*told, *unit)
    return Wide(separator, line, tuple(places), factor, at, (), *said, pose=pose)


def _as_pose(found: Columns) -> Columns:
    """Columns beside ranges: with x and y an angle is the heading of the robot."""
    columns = dict(found.by_role)
    if {"x", "y", "angle"} <= {*columns}:
        columns["heading"] = columns.pop("angle")
    return found._replace(by_role=columns)


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


def _ros2(separator: str | None, rows: Sequence[Sequence[str]]) -> Wide | str | None:
    """What `ros2 topic echo --csv` writes: seconds, nanoseconds, frame, numbers, ranges.

    Also what `rostopic echo -p` does, without its head: time, number, stamp, frame and so on.
    """
    row = rows[0]
    frame = next((k for k, field in enumerate(row[:4]) if not is_number(field)), 0)
    begin = frame + 1 + len(SINGLE_NUMBERS)
    if "..." in row:
        return SHORTENED
    if separator != "," or frame < 2 or len(row) <= begin:
        return None
    if not all(map(is_number, row[frame + 1 : begin])):
        return None
    first, last, step = map(float, row[frame + 1 : frame + 4])
    steps = (last - first) / step if step else np.nan
    count = round(steps) + 1 if np.isfinite(steps) else 0
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
    lines = Lines(path, on_error, "\n", TABLE_COMMENTS)
    last = max(wide.ranges)

    def scan_of(fields: list[str]) -> LaserScan | None:
        if lines.number <= wide.line:
            return None
        found = [*map(decimal, _flat(split(fields[0], wide.separator)))]
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
            beams = beams_of_message(SimpleNamespace(**UNSAID_NUMBERS | numbers, ranges=ranges))
        else:
            ranges = np.array([distance(text, wide.factor) for text in texts])
            turned = [direction_field(found[k], wide.radian) for k in wide.directions]
            beams = LaserScan(ranges, np.array(turned or wide.angles))
        pose = np.array([number_field(found[k], "the pose", unit) for k, unit in wide.pose])
        seconds = sum(when) if when else np.nan
        return replace(beams, time=seconds, odometry=pose if len(pose) else None)

    scans = [scan for scan in lines.each(scan_of) if scan is not None]
    if not scans:
        raise lines.no_scan("a line of a scan below the head")
    return Log(name, scans, None, lines.skipped, assumed=wide.told)
