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

from ...scans import LaserScan, Log
from ...scans.error_codes import as_ranges
from .._lines import Lines, LogError, Reading, is_number, merged, numbers
from .._raw_scans import URG_REACH, URG_TURN, urg_delays
from .._text import TextFormat
from .._turns import MOST_BEAMS, MOST_TURN

#: So many files of a kind, and lines of a file, are looked at.
FEW = 20


class HokuyoText(TextFormat):
    """One scan."""

    name, expected = "Hokuyo text", "lines of range in millimetres and angle in radians"

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        return len(fields) == 2 and all(is_number(field) for field in fields)

    def _take(self, fields: list[str]) -> None:
        beam = numbers(fields, "range and angle")
        if len(beam) != 2 or not abs(beam[1]) <= MOST_TURN:
            raise ValueError(f"expected {self.expected}, got {' '.join(fields)[:80]}")
        if len(self.scans) == MOST_BEAMS:
            raise self.lines.error(f"expected one scan, but there are more than {MOST_BEAMS} beams")
        self.scans.append(beam)

    def _log(self, name: str) -> Log:
        return Log(name, [self.scan(0.0)], None, self.lines.skipped)

    def scan(self, time: float) -> LaserScan:
        """All beams, the first measured at a time."""
        millimetres, angles = np.array(self.scans).T
        ranges, codes = as_ranges(millimetres)
        delays = urg_delays(angles)
        return LaserScan(ranges, angles, time, None, URG_REACH, codes=codes, delays=delays)


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


def read_folder(folder: Path, name: str, on_error: str = "raise") -> Log:
    """Read a scan a file, 0.1 seconds apart; "skip" leaves out, and counts, files without."""
    scans, reading = [], Reading(folder, on_error)
    for k, path in enumerate(numbered(folder)):
        try:
            found = HokuyoText(Lines(path, on_error)).walked()
        except LogError as fault:
            reading.damaged(fault)
        else:
            scans.append(found.scan(k * URG_TURN))
            reading.skipped = merged(reading.skipped, found.lines.skipped)
    if not scans:
        raise LogError(folder, f"holds no scan; {reading.skipped.reason}")
    return Log(name, scans, None, reading.skipped)


def _is_scan(path: Path) -> bool:
    """Whether most of the first lines are beams."""
    try:
        lines = list(islice(Lines(path, "skip"), FEW))
    except LogError:
        return False
    return 2 * sum(map(HokuyoText.claims, lines)) > len(lines)
