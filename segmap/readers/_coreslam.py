"""CoreSLAM logs (Mines ParisTech): a Hokuyo URG-04LX on a robot with two wheels.

A line is a scan: 24 fields of header, then 683 ranges in millimetres, below 20 error codes, see
`segmap.error_codes`. Of the header, field 0 is the time in microseconds and fields 2 and 3 are the
ticks of the left and right wheel since the start. A wheel of 77 mm radius makes 2000 ticks a turn,
the wheels are 330 mm apart, the laser sits 145 mm ahead of their axle.

The beams are the sensor's steps of 360/1024 degree, the middle one straight ahead: 239.8 degrees
in all. Between two lines the robot is taken to drive an exact arc; the odometry starts at 0, 0, 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..error_codes import as_ranges
from ..poses import compose
from ..scans import LaserScan, Log
from ._lines import Lines, is_number, numbers, time
from ._raw_scans import URG_REACH, URG_STEP, centred

HEADER, BEAMS = 24, 683
METRES_PER_TICK = 2 * np.pi * 0.077 / 2000
WHEEL_SEPARATION = 0.330
SENSOR_POSE = (0.145, 0.0, 0.0)
#: More ticks than this no wheel turns.
MOST_TICKS = 1e12


def claims(fields: Sequence[str]) -> bool:
    """Whether a line is one of this format."""
    return len(fields) > HEADER and fields[0].isdecimal() and is_number(fields[-1])


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a CoreSLAM log; `odometry` `(k, 3)`, metres and radians, is that of the wheels."""
    lines = Lines(path, on_error)
    rows = list(lines.each(_parse))
    if not rows:
        raise lines.no_scan(f"lines of {HEADER + BEAMS} numbers")
    table = np.array(rows)
    poses = integrate(METRES_PER_TICK * np.diff(table[:, 1:3], axis=0))
    scans = [_scan(row, pose) for row, pose in zip(table, poses, strict=True)]
    return Log(name, scans, None, lines.skipped)


def integrate(driven: Array) -> Array:
    """Poses of the robot, `(k + 1, 3)`, from what its left and right wheel drove, `(k, 2)`, metres.

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


def _parse(fields: list[str]) -> Array:
    """Time in seconds, ticks of both wheels and the ranges in millimetres."""
    if len(fields) != HEADER + BEAMS:
        raise ValueError(f"expected {HEADER} fields and {BEAMS} ranges, got {len(fields)} in all")
    ticks = numbers(fields[2:4], "the ticks of the wheels")
    if not (np.abs(ticks) <= MOST_TICKS).all():
        raise ValueError(f"expected the ticks of the wheels, got {' '.join(fields[2:4])[:40]}")
    return np.concatenate([[time(fields[0], unit=1e-6)], ticks, numbers(fields[HEADER:], "ranges")])


def _scan(row: Array, pose: Array) -> LaserScan:
    ranges, codes = as_ranges(row[3:])
    angles = centred(BEAMS, URG_STEP)
    return LaserScan(ranges, angles, row[0], pose, URG_REACH, SENSOR_POSE, codes)
