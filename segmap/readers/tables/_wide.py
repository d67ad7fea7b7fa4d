"""How tables with a scan a line are written: where its beams stand, and where they point.

    %time,field.header.stamp,...,field.angle_min,...,field.ranges0,...    rostopic echo -p /scan
    160,250,laser,-1.57,1.57,0.0087,0,0.1,0.02,5.6,2.0,...               ros2 topic echo --csv
    time,-90,-89,...          directions in degrees or radians
    t,range_mm_0,range_mm_1   an index
    t,angle_0,range_0,...     directions in each line; or `t;angle,range`, whose pairs go on
    t,ranges                  a cell with a list: "[2.0, 2.1, ...]"; or all ranges that follow
    t,x,y,theta,r0,r1,...     the robot's pose by its wheels
    0.1,2.0,2.1,...           nothing but numbers, perhaps a time or their count first; or pairs
    0.1: 2.0, 2.1, ...        a time apart from the others

There is no truth, and without a pose no odometry.

Assumed: the laser sits at the robot's centre; where the file does not say it, the unit of ranges
and times, and over which angle so many beams look.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from ...arrays import LIMIT, Array
from ...scans import LaserScan
from .._lines import LogError, direction_field, distance, float_fields, is_number
from .._raw_scans import (
    COUNTERCLOCKWISE,
    URG_STEP,
    beams_of_message,
    centred,
    half_turn,
    place_of,
    view_of,
)
from ._columns import BEFORE_NAME, Column, Columns, named, with_units_told
from ._fields import (
    MEASURE,
    TABLE_COMMENTS,
    as_numbers,
    decimal,
    listed,
    sample,
    separator_of,
    split,
    with_units_behind,
)
from ._layout import Beams, Layout, unnamed, with_units

#: Numbers of a message, in the order in which `ros2 topic echo --csv` writes them.
SINGLE_NUMBERS = (
    *("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time"),
    *("range_min", "range_max"),
)
#: What a message says that says nothing.
UNSAID_NUMBERS: dict[str, Any] = {"range_min": 0.0, "range_max": 0.0, "time_increment": 0.0}
SHORTENED = "its ranges are shortened: `ros2 topic echo --full-length`, no --noarr, shows all"
#: Steps from angle to angle differ by less than such a share.
EVEN_SHARE = 0.1
#: So many ranges in a line make a scan.
LEAST_BEAMS = 6
#: So many numbers in a line without a head do.
LEAST_BARE_BEAMS = 30
#: A head stands among the first so many lines.
HEAD_ROWS = 20
#: What names of ranges begin with that are not called so.
SCAN_PREFIXES = r"(?i)(laser|lidar|scan|beam|ray|reading|sample|d|l|m|z)?s?[^a-z]*$"
#: And of angles.
ANGLE_PREFIXES = r"(?i)(a|ang)s?[^a-z]*$"
#: A name with the number of a beam or its direction, and perhaps the unit of its range.
NUMBERED = re.compile(
    r"(.*?)[\[_(\s]*(-?\d+(?:\.\d+)?)[\])°\s]*(?:deg|rad|[\[(_ ]*(mm|cm|m|ft|in)[\])]?)?"
)
#: So many lines tell what a file is.
WIDE_SAMPLE_LINES = 60
#: Beams of usual lasers -> over how many degrees they look.
VIEWS_DEG = {
    **{180: 180, 181: 180, 360: 360, 361: 180, 401: 100, 541: 270, 720: 360, 811: 270, 1080: 270},
    **{1081: 270, 1440: 360, 1141: 285},
}
URG_BEAMS = (681, 682, 683, 726, 768, 769)


def first_fields(path: Path) -> tuple[str | None, list[tuple[int, str]], list[list[str]]]:
    """What separates the fields of the first lines, these with their numbers, and their fields."""
    lines = [(k, text) for k, text in sample(path, WIDE_SAMPLE_LINES) if text]
    first = lines[0][0] if lines else 0
    lines = [(k, t) for k, t in lines if not t.startswith(TABLE_COMMENTS) or k == first]
    separator = separator_of([text for _, text in lines])
    return separator, lines, [split(text.lstrip("#"), separator) for _, text in lines]


def scans_of(path: Path) -> Layout | None:
    """How a file with a scan a line is written; None for another one."""
    separator, lines, rows = first_fields(path)
    for k, (row, below) in enumerate(pairwise(rows[:HEAD_ROWS])):
        if "" in below:  # of another topic, perhaps
            alike = [each for each in rows[k + 1 :] if len(each) == len(below)]
            below = max(alike, key=lambda each: sum(map(bool, each)))
        names = [BEFORE_NAME.sub("", name) for name in row]
        if is_number(row[0]) and not _are_directions(row, below):
            names[0] = "time" if _are_directions(row[1:], below[1:]) else names[0]
        more = _going_on(names, len(below))
        if _is_head(more, below):
            head = Layout(separator, lines[k][0], tuple(more))
            return with_head(path, head, rows[k + 1 :], goes_on=len(more) > len(names))
    return _ros2(path, separator, rows[0]) if rows else None


def of_records(
    path: Path, records: Sequence[Mapping[str, str]], names: Sequence[str] = ()
) -> tuple[Layout, Array]:
    """The same of records with a name beside each value, also of those of beams; and their rows.

    Names that are numbers say nothing: then what they name has to tell, or the caller.
    """
    labels = tuple(records[0])
    own = tuple(BEFORE_NAME.sub("", label) for label in labels)
    bare = [] if names else [k for k, name in enumerate(own) if name.isdecimal()]
    rows = [[said.get(label, "") for label in labels] for said in records]
    if not names and not bare and _is_head(own, rows[0], least=1):
        return with_head(path, Layout(None, 0, own, labels=labels), rows), np.empty(0)
    table = np.array([as_numbers(row) for row in rows])
    found = unnamed([", ".join(row[k] for k in bare) for row in rows], []) if bare else None
    columns = named(names or labels)
    if found and len(found.names) == len(bare):
        roles = {role: c._replace(place=bare[c.place]) for role, c in found.columns.by_role.items()}
        columns = found.columns._replace(by_role=columns.by_role | roles)
        told = dict(zip(bare, found.names, strict=True))
        own = tuple(told.get(k, name) for k, name in enumerate(own))
    head = Layout(None, 0, own, columns, labels, found.told if found else ())
    return with_units(head, table), table


def _going_on(names: Sequence[str], count: int) -> Sequence[str]:
    """Names for so many fields: of a head such as `t,ranges` or `t,angle,range,...` the last go on.

    They are numbered where they stand there several times, too.
    """
    names = [name for name in names if not name or name.strip(".…")]
    pair = {*named(names[-2:]).by_role} == {"angle", "range"}
    pair &= not {"x", "y"} <= {*named(names).by_role}  # whose heading it is
    last = names[-2:] if pair else names[-1:]
    begin = names.index(last[0]) if last else 0
    more, left = divmod(count - begin, max(len(last), 1))
    whole = [*names[:begin], *last * more]
    if left or more < 2 or whole[: len(names)] != names or "range" not in named(last).by_role:
        return names
    return [*names[:begin], *(f"{name}_{k}" for k in range(more) for name in last)]


def _is_head(row: Sequence[str], below: Sequence[str], least: int = LEAST_BEAMS) -> bool:
    """Whether fields are names of many ranges: a prefix and numbers, directions, or of a list."""
    if len(row) != len(below):
        return False
    if all(map(is_number, row)) and not _are_directions(row, below):
        return False
    if any(map(MEASURE.fullmatch, below)) and all(is_number(decimal(field)) for field in row):
        return False
    beams, numbers, prefix = _beams_in(row, below)
    least = 1 if any(name.endswith("angle_increment") for name in row) else least
    found = [part for place in beams.ranges for part in listed(below[place])]
    apart = len({*numbers}) == len(numbers) or bool(prefix)
    return len(found) >= least and apart and any(is_number(decimal(part)) for part in found)


def _are_directions(row: Sequence[str], below: Sequence[str]) -> bool:
    """Whether numbers lie evenly, unlike those below them, as angles above ranges do."""
    if len(row) < LEAST_BARE_BEAMS or len(row) != len(below):
        return False
    if not all(map(is_number, [*row, *below])):
        return False
    steps = np.diff(np.clip(np.nan_to_num(np.array([row, below], float)), -LIMIT, LIMIT))
    even = np.ptp(steps, axis=1) < EVEN_SHARE * np.abs(np.median(steps, axis=1))
    return bool(even[0] and not even[1])


def _beams_in(names: Sequence[str], below: Sequence[str]) -> tuple[Beams, list[float], str]:
    """Places of ranges and angles among columns, numbers in their names, what these begin with.

    Of several groups that of the ranges counts, else the largest: of two as large, none. Angles,
    as many, may stand in another group.
    """
    lists = [k for k, field in enumerate(below) if field.startswith(("[", "("))]
    roles = {k: {*named([names[k]]).by_role} for k in lists}
    if found := [k for k in lists if "range" in roles[k]]:
        turned = tuple(k for k in lists if "angle" in roles[k])
        return Beams((found[0],), directions=turned[:1]), [], names[found[0]]
    groups: dict[str, list[tuple[int, float]]] = {}
    for place, name in enumerate(names):
        plain = name.replace(",", ".")
        if match := NUMBERED.fullmatch(plain):
            prefix = f"range {match[3]}" if match[3] else match[1].lower()
            groups.setdefault(prefix, []).append((place, float(match[2])))
    kinds = {prefix: {*named([prefix.strip("_ ")]).by_role} for prefix in groups}
    turns = [p for p in groups if p and ("angle" in kinds[p] or re.match(ANGLE_PREFIXES, p))]
    sizes = {
        prefix: ("range" in kinds[prefix] or prefix.startswith("laser"), len(group))
        for prefix, group in groups.items()
        if "range" in kinds[prefix] or re.match(SCAN_PREFIXES, prefix)
    }
    if not sizes and len(turns) == 1 and len(groups[turns[0]]) >= LEAST_BEAMS:
        sizes, turns = {turns[0]: (False, 0)}, []  # ranges, by where they were measured
    first, *others = sorted(sizes, key=lambda prefix: sizes[prefix], reverse=True) or [""]
    if not sizes or any(sizes[other] == sizes[first] for other in others):
        return Beams(()), [], ""
    places, numbers = zip(*groups[first], strict=True)
    angles = [[p for p, _ in groups[t]] for t in turns if len(groups[t]) == len(places)]
    return Beams(places, directions=tuple(angles[0]) if angles else ()), [*numbers], first


def with_head(
    path: Path, head: Layout, rows: Sequence[Sequence[str]], *, goes_on: bool = False
) -> Layout:
    """How such a file is written; lines may have as many beams as they like."""
    names, rows = head.names, [row for row in rows if len(row) == len(head.names)]
    beams, numbers, prefix = _beams_in(names, rows[0])
    place = {name.lower(): k for k, name in enumerate(names)}
    table = np.array([as_numbers(row) for row in rows])
    if names[0] == "%time":  # nanoseconds
        clock = Column(place.get("header.stamp", place.get("stamp", 0)), 1e-9, "")
        columns, told = Columns({"time": clock}), list[str]()
    else:
        used = {*beams.ranges, *beams.directions}
        others = ["-" if k in used else name for k, name in enumerate(names)]
        columns = with_units_behind(_as_pose(named(others)), rows)
        columns, told = with_units_told(columns, table)
    if (turn := columns.by_role.get("angle")) and np.isfinite(table[:, turn.place]).any():
        raise LogError(
            path,
            f"a column of angles and {len(beams.ranges)} of ranges, a scan each: expected a scan a "
            f"line; pandas.read_csv(path, header=None).T.to_csv('turned.csv', index=False, "
            f"header=False) turns it",
            head.line,
        )
    if {"x", "y", "heading"} <= {*columns.by_role}:
        told.append(place_of(np.zeros(3)))
    if {"angle_min", "angle_increment"} <= {*place}:
        single = tuple((word, place[word]) for word in SINGLE_NUMBERS if word in place)
        told.append(place_of(np.zeros(3)))
        said = tuple(dict.fromkeys(told))
        return head._replace(columns=columns, told=said, beams=beams._replace(single=single))
    factor, unit = unit_of_ranges(prefix, _cells(rows, beams.ranges))
    if any(MEASURE.fullmatch(rows[0][k]) for k in beams.ranges):
        factor, unit = 1.0, []
    if beams.directions:
        first = re.sub(r"(?i)^(a|ang)s?(?=[^a-z])", "angle", names[beams.directions[0]])
        flat = _cells(rows, beams.directions).reshape(-1, 1)
        column = with_units_told(named([first.rstrip("0123456789 _[](")]), flat)[0]
        radian = column.by_role["angle"].factor or 1.0
        told += [*unit, f"angles are in {'radians' if radian == 1 else 'degrees'}"]
        told, angles = [*told, COUNTERCLOCKWISE], np.empty(0)
        beams = beams._replace(radian=radian)
    elif not numbers or (
        numbers[0] in (0, 1) and (np.diff(numbers) == 1).all() and len(numbers) not in (360, 361)
    ):
        angles = usual_view(len(_cells(rows[:1], beams.ranges)))
        told += [view_of(angles), *unit]
    else:
        whole = all(number % 1 == 0 for number in numbers)
        is_radians = not whole and np.ptp(numbers) <= 2 * np.pi + 0.1
        angles = np.array(numbers) if is_radians else np.radians(numbers)
        told.append(f"the head holds {'radians' if is_radians else 'degrees'}, counter-clockwise")
        told += unit
    beams = beams._replace(factor=factor, angles=tuple(angles), goes_on=goes_on)
    return head._replace(columns=columns, told=tuple(told), beams=beams)


def _cells(rows: Sequence[Sequence[str]], places: Sequence[int]) -> Array:
    """All numbers of some columns, `(m,)`."""
    cells = (part for row in rows for k in places for part in listed(row[k]))
    return np.array(as_numbers([*cells]))


def _as_pose(found: Columns) -> Columns:
    """Columns beside ranges: with x and y an angle is the heading of the robot."""
    columns = dict(found.by_role)
    if {"x", "y", "angle"} <= {*columns}:
        columns["heading"] = columns.pop("angle")
    return found._replace(by_role=columns)


def unit_of_ranges(prefix: str, values: Array) -> tuple[float, list[str]]:
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


def usual_view(count: int) -> Array:
    """Where so many beams of one of the usual lasers point."""
    if count in URG_BEAMS:
        return centred(count, URG_STEP)
    wide = np.radians(VIEWS_DEG.get(count, 360))
    if wide <= np.pi:
        return half_turn(count) if np.isclose(wide, np.pi) else centred(count, wide / (count - 1))
    if wide > 6:  # a whole turn begins ahead
        return np.arange(count) * wide / count
    return centred(count, wide / (count - count % 2))


def _ros2(path: Path, separator: str | None, row: Sequence[str]) -> Layout | None:
    """What `ros2 topic echo --csv` writes: seconds, nanoseconds, frame, numbers, ranges.

    Also what `rostopic echo -p` does, without its head: time, number, stamp, frame and so on.
    """
    frame = next((k for k, field in enumerate(row[:4]) if not is_number(field)), 0)
    begin = frame + 1 + len(SINGLE_NUMBERS)
    if "..." in row:
        raise LogError(path, SHORTENED)
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
    clock: Any = {"time": Column(0, 1.0, ""), "nanosec": Column(1, 1e-9, "")}
    if frame > 2:
        clock = {"time": Column(2, 1e-9, "")}
    single = tuple((word, frame + 1 + k) for k, word in enumerate(SINGLE_NUMBERS))
    told = (place_of(np.zeros(3)),)
    return Layout(separator, 0, (), Columns(clock), told=told, beams=Beams(places, single=single))


def scan_in(fields: Sequence[str], beams: Beams) -> LaserScan:
    """The beams that stand in a line."""
    texts, turned = (
        [decimal(part) for k in places for part in listed(fields[k])]
        for places in (beams.places(each, len(fields)) for each in (beams.ranges, beams.directions))
    )
    if beams.single:
        numbers = {word: float_fields([fields[k]], word)[0] for word, k in beams.single}
        ranges = float_fields(texts, "ranges")
        return beams_of_message(SimpleNamespace(**UNSAID_NUMBERS | numbers, ranges=ranges))
    ranges = np.array([distance(text, beams.factor) for text in texts])
    ranges[ranges < beams.least] = np.nan
    if not turned and len(ranges) != len(beams.angles):
        return LaserScan(ranges, usual_view(len(ranges)))
    angles = [direction_field(text, beams.radian) for text in turned]
    return LaserScan(ranges, np.array(angles or beams.angles))
