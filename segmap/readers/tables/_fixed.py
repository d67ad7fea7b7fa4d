"""Lines of numbers in a fixed order, without words: of CoreSLAM and Rawseeds.

CoreSLAM (Mines ParisTech), a Hokuyo URG-04LX on a robot with two wheels: a header, then ranges in
millimetres. What most lines of a file have decides: 24 fields and 683 ranges (`test_lab2`, `exp1`),
or 13 and 682 (`test_lab`); a line of another length is damaged. The time is in microseconds; of the
ticks of the wheels since the start the right ones count backwards with 13 fields, as CoreSLAM's own
programs take them. Wheels that stand at zero in the whole file mean that there is no odometry.
Between two lines the robot is taken to drive an exact arc; the odometry starts at 0, 0, 0.

Rawseeds, the file of one laser, comma-separated, metres and seconds:

    t, count, offset [quarter degrees], ranges          a SICK, its beams as in `half_turn`
    t, 681 ranges                                       a Hokuyo

Values of a Hokuyo below 20 mm are error codes, see `error_codes`. There is no truth.

Assumed: a Hokuyo is a URG-04LX; its beams are 360/1024 degree apart, the middle one straight ahead,
and it turns in 0.1 s, which gives each beam its time. Of CoreSLAM, since its programs have it so: a
wheel of 77 mm radius makes 2000 ticks a turn, the wheels are 330 mm apart, the laser sits 145 mm
ahead of their axle. Of Rawseeds: a laser sits at the robot's centre, rear ones face backwards.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from ...arrays import LIMIT, Array
from ...poses import compose
from ...scans.error_codes import as_ranges
from ..lines import Lines, float_fields, is_number, time
from ..raw_scans import (
    NOWHERE,
    URG_ASSUMED,
    URG_REACH,
    URG_STEP,
    Extrinsic,
    RawScan,
    directions,
    half_turn,
    urg_delays,
)
from ..text import TextFormat, fields_by_name

#: Lines of CoreSLAM by the number of their fields, and the sign of the right wheel.
CORESLAM_LINES = {
    707: ("time - left right -*20 ranges*683", 1),
    695: ("time left right -*10 ranges*682", -1),
}
METRES_PER_TICK = 2 * np.pi * 0.077 / 2000
WHEEL_SEPARATION = 0.330
#: More ticks than this no wheel turns.
MOST_TICKS = 1e12
#: What the files do not say of the robot.
CORESLAM_ASSUMED = (
    "wheels of 77 mm radius, 2000 ticks a turn, 330 mm apart",
    "the laser sits 0.145 m ahead of the robot's centre",
)
#: Fields of a line of a Hokuyo of Rawseeds.
RAWSEEDS_HOKUYO = 682


def urg_scan(laser: str, millimetres: Array, when: float) -> RawScan:
    """A scan of a URG-04LX, whose ranges and codes are `(n,)`."""
    ranges, codes = as_ranges(millimetres)
    angles = directions(len(ranges), URG_STEP)
    turn = codes, urg_delays(angles), (URG_ASSUMED,)
    return RawScan(laser, ranges, angles, when, NOWHERE, NOWHERE, URG_REACH, *turn)


class CoreSlam(TextFormat):
    """A log of CoreSLAM: of the layout that most lines have, the first where none has any."""

    by_shape = True
    name, expected = "CoreSLAM", f"lines of {' or '.join(map(str, CORESLAM_LINES))} numbers"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        counts = Counter(map(len, Lines(lines.path, "skip")))
        self.form, self.sign = CORESLAM_LINES[max(CORESLAM_LINES, key=lambda n: counts[n])]
        self.ticks: list[Array] = []

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        return len(fields) in CORESLAM_LINES and fields[0].isdecimal() and is_number(fields[-1])

    def _take(self, fields: list[str]) -> None:
        by_name = fields_by_name(self.form, fields)
        wheels = float_fields([*by_name["left"], *by_name["right"]], "the ticks of the wheels")
        if not (np.abs(wheels) <= MOST_TICKS).all():
            raise ValueError(f"expected the ticks of the wheels, got {wheels.tolist()}")
        ranges = float_fields(by_name["ranges"], "ranges")
        self.scans.append(urg_scan("hokuyo", ranges, time(by_name["time"][0], unit=1e-6)))
        self.ticks.append(wheels * (1, self.sign))

    def _finish(self) -> Sequence[RawScan]:
        ticks, scans = np.array(self.ticks), list[RawScan](self.scans)
        if not np.ptp(ticks, axis=0).any() and not ticks.all():
            return scans
        poses = integrate(METRES_PER_TICK * np.diff(ticks, axis=0))
        more = (URG_ASSUMED, *CORESLAM_ASSUMED)
        pairs = zip(scans, poses, strict=True)
        return [scan._replace(odometry=pose, assumed=more) for scan, pose in pairs]

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        return Extrinsic(np.array([0.145, 0.0, 0.0]), is_stated=True)


def integrate(driven: Array) -> Array:
    """Poses of the robot, `(k + 1, 3)`, from what its left and right wheel drove, `(k, 2)`.

    Examples
    --------
    >>> integrate(np.array([[0.0, np.pi * 0.330 / 2]])).round(4)  # a quarter turn round the left
    array([[0.    , 0.    , 0.    ],
           [0.165 , 0.165 , 1.5708]])
    """
    left_m, right_m = driven.T
    turn = (right_m - left_m) / WHEEL_SEPARATION
    chord = (left_m + right_m) / 2 * np.sinc(turn / (2 * np.pi))
    steps = np.stack([chord * np.cos(turn / 2), chord * np.sin(turn / 2), turn], -1)
    poses = [np.zeros(3)]
    for step in steps:
        poses.append(compose(poses[-1], step))
    return np.array(poses)


class Rawseeds(TextFormat):
    """The file of one laser; with it odometry and truth, where its folder is read."""

    by_shape = True
    name, separator = "Rawseeds", ","
    expected = "lines of a SICK or Hokuyo file"

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line, split at commas, is one of these files."""
        metres = len(fields) == RAWSEEDS_HOKUYO and any("." in field for field in fields[1:])
        counted = len(fields) > 1 and fields[1].strip() == str(len(fields) - 3)
        return is_number(fields[0]) and (metres or counted)

    def _take(self, fields: list[str]) -> None:
        fields = [field.strip() for field in fields]
        when = time(fields[0])
        if len(fields) == RAWSEEDS_HOKUYO:
            metres = np.clip(float_fields(fields[1:], "ranges"), -LIMIT, LIMIT)
            self.scans.append(urg_scan("hokuyo", 1000 * metres, when))
            return
        by_name = fields_by_name("time n offset ranges*n", fields)
        (quarters,) = float_fields(by_name["offset"], "the offset")
        if not abs(quarters) <= 720:
            raise ValueError(f"expected an offset in quarter degrees, got {fields[2][:40]}")
        ranges = float_fields(by_name["ranges"], "ranges")
        angles = half_turn(len(ranges)) + np.radians(quarters / 4)
        self.scans.append(RawScan("sick", ranges, angles, when))

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        backwards = np.pi if "REAR" in self.lines.path.name.upper() else 0.0
        return Extrinsic(np.array([0.0, 0.0, backwards]))
