"""How many edits of a patient person make a floor plan right: joins and straight cuts.

A plan is judged on the pixels that lie in one of its rooms, over the published rooms of which half
lies there, by the mean of their intersection over union with the best room of the plan. The person
tries each join of two neighbours, and each cut of a room from border to border along eight
directions; what gains most is done by `FloorPlan.edited`, and the plan that comes out is judged.

`python -m benchmarks.bench_plan_edits FOLDER --logs` plays two real logs, and without `--logs` the
published maps with these names: the score after 0 to 20 edits.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
from scipy import ndimage

from segmap import alignment, build_map, quadtree, read, reduction
from segmap.arrays import Array
from segmap.plan import FloorPlan, Join, Split, floor_plan
from segmap.plan.edits import Edit
from segmap.plotting import draw_plan
from segmap.poses import transform
from segmap.scans import Log

from .bench_plan import FOLDER, LEAST_PIXELS, PICTURES, PIXEL_M, Known, Labels, known_maps, log_of
from .measure import SHARED, Row, missing

MOST_EDITS = 20
#: Cuts: directions in a half turn, metres between two that are parallel, pixels of the least piece.
DIRECTIONS, CUT_STEP_M, LEAST_PIECE = 8, 0.2, 200
#: Rooms whose pixels are so near can be joined, pixels.
NEAR_PIXELS = 8
#: Of what promises most so many edits are tried on the plan itself.
MOST_TRIED = 10
#: A published room counts where so much of it lies in rooms of the plan.
LEAST_SHARE = 0.5


class Seen(NamedTuple):
    """Pixels of a picture, their places in the plan, metres, and the true room of each.

    That is 0 where a pixel is free and in no room, -1 where it is not free.
    """

    places: Array  # (rows, columns, 2)
    true: Labels


def pixels(known: Known, to_plan: Callable[[Array], Array]) -> Seen:
    """The pixels of a published map."""
    row, column = np.indices(known.free.shape)
    places = (np.stack([column, row], -1) + 0.5) * PIXEL_M
    return Seen(to_plan(places), np.where(known.free, known.rooms, -1))


def rooms_at(plan: FloorPlan, seen: Seen) -> Labels:
    """The room of each pixel, numbered from 1, 0 for none."""
    return plan.room_at(seen.places.reshape(-1, 2)).reshape(seen.true.shape) + 1


class Score:
    """Intersection over union of the true rooms with rooms that are edited."""

    def __init__(self, rooms: Labels, true: Labels) -> None:
        size, there = (np.bincount(true[m]) for m in (true >= 0, (rooms > 0) & (true >= 0)))
        there = np.append(there, np.zeros(len(size) - len(there)))
        wanted = (size[1:] > LEAST_PIXELS) & (there[1:] >= LEAST_SHARE * size[1:])
        self.wanted = 1 + np.flatnonzero(wanted)
        self.true, self.sizes = true, there
        self.table = np.array([self.row(rooms == k) for k in range(1, rooms.max() + 1)])

    def row(self, room: Labels) -> Array:
        """Pixels of a room in each true room, and its size."""
        counts = np.bincount(self.true[room] + 1, minlength=len(self.sizes) + 1)[1:]
        return np.append(counts, counts.sum())

    def best(self, table: Array) -> Array:
        """Of each wanted true room the best intersection over union."""
        common = table[:, self.wanted]
        return (common / (table[:, -1:] + self.sizes[self.wanted] - common)).max(0)

    def mean(self, table: Array) -> float:
        return float(self.best(table).mean())

    def changed(self, rooms: list[int], by: list[Array]) -> float:
        """The mean after some rooms are replaced by others."""
        return self.mean(np.concatenate([np.delete(self.table, rooms, axis=0), np.array(by)]))


def joins(plan: FloorPlan, rooms: Labels, score: Score) -> Iterator[tuple[float, Edit]]:
    """Each join of two neighbours, and the mean after it."""
    for one in range(1, len(plan.rooms) + 1):
        near = ndimage.binary_dilation(rooms == one, iterations=NEAR_PIXELS)
        for other in np.unique(rooms[near & (rooms > one)]).tolist():
            a, b = (plan.rooms[k - 1].place for k in (one, other))
            both = score.table[one - 1] + score.table[other - 1]
            yield score.changed([one - 1, other - 1], [both]), Join(tuple(a), tuple(b))


def cuts(
    plan: FloorPlan, k: int, rooms: Labels, seen: Seen, score: Score
) -> list[tuple[float, Edit]]:
    """The best straight cut of a room, if one gains, and the mean after it."""
    best = [(score.mean(score.table), Edit())]
    if (score.table[k, score.wanted] > LEAST_PIECE).sum() < 2:
        return []
    own = rooms == k + 1
    box = ndimage.find_objects(own.astype(int))[0]
    own, places, true = own[box], seen.places[box], seen.true[box]
    shape = shapely.Polygon(plan.rooms[k].outline, plan.rooms[k].holes)
    for turn in plan.axes[0] + np.arange(DIRECTIONS) * np.pi / DIRECTIONS:
        way, normal = transform((0, 0, turn), np.eye(2))
        offsets, along = places @ normal, places @ way
        reach = np.array([along[own].min() - 1, along[own].max() + 1])[:, None] * way
        for offset in np.arange(offsets[own].min(), offsets[own].max(), CUT_STEP_M):
            line = shapely.LineString(reach + offset * normal)
            for part in shapely.get_parts(shapely.intersection(shape, line)):
                if shapely.get_dimensions(part) != 1:
                    continue
                ends = shapely.get_coordinates(part)[[0, -1]]
                low, high = np.sort(ends @ way)
                cut = own & (abs(offsets - offset) <= PIXEL_M)
                cut &= (along >= low - 2 * PIXEL_M) & (along <= high + 2 * PIXEL_M)
                pieces, count = ndimage.label(own & ~cut)
                counts = np.zeros((count + 1, len(score.sizes) + 1))
                np.add.at(counts, (pieces[own], true[own] + 1), 1)
                tables = [np.append(c, c.sum()) for c in counts[1:, 1:] if c.sum() > LEAST_PIECE]
                if len(tables) < 2:
                    continue
                mean = score.changed([k], tables)
                if mean > best[-1][0]:
                    best.append((mean, Split(tuple(ends[0]), tuple(ends[1]))))
    return best[1:][-1:]


def played(
    plan: FloorPlan, seen: Seen, most: int = MOST_EDITS
) -> Iterator[tuple[float, FloorPlan]]:
    """The mean after each edit, and the plan, as long as an edit gains."""
    rooms = rooms_at(plan, seen)
    score = Score(rooms, seen.true)
    yield score.mean(score.table), plan
    for _ in range(MOST_EDITS):
        options = list(joins(plan, rooms, score))
        for k in range(len(plan.rooms)):
            options += cuts(plan, k, rooms, seen, score)
        options.sort(key=lambda option: -option[0])
        for _, edit in options[:MOST_TRIED]:
            after = plan.edited([*plan.edits, edit])
            rooms_after = rooms_at(after, seen)
            score_after = Score(rooms_after, seen.true)
            gained = score_after.mean(score_after.table) > score.mean(score.table)
            if gained and not after.unplaced:
                break
        else:
            return
        plan, rooms, score = after, rooms_after, score_after
        yield score.mean(score.table), plan


def logged(name: str, known: dict[str, Known]) -> tuple[FloorPlan, Seen]:
    """The plan of a real log, and the picture of its building."""
    log = read(SHARED / "data" / f"{name}.log.gz")
    picture, (x, y, turn, size), mirror = PICTURES[name]

    def to_plan(places: Array) -> Array:
        turned = (places - (x, y)) @ transform((0, 0, -turn), np.eye(2))
        return turned / np.exp(size) * (1, mirror)

    return plan_of(log, alignment.pose_graph(log).trusted), pixels(known[picture], to_plan)


def plan_of(log: Log, poses: Array) -> FloorPlan:
    """The plan of a log, as `segmap plan` makes it."""
    seen = build_map(log, poses, keep_points=True).filtered(0.1)
    free = quadtree.build_map(log, poses, resolution=PIXEL_M, free_resolution=PIXEL_M)
    return floor_plan(reduction.one_per_wall(seen), free)


def drawn(plans: list[tuple[str, FloorPlan]], path: Path) -> None:
    """Plans side by side: rooms in colours, walls, doors."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9 * len(plans), 8), layout="constrained")
    for axes, (title, plan) in zip(
        figure.subplots(1, len(plans), squeeze=False)[0], plans, strict=True
    ):
        draw_plan(plan, ax=axes)
        axes.set_title(title)
    figure.savefig(path)


