"""Folders that are one log: a recording of Rawseeds, and numbered files with a scan in each.

    SICK_FRONT.csv, SICK_REAR.csv, HOKUYO_FRONT.csv, HOKUYO_REAR.csv     scans, see `_fixed`
    ODOMETRY_XYT.csv, GROUNDTRUTH.csv                                    see `_trajectories`

A name may have more before it (`bicocca-2009-02-25b-SICK_FRONT.csv`), and `.gz` after it. One laser
is read: the first that the folder has of the order above. Odometry and truth are interpolated at
the time of each scan; outside of what they cover, and for the truth in gaps longer than a second, a
scan has none.

Of numbered files, tables or arrays, `scan2.txt` comes before `scan10.txt`.

Assumed: the scans of numbered files are in the order of their numbers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ...poses import interpolate
from ...scans import LaserScan, Log
from ..lines import Lines, LogError, Reading, merged_skipped
from ..raw_scans import known_truth
from ._fixed import Rawseeds
from ._layout import layout_in_toml, layout_of
from ._npz import ARRAYS, claims
from ._table import read_declared_rows
from ._trajectories import pose_layout_of, track_in

RAWSEEDS_LASERS = ("SICK_FRONT", "HOKUYO_FRONT", "SICK_REAR", "HOKUYO_REAR")
PATTERN = re.compile(
    rf"({'|'.join((*RAWSEEDS_LASERS, 'ODOMETRY_XYT', 'GROUNDTRUTH'))})\.csv(\.gz)?$", re.IGNORECASE
)
#: Ground truth is not interpolated over more seconds than this: it exists only in some places.
TRUTH_GAP = 1.0
#: A number in the name of a file.
NAME_NUMBER = re.compile("[0-9]{1,18}")
#: Numbered tables with a scan each; with this many they are one log.
LEAST_FILES = 3
#: Files of a kind that are looked at.
FEW = 20
#: The largest file that may be one scan, in bytes.
MOST_ONE_SCAN_BYTES = 1 << 20
P = TypeVar("P", str, Path)
ReadFile = Callable[[Path, str, str], Log]
IN_ORDER = "scans in the order of the numbers in the files' names"


def files_of(folder: Path) -> dict[str, Path]:
    """The files of a recording in a folder, by sensor."""
    files = (path for path in sorted(folder.iterdir()) if path.is_file())
    matches = ((PATTERN.search(path.name), path) for path in files)
    return {match[1].upper(): path for match, path in matches if match}


def read_folder(folder: Path, name: str, on_error: str = "raise") -> Log:
    """Read a recording: of its first laser, with odometry and truth at the times of the scans."""
    files = files_of(folder)
    lasers = [laser for laser in RAWSEEDS_LASERS if laser in files]
    if not lasers:
        wanted = " or ".join(f"{laser}.csv" for laser in RAWSEEDS_LASERS[:2])
        raise LogError(folder, f"holds no scans, expected {wanted}")
    recording = Rawseeds(Lines(files[lasers[0]], on_error, ",")).walk()
    truth = None
    for sensor in ("ODOMETRY_XYT", "GROUNDTRUTH"):
        if sensor in files:
            track, reading = track_in(files[sensor], on_error, pose_layout_of(files[sensor]))
            recording.unknown = merged_skipped(recording.unknown, reading.skipped)
            if sensor == "GROUNDTRUTH":
                times = np.array([scan.time for scan in recording.scans])
                truth = known_truth(interpolate(*track.in_order(), times, max_gap=TRUTH_GAP))
            else:
                recording.track = track
    return replace(recording._log(name), truth=truth)


def read_as_stated(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a file of arrays, or a table by what it says of its columns."""
    if claims(path):
        return ARRAYS.read(path, name, on_error)
    return read_declared_rows(path, name, on_error, layout_in_toml(path) or layout_of(path))


def one_scan_each(
    files: Iterable[P], read: ReadFile = read_as_stated, least: int = LEAST_FILES
) -> list[list[P]]:
    """Files in their order; those of one folder and one name but for its number together, by it.

    The first of them hold a scan each, as far as they can be read. `least` files are needed, since
    two may be two rooms; those of a Hokuyo hold a scan each.
    """
    alike: dict[Any, list[P]] = {}
    for file in files:
        name = NAME_NUMBER.sub("#", Path(file).name)
        alike.setdefault((Path(file).parent, name), []).append(file)
    groups = list[list[P]]()
    for parts in alike.values():
        together = len(parts) > 1 and _one_each(parts, read, least)
        groups += [sorted(parts, key=_numbers_in_name)] if together else [[file] for file in parts]
    return groups


def _numbers_in_name(file: str | Path) -> list[int]:
    return [*map(int, NAME_NUMBER.findall(Path(file).name))]


def _one_each(files: Sequence[str | Path], read: ReadFile, least: int) -> bool:
    """Whether the first of files hold a scan each: all that can be read."""
    counts, has_codes = set[int](), False
    for path in map(Path, files[:FEW]):
        with suppress(LogError, OSError):
            if path.is_file() and path.stat().st_size <= MOST_ONE_SCAN_BYTES:
                log = read(path, "", "skip")
                if log.skipped.lines < len(log[0]):
                    counts.add(len(log))
                    has_codes |= log[0].codes is not None
    return counts == {1} and (len(files) >= least or has_codes)


def numbered_files(
    folder: Path, read: ReadFile = read_as_stated, least: int = LEAST_FILES
) -> list[Path]:
    """The files of a folder that are a scan each, and have one name but for its numbers."""
    files = sorted(path for path in folder.iterdir() if path.is_file())
    return next((group for group in one_scan_each(files, read, least) if group[1:]), [])


def read_numbered(folder: Path, name: str, on_error: str = "raise") -> Log:
    """Read a folder with a scan a file; "skip" leaves out, and counts, files without."""
    return read_in_order(numbered_files(folder), name, on_error)


def read_in_order(
    files: Sequence[Path], name: str, on_error: str = "raise", read: ReadFile = read_as_stated
) -> Log:
    """Read a scan a file; times that do not go on are left out."""
    reading = Reading(files[0].parent, on_error)
    scans, assumed = list[LaserScan](), tuple[str, ...]()
    for path in files:
        try:
            log = read(path, name, on_error)
        except LogError as fault:
            reading.leave_out(fault)
        else:
            scans, assumed = [*scans, *log], log.assumed
            reading.skipped = merged_skipped(reading.skipped, log.skipped)
    if not scans:
        raise LogError(files[0].parent, f"holds no scan; {reading.skipped.reason}")
    times = np.array([scan.time for scan in scans])
    if np.isfinite(times).all() and (np.diff(times) <= 0).any():
        scans = [replace(scan, time=np.nan) for scan in scans]
        assumed = (*assumed, "times of the files do not go on: left out")
    return Log(name, scans, None, reading.skipped, assumed=(*assumed, IN_ORDER))
