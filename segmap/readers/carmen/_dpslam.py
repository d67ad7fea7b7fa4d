"""DP-SLAM logs (A. Eliazar, R. Parr): a line of odometry before each scan.

    Odometry x y theta
    Laser n r1 ... rn

Metres and radians. The odometry of a scan is the last line before it that no scan has used: a line
used twice would put two scans into one place. There are no times, so scans are numbered, and no
truth. The beams follow the rule of `half_turn`; the laser is taken to be at the robot's centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...scans import Log
from .._lines import Lines, counted, numbers, pose
from .._raw_scans import NOWHERE, RawScan, assemble, half_turn, uncorrected

POSE, SCAN = "Odometry", "Laser"


def claims(fields: Sequence[str]) -> bool:
    """Whether a line is one of this format."""
    return fields[0] in (POSE, SCAN)


class _Recording:
    """What the lines of one log said so far."""

    def __init__(self) -> None:
        self.scans: list[RawScan] = []
        self.odometry = NOWHERE

    def take(self, fields: list[str]) -> None:
        """Take in one line."""
        if fields[0] == POSE:
            self.odometry = NOWHERE  # a damaged line leaves none
            self.odometry = pose(fields[1:], "the odometry")
        elif fields[0] == SCAN:
            odometry, self.odometry = self.odometry, NOWHERE
            self.scans.append(_parse_scan(fields)._replace(odometry=odometry))
        else:
            raise ValueError(f"expected an {POSE} or {SCAN} line, got {fields[0][:40]!r}")


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a DP-SLAM log: odometry `(k, 3)`, metres and radians, no truth."""
    lines, recording = Lines(path, on_error), _Recording()
    for _ in lines.each(recording.take):
        pass
    if not recording.scans:
        raise lines.no_scan(f"a {SCAN} line")
    log = assemble(recording.scans, lambda laser, mine: uncorrected(mine, np.zeros(3)))
    return Log(name, *log, lines.skipped)


def _parse_scan(fields: list[str]) -> RawScan:
    ranges, rest = counted(fields[1:], "ranges")
    if rest:
        raise ValueError(f"announces {len(ranges)} ranges, but {len(ranges) + len(rest)} follow")
    found = numbers(ranges, "ranges")
    return RawScan(SCAN, found, half_turn(len(found)))
