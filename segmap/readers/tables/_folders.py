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
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ...poses import interpolate
from ...scans import LaserScan, Log
from ..lines import Lines, LogError, Reading, merged_skipped
from ..raw_scans import known_truth
from ..text import Binary
from ._fixed import Rawseeds
from ._layout import Layout, layout_as_written, layout_in_toml, layout_of
from ._npz import ARRAYS, claims
from ._table import read_declared_rows
from ._trajectories import RAWSEEDS_POSES, track_in

RAWSEEDS_LASERS = ("SICK_FRONT", "HOKUYO_FRONT", "SICK_REAR", "HOKUYO_REAR")
PATTERN = re.compile(
    rf"({'|'.join((*RAWSEEDS_LASERS, 'ODOMETRY_XYT', 'GROUNDTRUTH'))})\.csv(\.gz)?$", re.IGNORECASE
)
#: Ground truth is not interpolated over more seconds than this: it exists only in some places.
TRUTH_GAP = 1.0
#: A number in the name of a file.
NAME_NUMBER = re.compile("[0-9]{1,18}")
#: So many numbered tables with a scan each are one log.
LEAST_FILES = 3
#: So many files of a kind are looked at.
FEW = 20
#: The largest file that may be one scan, in bytes.
MOST_ONE_SCAN_BYTES = 1 << 20
P = TypeVar("P", str, Path)
Form = Binary | Layout
FormOf = Callable[[Path], Form | None]
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
            columns = layout_as_written(files[sensor])._replace(names=RAWSEEDS_POSES[sensor])
            track, reading = track_in(files[sensor], on_error, columns)
            recording.unknown = merged_skipped(recording.unknown, reading.skipped)
            if sensor == "GROUNDTRUTH":
                times = np.array([scan.time for scan in recording.scans])
                truth = known_truth(interpolate(*track.ordered(), times, max_gap=TRUTH_GAP))
            else:
                recording.track = track
    return replace(recording._log(name), truth=truth)


def one_scan_each(
    files: Iterable[P], form_of: FormOf | None = None, least: int = LEAST_FILES
) -> list[list[P]]:
    """Files in their order, those that hold a scan each and are numbered together, by number.

    What the first of them hold decides: no more than one scan, in the same columns. `least` files
    are needed, since two may be two rooms; those of a Hokuyo hold a scan each.
    """
    groups = list[list[P]]()
    for parts in _numbered_alike(files):
        together = len(parts) > 1 and _one_each(parts, form_of or form_as_stated, least)
        groups += [sorted(parts, key=_numbers_in_name)] if together else [[file] for file in parts]
    return groups


def _numbered_alike(files: Iterable[P]) -> Iterable[list[P]]:
    """Files of one folder that have one name but for its numbers."""
    groups: dict[Any, list[P]] = {}
    for file in files:
        name = NAME_NUMBER.sub("#", Path(file).name)
        groups.setdefault((Path(file).parent, name), []).append(file)
    return groups.values()


def _numbers_in_name(file: str | Path) -> list[int]:
    return [*map(int, NAME_NUMBER.findall(Path(file).name))]


def _one_each(files: Sequence[str | Path], form_of: FormOf, least: int) -> bool:
    """Whether the first of files hold a scan each: all that can be read, in the same columns."""
    kinds = {names for file in files[:FEW] if (names := _names_of_one(Path(file), form_of))}
    is_hokuyo = any("urg_mm" in names for names in kinds)
    return len(kinds) == 1 and (len(files) >= least or is_hokuyo)


def form_as_stated(path: Path) -> Form | None:
    """How a file that may hold a scan is read; None of another."""
    if claims(path):
        return ARRAYS
    layout = layout_in_toml(path) or layout_of(path)
    return layout if layout.is_whole else None


def _read_by(form: Form, path: Path, name: str, on_error: str) -> Log:
    return (
        read_declared_rows(path, name, on_error, form)
        if isinstance(form, Layout)
        else form.read(path, name, on_error)
    )


def _names_of_one(path: Path, form_of: FormOf) -> tuple[str, ...]:
    """Names of the columns of a file; empty of one that is damaged, or no table.

    One that holds more than one scan has its own path for a name.
    """
    try:
        if not path.is_file() or path.stat().st_size > MOST_ONE_SCAN_BYTES:
            return ()
        form = form_of(path)
        if form is None:
            return ()
        log = _read_by(form, path, "", "skip")
    except (LogError, OSError):
        return ()
    if log.skipped.lines >= len(log[0]):
        return ()
    names = form.names if isinstance(form, Layout) else (form.name,)
    return names if len(log) == 1 else (str(path), "")


def numbered_files(
    folder: Path, form_of: FormOf = form_as_stated, least: int = LEAST_FILES
) -> list[Path]:
    """The files of a folder that are a scan each, and have one name but for its numbers."""
    files = sorted(path for path in folder.iterdir() if path.is_file())
    for group in _numbered_alike(files):
        if NAME_NUMBER.search(group[0].name) and _one_each(group, form_of, least):
            return sorted(group, key=_numbers_in_name)
    return []


def read_numbered(folder: Path, name: str, on_error: str = "raise") -> Log:
    """Read a folder with a scan a file; "skip" leaves out, and counts, files without."""
    return read_in_order(numbered_files(folder), name, on_error)


def read_in_order(
    files: Sequence[Path], name: str, on_error: str = "raise", form_of: FormOf = form_as_stated
) -> Log:
    """Read a scan a file, with the columns of the first; times that do not go on are left out."""
    reading = Reading(files[0].parent, on_error)
    first = next(form for form in map(form_of, files) if form is not None)
    first = first._replace(line=0) if isinstance(first, Layout) else first
    scans, assumed = list[LaserScan](), tuple[str, ...]()
    for path in files:
        try:
            log = _read_by(form_of(path) or first, path, name, on_error)
        except LogError as fault:
            reading.damaged(fault)
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
