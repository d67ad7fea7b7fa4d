"""Rows of a table that are whole, as columns in the units of segmap: pandas reads the fields.

A row with another number of fields, or with a word where a number should be, is damaged; a word for
nothing is no measurement.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...arrays import LIMIT, Array
from ..lines import (
    LATEST_TIME_S,
    MOST_DIRECTION_RAD,
    NOT_MEASURED,
    STRIPPED,
    HeadError,
    Lines,
    LogError,
    float_fields,
)
from ._columns import Column, places_of, ranges_in
from ._layout import COMMENTS, Layout, fields_of

HALF_DAY_S = 43_200.0
CLOCK_TIME = r"\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?"
ISO_DATE = r"\d{4}-\d{2}-\d{2}"
#: Largest value of a role, in metres, radians or seconds, and what is expected of one.
MOST = {
    "angle": (MOST_DIRECTION_RAD, "an angle within two turns"),
    "time": (LATEST_TIME_S, "a time"),
}
#: Words of a column `new`, and of `error` where none is.
YES = ("true", "1", "1.0", "s")
NO_ERROR = ("", "0", "0.0", "00", "0000", "nan")
#: A number in the name of a column.
BEAM = re.compile(r"\d+")
#: What stands between the parts of a line with words.
PART = "\x1f"


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
        wide = len(layout.names)
        if layout.kinds and len(layout.kinds) != wide:
            what = f"{wide} columns are named, but its rows have {len(layout.kinds)} fields"
            raise HeadError(lines.path, f"{what}; - names one that is left out, -*N several")
        parts = self._beams(numbered) if layout.pattern else self._rows(numbered, is_quoted)
        if not parts:
            raise lines.no_scan(f"rows of {layout.columns}")
        self.numbers = np.array([number for number, _ in parts], int)
        self.columns = pd.read_csv(
            io.StringIO("\n".join(row for _, row in parts)), header=None, names=range(wide),
            sep=PART if layout.pattern else layout.separator or r"\s+", decimal=layout.decimal,
            skipinitialspace=True, low_memory=False, lineterminator="\n", skip_blank_lines=False,
            quoting=csv.QUOTE_MINIMAL if is_quoted else csv.QUOTE_NONE, index_col=False,
        )  # fmt: skip
        if "angle_min" in layout.names:  # rows without it are of other topics
            is_scan = self.columns[layout.names.index("angle_min")].notna().to_numpy()
            self.columns = self.columns[is_scan].reset_index(drop=True)
            self.numbers = self.numbers[is_scan]
        self.good = np.ones(len(self.numbers), bool)

    def _beams(self, numbered: Sequence[tuple[int, str]]) -> list[tuple[int, str]]:
        """The parts of lines that hold a beam, or a scan."""
        layout, beams = self.layout, []
        mark, wanted = re.compile(layout.mark), layout.columns
        pattern = re.compile(layout.pattern)
        for number, row in numbered:
            if match := pattern.search(row):
                beams.append((number, PART.join(part or "" for part in match.groups())))
            elif mark.search(row):
                self._damaged(number, f"expected a beam, {wanted}, got {row[:40]!r}")
        return beams

    def _rows(self, numbered: Sequence[tuple[int, str]], is_quoted: bool) -> list[tuple[int, str]]:
        """The rows with as many fields as most of the first have."""
        mark, wide, rows = self.layout.separator, len(self.layout.names), []
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
        self.lines.leave_out(LogError(self.lines.path, fault, number))

    def ranges(self) -> list[Array]:
        """The ranges of each row, `(n,)`, metres: of a column each, or of one cell."""
        layout, lines = self.layout, self.lines
        places, (first, column) = ranges_in(layout.names), places_of(layout.names)["ranges"]
        if layout.view is None and len(places) == 1:
            return self._cells(first)
        if layout.view is None:
            beams = {int(BEAM.findall(layout.head[k])[-1]): k for k in places}
            places = [beams[k] for k in sorted(beams)]  # some sort their names as words
            if min(beams) > 1 or max(beams) - min(beams) + 1 != len(beams):
                what = (
                    f"its ranges are those of {len(beams)} beams from {min(beams)} to {max(beams)}"
                )
                raise HeadError(lines.path, f"{what}: expected a column of each beam, from 0")
        return [*np.stack([self.numbers_of(place, column) for place in places], axis=1)]

    def _cells(self, place: int) -> list[Array]:
        """The numbers in each cell of a column."""
        texts, cells = self.columns[place].astype(str), list[Array]()
        if texts.str.contains("...", regex=False).any():
            what = "ROS shortened its ranges: `ros2 topic echo --full-length --csv`"
            raise LogError(self.lines.path, what)
        for row, numbers in enumerate(texts.str.findall(r"[^\s,()\[\]']+")):
            try:
                cells.append(float_fields(numbers, "ranges"))
            except ValueError as fault:
                cells.append(np.empty(0))
                self.damaged(row, str(fault))
        return cells

    def damaged(self, row: int, fault: str) -> None:
        """Leave a row out, or end the reading."""
        self.good[row] = False
        self._damaged(int(self.numbers[row]), fault)

    def texts(self, place: int) -> Any:
        """A column as words in lower case."""
        texts = self.columns[place].astype(str).fillna("").str.strip().str.strip("'").str.lower()
        return texts if self.layout.decimal == "." else texts.map(self.layout.clean)

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
            self.damaged(row, f"expected {bounded if beyond[row] else plain}, got {got!r}")
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
