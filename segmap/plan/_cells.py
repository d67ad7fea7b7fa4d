"""Cells between the lines of a building, and which openings between them are a door."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from ..arrays import Array
from ..poses import transform
from ..quadtree import FREE, OCCUPIED, UNKNOWN, QuadtreeMap
from ._lines import Indices, Line, merged_spans

#: Of the rays at an occupied square more than this share ended there.
OCCUPIED_ENDED_SHARE = 0.2
#: And at a free square at most this one: in thousands of scans somebody stood everywhere once.
FREE_ENDED_SHARE = 0.05
#: So many rays ended at an occupied square, or crossed a free one.
LEAST_RAYS = 2
#: Smaller holes, square metres, are clutter in rooms.
LEAST_HOLE_M2 = 0.5
#: The sides of a line are looked at so far off it, metres.
BESIDE_LINE_M = 1e-3
#: And farther, in squares, for the cell that lies there behind what is not free.
BESIDE_STEPS = 4
#: A jamb: so much of the wall is covered, over so much from where it begins; that is as near the
#: end of an opening, metres: the leaf of a door may stand between.
JAMB_M = 0.15
JAMB_REACH_M = 0.3
#: A wall goes on over gaps of so much, metres.
BRIDGED_M = 0.3
#: One that stands alone is at least so long, metres: what is shorter may be furniture.
SHORTEST_ALONE_M = 1.0
#: A wall stands across a line where the sine of their angle is larger.
ACROSS_SINE = 0.9
#: Two faces of one wall lie at most so far apart, metres; with one room at that distance on both
#: sides, it stands alone.
THICKEST_WALL_M = 0.5
#: Leaves of doors are no wider, metres.
WIDEST_LEAF_M = 1.1

Mask = NDArray[np.bool_]


class Grid(NamedTuple):
    """Squares `(rows, columns)`: unknown, free or occupied; metres.

    Row and column grow along `up` and `right` from the middle of the first square, `origin`. Not
    all that counts as free was `seen` to be.
    """

    kind: Indices
    seen: Mask
    origin: Array
    right: Array
    up: Array
    side: float

    def places(self, box: tuple[slice, ...] = np.s_[:, :]) -> Array:
        """Middles of the squares in a box, of all, `(rows, columns, 2)`."""
        sizes = zip(self.kind.shape, box, strict=True)
        rows, columns = (np.arange(n)[part, None] * self.side for n, part in sizes)
        return self.origin + (rows * self.up)[:, None] + columns * self.right

    def squares(self, points: Array) -> tuple[Indices, Indices]:
        """Rows and columns of points `(..., 2)`; beside the grid those of its border."""
        to = points - self.origin
        row, column = (np.rint(to @ way / self.side).astype(int) for way in (self.up, self.right))
        return row.clip(0, len(self.kind) - 1), column.clip(0, len(self.kind[0]) - 1)

    def box(self, points: Array) -> tuple[slice, ...]:
        """The smallest box of squares with all points in it."""
        return tuple(slice(k.min(), k.max() + 1) for k in self.squares(points))

    def on(self, segments: Array) -> Mask:
        """Which squares segments `(n, 2, 2)` cross."""
        is_on = np.zeros(self.kind.shape, bool)
        for start, end in segments:
            along = np.linspace(0, 1, int(np.hypot(*(end - start)) / self.side) + 2)[:, None]
            is_on[self.squares(start + along * (end - start))] = True
        return is_on

    def at(self, points: Array, values: Indices | None = None) -> Indices:
        """Kind of the squares at points, or other values of them."""
        return (self.kind if values is None else values)[self.squares(points)]


def grid_along(free: QuadtreeMap, turn: float, segments: Array, side: float) -> Grid:
    """Squares along an axis of the building, about all segments and all free space."""
    both, finest = free.leaves(), free.resolution
    cell = float(np.ldexp(finest, max(0, round(np.log2(side / finest)))))
    vis, x_min, y_min, _ = free.rasterize(both.vis, shown=both.vis > 0, resolution=cell)
    occ = free.rasterize(both.occ, shown=both.vis > 0, resolution=cell)[0]
    least = min(LEAST_RAYS, max(1, free.scans))  # a map of a grid has one ray a square
    kind = np.full(vis.shape, UNKNOWN)
    kind[(occ <= FREE_ENDED_SHARE * vis) & (vis >= least)] = FREE
    kind[(occ >= least) & (occ > OCCUPIED_ENDED_SHARE * vis)] = OCCUPIED
    right, up = transform((0, 0, turn), np.eye(2))
    free_points = np.argwhere(kind == FREE)[:, ::-1] * cell + (x_min + cell / 2, y_min + cell / 2)
    points = np.concatenate([free_points, segments.reshape(-1, 2)]) @ np.stack([right, up], -1)
    start = points.min(0) - 2 * side
    shape = np.ceil(np.ptp(points, axis=0) / side + 4).astype(int)[::-1]
    blank = np.full(shape, UNKNOWN)
    grid = Grid(blank, blank == FREE, start @ [right, up], right, up, side)
    column, row = np.moveaxis((grid.places() - (x_min, y_min)) / cell - 0.5, -1, 0)
    scipy.ndimage.map_coordinates(kind, [row, column], grid.kind, order=0, mode="grid-constant")
    hidden = scipy.ndimage.label(grid.kind == UNKNOWN)[0]
    small = np.bincount(hidden.ravel()) * side**2 < LEAST_HOLE_M2
    small[hidden[scipy.ndimage.maximum_filter(grid.kind, 3) == OCCUPIED]] = False
    grid.kind[small[hidden]] = FREE
    return grid._replace(seen=grid.kind == FREE)


def completed(grid: Grid, lines: list[Line], segments: Array, least: float) -> Grid:
    """The squares, where lines and segments cut the plane into faces.

    A face of which most was seen free is so in whole: furniture hides the rest of it, but where it
    is as narrow as a wall, and may be the inside of one. Outside the building nothing below so many
    square metres is free: a ray that grazes a large leaf frees it all.
    """
    is_clear = (grid.kind != OCCUPIED) & ~grid.on(segments)
    face = connected(cell_keys(grid.places(), lines), is_clear, 1)
    count = face.max() + 1
    size, seen = (np.bincount(face[k & is_clear], minlength=count) for k in (is_clear, grid.seen))
    is_outer = np.isin(np.arange(len(size)), [*face[0], *face[-1], *face[:, 0], *face[:, -1]])
    is_whole, is_small = ~is_outer & (2 * seen >= size), is_outer & (seen * grid.side**2 < least)
    wall = round(THICKEST_WALL_M / grid.side)
    low, high = scipy.ndimage.minimum_filter(face, wall), scipy.ndimage.maximum_filter(face, wall)
    is_whole &= np.isin(np.arange(count), face[low == high])
    kind = np.where(is_clear & is_whole[face], FREE, grid.kind)
    kind[is_clear & is_small[face] & grid.seen] = UNKNOWN
    return grid._replace(kind=kind)


class Run(NamedTuple):
    """An open stretch of a line, metres along it, and what makes it a doorway; or nothing.

    `jambs` are where the wall ends, on both sides: the leaf of a door may stand between. It is the
    mouth of a corridor, or a niche, where cross walls stand at both ends of one side.
    """

    line: int
    low: float
    high: float
    door: str
    jambs: list[float]
    mouth: bool


class Edges(NamedTuple):
    """Squares of all lines: the cells on both sides and the open run, `(n, 3)`, -1 for none."""

    squares: Indices
    runs: list[Run]


def cell_keys(points: Array, lines: list[Line]) -> Indices:
    """The place of points between the lines of each axis, as one whole number."""
    key = np.zeros(points.shape[:-1], np.int64)
    for axis in sorted({line.axis for line in lines}):
        mine = [line for line in lines if line.axis == axis]
        offsets = np.sort([line.offset for line in mine])
        key = key * (len(mine) + 1) + np.searchsorted(offsets, points @ mine[0].normal)
    return key


def connected(key: Indices, mask: Mask, least: float) -> Indices:
    """Numbers of the parts of a mask that touch and have one key, -1 below so many squares."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    number, pairs = np.cumsum(mask.ravel()).reshape(mask.shape) - 1, []
    for a, b in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
        same = mask[a] & mask[b] & (key[a] == key[b])
        pairs.append(np.stack([number[a][same], number[b][same]]))
    i, j = np.concatenate(pairs, 1)
    links = coo_array((np.ones(len(i), np.int8), (i, j)), shape=(mask.sum(),) * 2)
    group = connected_components(links, directed=False)[1]
    large = np.bincount(group) >= least
    numbers = np.full(mask.shape, -1)
    numbers[mask] = np.where(large, np.cumsum(large) - 1, -1)[group]
    return numbers


