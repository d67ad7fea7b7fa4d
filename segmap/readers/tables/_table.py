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

from ...arrays import LIMIT, Array, checked
from ...scans import LaserScan, Log
from ..lines import (
    LATEST_TIME_S,
    MOST_DIRECTION_RAD,
    NOT_MEASURED,
    STRIPPED,
    HeadError,
    Lines,
    LogError,
    OnError,
    stem,
)
from ..packed import log_file
from ..raw_scans import COUNTERCLOCKWISE, known, place_of
from ._columns import BEAM_ROLES, Column, places_of
from ._layout import (
    COMMENTS,
    Layout,
    checked_view,
    declared_layout,
    fields_of,
    layout_of,
    said_beside,
)
from ._question import choices_of

#: No scan has more beams.
MOST_BEAMS_READ = 100_000
#: No table has more bytes.
MOST_BYTES = 1 << 30
HALF_DAY_S = 43_200.0
TIME_OF_DAY = r"\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?"
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
POSE = ("pose_x", "pose_y", "pose_theta")
#: A scan of end points may begin so much before the first one did.
SAME_DIRECTION_RAD = np.radians(0.5)


class Rows:
    """The rows of a table that are whole, as columns by their places."""

    def __init__(self, lines: Lines, layout: Layout) -> None:
        self.lines, self.layout = lines, layout
        text = lines.held(MOST_BYTES).decode("utf-8-sig", "replace")
        self.is_quoted = '"' in text
        each = [row.strip(STRIPPED) for row in text.split("\n")]
        head = each[layout.line - 1] if layout.line else ""
        places = [
            place
            for place in range(layout.line, len(each))
            if (row := each[place]) and row != head and not row.startswith(COMMENTS)
        ]
        rows = [each[place] for place in places]
        parts = self._matched(places, rows) if layout.pattern else self._counted(places, rows)
        self.numbers = np.array([place for place, _ in parts], int) + 1
        self.columns = self._parsed([row for _, row in parts])
        self.good = np.ones(len(parts), bool)

    def _matched(self, places: Sequence[int], rows: Sequence[str]) -> list[tuple[int, str]]:
        """The parts of lines that hold a beam, between commas."""
        mark, pattern, found = re.compile(self.layout.mark), re.compile(self.layout.pattern), []
        for place, row in zip(places, rows, strict=True):
            if match := pattern.search(row):
                found.append((place, ",".join(part or "" for part in match.groups())))
            elif mark.search(row):
                wanted = ",".join(self.layout.names)
                self._damaged(place + 1, f"expected a beam, {wanted}, got {row[:40]!r}")
        return found

    def _counted(self, places: Sequence[int], rows: Sequence[str]) -> list[tuple[int, str]]:
        """The rows with as many fields as most of the first have."""
        mark, wide = self.layout.separator, len(self.layout.kinds)
        if mark is None:
            counts = [len(row.split()) for row in rows]
        elif self.is_quoted:
            counts = [len(fields_of(row, mark)) * (row.count('"') % 2 == 0) for row in rows]
        else:
            counts = [row.count(mark) + 1 for row in rows]
        for place, count in zip(places, counts, strict=True):
            if count != wide:
                self._damaged(place + 1, f"expected {wide} fields, got {count}")
        triples = zip(places, rows, counts, strict=True)
        return [(place, row) for place, row, count in triples if count == wide]

    def _parsed(self, rows: Sequence[str]) -> Any:
        import pandas as pd

        layout = self.layout
        wide = len(layout.names if layout.pattern else layout.kinds)
        if wide < len(layout.names):
            what = f"{len(layout.names)} columns are named, but its rows have {wide} fields"
            raise HeadError(self.lines.path, what)
        if not rows:
            raise self.lines.no_scan(f"rows of {','.join(layout.names)}")
        return pd.read_csv(
            io.StringIO("\n".join(rows)), header=None, names=range(wide), index_col=False,
            sep="," if layout.pattern else layout.separator or r"\s+", decimal=layout.decimal,
            skipinitialspace=True, low_memory=False, lineterminator="\n", skip_blank_lines=False,
            quoting=csv.QUOTE_MINIMAL if self.is_quoted else csv.QUOTE_NONE,
        )  # fmt: skip

    def _damaged(self, number: int, fault: str) -> None:
        self.lines.damaged(LogError(self.lines.path, fault, number))

    def texts(self, place: int) -> Any:
        """A column as words in lower case."""
        texts = self.columns[place].astype(str).fillna("").str.strip().str.strip("'").str.lower()
        return texts.str.replace(",", ".") if self.layout.decimal == "," else texts

    def is_words(self, place: int) -> bool:
        """Whether a column does not hold numbers alone."""
        return self.columns[place].dtype.kind not in "iuf"

    def numbers_of(self, place: int, column: Column) -> Array:
        """A column in the units of segmap, NaN for nothing; rows with another word are damaged."""
        import pandas as pd

        texts = self.texts(place) if self.is_words(place) else None
        held = self.columns[place] if texts is None else pd.to_numeric(texts, errors="coerce")
        values = held.to_numpy(float, na_value=np.nan) * column.factor
        plain = f"a number for the {column.role}"
        most, bounded = MOST.get(column.role, (LIMIT, plain))
        ends = column.role in ("range", "ranges", "x", "y")
        with np.errstate(invalid="ignore"):
            beyond = (np.abs(values) > most) & ~(np.isinf(values) & ends)
        wrong = beyond | (np.isnan(values) & (column.role in ("angle", "scan")))
        if texts is not None:
            wrong |= np.isnan(values) & ~texts.isin(NOT_MEASURED).to_numpy()
            if self.layout.decimal == ",":  # a point would part thousands
                wrong |= self.columns[place].astype(str).str.contains(r"\d\.\d").to_numpy()
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
            held = texts.isin(YES) if is_new else ~texts.isin(NO_ERROR)
            return np.asarray(held, float)
        if column.role != "time" or column.unit:
            return self.numbers_of(place, column)
        if not self.is_words(place):
            return None
        texts = self.texts(place)
        if texts.str.fullmatch(TIME_OF_DAY).all():
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
    rows, places, told = Rows(lines, layout), places_of(layout.names), list(layout.told)
    beam = next(kind for kind in BEAM_ROLES if {*kind} <= {*places})
    others = {role for kind in BEAM_ROLES for role in kind} - {*beam}
    others |= set() if {*POSE} <= {*places} else {*POSE}
    places = {role: at for role, at in places.items() if role not in others}
    ranges_at, ranges = places.pop("ranges", (len(layout.names), None))
    behind = rows.columns.shape[1] - len(layout.names)  # so many more fields than names
    held: dict[str, Array] = {}
    for role, (k, column) in places.items():
        place = k if k < ranges_at else k + behind
        values = rows.values(place, column)
        if values is None:
            told.append(f"{layout.names[k]!r} says no unit of time and is left out")
        else:
            held[role] = values
    if ranges:
        fields = range(ranges_at, ranges_at + behind + 1)
        held["ranges"] = np.stack([rows.numbers_of(place, ranges) for place in fields], axis=1)
    _refuse_several(path, rows, layout)
    used = {k for k, _ in places.values()} | {ranges_at}
    unused = [n for k, n in enumerate(layout.names) if k not in used and n not in ("", "-")]
    if unused:
        told.append(f"left out: {', '.join(map(repr, unused))}")
    if {"time", "nanosec"} <= {*held}:
        held["time"] = held["time"] + held["nanosec"]
    wrong = int((~rows.good).sum())
    if wrong > len(rows.good) - wrong:
        what = f"{wrong} of {len(rows.good)} lines are no {','.join(layout.names)}"
        raise LogError(path, f"{what}: {lines.first.reason if lines.first else ''}")
    held = {role: values[rows.good] for role, values in held.items()}
    scans = _a_scan_a_row(held, layout) if ranges else _a_beam_a_row(path, held, layout, told)
    if any(scan.odometry is not None for scan in scans):
        told.append(place_of(np.zeros(3)))
    return Log(name, scans, None, lines.skipped, assumed=told)


