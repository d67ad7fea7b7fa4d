"""A distance field: the distance to the nearest occupied cell or wall, once for a window."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array, Metres, checked
from ..compiled import compiled
from ..kernels import off_segment
from ..poses.motions import transform
from ..quadtree import QuadtreeMap
from ..segments import SegmentMap, point_distance
from ._scores import Cells, Counts, blocks_of, scan_and_poses, whole

#: What a scan is laid on: squares, or walls.
Map = QuadtreeMap | SegmentMap

Singles = NDArray[np.float32]
Unsigned = NDArray[np.uint32]
#: Distances are whole numbers, the longest in a window below this: 32 bits.
MOST_WINDOW_DISTANCE = 2**31 - 1
#: Around the ends of a scan at its start, metres: how far a matcher may move them.
MATCHER_MARGIN_M = 0.5
#: Cells of a window along a side: 32 bits hold every distance.
MOST_SIDE_CELLS = 2**14
#: Cells of a window in all: a quarter of a GB.
MOST_WINDOW_CELLS = 2**26
#: Stands for a column without an occupied cell: more cells than a window may have a side.
NO_OCCUPIED_CELL = 30_000
#: Points beyond lie outside every window, metres.
FAR_AWAY = 1e9


class NothingNear(ValueError):
    """The window holds no occupied cell or wall."""


class DistanceField:
    """Distances to the nearest occupied cell, or the nearest wall, looked up by cell.

    A point counts as its cell's centre: the score differs from `distance_score` by at most
    `resolution / sqrt(2)` a beam where the window holds all ends and the cells nearest to them.
    Occupied cells outside the window do not count, which can only lower the score of ends inside;
    walls outside do.

    Parameters
    ----------
    map : QuadtreeMap or SegmentMap
        Scans that are inserted later do not change the field.
    window : (4,) sequence, metres, or None
        Left, low, right, high edge. A point beyond counts as on it. By default the whole root, or
        what holds all walls and half a metre more.
    resolution
        Side of a cell, for a SegmentMap only; the cells of a quadtree are its own.

    Attributes
    ----------
    cells : (rows, columns) int32 array
        Distances, row 0 lowest, in parts of a cell. They are the exact Euclidean distance transform
        of Meijster, Roerdink and Hesselink (2000), or, for walls, the distance from the cell's
        centre; B has none.
    unit : int
        How many parts a cell has.

    Raises
    ------
    ValueError
        For a window without area, of too many cells, or one that holds no occupied cell or whose
        circle no wall meets.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.1)
    >>> tree.insert_scan((0, 0), [(1.05, 0.05)])
    >>> DistanceField(tree).score([(1.05, 0.05)], [(0, 0, 0), (0.3, 0, 0)]).round(6) + 0
    array([ 0. , -0.3])
    >>> DistanceField(SegmentMap([[(0, 0), (2, 1)]])).score([(2.025, 0.025)], (0, 0, 0)).round(4)
    array([-0.8832])
    """

    @checked
    def __init__(
        self, map: Map, window: ArrayLike | None = None, *, resolution: Metres = 0.05
    ) -> None:
        either_map(map)
        if isinstance(map, SegmentMap):
            corner, side, ends = np.zeros(2), resolution, map.segments.reshape(-1, 2)
            bounds = *(ends.min(0) - MATCHER_MARGIN_M), *(ends.max(0) + MATCHER_MARGIN_M)
        else:
            corner, side, bounds = map.corner, map.resolution, map.bounds
        first, (columns, rows) = _cells_of_window(
            bounds if window is None else window, corner, side
        )
        corner = corner + first * side
        self.unit = MOST_WINDOW_DISTANCE // (columns + rows)
        self.cells = np.full((rows, columns), NO_OCCUPIED_CELL, np.int32)
        self._frame = np.array([*corner, side, columns, rows, -side / self.unit])
        if isinstance(map, SegmentMap):
            self._measure(map.segments, corner)
        else:
            self._transform(map, first)

    def _transform(self, map: QuadtreeMap, first: Cells) -> None:
        """The field of the occupied cells in the window, whose first cell is given."""
        rows, columns = self.cells.shape
        with map.lock:
            x0, y0 = (first - map.tree.corner).tolist()
            x, y = map.tree.occupied_cells(np.array([x0, y0, x0 + columns, y0 + rows])).T
        if not len(x):
            raise NothingNear("the window holds no occupied cell, so no pose in it has a score")
        self.cells[y - y0, x - x0] = 0
        transform_cells(self.cells, self.unit)

    def _measure(self, walls: Array, corner: Array) -> None:
        """The field of all walls, `(n, 2, 2)`."""
        walls, size = (walls - corner) / self._frame[2], np.array(self.cells.shape[::-1])
        if not point_distance(size / 2, walls).min(initial=np.inf) <= np.hypot(*size) / 2:
            raise NothingNear("the window holds no wall, so no pose in it has a score")
        level = int(size.max() - 1).bit_length()
        near, begin = np.empty((level + 2) * len(walls), np.int64), np.empty(level + 2, np.int64)
        away, todo = np.empty(len(walls)), np.empty((3 * level + 4, 3), np.int64)
        wall_distances(walls, self.unit, level, near, begin, away, todo, self.cells)

    @classmethod
    def around(
        cls, map: Map, points: ArrayLike, poses: ArrayLike, *, resolution: Metres = 0.02
    ) -> DistanceField:
        """The field that a scan needs near poses: a box about robot and ends, and half a metre.

        Points and poses are those of `occupancy_score`. The resolution, of a SegmentMap only, is
        finer than for a whole map: a matcher moves by centimetres.

        Examples
        --------
        >>> tree = QuadtreeMap(resolution=0.1)
        >>> tree.insert_scan((0, 0), [(1.05, 0.05)])
        >>> DistanceField.around(tree, [(1.05, 0.05)], (0, 0, 0))
        DistanceField(21 x 11 cells of 0.1 m)
        """
        either_map(map, empty=True)
        ends, at = scan_and_poses(points, poses)
        if not len(at):
            raise ValueError("poses must hold at least one pose, to know where the scan is")
        placed = np.concatenate([at[:, :2], transform(at, ends).reshape(-1, 2)])
        window = [*(placed.min(0) - MATCHER_MARGIN_M), *(placed.max(0) + MATCHER_MARGIN_M)]
        return cls(map, window, resolution=resolution)

    @property
    def distance(self) -> Array:
        """Distances to the nearest occupied cell, (rows, columns) array, metres, row 0 lowest."""
        return self.cells * -self._frame[5]

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, low, right and high edge of the window, metres: whole cells."""
        x_min, y_min, side, columns, rows, _ = self._frame.tolist()
        return x_min, y_min, x_min + columns * side, y_min + rows * side

    def score(self, points: ArrayLike, poses: ArrayLike) -> Array:
        """Minus the sum of the distances at each pose, `(k,)`, metres, as of `occupancy_score`."""
        ends, at = scan_and_poses(points, poses)
        return self.scorer(ends)(at)

    def scorer(self, points: ArrayLike) -> Callable[[Array], Array]:
        """The score as a function of poses `(k, 3)` alone, for a matcher, which asks often.

        It does not check the poses: they must be an array of finite floats.

        Examples
        --------
        >>> tree = QuadtreeMap(resolution=0.1)
        >>> tree.insert_scan((0, 0), [(1.05, 0.05)])
        >>> values = DistanceField(tree).scorer([(1.05, 0.05)])
        >>> values(np.array([(0.3, 0.0, 0.0)])).round(6)
        array([-0.3])
        """
        near = np.clip(scan_and_poses(points, np.zeros(3))[0], -FAR_AWAY, FAR_AWAY)
        ends = np.ascontiguousarray(near.T, np.float32)
        flat = self.cells.ravel()

        def score(poses: Array) -> Array:
            """The score at each pose."""
            cells, scores = np.empty(len(near), np.uint32), np.empty(len(poses))
            look_up(flat, self._frame, ends, poses, cells, scores)
            return scores

        return score

    def __repr__(self) -> str:
        rows, columns = self.cells.shape
        return f"DistanceField({columns} x {rows} cells of {self._frame[2]:.6g} m)"


