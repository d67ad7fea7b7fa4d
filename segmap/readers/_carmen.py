"""CARMEN logs, old and new laser messages.

    FLASER n r1 ... rn [x y theta ox oy otheta [t host t0]]

x y theta is the laser's pose, corrected where the log has been corrected; ox oy otheta is the
robot's odometry; t is in seconds. RLASER is the same of a laser that faces backwards. The beams
follow the rule of `_beams`. ROBOTLASERn and RAWLASERn are described in `_robotlaser`. A scan
without a time gets its number in the log.

`PARAM robot_frontlaser_offset`, `..._side_offset` and `..._angular_offset` say where the laser sits
on the robot (`robot_rearlaser_...` alike, x forward there too); the corrected poses of the log are
the robot's. A RLASER whose stated angle looks forward is read as that much off from backwards.

**What is truth.** The laser poses of FLASER and RLASER lines are corrected ones, unless every one
of them is where the odometry puts the laser. Then the file does not tell, and the rule is: a log
whose laser lines carry the fields of time, with no line of a recorder in the file (ODOM, PARAM,
...), went through a mapper, which writes its poses twice (Freiburg 079); any other log is raw and
has no truth. For ROBOTLASERn lines see `_shots.mount_by_poses`.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..poses import compose
from ..scans import Log
from ._beams import half_turn, no_return
from ._fields import counted, numbers, pose, time
from ._lines import Lines
from ._robotlaser import parse as parse_new
from ._shots import (
    NOWHERE,
    Mounted,
    Shot,
    assemble,
    mount_by_offset,
    mount_by_poses,
    same_poses,
)
from ._tracks import Track, with_odometry

OLD = ("FLASER", "RLASER")
NEW = tuple(f"{kind}LASER{k}" for kind in ("ROBOT", "RAW") for k in range(1, 6))
#: Lines of a recorder that hold neither a scan nor where its laser sits.
OTHERS = (
    *("SYNC", "TRUEPOS", "GLOBALPOS", "POSITION", "MARKER", "SCANMARK", "MESSAGE", "TEXT"),
    *("NMEAGGA", "NMEARMC", "NMEAVTG", "NMEAGLL", "GPS", "IMU", "COMPASS", "GYRO", "SONAR"),
    *("BUMPER", "LASER3", "LASER4", "REMISSIONFLASER", "REMISSIONRLASER", "PANTILT", "ARM"),
    *("ROBOTVELOCITY", "BASEVELOCITY", "BASEODOM", "VECTORMOVE", "FOLLOWTRAJECTORY"),
)
OFFSETS = tuple(
    f"robot_{end}laser_{kind}offset"
    for end in ("front", "rear")
    for kind in ("", "side_", "angular_")
)
KEYWORDS = frozenset(("PARAM", "ODOM", *OLD, *NEW, *OTHERS))


def claims(fields: Sequence[str]) -> bool:
    """Whether a line is one of this format."""
    return fields[0] in KEYWORDS


class _Recording:
    """What the lines of one log said so far."""

    def __init__(self) -> None:
        self.shots: list[Shot] = []
        self.wheels = Track()
        self.parameters: dict[str, float] = {}
        self.recorded = False

    def take(self, fields: list[str]) -> None:
        """Take in one line."""
        keyword = fields[0]
        if keyword in OLD:
            self.shots.append(_parse_old(fields))
        elif keyword in NEW:
            self.shots.append(parse_new(fields))
        elif keyword in KEYWORDS:
            self.recorded = True
            self._note(keyword, fields[1:])
        else:
            raise ValueError(f"expected a line of a CARMEN log, got {keyword[:40]!r}")

    def _note(self, keyword: str, fields: list[str]) -> None:
        if keyword == "PARAM" and fields and fields[0] in OFFSETS:
            self.parameters[fields[0]] = float(pose([*fields[1:2], "0", "0"], fields[0])[0])
        elif keyword == "ODOM" and len(fields) >= 9:
            self.wheels.add(time(fields[6]), pose(fields[:3], "the odometry"))

    def offset(self, laser: str) -> Array:
        """Where the file says that a laser sits on the robot, (3,) array, metres and radians."""
        rear = laser in ("RLASER", "ROBOTLASER2", "RAWLASER2")
        name = f"robot_{'rear' if rear else 'front'}laser_"
        turn = self.parameters.get(name + "angular_offset", 0.0)
        if rear and np.cos(turn) >= 0:
            turn += np.pi
        ahead, aside = (self.parameters.get(name + k, 0.0) for k in ("offset", "side_offset"))
        return np.array([ahead, aside, turn])

    def mount(self, laser: str, shots: Sequence[Shot]) -> Mounted:
        """Place of a laser `(3,)` and truth `(k, 3)`, metres and radians, by the rule above."""
        offset = self.offset(laser)
        if laser in NEW:
            return mount_by_poses(shots, offset)
        mounted = mount_by_offset(shots, offset)
        corrected = all(shot.time is not None for shot in shots) and not self.recorded
        if not corrected and _repeats_odometry(shots, offset):
            return Mounted(offset, np.full_like(mounted.truth, np.nan))
        return mounted

    def limits(self) -> Array:
        """For each shot the range from which on it met nothing, `(k,)`, metres."""
        limit = no_return(shot.ranges for shot in self.shots)
        return np.array([min(shot.limit, limit) for shot in self.shots])


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a CARMEN log; `truth` is `(k, 3)`, metres and radians, the robot's pose."""
    lines, recording = Lines(path, on_error), _Recording()
    for _ in lines.each(recording.take):
        pass
    if not recording.shots:
        raise lines.no_scan("a FLASER, RLASER, ROBOTLASER or RAWLASER line")
    shots = with_odometry(recording.shots, recording.wheels)
    return Log(name, *assemble(shots, recording.mount, recording.limits()), lines.skipped)


def _parse_old(fields: list[str]) -> Shot:
    ranges, rest = counted(fields[1:], "ranges")
    if len(rest) not in (0, 6, 9):
        raise ValueError(
            f"announces {len(ranges)} ranges and {len(rest)} fields follow them, expected 0, 6 or 9"
        )
    laser = pose(rest[:3], "the laser") if rest else NOWHERE
    odometry = pose(rest[3:6], "the odometry") if rest else NOWHERE
    found = numbers(ranges, "ranges")
    when = time(rest[6]) if len(rest) == 9 else None
    return Shot(fields[0], found, half_turn(len(found)), when, odometry, laser)


def _repeats_odometry(shots: Sequence[Shot], offset: Array) -> bool:
    poses = np.array([shot.pose for shot in shots])
    wheels = np.array([shot.odometry for shot in shots])
    return same_poses(poses, compose(wheels, offset)) or same_poses(poses, wheels)
