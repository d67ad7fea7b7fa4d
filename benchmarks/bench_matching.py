"""Scores, fields, greedy matchers, mapping without odometry: writes `data/records/matching.csv`.

A score's time is compared with scipy's kd-tree over the same occupied cells, in turn.
"""

import csv
import importlib
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from segmap_course import Trial, room_walk, try_pair

from segmap import LaserScan, read
from segmap.matching import (
    MATCHERS,
    SCORES,
    DistanceField,
    descent_score,
    hill_climb,
    map_scans,
    nearest_score,
    occupancy_score,
    sample_and_rank,
)
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap

from .measure import RECORDS, SHARED, Row, in_turn, missing, seconds, workloads

TARGET = RECORDS / "matching.csv"
ORIGIN = np.zeros(3)
#: Pairs that take long are tried with the first seed only.
SEEDS, SLOW = range(5), ("nearest", "descent")


def rows() -> Iterator[Row]:
    made = workloads()
    if made is None:
        yield from missing("scores, fields, matchers and the room path")
    else:
        yield from scores(made)
        yield from growth(made)
        for name in ("room", "loop"):
            yield from one_scan(made, name)
        yield from without_odometry(made)
    yield from real()
    trials = []
    for matcher in MATCHERS:
        for score in SCORES:
            found = [pair(matcher, score, k) for k in (SEEDS[:1] if score in SLOW else SEEDS)]
            trials += found
            yield Row(f"{matcher}, {score}", summary(found))
    pd.DataFrame(trials).to_csv(TARGET, index=False, lineterminator="\n")


def obstacles(made, count: int) -> tuple[QuadtreeMap, np.ndarray]:
    """A map of so many occupied cells, each put there by itself, and the ends of a scan."""
    cells, _, side, points = made.obstacle_field(count)
    map = QuadtreeMap(resolution=side)
    for centre in (cells[:, ::-1] + 0.5) * side:
        map.insert_scan(centre, centre[None])
    return map, points[:, ::-1].copy()


def centres(map: QuadtreeMap) -> np.ndarray:
    leaves = map.leaves()
    occupied = 2 * leaves.occ > leaves.vis
    return np.stack([leaves.x[occupied], leaves.y[occupied]], -1) + map.resolution / 2


def scores(made) -> Iterator[Row]:
    from scipy.spatial import cKDTree

    map, points = obstacles(made, 10_000)
    tree, what = cKDTree(centres(map)), "682 beams, 1e4 occupied cells"
    batch = np.random.default_rng(0).normal(0, 0.02, (64, 3))
    for name, score in (("nearest", nearest_score), ("descent", descent_score)):
        for poses, of in ((ORIGIN, "one pose"), (batch, "64 poses")):
            many = np.atleast_2d(poses)
            ends = np.concatenate([transform(pose, points) for pose in many])
            ours, theirs = in_turn(
                partial(score, map, points, poses), partial(tree.query, ends), repeat=21
            )
            ours, theirs = ours / len(many), theirs / len(many)
            yield Row(
                f"{name}_score, {what}, {of}",
                f"{1e6 * ours:.0f} us, {ours / theirs:.2f} of cKDTree's query",
                "<= 250 us, 0.70 of it (stretch 110)" if name == "nearest" else "",
            )
    yield against_nanoflann(map, points)
    off = abs(nearest_score(map, points, ORIGIN)[0] + tree.query(points)[0].sum())
    yield Row("nearest_score and cKDTree differ by", f"{off:.1e} m", "equal")
    took = seconds(lambda: occupancy_score(map, points, ORIGIN), 21)
    yield Row(f"occupancy_score, {what}", f"{1e6 * took:.0f} us")
    ask = DistanceField(map).scorer(points)
    for poses, target in ((ORIGIN[None], "<= 1.5 us (0.7)"), (batch, "<= 1.0 us (0.25)")):
        took = seconds(lambda p=poses: [ask(p) for _ in range(50)], 21) / 50 / len(poses)
        yield Row(f"field, batches of {len(poses)}", f"{1e6 * took:.2f} us a pose", target)


def against_nanoflann(map: QuadtreeMap, points: np.ndarray) -> Row:
    """One pose, through the Python binding of the C++ library, where that is installed."""
    what = "nearest_score, one pose, nanoflann's query / ours"
    try:
        library: Any = importlib.import_module("pynanoflann")
    except ImportError:
        return Row(what, "skipped", "pip install pynanoflann to compare")
    tree = library.KDTree(n_neighbors=1, leaf_size=10)
    tree.fit(centres(map))
    ask = partial(nearest_score, map, points, ORIGIN)
    ours, theirs = in_turn(ask, partial(tree.kneighbors, points), repeat=101)
    return Row(what, f"{1e6 * theirs:.0f} / {1e6 * ours:.0f} us = {theirs / ours:.2f}", ">= 1")


def growth(made) -> Iterator[Row]:
    """B's table 6.3: what a score costs as the map grows."""
    counts, leaves = (1_000, 10_000, 100_000), []
    took: dict[str, list[float]] = {"occupancy": [], "nearest": [], "descent": [], "field": []}
    poses = np.random.default_rng(0).normal(0, 0.02, (16, 3))
    for count in counts:
        map, points = obstacles(made, count)
        leaves.append(len(map.leaves().x))
        calls = {name: partial(SCORES[name], map, points) for name in took}
        calls["field"] = DistanceField(map).scorer(points)
        for name, call in calls.items():
            took[name].append(seconds(partial(call, poses), 7) / len(poses))
    write(
        "matching_growth",
        ["score", "leaves", "seconds"],
        [
            (name, *pair)
            for name in took
            for pair in zip(leaves, [float(f"{t:.3g}") for t in took[name]], strict=True)
        ],
    )
    for name, times in took.items():
        power = np.polyfit(np.log(leaves), np.log(times), 1)[0]
        figures = " -> ".join(f"{1e6 * t:.2g}" for t in times)
        yield Row(
            f"{name}, {leaves[0]} to {leaves[-1]} leaves, of 16 poses",
            f"{figures} us a pose: time ~ leaves^{power:.2f}",
        )


