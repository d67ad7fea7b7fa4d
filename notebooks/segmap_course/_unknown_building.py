"""A log without truth, four maps and three plans of it, and a tape measure: which one is right?"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import NamedTuple

import numpy as np

from segmap.alignment import Alignment, odometry, point_icp, pose_graph
from segmap.arrays import Array
from segmap.extraction import build_map
from segmap.metrics import doubled_walls
from segmap.plan import FloorPlan, Room, floor_plan
from segmap.quadtree import build_map as build_tree
from segmap.reduction import one_per_wall
from segmap.scans import Log
from segmap.segments import SegmentMap
from segmap.simulation import SICK_LMS200, OdometryNoise, cast_rays, drive, office, simulate

#: Ranges of map C are longer by this factor: the unit of another sensor of the same maker.
OTHER_UNIT = 1.03
#: Standard deviation of a distance that is taken from a map, metres: walls are drawn that thick.
MAP_SIGMA_M = 0.03
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
#: A map is doubtful by a figure beyond this: least share of scans placed, least share sure, metres
#: that are promised, share of walls doubled, standard deviations from the tape.
LIMITS = {"placed": 0.9, "sure": 0.9, "within": 0.5, "doubled": 0.25, "tape": 3.0}
#: A room on each side of a door holds a circle of at least so many times its width.
WIDER_THAN_A_DOOR = 1.25
#: Standard deviation of a distance taken from a plan, metres: walls that the poses have bent
#: are drawn straight.
PLAN_SIGMA_M = 0.05
#: The map of `unknown_building` from which each plan is made, and kappa.
MADE_FROM = {"P": ("D", 0.1), "Q": ("C", WIDER_THAN_A_DOOR), "R": ("D", WIDER_THAN_A_DOOR)}


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
def unknown_building() -> Unknown:
    """A drive through an office: maps A to D, each by another way from the same log.

    Examples
    --------
    >>> case = unknown_building()
    >>> case.log.truth is None, list(case.maps), [taped.words for taped in case.tape]
    (True, ['A', 'B', 'C', 'D'], ['along the corridor', 'across the building', \
'across the corridor'])
    """
    walls = office(rng=np.random.default_rng(7))
    known = simulate(
        walls,
        drive(STOPS, step=0.3, turn=0.35),
        sensor=replace(SICK_LMS200, max_range=4.0),
        odometry_noise=OdometryNoise(turn_bias=0.05, turn_noise=0.05, heading_noise=0.02),
        rng=np.random.default_rng(0),
    )
    truth = known.truth
    assert truth is not None
    log = Log("unknown", known.scans)
    made = {"A": (odometry, log), "B": (point_icp, log), "C": (pose_graph, with_other_unit(log))}
    made["D"] = pose_graph, log
    alignments = {name: method(given) for name, (method, given) in made.items()}
    maps = {
        name: build_map(given, alignments[name]).filtered(0.3) for name, (_, given) in made.items()
    }
    rng = np.random.default_rng(1)
    tape = tuple(
        Taped(words, k, turn, round(true + rng.normal(0, TAPE_SIGMA_M), 2))
        for words, k, turn in LAID
        for true in [wall_to_wall(walls, truth, Taped(words, k, turn, 0.0))]
    )
    return Unknown(log, alignments, maps, tape, truth)


def figures(case: Unknown, name: str) -> dict[str, float]:
    """What speaks for or against a map: figures that need no truth.

    `placed` and `sure` are shares of the scans, `within` what is promised of all of them, metres,
    `doubled` the share of doubled walls, `tape` the largest deviation from the tape in standard
    deviations. NaN is what the method does not tell.

    Examples
    --------
    >>> evidence = figures(unknown_building(), "D")
    >>> evidence["sure"], evidence["doubled"] < 0.01, evidence["tape"] < 3
    (1.0, True, True)
    """
    alignment, map = case.alignments[name], case.maps[name]
    told, sigma = alignment.verdict_on(map), np.hypot(MAP_SIGMA_M, TAPE_SIGMA_M)
    off = [(case.measured(name, taped) - taped.metres) / sigma for taped in case.tape]
    return {
        "placed": told.placed / told.scans,
        "sure": np.nan if told.sure is None else told.sure / told.scans,
        "within": np.nan if told.worst is None else told.worst,
        "doubled": doubled_walls(map, alignment.poses[:, :2]),
        "tape": float(np.abs(off).max()),
    }


def reasons(case: Unknown, name: str) -> set[str]:
    """Which witnesses speak against a map: verdict, spread, doubled, tape.

    Examples
    --------
    >>> case = unknown_building()
    >>> {name: sorted(reasons(case, name)) for name in case.maps}
    {'A': ['doubled', 'tape', 'verdict'], 'B': ['spread'], 'C': ['tape'], 'D': []}
    """
    found = figures(case, name)
    against = {
        "verdict": case.alignments[name].verdict_on(case.maps[name]).grade != "good",
        "spread": found["sure"] < LIMITS["sure"] or found["within"] > LIMITS["within"],
        "doubled": found["doubled"] > LIMITS["doubled"],
        "tape": found["tape"] > LIMITS["tape"],
    }
    return {witness for witness, speaks in against.items() if speaks}


@cache
def three_plans() -> Mapping[str, FloorPlan]:
    """Plans P, Q and R of the log of `unknown_building`.

    Examples
    --------
    >>> {name: (len(plan.rooms), len(plan.doors)) for name, plan in three_plans().items()}
    {'P': (11, 10), 'Q': (7, 6), 'R': (7, 6)}
    """
    case, made = unknown_building(), {}
    for name, (source, kappa) in MADE_FROM.items():
        log = with_other_unit(case.log) if source == "C" else case.log
        poses = case.alignments[source]
        walls = one_per_wall(build_map(log, poses, keep_points=True))
        free = build_tree(log, poses, resolution=0.05, free_resolution=0.05)
        made[name] = floor_plan(walls, free, kappa=kappa)
    return made


def circle_in(room: Room) -> float:
    """Diameter of the largest circle that a room holds, metres.

    Examples
    --------
    >>> corridor = three_plans()["R"].rooms[0]
    >>> round(circle_in(corridor), 1)
    2.1
    """
    import shapely

    inside = shapely.Polygon(room.outline, room.holes)
    return 2 * float(shapely.maximum_inscribed_circle(inside, tolerance=0.01).length)


def plan_reasons(name: str) -> set[str]:
    """What speaks against one of `three_plans`: "circle", "tape" or "shut".

    A door that is too wide for a room beside it; a distance that the tape measured otherwise; a
    room into which no door leads.

    Examples
    --------
    >>> {name: plan_reasons(name) for name in three_plans()}
    {'P': {'circle'}, 'Q': {'tape'}, 'R': set()}
    """
    plan, case = three_plans()[name], unknown_building()
    wide = [circle_in(room) for room in plan.rooms]
    poses = case.alignments[MADE_FROM[name][0]].poses
    walls = plan.walls.segments
    off = [wall_to_wall(walls, poses, taped) - taped.metres for taped in case.tape]
    doors = [(door, [wide[k] for k in door.rooms]) for door in plan.doors]
    against = {
        "circle": any(min(both) < WIDER_THAN_A_DOOR * door.width for door, both in doors),
        "tape": max(np.abs(off)) > LIMITS["tape"] * PLAN_SIGMA_M,
        "shut": not plan.graph.any(1).all(),
    }
    return {witness for witness, speaks in against.items() if speaks}
