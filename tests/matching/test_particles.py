"""Mapping with particles: what must hold for any number of them, and what they are there for."""

import itertools
from copy import deepcopy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import segmap_course as course
from conftest import slow
from hypothesis import given
from hypothesis import strategies as st
from quadtrees import leaves_of
from segmap_course import literal

from segmap import LaserScan
from segmap.matching import (
    DistanceField,
    effective_number,
    hill_climb,
    map_scans,
    particle_mapping,
    particle_paths,
    systematic,
)
from segmap.matching import _particles as particles_file
from segmap.matching._live_map import insert_placed, overlap_of
from segmap.poses import between, compose, transform
from segmap.quadtree import QuadtreeMap
from segmap.simulation import OdometryNoise, Sensor, drive, rectangular_room, simulate

SENSOR = Sensor("it", 61, -np.pi, 2 * np.pi / 61, max_range=6.0, sigma=0.005)


def room_log(scans=12, seed=4):
    path = drive([(1.2, 1.3), (2.8, 1.7), (2.0, 2.2)], step=0.25)[:scans]
    return simulate(rectangular_room(4, 3), path, sensor=SENSOR, rng=np.random.default_rng(seed))


def mapped(log, seed=1, *, particles=6, resolution=0.05, **options):
    map = options.pop("map", None) or QuadtreeMap(resolution=resolution)
    rng = np.random.default_rng(seed)
    return list(particle_mapping(log, particles=particles, rng=rng, map=map, **options)), map


def position_errors(poses, truth):
    return np.hypot(*(poses - truth)[..., :2].T)


TURNS = np.outer([0, -0.9, -0.6, -0.3, 0.3, 0.6, 0.9], [0, 0, 1])
AROUND = np.array(list(itertools.product((-0.05, 0, 0.05), (-0.05, 0, 0.05), (-0.01, 0, 0.01))))


def climbed(p, scan, tries):
    """Where hill climbing takes a particle, and the field there."""
    answers, points = [], scan.points()
    for tried in tries:
        try:
            field = DistanceField.around(p.map, points, p.pose + tried)
        except ValueError:
            return p.pose, None
        found = [
            hill_climb(p.map, points, at, score=lambda *given, field=field: field.score(*given[1:]))
            for at in p.pose + tried
        ]
        answers.append((max(found, key=lambda pose: field.score(points, pose)[0]), field))
        if len(tries) == 1 or overlap_of(p.map, scan.points(), answers[-1][0]) >= 0.75:
            return answers[-1]
    return answers[0]


def shares(own):
    weights = np.exp([p.recent for p in own])
    return weights / weights.sum()


def followed(log, map, start, rng, *, particles, odometry, noise, resample):
    """`particle_mapping` with an object for each particle, and the numbers written out."""
    first = SimpleNamespace(pose=np.array(start), map=map, recent=0.0, likely=0.0, drawn=None)
    own, wheels, told = [deepcopy(first) for _ in range(particles)], None, None
    for scan in log:
        points, parents, tries = scan.points(), range(particles), [TURNS[:1]]
        if literal.effective_number(shares(own)) < resample * particles:
            parents = literal.systematic(shares(own).tolist(), rng.random())
            own = [deepcopy(own[k]) for k in parents]
            for p in own:
                p.recent = 0.0
        if odometry is not None and scan.odometry is not None:
            step = np.zeros(3) if wheels is None else between(wheels, scan.odometry)
            if wheels is not None:
                tries = [TURNS] if abs(step[2]) > 0.3 else [TURNS[:1], TURNS]
            wheels = scan.odometry
            for p in own:
                p.pose = compose(p.pose, step)
        is_first = own[0].drawn is None
        if len(points) and not is_first:
            fields = []
            for p in own:
                p.pose, field = climbed(p, scan, tries)
                fields.append(field)
            best = max(own, key=lambda p: p.likely)
            x, y, turn = between(best.drawn, best.pose)
            if np.hypot(x, y) > 0.3 or abs(turn) > 0.3:
                wide = np.array([0.1, 0.1, 0.05])
                if told is not None and odometry is not None:
                    wide = particles_file.odometry_deviation(between(told, wheels), odometry)
                for p, field in zip(own, fields, strict=True):
                    values = particles_file._log_likelihood(field, points, compose(p.pose, AROUND))
                    covariance, weight = particles_file.proposal(values, wide)
                    p.recent, p.likely = p.recent + weight / 3, p.likely + weight / 3
                    if noise > 0:
                        drawn = np.linalg.cholesky(covariance) @ rng.standard_normal(3)
                        p.pose = compose(p.pose, noise * drawn)
                    p.drawn = p.pose
                told = wheels
        best = max(range(particles), key=lambda k: own[k].likely)
        overlap = overlap_of(own[best].map, scan.points(), own[best].pose)
        for p in own:
            insert_placed(p.map, None, scan, p.pose, free=False)
            if len(points) and is_first:
                p.drawn, told = p.pose, wheels
        yield [p.pose for p in own], shares(own), [*parents], best, overlap, own[best].map


