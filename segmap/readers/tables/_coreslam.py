"""CoreSLAM logs (Mines ParisTech): a Hokuyo URG-04LX on a robot with two wheels.

A line is a scan: a header, then ranges in millimetres, below 20 error codes, see
`error_codes`. Files differ, and what most lines of a file have decides: 24 fields and 683
ranges (`test_lab2`, `exp1`), or 13 and 682 (`test_lab`); a line of another length is damaged. Field
0 is the time in microseconds. The ticks of the left and right wheel since the start are fields 2
and 3; with 13 fields they are fields 1 and 2, and the right wheel counts backwards, as CoreSLAM's
own programs take them. Wheels that stand at zero in the whole file mean that there is no odometry.
Between two lines the robot is taken to drive an exact arc; the odometry starts at 0, 0, 0.

Assumed, since CoreSLAM's programs have it so: a wheel of 77 mm radius makes 2000 ticks a turn, the
wheels are 330 mm apart, the laser sits 145 mm ahead of their axle. Its beams are the sensor's steps
of 360/1024 degree, the middle one straight ahead, 239.8 degrees in all; it turns in 0.1 s, which
gives each beam its time.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...poses import compose
from ...scans import LaserScan, Log
from ...scans.error_codes import as_ranges
from .._lines import Lines, float_fields, is_number, time
from .._raw_scans import URG_ASSUMED, URG_REACH, URG_STEP, centred, known, urg_delays
from .._text import TextFormat


class Layout(NamedTuple):
    """Fields of the header, ranges, the field of the left wheel, and the sign of the right one."""

    header: int
    beams: int
    left: int
    right: int


#: By the number of fields in a line.
LAYOUTS = {sum(layout[:2]): layout for layout in (Layout(24, 683, 2, 1), Layout(13, 682, 1, -1))}
METRES_PER_TICK = 2 * np.pi * 0.077 / 2000
WHEEL_SEPARATION = 0.330
SENSOR_POSE = (0.145, 0.0, 0.0)
#: What the files do not say of the robot.
CORESLAM_ASSUMED = (
    "wheels of 77 mm radius, 2000 ticks a turn, 330 mm apart",
    "the laser sits 0.145 m ahead of the robot's centre",
)
#: More ticks than this no wheel turns.
MOST_TICKS = 1e12


class CoreSlam(TextFormat):
    """A log of CoreSLAM: of the layout that most lines have, the first where none has any."""

    by_shape = True
    name, expected = "CoreSLAM", f"lines of {' or '.join(map(str, LAYOUTS))} numbers"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        counts = Counter(map(len, Lines(lines.path, "skip")))
        self.layout = LAYOUTS[max(LAYOUTS, key=lambda length: counts[length])]

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        return len(fields) in LAYOUTS and fields[0].isdecimal() and is_number(fields[-1])

    def _take(self, fields: list[str]) -> None:
        """Time, ticks of both wheels and the ranges in millimetres."""
        header, beams, left, sign = self.layout
        if len(fields) != header + beams:
            raise ValueError(
                f"expected {header} fields and {beams} ranges, got {len(fields)} in all"
            )
        ticks = float_fields(fields[left : left + 2], "the ticks of the wheels") * (1, sign)
        if not (np.abs(ticks) <= MOST_TICKS).all():
            raise ValueError(f"expected the ticks of the wheels, got {ticks.tolist()}")
        when, ranges = time(fields[0], unit=1e-6), float_fields(fields[header:], "ranges")
        self.scans.append((when, ticks, ranges))

    def _log(self, name: str) -> Log:
        ticks = np.array([ticks for _, ticks, _ in self.scans])
        poses, scans = integrate(METRES_PER_TICK * np.diff(ticks, axis=0)), []
        stands = not np.ptp(ticks, axis=0).any() and not ticks.all()
        if stands:
            poses = np.full_like(poses, np.nan)
        for (when, _, found), pose in zip(self.scans, poses, strict=True):
            ranges, codes = as_ranges(found)
            angles = centred(len(ranges), URG_STEP)
            sensor = URG_REACH, SENSOR_POSE, codes, urg_delays(angles)
            scans.append(LaserScan(ranges, angles, when, known(pose), *sensor))
        return Log(
            name,
            scans,
            None,
            self.lines.skipped,
            assumed=(URG_ASSUMED, *(() if stands else CORESLAM_ASSUMED)),
        )


def integrate(driven: Array) -> Array:
    """Poses of the robot, `(k + 1, 3)`, from what its left and right wheel drove, `(k, 2)`.

    Examples
    --------
    >>> integrate(np.array([[0.0, np.pi * 0.330 / 2]])).round(4)  # a quarter turn round the left
    array([[0.    , 0.    , 0.    ],
           [0.165 , 0.165 , 1.5708]])
    """
    left, right = driven.T
    turn = (right - left) / WHEEL_SEPARATION
    chord = (left + right) / 2 * np.sinc(turn / (2 * np.pi))
    steps = np.stack([chord * np.cos(turn / 2), chord * np.sin(turn / 2), turn], -1)
    poses = [np.zeros(3)]
    for step in steps:
        poses.append(compose(poses[-1], step))
    return np.array(poses)
