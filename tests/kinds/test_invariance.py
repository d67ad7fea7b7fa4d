"""Changes of a log that must not alter the answer: from file to map, plan and verdict.

Every alignment, reduction and way in, the quadtree, the plan and the localization run on one
simulated log, and on the same log mounted, stored or placed otherwise. What comes out is carried
back and compared.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from inspect import unwrap
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np
import pytest
from plan_buildings import box, built

from segmap import Log, alignment, build_map, exports, matching, metrics, quadtree, read, reduction
from segmap.plan import floor_plan
from segmap.poses import between, compose, interpolate, inverse, transform
from segmap.scans import sensor_noise
from segmap.segments import SegmentMap
from segmap.simulation import OdometryNoise, Sensor, drive, simulate
from segmap.testing import assert_segments_equal

#: Two rooms and a door; the largest range, 6 m, is below the length of both.
ROOMS = built(
    [box(0, 0, 4.4, 4.0), box(4.52, 0, 3.7, 4.0)],
    [box(4.39, 1.4, 0.14, 0.9)],
    [(1, 1), (3.2, 1.85), (5.2, 1.85), (7, 3)],
    obstacles=[box(0.6, 2.9, 0.7, 0.5), box(7.0, 0.5, 0.6, 0.9)],
)
LASER = Sensor("whole turn", 180, -np.pi, np.radians(2), max_range=6.0, sigma=0.005)
WHEELS = OdometryNoise(turn_bias=0.02, turn_noise=0.02, heading_noise=0.005)


class World(NamedTuple):
    """A log, and how its poses and maps are carried back: out of the frame, then mirrored."""

    log: Log
    frame: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mirrored: bool = False

    def back(self, points):
        """Points `(..., 2)` of this world in the unchanged one."""
        there = transform(inverse(self.frame), np.reshape(points, (-1, 2))).reshape(
            np.shape(points)
        )
        return there * (1, -1) if self.mirrored else there

    def poses_back(self, poses):
        """Poses `(k, 3)` of this world in the unchanged one, without those of empty scans."""
        there = between(self.frame, poses)[shows(self.log)]
        return there * (1, -1, -1) if self.mirrored else there


def shows(log):
    """Which scans have a point."""
    return np.array([scan.valid.any() for scan in log])


def each(change) -> Callable[[Log], World]:
    """Every scan is stored otherwise."""
    return lambda log: World(replace(log, scans=tuple(map(change, log))))


def half_a_turn(scan):
    there = compose(scan.sensor_pose, (0, 0, np.pi))
    return replace(scan, angles=scan.angles - np.pi, sensor_pose=there)


def in_order(scan, order):
    """The beams stored in another order, each with its direction and its own time."""
    delays = None if scan.delays is None else scan.delays[order]
    return replace(scan, ranges=scan.ranges[order], angles=scan.angles[order], delays=delays)


def rolled(scan):
    k = len(scan) // 3
    angles = scan.angles + np.where(np.arange(len(scan)) < k, 2 * np.pi, 0.0)
    return in_order(replace(scan, angles=angles), np.roll(np.arange(len(scan)), -k))


def moved(frame) -> Callable[[Log], World]:
    """The log lies elsewhere: its odometry and what is true of it."""

    def change(log):
        scans = [replace(scan, odometry=compose(frame, scan.odometry)) for scan in log]
        return World(replace(log, scans=tuple(scans), truth=compose(frame, log.truth)), frame)

    return change


def mirrored(log):
    flip = (1, -1, -1)

    def change(scan):
        poses = {"odometry": scan.odometry * flip, "sensor_pose": scan.sensor_pose * flip}
        return in_order(replace(scan, angles=-scan.angles, **poses), slice(None, None, -1))

    return World(replace(log, scans=tuple(map(change, log)), truth=log.truth * flip), mirrored=True)


def with_empty_scans(log):
    """One on the way through the door and two behind it, where methods take another reference."""
    number = np.arange(len(log))
    every = np.sort(np.append(number, (14.5, 17 + 1 / 3, 17 + 2 / 3)))
    poses, truth = (interpolate(number, rows, every) for rows in (log.odometry, log.truth))
    scans = [
        replace(log[k], time=time, odometry=pose)
        for k, time, pose in zip(
            np.ceil(every).astype(int), np.interp(every, number, log.times), poses, strict=True
        )
    ]
    for k in np.flatnonzero(every % 1):
        scans[k] = replace(scans[k], ranges=np.full(len(scans[k]), np.nan))
    return World(replace(log, scans=tuple(scans), truth=truth))


CHANGES = {
    "mounted by pi": each(half_a_turn),
    "beams reversed": each(lambda scan: in_order(scan, slice(None, None, -1))),
    "times + 1.7e9": each(lambda scan: replace(scan, time=scan.time + 1.7e9)),
    "turn begins elsewhere": each(rolled),
    "nothing met is NaN": each(
        lambda s: replace(s, ranges=np.where(np.isinf(s.ranges), np.nan, s.ranges))
    ),
    "empty scans between": with_empty_scans,
    # The last way is driven towards -x, where headings jump.
    "turned and moved": moved((31.7, -12.3, np.pi - np.arctan2(1.15, 1.8))),
    "a quarter turn, whole cells": moved((31.0, -12.0, np.pi / 2)),
    "mirrored": mirrored,
}


@cache
def world(change=None, step=0.25, moving=False) -> World:
    """The log, of a laser beside the robot's turning point, or a change of it."""
    path, rng = drive(ROOMS.way, step=step, turn=0.8 * step + 0.15), np.random.default_rng(1)
    how = {"odometry_noise": WHEELS, "sensor_pose": (0.15, -0.05, 0.3), "moving": moving}
    log = simulate(ROOMS.walls, path, sensor=LASER, rng=rng, **how)
    return CHANGES[change](log) if change else World(log)


