"""The solver of pose graphs: against gtsam at the same minimum, and how it grows with the graph.

Worlds in the manner of the well-known data sets: a robot drives along the streets of a grid, a
metre a step, and recognises places where it was before.

    python -m benchmarks graph
    python -m benchmarks.bench_graph 100000     seconds, rounds and megabytes of one world alone
"""

import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from segmap import LaserScan, Log, load
from segmap.alignment import pose_graph
from segmap.alignment.graph import SCALE, Edge, Solver, deviations, residuals, solve
from segmap.poses import between, compose
from segmap.poses.information import rotate
from segmap.simulation import OdometryNoise, drifting_odometry

from .measure import ROOT, Row

Array = NDArray[np.float64]
#: Standard deviations of a motion, metres and radians; the streets are so many metres apart.
SPREAD, STREET = np.array([0.05, 0.05, 0.02]), 5
#: Poses, half side in metres, and loops of each world.
WORLDS = {"manhattan 3500": (3500, 25, 2100), "city 10000": (10000, 60, 10700)}
SIZES = (1_000, 10_000, 30_000)
#: Loops that leave an edge open by more than this, metres and radians, are solved at once.
STRAIN = np.array([0.05, 0.05, np.radians(0.5)])


class World(NamedTuple):
    """Poses by the odometry alone, and all edges: first the steps, then the loops."""

    start: Array
    edges: Edge


def rows() -> Iterator[Row]:
    worlds = {name: world(*size) for name, size in WORLDS.items()} | killian()
    for name, made in worlds.items():
        for scale in (np.inf, SCALE):
            yield against_gtsam(name, made, scale)
    yield from growth()
    yield from (drive(count) for count in (1_000, 4_000))


def world(count: int, side: int, loops: int, spread: Array = SPREAD, seed: int = 1) -> World:
    """A drive of so many metres in a square, and loops to places seen before, 1.5 m off at most."""
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(seed)
    truth = streets(count, side, rng)
    near = cKDTree(truth[:, :2]).query_pairs(1.5, output_type="ndarray")
    near = np.sort(near, axis=1)
    near = near[near[:, 1] - near[:, 0] > 10]
    chosen = near[rng.permutation(len(near))[:loops]]
    k = np.arange(count)
    first, second = np.concatenate([np.stack([k[:-1], k[1:]], -1), chosen]).T
    relative = between(truth[first], truth[second]) + rng.normal(0, spread, (len(first), 3))
    start = [truth[0]]
    for motion in relative[: count - 1]:
        start.append(compose(start[-1], motion))
    information = np.tile(np.diag(1 / spread**2), (len(first), 1, 1))
    loop = np.arange(len(first)) >= count - 1
    return World(np.array(start), Edge(first, second, relative, information, loop))


def streets(count: int, side: int, rng: np.random.Generator) -> Array:
    """Poses a metre apart along streets, with turns at half of the crossings: `(count, 3)`."""
    ahead = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    place, heading, found = np.zeros(2, np.int64), 0, np.zeros((count, 3))
    for k in range(1, count):
        place = place + ahead[heading]
        inside = [np.abs(place + ahead[(heading + t) % 4]).max() <= side for t in range(4)]
        crossing = not (place % STREET).any()
        if not inside[0] or (crossing and rng.random() < 0.5):
            sides = [t for t in (1, 3) if inside[t]] or [2]
            heading = (heading + sides[rng.integers(len(sides))]) % 4
        found[k] = *place, heading * np.pi / 2
    return found


def killian() -> dict[str, World]:
    """The graph of the first scans of Killian Court, with its odometry as the start."""
    try:
        log = load("killian")[:1300]
    except (ValueError, OSError):
        return {}
    noise, rng = OdometryNoise(), np.random.default_rng(1)
    wheels = drifting_odometry(log.truth, odometry_noise=noise, rng=rng)
    scans = [
        LaserScan(s.ranges, s.angles, s.time, at, s.max_range, s.sensor_pose)
        for s, at in zip(log, wheels, strict=True)
    ]
    graph = pose_graph(Log(log.name, scans, log.truth)).graph
    key, ends = np.unique(graph.edges, return_inverse=True)
    first, second = ends.reshape(-1, 2).T
    return {
        f"killian {len(key)}": World(
            wheels[key], Edge(first, second, graph.relative, graph.information, graph.loop)
        )
    }


