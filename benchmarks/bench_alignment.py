"""Matching two scans, and aligning whole logs: writes `data/records/alignment.csv`."""

import csv
import gzip
import resource
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from segmap_course import literal

from segmap import LaserScan, Log, alignment, load, read
from segmap.alignment import Alignment, align_to_truth, match_points, solve_graph
from segmap.angles import wrap
from segmap.metrics import relation_errors
from segmap.poses import between, compose
from segmap.simulation import OdometryNoise, drifting_odometry

from .measure import RECORDS, SHARED, Row, in_turn, missing, seconds, workloads

Array = NDArray[np.float64]
TARGET = RECORDS / "alignment.csv"
SEEDS = (1, 2, 3)


class Case(NamedTuple):
    """A log with drifting odometry, and the errors of a trajectory for it: metres and radians."""

    name: str
    log: Log
    errors: Callable[[Array], tuple[Array, Array]]
    by_scan: Callable[[Array], tuple[Array, Array]] | None = None


def rows() -> Iterator[Row]:
    yield from matches()
    yield from against_literal()
    records = []
    for case in cases():
        for name, method in alignment.METHODS.items():
            found = method(case.log, **({"missing": "drop"} if name == "ground_truth" else {}))
            records.append(record(case, name, found))
            yield Row(f"{case.name}, {name}", summary(records[-1]))
            if case.by_scan is not None:
                far = case.by_scan(found.poses)[0]
                words = f"{len(far)} relations, mean {far.mean():.4f} m, max {far.max():.2f} m"
                yield Row(f"{case.name}, {name}, relations whose times are those of scans", words)
    yield Row("largest memory so far", f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss} kB")
    if (SHARED / "data").exists():
        write(records)
    else:
        yield from missing("Intel and FR079: the stored records stay")


def matches() -> Iterator[Row]:
    """The scan pairs of the workloads: time, and errors of the pose."""
    made = workloads()
    if made is None:
        yield from missing("scan pairs")
        return
    for name in made.B_CASES:
        case = made.match_case(name)
        pairs = [
            [made.end_points(r, case.sensor.angles) for r in both]
            for both in zip(case.ref, case.cur, strict=True)
        ]
        found = [match_points(*pair).pose for pair in pairs]
        took = np.median([seconds(lambda p=pair: match_points(*p), 3) for pair in pairs[:25]])
        far, turned = made.pose_error(found, case.motion)
        wrong = int(((far > 0.03) | (turned > np.radians(1))).sum())
        yield Row(
            f"match_points, {name}",
            f"{1e3 * took:.2f} ms, median {1e3 * np.median(far):.2f} mm, {wrong} of {len(far)} off",
            "<= 2.1 ms, 1.5 mm, none off" if "room" in name else "",
        )


def against_literal() -> Iterator[Row]:
    """The same work by the readable methods of `segmap_course.literal`."""
    log = load("malaga")
    before, now = log[20].points(), log[23].points()
    start_pose = np.zeros(3)
    match_points(before, now)
    took = in_turn(
        lambda: literal.icp(before, now, start_pose)[-1], lambda: match_points(before, now)
    )
    yield Row("match_points, literal / ours", f"{took[0] / took[1]:.0f} x")
    start, ends, motions = circle(60)
    edges = [
        (i, j, m, np.eye(3).tolist()) for (i, j), m in zip(ends, motions.tolist(), strict=True)
    ]
    weights = np.tile(np.eye(3), (len(ends), 1, 1))
    step = literal.gauss_newton(start.tolist(), edges)
    solved = solve_graph(start, ends, motions, information=weights, scale=np.inf)
    assert np.abs(np.array(step) - solved)[:, :2].max() < 0.1
    took = in_turn(
        lambda: literal.gauss_newton(start.tolist(), edges),
        lambda: solve_graph(start, ends, motions, information=weights, scale=np.inf),
    )
    yield Row(
        "solve_graph, 60 poses, one literal step / ours to the end", f"{took[0] / took[1]:.0f} x"
    )
    for count in (1000, 10000):
        start, ends, motions = circle(count)
        took = in_turn(lambda s=start, e=ends, m=motions: solve_graph(s, e, m), repeat=3)
        yield Row(f"solve_graph, {count} poses, {len(ends)} edges", f"{took[0]:.2f} s")