def either_map(map: object, *, empty: bool = False) -> None:
    """Refuse what is neither of the two maps, and, unless it may be, an empty one."""
    if not isinstance(map, Map):
        got = arrays.brief(map)
        raise ValueError(f"map must be a QuadtreeMap or a SegmentMap, got {got}")
    if isinstance(map, QuadtreeMap) and not empty:
        blocks_of(map)
    elif isinstance(map, SegmentMap) and not (empty or len(map)):
        raise ValueError("the map holds no wall, so no pose has a score")


def fits(columns: float, rows: float) -> None:
    """Refuse a window of too many cells."""
    if max(columns, rows) > MOST_SIDE_CELLS or columns * rows > MOST_WINDOW_CELLS:
        raise ValueError(
            f"a window of {columns:.9g} x {rows:.9g} cells is too large: at most {MOST_SIDE_CELLS} "
            f"a side and {MOST_WINDOW_CELLS} in all; give a smaller one, or a coarser map"
        )


def _cells_of_window(
    window: ArrayLike, corner: Array, side: float
) -> tuple[Cells, tuple[int, int]]:
    """First cell of a window, counted from a map's first corner, and its columns and rows."""
    edges = arrays.numbers(window, "window")
    if edges.shape != (4,) or not np.isfinite(edges).all() or (edges[2:] <= edges[:2]).any():
        raise ValueError(f"window must be left, low, right, high in metres, got {window!r}")
    edges = (edges.reshape(2, 2) - corner) / side
    first, beyond = np.floor(edges[0]), np.ceil(edges[1])
    count = beyond - first
    fits(*count)
    if (abs(first) > 2.0**60).any():
        raise NothingNear(f"the window {window!r} lies beyond every map")
    return first.astype(np.int64), (int(count[0]), int(count[1]))