def against_gtsam(name: str, made: World, scale: float) -> Row:
    """CPU time of both to the minimum from the same start, in turn; and the losses there."""
    what = f"{name}, {len(made.edges.first)} edges, {'plain' if scale == np.inf else 'Cauchy'}"
    ours, (took, found) = [], cpu(lambda: solve(made.start, made.edges, scale=scale))
    try:
        optimizer = theirs(made, scale)
    except ImportError:
        return Row(what, f"{took:.3f} s, {found.rounds} rounds; gtsam is not installed")
    others = []
    for _ in range(3):
        ours.append(cpu(lambda: solve(made.start, made.edges, scale=scale))[0])
        optimizer = theirs(made, scale)
        took, values = cpu(optimizer.optimize)
        others.append(took)
    end = np.array([_pose(values.atPose2(k)) for k in range(len(made.start))])
    ratio = statistics.median(ours) / statistics.median(others)
    return Row(
        what,
        f"{statistics.median(ours):.3f} s / gtsam {statistics.median(others):.3f} s = {ratio:.2f}; "
        f"{found.rounds} / {optimizer.iterations()} rounds, chi2 "
        f"{2 * loss(found.poses, made, scale):.2f} / {2 * loss(end, made, scale):.2f}",
        "<= 1.5 at the same chi2",
    )


def cpu(call: Callable[[], Any]) -> tuple[float, Any]:
    begun = time.process_time()
    found = call()
    return time.process_time() - begun, found


def theirs(made: World, scale: float) -> Any:
    """gtsam's Gauss-Newton on the same edges, with the same weights; the first pose is held.

    It measures what is left of an edge in the frame where the motion ends.
    """
    import gtsam

    model, graph, values = gtsam.noiseModel, gtsam.NonlinearFactorGraph(), gtsam.Values()
    turned = rotate(made.edges.information, made.edges.relative[:, 2])
    for i, j, motion, information in zip(*made.edges[:3], turned, strict=True):
        noise = model.Gaussian.Information(information)
        if np.isfinite(scale):
            noise = model.Robust.Create(model.mEstimator.Cauchy.Create(scale), noise)
        graph.add(gtsam.BetweenFactorPose2(int(i), int(j), gtsam.Pose2(*motion), noise))
    held = model.Isotropic.Sigma(3, 1e-6)
    graph.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(*made.start[0]), held))
    for k, pose in enumerate(made.start):
        values.insert(k, gtsam.Pose2(*pose))
    return gtsam.GaussNewtonOptimizer(graph, values, gtsam.GaussNewtonParams())


def _pose(found: Any) -> tuple[float, float, float]:
    return found.x(), found.y(), found.theta()


def loss(poses: Array, made: World, scale: float) -> float:
    """Half the sum of squares in standard deviations, or of what Cauchy makes of them."""
    square = deviations(poses, made.edges) ** 2
    return float((square if scale == np.inf else scale**2 * np.log1p(square / scale**2)).sum() / 2)


def growth() -> Iterator[Row]:
    """Cities at one density, each in a process of its own."""
    for count in SIZES:
        command = [sys.executable, "-m", "benchmarks.bench_graph", str(count)]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        took, rounds, megabytes = done.stdout.split()
        yield Row(f"city of {count} poses", f"{took} s CPU, {rounds} rounds, {megabytes} MB")


def drive(count: int) -> Row:
    """A drive whose loops are closed as they come, solved anew each time or kept."""
    made = world(count, int(0.6 * count**0.5), int(0.3 * count), SPREAD / 10)
    (anew, fresh), (kept, lazy) = driven(made, lazily=False), driven(made, lazily=True)
    took, back = 1e3 * np.median(lazy[-20:]), 1e3 * np.median(fresh[-20:])
    return Row(
        f"drive of {count} poses, {len(lazy)} loops solved at once",
        f"kept {sum(lazy):.2f} s, anew {sum(fresh):.2f} s; the last {took:.1f} and {back:.1f} ms; "
        f"columns {kept / anew:.2f}",
    )


def driven(made: World, *, lazily: bool) -> tuple[int, list[float]]:
    """Columns that were computed, and CPU seconds of each solution while driving."""
    solver, poses, took = Solver(SCALE), made.start[:1], []
    last = np.maximum(made.edges.first, made.edges.second)
    order, since = np.argsort(last, kind="stable"), 0
    until = np.searchsorted(last[order], np.arange(len(made.start)), side="right")
    for k in range(1, len(made.start)):
        poses = np.vstack([poses, compose(poses[-1], made.edges.relative[k - 1])])
        new = part(made.edges, order[until[k - 1] : until[k]])
        if (np.abs(residuals(poses, new)) > STRAIN).any():
            solver.add(part(made.edges, order[since : until[k]]))
            since, step = until[k], poses
            seconds, found = cpu(lambda p=step: solver.solve(p, lazily=lazily))
            took.append(seconds)
            poses = found.poses
    return solver.columns, took


def part(edges: Edge, chosen: NDArray[np.int64]) -> Edge:
    return Edge(*(field[chosen] for field in edges[:-1]))  # none is forced


def main(count: int) -> None:
    solve(*world(100, 10, 20))
    made = world(count, int(0.6 * count**0.5), count, SPREAD / 10)
    took, found = cpu(lambda: solve(*made))
    unit = 1 if sys.platform == "darwin" else 1024
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6
    print(f"{took:.2f}", found.rounds if found.converged else "too many", f"{megabytes:.0f}")


if __name__ == "__main__":
    main(int(sys.argv[1]))
