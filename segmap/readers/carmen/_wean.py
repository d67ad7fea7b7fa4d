"""Logs of Wean Hall (Carnegie Mellon University): a SICK among lines of odometry.

    L x y theta laser_x laser_y laser_theta r1 ... r180 t
    O x y theta t

Lengths are centimetres here, and metres in the log; angles radians, times seconds. x y theta is the
robot by its wheels. The laser's pose lies 25 cm ahead in all logs that we know: what lies between
the two poses of all lines decides, see `extrinsic_by_poses`; where it varies, the laser's poses are
truth. O lines are left out, since every L line has its own odometry. The beams follow the rule of
`half_turn`.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...arrays import Array
from ...scans import Log
from .._lines import Lines, is_number, numbers, pose, time
from .._raw_scans import RawScan, assemble, extrinsic_by_poses, half_turn

SCAN, POSE = "L", "O"
#: Fields before the ranges, ranges, and fields after them.
HEAD, BEAMS, TAIL = 7, 180, 1
CENTIMETRES = np.array([0.01, 0.01, 1.0])
#: How far ahead of the robot's centre the laser sits where the poses do not tell, metres.
OFFSET = np.array([0.25, 0.0, 0.0])


def claims(fields: Sequence[str]) -> bool:
    """Whether a line is one of this format."""
    wanted = {SCAN: HEAD + BEAMS + TAIL, POSE: 5}.get(fields[0])
    return len(fields) == wanted and is_number(fields[1])


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a log of Wean Hall: odometry `(k, 3)`, metres and radians."""
    lines = Lines(path, on_error)
    raw = [scan for scan in lines.each(_parse) if scan is not None]
    if not raw:
        raise lines.no_scan(f"an {SCAN} line with {BEAMS} ranges")
    log = assemble(raw, lambda laser, mine: extrinsic_by_poses(mine, OFFSET))
    return Log(name, *log, lines.skipped)


def _parse(fields: list[str]) -> RawScan | None:
    if fields[0] == POSE:
        return None
    if fields[0] != SCAN:
        raise ValueError(f"expected an {SCAN} or {POSE} line, got {fields[0][:40]!r}")
    if len(fields) != HEAD + BEAMS + TAIL:
        raise ValueError(
            f"expected {HEAD - 1} fields, {BEAMS} ranges and a time, got {len(fields)}"
        )
    ranges = numbers(fields[HEAD:-TAIL], "ranges") / 100
    robot, laser = _pose(fields[1:4], "the robot"), _pose(fields[4:7], "the laser")
    return RawScan(SCAN, ranges, half_turn(BEAMS), time(fields[-1]), robot, laser)


def _pose(fields: Sequence[str], what: str) -> Array:
    return pose(fields, what) * CENTIMETRES