def real() -> Iterator[Row]:
    """The first 300 scans of a robot with an URG-04LX, without its odometry."""
    path = SHARED / "data" / "urg04lx-exp1.dat.gz"
    if not path.exists():
        yield from missing("urg04lx-exp1, 300 scans: the stored record stays")
        return
    log, map = read(path)[:300], QuadtreeMap()
    steps = list(map_scans(log, map=map))
    beams = [int(scan.valid.sum()) for scan in log]
    columns = ["scan", "x", "y", "heading", "score", "beams", "seconds"]
    found = [
        (k, *step.pose.round(4).tolist(), round(step.score, 4), n, round(step.seconds, 5))
        for k, (step, n) in enumerate(zip(steps, beams, strict=True))
    ]
    write("matching_exp1", columns, found)
    each = [-1e3 * step.score / n for step, n in zip(steps, beams, strict=True) if n]
    took = 1e3 * np.median([step.seconds for step in steps])
    yield Row(
        "urg04lx-exp1, 300 scans without odometry, cells of 1 cm",
        f"median {np.nanmedian(each):.1f}, largest {np.nanmax(each):.0f} mm a beam, "
        f"{took:.1f} ms a scan, {map}, {map.nbytes / 1e3:.0f} kB",
    )


def write(name: str, columns: list[str], found: list[tuple[object, ...]]) -> None:
    """A record, through a temporary file."""
    part = TARGET.with_name(f"{name}.part")
    with part.open("w", encoding="utf-8", newline="") as target:
        csv.writer(target, lineterminator="\n").writerows([columns, *found])
    part.replace(TARGET.with_name(f"{name}.csv"))


def known_map(made, name: str) -> tuple[QuadtreeMap, LaserScan, np.ndarray]:
    """A map of the first half of a path from its true poses, and the next scan and pose."""
    case = {"room": ("urg", 0.01), "loop": ("sick8", 0.05)}[name]
    sensor, path = made.SENSORS[case[0]], made.path(name, 200)
    rng, map = np.random.default_rng(0), QuadtreeMap(resolution=case[1])
    for pose in path[:101]:
        ranges = made.scan_at(made.WORLDS[name](), pose, sensor, rng)[0]
        scan = LaserScan(ranges, sensor.angles, max_range=sensor.max_range)
        if pose is not path[100]:
            map.insert_scan(pose[:2], transform(pose, scan.points()))
    return map, scan, path[100]


def one_scan(made, name: str) -> Iterator[Row]:
    map, scan, pose = known_map(made, name)
    points, start = scan.points(), pose + (0.02, -0.01, 0.02)
    field = DistanceField.around(map, points, start)
    took = seconds(lambda: DistanceField.around(map, points, start), 21)
    rows, columns = field.cells.shape
    yield Row(
        f"{name}: exact window transform, {columns} x {rows} cells",
        f"{1e3 * took:.2f} ms",
        "<= 3 ms (1.4)" if name == "room" else "<= 0.3 ms (0.08)",
    )
    ask = field.scorer(points)
    both = {
        "hill climbing": lambda: hill_climb(map, points, start, score=lambda *a: ask(a[2])),
        "sample and rank": lambda: sample_and_rank(
            map, points, start, score=lambda *a: ask(a[2]), rng=np.random.default_rng(1)
        ),
    }
    for matcher, call in both.items():
        took = seconds(call, 21)
        yield Row(f"{name}: {matcher} alone", f"{1e3 * took:.2f} ms", "<= 1 ms (0.4)")


def without_odometry(made) -> Iterator[Row]:
    """The room path of the workloads: poses from ranges alone, five seeds, both matchers."""
    sensor, path = made.SENSORS["urg"], made.path("room", 200)
    for matcher in ("hill climbing", "sample and rank"):
        found = []
        for seed in SEEDS:
            rng = np.random.default_rng(seed)
            ranges = [made.scan_at(made.room(), pose, sensor, rng)[0] for pose in path]
            log = [LaserScan(r, sensor.angles) for r in ranges]
            chosen = MATCHERS[matcher](np.random.default_rng(seed))
            steps = list(map_scans(log, matcher=chosen, start=path[0]))
            away = np.array([step.pose for step in steps]) - path
            took = np.median([step.seconds for step in steps])
            place = np.hypot(away[:, 0], away[:, 1])
            found.append((1e3 * np.median(place), 1e3 * place.max(), 1e3 * took))
        median, largest, took = np.median(found, axis=0)
        yield Row(
            f"room path of 200 scans, {matcher}, field, five seeds",
            f"median {median:.1f}, largest {largest:.1f} mm, step {took:.2f} ms",
            "<= 20, 50 mm, 5 ms (12, 30, 2.5)",
        )


def pair(matcher: str, score: str, seed: int) -> Trial:
    return try_pair(room_walk(seed=seed), matcher, score, seed=seed)


def summary(trials: list[Trial]) -> str:
    values = [(1e3 * t.median, 1e3 * t.largest, 1e3 * t.seconds, t.leaves) for t in trials]
    median, largest, took, leaves = np.median(values, axis=0)
    return f"median {median:.0f}, largest {largest:.0f} mm, {took:.1f} ms, {leaves:.0f} leaves"