def map_of(there: World) -> SegmentMap:
    return build_map(there.log, there.log.truth, keep_points=True)


def tree_of(there: World):
    return quadtree.build_map(there.log, there.log.truth, resolution=0.05)


# ---------------------------------------------------------------------------- members
def aligned(method):
    """Poses from the first one on, which scans are used, and the verdict on the map."""

    def answer(there):
        log = there.log
        alignment_of_log = method(log)
        poses = there.poses_back(alignment_of_log.poses)
        verdict = alignment_of_log.verdict_on(build_map(log, alignment_of_log))
        used = alignment_of_log.used[shows(log)]
        return {"poses": between(poses[0], poses), "used": used, "grade": verdict.grade}

    return answer


def usual(log):
    return alignment.pose_graph(alignment.prepared(log))


def without_wheels(log):
    return usual(replace(log, scans=tuple(replace(scan, odometry=None) for scan in log)))


def deskewed(there):
    """Beams of a robot that moves, carried to one moment; sorted."""
    points = [scan.points() for scan in alignment.deskew(there.log, there.log.truth)]
    flip = (1, -1) if there.mirrored else (1, 1)
    return {"points": np.concatenate([np.sort(rows * flip, axis=0) for rows in points])}


def reduced(name):
    """Walls, by a method that does not depend on the map's frame where it can be told to."""
    function = reduction.METHODS[name].function
    options = {"origin": "pair"} if "origin" in unwrap(function).__kwdefaults__ else {}
    return lambda there: {"segments": there.back(function(map_of(there), **options).segments)}


def occupied(there):
    """How much of each square of half a metre is occupied."""
    x, y = np.meshgrid(np.arange(-0.52, 8.98, 0.1), np.arange(-0.52, 4.48, 0.1))
    points = np.stack([x.ravel(), y.ravel()], 1) * ((1, -1) if there.mirrored else (1, 1))
    occupancy = tree_of(there).occupancy(transform(there.frame, points)) > 0.5
    return {"share": occupancy.reshape(10, 5, 19, 5).mean((1, 3))}


def plan_of(there, order=slice(None)):
    walls = reduction.one_per_wall(map_of(there)).segments[order]
    return floor_plan(walls, tree_of(there))


def planned(there, order=slice(None)):
    """Walls with what stands before them, rooms and doors."""
    plan = plan_of(there, order)
    doors = [there.back(door.ends).mean(0) for door in plan.doors]
    rooms = [(room.area, room.hidden) for room in plan.rooms]
    lines = np.concatenate([plan.walls.segments, plan.clutter.segments])
    return {"segments": there.back(lines), "rooms": rooms, "doors": doors}


def placed(map_made_of):
    """Where scans lie on the map of all, by filter and by search."""

    def answer(there):
        map, log, frame = map_made_of(there), there.log, there.frame
        beliefs = list(matching.localize(map, log, rng=np.random.default_rng(0)))
        places = [matching.search(map, log[k]) for k in np.flatnonzero(shows(log))[[4, -1]]]
        assert all(place.found for place in places) and all(b.found for b in beliefs[-8:])
        poses = there.poses_back([belief.pose for belief in beliefs])[-8:]
        flip = (1, -1, -1) if there.mirrored else (1, 1, 1)
        best = between(frame, [place.poses[0] for place in places]) * flip
        return {"poses": poses, "search": best}

    return answer


def filtered(there):
    walls = SegmentMap(reduction.one_per_wall(map_of(there)).segments)
    start, spread = there.log.truth[0], np.diag([0.01, 0.01, 0.001])
    states = matching.localize_ekf(walls, there.log, start, spread)
    return {"poses": there.poses_back([state.pose for state in states])}


