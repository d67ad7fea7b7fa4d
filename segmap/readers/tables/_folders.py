"""Folders that are one log: a recording of Rawseeds, and numbered files with a Hokuyo scan in each.

    SICK_FRONT.csv, SICK_REAR.csv, HOKUYO_FRONT.csv, HOKUYO_REAR.csv     scans, see `_fixed`
    ODOMETRY_XYT.csv, GROUNDTRUTH.csv                                    see `_trajectories`

A name may have more before it (`bicocca-2009-02-25b-SICK_FRONT.csv`), and `.gz` after it. One laser
is read: the first that the folder has of the order above. Odometry and truth are interpolated at
the time of each scan; outside of what they cover, and for the truth in gaps longer than a second, a
scan has none.

Of numbered files `scan2.txt` comes before `scan10.txt`.

Assumed: the scans of numbered files are in the order of their numbers.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np

from ...poses import interpolate
from ...scans import LaserScan, Log
from .._lines import Lines, LogError, Reading, merged_skipped
from .._raw_scans import known_truth
from ._fixed import HokuyoText, Rawseeds
from ._trajectories import track_in

RAWSEEDS_LASERS = ("SICK_FRONT", "HOKUYO_FRONT", "SICK_REAR", "HOKUYO_REAR")
PATTERN = re.compile(
    rf"({'|'.join((*RAWSEEDS_LASERS, 'ODOMETRY_XYT', 'GROUNDTRUTH'))})\.csv(\.gz)?$", re.IGNORECASE
)
#: Ground truth is not interpolated over more seconds than this: it exists only in some places.
TRUTH_GAP = 1.0
#: So many files of a kind, and lines of a file, are looked at.
FEW = 20
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
            track, reading = track_in(files[sensor], on_error)
            found.unknown = merged_skipped(found.unknown, reading.skipped)
            if sensor == "GROUNDTRUTH":
                times = np.array([scan.time for scan in found.scans])
                truth = known_truth(interpolate(*track.ordered(), times, max_gap=TRUTH_GAP))
            else:
                found.track = track
    return replace(found._log(name), truth=truth)


def numbered(folder: Path) -> list[Path]:
    """The scans of a folder: files with a number in their name, in the order of the last one.

    Of those with the same suffix the first few must look like scans, or all are of another kind.
    """
    found = []
    for path in folder.iterdir():
        words = path.name.removesuffix(".gz").split(".")
        numerals = re.findall(r"[0-9]{1,18}", words[0])
        if path.is_file() and words[0] and numerals:
            found.append((int(numerals[-1]), path))
    found.sort()
    kinds: dict[str, list[Path]] = {}
    for _, path in found:
        kinds.setdefault(_suffix(path), []).append(path)
    kept = {kind for kind, files in kinds.items() if any(map(_is_scan, files[:FEW]))}
    return [path for _, path in found if _suffix(path) in kept]


def _suffix(path: Path) -> str:
    return Path(path.name.removesuffix(".gz")).suffix.lower()


def read_numbered(folder: Path, name: str, on_error: str = "raise") -> Log:
    """Read a scan a file; "skip" leaves out, and counts, files without."""
    scans, assumed = list[LaserScan](), tuple[str, ...]()
    reading = Reading(folder, on_error)
    for path in numbered(folder):
        try:
            found = HokuyoText.read(path, name, on_error)
        except LogError as fault:
            reading.damaged(fault)
        else:
            scans, assumed = [*scans, *found], found.assumed
            reading.skipped = merged_skipped(reading.skipped, found.skipped)
    if not scans:
        raise LogError(folder, f"holds no scan; {reading.skipped.reason}")
    return Log(name, scans, None, reading.skipped, assumed=(*assumed, IN_ORDER))


def _is_scan(path: Path) -> bool:
    """Whether most of the first lines are beams."""
    try:
        lines = list(islice(Lines(path, "skip"), FEW))
    except LogError:
        return False
    beams = [" ".join(line) for line in lines if HokuyoText.claims(line)]
    return 2 * len(beams) > len(lines) and HokuyoText.fits(beams)