@pytest.mark.parametrize("seed", range(9))
def test_it_is_the_plain_filter_with_any_options(seed):
    """Steps of about 0.3 m and 0.3 radians, wheels that are late or silent, a scan without end; a
    map that holds something, and that the user changes: the particles have copies."""
    random = np.random.default_rng(seed)
    sensor = replace(SENSOR, beams=int(random.choice([30, 130])), step=0.04)
    turns, steps = np.cumsum(random.normal(0, 0.25, 9)), random.uniform(0, 0.4, (9, 2)) / 2
    path = np.column_stack([np.cumsum(steps, axis=0) + 0.8, turns])
    log = list(simulate(rectangular_room(4, 3), path, sensor=sensor, rng=random))
    silent, blind, *late = random.choice(9, 5, replace=False)
    for k, turn in zip(late, random.uniform(0.2, 0.5, 3), strict=True):
        log[k] = replace(log[k], odometry=compose(log[k].odometry, (0.1, 0, turn)))
    log[silent] = replace(log[silent], odometry=None)
    log[blind] = replace(log[blind], ranges=np.full(sensor.beams, np.inf))
    options = {
        "particles": 4,
        "odometry": [None, OdometryNoise(), OdometryNoise(0.1, 0.2, 0.1)][seed % 3],
        "noise": float(random.choice([0, 0.5, 1])),
        "resample": float(random.choice([0, 0.7, 1])),
    }
    start, own = random.normal(0, 1, 3), [QuadtreeMap(resolution=0.1) for _ in range(2)]
    start *= seed % 4 > 0  # at first the default
    rng, again = np.random.default_rng(seed), np.random.default_rng(seed)
    known = start[:2] + random.normal(0, 0.5, (9, 2))
    for map in own:
        map.insert_scan(start[:2], known)
    plain = followed(log, own[1], start, again, **options)
    options |= {"start": start} if start.any() else {}
    steps = particle_mapping(log, map=own[0], rng=rng, **options)
    for step, (poses, weights, parents, best, overlap, map) in zip(steps, plain, strict=True):
        np.testing.assert_allclose(step.poses, poses, atol=1e-9)
        np.testing.assert_allclose(step.weights, weights, atol=1e-9)
        assert (step.parents.tolist(), step.best, step.overlap) == (parents, best, overlap)
        assert leaves_of(own[0]) == leaves_of(map)
        own[0].insert_scan((0, 0), [(1, 1)])


@pytest.mark.parametrize("step", [(3, 4, 0), (0, 0, -2), (0, 0, 0)])
def test_the_errors_of_the_odometry_add_up_as_squares(step):
    noise, way, turn = OdometryNoise(0.1, 0.2, 0.3, 0.4), np.hypot(*step[:2]), abs(step[2])
    along = noise.distance_noise**2 * way + 0.002**2
    about = noise.turn_noise**2 * turn + noise.heading_noise**2 * way
    about += (noise.turn_bias * turn) ** 2 + 0.001**2
    np.testing.assert_allclose(
        particles_file.odometry_deviation(np.array(step), noise) ** 2, (along, along, about)
    )


@pytest.mark.parametrize("times", [1, 40])
def test_sixty_beams_of_a_scan_are_weighed_and_each_may_meet_anything(times):
    """One on its wall, one off by its standard deviation, one far away; and no map at all."""
    map = QuadtreeMap(resolution=0.05)
    map.insert_scan((0, 0), [(1.025, 0.025)])
    points = np.repeat([(1.025, 0.025), (1.025, 0.075), (1.025, 2.0)], times, axis=0)
    each, field = np.log([1, 0.9 * np.exp(-0.5) + 0.1, 0.1]), DistanceField(map)
    found = [
        particles_file._log_likelihood(near, points, np.zeros((1, 3)))[0] for near in (field, None)
    ]
    expected = min(times, 20) * np.array([each.sum(), 3 * np.log(0.1)])
    np.testing.assert_allclose(found, expected, rtol=1e-5)


def test_scans_without_returns_and_far_from_all_are_gone_through():
    blind = LaserScan([np.inf, 9.0], [0.0, 0.2], max_range=6.0)
    near, far = LaserScan([1.0, 1.0], [0.0, 0.2]), LaserScan([9.0, 9.1], [3.0, 3.1])
    steps, map = mapped([blind, near, blind, far], particles=4)
    assert [step.found for step in steps] == [False, True, False, False]
    assert particle_paths(steps[:1]).tolist() == steps[0].poses[:, None].tolist()
    assert map.scans == 2 and np.isfinite(steps[-1].poses).all()


