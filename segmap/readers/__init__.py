"""Log files: whatever a robot recorded becomes a `Log`.

`read` recognises the format by what is in the file; `load` reads a log that comes with segmap. One
file a format, each with what it means to the field; `_formats` lists them. `read_segments` reads a
map that `exports.write_segments` wrote, `read_graph` a pose graph of g2o.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from .. import arrays
from ..arrays import Array
from ..scans import Log
from ._bundled import data_file, find
from ._formats import recognise, what_to_do
from ._lines import LogError, UnknownFormat
from ._opening import asking, checked_file, named, stem
from ._raw_scans import half_turn, same_poses
from ._segments import read_segments
from .bags import _bags
from .graphs import PoseGraph, read_graph
from .tables import _hokuyo_text, _rawseeds, read_csv

__all__ = [
    "LogError",
    "PoseGraph",
    "UnknownFormat",
    "data_file",
    "format_of",
    "half_turn",
    "load",
    "read",
    "read_bag",
    "read_csv",
    "read_graph",
    "read_segments",
    "read_trajectory",
    "same_poses",
]

#: What a damaged line means.
ON_ERROR = ("raise", "skip")


def read(path: str | Path, *, on_error: str = "raise") -> Log:
    """Read a log, whatever its format: plain or gzip, a file or a folder.

    Beams that met nothing have range `inf`, those with an error of the sensor NaN: neither is
    valid. What the formats leave unsaid, and how it is read, stands in the file of each format.

    Parameters
    ----------
    path : str or Path
        A log of CARMEN (FLASER, RLASER, ROBOTLASER), a run of GMapping (.gfs), g2o with
        ROBOTLASER1, Player text, DP-SLAM, CMU's Wean Hall, CoreSLAM; a folder of Rawseeds files, or
        the file of one of its lasers; a Hokuyo scan as text, or a folder of numbered ones;
        a rawlog or a simplemap of MRPT; a bag of ROS 1 or ROS 2 (see `read_bag`); CSV with a header
        (others: `read_csv`), a dump of RPLidar or LD19, NPZ with `ranges` and `angles`.
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
        "skip" too where no scan remains, for a line of more than a megabyte, 100 000 empty lines in
        a row, and a packed file of more than 1 MB and 50 times its size: these bounds keep time
        and memory in proportion to the file.
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
    path, on_error = named(path), arrays.one_of(on_error, "on_error", ON_ERROR)
    with asking(path):
        name = path.resolve().name
        if path.is_dir():
            return _folder(path)[1](name, on_error)
        return recognise(checked_file(path)).read(path, stem(name), on_error)


def read_bag(
    path: str | Path,
    *,
    scan: str | None = None,
    odometry: str | None = None,
    on_error: str = "raise",
) -> Log:
    """Read a bag of ROS 1 or ROS 2, with the package `rosbags`: `pip install 'segmap[ros]'`.

    Scans are those of a topic of `sensor_msgs/LaserScan`. Odometry is that of a topic of
    `nav_msgs/Odometry`, interpolated at the times of the scans, or else the way of the frame below
    `odom`; scans before its beginning and after its end have none. Where the laser sits, upside
    down or not, is what `/tf_static` and `/tf` say. Ranges from `range_max` on met nothing, those
    below `range_min` are errors. All beams of a scan are taken to be measured at its time.

    Parameters
    ----------
    path : str or Path
        A `.bag`; a folder with a metadata.yaml, or with one bag alone; a `.db3` or an `.mcap`.
    scan, odometry : str or None
        Names of topics; None takes the one with most messages, and warns where there are others.
    on_error : "raise" or "skip"
        As in `read`: a message that is damaged is left out, a bag that is broken ends there.

    Returns
    -------
    Log
        Metres, radians, seconds; no truth.

    Raises
    ------
    LogError
        What is no bag, or a damaged one; no such topic; a laser that is tilted, or moves on the
        robot; more than 256 MB and 50 times the size unpacked; where `rosbags` is missing.
    ValueError
        What is no name of a topic; another `on_error`.

    Warns
    -----
    UserWarning
        Where there are several topics, nothing tells where the laser sits, or no scan lies within
        the time of the odometry.

    Examples
    --------
    >>> log = read_bag("office.bag", scan="/front/scan")  # doctest: +SKIP
    """
    path, on_error = named(path), arrays.one_of(on_error, "on_error", ON_ERROR)
    for name, topic in (("scan", scan), ("odometry", odometry)):
        if not isinstance(topic, str | None):
            raise ValueError(f"{name} must be the name of a topic, got {arrays.brief(topic)}")
    with asking(path):
        if not path.is_dir():
            checked_file(path)
        if not _bags.claims(path):
            raise UnknownFormat(path, "is no bag of ROS, expected a .bag, .mcap, .db3 or a folder")
        return _bags.read(path, stem(path.resolve().name), on_error, scan, odometry)


def format_of(path: str | Path) -> str:
    """The format of a log, told by its first lines; a folder's, by the files in it.

    Parameters
    ----------
    path : str or Path
        As in `read`.

    Returns
    -------
    str
        "CARMEN" for instance: the rest may be damaged all the same.

    Raises
    ------
    UnknownFormat
        A LogError, where it is no log of any format.
    LogError
        Where it cannot be read.

    Examples
    --------
    >>> format_of(data_file("malaga/malaga.log.gz"))
    'CARMEN'
    """
    path = named(path)
    with asking(path):
        return _folder(path)[0] if path.is_dir() else recognise(checked_file(path)).name


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
    on_error = arrays.one_of(on_error, "on_error", ON_ERROR)
    path = named(path)
    with asking(path):
        return _rawseeds.read_trajectory(checked_file(path), on_error)[:2]


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
    return read(find(name))


# --------------------------------------------------------------------- files and folders
def _folder(folder: Path) -> tuple[str, Callable[[str, str], Log]]:
    """The format of a folder, and what reads it: a bag, a Rawseeds recording, or Hokuyo scans."""
    if _bags.claims(folder):
        return "ROS bag", partial(_bags.read, folder)
    if files := _rawseeds.files_of(folder):
        return "Rawseeds", partial(_rawseeds.read_folder, files)
    if scans := _hokuyo_text.numbered(folder):
        return "Hokuyo text", partial(_hokuyo_text.read_folder, scans)
    raise UnknownFormat(
        folder,
        "holds no log, expected a Rawseeds recording (SICK_FRONT.csv or HOKUYO_FRONT.csv, "
        "ODOMETRY_XYT.csv, GROUNDTRUTH.csv), a bag of ROS 2 (metadata.yaml) "
        f"or numbered files with a Hokuyo scan in each\n{what_to_do()}",
    )
