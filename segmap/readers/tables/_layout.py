"""How a table with a line a beam is written: what separates fields, its head, what columns are."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from .._lines import is_number
from ._columns import (
    RPLIDAR_RECORD,
    Columns,
    is_unit,
    named,
    with_units_told,
)
from ._fields import (
    FIRST_BEAM,
    NESTED,
    SAMPLE_LINES,
    SEPARATOR_LINE,
    TABLE_COMMENTS,
    THOUSANDS,
    TUPLE,
    as_numbers,
    decimal,
    is_row,
    labelled,
    names_by_units,
    number_rows,
    sample,
    separator_of,
    split,
    with_units_behind,
)
from ._numbers import guessed, proposed_names

POSES_ALONE = "holds poses and no scan: --odometry or --truth reads them beside a log"
EXAMPLE = "columns=['angle_deg', 'range_mm'] or --columns angle_deg,range_mm"
#: So many of them are looked at for a head.
HEAD_LINES = 20
#: No line of a table with a beam a line is longer.
MOST_ROW_CHARACTERS = 4096
#: From this share of rows on that fit, a file is such a table.
ROWS_SHARE = 0.5
#: So many lines with names in them are a table of them.
LABELS_SHARE = 0.1
#: Behind it lie the points of a cloud, PCD.
CLOUD_DATA = "DATA ascii"
#: How the programs of RPLidar begin a file of degrees, clockwise, and millimetres.
SLAMTEC_HEAD = "#RPLIDAR SCAN DATA"


class Beams(NamedTuple):
    """Where in a line the beams of a scan stand, and what is known of all of them.

    One place may hold them all, as a list.
    """

    ranges: tuple[int, ...]
    factor: float = 1.0  #: what makes metres of ranges
    angles: tuple[float, ...] = ()
    directions: tuple[int, ...] = ()  #: where angles stand in each line
    radian: float = 1.0  #: of these
    single: tuple[tuple[str, int], ...] = ()  #: numbers of a message, and their places
    least: float = 0.0  #: shorter ranges are codes of the sensor
    goes_on: bool = False  #: whether each line has as many as it likes

    def places(self, places: tuple[int, ...], count: int) -> Sequence[int]:
        """Which of these there are in a line of so many fields."""
        if not self.goes_on or len(places) < 2:
            return places
        return range(places[0], count, places[1] - places[0])


class Layout(NamedTuple):
    """How a file is written: what separates fields, the line of its head, and its columns."""

    separator: str | None
    line: int
    names: tuple[str, ...]
    columns: Columns = Columns({})
    labels: tuple[str, ...] = ()  #: names that stand in each line
    told: tuple[str, ...] = ()
    nested: bool = False  #: whether a line is a scan, its beams in brackets
    thousands: bool = False  #: whether the commas in its numbers are no decimal marks
    beams: Beams | None = None  #: of a file with a scan a line


def headed_of(path: Path) -> Layout | None:
    """How a file with a line a beam is written whose head or labels say it; None for another."""
    lines = sample(path)
    rows = [line for _, line in lines if not line.startswith(TABLE_COMMENTS)]
    if not rows or len(rows[0]) >= MOST_ROW_CHARACTERS:
        return None
    return _labelled(lines) or _headed(lines)


def layout_of(path: Path) -> Layout | None:
    """The same, also where the numbers of the columns have to tell what they are."""
    rows = [line for _, line in sample(path) if not line.startswith(TABLE_COMMENTS)]
    if (found := headed_of(path)) or not rows:
        return found
    labels = tuple(next(labelled(rows[0])))
    beams = (said for row in rows for said in labelled(row) if {*labels} <= {*said})
    said = [", ".join(beam[label] for label in labels) for beam in beams]
    if len(labels) > 1 and (found := unnamed(said, labels)):
        return found._replace(labels=labels)
    separator, begin = begin_of(path)
    head = next((line for number, line in sample(path) if number == begin), "")
    if found := unnamed(rows, split(head, separator)):
        return found if found.nested else found._replace(line=begin)
    return None


def _labelled(lines: Sequence[tuple[int, str]]) -> Layout | None:
    for _, line in lines[:HEAD_LINES]:
        labels = tuple(next(labelled(line)))
        if (columns := named(labels)).enough:
            beams = sum({*labels} <= {*said} for _, text in lines for said in labelled(text))
            if beams < LABELS_SHARE * len(lines):
                continue  # they say something of the beams below
            return _over(Layout(None, 0, labels, columns, labels), lines)
    return None


def _headed(lines: Sequence[tuple[int, str]]) -> Layout | None:
    """A head that names angle and range; a comment is one where the next line fits below it.

    A line of units alone may stand below it.
    """
    body = [line for _, line in lines[1:] if not line.startswith(TABLE_COMMENTS)]
    separator, comment = separator_of(body or [line for _, line in lines]), None
    for number, line in lines[:HEAD_LINES]:
        if told := SEPARATOR_LINE.fullmatch(line):
            separator = told[1]
        elif line.startswith(SLAMTEC_HEAD):
            columns = ("angle_deg_cw", "range_mm", "quality")
            return Layout(None, number, columns, named(columns))
        else:
            own = separator is None or bool({*separator} & {*line})
            mark = separator if own else separator_of([line])
            names = tuple(split(line.lstrip('#%/!; "').strip(" "), mark))
            found = Layout(separator, number, names)
            if not any(map(is_number, names)):
                found = found._replace(columns=named(names))
            if names[:1] == ("FIELDS",):  # a cloud of points, PCD
                begin = [k for k, text in lines if text.startswith(CLOUD_DATA)] or [number]
                cloud = Layout(separator, begin[0], names[1:], named(names[1:]))
                return _over(cloud, lines) if cloud.columns.enough else None
            if not line.startswith(TABLE_COMMENTS):
                fits = comment and _fits(split(line, separator), comment)
                chosen = comment if fits and comment else found
                if chosen.columns.enough:
                    under = [split(text, separator) for at, text in lines if at > number][:2]
                    return _over(_over_units(chosen, under if chosen is found else []), lines)
            elif found.columns.enough:
                comment = found
    return None


def _over_units(head: Layout, below: Sequence[Sequence[str]]) -> Layout:
    """A head, with the units of a line below it, or above; lines without numbers are left out."""
    for fields in below:
        if len(fields) != len(head.names) or any(is_number(decimal(field)) for field in fields):
            break
        pairs = list(zip(head.names, fields, strict=True))
        above = all(map(is_unit, filter(None, head.names)))
        names = tuple(f"{b} {a}" if above else f"{a} {b}" for a, b in pairs)
        head = head._replace(line=head.line + 1)
        if (columns := named(names)).enough:
            head = head._replace(names=names, columns=columns)
    return head


def _fits(fields: Sequence[str], head: Layout) -> bool:
    numbers = list(map(decimal, fields))
    used = head.columns.by_role.values()
    return len(fields) == len(head.names) and all(is_number(numbers[c.place]) for c in used)


def unnamed(rows: Sequence[str], head: Sequence[str]) -> Layout | None:
    """Columns that are told by their numbers, and the record of the package rplidar.

    A head without known names may still say their units; one that says an unknown unit ends it.
    """
    nested = [row for row in rows if NESTED.search(row)]
    if 3 * len(nested) < len(rows):  # an array of numpy's, printed
        nested = []
    if nested:
        beams = (each for row in nested for each in TUPLE.findall(row))
        rows = [", ".join(split(each, ",")) for each in islice(beams, SAMPLE_LINES)]
    separator = separator_of(rows)
    fields = [split(row, separator) for row in rows]
    if all(
        len(f) == 4 and f[0] in ("True", "False") and all(map(is_number, f[1:])) for f in fields
    ):
        return Layout(separator, 0, RPLIDAR_RECORD, named(RPLIDAR_RECORD))
    table = number_rows(fields)
    if not len(table) or len(table) < ROWS_SHARE * len(rows):
        return None
    three = table.shape[1] == 3 and len(np.unique(table[:, 0])) <= 64 and (table[:, 2] > 100).any()
    three &= bool(np.isfinite(table[:, 0]).all())
    names = RPLIDAR_RECORD[1:] if three and _is_record(table) else guessed(table)
    names = names_by_units(fields) or names
    if not names:
        return None
    if len(head) == len(names):
        names = tuple(_with_unit(name, above) for name, above in zip(names, head, strict=True))
    if any(map(FIRST_BEAM.match, rows)):
        names = tuple("angle_cw" if name == "angle" else name for name in names)
    columns, told = with_units_told(with_units_behind(named(names), fields), table)
    if not {"angle", "range"} <= {*columns.by_role}:
        return None
    if any(columns.by_role[role].factor is None for role in ("angle", "range")):
        return None
    said = ", ".join(proposed_names(names, table))
    told = [f"columns without names are {said}: --columns names others", *told]
    if columns.clockwise:
        told.append("beams clockwise, as the package rplidar has them")
    return Layout(separator, 0, names, columns, (), tuple(told), bool(nested))


def _with_unit(name: str, above: str) -> str:
    """A guessed name, with what stands behind the first word of the head above it."""
    said = re.split(r"[\s_(\[/]+", above.strip(), maxsplit=1)[1:]
    return f"{name} {said[0].rstrip(')]} ')}" if said and name != "-" else name


def _is_record(table: Array) -> bool:
    """Whether columns are quality, degrees and millimetres, as rplidar has them.

    A column that only rises numbers the scans.
    """
    if np.ptp(table[:, 0]) and (np.diff(table[:, 0]) >= 0).all():
        return False
    return guessed(table[:, [1, 2]]) == ("angle", "range") and float(np.ptp(table[:, 1])) > 7


def rows_below(layout: Layout, lines: Sequence[tuple[int, str]]) -> Array:
    """The numbers of the first rows, `(m, k)`, NaN for what is none."""
    count, mark = len(layout.names), layout.separator
    rows = []
    for number, line in lines:
        if layout.labels:
            beams = (said for said in labelled(line) if {*layout.labels} <= {*said})
            rows += [as_numbers([said[n] for n in layout.labels]) for said in beams]
        elif number > layout.line and not line.startswith(TABLE_COMMENTS):
            fields = split(line, mark)
            if len(fields) >= count:
                rows.append(as_numbers(fields[:count], thousands=layout.thousands))
    return np.array(rows).reshape(len(rows), count)


def with_units(layout: Layout, table: Array) -> Layout:
    """A layout with the units that numbers of its first rows, `(m, k)`, tell."""
    columns, told = with_units_told(layout.columns, table)
    if columns.by_program and not layout.labels and columns.clockwise:
        told.append("beams clockwise, as programs have it that name columns so")
    return layout._replace(columns=columns, told=(*layout.told, *told))


def _over(layout: Layout, lines: Sequence[tuple[int, str]]) -> Layout:
    """A layout with what the lines below its head tell."""
    layout = as_written(layout, lines)
    return with_units(layout, rows_below(layout, lines))


def as_written(layout: Layout, lines: Sequence[tuple[int, str]]) -> Layout:
    """A layout with what fields say themselves: units behind numbers, and marks of thousands.

    Ranges in quotes, as 4,002, are whole numbers where each has three digits, and no metres.
    """
    if layout.labels:
        return layout
    rows = [split(line, layout.separator) for number, line in lines if number > layout.line]
    layout = layout._replace(columns=with_units_behind(layout.columns, rows))
    if "range" not in layout.columns.by_role or layout.separator != ",":
        return layout
    place, factor, *_ = layout.columns.by_role["range"]
    marked = [row[place] for row in rows if len(row) > place and "," in row[place]]
    found = bool(marked) and all(map(THOUSANDS.fullmatch, marked)) and (factor or 0) < 0.1
    return layout._replace(thousands=found)


def wanting(layout: Layout, table: Array) -> str:
    """What keeps a table from being read, and what to do; empty where nothing does."""
    found = layout.columns
    if {"x", "y", "angle"} <= {*found.by_role} and "range" not in found.by_role:
        return f"{POSES_ALONE}, readers.read_trajectory in Python"
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
    names = proposed_names(layout.names, table)
    return (
        f"{faults[0]}: if it is so, --columns {','.join(names)} reads it, "
        f"or segmap.readers.read_csv(path, columns={names})"
    )


def begin_of(path: Path) -> tuple[str | None, int]:
    """What separates the fields of a file, and the last line before its first row of numbers."""
    lines = [(k, line) for k, line in sample(path) if not line.startswith(TABLE_COMMENTS)]
    clouds = [k for k, (_, line) in enumerate(lines) if line.startswith(CLOUD_DATA)]
    lines = lines[clouds[0] + 1 :] if clouds else lines
    separator = separator_of([line for _, line in lines[1:]] or [line for _, line in lines])
    if told := [found for _, line in lines[:1] if (found := SEPARATOR_LINE.fullmatch(line))]:
        separator = told[0][1]
    lengths = [len(split(line, separator)) for _, line in lines]
    usual = max({*lengths}, key=lengths.count, default=0)
    for (number, line), length in zip(lines[:HEAD_LINES], lengths, strict=False):
        if length >= usual and is_row([*map(decimal, split(line, separator))]):
            return separator, number - 1
    return separator, lines[0][0] if lines else 0


def parted(layout: Layout, place: int) -> str:
    """Python that makes of a table a file for each thing that a column says."""
    mark, has_head = layout.separator or " ", layout.names[place : place + 1] not in ((), ("-",))
    kind = f"[{mark}]+" if len(mark) > 1 else mark.replace(" ", r"\s+")
    above = f", skiprows={layout.line - has_head}" * (layout.line > has_head)
    above += ", header=None" * (not has_head) + ", engine='python'" * (len(mark) > 1)
    return (
        f"for k, (_, rows) in enumerate(pandas.read_csv(path, sep={kind!r}, dtype=str{above})"
        f".groupby({(layout.names[place] if has_head else place)!r}), 1): "
        f"rows.to_csv(f'part{{k}}.csv', sep={mark[0]!r}, index=False, header={has_head})"
    )
