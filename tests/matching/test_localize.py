"""A robot on a known map while it drives: found, kept, lost, and found again."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import scipy
from conftest import slow
from segmap_course import literal

from segmap import Log, load
from segmap.angles import wrap
from segmap.extraction import build_map as drawn
from segmap.matching import _localize as inner
from segmap.matching import localize
from segmap.matching._likelihoods import Likelihoods
from segmap.poses import compose, transform
from segmap.quadtree import build_map
from segmap.scans import LaserScan
from segmap.segments import SegmentMap
from segmap.simulation import (
    URG_04LX,
    OdometryNoise,
    Sensor,
    box,
    drifting_odometry,
    drive,
    office,
    simulate,
    square_room,
)

ROOM = SegmentMap(np.concatenate([square_room(4), box(0.5, 0.8, (3, 3, 0.2))]))
ROUND = Sensor("round", 72, -np.pi, np.pi / 36, max_range=30.0, sigma=0.01)
#: A drive through all rooms of an office.
ROUTE = [(0.7, 5), (11.3, 5), (10, 5), (10, 7.4), (10, 5), (10, 2.6), (10, 5), (6, 5), (6, 7.4),
         (6, 5), (6, 2.6), (6, 5), (2, 5), (2, 7.4), (2, 5), (2, 2.6), (2, 5)]  # fmt: skip


def rng(seed):
    return np.random.default_rng(seed)


def seen(walls, pose):
    """The scan from a pose."""
    return simulate(walls, [pose], sensor=ROUND, rng=rng(1))[0]


def with_odometry(log, seed):
    """Scans with an odometry that drifts, in a frame of its own."""
    drifted = drifting_odometry(log.truth, odometry_noise=OdometryNoise(), rng=rng(seed))
    frame = compose((5.0, -3.0, 2.0), drifted)
    return [replace(scan, odometry=pose) for scan, pose in zip(log, frame, strict=True)]


def office_drive(seed, scans=14, sensor=URG_04LX):
    """An office as a drive has mapped it, and scans of another day every 0.4 m with their poses."""
    walls, path = office(rng=rng(seed)), drive(ROUTE, step=0.4)
    log = simulate(walls, drive(ROUTE, step=0.2), sensor=sensor, rng=rng(seed + 50))
    begin = int(rng(seed + 60).integers(len(path) - scans))
    again = simulate(walls, path[begin : begin + scans], sensor=sensor, rng=rng(seed + 70))
    return build_map(log, log.truth), with_odometry(again, seed), again.truth


def away(belief, pose):
    return np.hypot(*(belief.pose - pose)[:2])


@pytest.mark.parametrize("count", [4, slow(30)])
def test_a_drive_through_an_office_ends_found_and_is_never_found_wrong(count):
    """Six equal rooms, another noise, odometry that drifts in a frame of its own."""
    undecided = []
    for seed in range(count):
        map, scans, truth = office_drive(seed)
        beliefs = list(localize(map, scans, rng=rng(seed)))
        for belief, pose in zip(beliefs, truth, strict=True):
            assert not belief.found or away(belief, pose) < 0.3, seed
            assert belief.weights.sum() == pytest.approx(1.0)
            assert 0 < belief.share <= 1 + 1e-9 and np.linalg.eigvalsh(belief.covariance)[0] > 0
        assert away(beliefs[-1], truth[-1]) < 0.1, seed
        if not beliefs[-1].found:  # two rooms whose scans all but agree: it says so
            assert beliefs[-1].reason == "not yet: 2 places" and beliefs[-1].share > 0.9
            undecided.append(seed)
    assert len(undecided) <= 1


@pytest.mark.parametrize("seeds", [range(3), slow(range(40))])
def test_a_robot_that_is_carried_away_says_so_and_is_found_again(seeds):
    """Odometry knows nothing of it: not found within two scans, at the new place soon after."""
    again, kept, undecided = [], [], []
    for seed in seeds:
        map, scans, truth = office_drive(seed, 40)
        far = np.hypot(*(truth[12:30] - truth[10])[:, :2].T).argmax() + 12  # and go on there
        moved = replace(scans[far], odometry=scans[10].odometry)
        shift = compose(scans[10].odometry, (0.0, 0.0, 0.0))
        after = [moved]
        for before, scan in pairwise(scans[far:]):
            step = inner.between(before.odometry, scan.odometry)
            shift = compose(shift, step)
            after.append(replace(scan, odometry=shift))
        true = [*truth[:11], *truth[far:]]
        beliefs = list(localize(map, [*scans[:11], *after], rng=rng(seed)))
        kept.append(beliefs[10].found and away(beliefs[10], truth[10]) < 0.3)
        assert any(not belief.found for belief in beliefs[11:13])
        good = [b.found and away(b, p) < 0.3 for b, p in zip(beliefs, true, strict=True)][11:]
        again.append(good.index(True) if any(good) else 99)
        if not any(good):  # two places that look alike: the right one leads, and it says so
            undecided.append(seed)
            assert beliefs[-1].reason == "not yet: 2 places" and away(beliefs[-1], true[-1]) < 0.3
    assert np.mean(kept) >= 0.9
    assert np.mean(np.array(again) <= 5) >= (0.6 if len(seeds) < 40 else 0.85)
    assert max(a for a in again if a < 99) <= 20
    assert len(undecided) <= 1


def test_a_scan_that_no_place_explains_is_lost():
    """A wall of ten metres on the map of a room of four. Catches places asked where none are."""
    far = simulate(box(20, 20, (0, 0, 0)), [(0, 0, 0)], sensor=ROUND, rng=rng(1))[0]
    for scan in (far, replace(far, odometry=np.zeros(3))):
        beliefs = list(localize(ROOM, [scan, scan], rng=rng(1)))
        assert all("lost" in belief.reason for belief in beliefs)


#: Half of a hall: two walls and a box; the other half is the same, turned by half a turn.
HALF = [[(4, 0), (4, 3)], [(8, 5), (8, 8)], *box(1, 1, (2.5, 6.5, 0))]


@pytest.mark.parametrize("kind", ["walls", "squares"])
@pytest.mark.parametrize("count", [3, slow(8)])
def test_a_hall_of_two_equal_halves_is_never_found_but_with_a_box_in_one(kind, count):
    """Both places explain every scan. Catches a place that only chance has taken away."""
    both = [*HALF, *(np.array([20, 8]) - np.array(HALF))]
    hall = np.concatenate([box(20, 8, (10, 4, 0)), both])
    round_ = replace(ROUND, beams=180, step=np.radians(2), max_range=12.0)
    for boxed in (False, True):
        walls = np.concatenate([hall, box(0.8, 0.6, (5.4, 1.3, 0))]) if boxed else hall
        whole = simulate(walls, drive([(1.5, 4), (18.5, 4)], step=0.25), sensor=round_, rng=rng(1))
        map = SegmentMap(walls) if kind == "walls" else build_map(whole, whole.truth)
        for seed in range(count):
            path = drive([(1.5, 4), (9, 4)], step=0.25)
            way = simulate(walls, path, sensor=round_, rng=rng(seed))
            beliefs = list(localize(map, with_odometry(way, seed), rng=rng(seed)))
            found = [away(b, p) for b, p in zip(beliefs, way.truth, strict=True) if b.found]
            if boxed:
                assert len(found) >= 5 and max(found) < 0.3, seed
            else:
                assert not found and beliefs[-1].reason == "not yet: 2 places", seed


def test_a_robot_that_turns_fast_without_odometry_is_searched_again():
    """30 degrees a scan, its particles may turn by 6: `search` finds it in most scans."""
    found = []
    for seed in range(3):
        walls = office(rng=rng(seed))
        log = simulate(walls, drive(ROUTE, step=0.2), sensor=URG_04LX, rng=rng(seed + 50))
        path = drive(ROUTE, step=0.1)[40:70].copy()
        path[:, 2] = np.radians(30) * np.arange(len(path))
        scans = simulate(walls, path, sensor=URG_04LX, rng=rng(seed))
        beliefs = localize(build_map(log, log.truth), scans, rng=rng(seed))
        told = [(b.found, away(b, p)) for b, p in zip(beliefs, path, strict=True)]
        found += [f for f, _ in told]
        assert not any(f and off > 0.5 for f, off in told), seed
    assert np.mean(found) >= 0.4


@pytest.mark.parametrize("kind", ["segments", "squares"])
def test_on_a_real_map_it_is_found_where_it_is_right_and_nowhere_else(kind):
    """Malaga, where a third of the beams meet no wall; and the robot beside the half of the map.

    Catches a fit of beams that no map can explain, and one that fits to anything.
    """
    log = load("malaga")
    rows = np.flatnonzero(np.isfinite(log.truth).all(1))
    log = Log("known", [log[int(k)] for k in rows], log.truth[rows])

    def map_of(part):
        if kind == "squares":
            return build_map(part, part.truth, resolution=0.05)
        return drawn(part, part.truth)

    def asked(map, part):
        beliefs = list(localize(map, part, rng=rng(1)))
        right = [away(b, p) < 0.3 for b, p in zip(beliefs, part.truth, strict=True)]
        return np.array(right), np.array([b.found for b in beliefs])

    right, found = asked(map_of(log), log)
    assert right.mean() > 0.9 and not (found & ~right).any()
    assert found.sum() >= 0.85 * right.sum()
    right, found = asked(map_of(log[:50]), log[50:])
    assert not (found & ~right).any()


def test_as_many_particles_are_drawn_as_the_literal_filter_draws():
    """Catches a cell counted twice."""
    random = rng(3)
    for wide in (0.01, *np.linspace(0.09, 0.2, 30), 9.0):
        poses = random.normal(0, wide, (1500, 3))
        assert inner.kld_sample_size(poses) == literal.enough(poses.tolist())
    far = random.integers(-3, 4, (3000, 3)) * (2.5e8, 2.5e8, 0.2)
    assert inner.kld_sample_size(far) == literal.enough(far.tolist())


@pytest.mark.parametrize("kind", ["walls", "squares"])
def test_poses_are_weighed_as_arrays_weigh_them(kind):
    """On the map, beside it and far beyond. Catches a cell beside, an edge, a part left out."""
    scans = simulate(ROOM.segments, drive([(1, 1), (3, 1)], step=0.3), sensor=ROUND, rng=rng(1))
    map = Likelihoods(ROOM if kind == "walls" else build_map(scans, scans.truth))
    for seed, (count, wide) in enumerate([(1, 0.1), (2, 3), (50, 1), (999, 1e7), (8001, 0.3)]):
        points = rng(seed).permutation(scans[0].points())[: 1 + 20 * seed]
        poses = scans.truth[0] + rng(seed).normal(0, wide, (count, 3))
        worth = 0.9 * map.likelihood(transform(poses, points)) + 0.1
        expected = np.exp(np.log(worth).mean(1))
        np.testing.assert_allclose(map.fits(points, poses), expected, rtol=1e-12, atol=0)


@pytest.mark.parametrize("seed", range(4))
def test_the_whole_run_is_that_of_the_literal_filter(seed):
    """From nowhere, and carried away after three scans: each particle and weight, scan by scan."""
    map, few = Likelihoods(ROOM), Sensor("few", 60, -np.pi, np.pi / 30, max_range=30.0, sigma=0.01)
    path = [*drive([(1, 1), (2, 1)], step=0.3)[:3], *[(2.8, 1.2, 1.6)] * 3]
    log = simulate(ROOM.segments, path, sensor=few, rng=rng(seed))
    scans = with_odometry(log, seed)
    scans[3:] = [replace(scan, odometry=scans[2].odometry) for scan in scans[3:]]
    drawn, searched, sizes = rng(seed), [], set()

    def fresh(points, count):
        searched.append(count)
        return inner.fresh_poses(map, np.array(points), count, drawn).tolist()

    steps = literal.localize(
        [(scan.points().tolist(), scan.odometry.tolist()) for scan in scans],
        lambda place: float(map.likelihood(np.array(place))),
        fresh, rng=drawn, particles=400,
        on_lines=lambda points, least: inner.on_lines(np.array(points), least).tolist(),
    )  # fmt: skip
    beliefs = localize(ROOM, scans, rng=rng(seed), particles=400)
    for belief, (poses, weights, fit) in zip(beliefs, steps, strict=True):
        np.testing.assert_allclose(belief.weights, weights, atol=1e-9)
        turned = wrap(belief.poses[:, 2] - np.array(poses)[:, 2])
        np.testing.assert_allclose(belief.poses[:, :2], np.array(poses)[:, :2], atol=1e-9)
        assert np.abs(turned).max() < 1e-9 and belief.fit == pytest.approx(fit)
        sizes.add(len(weights))
    assert len(searched) >= 2 and len(sizes) >= 2


STILL = np.zeros(3)


@pytest.mark.parametrize(
    ("way", "errors"),
    [
        *((None, (0.1, 0.1, 0.1)), (STILL, (0.02, 0.02, 0.01))),
        *(((3, -4, 0), (0.52, 0.52, 0.26)), ((0, 0, -2), (0.02, 0.02, 0.21))),
    ],
)
def test_particles_move_by_the_odometry_with_its_errors(way, errors):
    """At rest, for each metre and for each radian; 0.1 m and 0.1 rad where there is none.

    Once it is found one of eighteen is off by three times as much: normal errors lose a robot
    whose wheels slip.
    """
    first = LaserScan([], [], odometry=None if way is None else STILL)
    second = LaserScan([], [], odometry=way)
    poses, random = np.zeros((20_000, 3)), rng(1)
    moved = inner.predict(poses, (first, second), np.zeros(3), random, found=False)
    np.testing.assert_allclose(moved.std(0), errors, rtol=0.03)
    np.testing.assert_allclose(moved.mean(0), STILL if way is None else way, atol=0.02)
    kept = inner.predict(poses, (first, second), np.zeros(3), random, found=True)
    usual = scipy.stats.t(3).ppf(0.75)  # half of the errors are smaller
    np.testing.assert_allclose(np.median(abs(kept - kept.mean(0)), 0) / usual, errors, rtol=0.04)
    assert (abs(kept[:, 0] - kept[:, 0].mean()) > 3 * errors[0]).mean() > 0.05
    np.testing.assert_allclose(np.median(kept, 0), STILL if way is None else way, atol=0.02)
    assert inner.predict(poses, (None, second), np.zeros(3), random, found=True) is poses


def test_a_robot_without_odometry_goes_on_as_it_went():
    """0.4 m a scan: particles that begin where it was lag behind, 2 cm in the mean."""
    walls = office(rng=rng(2))
    log = simulate(walls, drive(ROUTE, step=0.2), sensor=URG_04LX, rng=rng(3))
    scans = simulate(walls, drive(ROUTE, step=0.4)[:60], sensor=URG_04LX, rng=rng(4))
    unled = [replace(scan, odometry=None) for scan in scans]
    beliefs = list(localize(build_map(log, log.truth), unled, rng=rng(5)))[1:]
    poses, found = np.array([b.pose for b in beliefs]), np.array([b.found for b in beliefs])
    steps, errors = np.diff(scans.truth[:, :2], axis=0), (poses - scans.truth[1:])[:, :2]
    ways = np.hypot(*steps.T)
    ahead = (errors * steps).sum(1)[found].sum() / ways[found].sum()
    assert found.mean() > 0.9 and abs(ahead) < 0.01


def test_odometry_in_every_second_scan_is_none():
    """Catches a way that is taken for driven since one of its two ends has odometry."""
    log = load("room")
    some = [replace(scan, odometry=None) if k % 2 else scan for k, scan in enumerate(log)]
    beliefs = localize(build_map(log, log.truth), some, rng=rng(1))
    assert np.mean([belief.found for belief in beliefs]) > 0.9


def test_the_places_of_a_belief():
    """Two heaps of particles are two places until one is dead; headings about pi are one."""
    heap = rng(1).normal(0, 0.05, (100, 3)) + (1, 2, np.pi)
    heap[:, 2] = wrap(heap[:, 2])
    poses = np.concatenate([heap, heap[:50] + (3, 0, 0)])

    def believed(far, fit, least):
        weights = np.r_[np.full(100, (1 - far) / 100), np.full(50, far / 50)]
        return inner.estimate(poses, weights, inner.at_places(poses, weights), fit, least)

    even = believed(1 / 3, 0.95, 0.9)
    assert even.reason == "not yet: 2 places" and even.share == pytest.approx(2 / 3)
    np.testing.assert_allclose(even.pose[:2], heap[:, :2].mean(0))
    heading = np.pi + wrap(heap[:, 2] - np.pi).mean()
    assert abs(wrap(even.pose[2] - heading)) < 1e-9 and even.covariance[2, 2] < 0.01
    assert believed(0.04, 0.95, 0.9).reason == "not yet: 2 places"  # may be right, one in 25
    assert believed(0.029, 0.8, 0.8).found  # at least so well


def test_chance_takes_no_place_away():
    """Two equal heaps drawn anew two hundred times: each keeps its weight, and its particles."""
    poses, weights = np.tile([(0.0, 0, 0), (5, 0, 0)], (200, 1)), np.full(400, 1 / 400)
    for seed in range(200):
        uneven = weights * rng(seed).uniform(0, 1, 400) ** 4
        heaps = [uneven * (poses[:, 0] < 1), uneven * (poses[:, 0] > 1)]
        uneven = sum(heap / heap.sum() / 2 for heap in heaps)
        places = inner.at_places(poses, uneven)
        poses, weights = inner.redraw(poses, uneven, places, 400, rng(seed))
        assert weights[poses[:, 0] < 1].sum() == pytest.approx(0.5), seed
        poses, weights = np.tile([(0.0, 0, 0), (5, 0, 0)], (200, 1)), np.full(400, 1 / 400)


def test_blind_scans_and_no_odometry():
    """A scan without ends changes no weight; without odometry a slow robot is kept too."""
    scan = seen(ROOM.segments, (1.2, 1.6, 0.4))
    blind = replace(scan, ranges=np.full(len(scan.ranges), np.inf))
    nothing = next(localize(ROOM, [blind], rng=rng(1)))
    assert "lost" in nothing.reason and not len(nothing.poses) and np.isnan(nothing.pose).all()
    assert nothing.fit == nothing.share == 0
    first, second = localize(ROOM, [scan, blind], rng=rng(1))
    assert second.fit == first.fit > 0.88 and not first.found  # one look is not enough
    assert np.abs(second.pose - first.pose).max() < 0.1
    slowly = simulate(ROOM.segments, drive([(1, 1), (3, 1)], step=0.05), sensor=ROUND, rng=rng(1))
    beliefs = list(localize(ROOM, slowly, rng=rng(2)))
    for belief, pose in zip(beliefs[8:], slowly.truth[8:], strict=True):
        assert belief.found and away(belief, pose) < 0.1
    assert max(len(b.poses) for b in localize(ROOM, slowly, rng=rng(2), particles=400)) <= 800


@pytest.mark.parametrize("blind", [1, 2, 5])
def test_what_it_drives_while_it_sees_nothing_counts_once(blind):
    """By the odometry alone, and seen again at the end.

    Catches a way that is driven again from the last scan that saw something.
    """
    path = drive([(1, 1), (3, 1)], step=0.2)[: 3 + blind]
    log = simulate(ROOM.segments, path, sensor=ROUND, rng=rng(1))
    scans = [replace(scan, odometry=pose) for scan, pose in zip(log, path, strict=True)]
    scans[2:-1] = [replace(s, ranges=np.full(len(s), np.inf)) for s in scans[2:-1]]
    for belief, pose in zip(localize(ROOM, scans, rng=rng(1)), path, strict=True):
        assert away(belief, pose) < 0.08
