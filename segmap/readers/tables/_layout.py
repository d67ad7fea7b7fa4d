"""How a table with a line a beam is written: what separates fields, its head, what columns are."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from .._lines import Lines, LogError, is_number
from ..packed import log_file
from ._columns import RPLIDAR_RECORD, Columns, guessed, named, proposed_names, with_units_told

EXAMPLE = "columns=['angle_deg', 'range_mm']"
#: So many lines tell what a file is.
SAMPLE_LINES = 2000
#: So many rows are shown where columns are chosen.
SHOWN_ROWS = 6
#: So many of them are looked at for a head.
HEAD_LINES = 20
#: No line of a table with a beam a line is longer.
MOST_ROW_CHARACTERS = 4096
#: From this share of rows on that fit, a file is such a table.
ROWS_SHARE = 0.5
#: A first line of Excel that names the separator.
SEPARATOR_LINE = re.compile(r"(?i)sep=(.)")
#: A name and its number, in a line where each field has its name.
LABEL = re.compile(
    r"([A-Za-z_]+(?:[(\[]\w+[)\]])?)\s*[:=]\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)(?![\w.])"
)
#: Numbers with decimal commas between white space.
DECIMAL_COMMAS = re.compile(r"[-+]?[0-9]+(,[0-9]+)?(\s+[-+]?[0-9]+(,[0-9]+)?)+")
#: How the programs of RPLidar begin a file of degrees, clockwise, and millimetres.
SLAMTEC_HEAD = "#RPLIDAR SCAN DATA"
#: Beams of one scan in brackets.
TUPLE = re.compile(r"[(\[]([^()\[\]]+)[)\]]")


class Layout(NamedTuple):
    """How a file is written: what separates fields, the line of its head, and its columns."""

    separator: str | None
    line: int
    names: tuple[str, ...]
    columns: Columns
    labels: tuple[str, ...] = ()  #: names that stand in each line
    told: tuple[str, ...] = ()


def split(line: str, separator: str | None) -> list[str]:
    """The fields of a line; white space separates them where nothing else does."""
    if separator is None:
        line = re.sub(r"\s+(?=[\[(])", "", line)
    return [field.strip().strip("\"'") for field in line.strip().split(separator)]


def separator_of(lines: Sequence[str]) -> str | None:
    """What separates the fields of most lines."""
    for mark in ";\t,":
        if 2 * sum(mark in line for line in lines) > len(lines):
            commas = mark == "," and sum(bool(DECIMAL_COMMAS.fullmatch(line)) for line in lines)
            return None if 2 * commas > len(lines) else mark
    return None


def decimal(field: str, separator: str | None) -> str:
    """A number with a point; with a comma too, unless commas separate the fields.

    Examples
    --------
    >>> decimal("2000,5", ";"), decimal("2000.5", ",")
    ('2000.5', '2000.5')
    """
    return field if separator == "," else field.replace(",", ".", 1)


def moment(field: str) -> float:
    """Seconds of a time of the wall: ISO 8601, since 1970, or the time of day; else NaN.

    Examples
    --------
    >>> moment("1970-01-02T00:00:00.5Z"), moment("01:00:02,25")
    (86400.5, 3602.25)
    """
    text = field.replace(",", ".").replace("/", "-")
    if day := re.fullmatch(r"(\d{1,2}):(\d{2}):(\d{2}(?:\.\d+)?)", text):
        return 3600 * int(day[1]) + 60 * int(day[2]) + float(day[3])
    with suppress(ValueError, OverflowError):
        found = datetime.fromisoformat(text)
        return (found if found.tzinfo else found.replace(tzinfo=UTC)).timestamp()
    return np.nan


def sample(path: Path, count: int = SAMPLE_LINES) -> list[tuple[int, str]]:
    """The first lines of a file that are not empty, comments too, with their numbers."""
    lines = Lines(path, "skip", "\n", comments="", encoding="utf-8-sig")
    with suppress(LogError):
        return [(lines.number, fields[0]) for fields in islice(lines, count)]
    return []


# ------------------------------------------------------------------------------------ layout
def headed_of(path: Path) -> Layout | None:
    """How a file with a line a beam is written whose head or labels say it; None for another."""
    lines = sample(path)
    rows = [line for _, line in lines if not line.startswith("#")]
    if not rows or len(rows[0]) >= MOST_ROW_CHARACTERS:
        return None
    return _labelled(lines) or _headed(lines)


def layout_of(path: Path) -> Layout | None:
    """The same, also where the numbers of the columns have to tell what they are."""
    rows = [line for _, line in sample(path) if not line.startswith("#")]
    if (found := headed_of(path)) or not rows or not (found := _unnamed(rows)):
        return found
    return found if rows[0].startswith(("[(", "(")) else found._replace(line=begin_of(path)[1])


def _labelled(lines: Sequence[tuple[int, str]]) -> Layout | None:
    for _, line in lines[:HEAD_LINES]:
        labels = tuple(label for label, _ in LABEL.findall(line))
        if (columns := named(labels)).enough:
            return _with_units(Layout(None, 0, labels, columns, labels), lines)
    return None


def _headed(lines: Sequence[tuple[int, str]]) -> Layout | None:
    """A head that names angle and range; a comment is one where the next line fits below it."""
    body = [line for _, line in lines[1:] if not line.startswith("#")]
    separator, comment = separator_of(body or [line for _, line in lines]), None
    for number, line in lines[:HEAD_LINES]:
        if told := SEPARATOR_LINE.fullmatch(line):
            separator = told[1]
        elif line.startswith(SLAMTEC_HEAD):
            columns = ("angle_deg_cw", "range_mm", "quality")
            return Layout(None, number, columns, named(columns))
        else:
            mark = separator if separator is None or separator in line else separator_of([line])
            names = tuple(split(line.lstrip("#"), mark))
            found = Layout(separator, number, names, named(names))
            if not line.startswith("#"):
                fits = comment and _fits(split(line, separator), comment)
                chosen = comment if fits and comment else found
                if chosen.columns.enough:
                    return _with_units(chosen, lines)
                if any(map(is_number, names)):
                    return None
            elif found.columns.enough:
                comment = found
    return None


def _fits(fields: Sequence[str], head: Layout) -> bool:
    numbers = [decimal(field, head.separator) for field in fields]
    used = head.columns.by_role.values()
    return len(fields) == len(head.names) and all(is_number(numbers[c.place]) for c in used)


def _unnamed(rows: Sequence[str]) -> Layout | None:
    """Columns that are told by their numbers, and the record of the package rplidar."""
    if rows[0].startswith("[("):
        rows = [", ".join(split(each, ",")) for row in rows for each in TUPLE.findall(row)]
    separator = separator_of(rows)
    fields = [split(row.strip("()"), separator) for row in rows]
    if all(
        len(f) == 4 and f[0] in ("True", "False") and all(map(is_number, f[1:])) for f in fields
    ):
        return Layout(separator, 0, RPLIDAR_RECORD, named(RPLIDAR_RECORD))
    table = _number_rows(fields, separator)
    if not len(table) or len(table) < ROWS_SHARE * len(rows):
        return None
    three = table.shape[1] == 3 and len(np.unique(table[:, 0])) <= 64 and (table[:, 2] > 100).any()
    names = RPLIDAR_RECORD[1:] if three and _is_record(table) else guessed(table)
    if not names:
        return None
    columns, told = with_units_told(named(names), table)
    if not {"angle", "range"} <= {*columns.by_role}:
        return None
    if any(columns.by_role[role].factor is None for role in ("angle", "range")):
        return None
    said = ", ".join(proposed_names(names, table))
    told = [f"columns without names are {said}: --columns names others", *told]
    return Layout(separator, 0, names, columns, (), tuple(told))


def _is_record(table: Array) -> bool:
    """Whether columns are quality, degrees and millimetres, as rplidar has them."""
    return guessed(table[:, [1, 2]]) == ("angle", "range") and float(np.ptp(table[:, 1])) > 7


def _number_rows(fields: Sequence[Sequence[str]], separator: str | None) -> Array:
    """The rows that are numbers, as many as most rows have; `(m, k)`."""
    if not fields:
        return np.empty((0, 0))
    lengths = [len(row) for row in fields]
    count = max(max(set(lengths), key=lengths.count), 1)
    rows = [[decimal(field, separator) for field in row] for row in fields if len(row) == count]
    return np.array([_as_numbers(row) for row in rows if all(map(is_number, row))]).reshape(
        -1, count
    )


def _as_numbers(row: Sequence[str]) -> list[float]:
    """Numbers of fields; NaN of others, seconds of a time of the wall."""
    return [float(field) if is_number(field) else moment(field) for field in row]


def _table_below(layout: Layout, lines: Sequence[tuple[int, str]]) -> Array:
    """The numbers of the first rows, `(m, k)`, NaN for what is none."""
    count, mark = len(layout.names), layout.separator
    rows = []
    for number, line in lines:
        if layout.labels:
            said = dict(LABEL.findall(line))
            rows += [[float(said[n]) for n in layout.labels]] if {*layout.labels} <= {*said} else []
        elif number > layout.line and not line.startswith("#"):
            fields = split(line, mark)
            if len(fields) >= count:
                rows.append(_as_numbers([decimal(field, mark) for field in fields[:count]]))
    return np.array(rows).reshape(-1, count)


def _with_units(layout: Layout, lines: Sequence[tuple[int, str]]) -> Layout:
    table = _table_below(layout, lines)
    columns, told = with_units_told(layout.columns, table)
    if (clock := columns.by_role.get("time")) and len(table):
        values = table[:, clock.place]
        if np.isnan(values).all():
            told.append(f"the column {clock.name!r} holds no times: left out")
            columns = columns._replace(
                by_role={k: v for k, v in columns.by_role.items() if k != "time"}
            )
    return layout._replace(columns=columns, told=tuple(told))


def wanting(layout: Layout, path: Path) -> str:
    """What keeps a table from being read, and what to do; empty where nothing does."""
    found = layout.columns
    roles = (
        ("x", "y") if "angle" not in found.by_role and "x" in found.by_role else ("angle", "range")
    )
    faults = [
        f"the unit of {found.by_role[role].name!r} is not said"
        if role in found.by_role
        else f"no column is the {role}"
        for role in roles
        if role not in found.by_role or found.by_role[role].factor is None
    ]
    if not faults:
        return ""
    names = proposed_names(layout.names, _table_below(layout, sample(path)))
    return (
        f"{faults[0]}: if it is so, --columns {','.join(names)} reads it, "
        f"or segmap.readers.read_csv(path, columns={names})"
    )


def begin_of(path: Path) -> tuple[str | None, int]:
    """What separates the fields of a file, and the last line before its first row of numbers."""
    lines = [(number, line) for number, line in sample(path) if not line.startswith("#")]
    separator = separator_of([line for _, line in lines[1:]] or [line for _, line in lines])
    for number, line in lines:
        if told := SEPARATOR_LINE.fullmatch(line):
            separator = told[1]
            continue
        fields = [decimal(field, separator) for field in split(line, separator)]
        return separator, number - 1 if is_row(fields) else number
    return separator, 0


def is_row(fields: Sequence[str]) -> bool:
    """Whether a line holds numbers, and no names."""
    return (
        any(map(is_number, fields)) and not named([f for f in fields if not is_number(f)]).by_role
    )


def first_rows(path: str | Path) -> tuple[list[str], list[list[str]]]:
    """Names that may fit the columns of a table, with units, and its first rows, as texts.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "it.csv"
    ...     _ = path.write_text("a;b\\n0;1500\\n90;2000\\n")
    ...     first_rows(path)
    (['angle_deg', 'range_mm'], [['0', '1500'], ['90', '2000']])
    """
    with log_file(path) as place:
        separator, line = begin_of(place)
        lines = [(k, text) for k, text in sample(place) if not text.startswith("#") and k > line]
        rows = [split(text, separator) for _, text in lines]
        wide = max((len(row) for row in rows), default=0)
        found = layout_of(place)
        names = found.names if found and len(found.names) == wide else ("-",) * wide
        table = _table_below(Layout(separator, line, names, named(names)), lines)
        return proposed_names(names, table) if wide else [], rows[:SHOWN_ROWS]


def looks_like(path: Path) -> str:
    """What a file without a format holds, and three lines of Python that read it, if numbers."""
    lines = [(number, line) for number, line in sample(path) if not line.startswith("#")]
    separator, line = begin_of(path)
    rows = [split(text, separator) for number, text in lines if number > line]
    fields = [decimal(field, separator) for field in rows[0]] if rows else []
    if len(rows) < 2 or len(fields) < 2 or not all(map(is_number, fields)):
        return ""
    count, mark = len(rows[0]), {None: "white space", "\t": "tabs"}.get(separator, f"{separator!r}")
    first = "".join(f"    {text[:70]}\n" for _, text in lines[:3])
    names, _ = first_rows(path)
    commas = separator != "," and any("," in field for field in rows[0])
    how = f"sep={separator or '[ ]+'!r}, decimal={',' if commas else '.'!r}"
    angle, far = (
        next(k for k, n in enumerate(names) if n.startswith(w)) for w in ("angle", "range")
    )
    turn = "" if "rad" in names[angle] else " * numpy.pi / 180"
    scale = " / 1000" if "mm" in names[far] else ""
    return (
        f"It looks like {count} columns between {mark}:\n{first}"
        f"Which is which nobody says. --columns {','.join(names)} reads it if it is so, or\n"
        f"    import numpy, pandas, segmap\n"
        f"    rows = pandas.read_csv({path.name!r}, {how}, header=None, skiprows={line}).values\n"
        f"    log = segmap.Log('mine', [segmap.LaserScan(rows[:, {far}]{scale}, "
        f"rows[:, {angle}]{turn})])\n"
    )