def circle(count: int) -> tuple[Array, NDArray[np.int64], Array]:
    """Poses by noisy steps four times round a circle, and the edges: steps, and loops each turn."""
    rng = np.random.default_rng(0)
    angle = 8 * np.pi * np.arange(count) / count
    truth = np.column_stack([10 * np.cos(angle), 10 * np.sin(angle), wrap(angle + np.pi / 2)])
    k, lap = np.arange(count), count // 4
    ends = np.concatenate([np.stack([k[:-1], k[1:]], -1), np.stack([k[:-lap:3], k[lap::3]], -1)])
    motions = between(truth[ends[:, 0]], truth[ends[:, 1]])
    motions += rng.normal(0, 1, motions.shape) * (0.02, 0.02, 0.002)
    start = [truth[0]]
    for motion in motions[: count - 1]:
        start.append(compose(start[-1], motion))
    return np.array(start), ends, motions


def cases() -> Iterator[Case]:
    malaga = load("malaga")
    yield Case("malaga", malaga, lambda poses: after_rigid_alignment(poses, malaga.truth))
    for name in ("intel", "fr079"):
        path = SHARED / "data" / f"{name}.log.gz"
        if not path.exists():
            yield from ()
            continue
        recorded = read(path)
        log = alignment.prepared(recorded)
        with gzip.open(path.with_name(f"{name}.relations.gz")) as lines:
            relations = np.loadtxt(lines, usecols=range(8))
        tolerance = 0.02 if name == "intel" else 0.1
        for seed in SEEDS if name == "fr079" else (None,):
            yield Case(
                name if seed is None else f"{name}, drift {seed}",
                log if seed is None else drifted(log, seed),
                lambda poses, t=recorded.times, r=relations, tol=tolerance: relation_errors(
                    t, poses, r, tolerance=tol
                ),
                (
                    lambda poses, t=recorded.times, r=relations: relation_errors(
                        t, poses, r, tolerance=0
                    )
                )
                if name == "intel"
                else None,
            )


def drifted(log: Log, seed: int) -> Log:
    """The log with odometry that ordinary wheels would have made of its corrected poses."""
    odometry = drifting_odometry(
        log.truth, odometry_noise=OdometryNoise(), rng=np.random.default_rng(seed)
    )
    scans = [
        LaserScan(s.ranges, s.angles, s.time, wheels, s.max_range, s.sensor_pose)
        for s, wheels in zip(log, odometry, strict=True)
    ]
    return Log(log.name, scans, log.truth)


def after_rigid_alignment(poses: Array, truth: Array) -> tuple[Array, Array]:
    """Errors of position and heading where the truth is known, after the best rigid motion."""
    known = np.isfinite(truth).all(1)
    away = align_to_truth(poses[known], truth[known], best=True) - truth[known]
    return np.hypot(*away[:, :2].T), np.abs(wrap(away[:, 2]))


def record(case: Case, method: str, found: Alignment) -> dict[str, Any]:
    far, turned = case.errors(found.poses)
    return {
        "log": case.name,
        "method": method,
        "scans": len(found),
        "used": int(found.used.sum()),
        "compared": len(far),
        "mean": round(float(far.mean()), 4),
        "deviation": round(float(far.std()), 4),
        "rms": round(float(np.sqrt((far**2).mean())), 4),
        "p95": round(float(np.quantile(far, 0.95)), 4),
        "largest": round(float(far.max()), 4),
        "above_0.2": round(float((far > 0.2).mean()), 4),
        "heading": round(float(turned.mean()), 5),
        "seconds": round(found.seconds, 2),
    }


def summary(row: dict[str, Any]) -> str:
    return (
        f"mean {row['mean']:.4f}, sd {row['deviation']:.3f}, rms {row['rms']:.4f}, p95 "
        f"{row['p95']:.3f}, max {row['largest']:.2f} m, {np.degrees(row['heading']):.2f} deg, "
        f"{row['used']} of {row['scans']} used, {row['seconds']:.1f} s"
    )


def write(records: list[dict[str, Any]]) -> None:
    """All records, through a temporary file."""
    part = TARGET.with_suffix(".part")
    with part.open("w", newline="") as target:
        table = csv.DictWriter(target, records[0].keys(), lineterminator="\n")
        table.writeheader()
        table.writerows(records)
    part.replace(TARGET)
