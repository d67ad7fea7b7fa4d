"""Reading a log of any format, by what is in it."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from .. import arrays
from ..arrays import brief, checked
from ..progress import Progress
from ..scans import Log
from ._bundled import open_bundled
from ._formats import in_parts, recognise
from .lines import OnError, stem
from .packed import log_file
from .tables import layout_in_toml, one_scan_each, read_declared_rows, read_in_order


@checked
def read(
    path: str | Path | Sequence[str | Path],
    *,
    on_error: OnError = "raise",
    progress: Progress | None = None,
) -> Log:
    """Read a log, whatever its format: a file, packed by gzip, bzip2 or xz or plain, or a folder.

    Beams that met nothing have range `inf`, those with an error of the sensor NaN: neither is
    valid. What the formats leave unsaid, and how it is read, stands in the file of each format.

    Parameters
    ----------
    path : str, Path or list of them
        A log of CARMEN (FLASER, RLASER, ROBOTLASER), a run of GMapping (.gfs), g2o with
        ROBOTLASER1, DP-SLAM, CMU's Wean Hall, CoreSLAM; a folder of Rawseeds files, or the file of
        one of its lasers; a Hokuyo scan as text; a bag of ROS 1 or ROS 2 (see `read_bag`), or a
        table of its scans; what the programs of RPLidar, LD19, XV-11 and CSM write; a table that
        says what its columns are (`read_csv`), or a folder of numbered ones with a scan each; NPZ
        with `ranges` and `angles`. A list holds the files of one log, as `together` finds them.
    on_error : "raise" or "skip"
        What a damaged line means: the end of reading, or one line less; `log.skipped` then tells
        how many lines were left out and why the first.
    progress
        Is called with the share of the file that is read and words, and may raise to stop.

    Returns
    -------
    Log
        With odometry and, where the file has them, corrected poses as `truth`: both `(k, 3)`, of
        the robot.

    Raises
    ------
    LogError
        A damaged line, or a file that cannot be read, is of no known format or holds no scan. With
        "skip" too where no scan remains, for a line of more than a megabyte, and a packed
        file of more than 1 MB and 50 times its size: these bounds keep time and memory in
        proportion to the file.

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
    paths: Sequence[Any] = path if isinstance(path, list | tuple) else [path]
    with ExitStack() as stack:
        places = [stack.enter_context(log_file(each, folders=True)) for each in paths]
        if len(places) != 1:
            for form, parts in in_parts() if places else ():
                if form.claims(places[0]):
                    return parts.read(places, on_error=on_error)
            groups = one_scan_each(places)
            if len(groups) != 1:
                raise ValueError(f"path must be the parts of one log, got {brief(path)}")
            return read_in_order(groups[0], places[0].parent.resolve().name, on_error)
        (place,) = places
        name = place.resolve().name if place.is_dir() else stem(place)
        if layout := layout_in_toml(Path(paths[0])):
            return read_declared_rows(place, name, on_error, layout)
        return recognise(place).read(place, name, on_error)


def together(files: Sequence[str]) -> list[list[str]]:
    """Files in their order, those together that are one log: parts of a bag, scans of a table.

    Examples
    --------
    >>> together(["room.log", "other.log"])
    [['room.log'], ['other.log']]
    """
    if not isinstance(files, list | tuple):
        raise ValueError(f"files must be a list of paths, got {brief(files)}")
    named = [str(arrays.file(file, "files")) for file in files]
    groups = [[name] for name in named]
    for _, parts in in_parts():
        groups = parts.together(named)
    alone = one_scan_each([group[0] for group in groups if len(group) == 1])
    groups = [*(group for group in groups if len(group) > 1), *alone]
    return sorted(groups, key=lambda group: named.index(group[0]))


def format_of(path: str | Path) -> str:
    """The format of a log, told by its first lines; a folder's, by the files in it.

    The rest may be damaged all the same. What is no log of any format is an `UnknownFormat`.

    Examples
    --------
    >>> from segmap.readers import data_file
    >>> format_of(data_file("malaga/malaga.log.gz"))
    'CARMEN'
    """
    with log_file(path, folders=True) as place:
        return "table" if layout_in_toml(Path(path)) else recognise(place).name


def load(name: str) -> Log:
    """Read one of the logs that come with segmap.

    They are "malaga", a real one, and simulated ones: the names of the folders under `data`.

    Examples
    --------
    >>> load("malaga")
    Log('malaga', 225 scans, odometry, truth for 99)
    """
    with open_bundled(name) as path:
        return read(path)
