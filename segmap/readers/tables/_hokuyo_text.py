"""Readings of a Hokuyo as text: a scan a file, a beam a line.

    range_mm angle_rad

A folder of numbered files is a log, in the order of the numbers: `scan2.txt` before `scan10.txt`.
Values below 20 mm are error codes, see `error_codes`. The files have no times; the sensor
turns in 100 ms, so scan k is given 0.1 k seconds. There is no odometry and no truth.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from ...arrays import Array
from ...scans import NOTHING_SKIPPED, LaserScan, Log, Skipped
from ...scans.error_codes import as_ranges
from .._lines import Lines, LogError, is_number, merged, numbers
from .._raw_scans import URG_REACH

SECONDS_PER_TURN = 0.1
#: A beam points nowhere beyond two turns, radians.
MOST_TURN = 4 * np.pi
MOST_BEAMS = 100_000
#: So many files of a kind, and lines of a file, are looked at.
FEW = 20


def claims(fields: Sequence[str]) -> bool:
    """Whether a line is one of this format."""
    return len(fields) == 2 and all(is_number(field) for field in fields)


def numbered(folder: Path) -> list[Path]:
    """The scans of a folder: files with a number in their name, in the order of the last one.

    Of those with the same suffix the first few must look like scans, or all are of another kind.
    """
    kinds: dict[str, list[Path]] = {}
    for path in _numbered(folder):
        kinds.setdefault(_suffix(path), []).append(path)
    kept = {kind for kind, files in kinds.items() if any(map(_is_scan, files[:FEW]))}
    return [path for path in _numbered(folder) if _suffix(path) in kept]


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read one scan: its `(n,)` ranges become metres."""
    scan, skipped = _read_scan(path, 0.0, on_error)
    return Log(name, [scan], None, skipped)


def read_folder(files: Sequence[Path], name: str, on_error: str = "raise") -> Log:
    """Read a scan a file, 0.1 seconds apart; "skip" leaves out, and counts, files without."""
    scans, skipped = [], NOTHING_SKIPPED
    for k, path in enumerate(files):
        try:
            scan, more = _read_scan(path, k * SECONDS_PER_TURN, on_error)
        except LogError as fault:
            if on_error == "raise":
                raise
            more = Skipped(1, str(fault))
        else:
            scans.append(scan)
        skipped = merged(skipped, more)
    if not scans:
        raise LogError(files[0].parent, f"holds no scan; {skipped.reason}")
    return Log(name, scans, None, skipped)


def _numbered(folder: Path) -> list[Path]:
    files = (path for path in folder.iterdir() if path.is_file() and not path.name.startswith("."))
    found = [(int(numerals[-1]), path) for path in files if (numerals := _numerals(path))]
    return [path for _, path in sorted(found)]


def _suffix(path: Path) -> str:
    return Path(path.name.removesuffix(".gz")).suffix.lower()


def _is_scan(path: Path) -> bool:
    """Whether most of the first lines are beams."""
    try:
        lines = list(islice(Lines(path, "skip"), FEW))
    except LogError:
        return False
    return 2 * sum(map(claims, lines)) > len(lines)


def _numerals(path: Path) -> list[str]:
    return re.findall(r"[0-9]{1,18}", path.name.removesuffix(".gz").split(".")[0])


def _read_scan(path: Path, time: float, on_error: str) -> tuple[LaserScan, Skipped]:
    lines = Lines(path, on_error)
    beams = np.array(list(islice(lines.each(_parse), MOST_BEAMS + 1))).reshape(-1, 2)
    if len(beams) > MOST_BEAMS:
        raise lines.error(f"expected one scan, but there are more than {MOST_BEAMS} beams")
    if not len(beams):
        raise lines.no_scan("lines of range in millimetres and angle in radians")
    ranges, codes = as_ranges(beams[:, 0])
    return LaserScan(ranges, beams[:, 1], time, None, URG_REACH, codes=codes), lines.skipped


def _parse(fields: list[str]) -> Array:
    beam = numbers(fields, "range and angle")
    if len(beam) != 2 or not abs(beam[1]) <= MOST_TURN:
        raise ValueError(
            f"expected a range in millimetres and an angle in radians, got {' '.join(fields)[:80]}"
        )
    return beam
