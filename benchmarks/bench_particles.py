"""Particles on a known map, a step of their filter; and mapping with particles.

Writes `data/records/particles.csv`, the corridor loop over 20 seeds.
"""

import csv
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from segmap_course import corridor_walk, room_walk

from segmap import Log, read
from segmap.matching import particle_mapping, particle_paths
from segmap.matching._likelihoods import Likelihoods
from segmap.matching._localize import at_places, estimate, predict, redraw
from segmap.matching._search import sample_beams
from segmap.metrics import relation_errors
from segmap.quadtree import QuadtreeMap, build_map
from segmap.simulation import (
    URG_04LX,
    OdometryNoise,
    drifting_odometry,
    drive,
    office,
    simulate,
)

from .measure import RECORDS, SHARED, Row, missing, on_cores

#: Name of a log -> seconds within which a relation finds its scans, and GMapping's error, metres.
REAL = {"intel": (0.02, "0.070 +- 0.083"), "fr079": (0.1, "0.061 +- 0.044")}


def rows() -> Iterator[Row]:
    yield from steps_of_a_filter()
    found = []
    for particles in (1, 30):
        off = [loop(seed, particles) for seed in range(20)]
        found += [(particles, seed, round(away, 3)) for seed, away in enumerate(off)]
        closed = sum(away < 0.3 for away in off)
        yield Row(
            f"corridor loop, 20 seeds, {particles} particles",
            f"{closed} closed to 0.3 m, median {np.median(off):.2f}, largest {max(off):.2f} m",
        )
    with (RECORDS / "particles.csv").open("w", encoding="utf-8", newline="") as target:
        csv.writer(target, lineterminator="\n").writerows([("particles", "seed", "off"), *found])
    for resolution in (0.01, 0.05):
        log = room_walk()
        map = QuadtreeMap(resolution=resolution)
        steps = run(log, 15, map=map, start=log.truth[0])
        yield Row(
            f"room walk, 15 particles, cells of {100 * resolution:.0f} cm",
            f"{1e3 * np.median([step.seconds for step in steps]):.0f} ms a scan, "
            f"{15 * map.nbytes / 1e6:.1f} MB of maps",
            "<= 100 ms",
        )
    for name in REAL:
        yield from real(name)


def steps_of_a_filter() -> Iterator[Row]:
    """In an office that 60 beams see: moved, weighed, told apart, estimated and drawn anew."""
    rng, path = np.random.default_rng(0), drive([(0.7, 5), (11.3, 5), (10, 5), (10, 7.4)], step=0.2)
    log = simulate(office(rng=rng), path, sensor=URG_04LX, rng=rng)
    known = Likelihoods(build_map(log, log.truth))
    scans = [replace(scan, odometry=at) for scan, at in zip(log, log.truth, strict=True)]
    points = sample_beams(scans[11].points(), 60)
    for count in (1_000, 10_000, 100_000):
        poses = log.truth[10] + rng.normal(0, 0.05, (count, 3))

        def step(poses: np.ndarray = poses, count: int = count) -> None:
            moved = predict(poses, (scans[10], scans[11]), np.zeros(3), rng, found=True)
            weights = known.fits(points, moved) ** (len(points) / 3)
            weights /= weights.sum()
            places = at_places(moved, weights)
            estimate(moved, weights, places, 0.9, 0.9)
            redraw(moved, weights, places, count, rng)

        weighing = on_cores(lambda poses=poses: known.fits(points, poses))
        yield Row(f"weighing {count} poses, 60 beams, one / all cores", weighing)
        yield Row(f"a step of {count} particles, one / all cores", on_cores(step))


def run(log: Log, particles: int, seed: int = 1, **options):
    """What `particle_mapping` says after each scan; a single particle draws nothing."""
    rng, noise = np.random.default_rng(seed), float(particles > 1)
    return list(particle_mapping(log, particles=particles, rng=rng, noise=noise, **options))


def loop(seed: int, particles: int) -> float:
    """How far off the best particle is in the end, metres."""
    log = corridor_walk(seed=seed)
    last = run(log, particles, seed, start=log.truth[0])[-1]
    return float(np.hypot(*(last.pose - log.truth[-1])[:2]))


def real(name: str) -> Iterator[Row]:
    """Errors of the verified relations, beside those of 50 particles of GMapping (Kuemmerle)."""
    path = SHARED / "data" / f"{name}.log.gz"
    if not path.exists():
        yield from missing(f"{name}, 30 particles")
        return
    log, (tolerance, theirs) = read(path), REAL[name]
    if log[0].odometry is None:  # corrected poses only: drift as in bench_alignment
        noise, rng = OdometryNoise(), np.random.default_rng(1)
        drifted = drifting_odometry(log.truth, odometry_noise=noise, rng=rng)
        scans = [replace(scan, odometry=at) for scan, at in zip(log, drifted, strict=True)]
        log = Log(name, scans, log.truth)
    map = QuadtreeMap(resolution=0.05)
    steps = run(log, 30, map=map)
    relations = np.loadtxt(SHARED / "data" / f"{name}.relations.gz")
    poses = particle_paths(steps)[steps[-1].best]
    away = relation_errors(log.times, poses, relations, tolerance=tolerance)[0]
    took = 1e3 * np.median([step.seconds for step in steps])
    yield Row(
        f"{name}, 30 particles, {len(away)} relations",
        f"{away.mean():.3f} +- {away.std():.3f}, largest {away.max():.2f} m, {took:.0f} ms a scan, "
        f"{30 * map.nbytes / 1e6:.0f} MB of maps",
        f"GMapping {theirs} m",
    )
