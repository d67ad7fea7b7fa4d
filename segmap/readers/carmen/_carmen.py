"""CARMEN logs, old and new laser messages.

    FLASER n r1 ... rn [x y theta ox oy otheta [t host t0]]

x y theta is the laser's pose, corrected where the log has been corrected; ox oy otheta is the
robot's odometry; t is in seconds. RLASER is the same of a laser that faces backwards. The beams
follow the rule of `half_turn`. A scan without a time gets its number in the log. The newer lines
state their beams:

    ROBOTLASER1 type start_angle field_of_view resolution maximum_range accuracy remission_mode
        n [n ranges] m [m remissions] laser_x laser_y laser_theta robot_x robot_y robot_theta
        tv rv forward_safety side_safety turn_axis timestamp host logger_timestamp

RAWLASERn has no poses: after the remissions come only the three fields of time. Metres, radians,
seconds. Beam i points to `start_angle + i resolution`; where the resolution is stated as 0 the
beams are spread evenly over the field of view, both ends included.

`PARAM robot_frontlaser_offset`, `..._side_offset` and `..._angular_offset` say where the laser sits
on the robot (`robot_rearlaser_...` alike, x forward there too); the corrected poses of the log are
the robot's. A RLASER whose stated angle looks forward is read as that much off from backwards.

**What is truth.** The laser poses of FLASER and RLASER lines are corrected ones, unless every one
of them is where the odometry puts the laser. Then the file does not tell, and the rule is: a log
whose laser lines carry the fields of time, with no line of a recorder in the file (ODOM, PARAM,
...), went through a mapper, which writes its poses twice (Freiburg 079): they are truth, and there
is no odometry. Any other log is raw and has no truth. GMapping leaves NEFF, WEIGHT and ENTROPY
lines, and writes its poses twice into a laser line, FLASER or ROBOTLASER: they are truth. It writes
them into the ODOM lines too, and then there is no odometry; where the poses of most scans are in no
ODOM line, these are the raw odometry. Other lines that are a word in capital letters and at most
one field are left out and counted, as `skipped`. For ROBOTLASERn lines of other logs see
`extrinsic_by_poses`.

Assumed: over which angle the beams of FLASER and RLASER look, and that a range from the sensor's
limit on met nothing; where neither PARAM nor poses say it, that the laser sits at the robot's
centre.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from ...arrays import Array, unit_checks
from ...poses import compose
from ...scans import Skipped
from ..lines import Lines, counted_fields, float_fields, merged_skipped, pose_fields, time
from ..raw_scans import (
    NOWHERE,
    Extrinsic,
    RawScan,
    extrinsic_by_offset,
    extrinsic_by_poses,
    half_turn,
    same_poses,
    view_of,
)
from ..text import TextFormat

OLD = ("FLASER", "RLASER")
NEW = tuple(f"{kind}LASER{k}" for kind in ("ROBOT", "RAW") for k in range(1, 6))
#: Lines of a recorder that hold neither a scan nor where its laser sits.
CARMEN_OTHERS = (
    *("SYNC", "TRUEPOS", "GLOBALPOS", "POSITION", "MARKER", "SCANMARK", "MESSAGE", "TEXT"),
    *("NMEAGGA", "NMEARMC", "NMEAVTG", "NMEAGLL", "GPS", "IMU", "COMPASS", "GYRO", "SONAR"),
    *("BUMPER", "LASER3", "LASER4", "REMISSIONFLASER", "REMISSIONRLASER", "PANTILT", "ARM"),
    *("ROBOTVELOCITY", "BASEVELOCITY", "BASEODOM", "VECTORMOVE", "FOLLOWTRAJECTORY"),
)
#: Lines that GMapping adds to a log when it writes its own poses into it.
MAPPED = ("NEFF", "WEIGHT", "ENTROPY")
OFFSETS = tuple(
    f"robot_{end}laser_{kind}offset"
    for end in ("front", "rear")
    for kind in ("", "side_", "angular_")
)
#: Settings of the sensor at the start of a ROBOTLASERn or RAWLASERn line.
ROBOTLASER_SETTINGS = 7
CARMEN_KEYWORDS = frozenset(("PARAM", "ODOM", *OLD, *NEW, *CARMEN_OTHERS, *MAPPED))


class Carmen(TextFormat):
    """A CARMEN log."""

    name, keywords = "CARMEN", CARMEN_KEYWORDS
    expected = "a FLASER, RLASER, ROBOTLASER or RAWLASER line"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.parameters: dict[str, float] = {}
        self.recorded = self.mapped = False

    def _take(self, fields: list[str]) -> None:
        keyword, *rest = fields
        if keyword in OLD:
            self.scans.append(_parse_old(fields))
        elif keyword in NEW:
            self.scans.append(parse_robotlaser(fields))
        elif keyword in CARMEN_KEYWORDS:
            self.recorded = True
            self.mapped |= keyword in MAPPED
            if keyword == "PARAM" and rest and rest[0] in OFFSETS:
                value = pose_fields([*rest[1:2], "0", "0"], rest[0])[0]
                if "angular" in rest[0]:
                    unit_checks.check_angles(value, rest[0])
                self.parameters[rest[0]] = float(value)
            elif keyword == "ODOM" and len(rest) >= 9:
                self.track.add(
                    time(rest[6]), pose_fields(rest[:3], "the odometry"), len(self.scans)
                )
        elif _is_strange(fields):
            reason = f"lines of no known meaning, {keyword[:40]} first"
            self.unknown = merged_skipped(self.unknown, Skipped(1, reason))
        else:
            raise ValueError(f"expected a line of a CARMEN log, got {keyword[:40]!r}")

    def _finish(self) -> Sequence[RawScan]:
        """The scans; those of a mapper with the odometry of ODOM lines, where that is raw."""
        if self._repeats():
            return [scan._replace(odometry=NOWHERE) for scan in self.scans]
        if not self.mapped:
            return super()._finish()
        noted = {_round_pose(pose) for pose in self.track.poses}
        repeated = 2 * sum(_round_pose(scan.pose) in noted for scan in self.scans) > len(self.scans)
        self.scans = [scan._replace(odometry=NOWHERE) for scan in self.scans]
        return self.scans if repeated else super()._finish()

    def _is_corrected(self, scans: Sequence[RawScan]) -> bool:
        """Whether the poses of laser lines went through a mapper, by the rule above."""
        return self.mapped or (all(s.time is not None for s in scans) and not self.recorded)

    def _repeats(self) -> bool:
        """Whether a mapper, not GMapping, wrote its poses into the fields of the odometry too."""
        old = bool(self.scans) and all(scan.laser in OLD for scan in self.scans)
        if not old or self.mapped or not self._is_corrected(self.scans):
            return False
        poses = np.array([scan.pose for scan in self.scans])
        odometry = np.array([scan.odometry for scan in self.scans])
        return bool(np.isfinite(poses).all()) and same_poses(poses, odometry)

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        """Place of a laser and truth, by the rule above."""
        offset, is_stated = self._offset(laser)
        if laser in NEW:
            return extrinsic_by_poses(scans, offset, is_stated)
        if not self._is_corrected(scans):
            poses = np.array([scan.pose for scan in scans])
            odometry = np.array([scan.odometry for scan in scans])
            if any(same_poses(poses, at) for at in (compose(odometry, offset), odometry)):
                return Extrinsic(offset, is_stated)
        return extrinsic_by_offset(scans, offset, is_stated)

    def _offset(self, laser: str) -> tuple[Array, bool]:
        """Where a laser sits on the robot, (3,) array, and whether the file says so."""
        rear = laser in ("RLASER", "ROBOTLASER2", "RAWLASER2")
        name = f"robot_{'rear' if rear else 'front'}laser_"
        turn = self.parameters.get(name + "angular_offset", 0.0)
        if rear and np.cos(turn) >= 0:
            turn += np.pi
        ahead, aside = (self.parameters.get(name + k, 0.0) for k in ("offset", "side_offset"))
        is_stated = any(parameter.startswith(name) for parameter in self.parameters)
        return np.array([ahead, aside, turn]), is_stated


def _parse_old(fields: list[str]) -> RawScan:
    words, rest = counted_fields(fields[1:], "ranges")
    if len(rest) not in (0, 6, 9):
        raise ValueError(
            f"announces {len(words)} ranges and {len(rest)} fields follow them, expected 0, 6 or 9"
        )
    laser = pose_fields(rest[:3], "the laser") if rest else NOWHERE
    odometry = pose_fields(rest[3:6], "the odometry") if rest else NOWHERE
    ranges = float_fields(words, "ranges")
    when = time(rest[6]) if len(rest) == 9 else None
    angles = half_turn(len(ranges))
    return RawScan(fields[0], ranges, angles, when, odometry, laser, assumed=(view_of(angles),))


def _is_strange(fields: list[str]) -> bool:
    """Whether a line is a word and at most one field, and not the torn beginning of a known one."""
    whole = not any(keyword.startswith(fields[0]) for keyword in CARMEN_KEYWORDS)
    return len(fields) <= 2 and re.fullmatch("[A-Z_]{2,}", fields[0]) is not None and whole


def _round_pose(pose: Array) -> tuple[float, ...]:
    """A pose, (3,) array, to a millimetre and a milliradian."""
    return tuple(np.round(pose, 3).tolist())


def parse_robotlaser(fields: list[str]) -> RawScan:
    """One ROBOTLASERn or RAWLASERn line; the keyword names the laser."""
    head = float_fields(fields[1 : ROBOTLASER_SETTINGS + 1], "the sensor's settings")
    if len(head) < ROBOTLASER_SETTINGS or not np.isfinite(head[1:5]).all():
        raise ValueError(
            f"expected {ROBOTLASER_SETTINGS} finite settings of the sensor after {fields[0]}"
        )
    words, rest = counted_fields(fields[ROBOTLASER_SETTINGS + 1 :], "ranges")
    _, rest = counted_fields(rest, "remissions", least=0)
    posed = fields[0].startswith("ROBOT")
    wanted = 14 if posed else 3
    if len(rest) != wanted:
        raise ValueError(f"expected {wanted} fields after the remissions, got {len(rest)}")
    laser = pose_fields(rest[:3], "the laser") if posed else NOWHERE
    odometry = pose_fields(rest[3:6], "the robot") if posed else NOWHERE
    ranges, when = float_fields(words, "ranges"), time(rest[-3])
    start, view, resolution, limit = head[1:5]
    if view < 0 or resolution < 0:
        raise ValueError(f"expected angles that count up, got a step of {min(view, resolution):g}")
    if not (abs(start) < 10 and view < 10 and resolution < 10):
        raise ValueError(f"expected the beams' angles in radians, got {head[1:4].tolist()}")
    angles = start + (resolution or view / max(len(ranges) - 1, 1)) * np.arange(len(ranges))
    unit_checks.check_angles(angles, "angles")
    limit = limit if limit > 0 else np.inf
    spread = () if resolution else (f"beams are spread evenly over {np.degrees(view):.4g} degrees",)
    return RawScan(fields[0], ranges, angles, when, odometry, laser, limit, assumed=spread)