def measured(there):
    """What is told of the sensor, of odometry, and of a map that shows walls twice."""
    log, seen = there.log, np.flatnonzero(shows(there.log))
    steps = between(log.truth[seen[:-1]], log.truth[seen[1:]])
    steps[:, 2] += -0.01 if there.mirrored else 0.01
    rows = [
        [*ends, x, y, 0, 0, 0, h] for ends, (x, y, h) in zip(pairwise(seen), steps, strict=True)
    ]
    errors = metrics.relation_errors(np.arange(len(log)), log.odometry, rows)
    aside = compose(there.frame, (0.3, 0, 0)) - there.frame
    twice = log.truth + np.where(np.cumsum(shows(log))[:, None] % 2, aside, 0.0)
    doubled = metrics.doubled_walls(build_map(log, twice, keep_points=True))
    return {"noise": sensor_noise(log).range_m, "doubled": doubled, "errors": errors}


MEMBERS = {
    **{name: aligned(method) for name, method in alignment.METHODS.items()},
    "usual": aligned(usual),
    "without wheels": aligned(without_wheels),
    **{name: reduced(name) for name in reduction.METHODS},
    "map": lambda there: {"segments": there.back(map_of(there).segments)},
    "deskew": deskewed,
    "quadtree": occupied,
    "plan": planned,
    "doubt of the plan": lambda there: {"doubt": plan_of(there).doubt},
    "on segments": placed(map_of),
    "on a quadtree": placed(tree_of),
    "localize_ekf": filtered,
    "measures": measured,
}
#: Beams have times of their own only where the robot moves meanwhile.
OWN_LOG = {"deskew": {"step": 0.1, "moving": True}}
TURNED, QUARTER, MIRRORED = "turned and moved", "a quarter turn, whole cells", "mirrored"
EMPTY, LATE = "empty scans between", "times + 1.7e9"
#: Metres and radians by which a member may differ, and by which it may under one change; else 1e-9.
BOUNDS = {
    # An iteration stops elsewhere.
    ("segment_icp", MIRRORED): 2e-3,
    ("pose_graph", MIRRORED): 1e-5,
    ("usual", MIRRORED): 1e-5,
    ("without wheels", MIRRORED): 1e-7,
    ("fuzzy_clustering", MIRRORED): 2e-3,
    # The motion to an empty scan counts: as the last one that is known, for the noise of wheels.
    ("without wheels", EMPTY): 1e-3,
    ("localize_ekf", EMPTY): 2e-3,
    # A time of 1.7e9 s is known to a quarter of a microsecond.
    ("deskew", LATE): 1e-5,
    # Squares lie otherwise: of the quadtree, and of looks at doubled walls.
    **{("quadtree", change): 0.25 for change in (TURNED, QUARTER, MIRRORED)},
    **{("plan", change): 0.1 for change in (TURNED, QUARTER, MIRRORED)},
    ("measures", TURNED): 0.1,
    # Noise is that of neighbours in the order of storing, and of some of the scans.
    ("measures", "turn begins elsewhere"): 1e-3,
    ("measures", EMPTY): 1e-3,
    # Beams are chosen by their order, poses by chance or on cells of 5 cm.
    **{(name, change): 0.06 for name in ("on segments", "on a quadtree") for change in CHANGES},
}
#: Its squares lie along the axes.
LEFT_OUT = {("fuzzy_clustering", TURNED), ("fuzzy_clustering", QUARTER)}


def assert_same(answer, unchanged, bound=1e-9):
    """Every part of the answer is that of the log without the change, within metres or radians."""
    for name, part in unchanged.items():
        if name == "segments":
            assert_segments_equal(answer[name], part, atol=bound)
        elif isinstance(part, str):
            assert answer[name] == part
        else:
            np.testing.assert_allclose(answer[name], part, rtol=0, atol=bound, err_msg=name)


@cache
def unchanged(name):
    return MEMBERS[name](world(**OWN_LOG.get(name, {})))


CASES = [case for case in product(MEMBERS, CHANGES) if case not in LEFT_OUT]


@pytest.mark.parametrize(("name", "change"), CASES)
def test_what_does_not_matter_does_not_alter_the_answer(name, change):
    """Catches a frame, a mounting, an order of beams, a clock, an empty scan that is forgotten."""
    answer = MEMBERS[name](world(change, **OWN_LOG.get(name, {})))
    assert_same(answer, unchanged(name), BOUNDS.get((name, change), 1e-9))


# ------------------------------------------------------------------------- ways in
def carmen(log, folder):
    exports.write_carmen(folder / "it.log", log)
    return read(folder / "it.log")


