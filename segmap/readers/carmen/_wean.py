"""Logs of Wean Hall (Carnegie Mellon University): a SICK among lines of odometry.

    L x y theta laser_x laser_y laser_theta r1 ... r180 t
    O x y theta t

Lengths are centimetres here, and metres in the log; angles radians, times seconds. x y theta is the
robot by its wheels. The laser's pose lies 25 cm ahead in all logs that we know: what lies between
the two poses of all lines decides, see `extrinsic_by_poses`; where it varies, the laser's poses are
truth. O lines are left out, since every L line has its own odometry.

Assumed: the beams follow the rule of `half_turn`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .._lines import float_fields, is_number, pose_fields, time
from .._raw_scans import Extrinsic, RawScan, extrinsic_by_poses, half_turn, view_of
from .._text import TextFormat

#: First word of a line with a scan.
WEAN_SCAN = "L"
#: First word of a line with a pose.
WEAN_POSE = "O"
#: Fields before the ranges.
FIELDS_BEFORE_RANGES = 7
#: Ranges of a line.
WEAN_RANGES = 180
#: Fields after them.
FIELDS_AFTER_RANGES = 1
CENTIMETRES = np.array([0.01, 0.01, 1.0])
#: How far ahead of the robot's centre the laser sits where the poses do not tell, metres.
OFFSET = np.array([0.25, 0.0, 0.0])


class WeanHall(TextFormat):
    """A log of Wean Hall."""

    name, expected = "Wean Hall", f"an {WEAN_SCAN} line with {WEAN_RANGES} ranges"

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        wanted = {
            WEAN_SCAN: FIELDS_BEFORE_RANGES + WEAN_RANGES + FIELDS_AFTER_RANGES,
            WEAN_POSE: 5,
        }.get(fields[0])
        return len(fields) == wanted and is_number(fields[1])

    def _take(self, fields: list[str]) -> None:
        if fields[0] not in (WEAN_SCAN, WEAN_POSE):
            raise ValueError(f"expected an {WEAN_SCAN} or {WEAN_POSE} line, got {fields[0][:40]!r}")
        if fields[0] == WEAN_SCAN:
            self.scans.append(_parse(fields))

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        return extrinsic_by_poses(scans, OFFSET)


def _parse(fields: list[str]) -> RawScan:
    if len(fields) != FIELDS_BEFORE_RANGES + WEAN_RANGES + FIELDS_AFTER_RANGES:
        raise ValueError(
            f"expected {FIELDS_BEFORE_RANGES - 1} fields, {WEAN_RANGES} ranges "
            f"and a time, got {len(fields)}"
        )
    ranges = float_fields(fields[FIELDS_BEFORE_RANGES:-FIELDS_AFTER_RANGES], "ranges") / 100
    robot = pose_fields(fields[1:4], "the robot") * CENTIMETRES
    laser = pose_fields(fields[4:7], "the laser") * CENTIMETRES
    angles = half_turn(WEAN_RANGES)
    when, view = time(fields[-1]), (view_of(angles),)
    return RawScan(WEAN_SCAN, ranges, angles, when, robot, laser, assumed=view)
