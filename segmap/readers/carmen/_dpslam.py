"""DP-SLAM logs (A. Eliazar, R. Parr): a line of odometry before each scan.

    Odometry x y theta
    Laser n r1 ... rn

Metres and radians. The odometry of a scan is the last line before it that no scan has used: a line
used twice would put two scans into one place. There are no times and no truth.

Assumed: the beams follow the rule of `half_turn`, and the laser sits at the robot's centre.
"""

from __future__ import annotations

from .._lines import Lines, counted_fields, float_fields, pose_fields
from .._raw_scans import NOWHERE, RawScan, half_turn, view_of
from .._text import TextFormat

#: First word of a line with a pose.
DPSLAM_POSE = "Odometry"
#: First word of a line with a scan.
DPSLAM_SCAN = "Laser"


class DpSlam(TextFormat):
    """A log of DP-SLAM."""

    name, keywords, expected = "DP-SLAM", (DPSLAM_POSE, DPSLAM_SCAN), f"a {DPSLAM_SCAN} line"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.odometry = NOWHERE

    def _take(self, fields: list[str]) -> None:
        odometry, self.odometry = self.odometry, NOWHERE  # a damaged line leaves none
        if fields[0] == DPSLAM_POSE:
            self.odometry = pose_fields(fields[1:], "the odometry")
        elif fields[0] == DPSLAM_SCAN:
            ranges, rest = counted_fields(fields[1:], "ranges")
            if rest:
                count = len(ranges)
                raise ValueError(f"announces {count} ranges, but {count + len(rest)} follow")
            found, angles = float_fields(ranges, "ranges"), half_turn(len(ranges))
            view = (view_of(angles),)
            self.scans.append(RawScan(DPSLAM_SCAN, found, angles, odometry=odometry, assumed=view))
        else:
            self.odometry = odometry
            raise ValueError(
                f"expected an {DPSLAM_POSE} or {DPSLAM_SCAN} line, got {fields[0][:40]!r}"
            )
