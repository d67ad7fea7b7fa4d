"""Mapping without odometry: what a live user sees, and how far the poses are off."""

from dataclasses import replace
from functools import partial
from operator import length_hint

import numpy as np
import pytest
from quadtrees import leaves_of, state

from segmap import LaserScan, load
from segmap.matching import (
    distance_score,
    field_score,
    hill_climb,
    map_scans,
    nearest_score,
    occupancy_score,
    sample_and_rank,
)
from segmap.poses import compose, inverse, transform
from segmap.quadtree import QuadtreeMap
from segmap.simulation import Sensor, drive, rectangular_room, simulate

SENSOR = Sensor("it", 181, -np.pi, 2 * np.pi / 181, max_range=6.0, sigma=0.005)


def room_log(scans=8, *, sensor_pose=(0.0, 0.0, 0.0)):
    """A robot that drives through a room, a walk a second."""
    path = drive([(1.2, 1.3), (2.8, 1.7)], step=0.05)[:scans]
    rng = np.random.default_rng(4)
    walls = rectangular_room(4, 3)
    return simulate(walls, path, sensor=SENSOR, rng=rng, sensor_pose=sensor_pose)


def position_errors(steps, truth):
    return np.hypot(*(np.array([step.pose for step in steps]) - truth)[:, :2].T)


def thinning(map, points, start, *, score):
    """A matcher of the user's own: the score must be that of the points asked for."""
    tried = start + np.array([(0, 0, 0), (0.02, 0, 0), (0, -0.02, 0), (0, 0, 0.01)])
    return tried[np.argmax(score(map, points[::3], tried) + score(map, points, tried))]


def walked(log, map, pose, *, matcher, score, settle, free):
    """`map_scans` as its docstring says it, with all rays written out."""
    drawn, centre = 0, np.zeros((1, 2))
    for scan in log:
        points, value, overlap = scan.points(), np.nan, float(len(scan.points()) > 0)
        if len(points) and drawn >= settle:
            pose = matcher(map, points, pose, score=score)
            value = score(map, points, pose)[0]
        if len(points) and drawn:
            ends = np.column_stack([transform(pose, points), 0 * points[:, 0]])
            overlap = np.mean(distance_score(map, centre, ends) >= -0.12 - map.resolution / 2)
        x, y, heading = compose(pose, scan.sensor_pose)
        at = heading + scan.angles[np.isposinf(scan.ranges)]
        unmet = np.stack([x + 6 * np.cos(at), y + 6 * np.sin(at)], -1)
        if len(points):
            map.insert_scan((x, y), transform(pose, points), unmet if free else None)
        drawn += len(points) > 0
        yield pose, value, overlap


