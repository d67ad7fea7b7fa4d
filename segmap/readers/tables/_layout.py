"""How a table is written: what separates its fields, where its rows begin, what its columns are.

The columns are those that the caller names, or a file `NAME.toml` beside the table, or a program
that many use, told by its own words, or the head of the table.
"""

from __future__ import annotations

import csv
import re
import tomllib
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ... import arrays
from ...arrays import brief
from ..lines import NOT_MEASURED, Lines, LogError, is_number
from ..packed import read_text
from ._columns import meaning, missing_in, named, places_of

#: Separators of fields, the first that most first rows hold; else white space.
SEPARATORS = ";\t|,"
#: What begins a comment, and a line by which Excel names a separator.
COMMENTS = ("#", "%", "//", "sep=")
#: So many lines tell how a file is written.
SAMPLE_LINES = 60
#: Of more columns nobody chooses the angle: they are a scan a row, if anything.
MOST_COLUMNS = 12
#: The number at the end of a name that is one of many alike.
COUNTED = re.compile(r"(.*?)[\s_.\[(]*(\d+)[\])]?(.*)")
#: What names of columns do not say, in words.
Missing = Callable[[Sequence[str]], str]
#: A beam points nowhere beyond two turns.
MOST_VIEW_DEG = 720.0
SAID_BESIDE = "expected columns = 'angle_deg,range_mm', and of a scan a row view = [-90, 90]"


class Layout(NamedTuple):
    """How a table is written."""

    names: tuple[str, ...] = ()  #: of its columns from the left
    line: int = 0  #: of its head: rows are below it
    separator: str | None = ","
    decimal: str = "."
    view: tuple[float, float] | None = None  #: of a scan a row: its first and last beam, degrees
    pattern: str = ""  #: of a beam in a line, where no separator parts fields
    mark: str = ""  #: the pattern of what each of these lines holds
    told: tuple[str, ...] = ()
    head: tuple[str, ...] = ()  #: what the file itself calls its columns
    kinds: tuple[bool, ...] = ()  #: whether a column holds numbers, and no words
    rows: tuple[str, ...] = ()  #: the first of its lines with numbers

    @property
    def is_headed(self) -> bool:
        """Whether a name in the head is one that a column of a log may have."""
        return any(column and column.role != "time" for column in map(meaning, self.head))

    @property
    def is_whole(self) -> bool:
        """Whether it says all that a log needs."""
        return bool(self.names) and (self.view is not None or "ranges" not in places_of(self.names))


class Program(NamedTuple):
    """A program whose text has words that no other writes."""

    name: str
    word: str  #: the pattern of what the text holds
    mark: str  #: of what each line with a beam holds
    beam: str  #: of a beam, whose groups are the columns
    columns: str


PROGRAMS = (
    Program(
        "ultra_simple of RPLidar's SDK", r"theta: *\d+\.\d\d +Dist: *\d{5}\.\d\d", "theta:",
        r"^\s*(S?)\s*theta: *(\d{1,3}\.\d\d) +Dist: *(\d{5}\.\d\d)", "new,angle_deg_cw,range_mm",
    ),
    Program(
        "record_measurments of the package rplidar", r"^(True|False)\t\d+\t[\d.]+\t[\d.]+$", "\t",
        r"^(True|False)\t\d+\t([\d.]+)\t([\d.]+)$", "new,angle_deg_cw,range_mm",
    ),
    Program(
        "LD06 and LD19", r"angle:[\d.]+,distance\(mm\):", r"distance\(",
        r"(?:stamp\(ns\):(\d+),)?angle:([\d.]+),distance\(mm\):(\d+)",
        "time_ns,angle_deg_cw,range_mm",
    ),
    Program(
        "GetLDSScan of Neato and XV-11", "AngleInDegrees,DistInMM,Intensity,ErrorCodeHEX", r"^\d",
        r"^(\d{1,3}),(\d+),\d+,([0-9A-Fa-f]+)$", "angle_deg,range_mm,error",
    ),
)  # fmt: skip
#: Words of a head that one program alone writes -> what it means.
HEADS = {
    "angule distance quality": "angle_deg_cw,range_mm,-",  # frame_grabber of SLAMTEC
    "new_scan quality angle distance": "new,-,angle_deg_cw,range_mm",  # the package rplidar
}


def fields_of(row: str, separator: str | None) -> list[str]:
    """The fields of a row; a separator between quotes is none."""
    if separator and '"' in row:
        with suppress(csv.Error):
            return [field.strip() for field in next(csv.reader([row], delimiter=separator))]
    return [field.strip().strip("'") for field in row.split(separator)]


def first_lines(path: Path) -> list[tuple[int, str]]:
    """The first lines that are not empty, comments too, with their numbers."""
    lines = Lines(path, "skip", "\n", comments="")
    with suppress(LogError):
        return [(lines.number, text) for (text,) in islice(lines, SAMPLE_LINES)]
    return []


def layout_of(path: Path) -> Layout:
    """How a table is written, and its columns; no `names` where it says too little of them."""
    rows = [text for _, text in first_lines(path)]
    for program in PROGRAMS:
        if any(re.search(program.word, row) for row in rows):
            told = (f"a text of {program.name}",)
            names = named(program.columns)
            return Layout(names, pattern=program.beam, mark=program.mark, told=told)
    found = layout_as_written(path)
    if columns := HEADS.get(" ".join(found.head).lower()):
        told = ("columns as the makers of RPLidar mean them",)
        return found._replace(names=named(columns), told=told)
    names = tuple(name for name, _ in merged(found.head))
    return found if missing_in(names) else found._replace(names=names)