def _refuse_several(path: Path, rows: Rows, layout: Layout) -> None:
    """A column of the file itself that says that several sensors measured ends the reading."""
    for place, name in enumerate(layout.names):
        if WHO.fullmatch(name) and (values := [*dict.fromkeys(rows.columns[place])])[1:]:
            said = ", ".join(map(str, values[:3]))
            rows_of = f"pandas.read_csv(path, sep={layout.separator!r}, skiprows={layout.line - 1})"
            raise HeadError(
                path,
                f"{name!r} holds {said}: expected one sensor a log; [part.to_csv(f'part{{k}}.csv', "
                f"index=False) for k, (_, part) in enumerate({rows_of}.groupby({name!r}), 1)] "
                "parts them",
            )


def _a_scan_a_row(held: Mapping[str, Array], layout: Layout) -> list[LaserScan]:
    assert layout.view is not None
    ranges = held["ranges"]
    angles = np.radians(np.linspace(*layout.view, ranges.shape[1]))
    if angles[0] > angles[-1]:
        angles, ranges = angles[::-1], ranges[:, ::-1]
    times = held.get("time", np.full(len(ranges), np.nan))
    return [
        LaserScan(np.where(far > 0, far, np.nan), angles, when, _pose(held, k))
        for k, (far, when) in enumerate(zip(ranges, times, strict=True))
    ]


