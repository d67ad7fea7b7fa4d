"""How a table is written: what separates its fields, where its rows begin, what its columns are.

The columns are those that the caller names, or a file `NAME.toml` beside the table, or a program
that many use, told by its own words, or the head of the table.
"""

from __future__ import annotations

import csv
import re
import tomllib
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from itertools import groupby, islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ... import arrays
from ...arrays import brief
from ..lines import NOT_MEASURED, Lines, LogError, is_number
from ..packed import read_text
from ._columns import (
    TURNS,
    UNIT_WORDS,
    column_names,
    meaning,
    missing_in,
    places_of,
    ranges_in,
    words_of,
)
from ._ros import names_in_ros

#: Separators of fields, the first that most first rows hold; else white space.
SEPARATORS = ";\t|,"
#: What begins a comment, and a line by which Excel names a separator.
COMMENTS = ("#", "%", "//", "sep=", "----", "+--", "|--", "| --")
#: A line of words that begins as a comment does, wherever it stands.
COMMENT = re.compile(rb"(?m)^[ \t]*(?:#|%|//).*")
#: A line that says something, not how the table is drawn or its fields are parted.
IN_WORDS = re.compile(r"(?!sep=).*\w")
#: Lines that are read to learn how a file is written.
SAMPLE_LINES = 60
#: The number in a name that is one of many alike.
COUNTED = re.compile(r"-?\d+(?:\.\d+)?")
#: A number whose thousands a mark may part.
THOUSANDS = r"[-+]?[1-9]\d{0,2}(?:[.,'\u2019\xa0\u202f]\d{3})+(?:[.,]\d+)?"
#: A number with a comma in it, and another, with white space between them.
COMMA_IN_NUMBER = re.compile(r"\d,\d+\s+-?\d|\d\s+-?\d+,\d+(?:\s|$)")
#: What says in a line of words which way angles grow.
WAY_IN_WORDS = re.compile(
    r"(?i)clock[- ]?wise|uhrzeiger|orari|horaire|mirror|flipped|(?<![a-z])c?cw(?![a-z])|"
    r"\b(?:left|right|links|rechts)\b"
)
#: A beam points nowhere beyond two turns.
MOST_VIEW_DEG = 720.0
NUMBERS_UNSAID = (
    "whether a mark parts thousands in {0}, or is its decimal mark, is not said: one of the two "
    "lines in the middle writes it so that all programs read it\n"
    "    from pathlib import Path\n"
    "    text = Path({1!r}).read_text('utf-8').replace(',', '')  # as 1,234.5 has it\n"
    "    text = Path({1!r}).read_text('utf-8').replace('.', '').replace(',', '.')  # as 1.234,5\n"
    "    Path('{2}_numbers.csv').write_text(text.replace(';', ','){3})"
)
SAID_BESIDE = "expected columns = 'angle_deg,range_mm', and of a scan a row view = [-90, 90]"


class Layout(NamedTuple):
    """How a table is written."""

    names: tuple[str, ...] = ()  #: names of its columns from the left
    line: int = 0  #: number of the line of its head: rows are below it
    separator: str | None = ","
    decimal: str = "."
    view: tuple[float, float] | None = None  #: first and last beam of a scan a row, degrees
    pattern: str = ""  #: pattern of a line with numbers between words; its groups are the columns
    mark: str = ""  #: pattern that each line of this kind matches; any other line is damaged
    notes: tuple[str, ...] = ()
    unsaid: str = ""  #: what the file does not say of its numbers, whatever its columns are
    head: tuple[str, ...] = ()  #: what the file itself calls its columns
    kinds: tuple[bool, ...] = ()  #: whether a column holds numbers, and no words
    rows: tuple[str, ...] = ()  #: the first lines with numbers
    words: tuple[str, ...] = ()  #: the first lines, comments too, without numbers or the head

    @property
    def is_whole(self) -> bool:
        """Whether it says all that a log needs."""
        roles = {*places_of(self.names)}
        has_view = self.view is not None or "ranges" not in roles or "angle_min" in roles
        return bool(self.names) and has_view and not self.unsaid

    @property
    def columns(self) -> str:
        """Its names, those that repeat once."""
        return ",".join(name for name, _ in groupby(self.names))

    @property
    def way_in_words(self) -> str:
        """The line or column that says which way angles grow, where the angle's name does not."""
        turned = [name for name in self.head if TURNS & {*words_of(name)}]
        if any(column and column.is_whole for column in map(meaning, turned)):
            return ""
        lines = (*self.words, *self.rows[:1])  # a column may say it for each beam
        return next(iter((*turned, *filter(WAY_IN_WORDS.search, lines))), "")

    def clean(self, number: str) -> str:
        """A number as Python writes it."""
        return number.translate(str.maketrans(",.", ".,")) if self.decimal == "," else number

    def fields(self, row: str) -> list[str]:
        """The fields of a row."""
        return fields_of(row, self.separator)


class Program(NamedTuple):
    """A program whose text has words that no other writes."""

    name: str
    word: str  #: pattern that only the text of this program matches
    mark: str  #: pattern that each line with a beam matches
    beam: str  #: pattern of a beam; its groups are the columns
    columns: str


