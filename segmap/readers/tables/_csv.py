"""CSV of cheap sensors: a line a beam, columns named by a header or by the caller.

    angle_deg,range_mm,quality,time_s,scan

The separator is a comma, a semicolon, a tab or white space. Columns are known by their names, the
unit stands in them (`angle_deg`, `range [mm]`, `time (us)`): no unit is guessed. A scan ends where
its number changes or, without a column `scan`, where the angle wraps; its time is that of its first
beam, and without a column `time` unknown. Angles are counter-clockwise unless their name or the
caller says otherwise (`angle_deg_cw`). A range of 0 and an empty one are no
measurement, `inf` is a beam that met nothing. Other columns, such as the quality, are left out.
There is no odometry and no truth.

Assumed: beams are counter-clockwise, where neither a name (`ccw`) nor the caller says it, and a
scan ends where the angle wraps, without a column `scan`.

Files that begin with `#RPLIDAR SCAN DATA` hold degrees, clockwise, and millimetres.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...arrays import brief, checked
from ...scans import Log
from .._lines import HeadError, Lines, LogError, OnError, stem, time
from .._turns import COUNTERCLOCKWISE, Beams, direction_field, distance, number_field
from ..packed import log_file
from ._csv_columns import (
    EXAMPLE,
    Head,
    decimal,
    first_row,
    first_rows,
    head,
    head_of,
    wanting,
    with_units_told,
)


class _Table(Beams):
    """Beams in columns that a head names."""

    expected = "lines of angle and range"

    def __init__(self, lines: Lines, head: Head, clockwise: bool, told: Sequence[str]) -> None:
        super().__init__(lines)
        self.head, self.clockwise = head, clockwise or bool(head.clockwise)
        counted = not clockwise and head.clockwise is None
        self.assumed = (*told, *(COUNTERCLOCKWISE,) * counted)
        self.last = max(column.place for column in head.columns.values())

    def _take(self, fields: list[str]) -> None:
        if self.lines.number <= self.head.line:
            return
        if len(fields) <= self.last:
            raise ValueError(f"expected {self.last + 1} columns or more, got {len(fields)}")
        columns = self.head.columns
        said = {
            role: decimal(fields[column.place].strip().strip("\"'"), self.lines.separator)
            for role, column in columns.items()
        }
        factors = {role: column.factor or 1.0 for role, column in columns.items()}
        beam = (
            direction_field(said["angle"], factors["angle"]),
            distance(said["range"], factors["range"]),
            time(said["time"], unit=factors["time"]) if "time" in said else np.nan,
            number_field(said["scan"], "the scan") if "scan" in said else np.nan,
        )
        self.scans.append(beam)


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a file whose header names the columns: no odometry, no truth."""
    return _read_table(path, name, on_error, *_stated(path))


@checked
def read_csv(
    path: str | Path,
    *,
    columns: str | Sequence[str] | None = None,
    clockwise: bool = False,
    on_error: OnError = "raise",
) -> Log:
    """Read a CSV file with a beam a line, whose columns the caller names.

    Fields lie between commas, semicolons, tabs or white space. A scan ends where the column `scan`
    changes or, without one, where the angle wraps.

    Parameters
    ----------
    columns : list of str, or one str with commas
        Names of the columns from the left, with units: `angle_deg` or `angle_rad`, `range_m`,
        `range_cm` or `range_mm`; where the file has them `time_s`, `time_ms`, `time_us` or
        `time_ns`, and `scan`; any other name for a column to leave out. Instead of the header's,
        where the file has one. None takes the header's.
    clockwise : bool
        Whether angles grow clockwise, seen from above, as those of most cheap sensors do. Scans are
        turned round then.
    on_error : "raise" or "skip"
        As in `read`.

    Raises
    ------
    LogError
        As in `read`, and where the header does not say columns or units.

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
    names = columns.split(",") if isinstance(columns, str) else columns
    if names is not None:
        if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
            raise ValueError(
                f"columns must be a list of names, such as {EXAMPLE}, got {brief(columns)}"
            )
        try:
            fault = wanting(head(names))
        except ValueError as same:
            fault = str(same)
        if fault:
            raise ValueError(f"columns must name angle and range with units: {fault}")
    with log_file(path) as place:
        if names is None:
            found, told = _stated(place)
        else:
            row = first_row(place)
            found, told = head(names, row.separator, row.line), []
        return _read_table(place, stem(place), on_error, found, told, clockwise)


def _stated(path: Path) -> tuple[Head, list[str]]:
    """What the header says, and what the numbers below it say of units: must be enough."""
    found = head_of(path)
    if found is None:
        raise LogError(path, f"no header names angle and range: name the columns, {EXAMPLE}")
    found, told = with_units_told(found, first_rows(path, found))
    if fault := wanting(found):
        raise HeadError(path, fault, found.line)
    return found, told


def _read_table(
    path: Path,
    name: str,
    on_error: str,
    found: Head,
    told: Sequence[str],
    clockwise: bool = False,
) -> Log:
    lines = Lines(path, on_error, found.separator)
    return _Table(lines, found, clockwise, told).walked()._log(name)
