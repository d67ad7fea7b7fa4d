"""The tree itself, in whole cells: blocks of four nodes that double, split and join."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array
from ..kernels import Nodes, leaves_in
from ..threads import Locked, locked
from . import _kernels as kernels

#: What an error says of coordinates.
COORDINATES_UNIT = "metres (leave out beams without return)"
#: No cell is smaller, metres: single precision must hold coordinates counted in cells.
SMALLEST_CELL_M = 1e-6


class Leaves(NamedTuple):
    """Leaves as arrays `(n,)`: lower left corner and side in metres, rays that crossed, ends.

    Examples
    --------
    >>> from segmap.quadtree import QuadtreeMap
    >>> QuadtreeMap(resolution=0.5, size=2).leaves().side
    array([1., 1., 1., 1.])
    """

    x: Array
    y: Array
    side: Array
    vis: NDArray[np.int32]
    occ: NDArray[np.int32]


class Tree(Locked):
    """Nodes in blocks of four, and the root square that they divide.

    Cells are counted from the root's lower left one, but for `corner`.

    Attributes
    ----------
    vis, occ : (4 b,) int32 arrays
        Counts of leaves; `vis` of an inner node is the complement of its children's block.
    used : int
        Blocks in use.
    block, level : int
        Block of the root's children, and the level of the root: 2^level cells a side.
    largest : int
        The level that the root never exceeds.
    corner : (2,) int array
        The root's lower left cell, counted from where it was at first.
    version : int
        Grows with every change: what was computed from another version is out of date.
    """

    def __init__(self, level: int, largest: int) -> None:
        self.vis, self.occ = np.zeros(64, np.int32), np.zeros(64, np.int32)
        self.used, self.block, self.level, self.largest = 1, 0, level, largest
        self.corner, self.version = np.zeros(2, np.int64), 0
        self._occupied: tuple[int, kernels.Holds] = (-1, np.zeros(0, np.bool_))

    @locked
    def grow(self, cells: kernels.Cells, resolution: float) -> None:
        """Double the root until it holds all cells `(n, 2)`, in their order.

        Where a cell lies beyond the largest root, that is a ValueError, and the tree is as it was.
        """
        x, y, level, steps = 0, 0, self.level, []
        for cell_x, cell_y in cells.tolist():
            while not (0 <= cell_x - x < 1 << level and 0 <= cell_y - y < 1 << level):
                if level == self.largest:
                    raise ValueError(
                        f"the scan reaches beyond max_size, {np.ldexp(resolution, level):.6g} m, "
                        f"with cell {(self.corner + (cell_x, cell_y)).tolist()} of "
                        f"{resolution:.6g} m: the map is as it was"
                    )
                west, south = cell_x < x, cell_y < y
                steps.append(west + 2 * south)
                x, y, level = x - west * (1 << level), y - south * (1 << level), level + 1
        for quarter in steps:
            self._double(quarter)

    def _double(self, quarter: int) -> None:
        """Put the root into one quarter of a new one, whose other quarters nothing has crossed."""
        self._make_room(1)
        nodes = slice(4 * self.used, 4 * self.used + 4)
        self.vis[nodes], self.occ[nodes] = 0, 0
        self.vis[4 * self.used + quarter] = ~self.block
        corner = self.corner - np.array([quarter & 1, quarter >> 1]) * (1 << self.level)
        self.corner, self.level = corner, self.level + 1
        self.block, self.used, self.version = self.used, self.used + 1, self.version + 1

    @locked
    def insert(self, scan: kernels.Scan, at: tuple[Array, float], finest: int | None) -> bool:
        """Insert a scan (B 4.2 to 4.4); False where the root does not hold it: nothing was done.

        `at` are corner and resolution of the map, metres. Rays too split leaves above the level
        `finest`, where there is one: children then keep the count, and leaves that are alike join
        in the end.
        """
        ends, count = len(scan.points), sum(map(len, scan))
        cells, level = np.empty((count, 2), np.int64), -1 if finest is None else finest
        done, on_the_way = 0, np.zeros(2, np.int64)
        while done < ends + count:
            self._make_room(self.level)
            blocks, frame = self._blocks(), kernels.Frame(*at, self.corner, 1 << self.level)
            room = kernels.Room(cells, self._path(), on_the_way)
            self.used, done = kernels.insert(blocks, self.used, scan, frame, done, level, room)
            if done < 0:
                return False
            self.version += 1
        if finest is not None:
            self._compact(self.used, join=True)
        return True

    @locked
    def crop(self, corners: kernels.Cells) -> None:
        """Forget what lies outside a rectangle of cells, `(2, 2)`; leaves on its border split."""
        while True:
            node, first, level = self.leaves()
            last = first + (1 << level)[:, None]
            outside = ((last <= corners[0]) | (first >= corners[1])).any(1)
            within = ((first >= corners[0]) & (last <= corners[1])).all(1)
            self.vis[node[outside]], self.occ[node[outside]] = 0, 0
            border = node[~(outside | within) & (self.vis[node] > 0)]
            if not len(border):
                break
            self._make_room(len(border))
            blocks = np.arange(self.used, self.used + len(border), dtype=np.int32)
            nodes = 4 * blocks[:, None] + np.arange(4)
            self.vis[nodes], self.occ[nodes] = self.vis[border][:, None], 0
            self.vis[border], self.used = ~blocks, self.used + len(border)
        self._compact(self.used, join=True)

    @locked
    def mend(self) -> None:
        """Keep the blocks that the root reaches: an interrupt may have hidden how many are used."""
        self._compact(len(self.vis) // 4, join=False)

    def _compact(self, blocks: int, *, join: bool) -> None:
        """Renumber the blocks; first of all there are so many."""
        order, above = np.empty((2, blocks), np.int64)
        new = kernels.Blocks(*np.empty((2, min(6 * blocks, len(self.vis))), np.int32))
        self.used = kernels.compact(self._blocks(), self.block, join, order, above, new)
        (self.vis, self.occ), self.block, self.version = new, 0, self.version + 1

    @locked
    def leaves_at(self, cells: kernels.Cells) -> kernels.Cells:
        """Leaf of each cell `(n, 2)`; -1 outside the root."""
        leaves = np.empty(len(cells), np.int64)
        kernels.leaves_at(self.vis, cells, self._path(), leaves)
        return leaves

    @locked
    def leaves(self) -> tuple[kernels.Cells, kernels.Cells, kernels.Cells]:
        """Nodes `(n,)`, lower left cells `(n, 2)` and levels `(n,)` of all leaves."""
        leaves = self._leaves_in(np.array([0, 0, 1, 1]) << self.level, np.zeros(0, np.bool_))
        return leaves[:, 0], leaves[:, 1:3], leaves[:, 3]

    @locked
    def occupied_cells(self, window: kernels.Cells) -> kernels.Cells:
        """The occupied cells `(n, 2)` of a window: left, low, right and high, `(4,)`, in cells."""
        return self._leaves_in(window, self.occupied_blocks())[:, 1:3]

    def _leaves_in(self, window: kernels.Cells, holds: kernels.Holds) -> kernels.Cells:
        leaves = np.empty((3 * self.used + 1, 4), np.int64)
        todo = np.empty((4 * kernels.DEPTH, 4), np.int64)
        todo[0] = self.block, 0, 0, self.level
        return leaves[: leaves_in(Nodes(self.vis, self.occ, holds), window, todo, leaves)]

    @locked
    def occupied_blocks(self) -> kernels.Holds:
        """Which blocks hold an occupied cell (occupancy above 0.5), `(b,)`; kept until a change."""
        if self._occupied[0] != self.version:
            holds = np.zeros(self.used, np.bool_)
            kernels.occupied_blocks(self.vis, self.occ, holds)
            self._occupied = self.version, holds
        return self._occupied[1]

    def _blocks(self) -> kernels.Blocks:
        return kernels.Blocks(self.vis, self.occ)

    def _path(self) -> kernels.Cells:
        path = np.empty(self.level + 1, np.int64)
        path[-1] = self.block
        return path

    def _make_room(self, blocks: int) -> None:
        """Make sure that so many blocks can be added."""
        wanted = 4 * (self.used + blocks)
        if wanted > len(self.vis):
            room = 3 * wanted // 2
            self.vis, self.occ = np.resize(self.vis, room), np.resize(self.occ, room)


def level_of(name: str, length: float, resolution: float, *, least: int = 0) -> int:
    """The level of squares of a side in metres: a power of two of cells, at least `2^least`."""
    count = arrays.number(length, name, most=1e300, unit="metres") / resolution
    level = round(np.log2(count)) if 0 < count < 2.0**60 else -1
    if level < least or not np.isclose(count, 2.0**level, rtol=1e-9, atol=0):
        raise ValueError(
            f"{name} must be a power of two of cells of {resolution:.6g} m, at least {1 << least}, "
            f"got {length} m: {count:.6g} cells"
        )
    return level


def point_pairs(name: str, values: ArrayLike) -> Array:
    """Points as an array `(n, 2)`; whether they are finite is seen where their cells are found."""
    if arrays.ready(values) and values.shape[1:] == (2,):
        return values
    return np.array(arrays.table(values, name, 2, unit=COORDINATES_UNIT, limit=np.inf), order="C")