def arrays(log, folder):
    exports.write_arrays(folder / "it.npz", log)
    return read(folder / "it.npz")


def table(log, folder, unit="m", per_metre=1.0, turn="rad", per_radian=1.0):
    """A row a beam, with the pose of the laser, which such a table knows nothing else of."""
    rows = [
        f"{k},{scan.time:.7f},{x * per_metre!r},{y * per_metre!r},{heading * per_radian!r},"
        f"{angle * per_radian!r},{distance * per_metre if distance < 6 else 0!r}"
        for k, scan in enumerate(log)
        for x, y, heading in [compose(scan.odometry, scan.sensor_pose).tolist()]
        for angle, distance in zip(scan.angles.tolist(), scan.ranges.tolist(), strict=True)
    ]
    names = f"pose_x_{unit},pose_y_{unit},pose_theta_{turn},angle_{turn},range_{unit}"
    (folder / "it.csv").write_text("\n".join([f"scan,time_s,{names}", *rows]) + "\n")
    return read(folder / "it.csv")


WAYS = {"CARMEN": carmen, "NPZ": arrays, "table": table}
#: CARMEN's beams count up.
NO_LINE_FOR_IT = {("CARMEN", "beams reversed")}
UNITS = {
    "mm": ("mm", 1e3),
    "cm": ("cm", 1e2),
    "ft": ("ft", 1 / 0.3048),
    "in": ("in", 1 / 0.0254),
    "degrees": ("m", 1.0, "deg", 180 / np.pi),
    "clockwise": ("m", 1.0, "rad_cw", -1.0),
}


def mapped(there: World):
    """What a user has in the end: walls, rooms, verdict."""
    result = usual(there.log)
    map = build_map(there.log, result)
    walls, tree = (
        reduction.one_per_wall(map),
        quadtree.build_map(there.log, result, resolution=0.05, free_resolution=0.05),
    )
    areas = [room.area for room in floor_plan(walls, tree).rooms]
    grade = result.verdict_on(map).grade
    return {"segments": there.back(walls.segments), "areas": areas, "grade": grade}


@pytest.fixture(scope="module")
def read_by(tmp_path_factory):
    """The answer of the log as a way in reads it."""
    folder = tmp_path_factory.mktemp("ways")
    return cache(lambda way: mapped(World(WAYS[way](world().log, folder))))


@pytest.mark.parametrize(
    ("way", "change"), [case for case in product(WAYS, CHANGES) if case not in NO_LINE_FOR_IT]
)
def test_a_file_of_the_changed_log_gives_the_same_map(way, change, read_by, tmp_path):
    """Catches a reader or writer that passes over where the laser sits, or where a turn begins."""
    there = world(change)
    answer = mapped(there._replace(log=WAYS[way](there.log, tmp_path)))
    assert_same(answer, read_by(way), 0.02 if change in (TURNED, QUARTER, MIRRORED) else 1e-4)


@pytest.mark.parametrize("unit", UNITS)
def test_a_table_in_another_unit_gives_the_same_map(unit, read_by, tmp_path):
    """Catches a unit that one of the columns does not know, and beams that are mirrored by it."""
    assert_same(mapped(World(table(world().log, tmp_path, *UNITS[unit]))), read_by("table"))


# -------------------------------------------------------------------- orders and labels
#: Offline, and yet the order of segments decides: the first one takes the others in.
BY_ORDER = {"basic_offline", "fuzzy_set"}


def relabelled(map, label, order):
    """The map with other numbers of scans, and its segments in another order."""
    sensors = np.full((label.max() + 1, 2), np.nan)
    sensors[label] = map.sensors
    rows = [map.points[map.first[k] : map.first[k + 1]] for k in order]
    first = np.append(0, np.cumsum([len(row) for row in rows]))
    behind = {"points": np.concatenate(rows), "first": first, "sensors": sensors}
    return SegmentMap(map.segments[order], label[map.scan[order]], **behind)


@pytest.mark.parametrize("name", reduction.METHODS)
def test_numbers_of_scans_and_the_order_of_segments_are_names_only(name):
    """Catches a count of scans taken from their largest number, and a row taken for a segment."""
    map, method, rng = map_of(world()), reduction.METHODS[name], np.random.default_rng(3)
    label, order = 3 * np.arange(len(map.sensors)) + 2, np.lexsort((rng.random(len(map)), map.scan))
    if not method.online and name not in BY_ORDER:
        label, order = rng.permutation(label), rng.permutation(order)
    assert_segments_equal(method(relabelled(map, label, order)).segments, method(map).segments)


def test_rooms_do_not_depend_on_the_order_of_walls():
    """Catches rooms and doors that are numbered by the walls around them."""
    assert_same(planned(world(), slice(None, None, -1)), unchanged("plan"))