@pytest.mark.parametrize("seed", range(4))
def test_it_is_the_plain_loop_with_any_options(seed):
    """Also with blind scans and broken beams, and one scan at a time.

    Catches the sensor's pose left out or used twice, free rays along the robot's heading or where
    the sensor reported an error, an overlap with what the scan itself has drawn, a generator that
    is made anew, a scan that is taken too early, and a pose that is not the user's own.
    """
    rng = np.random.default_rng(seed)
    log = list(room_log(9, sensor_pose=tuple(rng.normal(0, 0.3, 3))))
    for k in range(9):
        ranges = np.where(
            rng.random(181) < 0.2, rng.choice([np.inf, np.nan, 0], 181), log[k].ranges
        )
        blind = k in (seed % 2, 6)
        log[k] = replace(log[k], ranges=np.full(181, np.inf) if blind else ranges)
    options = {
        "settle": [1, 3][seed // 2 % 2],
        "score": [field_score, nearest_score, occupancy_score][seed % 3],
        "free": bool(seed % 2),
    }
    matchers = hill_climb, thinning, sample_and_rank
    again, matcher = np.random.default_rng(seed), matchers[(seed + seed // 3) % 3]
    same = partial(matcher, rng=again) if matcher is sample_and_rank else matcher
    start, source = rng.normal(0, 1, 3), iter(log)
    cells = {"resolution": [0.02, 0.1][seed % 2], "free_resolution": [0.08, 0.1][seed % 2]}
    own = [QuadtreeMap(**cells) for _ in range(2)]
    steps = map_scans(source, map=own[0], start=start, matcher=matcher,
                      rng=np.random.default_rng(seed), **options)  # fmt: skip
    plain = walked(log, own[1], start, matcher=same, **options)
    assert length_hint(source) == len(log)
    for k, (step, (pose, value, overlap)) in enumerate(zip(steps, plain, strict=True)):
        np.testing.assert_allclose(step.pose, pose, atol=1e-12)
        np.testing.assert_allclose(step.score, value, rtol=1e-5, atol=1e-9)
        assert (step.overlap, step.found) == (overlap, overlap >= 0.6)
        assert leaves_of(own[0]) == leaves_of(own[1]) and not step.closed
        assert length_hint(source) == len(log) - k - 1 and 0 < step.seconds < 60
        step.pose[:] = 1e6


def test_a_scan_far_from_all_stays():
    """Nothing of the map within reach: no match, and no error but where the map must end."""
    scans = [LaserScan([1.0, 1.0], [0.0, 0.2]), LaserScan([9.0, 9.1], [3.0, 3.1])]
    map = QuadtreeMap()
    near, far = map_scans(scans, start=(5, 5, 0), map=map, matcher=partial(shifted, by=1.0))
    assert far.pose.tolist() == near.pose.tolist() and np.isnan(far.score)
    assert near.found and not far.found and far.overlap == 0
    assert map.scans == 2
    with pytest.raises(ValueError, match=r"^scan 1: the scan reaches beyond max_size"):
        list(map_scans(room_log(2), matcher=partial(shifted, by=1e4)))


def test_steps_say_where_the_robot_was_lost():
    """Catches a robot that is lost in silence: in the room it turns by 30 degrees from scan 3 on.

    Its way is known to hill climbing where it moves little, as in Malaga.
    """
    maps = [QuadtreeMap(resolution=0.05) for _ in range(2)]
    room = list(map_scans(load("room"), map=maps[0]))
    truth = load("room").truth
    expected = compose(inverse(truth[0]), truth)
    lost = [k for k, step in enumerate(room) if not step.found]
    assert position_errors(room[: lost[0]], expected[: lost[0]]).max() < 0.5
    assert position_errors(room[-1:], expected[-1:])[0] > 2
    malaga = list(map_scans(load("malaga")[:60], map=maps[1]))
    assert all(step.found for step in malaga) and min(step.overlap for step in malaga) > 0.6


def shifted(map, points, start, *, score, by):
    """A matcher that always finds the robot so much farther along x."""
    return start + (by, 0, 0)


#: A scan after two good ones, and what is said of it.
BROKEN = [
    (np.ones(9), "wanted a LaserScan, as a Log or sensor gives, got ndarray"),
    (LaserScan([1.0, np.inf], [0.0, 1.0], max_range=1e4), ".* beyond max_size"),
    *((LaserScan([1.0, m], [0.0, 0.1]), ".*(too large|beyond max_size)") for m in (2e3, 1e4, 1e7)),
]


@pytest.mark.parametrize(("scan", "message"), BROKEN)
def test_a_broken_scan_is_named_and_leaves_the_map(scan, message):
    """Catches half a scan in the map: beams that met nothing count too."""
    map = QuadtreeMap()
    mapping = map_scans([*room_log(2), scan], map=map, free=True)
    next(mapping), next(mapping)
    before = state(map)
    with pytest.raises(ValueError, match=f"^scan 2: {message}"):
        next(mapping)
    assert state(map) == before


def path_errors(workloads, seed, **options):
    """Median and largest position error on the room path, and the map."""
    sensor, path = workloads.SENSORS["urg"], workloads.path("room", 200)
    rng, walls = np.random.default_rng(seed), workloads.room()
    log = [LaserScan(workloads.scan_at(walls, p, sensor, rng)[0], sensor.angles) for p in path]
    map = QuadtreeMap()
    errors = position_errors(list(map_scans(log, start=path[0], map=map, **options)), path)
    return np.median(errors), errors.max(), len(map.leaves().x)


def test_the_room_path_without_odometry(workloads):
    """The promise: over seeds the median of medians 20 mm, of the largest 50 mm."""
    found = np.array([path_errors(workloads, seed)[:2] for seed in range(2)])
    median, largest = np.median(found, axis=0)
    assert median <= 0.020
    assert largest <= 0.050


def test_walls_that_come_into_view_do_not_make_up_for_a_corridor():
    """Catches scans 52 and 53 called found: their own corner fixes them, .4 and .1 m behind."""
    clinic = load("clinic")[:56]
    steps = list(map_scans(clinic, start=clinic.truth[0]))
    assert not any(step.found for step in steps[47:54]) and steps[54].found


@pytest.mark.parametrize("half, found", [(50.0, False), (2.0, True)])
def test_how_far_along_a_corridor_is_not_known(half, found):
    """Catches a robot that is found, as its scan lies on the map, where no wall tells how far."""
    walls = np.array([[(-half, y), (half, y)] for y in (-1, 1)] + [[(half, -1), (half, 1)]])
    path = np.column_stack([np.arange(0, 0.25, 0.05), np.zeros((5, 2))])
    log = simulate(walls, path, sensor=SENSOR, rng=np.random.default_rng(4))
    steps = list(map_scans(log))
    assert min(step.overlap for step in steps) > 0.7
    assert [step.found for step in steps] == [True] + 4 * [found]
