"""What the programs beside cheap sensors print: RPLidar's `ultra_simple`, and LD06, LD19's SDK.

    S  theta: 12.34 Dist: 01234.00 Q: 47
    stamp(ns):1234,angle:12.34,distance(mm):1234,intensity:200

Angles are degrees, and grow clockwise on both sensors: they are turned round, so that scans run
counter-clockwise. RPLidar's distances are millimetres; the SDK's lines say theirs. 0 is no
measurement. A scan ends where the angle wraps. Its time is that of its first beam where the stamp
says its unit, `stamp(ns)`; other stamps are left out, and scans are numbered. Quality and intensity
are left out, and so are other lines that the programs print, such as the health of the sensor.
There is no odometry and no truth.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from ...scans import Log
from .._lines import Lines, time
from .._turns import Beam, angle, distance, to_scans

DEGREES = np.pi / 180
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
#: What a beam looks like; in a line with one of the words behind it nothing else may stand.
RPLIDAR = re.compile(r"(?:S\s+)?theta:\s*([0-9.]+)\s+Dist:\s*([0-9.]+)\s+Q:\s*[0-9]+\s*")
RPLIDAR_WORDS = ("theta:", "Dist:", "Q:")
LD19 = re.compile(
    r"(?:.*\bstamp(\(ns\))?:([0-9]+),\s*|[^,]*\b)?"
    r"angle:([0-9.]+),\s*distance\((mm|cm|m)\):([0-9.]+),\s*intensity:[0-9]+[\s,]*"
)
LD19_WORDS = ("angle:", "distance(", "intensity:")


def claims_rplidar(fields: Sequence[str]) -> bool:
    """Whether a line is one of `ultra_simple`."""
    return RPLIDAR.fullmatch(" ".join(fields[:9])) is not None


def claims_ld19(fields: Sequence[str]) -> bool:
    """Whether a line is one of the SDK of LD06 and LD19."""
    return LD19.fullmatch(" ".join(fields[:20])[:400]) is not None


def read_rplidar(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a dump of `ultra_simple`: no odometry, no truth."""
    return _read(path, name, on_error, RPLIDAR, RPLIDAR_WORDS)


def read_ld19(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a dump of the SDK of LD06 and LD19: no odometry, no truth."""
    return _read(path, name, on_error, LD19, LD19_WORDS)


def _read(
    path: Path, name: str, on_error: str, pattern: re.Pattern[str], words: Sequence[str]
) -> Log:
    lines = Lines(path, on_error)
    parse = partial(_parse, pattern=pattern, words=words)
    beams = [beam for beam in lines.each(parse) if beam is not None]
    if not beams:
        raise lines.no_scan(f"lines with {', '.join(words)}")
    return Log(name, to_scans(beams, lines, clockwise=True), None, lines.skipped)


def _parse(fields: list[str], pattern: re.Pattern[str], words: Sequence[str]) -> Beam | None:
    line = " ".join(fields)[:400]
    if found := pattern.fullmatch(line):
        return _rplidar_beam(found) if pattern is RPLIDAR else _ld19_beam(found)
    if any(word in line for word in words):
        raise ValueError(f"expected a beam with {', '.join(words)}, got {line[:60]!r}")
    return None


def _rplidar_beam(found: re.Match[str]) -> Beam:
    return angle(found[1], DEGREES), distance(found[2], 0.001), np.nan, np.nan


def _ld19_beam(found: re.Match[str]) -> Beam:
    when = time(found[2], unit=1e-9) if found[1] else np.nan
    return angle(found[3], DEGREES), distance(found[5], UNITS[found[4]]), when, np.nan