def unseen_border(grid: Grid, labels: Indices, least: float) -> Array:
    """Metres of the border of each room behind which nobody saw anything, neither free nor wall.

    Stretches below `least`, metres, do not count.
    """
    beside = (scipy.ndimage.minimum_filter(grid.kind, 3) == UNKNOWN) & (labels >= 0)
    beside[scipy.ndimage.maximum_filter(grid.kind, BESIDE_STEPS + 1) == OCCUPIED] = False
    stretch = scipy.ndimage.label(beside, np.ones((3, 3)))[0]
    beside &= np.bincount(stretch.ravel())[stretch] * grid.side >= least
    return np.bincount(labels[beside], minlength=labels.max() + 1).astype(np.float64) * grid.side


def edges_between(lines: list[Line], grid: Grid, cells: Indices, door: Array, band: float) -> Edges:
    """What lies between the cells on both sides of each line, square by square."""
    corners = grid.places()[[0, 0, -1, -1], [0, -1, 0, -1]]
    squares, runs, keys = list[Indices](), list[Run](), cell_keys(grid.places(), lines)
    walls = [(line, merged_spans(line.spans, BRIDGED_M)) for line in lines]
    walls = [(line, spans[np.ptp(spans, axis=1) >= SHORTEST_ALONE_M]) for line, spans in walls]
    for number, line in enumerate(lines):
        low, high = np.sort(corners @ line.way)[[0, -1]]
        at = np.arange(low, high, grid.side) + grid.side / 2
        points = at[:, None] * line.way + line.offset * line.normal
        clear, off = grid.at(points) == FREE, grid.side * line.normal
        clear &= (grid.at(points + off) != OCCUPIED) & (grid.at(points - off) != OCCUPIED)
        near = [k for k in lines if k.axis == line.axis and abs(k.offset - line.offset) <= band]
        spans = merged_spans(np.concatenate([one.spans for one in near]))  # the other face too
        which = np.searchsorted(spans[:, 0], at, "right") - 1
        covered = (which >= 0) & (at <= spans[which, 1])
        crossings = crossed(line, walls)
        run, clear = np.full(len(at), -1), np.concatenate([[False], clear & ~covered, [False]])
        for ends in (np.flatnonzero(np.diff(clear)).reshape(-1, 2) - (0, 1)).tolist():
            run[ends[0] : ends[1] + 1] = len(runs)
            runs.append(_open_run(number, at, covered, crossings, ends, door))
        sides = []
        for way in (line.normal, -line.normal):
            key, cell = cell_keys(points + BESIDE_LINE_M * way, lines), np.full(len(at), -1)
            for step in range(BESIDE_STEPS, 0, -1):
                there = grid.squares(points + step * grid.side * way)
                cell = np.where((cells[there] >= 0) & (keys[there] == key), cells[there], cell)
            sides.append(cell)
        squares.append(np.stack([*sides, run], -1))
    return Edges(np.concatenate(squares or [np.zeros((0, 3), np.int64)]), runs)