def transform_cells(grid: Counts, unit: int) -> None:
    """Replace each cell of a grid by its distance to the nearest 0, in place.

    A grid holds 0 and `NO_OCCUPIED_CELL`.
    """
    columns = grid.shape[1]
    distance_transform(
        grid, unit, np.empty((columns, 3), np.int64), 0.5 / np.arange(1, columns + 1)
    )


# ---------------------------------------------------------------------------------- loops
@compiled
def wall_distances(
    walls: Array,
    unit: int,
    level: int,
    near: Cells,
    begin: Cells,
    away: Array,
    todo: Cells,
    grid: Counts,
) -> None:
    """Write the distance of each cell's centre from the nearest wall, in cells / `unit`.

    Walls `(n, 2, 2)` are in cells of the grid `(rows, columns)`. The square of `2^level` cells that
    holds the grid is quartered again and again; of the walls only those stay that can be nearest to
    a point of a square: no farther from its middle than the nearest and its whole diagonal. Those
    of a square of each level stand in `near`, `((level + 2) n,)`, one after the other; `begin`,
    `away` and `todo` are room to work in.
    """
    rows, columns = grid.shape
    todo[0, 0], todo[0, 1], todo[0, 2], used = 0, 0, level, 1
    for k in range(len(walls)):
        near[k] = k
    begin[level + 1], begin[level] = 0, len(walls)
    while used:
        used -= 1
        i, j, at = todo[used, 0], todo[used, 1], todo[used, 2]
        half, first, last = 0.5 * (1 << at), begin[at + 1], begin[at]
        least = np.inf
        for k in range(first, last):
            away[k - first] = off_segment(i + half, j + half, walls[near[k]])
            least = min(least, away[k - first])
        if at == 0:
            grid[j, i] = whole(least * unit + 0.5)
            continue
        end = last
        for k in range(first, last):
            if away[k - first] <= least + 2 * np.sqrt(2.0) * half:
                near[end] = near[k]
                end += 1
        begin[at - 1], width = end, 1 << (at - 1)
        for q in range(4):
            a, b = i + width * (q & 1), j + width * (q >> 1)
            if a < columns and b < rows:
                todo[used, 0], todo[used, 1], todo[used, 2] = a, b, at - 1
                used += 1


