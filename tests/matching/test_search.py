"""One scan on a whole map: branch and bound against every pose, symmetry, and what is not found."""

import numpy as np
import pytest
from conftest import slow
from segmap_course import literal

from segmap.angles import wrap
from segmap.matching import Places, search
from segmap.poses import compose, transform
from segmap.quadtree import QuadtreeMap, build_map
from segmap.scans import LaserScan
from segmap.segments import SegmentMap
from segmap.simulation import (
    SICK_LMS200,
    Sensor,
    box,
    city,
    corridor_loop,
    drive,
    office,
    simulate,
    square_room,
)

ROUND = Sensor("round", 72, -np.pi, np.pi / 36, max_range=30.0, sigma=0.01)
#: A drive through all rooms of an office.
ROUTE = [(0.7, 5), (11.3, 5), (10, 5), (10, 7.4), (10, 5), (10, 2.6), (10, 5), (6, 5), (6, 7.4),
         (6, 5), (6, 2.6), (6, 5), (2, 5), (2, 7.4), (2, 5), (2, 2.6), (2, 5)]  # fmt: skip


def rng(seed):
    return np.random.default_rng(seed)


def scan_of(points):
    return LaserScan(np.hypot(*points.T), np.arctan2(*points.T[::-1]))


def seen(walls, pose, sensor=ROUND, seed=1):
    """The scan from a pose."""
    return simulate(walls, [pose], sensor=sensor, rng=rng(seed))[0]


def cells_of(map, wide=0.5):
    """Likelihoods of a quadtree's cells for the literal search, shape and corner, by every pair."""
    leaves = map.leaves()
    occupied = np.stack([leaves.x, leaves.y], -1)[2 * leaves.occ > leaves.vis]
    at = np.rint((occupied - map.corner) / map.resolution).astype(int)
    edge = int(np.ceil(wide / map.resolution))
    first, last = at.min(0) - edge, at.max(0) + edge + 1
    values = {}
    for i, j in np.ndindex(*(last - first)):
        away = map.resolution * np.hypot(*(at - first - (i, j)).T).min()
        values[i, j] = literal.likelihood(away)
    return values, tuple((last - first).tolist()), map.corner + first * map.resolution


def small_map(seed):
    """A few strokes of wall on coarse cells."""
    random = rng(seed)
    map = QuadtreeMap(resolution=0.1, corner=random.uniform(-1, 1, 2))
    for _ in range(3):
        start, way = random.uniform(0, 0.8, 2), random.uniform(-0.6, 0.6, 2)
        ends = start + np.linspace(0, 1, 12)[:, None] * way
        map.insert_scan(start, ends)
    return map, random


@pytest.mark.parametrize("seed", range(3))
def test_search_is_every_pose_tried(seed):
    """Catches a block that is passed over, a bound too low at an edge, a margin or a heading that
    is missed, and a place that is told twice."""
    map, random = small_map(seed)
    points = random.uniform(-1, 1, (7, 2))
    cells, shape, corner = cells_of(map)
    count = literal.headings(points, 0.1)
    scored = list(literal.every_pose(cells, shape, points, 0.1, count))
    full = 255 * len(points)
    best = max(total for total, _ in scored) / full  # at least so much, to the last part
    for margin, least in ((0.0, 0.0), (0.05, 0.3), (0.12, 0.5), (0.05, best)):
        asked = int(margin * full + 1e-9), int(np.ceil(least * full - 1e-9))
        expected = literal.places(scored, 0.1, count, *asked)
        found = search(map, scan_of(points), margin=margin, least=least, most_places=999)
        assert not found.found or len(expected) == 1
        np.testing.assert_allclose(found.scores * full, [total for total, _ in expected])
        poses = np.array([pose for _, pose in expected]).reshape(-1, 3)
        np.testing.assert_allclose(found.poses[:, :2], corner + (poses[:, 1:] + 0.5) * 0.1)
        turned = wrap(found.poses[:, 2] - 2 * np.pi * poses[:, 0] / count)
        np.testing.assert_allclose(turned, 0, atol=1e-9)


@pytest.mark.parametrize("kind", ["walls", "squares"])
@pytest.mark.parametrize("seed", range(3))
def test_a_square_room_has_four_places(kind, seed):
    """Never found, and the true one is among the four, which are quarter turns of each other."""
    walls, random = square_room(4.0), rng(seed)
    pose = (*random.uniform(0.8, 1.6, 2), random.uniform(-3, 3))
    map = SegmentMap(walls)
    if kind == "squares":
        log = simulate(walls, drive([(1, 1), (3, 1), (3, 3)]), sensor=ROUND, rng=rng(seed))
        map = build_map(log, log.truth)
    found = search(map, seen(walls, pose, seed=seed))
    assert len(found) == 4 and not found.found and "4 places" in repr(found)
    turns = np.arange(4) * np.pi / 2
    four = compose([(2, 2, turn) for turn in turns], np.subtract(pose, (2, 2, 0)))
    away = np.hypot(*(found.poses[:, None, :2] - four[:, :2]).transpose(2, 0, 1))
    assert sorted(away.argmin(1)) == [0, 1, 2, 3] and away.min(1).max() < 0.08
    turned = wrap(found.poses[:, 2] - four[away.argmin(1), 2])
    assert np.abs(turned).max() < 0.05


