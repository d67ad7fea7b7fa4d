"""Folders that are one log: a recording of Rawseeds, and numbered files with a scan in each.

    SICK_FRONT.csv, SICK_REAR.csv, HOKUYO_FRONT.csv, HOKUYO_REAR.csv     scans, see `_fixed`
    ODOMETRY_XYT.csv, GROUNDTRUTH.csv                                    see `_trajectories`

A name may have more before it (`bicocca-2009-02-25b-SICK_FRONT.csv`), and `.gz` after it. One laser
is read: the first that the folder has of the order above. Odometry and truth are interpolated at
the time of each scan; outside of what they cover, and for the truth in gaps longer than a second, a
scan has none.

Of numbered files, of a Hokuyo or tables, `scan2.txt` comes before `scan10.txt`.

Assumed: the scans of numbered files are in the order of their numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ...poses import interpolate
from ...scans import LaserScan, Log
from ..lines import Lines, LogError, Reading, merged_skipped
from ..raw_scans import known_truth
from ..text import Binary
from ._fixed import HokuyoText, Rawseeds
from ._layout import Layout, first_lines, layout_as_written, layout_of, said_beside
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
#: So many files of a kind are looked at.
FEW = 20
#: The largest file that may be one scan, in bytes.
MOST_ONE_SCAN_BYTES = 1 << 20
P = TypeVar("P", str, Path)
IN_ORDER = "scans in the order of the numbers in the files' names"


def files_of(folder: Path) -> dict[str, Path]:
    """The files of a recording in a folder, by sensor."""
    found = ((PATTERN.search(path.name), path) for path in sorted(folder.iterdir()))
    return {match[1].upper(): path for match, path in found if match}


def read_folder(folder: Path, name: str, on_error: str = "raise") -> Log:
    """Read a recording: of its first laser, with odometry and truth at the times of the scans."""
    files = files_of(folder)
    lasers = [laser for laser in RAWSEEDS_LASERS if laser in files]
    if not lasers:
        wanted = " or ".join(f"{laser}.csv" for laser in RAWSEEDS_LASERS[:2])
        raise LogError(folder, f"holds no scans, expected {wanted}")
    found = Rawseeds(Lines(files[lasers[0]], on_error, ",")).walked()
    truth = None
    for sensor in ("ODOMETRY_XYT", "GROUNDTRUTH"):
        if sensor in files:
            columns = layout_as_written(files[sensor])._replace(names=RAWSEEDS_POSES[sensor])
            track, reading = track_in(files[sensor], on_error, columns)
            found.unknown = merged_skipped(found.unknown, reading.skipped)
            if sensor == "GROUNDTRUTH":
                times = np.array([scan.time for scan in found.scans])
                truth = known_truth(interpolate(*track.ordered(), times, max_gap=TRUTH_GAP))
            else:
                found.track = track
    return replace(found._log(name), truth=truth)


def one_scan_each(files: Iterable[P]) -> list[list[P]]:
    """Files in their order, those that hold a scan each and are numbered together, by number.

    What the first of them hold decides: no more than one scan, in the same columns. A scan a file
    of a Hokuyo is such by its format; of other tables three are needed, two may be two rooms.
    """
    groups: dict[Any, list[P]] = {}
    for file in files:
        groups.setdefault((Path(file).parent, NAME_NUMBER.sub("#", Path(file).name)), []).append(
            file
        )
    found = list[list[P]]()
    for parts in groups.values():
        together = len(parts) > 1 and _one_each(parts)
        found += [sorted(parts, key=_numbers_in_name)] if together else [[file] for file in parts]
    return found


def _numbers_in_name(file: str | Path) -> list[int]:
    return [*map(int, NAME_NUMBER.findall(Path(file).name))]


def _one_each(files: Sequence[str | Path]) -> bool:
    """Whether the first of files hold a scan each: all that can be read, in the same columns."""
    kinds = [kind for file in files[:FEW] if (kind := _kind_of_one(Path(file))) is not None]
    names = {name for name, _ in kinds}
    return len({*kinds}) == 1 and ("Hokuyo text" in names or (len(files) > 2 and "" not in names))


def _form_of(path: Path) -> Binary | Layout | type[HokuyoText] | None:
    """How a file that may hold a scan is read; None of another."""
    if claims(path):
        return ARRAYS
    layout = said_beside(path) or layout_of(path)
    if layout.is_whole:
        return layout
    lines = [text for _, text in first_lines(path) if not text.startswith("#")]
    beams = sum(HokuyoText.claims(line.split()) for line in lines)
    return HokuyoText if 2 * beams >= len(lines) > 0 and HokuyoText.fits(lines) else None


def _read_by(form: Binary | Layout | type[HokuyoText], path: Path, name: str, on_error: str) -> Log:
    return (
        read_declared_rows(path, name, on_error, form)
        if isinstance(form, Layout)
        else form.read(path, name, on_error)
    )


def _kind_of_one(path: Path) -> tuple[str, object] | None:
    """Format and names of columns of a file with one scan; without a format where it holds more.

    None of a file that is damaged, or no table.
    """
    try:
        if not path.is_file() or path.stat().st_size > MOST_ONE_SCAN_BYTES:
            return None
        form = _form_of(path)
        if form is None:
            return None
        found = _read_by(form, path, "", "skip")
        if found.skipped.lines >= len(found[0]):
            return None
        kind = ("table", form.names) if isinstance(form, Layout) else (form.name, None)
        return kind if len(found) == 1 else ("", None)
    except (LogError, OSError):
        return None


def numbered(folder: Path) -> list[Path]:
    """The files of a folder that are a scan each, and have one name but for its numbers."""
    groups = one_scan_each(sorted(path for path in folder.iterdir() if path.is_file()))
    return next((g for g in groups if len(g) > 1 or _is_hokuyo(g[0])), [])


def _is_hokuyo(path: Path) -> bool:
    return bool(NAME_NUMBER.search(path.name)) and _one_each([path])


def read_numbered(folder: Path, name: str, on_error: str = "raise") -> Log:
    """Read a folder with a scan a file; "skip" leaves out, and counts, files without."""
    return read_in_order(numbered(folder), name, on_error)


def read_in_order(files: Sequence[Path], name: str, on_error: str = "raise") -> Log:
    """Read a scan a file, with the columns of the first; times that do not go on are left out."""
    reading, forms = Reading(files[0].parent, on_error), map(_form_of, files)
    form = next((form for form in forms if form is not None), HokuyoText)
    scans, assumed = list[LaserScan](), tuple[str, ...]()
    for path in files:
        try:
            found = _read_by(form, path, name, on_error)
        except LogError as fault:
            reading.damaged(fault)
        else:
            scans, assumed = [*scans, *found], found.assumed
            reading.skipped = merged_skipped(reading.skipped, found.skipped)
    if not scans:
        raise LogError(files[0].parent, f"holds no scan; {reading.skipped.reason}")
    times = np.array([scan.time for scan in scans])
    if np.isfinite(times).all() and (np.diff(times) <= 0).any():
        scans = [replace(scan, time=np.nan) for scan in scans]
        assumed = (*assumed, "times of the files do not go on: left out")
    return Log(name, scans, None, reading.skipped, assumed=(*assumed, IN_ORDER))
