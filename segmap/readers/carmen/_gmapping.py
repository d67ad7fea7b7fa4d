"""GMapping's own record of a run (`.gfs`; G. Grisetti, C. Stachniss, W. Burgard).

    LASER_READING n r1 ... rn x y theta t
    SM_UPDATE m x1 y1 theta1 weight1 ... xm ym thetam weightm

A LASER_READING is a scan that went into the map, with the raw odometry and the time. The SM_UPDATE
after it lists all particles once the scan was matched: the pose of the heaviest one is the truth of
that scan. Where two updates follow a scan, the last counts; a scan without one has no truth. Ranges
of `PARAM maxrange` and more met nothing. Metres, radians, seconds.

Left out are ODOM and ODO_UPDATE (poses between the scans, raw and of all particles), RESAMPLE,
NEFF, FRAME, ENTROPY, SIMULATOR_POS, COMMENT and the other parameters.

Assumed: where the beams point: 540 and 541 are those of a S300 (270 degrees), 682 and 683 those of
an URG-04LX, as GMapping itself takes them; all others follow the rule of `half_turn`. And the laser
sits at the robot's centre.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import Array
from .._lines import Lines, counted_fields, float_fields, is_count, pose_fields, time
from .._raw_scans import (
    URG_STEP,
    Extrinsic,
    RawScan,
    centred,
    extrinsic_by_offset,
    half_turn,
    view_of,
)
from .._text import TextFormat

#: First word of a line with a scan.
GMAPPING_SCAN = "LASER_READING"
#: First word of a line with the pose that GMapping found for it.
GMAPPING_MATCHED = "SM_UPDATE"
#: Lines that hold neither a scan nor its pose.
GMAPPING_OTHERS = (
    *("PARAM", "ODOM", "ODO_UPDATE", "NEFF", "RESAMPLE", "FRAME", "ENTROPY"),
    *("SIMULATOR_POS", "COMMENT"),
)
GMAPPING_KEYWORDS = frozenset((GMAPPING_SCAN, GMAPPING_MATCHED, *GMAPPING_OTHERS))
#: Beams of lasers that look over more than half a turn, and the turn from one to the next.
WIDE_LASER_STEPS_RAD = {540: np.radians(0.5), 541: np.radians(0.5), 682: URG_STEP, 683: URG_STEP}
#: Fields of a particle: x, y, theta, weight.
PARTICLE = 4


class GMapping(TextFormat):
    """A run of GMapping."""

    name, keywords, expected = "GMapping", GMAPPING_KEYWORDS, f"a {GMAPPING_SCAN} line"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.reach = np.inf

    def _take(self, fields: list[str]) -> None:
        if fields[0] == GMAPPING_SCAN:
            self.scans.append(_gmapping_scan(fields))
        elif fields[0] == GMAPPING_MATCHED and self.scans:
            self.scans[-1] = self.scans[-1]._replace(pose=_heaviest(fields))
        elif fields[:2] == ["PARAM", "maxrange"]:
            reach = float(float_fields(fields[2:3] or [""], "maxrange")[0])
            if not reach > 0:
                raise ValueError(f"expected metres for maxrange, got {fields[2][:40]!r}")
            self.reach = reach
        elif fields[0] not in GMAPPING_KEYWORDS:
            raise ValueError(f"expected a line of a GMapping run, got {fields[0][:40]!r}")

    def _finished(self) -> list[RawScan]:
        return [scan._replace(limit=self.reach) for scan in self.scans]

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        return extrinsic_by_offset(scans, np.zeros(3))


def _gmapping_scan(fields: list[str]) -> RawScan:
    ranges, rest = counted_fields(fields[1:], "ranges")
    if len(rest) != PARTICLE:
        raise ValueError(f"expected x, y, heading and the time after the ranges, got {len(rest)}")
    odometry, found = pose_fields(rest[:3], "the odometry"), float_fields(ranges, "ranges")
    n, when = len(found), time(rest[3])
    angles = centred(n, WIDE_LASER_STEPS_RAD[n]) if n in WIDE_LASER_STEPS_RAD else half_turn(n)
    return RawScan(GMAPPING_SCAN, found, angles, when, odometry, assumed=(view_of(angles),))


def _heaviest(fields: list[str]) -> Array:
    """Pose of the heaviest particle, (3,) array; weights are logarithms, -inf is one."""
    field = fields[1] if len(fields) > 1 else ""
    if not is_count(field) or len(fields) != 2 + PARTICLE * int(field):
        raise ValueError(f"announces {field[:40]!r} particles, but {len(fields) - 2} fields follow")
    weights = float_fields(fields[5::PARTICLE], "the weights")
    if np.isnan(weights).all():
        raise ValueError("expected the weight of a particle, got none")
    best = 2 + PARTICLE * int(np.nanargmax(weights))
    return pose_fields(fields[best : best + 3], "the heaviest particle")