@pytest.mark.parametrize("count", [5, slow(50)])
def test_a_scan_of_another_building_is_never_found(count):
    """Streets, an office and a ring of corridors: catches `found` that looks at the score alone."""
    buildings = {
        "office": (office(rng=rng(1)), ROUTE),
        "city": (city(2, 2, rng=rng(1)), [(1.5, 1.5), (1.5, 20.5), (20.5, 20.5), (20.5, 1.5)]),
        "ring": (corridor_loop(), [(1, 1), (29, 1), (29, 11), (1, 11), (1, 1.5)]),
    }
    logs = {
        name: simulate(walls, drive(path, step=0.3), sensor=SICK_LMS200, rng=rng(2))
        for name, (walls, path) in buildings.items()
    }
    for here, log in logs.items():
        map = build_map(log, log.truth)
        for there in logs.keys() - {here}:
            for k in rng(3).choice(len(logs[there]), count, replace=False):
                assert not search(map, logs[there][int(k)]).found, (here, there, k)


def test_the_covariance_holds_the_error_and_grows_along_a_corridor():
    """Errors are within three standard deviations; a wall without end fixes nothing along it."""
    walls, random = np.concatenate([box(6, 4), box(0.7, 0.5, (1, 0.6, 0.5))]), rng(2)
    map, errors = SegmentMap(walls), []
    for seed in range(20):
        pose = np.array([*random.uniform(-1, 0.2, 2), random.uniform(-3, 3)])
        found = search(map, seen(walls, pose, seed=seed))
        error = found.poses[0] - pose
        error[2] = wrap(error[2])
        errors.append(error @ np.linalg.solve(found.covariances[0], error) / 3)
    assert 0.1 < np.mean(errors) < 1.5 and max(errors) < 5
    long = search(SegmentMap([[(-50, 1), (50, 1)], [(-50, -1), (50, -1)]]), scan_of(
        np.stack([np.tile(np.linspace(-1, 1, 9), 2), np.repeat([1.0, -1.0], 9)], -1)))  # fmt: skip
    along, across, _ = np.diag(long.covariances[0])
    assert along > 5 * across and not long.found


def test_fewer_beams_spread_along_the_walls():
    """A near wall of many ends and a far one of few, equally long: both count as much."""
    near = np.stack([np.linspace(0, 2, 180), np.ones(180)], -1)
    far = np.stack([np.linspace(8, 10, 20), np.full(20, 9.0)], -1)
    scan = scan_of(np.concatenate([near, far]))
    for wall in ([(0, 1), (2, 1)], [(8, 9), (10, 9)]):  # half of the beams are explained
        known = SegmentMap([wall, [(0, -0.1), (0.05, -0.1)]])  # and where the robot stands
        found = search(known, scan, beams=40, least=0.3, most_places=99)
        assert found.scores[0] == pytest.approx(0.5, abs=0.08)
    assert len(search(SegmentMap([[(0, 1), (2, 1)]]), scan_of(np.ones((9, 2))), beams=3)) > 0


@pytest.mark.parametrize(("more", "found"), [(-1e-3, True), (1e-3, False)])
def test_a_place_is_found_where_it_scores_as_much_as_asked(more, found):
    map = SegmentMap(np.concatenate([square_room(4), box(0.5, 0.8, (3, 3, 0.2))]))
    scan = seen(map.segments, (1.2, 1.6, 0.4))
    assert search(map, scan, least=search(map, scan).scores[0] + more).found == found


def test_it_says_why_nothing_is_found():
    map = SegmentMap(np.concatenate([square_room(4), box(0.5, 0.8, (3, 3, 0.2))]))
    scan = seen(map.segments, (1.2, 1.6, 0.4))
    assert search(map, scan).found and search(map, scan).reason == ""
    place = np.array([(1.25, -1e-9, np.pi / 2)]), np.array([0.9]), np.ones(1), np.eye(3)[None]
    assert repr(Places(*place, "so", 9)) == "Places(1.25 m, 0 m, 90 deg, score 0.90; so)"
    blind = search(map, LaserScan([np.inf], [0.0]))
    assert isinstance(blind, Places) and not len(blind) and "no beam" in repr(blind)
    wide = scan_of(transform((0, 0, 0), scan.points() * 3))
    assert "no pose scores 0.9" in search(map, wide, least=0.9).reason
    four = search(map, scan, margin=0.4, most_places=2)
    assert len(four) == 2 and four.reason == "more than 2 places explain it"
    single = search(SegmentMap([[(0, 0), (200, 0)]]), LaserScan([1.0], [0.0]))
    assert "more than 65536 poses" in single.reason
    moved = seen(np.concatenate([square_room(4), *(box(0.9, 0.9, (x, 0.6, x)) for x in (1, 2, 3))]),
                 (1.2, 2.6, 0.4))  # fmt: skip
    assert "fits it to 0." in search(map, moved, margin=0.0).reason


@pytest.mark.parametrize("end", [(-0.6, 0.0), (0.0, -0.6)])
def test_no_place_lies_beyond_half_a_metre_around_the_map(end):
    """One cell; at the first heading the end is on it from six cells away, where five are tried."""
    map = QuadtreeMap(resolution=0.1)
    map.insert_scan((0.05, 0.05), [(0.05, 0.05)])
    found = search(map, scan_of(np.array([end])), most_places=99)
    assert len(found) > 3 and np.abs(found.poses[:, :2] - 0.05).max() < 0.51


def test_beams_without_end_and_maps_far_away():
    """A range of 1e90 m overflows nothing; a map a thousand kilometres off is searched as well."""
    walls = np.concatenate([square_room(4), box(0.5, 0.8, (3, 3, 0.2))])
    scan = seen(walls, (1.2, 1.6, 0.4))
    odd = LaserScan([1e90, *scan.ranges], [0.1, *scan.angles])
    assert search(SegmentMap(walls), odd).found
    far = search(SegmentMap(walls + 1e6), scan)
    assert far.found and np.abs(far.poses[0, :2] - (1000001.2, 1000001.6)).max() < 0.06