@pytest.mark.parametrize("turn", [-0.8, 0.8])
def test_odometry_that_is_late_in_a_turn_is_made_good(turn):
    """As in the log of the Intel lab. Catches a matcher that begins at the odometry alone."""
    log = room_log()
    late = replace(log[6], odometry=compose(log[6].odometry, np.array([0, 0, turn])))
    scans = [*log[:6], late, *log[7:]]
    steps = mapped(scans, particles=3, start=log.truth[0])[0]
    off = np.array([step.pose for step in steps]) - log.truth
    assert np.hypot(*off[:, :2].T).max() < 0.1 and np.abs(off[:, 2]).max() < 0.05
    assert min(step.overlap for step in steps) > 0.8


@given(
    st.lists(st.floats(1e-9, 1), min_size=1, max_size=12),
    st.floats(0, 1),
    st.integers(1, 50),
)
def test_resampling_equals_its_loops(weights, offset, n):
    share = np.array(weights) / np.sum(weights)
    taken = systematic(share, offset, n)
    assert effective_number(share) == pytest.approx(literal.effective_number(share.tolist()))
    walked = literal.systematic(share.tolist(), offset, n)
    sums = np.cumsum(share)
    near = np.abs(np.subtract.outer((np.arange(n) + offset) / n, sums)).min(1)
    assert [a for a, d in zip(taken, near, strict=True) if d > 1e-12] == [
        a for a, d in zip(walked, near, strict=True) if d > 1e-12
    ]
    count = np.bincount(taken, minlength=len(share))
    assert (np.abs(count - n * share) < 1 + 1e-9).all() and len(taken) == n


def test_the_proposal_equals_its_loops():
    """The likelihood of a scan over all cells, and the information of the parabola."""
    log, map = room_log(), QuadtreeMap(resolution=0.01)
    points, peak = log[0].points(), log.truth[0]
    map.insert_scan(peak[:2], transform(peak, points))
    lattice = particles_file.LATTICE * particles_file.PEAK_STEP
    field = DistanceField.around(map, points, peak)
    found = particles_file._log_likelihood(field, points, compose(peak, lattice))
    leaves, few = map.leaves(), points[np.linspace(0, len(points) - 1, 60).astype(int)]
    centres = (np.column_stack(leaves[:2])[leaves.occ > 0] + map.resolution / 2).tolist()

    def value(offset):
        ends = transform(compose(peak, np.array(offset)), few).tolist()
        return literal.log_likelihood(ends, centres, sigma=0.05, astray=0.1)

    np.testing.assert_allclose(found, [value(offset) for offset in lattice], atol=2.0)
    exact = np.array([value(offset) for offset in lattice])
    wide = np.array([0.02, 0.03, 0.01])
    covariance, weight = particles_file.proposal(exact, wide)
    bent = np.array(literal.information(value, particles_file.PEAK_STEP))
    assert np.linalg.eigvalsh(bent).min() > 0
    np.testing.assert_allclose(np.linalg.inv(covariance), bent + np.diag(wide**-2), rtol=1e-6)
    shrunk = np.log(np.sqrt(np.linalg.det(covariance)) / wide.prod())
    assert weight == pytest.approx(exact[13] + shrunk)


def test_a_ridge_or_a_valley_leaves_the_odometry():
    """Catches a covariance that is negative, or larger than the odometry's."""
    wide = np.array([0.02, 0.03, 0.01])
    x, y, turn = particles_file.LATTICE.T
    for values in (np.zeros(27), x * x + y * y + turn * turn):
        covariance, weight = particles_file.proposal(values, wide)
        np.testing.assert_allclose(covariance, np.diag(wide**2), atol=1e-12)
        assert weight == pytest.approx(values[13])
    flat_along_x, _ = particles_file.proposal(-8 * y * y - 8 * turn * turn, wide)
    assert np.sqrt(flat_along_x[0, 0]) == pytest.approx(0.02)
    assert np.sqrt(flat_along_x[1, 1]) < 0.02


@pytest.mark.parametrize("resolution", [0.05, slow(0.01)])
def test_the_room_walk_is_no_worse_than_hill_climbing(resolution):
    log, maps = course.room_walk(), [QuadtreeMap(resolution=resolution) for _ in range(2)]
    options = {"start": log.truth[0]}
    climbed = np.array([step.pose for step in map_scans(log, map=maps[0], **options)])
    steps, _ = mapped(log, map=maps[1], particles=8, **options)
    errors = [
        np.median(position_errors(poses, log.truth))
        for poses in (particle_paths(steps)[steps[-1].best], climbed)
    ]
    assert errors[0] < errors[1] + 0.015
