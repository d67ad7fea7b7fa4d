"""How the pose graph grows with the length of a drive, at one density of walls and of revisits.

A robot drives round block after block of a city, four to a row, so that half of its way is known
to it. Each drive has a process of its own, which also tells how much memory it has held:
`python -m benchmarks.bench_length 24000`, or `100000 16` for 16 blocks to a row.
"""

import math
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import count, islice

import numpy as np
from scipy.spatial import cKDTree

from segmap import Log, load
from segmap.alignment import Alignment, pose_graph
from segmap.arrays import Array
from segmap.poses import between
from segmap.simulation import Sensor, city, drive, simulate

from .measure import ROOT, Row

LENGTHS = (1_500, 3_000, 6_000, 12_000, 24_000)
COLUMNS, BLOCK, STREET = 4, 16.0, 3.0
#: Scans to a block that is driven round, at least: five streets and as many turns.
A_BLOCK = 380
LASER = Sensor("laser", 181, -np.pi / 2, np.pi / 180, max_range=20.0, sigma=0.01)
#: Pairs of poses are compared where they lie so near each other, metres, and so many scans apart.
NEAR, APART = 20.0, 50
#: A loop is false where it is wrong by more, metres.
FALSE = 0.5


def rows() -> Iterator[Row]:
    for scans in LENGTHS:
        command = [sys.executable, "-m", "benchmarks.bench_length", str(scans)]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        yield Row(f"city, {scans} scans", done.stdout.strip(), "<= 4 ms a scan, errors flat")


def tour(columns: int) -> Iterator[Array]:
    """Crossings on a way round every block, row after row, there and back: `(2,)`, metres."""
    for row in count():
        along = [*range(columns)] if row % 2 == 0 else [*range(columns, 0, -1)]
        turn = 1 if row % 2 == 0 else -1
        for i in along:
            for corner in ((i, row), (i, row + 1), (i + turn, row + 1), (i + turn, row), (i, row)):
                yield crossing(*corner)
        yield crossing(along[-1] + turn, row)


def crossing(i: int, j: int) -> Array:
    """Middle of a crossing, `(2,)`, metres."""
    return STREET / 2 + (BLOCK + STREET) * np.array([i, j])


def city_log(scans: int, columns: int = COLUMNS, seed: int = 1) -> Log:
    """The log of so many scans in a city that is as large as they need."""
    rng, blocks = np.random.default_rng(seed), math.ceil(scans / A_BLOCK) + 1
    height = math.ceil(blocks / columns)
    walls = city(columns, height, rng=rng, block=BLOCK, street=STREET)
    corners = np.array([*islice(tour(columns), 5 * blocks)])
    kept = np.r_[True, np.any(np.diff(corners, axis=0) != 0, axis=1)]
    path = drive(corners[kept], step=0.25, turn=np.radians(15))[:scans]
    return simulate(walls, path, sensor=LASER, rng=rng, name=f"city of {blocks} blocks")


def pair_errors(truth: Array, found: Alignment, most: int = 50_000) -> Array:
    """How wrong the place of one scan is as seen from another nearby, both used, metres."""
    truth, poses = truth[found.used], found.poses[found.used]
    rng, tree = np.random.default_rng(0), cKDTree(truth[:, :2])
    first = rng.integers(0, len(truth), most)
    balls = (tree.query_ball_point(truth[k, :2], NEAR) for k in first)
    second = np.array([ball[int(rng.integers(len(ball)))] for ball in balls])
    far = np.abs(first - second) > APART
    return wrong(truth, poses, first[far], second[far])


def wrong(truth: Array, poses: Array, first: Array, second: Array) -> Array:
    """Error of the motion between scans, metres."""
    left = between(between(truth[first], truth[second]), between(poses[first], poses[second]))
    return np.hypot(left[:, 0], left[:, 1])


def figures(log: Log, found: Alignment, took: float, held: float) -> str:
    truth, graph = log.truth, found.graph
    errors, unused = pair_errors(truth, found), int((~found.used).sum())
    first, second = graph.edges[graph.loop].T
    left = between(between(truth[first], truth[second]), graph.relative[graph.loop])
    false = int((np.hypot(left[:, 0], left[:, 1]) > FALSE).sum())
    return (
        f"{1e3 * took / len(log):.2f} ms a scan; pairs {errors.mean():.3f} m in the mean, "
        f"{errors.max():.2f} at most, {unused} scans not used; {len(first)} loops, {false} false; "
        f"{held:.0f} MB"
    )


def main(scans: int, columns: int) -> None:
    pose_graph(load("corridor")[:60])
    log = city_log(scans, columns)
    start = time.process_time()
    found = pose_graph(log)
    took, unit = time.process_time() - start, 1 if sys.platform == "darwin" else 1024
    held = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6
    print(figures(log, found, took, held))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else COLUMNS)