def rows() -> Iterator[Row]:
    if not FOLDER.exists():
        yield from missing("edits of floor plans")
        return
    yield Row("edits of floor plans", "skipped", "python -m benchmarks.bench_plan_edits FOLDER")


def main() -> None:
    parser = argparse.ArgumentParser("python -m benchmarks.bench_plan_edits", description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=FOLDER)
    parser.add_argument("--maps", nargs="+", default=[], help="names of some maps")
    parser.add_argument("--logs", action="store_true", help="two real logs")
    parser.add_argument("--pictures", type=Path, help="a folder for plans before and after")
    asked = parser.parse_args()
    known = {each.name: each for each in known_maps(asked.folder)}
    for name in asked.maps or ([*PICTURES] if asked.logs else [*known]):
        if asked.logs:
            first, seen = logged(name, known)
        else:
            log = log_of(known[name], rng=np.random.default_rng(0))
            first, seen = plan_of(log, log.truth), pixels(known[name], lambda places: places)
        plans = list[FloorPlan]()
        for count, (mean, plan) in enumerate(played(first, seen)):
            last = "".join(map(str, plan.edits[-1:]))
            print(f"{name}: {count:2d} {mean:.3f} {len(plan.rooms)} rooms {last}", flush=True)
            plans.append(plan)
        if asked.pictures:
            shown = {
                len(each.edits): each
                for each in plans
                if len(each.edits) in (0, 10, len(plans) - 1)
            }
            drawn([(f"{name}: {k} edits", each) for k, each in shown.items()],
                  asked.pictures / f"{name}.png")  # fmt: skip


if __name__ == "__main__":
    main()
