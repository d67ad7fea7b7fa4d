"""Log files: whatever a robot recorded becomes a `Log`.

`read` recognises the format by what is in the file; `load` reads a log that comes with segmap. One
file a format, each with what it means to the field: `_carmen` (with `_robotlaser`), `_g2o`,
`_player`, `_rawseeds`, `_hokuyo_text`, `_coreslam`.
"""

from pathlib import Path

from ..arrays import Array
from ..scans import Log
from . import _bundled, _formats, _rawseeds
from ._beams import half_turn
from ._bundled import data_file
from ._lines import LogError
from ._shots import same_poses

__all__ = [
    "LogError",
    "data_file",
    "half_turn",
    "load",
    "read",
    "read_trajectory",
    "same_poses",
]


def read(path: str | Path, *, on_error: str = "raise") -> Log:
    """Read a log, whatever its format: plain or gzip, a file or a folder.

    Beams that met nothing have range `inf`, those with an error of the sensor NaN: neither is
    valid. What the formats leave unsaid, and how it is read, stands in the file of each format.

    Parameters
    ----------
    path : str or Path
        A log of CARMEN (FLASER, RLASER, ROBOTLASER), g2o with ROBOTLASER1, Player text, CoreSLAM;
        a folder of Rawseeds files, or the file of one of its lasers; a Hokuyo scan as text, or a
        folder of numbered ones.
    on_error : "raise" or "skip"
        What a damaged line means: the end of reading, or one line less; `log.skipped` then tells
        how many lines were left out and why the first.

    Returns
    -------
    Log
        Metres, radians, seconds; odometry and, where the file has them, corrected poses as `truth`:
        both `(k, 3)`, of the robot.

    Raises
    ------
    LogError
        A damaged line, or a file that cannot be read, is of no known format or holds no scan. With
        "skip" too where no scan remains, and for a line of more than a megabyte.
    ValueError
        Another `on_error`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "two.log"
    ...     _ = path.write_text("FLASER 2 1 81.83 0 0 0 0 0 0\\nFLASER 2 1\\n")
    ...     log = read(path, on_error="skip")
    >>> log, log.skipped.lines, log[0].valid
    (Log('two', 1 scan, odometry, no truth), 1, array([ True, False]))
    """
    path, on_error = Path(path), _checked(on_error)
    try:
        name = path.resolve().name
        if path.is_dir():
            return _formats.read_folder(path, name, on_error)
        return _formats.read_file(_checked_file(path), _stem(name), on_error)
    except OSError as fault:
        raise LogError(path, f"cannot be read ({fault.strerror or fault})") from fault


def read_trajectory(path: str | Path, *, on_error: str = "raise") -> tuple[Array, Array]:
    """Read a file of poses: Rawseeds ground truth, or its odometry.

    Parameters
    ----------
    path : str or Path
        Comma-separated lines `t, x, y, theta, 9 covariances`, or those of ODOMETRY_XYT.csv.
    on_error : "raise" or "skip"
        As in `read`.

    Returns
    -------
    times : (k,) array, seconds, ascending
    poses : (k, 3) array, metres and radians

    Raises
    ------
    LogError
        As in `read`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "GROUNDTRUTH.csv"
    ...     _ = path.write_text("10.5, 1, 2, 0.5" + ", 0" * 9)
    ...     read_trajectory(path)
    (array([10.5]), array([[1. , 2. , 0.5]]))
    """
    times, poses, _ = _rawseeds.read_trajectory(_checked_file(Path(path)), _checked(on_error))
    return times, poses


def load(name: str) -> Log:
    """Read one of the logs that come with segmap.

    Parameters
    ----------
    name : str
        "malaga", a real one, or a simulated one: the name of its folder under `data`.

    Returns
    -------
    Log
        As `read` gives it; `truth` is `(k, 3)`, metres and radians.

    Raises
    ------
    ValueError
        Where no log of that name comes with segmap; it lists those that do.

    Examples
    --------
    >>> load("malaga")
    Log('malaga', 225 scans, odometry, truth for 99)
    """
    return read(_bundled.find(name))


def _checked(on_error: str) -> str:
    if on_error not in ("raise", "skip"):
        raise ValueError(f"on_error must be 'raise' or 'skip', got {on_error!r}")
    return on_error


def _checked_file(path: Path) -> Path:
    if not path.is_file():
        found = "is no file" if path.exists() else "does not exist"
        raise LogError(path, f"{found}, expected a log file or a folder of one")
    return path


def _stem(name: str) -> str:
    return name.removesuffix(".gz").removesuffix(".zip").rsplit(".", 1)[0]
