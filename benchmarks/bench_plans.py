"""Reduced maps against the walls of published floor plans, on poses of our own graph.

`python -m benchmarks.bench_plans FOLDER NAME...` takes pictures of plans in which free space is
white and a pixel is 0.05 m, drives through each, and prints how many maps of each method are good
(see `experiments.good_maps`): with true poses, with those of the pose graph, and with poses that
each err by 2 cm. Plans: Bormann et al., "Room segmentation: survey, implementation, and analysis",
ICRA 2016.
"""

import argparse
from collections import deque
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from PIL import Image
from scipy import ndimage

from segmap import METHODS, SegmentMap, alignment, build_map, simulation
from segmap.arrays import Array
from segmap.metrics import against_walls

from .measure import Row

PIXEL_M = 0.05
#: Cells of the way, in pixels; stops are six of them apart.
COARSE_PIXELS = 4
#: Of the robot's middle from a wall, metres.
CLEARANCE_M = 0.45
DRIVE_M = 60.0
#: Name in the table -> method and thresholds.
TRIED = {
    "one_per_wall": partial(METHODS["one_per_wall"]),
    **{f"least_cost {p}": partial(METHODS["least_cost"], penalty=p) for p in (0.05, 0.5, 1, 1.6)},
    "hybrid_fusion": partial(METHODS["hybrid_fusion"], distance=0.10, tolerance=0.04),
    "fusion": partial(METHODS["fusion"]),
    "segment_similarity": partial(METHODS["segment_similarity"], distance=0.045),
}


def walls_of(free: Array) -> Array:
    """Runs of pixel edges between free space and the rest, `(n, 2, 2)`, metres."""
    found = []
    padded = np.pad(free, 1).astype(int)
    for axis in (0, 1):
        steps = np.diff(padded, axis=axis)
        for r, row in enumerate(steps if axis == 0 else steps.T):
            for sign in (1, -1):
                ends = np.flatnonzero(np.diff(np.r_[0, (row == sign).astype(int), 0]))
                for a, b in ends.reshape(-1, 2):
                    wall = np.array([(a, r + 1), (b, r + 1)])
                    found.append(wall if axis == 0 else wall[:, ::-1])
    return np.array(found) * PIXEL_M


def way_through(free: Array, rng: np.random.Generator) -> Array:
    """Poses of a drive between random places of the largest room space, `(k, 3)`."""
    label, count = ndimage.label(free)
    border = {*label[0], *label[-1], *label[:, 0], *label[:, -1]}
    sizes = np.bincount(label.ravel(), minlength=count + 1)
    inside = max((sizes[k], k) for k in range(1, count + 1) if k not in border)[1]
    clear = ndimage.distance_transform_edt(label == inside) * PIXEL_M > CLEARANCE_M
    joined, _ = ndimage.label(clear)
    open_ = (joined == np.bincount(joined[joined > 0]).argmax())[::COARSE_PIXELS, ::COARSE_PIXELS]
    cells = np.argwhere(open_)
    way, metres = [tuple(cells[rng.integers(len(cells))])], 0.0
    while metres < DRIVE_M:
        path = shortest(open_, way[-1], tuple(cells[rng.integers(len(cells))]))
        way, metres = way + path[1:], metres + len(path) * COARSE_PIXELS * PIXEL_M
    stops = (np.array(way)[::6, ::-1] + 0.5) * COARSE_PIXELS * PIXEL_M
    apart = np.hypot(*np.diff(stops, axis=0).T) > PIXEL_M
    return simulation.drive(stops[np.r_[True, apart]], step=0.3, turn=np.radians(30))


def shortest(free: Array, start: tuple[int, ...], goal: tuple[int, ...]) -> list[tuple[int, ...]]:
    """Cells from start to goal, or the start alone where there is no way."""
    before, todo = {start: start}, deque([start])
    while todo and goal not in before:
        i, j = todo.popleft()
        for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            there = (i + a, j + b)
            within = 0 <= there[0] < free.shape[0] and 0 <= there[1] < free.shape[1]
            if within and free[there] and there not in before:
                before[there] = (i, j)
                todo.append(there)
    if goal not in before:
        return [start]
    path = [goal]
    while path[-1] != start:
        path.append(before[path[-1]])
    return path[::-1]


def is_good(walls: Array, map: SegmentMap, true: SegmentMap, method: partial, most: float) -> bool:
    """Whether all four hold; `most` is how far off a map may lie, metres."""
    found = against_walls(walls, method(map), seen=true)
    missed, invented = (np.sum(m) / found.seen.sum() for m in (found.missed, found.invented))
    near = found.per_wall <= 1.1 and found.offset <= most
    return bool(near and missed <= 0.01 and invented <= 0.03)


def rows() -> Iterator[Row]:
    """One that says how to start it: pictures of plans are not part of the project."""
    yield Row(
        "reduced maps of floor plans", "skipped", "python -m benchmarks.bench_plans FOLDER NAME"
    )


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("folder", type=Path)
    asked.add_argument("names", nargs="+")
    given, found = asked.parse_args(), []
    for name in given.names:
        new = np.random.default_rng
        free = np.array(Image.open(given.folder / f"{name}.png").convert("L")) > 250
        walls, way = walls_of(free), way_through(free, new(0))
        wheels, eye = simulation.OdometryNoise(), simulation.SICK_LMS200
        log = simulation.simulate(walls, way, sensor=eye, odometry_noise=wheels, rng=new(0))
        graph = alignment.align_to_truth(alignment.pose_graph(log).poses, way, best=True)
        off = 1000 * np.median(np.hypot(*(graph - way)[:, :2].T))
        print(f"{name}: {len(log)} scans, poses of the graph {off:.0f} mm off (median)", flush=True)
        erring = way + new(0).normal(size=way.shape) * (0.02, 0.02, np.radians(0.3))
        true = build_map(log, way, keep_points=True)
        for kind, poses, most in (
            ("true", way, 0.01),
            ("graph", graph, 0.01),
            ("2 cm", erring, 0.02),
        ):
            seen = build_map(log, poses, keep_points=True)
            found += [(kind, m, is_good(walls, seen, true, f, most)) for m, f in TRIED.items()]
    table = pd.DataFrame(found, columns=["poses", "method", "good"])
    print(table.pivot_table("good", "method", "poses", aggfunc="sum").to_string())


if __name__ == "__main__":
    main()
