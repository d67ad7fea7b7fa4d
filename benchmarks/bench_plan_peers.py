"""Rooms of published maps by other methods, beside `floor_plan`, from the same free space.

Bormann et al. 2016 compare four families; each stands here as its paper's idea with a few lines of
scipy, thresholds as that survey gives them where it does. None tells walls or doors.

`python -m benchmarks.bench_plan_peers FOLDER` prints intersection over union, precision, CPU s.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import ndimage

from segmap import build_map, quadtree, reduction
from segmap.arrays import Array
from segmap.plan import floor_plan

from . import bench_plan
from .bench_plan import PIXEL_M, Known, Labels
from .measure import Row

Mask = NDArray[np.bool_]
#: Rooms by erosion have between so many square metres.
ERODED_M2 = 0.8, 47.0
#: Seeds of rooms where the distance to walls is large have so much, square metres.
SEED_M2 = 0.35, 163.0
#: Maxima of the distance to walls so near one another are one room, metres.
PEAK_M = 1.5
#: A place of the Voronoi graph is critical where it is the narrowest so far around, metres, and
#: nearer to walls than this; the walls on both sides of the graph lie so far apart at least.
NARROWEST_M, DOOR_M, SIDES_M = 1.0, 1.25, 0.5
#: What is cut off and smaller goes to its neighbours, square metres.
LEAST_M2 = 1.5
#: A seen square is free where fewer rays ended.
FREE_SHARE = 0.5


def away_from_walls(free: Mask) -> Array:
    """Metres from each free pixel to the nearest that is not."""
    return np.asarray(ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * PIXEL_M)


def grown(labels: Labels, free: Mask) -> Labels:
    """Each free pixel goes to the room that reaches it first."""
    left = 1
    while left:
        around = np.where(free & (labels == 0), ndimage.grey_dilation(labels, (3, 3)), 0)
        left = np.count_nonzero(around)
        labels = labels + around
    return labels


def sized(mask: Mask, least: float, most: float) -> Labels:
    """The parts of a mask whose area is within bounds, square metres, numbered from 1."""
    found = ndimage.label(mask)[0]
    area = np.bincount(found.ravel()) * PIXEL_M**2
    right = (area >= least) & (area <= most)
    right[0] = False
    return np.where(right, np.cumsum(right), 0)[found]


def watershed(free: Mask) -> Labels:
    """Basins of the distance to walls, turned over: from its maxima down to where two meet."""
    away = ndimage.gaussian_filter(away_from_walls(free), 2)
    peaks = (away == ndimage.maximum_filter(away, round(2 * PEAK_M / PIXEL_M))) & free
    markers = ndimage.label(peaks, np.ones((3, 3)))[0]
    markers[~free] = -1
    deep = np.where(free, np.clip(away.max() - away, 0, None) / away.max() * 65000, 65535)
    return np.clip(ndimage.watershed_ift(deep.astype(np.uint16), markers), 0, None) * free


def morphological(free: Mask) -> Labels:
    """Free space is eroded; a part that comes off with the area of a room is one."""
    left, found = free, np.zeros(free.shape, np.int64)
    while left.any():
        left = ndimage.binary_erosion(left)
        rooms = sized(left, *ERODED_M2)
        found[rooms > 0] = rooms[rooms > 0] + found.max()
        left = left & (rooms == 0)
    return grown(found, free)


def distance(free: Mask) -> Labels:
    """Where walls are farther than a threshold: the one that leaves the most rooms."""
    away = away_from_walls(free)
    tried = [sized(away > far, *SEED_M2) for far in np.arange(0.2, 2.0, PIXEL_M)]
    return grown(max(tried, key=np.max), free)


def voronoi(free: Mask) -> Labels:
    """Cuts from wall to wall through the narrowest places of the Voronoi graph.

    Of the survey's rules that join small parts to larger ones only the last is here.
    """
    away, free = away_from_walls(free), free.copy()
    wall = ndimage.distance_transform_edt(free, return_distances=False, return_indices=True)
    nearest = np.moveaxis(wall, 0, -1)
    ends, graph = np.stack([nearest] * 2, -2), np.full(free.shape, np.inf)
    for a, b in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
        apart = np.hypot(*np.moveaxis(nearest[a] - nearest[b], -1, 0)) * PIXEL_M
        on = free[a] & free[b] & (apart > np.maximum(SIDES_M, 1.6 * away[a]))
        graph[a][on] = away[a][on]
        ends[a][on] = np.stack([nearest[a][on], nearest[b][on]], 1)
    narrow = graph == ndimage.minimum_filter(graph, round(2 * NARROWEST_M / PIXEL_M) + 1)
    for one, other in ends[narrow & (graph < DOOR_M)]:
        steps = np.linspace(0, 1, 2 * int(abs(one - other).max()) + 2)[:, None]
        row, column = np.rint(one + steps * (other - one)).astype(int).T
        free[row, column] = free[np.minimum(row + 1, len(free) - 1), column] = False
    whole = away > 0
    return grown(sized(free, LEAST_M2, np.inf), whole)


PEERS: dict[str, Callable[[Mask], Labels]] = {
    "watershed": watershed, "morphological": morphological, "distance": distance,
    "Voronoi": voronoi,
}  # fmt: skip


def seen_free(free: quadtree.QuadtreeMap, shape: tuple[int, ...]) -> Mask:
    """Pixels of a map that were seen free."""
    row, column = (k.ravel() for k in np.indices(shape))
    places = (np.column_stack([column, row]) + 0.5) * PIXEL_M
    return np.asarray((free.occupancy(places) < FREE_SHARE).reshape(shape))


def peer_rows(
    known: Known, reduced: reduction.Reduction, free: quadtree.QuadtreeMap
) -> Iterator[dict[str, object]]:
    """What each method makes of a map, and ours."""
    seen = seen_free(free, known.free.shape)
    ours = {
        "floor_plan": lambda seen: bench_plan.room_pixels(floor_plan(reduced, free), seen.shape)
    }
    for name, method in (ours | PEERS).items():
        start = time.process_time()
        found = np.asarray(method(seen), np.int64)
        took = time.process_time() - start
        union, precision = bench_plan.agreement(found, known)
        yield {"map": known.name, "method": name, "union": union, "precision": precision,
               "rooms": len(np.unique(found[found > 0])), "seconds": took}  # fmt: skip


def rows() -> Iterator[Row]:
    yield Row("rooms by other methods", "skipped", "python -m benchmarks.bench_plan_peers FOLDER")


def main() -> None:
    parser = argparse.ArgumentParser("python -m benchmarks.bench_plan_peers", description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=bench_plan.FOLDER)
    parser.add_argument("--maps", nargs="+", default=[], help="names of some maps")
    asked, found = parser.parse_args(), list[dict[str, object]]()
    for known in bench_plan.known_maps(asked.folder):
        if asked.maps and known.name not in asked.maps:
            continue
        log = bench_plan.log_of(known, rng=np.random.default_rng(0))
        walls = reduction.one_per_wall(build_map(log, log.truth, keep_points=True).filtered(0.1))
        free = quadtree.build_map(log, log.truth, resolution=PIXEL_M, free_resolution=PIXEL_M)
        found += peer_rows(known, walls, free)
        print(pd.DataFrame(found[-5:]).round(3).to_string(index=False), flush=True)
    table = pd.DataFrame(found)
    furnished = table["map"].str.endswith("_furnitures")
    table["kind"] = np.where(furnished, "furnished", "empty")
    means = table.groupby(["kind", "method"])[["union", "precision", "rooms", "seconds"]].mean()
    print(means.round(3).to_string())


if __name__ == "__main__":
    main()
