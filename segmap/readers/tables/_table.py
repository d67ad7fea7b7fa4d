"""Tables whose columns are declared: a beam a row, or a scan a row.

Rows of one scan number are one scan, wherever they stand. Where nothing says which rows are one
scan, it ends where the angle wraps, or where a sweep turns back. A range of 0 or below, and a word
for nothing, is no measurement.

Assumed: angles are counter-clockwise where no name says `cw`; a robot's laser sits at its centre.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import LIMIT, Array
from ...scans import LONGEST_TURN_S, LaserScan, Log
from ...scans.error_codes import as_ranges
from ..lines import (
    LATEST_TIME_S,
    MOST_DIRECTION_RAD,
    NOT_MEASURED,
    STRIPPED,
    HeadError,
    Lines,
    LogError,
)
from ..raw_scans import COUNTERCLOCKWISE, or_none, place_of
from ._columns import BEAM_ROLES, POSE, Column, places_of
from ._layout import (
    COMMENTS,
    Layout,
    fields_of,
)
from ._question import choices_of

#: No scan has more beams.
MOST_BEAMS_READ = 100_000
HALF_DAY_S = 43_200.0
#: So much is told of the lines of words in a table.
TOLD_CHARACTERS = 160
CLOCK_TIME = r"\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?"
ISO_DATE = r"\d{4}-\d{2}-\d{2}"
#: Names of columns that say who measured.
WHO = re.compile(r"(?i)(sensor|laser|lidar|robot|device|frame|topic|channel)([ _-]?(id|no|name))?")
#: Largest value of a role, in metres, radians or seconds, and what is expected of one.
MOST = {
    "angle": (MOST_DIRECTION_RAD, "an angle within two turns"),
    "time": (LATEST_TIME_S, "a time"),
}
#: Words of a column `new`, and of `error` where none is.
YES = ("true", "1", "1.0", "s")
NO_ERROR = ("", "0", "0.0", "00", "0000", "nan")
#: A scan of end points may begin so much before the first one did.
SAME_DIRECTION_RAD = np.radians(0.5)


class Rows:
    """The rows of a table that are whole, as columns by their places."""

    def __init__(self, lines: Lines, layout: Layout) -> None:
        import pandas as pd

        self.lines, self.layout = lines, layout
        text = lines.path.read_bytes().decode("utf-8-sig", "replace")
        is_quoted = '"' in text
        each = [row.strip(STRIPPED) for row in text.split("\n")]
        passed = {each[layout.line - 1] if layout.line else "", *layout.words}
        numbered = [
            (place + 1, row)
            for place, row in enumerate(each)
            if place >= layout.line and row and row not in passed and not row.startswith(COMMENTS)
        ]
        wide = len(layout.kinds) or len(layout.names)
        if wide < len(layout.names):
            what = f"{len(layout.names)} columns are named, but its rows have {wide} fields"
            raise HeadError(lines.path, what)
        parts = self._beams(numbered) if layout.pattern else self._rows(numbered, is_quoted)
        if not parts:
            raise lines.no_scan(f"rows of {','.join(layout.names)}")
        self.numbers = np.array([number for number, _ in parts], int)
        self.columns = pd.read_csv(
            io.StringIO("\n".join(row for _, row in parts)), header=None, names=range(wide),
            sep="," if layout.pattern else layout.separator or r"\s+", decimal=layout.decimal,
            skipinitialspace=True, low_memory=False, lineterminator="\n", skip_blank_lines=False,
            quoting=csv.QUOTE_MINIMAL if is_quoted else csv.QUOTE_NONE, index_col=False,
        )  # fmt: skip
        self.good = np.ones(len(parts), bool)

    def _beams(self, numbered: Sequence[tuple[int, str]]) -> list[tuple[int, str]]:
        """The parts of lines that hold a beam, between commas."""
        layout, beams = self.layout, []
        mark, wanted = re.compile(layout.mark), ",".join(layout.names)
        pattern = re.compile(layout.pattern)
        for number, row in numbered:
            if match := pattern.search(row):
                beams.append((number, ",".join(part or "" for part in match.groups())))
            elif not layout.mark:
                fault = f"no line as most are, {layout.rows[0][:40]!r}: {row[:40]!r}"
                self.lines.leave_out(LogError(self.lines.path, fault, number))
            elif mark.search(row):
                self._damaged(number, f"expected a beam, {wanted}, got {row[:40]!r}")
        return beams

    def _rows(self, numbered: Sequence[tuple[int, str]], is_quoted: bool) -> list[tuple[int, str]]:
        """The rows with as many fields as most of the first have."""
        mark, wide, rows = self.layout.separator, len(self.layout.kinds), []
        for number, row in numbered:
            if mark and not is_quoted:
                count = row.count(mark) + 1
            else:  # a quote that does not end holds no field
                count = len(fields_of(row, mark)) * (row.count('"') % 2 == 0)
            if count == wide:
                rows.append((number, row))
            else:
                self._damaged(number, f"expected {wide} fields, got {count}")
        return rows

    def _damaged(self, number: int, fault: str) -> None:
        self.lines.damaged(LogError(self.lines.path, fault, number))

    def texts(self, place: int) -> Any:
        """A column as words in lower case."""
        texts = self.columns[place].astype(str).fillna("").str.strip().str.strip("'").str.lower()
        return texts if self.layout.decimal == "." else texts.map(self.layout.plain)

    def is_words(self, place: int) -> bool:
        """Whether a column does not hold numbers alone."""
        return self.columns[place].dtype.kind not in "iuf"

    def numbers_of(self, place: int, column: Column) -> Array:
        """A column in the units of segmap, NaN for nothing; rows with another word are damaged."""
        import pandas as pd

        texts = self.texts(place) if self.is_words(place) else None
        numbers = self.columns[place] if texts is None else pd.to_numeric(texts, errors="coerce")
        values = numbers.to_numpy(float, na_value=np.nan) * column.factor
        comma = ", its decimal mark a comma" if self.layout.decimal == "," else ""
        plain = f"a number for the {column.role}{comma}"
        most, bounded = MOST.get(column.role, (LIMIT, plain))
        ends = column.role in ("range", "ranges", "x", "y")
        with np.errstate(invalid="ignore"):
            beyond = (np.abs(values) > most) & ~(np.isinf(values) & ends)
        wrong = beyond | (np.isnan(values) & (column.role in ("angle", "scan")))
        if texts is not None:
            wrong |= np.isnan(values) & ~texts.isin(NOT_MEASURED).to_numpy()
        for row in np.flatnonzero(wrong & self.good).tolist():
            got = str(self.columns[place].iloc[row])[:40]
            expected = bounded if beyond[row] else plain
            self._damaged(int(self.numbers[row]), f"expected {expected}, got {got!r}")
        self.good &= ~wrong
        return values

    def values(self, place: int, column: Column) -> Array | None:
        """A column in the units of segmap; None of times whose unit is not said."""
        import pandas as pd

        if column.role in ("new", "error"):
            texts = self.texts(place)
            is_new = column.role == "new"
            flags = texts.isin(YES) if is_new else ~texts.isin(NO_ERROR)
            return np.asarray(flags, float)
        if column.role != "time" or column.unit:
            return self.numbers_of(place, column)
        if not self.is_words(place):
            return None
        texts = self.texts(place)
        if texts.str.fullmatch(CLOCK_TIME).all():
            seconds = pd.to_timedelta(texts).dt.total_seconds().to_numpy()
            return seconds + 2 * HALF_DAY_S * np.cumsum(
                np.diff(seconds, prepend=seconds[:1]) < -HALF_DAY_S
            )
        if not texts.str.match(ISO_DATE).all():
            return None
        when = pd.to_datetime(texts.str.upper(), format="ISO8601", utc=True, errors="coerce")
        return (when - pd.Timestamp(0, tz="UTC")).dt.total_seconds().to_numpy()


def read_declared_rows(path: Path, name: str, on_error: str, layout: Layout) -> Log:
    """The log that a table holds."""
    if not layout.is_whole:
        raise HeadError(path, choices_of(layout).told(path.name), layout.line or None)
    lines = Lines(path, on_error)
    rows, places, notes = Rows(lines, layout), places_of(layout.names), list(layout.notes)
    beam = next(kind for kind in BEAM_ROLES if {*kind} <= {*places})
    others = {role for kind in BEAM_ROLES for role in kind} - {*beam}
    others |= set() if {*POSE} <= {*places} else {*POSE}
    places = {role: at for role, at in places.items() if role not in others}
    ranges_at, ranges = places.pop("ranges", (len(layout.names), None))
    behind = rows.columns.shape[1] - len(layout.names)  # so many more fields than names
    table: dict[str, Array] = {}
    for role, (k, column) in places.items():
        place = k if k < ranges_at else k + behind
        values = rows.values(place, column)
        if values is None:
            notes.append(f"{layout.names[k]!r} says no unit of time and is left out")
        else:
            table[role] = values
    if ranges:
        fields = range(ranges_at, ranges_at + behind + 1)
        table["ranges"] = np.stack([rows.numbers_of(place, ranges) for place in fields], axis=1)
    _refuse_several(path, rows, layout)
    used = {k for k, _ in places.values()} | {ranges_at}
    unused = [
        name or f"column {k + 1}"
        for k, name in enumerate(layout.names)
        if k not in used and name != "-" and (name or rows.columns[k].notna().any())
    ]
    if layout.words:
        notes.append(f"not read: {', '.join(map(repr, layout.words[:3]))}"[:TOLD_CHARACTERS])
    if unused:
        notes.append(f"left out: {', '.join(map(repr, unused))}")
    if {"time", "nanosec"} <= {*table}:
        table["time"] = table["time"] + table["nanosec"]
    wrong = int((~rows.good).sum())
    if wrong > len(rows.good) - wrong:
        what = f"{wrong} of {len(rows.good)} lines are no {','.join(layout.names)}"
        raise LogError(path, f"{what}: {lines.first.reason if lines.first else ''}")
    table = {role: values[rows.good] for role, values in table.items()}
    if ranges:
        scans = _a_scan_a_row(path, table, layout)
    else:
        scans = _a_beam_a_row(path, table, layout, notes)
    if any(scan.odometry is not None for scan in scans):
        notes.append(place_of(np.zeros(3)))
    return Log(name, scans, None, lines.skipped, assumed=notes)


def _refuse_several(path: Path, rows: Rows, layout: Layout) -> None:
    """A column of the file itself that says that several sensors measured ends the reading."""
    for place, name in enumerate(layout.names):
        if WHO.fullmatch(name) and (values := [*dict.fromkeys(rows.columns[place])])[1:]:
            what = f"{name!r} holds {', '.join(map(str, values[:3]))}: expected one sensor a log"
            table = f"pandas.read_csv({path.name!r}, sep={layout.separator!r})"
            code = f"for who, part in {table}.groupby({name!r}):"
            written = f"part.to_csv(f'{name}_{{who}}.csv', index=False)"
            raise HeadError(path, f"{what}, which these lines part:\n    {code}\n        {written}")


def _a_scan_a_row(path: Path, table: Mapping[str, Array], layout: Layout) -> list[LaserScan]:
    assert layout.view is not None
    ranges = table["ranges"]
    angles = np.radians(np.linspace(*layout.view, ranges.shape[1]))
    factor = places_of(layout.names)["ranges"][1].factor
    if len(angles) > 2 and np.allclose(ranges[0] / factor, np.degrees(angles), atol=1e-6):
        what = "its first row holds the directions of the view: a head is one with # before it"
        raise HeadError(path, what)
    if angles[0] > angles[-1]:
        angles, ranges = angles[::-1], ranges[:, ::-1]
    times = table.get("time", np.full(len(ranges), np.nan))
    return [
        LaserScan(np.where(far > 0, far, np.nan), angles, when, _pose(table, k))
        for k, (far, when) in enumerate(zip(ranges, times, strict=True))
    ]


def _pose(table: Mapping[str, Array], row: int) -> Array | None:
    pose = [table[role][row] for role in POSE if role in table]
    return or_none(np.array(pose)) if len(pose) == len(POSE) else None


def _a_beam_a_row(
    path: Path, table: dict[str, Array], layout: Layout, notes: list[str]
) -> list[LaserScan]:
    if "urg" in table:
        table["range"], codes = as_ranges(table["urg"])
        table["codes"] = codes.astype(float)
    elif "range" not in table:
        met = np.hypot(table["x"], table["y"]) > 0  # others ended nowhere
        table = {role: values[met] for role, values in table.items()}
        table["range"] = np.hypot(table["x"], table["y"])
        table["angle"] = _from_first(np.arctan2(table["y"], table["x"]))
    ways = {column.clockwise for _, column in places_of(layout.names).values()}
    is_clockwise = True in ways
    if ways == {None}:
        notes.append(COUNTERCLOCKWISE)
    if "error" in table:
        table["range"] = np.where(table["error"] > 0, np.nan, table["range"])
    table["range"] = np.where(table["range"] > 0, table["range"], np.nan)
    ends: NDArray[np.int64] = np.empty(0, np.int64)  # a text of a Hokuyo is one scan
    if "scan" in table:
        table, ends = _by_number(path, table)
    elif table.get("new", np.zeros(1)).any():
        ends = np.flatnonzero(table["new"][1:])
    elif "urg" not in table:
        ends, how = ends_of_turns(table["angle"])
        notes += [f"a scan ends where the angle {how}"] * bool(len(ends))
    times = table.get("time", np.full(len(table["angle"]), np.nan))
    back = np.flatnonzero(np.diff(times) < 0)
    if len(back) > max(len(ends), 1):
        raise LogError(
            path, f"its times go back {len(back)} times: sort its rows by time, or name the scans"
        )
    scans = []
    for begin, end in pairwise([0, *(ends + 1).tolist(), len(times)]):
        if end - begin > MOST_BEAMS_READ:
            what = f"expected at most {MOST_BEAMS_READ} beams in a scan, got {end - begin}"
            raise LogError(path, f"{what}: a column `scan` or `new` says where one ends")
        way = (
            slice(end - 1, begin - 1 if begin else None, -1) if is_clockwise else slice(begin, end)
        )
        angles, ranges, when = (table.get(role, times)[way] for role in ("angle", "range", "time"))
        first = float(np.min(when))
        if np.ptp(when) > LONGEST_TURN_S:
            words = f"the beams of a scan take {np.ptp(when):.6g} s, and no laser turns so slowly"
            raise LogError(path, f"{words}: are its times milliseconds, or is it several scans?")
        delays = when - first if np.ptp(when) > 0 else None
        errors = table["codes"][way].astype(np.int64) if "codes" in table else None
        pose = _pose(table, begin)
        scans.append(LaserScan(ranges, angles, first, pose, codes=errors, delays=delays))
    return scans


def _by_number(
    path: Path, table: Mapping[str, Array]
) -> tuple[dict[str, Array], NDArray[np.int64]]:
    """The beams with those of one scan together, in the order of the file, and where scans end."""
    number = table["scan"]
    steps = np.flatnonzero(np.diff(number))
    if len(steps) + 1 == len(np.unique(number)):
        return dict(table), steps
    order = np.argsort(number, kind="stable")
    beams = np.unique(np.stack([number, table["angle"]]), axis=1)
    if beams.shape[1] < len(number):
        what = "scan numbers come back, with directions that their scans have already"
        raise LogError(path, f"{what}: expected the rows of one recording")
    sorted_table = {role: values[order] for role, values in table.items()}
    return sorted_table, np.flatnonzero(np.diff(sorted_table["scan"]))


def _from_first(angles: Array) -> Array:
    """Angles of points in their order, that wrap where the first of them lies."""
    steps = np.diff(np.unwrap(angles))
    onwards = 1.0 if (steps > 0).sum() >= (steps < 0).sum() else -1.0
    first = angles[:1] - onwards * SAME_DIRECTION_RAD
    return np.asarray(first + onwards * np.mod(onwards * (angles - first), 2 * np.pi))


def ends_of_turns(angles: Array) -> tuple[NDArray[np.int64], str]:
    """Last beams of turns, or of sweeps to and fro, by their places, and what tells them."""
    steps = np.diff(angles)
    onwards = 1.0 if (steps > 0).sum() >= (steps < 0).sum() else -1.0
    wraps = np.flatnonzero(-onwards * steps > min(np.ptp(angles) / 2, np.pi))
    if len(wraps):
        return wraps, "wraps"
    aside = angles - (angles.max() + angles.min()) / 2
    outer = np.flatnonzero(np.abs(aside) > np.ptp(angles) / 4)
    visits = np.split(outer, np.flatnonzero(np.diff(np.sign(aside[outer]))) + 1)
    ends = [int(v[np.abs(aside[v]).argmax()]) for v in visits[1:-1]]
    return np.array(ends, int), "turns back"