#: A beam as record_measurments writes it, or as Python prints it.
RPLIDAR = r"\(?(True|False)(?:\t|, )\d+(?:\t|, )([\d.]+)(?:\t|, )([\d.]+)\)?"
PROGRAMS = (
    Program(
        "ultra_simple of RPLidar's SDK", r"theta: *\d+\.\d\d +Dist: *\d{5}\.\d\d", "theta:",
        r"^\s*(S?)\s*theta: *(\d{1,3}\.\d\d) +Dist: *(\d{5}\.\d\d)", "new,angle_deg_cw,range_mm",
    ),
    Program(
        "the package rplidar", rf"(?m)^{RPLIDAR}$", "True|False", f"^{RPLIDAR}$",
        "new,angle_deg_cw,range_mm",
    ),
    Program(
        "LD06 and LD19", r"angle:[\d.]+,distance\(mm\):", r"distance\(",
        r"(?:stamp\(ns\):(\d+),)?angle:([\d.]+),distance\(mm\):(\d+)",
        "time_ns,angle_deg_cw,range_mm",
    ),
    Program(  # ros2 topic echo --csv of a LaserScan; its intensities stand behind its ranges
        "", r"\A\d+,\d+,[A-Za-z/][^,]*(?:,-?[\d.]+(?:e[-+]\d+)?){7},", ",",
        rf"^(\d+),(\d+),([^,]*),{','.join([r'([^,]*)'] * 7)},(.+)$",
        "time_s,nanosec,frame_id,angle_min,angle_max,angle_increment,time_increment,-,range_min,range_max,"
        "ranges_m",
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
    rows = "\n".join(text for _, text in first_lines(path))
    for program in PROGRAMS:
        if re.search(program.word, rows):
            notes = (f"a text of {program.name}",) if program.name else ()
            names = tuple(program.columns.split(","))
            return Layout(names, pattern=program.beam, mark=program.mark, notes=notes)
    layout = layout_as_written(path)
    if columns := HEADS.get(" ".join(layout.head).lower()):
        notes = ("columns as the makers of RPLidar mean them",)
        return layout._replace(names=column_names(columns), notes=notes)
    if names := names_in_ros(layout.head):
        return layout if missing_in(names) else layout._replace(names=names, rows=())
    for form, run in groupby(layout.head, key=lambda name: COUNTED.sub("#", name)):
        numbers = [float(n[-1]) for name in run if "#" in form and (n := COUNTED.findall(name))]
        if numbers not in (sorted(numbers), sorted(numbers, key=abs)):
            words = f"its columns {form} do not stand in the order of their numbers: put them so"
            raise LogError(path, words)
    names = tuple(name for name, count in runs_of(layout.head) for _ in range(count))
    return layout if missing_in(names) or layout.way_in_words else layout._replace(names=names)


def decimal_mark(content: bytes, separator: str | None) -> tuple[str, str]:
    """The decimal mark of the numbers of a table; and one of them, where all may be thousands.

    It is the point that Python reads, or a comma, where a comma does not separate fields.
    """
    cell = rb"(?m)(?:^|[\s%s\"])[ ]*([-+]?%s\d+\%s\d+(?:[eE][-+]?\d+)?)(?=[\s%s\"]|$)"
    about, thousands = (separator or " ").encode(), rb"(?![1-9]\d{0,2}[.,]\d{3}(?!\d))"
    for mark in {None: b",", "\t": b",", "|": b",", ";": b",."}.get(separator, b"").decode():
        marked = re.search(cell % (about, b"", mark.encode(), about), content)
        if marked and not re.search(cell % (about, thousands, mark.encode(), about), content):
            return mark, marked[1].decode()
        if marked:
            return mark, ""
    return ".", ""


def layout_as_written(path: Path) -> Layout:
    """Separator, decimal mark, first row and head of a table.

    Rows are the lines whose fields are numbers and words as those of most lines are.
    """
    lines = first_lines(path)
    body = [text for _, text in lines if not text.startswith(COMMENTS)]
    mark = next((m for m in SEPARATORS if 2 * sum(m in row for row in body) > len(body)), None)
    if mark == "," and 2 * sum(bool(COMMA_IN_NUMBER.search(row)) for row in body) > len(body):
        mark = None  # between numbers is white space
    fields = [field for row in body for field in fields_of(row, mark)]
    content = path.read_bytes()
    comments = [each.decode("utf-8", "replace") for each in COMMENT.findall(content)]
    decimal, parted = decimal_mark(COMMENT.sub(b"", content) if comments else content, mark)
    layout = Layout(separator=mark, decimal=decimal)
    two_marks = [f for f in fields if re.fullmatch(THOUSANDS, f) and not is_number(layout.clean(f))]
    if mark != "," and (parted := parted or "".join(two_marks[:1])):
        odd = "".join(f".replace({each!r}, '')" for each in {*parted} - {*"+-0123456789,."})
        layout = layout._replace(unsaid=NUMBERS_UNSAID.format(parted, path.name, path.stem, odd))

    def kind(row: str) -> tuple[bool, ...]:
        fields = fields_of(row, mark)
        numbers = [is_number(layout.clean(f)) or is_number(f) or f in two_marks for f in fields]
        if not any(numbers):  # an empty line of a spreadsheet
            return ()
        return tuple(n or f.lower() in NOT_MEASURED for n, f in zip(numbers, fields, strict=True))

    kinds = Counter(map(kind, body))
    usual = max((k for k in kinds if sum(k) > 1), key=kinds.__getitem__, default=())
    is_table = usual and 2 * kinds[usual] >= len(body)
    if not is_table:
        return _head_alone(lines)
    are_rows = (not text.startswith(COMMENTS) and kind(text) == usual for _, text in lines)
    begin = next(k for k, is_row in enumerate(are_rows) if is_row)
    rows = tuple(text for _, text in lines[begin:] if not text.startswith(COMMENTS))
    heads = [(number, _head(text, mark, rows[0])) for number, text in lines[:begin]]
    heads = [(number, names) for number, names in heads if len(names) == len(usual)]
    used = set[int]()
    if heads[1:] and (units := _units_in(heads[-1][1])):
        used = {heads[-2][0]}
        names = (f"{name} {unit}".strip() for name, unit in zip(heads[-2][1], units, strict=True))
        heads = [(heads[-1][0], tuple(names))]
    line, head = max(reversed(heads), key=lambda each: _meanings(each[1]), default=(0, ()))
    if _meanings(head):
        used.add(line)
    elif begin:
        line = lines[begin - 1][0]
    above = [  # with all fields it may be a damaged row
        text
        for number, text in lines[:begin]
        if number <= line or len(fields_of(text, mark)) != len(usual)
    ]
    heading = {text for number, text in lines if number in used}
    words = dict.fromkeys(text.strip() for text in (*above, *comments))
    words = {text: None for text in words if text not in heading and IN_WORDS.match(text)}
    return layout._replace(line=line, head=head, kinds=usual, rows=rows, words=tuple(words))


def _meanings(head: Sequence[str]) -> int:
    return len({column.role for column in map(meaning, head) if column})


def _units_in(names: Sequence[str]) -> list[str]:
    """The units of a line of units, empty where a column has none; nothing of another line."""
    words = [name.strip("[]() -") for name in names]
    units = [UNIT_WORDS.get(word.lower(), "") for word in words]
    return (
        units
        if any(units) and all(u or w in ("", "1") for u, w in zip(units, words, strict=True))
        else []
    )


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


def runs_of(head: Sequence[str]) -> list[tuple[str, int]]:
    """Names of a head, and how many columns each has: those alike but for a number are one.

    Examples
    --------
    >>> runs_of(["time_s", "r0_mm", "r1_mm", "q0", "q1", "Angles"])
    [('time_s', 1), ('ranges_mm', 2), ('q#', 2), ('Angles', 1)]
    """
    runs: list[tuple[str, int]] = []
    for form, run in groupby(head, key=lambda name: COUNTED.sub("#", name)):
        names = list(run)
        if "#" in form and names[1:]:
            column = meaning(form.replace("#", " "))
            is_range = column is not None and column.role in ("range", "ranges")
            name = column._replace(role="ranges").name if column and is_range else form
            runs.append((name, len(names)))
            continue
        for name in names:
            column = meaning(name)
            is_plural = column is not None and column.role == "ranges"
            runs.append((column._replace(role="range").name if column and is_plural else name, 1))
    return runs


def layout_in_toml(path: Path, of_poses: bool = False) -> Layout | None:
    """What the file NAME.toml beside a table says; None without one."""
    beside = path.parent / f"{path.name}.toml"
    try:
        if not (path.is_file() and beside.is_file()):
            return None
    except OSError:  # a name that is too long
        return None
    try:
        return declared_layout(path, **tomllib.loads(read_text(beside)), of_poses=of_poses)
    except (ValueError, TypeError) as fault:
        raise LogError(beside, f"{SAID_BESIDE}: {fault}") from fault


def declared_layout(
    path: Path, columns: str | Sequence[str], view: Any = None, *, of_poses: bool = False
) -> Layout:
    """A layout whose columns, and whose view where a row is a scan, somebody names."""
    names = column_names(columns)
    if fault := missing_in(names, of_poses):
        raise ValueError(f"columns do not say enough: {fault}")
    layout = layout_as_written(path)
    if places := ranges_in(names):
        last, unnamed = places[-1], max(len(layout.kinds) - len(names), 0)
        names = (*names[:last], *[names[last]] * (1 + unnamed), *names[last + 1 :])
    return layout._replace(names=names, view=checked_view(view))


def checked_view(view: Any) -> tuple[float, float] | None:
    """Where the first and the last range of a row point, two numbers in degrees."""
    if view is None:
        return None
    ends = arrays.numbers(view, "view")
    if ends.shape != (2,) or not (np.abs(ends) <= MOST_VIEW_DEG).all():
        raise ValueError(f"view must be two directions in degrees, got {brief(view)}")
    return float(ends[0]), float(ends[1])
