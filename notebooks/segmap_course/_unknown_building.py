"""A log without truth, four maps of it, and a tape measure: which one is right?"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import NamedTuple

import numpy as np

from segmap.alignment import Alignment, odometry, point_icp, pose_graph
from segmap.arrays import Array
from segmap.extraction import build_map
from segmap.scans import Log
from segmap.segments import SegmentMap
from segmap.simulation import SICK_LMS200, OdometryNoise, cast_rays, drive, office, simulate

#: Ranges of map C are longer by this factor: the unit of another sensor of the same maker.
OTHER_UNIT = 1.03
#: Standard deviation of the tape measure, metres.
TAPE_SIGMA_M = 0.005
#: The drive through the office, metres.
STOPS = [
    *((0.7, 5), (2, 5), (2, 7.4), (2, 5), (6, 5), (6, 2.6), (6, 5), (11.3, 5), (10, 5), (10, 7.4)),
    *((10, 5), (10, 2.6), (10, 5), (6, 5), (6, 7.4), (6, 5), (2, 5), (2, 2.6), (2, 5), (1, 5)),
]

#: Where the tape is laid: words, index of the scan, direction in the robot's frame, radians.
LAID = (
    ("along the corridor", 48, 0.0),
    ("across the building", 12, 0.0),
    ("across the corridor", 48, np.pi / 2),
)


class Taped(NamedTuple):
    """A distance from wall to wall through the place of a scan, along a direction of the robot.

    Words say which; `scan` is its index, `turn` the direction in the robot's frame, radians, and
    `metres` what the tape says.
    """

    words: str
    scan: int
    turn: float
    metres: float


@dataclass(frozen=True)
class Unknown:
    """A log that nobody knows the truth of, with four maps of it and three taped distances."""

    log: Log
    alignments: Mapping[str, Alignment]
    maps: Mapping[str, SegmentMap]
    tape: tuple[Taped, ...]
    #: For the judge alone: the true poses.
    _truth: Array = field(repr=False)

    def measured(self, name: str, taped: Taped) -> float:
        """The distance that a map shows where the tape was laid, metres."""
        return wall_to_wall(self.maps[name].segments, self.alignments[name].poses, taped)

    def off(self, name: str) -> Array:
        """How far each scan of a map really is from its place, (k,) metres: after the decision."""
        away = self.alignments[name].poses - self._truth
        return np.hypot(*away[:, :2].T)


def wall_to_wall(walls: Array, poses: Array, taped: Taped) -> float:
    """From wall to wall through the place of a scan, metres; walls `(n, 2, 2)`, poses `(k, 3)`."""
    both = [taped.turn, taped.turn + np.pi]
    return float(cast_rays(walls, poses[taped.scan], both, max_range=50.0).sum())


def with_other_unit(log: Log) -> Log:
    """The log as who takes the unit of another sensor reads it: all ranges longer."""
    return Log(log.name, [replace(scan, ranges=OTHER_UNIT * scan.ranges) for scan in log])


@cache
def unknown_building(floor: int = 0) -> Unknown:
    """A drive through an office: four maps, A to D, each by another way from the same log.

    On another floor the same ways were taken, and nobody says which map is by which.

    Examples
    --------
    >>> case = unknown_building()
    >>> case.log.truth is None, list(case.maps), [taped.words for taped in case.tape]
    (True, ['A', 'B', 'C', 'D'], ['along the corridor', 'across the building', \
'across the corridor'])
    """
    walls = office(rng=np.random.default_rng(7 + floor))
    drive_log = simulate(
        walls,
        drive(STOPS, step=0.3, turn=0.35),
        sensor=replace(SICK_LMS200, max_range=4.0),
        odometry_noise=OdometryNoise(turn_bias=0.05, turn_noise=0.05, heading_noise=0.02),
        rng=np.random.default_rng(floor),
    )
    truth = drive_log.truth
    assert truth is not None
    log = Log("unknown", drive_log.scans)
    ways = [
        (odometry, log),
        (point_icp, log),
        (pose_graph, with_other_unit(log)),
        (pose_graph, log),
    ]
    order = np.random.default_rng(floor).permutation(4) if floor else range(4)
    pairs = dict(zip("ABCD", (ways[k] for k in order), strict=True))
    alignments = {name: method(scans) for name, (method, scans) in pairs.items()}
    maps = {
        name: build_map(scans, alignments[name]).filtered(0.3) for name, (_, scans) in pairs.items()
    }
    rng = np.random.default_rng(1)
    tape = tuple(
        Taped(words, k, turn, round(true + rng.normal(0, TAPE_SIGMA_M), 2))
        for words, k, turn in LAID
        for true in [wall_to_wall(walls, truth, Taped(words, k, turn, 0.0))]
    )
    return Unknown(log, alignments, maps, tape, truth)
