"""Readings of a Hokuyo as text: a scan a file, a beam a line.

    range_mm angle_rad

A folder of numbered files is a log, in the order of the numbers: `scan2.txt` before `scan10.txt`.
Values below 20 are error codes, see `error_codes`. There are no times, no odometry and no truth,
and nothing says how far the sensor sees or how fast it turns.

Assumed: millimetres, radians counter-clockwise, the codes of a URG-04LX, and the order of files.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from ...arrays import LIMIT
from ...scans import LaserScan, Log
from ...scans.error_codes import as_ranges
from .._lines import (
    MOST_DIRECTION_RAD,
    Lines,
    LogError,
    Reading,
    float_fields,
    is_number,
    merged_skipped,
)
from .._raw_scans import COUNTERCLOCKWISE
from .._text import TextFormat
from ._table import MOST_BEAMS_READ

#: So many files of a kind, and lines of a file, are looked at.
FEW = 20
#: What two numbers a line do not say, and what their files do not.
HOKUYO_TEXT_ASSUMED = (
    "ranges in millimetres",
    "angles in radians",
    COUNTERCLOCKWISE,
    "values below 20 are error codes of a URG-04LX",
)
IN_ORDER = "scans in the order of the numbers in the files' names"


class HokuyoText(TextFormat):
    """One scan."""

    by_shape = True
    name, expected = "Hokuyo text", "lines of range in millimetres and angle in radians"

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        if len(fields) != 2 or not all(map(is_number, fields)):
            return False
        return float(fields[0]) % 1 == 0 and abs(float(fields[1])) <= MOST_DIRECTION_RAD

    def _take(self, fields: list[str]) -> None:
        beam = float_fields(fields, "range and angle")
        if len(beam) != 2 or abs(beam[0]) > LIMIT or not abs(beam[1]) <= MOST_DIRECTION_RAD:
            raise ValueError(f"expected {self.expected}, got {' '.join(fields)[:80]}")
        if len(self.scans) == MOST_BEAMS_READ:
            raise self.lines.error(
                f"expected one scan, but there are more than {MOST_BEAMS_READ} beams"
            )
        self.scans.append(beam)

    def _log(self, name: str) -> Log:
        return Log(name, [self.scan()], None, self.lines.skipped, assumed=HOKUYO_TEXT_ASSUMED)

    def scan(self) -> LaserScan:
        """All beams, at a time that nobody knows."""
        millimetres, angles = np.array(self.scans).T
        ranges, codes = as_ranges(millimetres)
        return LaserScan(ranges, angles, np.nan, codes=codes)


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


def read_hokuyo_folder(folder: Path, name: str, on_error: str = "raise") -> Log:
    """Read a scan a file; "skip" leaves out, and counts, files without."""
    scans, reading = [], Reading(folder, on_error)
    for path in numbered(folder):
        try:
            found = HokuyoText(Lines(path, on_error)).walked()
        except LogError as fault:
            reading.damaged(fault)
        else:
            scans.append(found.scan())
            reading.skipped = merged_skipped(reading.skipped, found.lines.skipped)
    if not scans:
        raise LogError(folder, f"holds no scan; {reading.skipped.reason}")
    return Log(name, scans, None, reading.skipped, assumed=(*HOKUYO_TEXT_ASSUMED, IN_ORDER))


def _is_scan(path: Path) -> bool:
    """Whether most of the first lines are beams."""
    try:
        lines = list(islice(Lines(path, "skip"), FEW))
    except LogError:
        return False
    return 2 * sum(map(HokuyoText.claims, lines)) > len(lines)