@compiled
def distance_transform(grid: Counts, unit: int, room: Cells, share: Array) -> None:
    """Replace each cell of a grid `(rows, columns)` by its distance to the nearest 0.

    A grid holds 0 and `NO_OCCUPIED_CELL`. In place, in cells / `unit`. First along the columns;
    then, in each row, by the lower envelope of the parabolas that stand on its columns, left to
    right, which is exact (Meijster, Roerdink and Hesselink 2000). Of each parabola that is lowest
    anywhere `room`, `(columns, 3)`, holds its column, where it begins to be lowest, and its height;
    `share[k]` is `1 / (2 k + 2)`.
    """
    rows, columns = grid.shape
    for k in range(1, 2 * rows - 1):  # down, and up again
        i, before = (k, k - 1) if k < rows else (2 * rows - 2 - k, 2 * rows - 1 - k)
        for j in range(columns):
            grid[i, j] = grid[before, j] + 1 if grid[before, j] < grid[i, j] else grid[i, j]
    for i in range(rows):
        last = -1
        for j in range(columns):
            if grid[i, j] >= NO_OCCUPIED_CELL:
                continue
            g, begin = whole(grid[i, j]) * grid[i, j], 0
            while last >= 0:
                v, t, h = room[last, 0], room[last, 1], room[last, 2]
                if (t - v) * (t - v) + h <= (t - j) * (t - j) + g:
                    begin = whole((g + j * j - h - v * v) * share[j - v - 1]) + 1
                    break
                last -= 1
            if begin < columns:
                last += 1
                room[last, 0], room[last, 1], room[last, 2] = j, begin, g
        until = columns
        for k in range(last, -1, -1):
            for j in range(room[k, 1], until):
                square = (j - room[k, 0]) * (j - room[k, 0]) + room[k, 2]
                grid[i, j] = whole(np.sqrt(square) * unit + 0.5)
            until = room[k, 1]


@compiled
def look_up(
    field: Counts, frame: Array, points: Singles, poses: Array, cells: Unsigned, scores: Array
) -> None:
    """Write the sum of the field under points `(2, n)` at each pose `(k, 3)`.

    A point beyond the edge counts as on it.
    `frame` holds left and low edge, cell side, columns, rows, and what the field's unit is worth;
    `cells`, `(n,)`, is room to work in. Single precision and whole numbers let the compiler take
    eight beams at a time.
    """
    x0, y0, side, columns = frame[0], frame[1], frame[2], np.int32(frame[3])
    zero, most_x, most_y = np.float32(0.0), np.float32(frame[3] - 1.0), np.float32(frame[4] - 1.0)
    for k in range(len(poses)):
        c, s = np.float32(np.cos(poses[k, 2]) / side), np.float32(np.sin(poses[k, 2]) / side)
        dx, dy = np.float32((poses[k, 0] - x0) / side), np.float32((poses[k, 1] - y0) / side)
        for m in range(points.shape[1]):
            x = c * points[0, m] - s * points[1, m] + dx
            y = s * points[0, m] + c * points[1, m] + dy
            x, y = min(most_x, max(zero, x)), min(most_y, max(zero, y))
            cells[m] = np.int32(y) * columns + np.int32(x)  # unsigned: none from the end
        total = whole(0)
        for m in range(points.shape[1]):
            total += field[cells[m]]
        scores[k] = total * frame[5]