def crossed(line: Line, walls: list[tuple[Line, Array]]) -> Array:
    """Where walls, spans of other lines, meet a line, `(n, 3)`: metres along it, and on which side.

    The sides are that of the normal, and the other: 1 where the wall stands there.
    """
    crossings = [np.zeros((0, 3))]
    for other, spans in walls:
        across = float(line.way @ other.normal)
        if abs(across) > ACROSS_SINE and len(spans):
            at = (other.offset - line.offset * float(line.normal @ other.normal)) / across
            there = float((at * line.way + line.offset * line.normal) @ other.way)
            beyond = np.sort((spans - there) * np.sign(line.normal @ other.way), axis=1)
            touch = (beyond[:, 0] <= JAMB_REACH_M) & (beyond[:, 1] >= -JAMB_REACH_M)
            sides = beyond[touch, ::-1] * (1, -1) >= SHORTEST_ALONE_M / 2
            crossings.append(np.column_stack([np.full(len(sides), at), sides]))
    return np.concatenate(crossings)


def _open_run(
    line: int, at: Array, covered: Mask, crossings: Array, ends: list[int], door: Array
) -> Run:
    """The open run from the first of its squares to the last."""
    side, kinds, jambs, shut = float(at[1] - at[0]), list[str](), list[float](), np.ones(2, bool)
    reach, low, high = round(JAMB_REACH_M / side), at[ends[0]] - side / 2, at[ends[1]] + side / 2
    for inner, way in zip(ends, (-1, 1), strict=True):
        beyond = covered[inner + way :: way] if inner + way >= 0 else covered[:0]
        near = abs(crossings[:, 0] - at[inner]) <= JAMB_REACH_M + 2 * side
        walls = crossings[near, 1:].any(0)
        shut &= walls  # where both sides are, it is a corridor between cross walls
        start = int(beyond[:reach].argmax()) if len(beyond) else 0
        jamb = beyond[start : start + reach].sum() * side >= JAMB_M - side / 2
        size = int(np.append(beyond[start:], False).argmin()) * side
        along = way * (crossings[:, 0] - at[inner])
        meets = (along >= 0) & (along <= start * side + size + JAMB_REACH_M)
        jamb &= size >= SHORTEST_ALONE_M or bool(meets.any())
        kinds += ["a jamb"] if jamb else ["a cross wall"] * bool(walls.any())
        jambs.append(float(at[inner] + way * side * (start * jamb + 0.5)))
    mouth, widest = bool(shut.any()), float(door[1])
    if not mouth and "a cross wall" in kinds:  # else the end of a wall in a room
        widest = min(widest, WIDEST_LEAF_M)
    fits = not shut.all() and len(kinds) == 2 and float(door[0]) <= high - low <= widest
    words = " and ".join(kinds if fits else ())
    return Run(line, float(low), float(high), words, jambs, mouth)
