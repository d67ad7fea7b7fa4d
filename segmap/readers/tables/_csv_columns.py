"""Which column of a CSV file is what, and in which unit: by its header, or by its numbers, told."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .._lines import BROKEN, is_number, open_bytes

#: First words of a column's name.
ROLES = {
    "angle": ("angle", "theta", "bearing", "azimuth", "angule"),
    "range": ("range", "distance", "dist", "r"),
    "time": ("time", "timestamp", "stamp", "t"),
    "scan": ("scan", "frame", "rotation", "revolution", "sweep", "turn"),
}
#: Words that may stand beside them and change nothing.
FILLERS = ("id", "no", "nr", "number", "index", "value", "in")
CLOCKWISE = ("cw", "clockwise")
TURN_WORDS = (*CLOCKWISE, "ccw", "counterclockwise")
#: How each unit is written, and the metres, radians or seconds of it.
UNIT_WORDS: dict[str, dict[str, float]] = {
    "angle": {"deg degs degree degrees °": np.pi / 180, "rad rads radian radians": 1.0},
    "range": {
        "m meter meters metre metres": 1.0,
        "cm centimeter centimeters centimetres": 0.01,
        "mm millimeter millimeters millimetres": 0.001,
        "ft feet foot": 0.3048,
        "in inch inches": 0.0254,
    },
    "time": {
        "s sec secs second seconds": 1.0,
        "ms msec milliseconds": 1e-3,
        "us µs usec microseconds": 1e-6,
        "ns nsec nanoseconds": 1e-9,
    },
    "scan": {},
}
COLUMN_UNITS = {
    role: {word: factor for words, factor in units.items() for word in words.split()}
    for role, units in UNIT_WORDS.items()
}
EXAMPLE = "columns=['angle_deg', 'range_mm']"
#: So many lines are looked at for a header.
HEADER_LINES = 20
#: Ranges whose median is above this, and whole numbers, are millimetres where no unit is said.
LEAST_MILLIMETRES = 100
#: A first line of Excel that names the separator.
SEPARATOR_LINE = re.compile(r"(?i)sep=.")
#: No header is longer, in bytes.
LONGEST_HEADER_BYTES = 4096
#: How the programs of RPLidar begin a file ...
SLAMTEC_HEAD = "#RPLIDAR SCAN DATA"
#: ... of degrees, clockwise, and millimetres.
SLAMTEC_COLUMNS = ("angle_deg_cw", "range_mm", "quality")


class Column(NamedTuple):
    """One column: its place, what makes metres, radians or seconds of it, and its name."""

    place: int
    factor: float | None
    name: str


class Head(NamedTuple):
    """What the beginning of a file says: columns by role, what separates them, the line it is.

    Whether angles grow clockwise is None where it is not said.
    """

    columns: dict[str, Column]
    separator: str | None
    line: int
    clockwise: bool | None = None


def head_of(path: Path) -> Head | None:
    """The header of a file; None where it has none that names angle and range.

    A comment is one where the first line after it has as many fields, and numbers in its columns.
    """
    comment, count = None, 0
    for number, line in _beginning(path):
        if SEPARATOR_LINE.fullmatch(line):
            continue
        if line.startswith(SLAMTEC_HEAD):
            return head(SLAMTEC_COLUMNS, None, number)
        separator, names = split(line.lstrip("#"))
        found = None
        with suppress(ValueError):
            told = head(names, separator, number)
            found = told if {"angle", "range"} <= set(told.columns) else None
        if not line.startswith("#"):
            if comment is None:
                return found
            fields = [field.strip() for field in line.split(comment.separator)]
            fits = len(fields) == count and all(
                is_number(decimal(fields[column.place], comment.separator))
                for column in comment.columns.values()
            )
            return comment if fits else found
        comment, count = (found, len(names)) if found else (comment, count)
    return None


def first_row(path: Path) -> Head:
    """What separates the fields of a file, and the last line before its first row of numbers."""
    for number, line in _beginning(path):
        if not (line.startswith("#") or SEPARATOR_LINE.fullmatch(line)):
            separator, fields = split(line)
            numeric = all(is_number(decimal(field, separator)) for field in fields if field)
            return Head({}, separator, number - 1 if numeric else number)
    return Head({}, None, 0)


def head(names: Sequence[str], separator: str | None = None, line: int = 0) -> Head:
    """The columns that the names stand for; two of the same are a ValueError."""
    columns: dict[str, Column] = {}
    clockwise = None
    for place, name in enumerate(names):
        apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)  # `AngleInDegrees`
        words = re.findall(r"[a-zµ°]+", apart.lower().replace("μ", "µ"))
        if (role := _role(name, words)) is None:
            continue
        if role in columns:
            raise ValueError(f"{columns[role].name!r} and {name!r} are both columns of the {role}")
        units = [factor for word, factor in COLUMN_UNITS[role].items() if word in words[1:]]
        columns[role] = Column(place, units[0] if units else None, name.strip())
        if role == "angle" and (said := [w in CLOCKWISE for w in words if w in TURN_WORDS]):
            clockwise = any(said)
    return Head(columns, separator, line, clockwise)


def wanting(found: Head) -> str:
    """What keeps the columns from being read, and what to write; empty where nothing does."""
    for role in ("angle", "range"):
        if role not in found.columns:
            return f"no column is the {role}: name the columns, such as {EXAMPLE}"
    for role in ("angle", "range"):
        column = found.columns[role]
        if column.factor is None:
            short = ", ".join(words.split()[0] for words in UNIT_WORDS[role])
            return (
                f"the unit of {column.name!r} is not said ({short}): "
                f"write it into the header, or call segmap.readers.read_csv(path, {EXAMPLE})"
            )
    return ""


def split(line: str, known: str | None = None) -> tuple[str | None, list[str]]:
    """What separates the fields of a line, None for white space, and the fields."""
    separator = known or next((mark for mark in ";\t," if mark in line), None)
    closed = line if separator else re.sub(r"\s+(?=[\[(])", "", line)
    return separator, [field.strip().strip("\"'") for field in closed.strip().split(separator)]


def decimal(field: str, separator: str | None) -> str:
    """A number with a point; with a comma too, unless commas separate the fields.

    Examples
    --------
    >>> decimal("2000,5", ";"), decimal("2000.5", ",")
    ('2000.5', '2000.5')
    """
    return field if separator == "," else field.replace(",", ".", 1)


def with_units_told(found: Head, rows: Sequence[Sequence[str]]) -> tuple[Head, list[str]]:
    """A head whose units the numbers of its first rows tell, and what was taken from them.

    Angles that span more than a turn in radians are degrees. Ranges in whole numbers, half of them
    above 100, are millimetres. A time without a unit is left out.
    """
    columns, told = dict(found.columns), []
    if "time" in columns and columns["time"].factor is None:
        told.append(f"the column {columns.pop('time').name!r} says no unit: left out")
    for role in ("angle", "range"):
        column = columns.get(role)
        if column is None or column.factor is not None:
            continue
        fields = [row[column.place] for row in rows if len(row) > column.place]
        values = np.array([float(field) for field in fields if is_number(field)])
        values = values[np.isfinite(values) & (values != 0)]
        if not len(values):
            continue
        if role == "angle" and np.ptp(values) > 2 * np.pi + 0.1:
            columns[role] = column._replace(factor=np.pi / 180)
            told.append(f"{column.name!r} is in degrees, since it spans more than 2 pi")
        whole = (values == np.floor(values)).all()
        if role == "range" and whole and np.median(values) > LEAST_MILLIMETRES:
            columns[role] = column._replace(factor=0.001)
            told.append(f"{column.name!r} is in millimetres, since it holds whole numbers")
    return found._replace(columns=columns), told


def first_rows(path: Path, found: Head) -> list[list[str]]:
    """The fields of the first lines below a head."""
    below = (line for number, line in _beginning(path) if number > found.line)
    rows = (split(line, found.separator)[1] for line in below if not line.startswith("#"))
    return [[decimal(field, found.separator) for field in row] for row in rows]


def _role(name: str, words: Sequence[str]) -> str | None:
    """What a column is; None where another word than a unit stands in its name."""
    first = words[0] if words and not re.search("[0-9:]", name) else ""
    for role, names in ROLES.items():
        if first in names or first.removesuffix("s") in names:
            known = {*COLUMN_UNITS[role], *FILLERS, *TURN_WORDS}
            return role if known.issuperset(words[1:]) else None
    return None


def _beginning(path: Path) -> Iterator[tuple[int, str]]:
    """The first lines of a file that are not empty, with their numbers."""
    with suppress(*BROKEN, OSError), open_bytes(path) as file:
        for number in range(1, HEADER_LINES + 1):
            line = file.readline(LONGEST_HEADER_BYTES + 1)
            if len(line) > LONGEST_HEADER_BYTES:
                return
            if text := line.decode("utf-8-sig", "replace").strip():
                yield number, text