def layout_as_written(path: Path) -> Layout:
    """Separator, decimal mark, first row and head of a table.

    Rows are the lines whose fields are numbers and words as those of most lines are.
    """
    lines = first_lines(path)
    body = [text for _, text in lines if not text.startswith(COMMENTS)]
    mark = next((m for m in SEPARATORS if 2 * sum(m in row for row in body) > len(body)), None)
    if mark == "," and 2 * sum(bool(re.search(r"\d,\d+\s+-?\d+", row)) for row in body) > len(body):
        mark = None  # numbers with decimal commas between white space
    comma = mark != "," and any(re.search(r"\d,\d", row) for row in body)

    def kind(row: str) -> tuple[bool, ...]:
        fields = fields_of(row.replace(",", ".") if comma else row, mark)
        return tuple(is_number(field) or field.lower() in NOT_MEASURED for field in fields)

    kinds = Counter(kind(row) for row in body if row[0] not in "[{(")
    usual = max((k for k in kinds if sum(k) > 1), key=kinds.__getitem__, default=())
    usual = usual if 2 * kinds[usual] >= len(body) else ()
    fits = (not text.startswith(COMMENTS) and kind(text) == usual for _, text in lines)
    begin = next((k for k, is_row in enumerate(fits) if is_row), None)
    if not usual or begin is None:
        return _head_alone(lines)
    first = next(k for k, (_, text) in enumerate(lines) if not text.startswith(COMMENTS))
    while (
        begin > first + 1 and len(usual) == len(above := kind(lines[begin - 1][1])) and any(above)
    ):
        begin -= 1  # a damaged row
    rows = tuple(text for _, text in lines[begin:] if not text.startswith(COMMENTS))
    heads = [_head(text, mark, rows[0]) for _, text in reversed(lines[:begin])]
    heads = [head for head in heads if len(head) == len(usual)]
    head = max(heads, key=lambda names: sum(map(bool, map(meaning, names))), default=())
    line = lines[begin - 1][0] if begin else 0
    return Layout((), line, mark, "," if comma else ".", head=head, kinds=usual, rows=rows)


def _head_alone(lines: Sequence[tuple[int, str]]) -> Layout:
    """The layout of a table with a head that says all, and no row that is whole."""
    for number, text in lines:
        mark = next((m for m in SEPARATORS if m in text), None)
        head = _head(text, mark, "")
        if not missing_in(head):
            return Layout((), number, mark, head=head, kinds=(True,) * len(head))
    return Layout()


def _head(text: str, mark: str | None, row: str) -> tuple[str, ...]:
    """The names in a line above the rows, a comment perhaps, whose separator may be another."""
    bare = re.sub(r"\s+(?=[\[(])", "", text.lstrip("#%/!; ") if text.startswith(COMMENTS) else text)
    own = mark if mark is None or mark in bare else next((m for m in SEPARATORS if m in bare), None)
    names = fields_of(bare, own)
    is_open = mark and len(names) + 1 == len(fields_of(row, mark)) and row.endswith(mark)
    return (*names, "") if is_open else tuple(names)


def merged(head: Sequence[str]) -> list[tuple[str, int]]:
    """Names of a head, and how many columns each has: those that count up are one of `ranges`."""
    found: list[tuple[str, int]] = []
    before = None
    for name in head:
        part = COUNTED.fullmatch(name)
        column = meaning(f"{part[1]} {part[3]}") if part else None
        here = None
        if part and column and column.role == "range":
            here = part[1], part[3], int(part[2])
        if column and here and before == (*here[:2], here[2] - 1):
            found[-1] = column._replace(role="ranges").name, found[-1][1] + 1
        else:
            found.append((name, 1))
        before = here
    return found


def said_beside(path: Path, missing: Missing = missing_in) -> Layout | None:
    """What the file NAME.toml beside a table says; None without one."""
    beside = path.parent / f"{path.name}.toml"
    try:
        if not (path.is_file() and beside.is_file()):
            return None
    except OSError:  # a name that is too long
        return None
    try:
        return declared_layout(path, **tomllib.loads(read_text(beside)), missing=missing)
    except (ValueError, TypeError) as fault:
        raise LogError(beside, f"{SAID_BESIDE}: {fault}") from fault


def declared_layout(
    path: Path, columns: str | Sequence[str], view: Any = None, *, missing: Missing = missing_in
) -> Layout:
    """A layout whose columns, and whose view where a row is a scan, somebody names."""
    names = named(columns)
    if fault := missing(names):
        raise ValueError(f"columns do not say enough: {fault}")
    return layout_as_written(path)._replace(names=names, view=checked_view(view))


def checked_view(view: Any) -> tuple[float, float] | None:
    """Where the first and the last range of a row point, two numbers in degrees."""
    if view is None:
        return None
    ends = arrays.numbers(view, "view")
    if ends.shape != (2,) or not (np.abs(ends) <= MOST_VIEW_DEG).all():
        raise ValueError(f"view must be two directions in degrees, got {brief(view)}")
    return float(ends[0]), float(ends[1])
