"""DP-SLAM logs (A. Eliazar, R. Parr): a line of odometry before each scan.

    Odometry x y theta
    Laser n r1 ... rn

Metres and radians. The odometry of a scan is the last line before it that no scan has used: a line
used twice would put two scans into one place. There are no times and no truth.

Assumed: the beams follow the rule of `half_turn`, and the laser sits at the robot's centre.
"""

from __future__ import annotations

from .._lines import Lines, counted, numbers, pose
from .._raw_scans import NOWHERE, RawScan, half_turn, view_of
from .._text import TextFormat

POSE, SCAN = "Odometry", "Laser"


class DpSlam(TextFormat):
    """A log of DP-SLAM."""

    name, keywords, expected = "DP-SLAM", (POSE, SCAN), f"a {SCAN} line"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.odometry = NOWHERE

    def _take(self, fields: list[str]) -> None:
        odometry, self.odometry = self.odometry, NOWHERE  # a damaged line leaves none
        if fields[0] == POSE:
            self.odometry = pose(fields[1:], "the odometry")
        elif fields[0] == SCAN:
            ranges, rest = counted(fields[1:], "ranges")
            if rest:
                count = len(ranges)
                raise ValueError(f"announces {count} ranges, but {count + len(rest)} follow")
            found, angles = numbers(ranges, "ranges"), half_turn(len(ranges))
            view = (view_of(angles),)
            self.scans.append(RawScan(SCAN, found, angles, odometry=odometry, assumed=view))
        else:
            self.odometry = odometry
            raise ValueError(f"expected an {POSE} or {SCAN} line, got {fields[0][:40]!r}")