def _pose(held: Mapping[str, Array], row: int) -> Array | None:
    pose = [held[role][row] for role in POSE if role in held]
    return known(np.array(pose)) if len(pose) == len(POSE) else None


def _a_beam_a_row(
    path: Path, held: dict[str, Array], layout: Layout, told: list[str]
) -> list[LaserScan]:
    if "range" not in held:
        met = np.hypot(held["x"], held["y"]) > 0  # others ended nowhere
        held = {role: values[met] for role, values in held.items()}
        held["range"] = np.hypot(held["x"], held["y"])
        held["angle"] = _from_first(np.arctan2(held["y"], held["x"]))
    is_clockwise = any(column.clockwise for _, column in places_of(layout.names).values())
    if not is_clockwise:
        told.append(COUNTERCLOCKWISE)
    if "error" in held:
        held["range"] = np.where(held["error"] > 0, np.nan, held["range"])
    held["range"] = np.where(held["range"] > 0, held["range"], np.nan)
    if "scan" in held:
        held, ends = _by_number(path, held)
    elif held.get("new", np.zeros(1)).any():
        ends = np.flatnonzero(held["new"][1:])
    else:
        ends, how = ends_of_turns(held["angle"])
        told += [f"a scan ends where the angle {how}"] * bool(len(ends))
    times = held.get("time", np.full(len(held["angle"]), np.nan))
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
        angles, ranges, when = (held.get(role, times)[way] for role in ("angle", "range", "time"))
        first = float(np.min(when))
        delays = when - first if np.ptp(when) > 0 else None
        turned = -angles if is_clockwise else angles
        scans.append(LaserScan(ranges, turned, first, _pose(held, begin), delays=delays))
    return scans


def _by_number(path: Path, held: Mapping[str, Array]) -> tuple[dict[str, Array], NDArray[np.int64]]:
    """The beams with those of one scan together, in the order of the file, and where scans end."""
    number = held["scan"]
    steps = np.flatnonzero(np.diff(number))
    if len(steps) + 1 == len(np.unique(number)):
        return dict(held), steps
    order = np.argsort(number, kind="stable")
    beams = np.unique(np.stack([number, held["angle"]]), axis=1)
    if beams.shape[1] < len(number):
        what = "scan numbers come back, with directions that their scans have already"
        raise LogError(path, f"{what}: expected the rows of one recording")
    found = {role: values[order] for role, values in held.items()}
    return found, np.flatnonzero(np.diff(found["scan"]))


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


def read_declared(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a table by what it says of its columns."""
    return read_declared_rows(path, name, on_error, layout_of(path))


@checked
def read_csv(
    path: str | Path,
    *,
    columns: str | Sequence[str] | None = None,
    view: Sequence[float] | None = None,
    on_error: OnError = "raise",
) -> Log:
    """Read a table whose columns the caller names.

    Parameters
    ----------
    columns : list of str, or one str with commas
        From the left, with units: `angle_deg`, `range_mm`, `time_s`, `scan`, `-` for one to leave
        out; all names stand at the top of `readers/tables/_columns.py`. None takes what the file,
        or `NAME.toml` beside it, says.
    view : two numbers, degrees
        Of a scan a row, `ranges_m`: where its first and its last range point, counter-clockwise
        from straight ahead.
    on_error : "raise" or "skip"
        As in `read`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "mine.csv"
    ...     _ = path.write_text("0;1500\\n90;2000\\n180;0\\n0;1510\\n90;2010\\n180;900\\n")
    ...     log = read_csv(path, columns=["angle_deg", "range_mm"])
    >>> log, log[1].ranges
    (Log('mine', 2 scans, no odometry, no truth), array([1.51, 2.01, 0.9 ]))
    """
    with log_file(path) as place:
        if columns is not None:
            layout = declared_layout(place, columns, view)
        else:
            layout = said_beside(Path(path)) or layout_of(place)
            layout = layout._replace(view=checked_view(view) or layout.view)
        return read_declared_rows(place, stem(place), on_error, layout)
