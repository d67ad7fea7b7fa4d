"""CSV of cheap sensors: a line a beam, columns named by a header or by the caller.

    angle_deg,range_mm,quality,time_s,scan

The separator is a comma, a semicolon, a tab or white space. Columns are known by their names, the
unit stands in them (`angle_deg`, `range [mm]`, `time (us)`): no unit is guessed. A scan ends where
its number changes or, without a column `scan`, where the angle wraps; its time is that of its first
beam, and without a column `time` its place in the log. Angles are counter-clockwise unless their
name or the caller says otherwise (`angle_deg_cw`). A range of 0 and an empty one are no
measurement, `inf` is a beam that met nothing. Other columns, such as the quality, are left out.
There is no odometry and no truth.

Files that begin with `#RPLIDAR SCAN DATA` hold degrees, clockwise, and millimetres.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from ... import arrays
from ...scans import Log
from .._lines import Lines, LogError, time
from .._opening import asking, checked_file, named, stem
from .._turns import Beam, angle, distance, number, to_scans
from ._csv_columns import EXAMPLE, Head, first_row, head, head_of, wanting


def claims(path: Path) -> bool:
    """Whether a file has a header that names angle and range."""
    return head_of(path) is not None


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a file whose header names the columns: no odometry, no truth."""
    found = head_of(path) or Head({}, None, 0)
    if fault := wanting(found):
        raise LogError(path, fault, found.line or None)
    return _read(path, name, on_error, found)


def read_csv(
    path: str | Path,
    *,
    columns: str | Sequence[str] | None = None,
    clockwise: bool = False,
    on_error: str = "raise",
) -> Log:
    """Read a CSV file with a beam a line, whose columns the caller names.

    Parameters
    ----------
    path : str or Path
        Plain or gzip; fields between commas, semicolons, tabs or white space.
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

    Returns
    -------
    Log
        Metres, radians, seconds; no odometry, no truth. A scan ends where the column `scan`
        changes or, without one, where the angle wraps.

    Raises
    ------
    LogError
        As in `read`, and where the header does not say columns or units.
    ValueError
        Columns without an angle, a range or their units.

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
    on_error = arrays.one_of(on_error, "on_error", ("raise", "skip"))
    clockwise = arrays.switch(clockwise, "clockwise")
    wanted = None if columns is None else _columns(columns)
    path = named(path)
    with asking(path):
        found = _head(checked_file(path), wanted)
        return _read(path, stem(path.resolve().name), on_error, found, clockwise)


def _columns(columns: object) -> list[str]:
    names = columns.split(",") if isinstance(columns, str) else columns
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        raise ValueError(f"columns must be a list of names, such as {EXAMPLE}, got {columns!r}")
    try:
        fault = wanting(head(names))
    except ValueError as same:
        fault = str(same)
    if fault:
        raise ValueError(f"columns must name angle and range with units: {fault}")
    return list(names)


def _head(path: Path, columns: Sequence[str] | None) -> Head:
    if columns is not None:
        row = first_row(path)
        return head(columns, row.separator, row.line)
    found = head_of(path)
    if found is None:
        raise LogError(path, f"no header names angle and range: name the columns, {EXAMPLE}")
    if fault := wanting(found):
        raise LogError(path, fault, found.line)
    return found


def _read(path: Path, name: str, on_error: str, found: Head, clockwise: bool = False) -> Log:
    lines = Lines(path, on_error, found.separator)
    parse = partial(_parse, found=found, lines=lines)
    beams = [beam for beam in lines.each(parse) if beam is not None]
    if not beams:
        raise lines.no_scan("lines of angle and range")
    scans = to_scans(beams, lines, clockwise=clockwise or found.clockwise)
    return Log(name, scans, None, lines.skipped)


def _parse(fields: list[str], found: Head, lines: Lines) -> Beam | None:
    if lines.number == found.line:
        return None
    columns = found.columns
    last = max(column.place for column in columns.values())
    if len(fields) <= last:
        raise ValueError(f"expected {last + 1} columns or more, got {len(fields)}")
    said = {role: fields[column.place].strip().strip("\"'") for role, column in columns.items()}
    factors = {role: column.factor or 1.0 for role, column in columns.items()}
    return (
        angle(said["angle"], factors["angle"]),
        distance(said["range"], factors["range"]),
        time(said["time"], unit=factors["time"]) if "time" in said else np.nan,
        number(said["scan"], "the scan") if "scan" in said else np.nan,
    )
