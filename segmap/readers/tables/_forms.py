"""The kinds of tables, how each is recognised, and what the user is asked about unknown ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ...arrays import checked
from ...scans import Log
from ..lines import OnError, UnknownFormat, stem
from ..packed import log_file
from ..text import Binary
from ._columns import POSES_ALONE, meaning
from ._csm import Csm
from ._fixed import CoreSlam, Rawseeds
from ._folders import (
    files_of,
    numbered_files,
    read_as_stated,
    read_folder,
    read_in_order,
    read_numbered,
)
from ._layout import checked_view, declared_layout, layout_in_toml, layout_of
from ._question import choices_of
from ._table import read_declared_rows
from ._trajectories import pose_layout_of

#: Rows of numbers without names; with this many the file is a table.
LEAST_ROWS = 3


def is_table(path: Path) -> bool:
    """Whether a file says that it is a table, though perhaps not enough."""
    layout = layout_of(path)
    return bool(layout.names) or any(c and c.role != "time" for c in map(meaning, layout.head))


#: Told by a head, or by words that stand in each line.
TABLE = Binary("table", is_table, read_as_stated)
TABLE_FOLDERS = (
    Binary("Rawseeds", files_of, read_folder),
    Binary("numbered scans", numbered_files, read_numbered),
)
TABLE_FORMATS = (CoreSlam, Rawseeds, Csm)


def asked_of(path: Path) -> str:
    """What is asked of a file that holds rows of numbers and no name of them; empty of another."""
    layout = layout_of(path)
    if pose_layout_of(path).names:
        return POSES_ALONE
    are_numbers = len(layout.rows) >= LEAST_ROWS and 2 * sum(layout.kinds) >= len(layout.kinds)
    return choices_of(layout).question(path.name) if are_numbers else ""


@checked
def read_csv(
    path: str | Path,
    *,
    columns: str | Sequence[str] | None = None,
    view: Sequence[float] | None = None,
    on_error: OnError = "raise",
) -> Log:
    """Read a table whose columns the caller names, or a folder of numbered ones with a scan each.

    Parameters
    ----------
    columns : list of str, or one str with commas
        From the left, with units: `angle_deg`, `angle_deg_cw` (clockwise), `range_mm`, `time_s`,
        `scan`; `x_m`, `y_m` for ends of beams; `pose_x_m`, `pose_y_m`, `pose_theta_rad`; `new`,
        `error`, `nanosec`; `urg_mm` of a Hokuyo, with its error codes; `ranges_m` for a scan a row;
        `-` for one to leave out, `-*20` for 20. Units are m, cm, mm, ft, in; deg, rad; s, ms, us,
        ns, and parts of them: `angle_deg/10`. None takes what the file, or `NAME.toml` beside it,
        says.
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

    def read(place: Path, name: str, on_error: str) -> Log:
        if columns is not None:
            layout = declared_layout(place, columns, view)
        else:
            layout = layout_in_toml(Path(path)) or layout_of(place)
            layout = layout._replace(view=checked_view(view) or layout.view)
        return read_declared_rows(place, name, on_error, layout)

    with log_file(path, folders=columns is not None) as place:
        if not place.is_dir():
            return read(place, stem(place), on_error)
        if not (files := numbered_files(place, read, least=1)):
            raise UnknownFormat(place, f"holds no numbered files of {columns} with a scan each")
        return read_in_order(files, place.resolve().name, on_error, read)
