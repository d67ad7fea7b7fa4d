"""Floor plans of published maps against rooms that were drawn by hand (Bormann et al. 2016).

A folder holds, for each map, `NAME.png` (empty), `NAME_furnitures.png` and
`NAME_gt_segmentation.png`, 0.05 m a pixel: white is free, and in the last each white area is a
room. A laser is cast over the edges of the free pixels, from places all over them, at true poses;
`--drive` lets a robot with odometry drive by these places instead, and judges the plan at the true
poses and at those of the pose graph.

`--logs` judges the plans of two real logs by the pictures that were drawn of their buildings: each
map lies on its picture by the similarity with the best overlap of free pixels, found once.

`python -m benchmarks.bench_plan FOLDER` prints the table, map by map.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse import csgraph
from scipy.spatial.distance import cdist

from segmap import SegmentMap, alignment, build_map, quadtree, read, reduction
from segmap.arrays import Array
from segmap.metrics import against_walls
from segmap.plan import FloorPlan, floor_plan
from segmap.poses import transform
from segmap.scans import Log
from segmap.segments import length, point_distance
from segmap.simulation import Sensor, drive, simulate

from .measure import SHARED, Row, missing

FOLDER = SHARED / "data" / "plans"
#: Side of a pixel, metres.
PIXEL_M = 0.05
#: Brighter pixels are free.
WHITE = 250
#: Rooms of fewer pixels do not count, on either side.
LEAST_PIXELS = 100
#: Scans are taken on a square grid with this spacing, metres, this far from what is not free.
SPACING_M, CLEARANCE_M = 1.0, 0.25
#: A robot drives by places so far apart, over squares of so many pixels, and so far from walls,
#: metres; it scans after so many metres.
TOUR_M, COARSE_PIXELS, ROBOT_M, STEP_M = 2.0, 4, 0.3, 0.5
#: A whole turn, half a degree from beam to beam, with the noise of a good sensor.
LASER = Sensor("turning", 720, -np.pi, np.pi / 360, max_range=20.0, sigma=0.01)

#: Of a log, its picture, and how the map lies on it: x and y, metres, turn, radians, the logarithm
#: of the scale, and -1 where the picture is a mirror image. Free pixels overlap by .82 and .85 of
#: their mean; the rooms of FR079 to the lower right were not driven into.
PICTURES = {
    "fr079": ("Freiburg79_scan", (24.737, 11.316, 0.074, -0.177), 1),
    "intel": ("lab_intel", (16.962, 13.949, 1.995, 0.152), -1),
}

#: True walls of this length count, metres.
LEAST_TRUE_M = 1.0
#: Ends so near the crossing of their lines are a corner, metres.
CORNER_M = 0.3
#: A wall that ends so far behind a crossing is cut there; farther, it is a T, metres.
CUT_M = 0.1
#: Parallels so near are twins, metres.
TWIN_M = 0.12

Labels = NDArray[np.int64]


class Known(NamedTuple):
    """A published map: its free pixels, row 0 lowest, and the room of each, 0 for none."""

    name: str
    free: NDArray[np.bool_]
    rooms: Labels


def white_pixels(path: Path) -> NDArray[np.bool_]:
    """White pixels of a picture, row 0 lowest."""
    from PIL import Image

    with Image.open(path) as picture:
        return np.asarray(picture.convert("L"))[::-1] > WHITE


def known_maps(folder: Path) -> Iterator[Known]:
    """The maps of a folder, empty and furnished."""
    for truth in sorted(folder.glob("*_gt_segmentation.png")):
        name = truth.name.removesuffix("_gt_segmentation.png")
        rooms = true_rooms(white_pixels(truth))
        for kind in ("", "_furnitures"):
            if (path := folder / f"{name}{kind}.png").exists():
                yield Known(path.stem, white_pixels(path), rooms)


def true_rooms(white: NDArray[np.bool_]) -> Labels:
    """White areas that do not touch the border, numbered from 1."""
    found, _ = ndimage.label(white)
    edge = np.concatenate([found[0], found[-1], found[:, 0], found[:, -1]])
    found[np.isin(found, edge)] = 0
    return np.asarray(found, np.int64)


def pixel_edges(free: NDArray[np.bool_]) -> Array:
    """Sides between free pixels and others, those in one row joined: `(n, 2, 2)`, metres."""
    padded, found = np.pad(free, 1), []
    for axis in (0, 1):
        turned = padded if axis == 0 else padded.T
        for side in (1, -1):
            edge = turned & ~np.roll(turned, side, axis=0)
            steps = np.diff(edge.astype(np.int8), axis=1)
            row, start = np.nonzero(steps == 1)
            end = np.nonzero(steps == -1)[1]
            across = (row - 1 + (side == -1)) * PIXEL_M
            ends = [np.stack([(k - 0.0) * PIXEL_M, across], -1) for k in (start, end)]
            lines = np.stack(ends, 1)
            found.append(lines if axis == 0 else lines[..., ::-1])
    return np.concatenate(found)


def places_of(known: Known, apart: float, clear: float) -> NDArray[np.int64]:
    """Pixels `(k, 2)`, row and column: the freest of each block of `apart` metres."""
    free = ndimage.binary_opening(known.free, iterations=1)
    away = ndimage.distance_transform_edt(np.pad(known.free, 1))[1:-1, 1:-1] * PIXEL_M
    cells = np.argwhere(free & (away >= clear))
    block = pd.DataFrame(cells // round(apart / PIXEL_M), columns=["row", "column"])
    block["away"] = away[tuple(cells.T)]
    return cells[block.groupby(["row", "column"])["away"].idxmax().to_numpy()]


def log_of(known: Known, *, rng: np.random.Generator) -> Log:
    """Scans from places all over the free pixels, each at its true pose."""
    places = (places_of(known, SPACING_M, CLEARANCE_M)[:, ::-1] + 0.5) * PIXEL_M
    path = np.column_stack([places, rng.uniform(-np.pi, np.pi, len(places))])
    return simulate(pixel_edges(known.free), path, sensor=LASER, rng=rng, name=known.name)


def driven_log(known: Known, *, rng: np.random.Generator) -> Log:
    """Scans of a robot that drives, each time, to the nearest place that it has not been at."""
    away = ndimage.distance_transform_edt(np.pad(known.free, 1))[1:-1, 1:-1] * PIXEL_M
    clear = (away >= ROBOT_M)[::COARSE_PIXELS, ::COARSE_PIXELS]
    number, links = np.cumsum(clear).reshape(clear.shape) - 1, list[Any]()
    for a, b in (
        (np.s_[1:], np.s_[:-1]),
        (np.s_[:, 1:], np.s_[:, :-1]),
        (np.s_[1:, 1:], np.s_[:-1, :-1]),
        (np.s_[1:, :-1], np.s_[:-1, 1:]),
    ):
        both = clear[a] & clear[b]
        links.append(np.stack([number[a][both], number[b][both]]))
    i, j = np.concatenate(links, 1)
    cells = np.argwhere(clear)
    apart = np.hypot(*(cells[i] - cells[j]).T)
    graph = sparse.coo_array((apart, (i, j)), shape=(len(cells),) * 2).tocsr()
    part = csgraph.connected_components(graph, directed=False)[1]
    largest = part == np.bincount(part).argmax()
    block = pd.DataFrame(cells[largest] // round(TOUR_M / PIXEL_M / COARSE_PIXELS))
    block["away"] = away[tuple(cells[largest].T * COARSE_PIXELS)]
    left = np.flatnonzero(largest)[block.groupby([0, 1])["away"].idxmax().to_numpy()].tolist()
    way = [left.pop(0)]
    while left:
        far, before = csgraph.dijkstra(graph, False, indices=way[-1], return_predecessors=True)
        goal, leg = left.pop(int(far[left].argmin())), list[int]()
        while goal != way[-1]:
            leg, goal = [goal, *leg], int(before[goal])
        way += [*leg[2:-1:3], leg[-1]]
    stops = (cells[way][:, ::-1] * COARSE_PIXELS + 0.5) * PIXEL_M
    path = drive(stops, step=STEP_M, turn=np.pi / 4)
    return simulate(pixel_edges(known.free), path, sensor=LASER, rng=rng, name=known.name)


def agreement(found: Labels, known: Known) -> tuple[float, float]:
    """Intersection over union, mean over the true rooms; precision, mean over the found ones.

    `found` numbers the free pixels' rooms from 1; what has 0 lies in none.
    """
    both = np.where(known.free, found, 0), np.where(known.free, known.rooms, 0)
    table = np.zeros((both[0].max() + 1, both[1].max() + 1))
    np.add.at(table, both, 1)
    mine, true = table.sum(1), table.sum(0)
    common = table[1:, 1:]
    union = mine[1:, None] + true[None, 1:] - common
    large, wanted = mine[1:] > LEAST_PIXELS, true[1:] > LEAST_PIXELS
    overlap = (common / np.maximum(union, 1))[large].max(0, initial=0)[wanted]
    share = common.max(1, initial=0)[large] / mine[1:][large]
    return float(overlap.mean()), float(share.mean()) if large.any() else np.nan


def room_pixels(plan: FloorPlan, shape: tuple[int, ...]) -> Labels:
    """The room of each pixel, numbered from 1."""
    row, column = (k.ravel() for k in np.indices(shape))
    places = (np.column_stack([column, row]) + 0.5) * PIXEL_M
    return plan.room_at(places).reshape(shape) + 1


def corners(walls: Array, free: quadtree.QuadtreeMap) -> tuple[Array, Array, Array]:
    """Metres between both ends of each corner, `(k,)`, and from an end to the other wall.

    A corner: two ends at most 0.3 m from where their lines cross, at more than 20 degrees, with
    free space in the angle. An end is in the corner of its nearest crossing only. Where a wall goes
    on by more than 0.1 m behind the crossing it is none but a T, which the third array tells: to
    cut that wall would lose a piece of it, such as a jamb.
    """
    ends = walls.reshape(-1, 2)
    inward = (walls[:, ::-1] - walls).reshape(-1, 2)
    inward /= np.hypot(*inward.T)[:, None]
    i, j = np.nonzero(cdist(ends, ends) < 2 * CORNER_M)
    across = inward[i, 0] * inward[j, 1] - inward[i, 1] * inward[j, 0]
    steep = (i // 2 != j // 2) & (abs(across) > np.sin(np.radians(20)))
    i, j, across = i[steep], j[steep], across[steep]
    to = ends[j] - ends[i]
    t = (to[:, 0] * inward[j, 1] - to[:, 1] * inward[j, 0]) / across
    u = (to[:, 0] * inward[i, 1] - to[:, 1] * inward[i, 0]) / across
    middle = inward[i] + inward[j]
    place = ends[i] + t[:, None] * inward[i] + 0.15 * middle / np.hypot(*middle.T)[:, None]
    met = (abs(t) <= CORNER_M) & (abs(u) <= CORNER_M) & (free.occupancy(place) < 0.5)
    i, j, far, on = i[met], j[met], np.maximum(abs(t), abs(u))[met], np.maximum(t, u)[met]
    order = np.lexsort([j, far, i])
    first = order[np.diff(i[order], prepend=-1) > 0]
    nearest = dict(zip(i[first].tolist(), j[first].tolist(), strict=True))
    beyond = dict(zip(i[first].tolist(), on[first].tolist(), strict=True))
    pairs = [(a, b) for a, b in nearest.items() if nearest.get(b) != a or a < b]
    apart = np.array([np.hypot(*(ends[a] - ends[b])) for a, b in pairs])
    a, b = np.reshape(pairs, (-1, 2)).T
    off = [point_distance(ends[one], walls[other // 2]) for one, other in ((a, b), (b, a))]
    return apart, np.minimum(*off), np.array([beyond[a] > CUT_M for a, _ in pairs], bool)


def twins(walls: Array, side: NDArray[np.int64]) -> float:
    """Share of the length that has a parallel within 12 cm, with the same free side."""
    way = walls[:, 1] - walls[:, 0]
    size = np.hypot(*way.T)
    way = way / size[:, None]
    doubled = 0.0
    for k in range(len(walls)):
        normal = np.array([-way[k, 1], way[k, 0]])
        to = walls - walls[k, 0]
        same = abs(way @ normal) < np.sin(np.radians(10))
        same &= (abs(to @ normal) < TWIN_M).all(1) & (np.arange(len(walls)) != k)
        same &= side * np.sign(way @ way[k]) * side[k] >= 0
        covered = np.zeros(int(size[k] / 0.01) + 1, bool)
        for low, high in np.sort(to[same] @ way[k], 1):
            covered[int(max(low, 0) / 0.01) : max(0, int(high / 0.01))] = True
        doubled += covered.sum() * 0.01
    return doubled / size.sum()


def wall_row(plan: FloorPlan, before: Array, free: quadtree.QuadtreeMap) -> dict[str, float]:
    """How walls are drawn: shares of corners closed, of twins, of the length that is left.

    `closed` are shares of the corners, `met_2cm` of the T: an end on the other wall; `behind` is
    the share of the length, of segments above 0.5 m, that walls were drawn from: of twins one is
    left.
    """
    walls, sizes = plan.walls.segments, length(before)
    apart, off, tee = corners(walls, free)
    behind = plan.walls.parents >= 0
    return {
        "corners": int((~tee).sum()),
        "closed_2cm": float((apart[~tee] <= 0.02).mean()),
        "closed_10cm": float((apart[~tee] <= 0.1).mean()),
        "tees": int(tee.sum()),
        "met_2cm": float((off[tee] <= 0.02).mean()) if tee.any() else 1.0,
        "twins": twins(walls, plan.side),
        "shortest": float(length(walls).min()),
        "left": float(length(walls).sum() / sizes[sizes >= 0.5].sum()),
        "behind": float(sizes[behind & (sizes >= 0.5)].sum() / sizes[sizes >= 0.5].sum()),
    }


def known_row(known: Known, log: Log, poses: Array) -> tuple[dict[str, Any], FloorPlan]:
    """The figures of the plan of a log of a published map, and the plan."""
    raw = build_map(log, poses, keep_points=True).filtered(0.1)
    free = quadtree.build_map(log, poses, resolution=PIXEL_M, free_resolution=PIXEL_M)
    return row_of(known, raw, reduction.one_per_wall(raw), free)


def row_of(
    known: Known, raw: SegmentMap, reduced: reduction.Reduction, free: quadtree.QuadtreeMap
) -> tuple[dict[str, Any], FloorPlan]:
    """The figures of a published map, and its plan, from its segments and its free space."""
    start = time.process_time()
    plan = floor_plan(reduced, free)
    took = time.process_time() - start
    union, precision = agreement(room_pixels(plan, known.free.shape), known)
    walls = pixel_edges(known.free)
    walls = walls[length(walls) >= LEAST_TRUE_M]  # others are steps of a scanned line
    after, was = (against_walls(walls, each, seen=raw) for each in (plan.walls, reduced))
    lost = ((was.kept >= 1) & (after.kept < 0.5 * was.kept)).sum()
    row = {"map": known.name, "union": union, "precision": precision, "rooms": len(plan.rooms)}
    row |= {"true": int((np.bincount(known.rooms.ravel())[1:] > LEAST_PIXELS).sum())}
    row |= wall_row(plan, reduced.segments, free)
    row |= {"lost": int(lost), "per_wall": after.per_wall, "seconds": took}
    return row, plan


def logged_row(log: Log, known: Known, at: tuple[float, ...], mirror: int) -> dict[str, Any]:
    """How the plan of a real log, at the poses of the graph, agrees with a picture."""
    poses = alignment.pose_graph(log).trusted
    raw = build_map(log, poses, keep_points=True).filtered(0.1)
    free = quadtree.build_map(log, poses, resolution=PIXEL_M, free_resolution=PIXEL_M)
    reduced = reduction.one_per_wall(raw)
    plan = floor_plan(reduced, free)
    row, column = (k.ravel() for k in np.indices(known.free.shape))
    places = (np.column_stack([column, row]) + 0.5) * PIXEL_M
    x, y, turn, size = at
    turned = (places - (x, y)) @ transform((0, 0, -turn), np.eye(2)) / np.exp(size) * (1, mirror)
    found = plan.room_at(turned).reshape(known.free.shape) + 1
    union, precision = agreement(found, known)
    told: dict[str, Any] = {"map": log.name, "union": union, "precision": precision}
    return told | {"rooms": len(plan.rooms)} | wall_row(plan, reduced.segments, free)


def driven_rows(known: Known) -> Iterator[dict[str, Any]]:
    """The same drive at its true poses and at those of the pose graph."""
    log = driven_log(known, rng=np.random.default_rng(0))
    found = alignment.pose_graph(log)
    graph = alignment.align_to_truth(found.poses, log.truth, best=True)
    off = np.hypot(*(graph - log.truth)[:, :2].T)
    for poses, name, rms in (
        (log.truth, "true", 0.0),
        (graph, "graph", float(np.sqrt(np.nanmean(off**2)))),
    ):
        row, _ = known_row(known, log, poses)
        yield {"map": known.name, "poses": name, "scans": len(log), "rms": rms} | row


def table(folder: Path, names: list[str], *, drives: bool) -> pd.DataFrame:
    """All maps of a folder, or those with these names; then the means."""
    found = []
    for known in known_maps(folder):
        if names and known.name not in names:
            continue
        log = None if drives else log_of(known, rng=np.random.default_rng(0))
        for row in driven_rows(known) if log is None else [known_row(known, log, log.truth)[0]]:
            found.append(row)
            print(pd.DataFrame(found[-1:]).round(3).to_string(index=False), flush=True)
    return pd.DataFrame(found)


def rows() -> Iterator[Row]:
    if not FOLDER.exists():
        yield from missing("floor plans of published maps")
        return
    yield Row("floor plans of published maps", "skipped", "python -m benchmarks.bench_plan FOLDER")


def main() -> None:
    parser = argparse.ArgumentParser("python -m benchmarks.bench_plan", description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=FOLDER)
    parser.add_argument("--maps", nargs="+", default=[], help="names of some maps")
    parser.add_argument("--logs", action="store_true", help="two real logs")
    parser.add_argument("--drive", action="store_true", help="a drive, true poses and the graph's")
    asked = parser.parse_args()
    if asked.logs:
        by_name = {known.name: known for known in known_maps(asked.folder)}
        for name, (picture, at, mirror) in PICTURES.items():
            log = read(SHARED / "data" / f"{name}.log.gz")
            row = logged_row(log, by_name[picture], at, mirror)
            print(pd.DataFrame([row]).round(3).to_string(index=False), flush=True)
        return
    found = table(asked.folder, asked.maps, drives=asked.drive)
    found["kind"] = np.where(found["map"].str.endswith("_furnitures"), "furnished", "empty")
    for name, part in found.groupby(["kind", *found.columns.intersection(["poses"])]):
        means = part.mean(numeric_only=True).round(3)
        print(f"\n{', '.join(name)}, {len(part)} maps\n{means.to_string()}")


if __name__ == "__main__":
    main()
