"""Logs of programs near CARMEN, whose lines are a word and fields in a fixed order.

    GMapping (`.gfs`; G. Grisetti, C. Stachniss, W. Burgard)
        LASER_READING n r1 ... rn x y theta t
        SM_UPDATE m x1 y1 theta1 weight1 ... xm ym thetam weightm
    DP-SLAM (A. Eliazar, R. Parr)
        Odometry x y theta
        Laser n r1 ... rn
    Wean Hall (Carnegie Mellon University), in centimetres
        L x y theta laser_x laser_y laser_theta r1 ... r180 t
        O x y theta t

Metres else, radians, seconds. Of GMapping a reading is a scan that went into the map, with the raw
odometry. The SM_UPDATE after it lists all particles once the scan was matched: the pose of the
heaviest one is the truth of that scan. Where two updates follow a scan, the last counts; a scan
without one has no truth. Ranges of `PARAM maxrange` and more met nothing. Left out are poses
between the scans and other parameters.

Of DP-SLAM the odometry of a scan is the last line before it that no scan has used: a line used
twice would put two scans into one place. There are no times and no truth.

Of Wean Hall the laser's pose lies 25 cm ahead in all logs that we know: what lies between the two
poses of all lines decides, see `extrinsic_by_poses`; where it varies, the laser's poses are truth.
O lines are left out, since every L line has its own odometry.

Assumed: where the beams point: of GMapping 540 and 541 are those of a S300 (270 degrees), 682 and
683 those of an URG-04LX, as GMapping itself takes them; all others follow the rule of `half_turn`.
The laser of GMapping and DP-SLAM sits at the robot's centre.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...arrays import Array
from ..lines import Lines, counted_fields, float_fields, is_number, pose_fields
from ..raw_scans import (
    NOWHERE,
    URG_STEP,
    Extrinsic,
    RawScan,
    directions,
    extrinsic_by_offset,
    extrinsic_by_poses,
    half_turn,
)
from ..text import Declared

#: Beams of lasers that look over more than half a turn, and the turn from one to the next.
WIDE_LASER_STEPS_RAD = {540: np.radians(0.5), 541: np.radians(0.5), 682: URG_STEP, 683: URG_STEP}
#: Fields of a particle: x, y, theta, weight.
PARTICLE = 4
#: How far ahead of the robot's centre the laser sits where the poses do not tell, metres.
OFFSET = np.array([0.25, 0.0, 0.0])


class GMapping(Declared):
    """A run of GMapping."""

    name, expected = "GMapping", "a LASER_READING line"
    forms = {"LASER_READING": "n ranges*n odometry*3 time"}  # noqa: RUF012
    keywords = (
        *("LASER_READING", "SM_UPDATE", "PARAM", "ODOM", "ODO_UPDATE", "NEFF", "RESAMPLE"),
        *("FRAME", "ENTROPY", "SIMULATOR_POS", "COMMENT"),
    )

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.reach = np.inf

    def _other(self, fields: list[str]) -> None:
        if fields[0] == "SM_UPDATE" and self.scans:
            self.scans[-1] = self.scans[-1]._replace(pose=_best_pose(fields))
        elif fields[:2] == ["PARAM", "maxrange"]:
            reach = float(float_fields(fields[2:3] or [""], "maxrange")[0])
            if not reach > 0:
                raise ValueError(f"expected metres for maxrange, got {fields[2][:40]!r}")
            self.reach = reach

    def _directions(self, count: int) -> Array:
        step = WIDE_LASER_STEPS_RAD.get(count)
        return directions(count, step) if step else half_turn(count)

    def _finish(self) -> list[RawScan]:
        return [scan._replace(limit=self.reach) for scan in self.scans]

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        return extrinsic_by_offset(scans, np.zeros(3))


def _best_pose(fields: list[str]) -> Array:
    """Pose of the heaviest particle, (3,) array; weights are logarithms, -inf is one."""
    particles, rest = counted_fields([*fields[1:2], *fields[2::PARTICLE]], "particles")
    if rest or len(fields) != 2 + PARTICLE * len(particles):
        raise ValueError(f"announces {len(particles)} particles, got {len(fields) - 2} fields")
    weights = float_fields(fields[5::PARTICLE], "the weights")
    if np.isnan(weights).all():
        raise ValueError("expected the weight of a particle, got none")
    best = 2 + PARTICLE * int(np.nanargmax(weights))
    return pose_fields(fields[best : best + 3], "the heaviest particle")


class DpSlam(Declared):
    """A log of DP-SLAM."""

    name, expected = "DP-SLAM", "a Laser line"
    forms = {"Odometry": "odometry*3", "Laser": "n ranges*n"}  # noqa: RUF012
    keywords = tuple(forms)
    odometry = NOWHERE

    def _take_fields(self, word: str, by_name: Mapping[str, Sequence[str]]) -> None:
        if word == "Odometry":
            self.odometry = pose_fields(by_name["odometry"], "the odometry")
        else:
            super()._take_fields(word, by_name)
            self.scans[-1] = self.scans[-1]._replace(odometry=self.odometry)
            self.odometry = NOWHERE

    def _take(self, fields: list[str]) -> None:
        before, self.odometry = self.odometry, NOWHERE
        if fields[0] != "Odometry":  # of which a damaged one leaves none
            self.odometry = before
        super()._take(fields)


class WeanHall(Declared):
    """A log of Wean Hall."""

    name, expected = "Wean Hall", "an L line with 180 ranges"
    forms = {"L": "odometry*3 laser*3 ranges*180 time"}  # noqa: RUF012
    keywords, per_metre = ("L", "O"), 100

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        wanted = {"L": 188, "O": 5}.get(fields[0])
        return len(fields) == wanted and is_number(fields[1])

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        return extrinsic_by_poses(scans, OFFSET)
