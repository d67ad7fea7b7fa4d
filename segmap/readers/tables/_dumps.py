"""What programs of cheap sensors print: RPLidar's `ultra_simple`, `rplidar`, LD06, LD19's SDK.

    S  theta: 12.34 Dist: 01234.00 Q: 47
    stamp(ns):1234,angle:12.34,distance(mm):1234,intensity:200
    True    15    12.34    1234.0

Angles are degrees, and grow clockwise on both sensors: they are turned round, so that scans run
counter-clockwise. RPLidar's distances are millimetres; the SDK's lines say theirs. 0 is no
measurement. A scan ends where the angle wraps. Its time is that of its first beam where the stamp
says its unit, `stamp(ns)`; other stamps are left out, and scans are numbered. Quality and intensity
are left out, and so are other lines that the programs print, such as the health of the sensor.
There is no odometry and no truth.

Assumed: a scan ends where the angle wraps.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from .._lines import Lines, is_number, time
from .._turns import Beam, Beams, direction_field, distance

DEGREES = np.pi / 180
DUMP_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}


class _Dump(Beams):
    """What a beam looks like; in a line with one of the words nothing else may stand."""

    pattern: ClassVar[re.Pattern[str]]
    words: ClassVar[Sequence[str]]

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        return cls.pattern.fullmatch(" ".join(fields)) is not None

    def _take(self, fields: list[str]) -> None:
        line = " ".join(fields)
        if found := self.pattern.fullmatch(line):
            self.scans.append(self._beam(found))
        elif any(word in line for word in self.words):
            said = ", ".join(self.words)
            raise ValueError(f"expected a beam with {said}, got {line[:60]!r}")

    def _beam(self, found: re.Match[str]) -> Beam:
        raise NotImplementedError


class RpLidar(_Dump):
    """A dump of `ultra_simple`."""

    name, words = "RPLidar", ("theta:", "Dist:", "Q:")
    expected = "lines with theta:, Dist:, Q:"
    pattern = re.compile(r"(?:S\s+)?theta:\s*([0-9.]+)\s+Dist:\s*([0-9.]+)\s+Q:\s*[0-9]+\s*")

    def _beam(self, found: re.Match[str]) -> Beam:
        return direction_field(found[1], DEGREES), distance(found[2], 0.001), np.nan, np.nan


class Ld19(_Dump):
    """A dump of the SDK of LD06 and LD19."""

    name, words = "LD19", ("angle:", "distance(", "intensity:")
    expected = "lines with angle:, distance(, intensity:"
    pattern = re.compile(
        r"(?:.*\bstamp(\(ns\))?:([0-9]+),\s*|[^,]*\b)?"
        r"angle:([0-9.]+),\s*distance\((mm|cm|m)\):([0-9.]+),\s*intensity:[0-9]+[\s,]*"
    )

    def _beam(self, found: re.Match[str]) -> Beam:
        when = time(found[2], unit=1e-9) if found[1] else np.nan
        return (
            direction_field(found[3], DEGREES),
            distance(found[5], DUMP_UNITS[found[4]]),
            when,
            np.nan,
        )


class RpLidarRecord(Beams):
    """What the examples of the Python package `rplidar` write, a beam a line.

    Whether a new turn begins, quality, degrees and millimetres.
    """

    name, expected = "RPLidar record", "lines of True or False, quality, degrees, millimetres"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.turns = 0

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        return (
            len(fields) == 4 and fields[0] in ("True", "False") and all(map(is_number, fields[1:]))
        )

    def _take(self, fields: list[str]) -> None:
        if not self.claims(fields):
            raise ValueError(f"expected {self.expected}, got {' '.join(fields)[:60]!r}")
        self.turns += fields[0] == "True"
        where = direction_field(fields[2], DEGREES), distance(fields[3], 0.001)
        self.scans.append((*where, np.nan, float(self.turns)))
