"""The tree itself, in whole cells: blocks of four nodes that double, split and join (B 4.2)."""

import numpy as np
from numpy.typing import NDArray

from . import _loops as loops
from . import _whole_loops as whole

Cells = loops.Cells
Counts = loops.Counts


class Tree:
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
    corner : (2,) int array
        The root's lower left cell, counted from where it was at first.
    """

    def __init__(self, level: int, largest: int) -> None:
        self.vis, self.occ = np.zeros(64, np.int32), np.zeros(64, np.int32)
        self.used, self.block, self.level = 1, 0, level
        self.corner = np.zeros(2, np.int64)
        self.largest = largest

    def grow(self, cells: Cells) -> None:
        """Double the root until it holds all cells `(n, 2)`, in their order; first see that it may.

        Raises
        ------
        ValueError
            Where a cell lies beyond the largest root; the tree is then as it was.
        """
        x, y, level = 0, 0, self.level
        steps: list[int] = []
        outside = ((cells < 0) | (cells >= 1 << level)).any(1)
        for cell_x, cell_y in cells[outside].tolist():
            while not (0 <= cell_x - x < 1 << level and 0 <= cell_y - y < 1 << level):
                if level == self.largest:
                    raise ValueError(f"cell {(self.corner + (cell_x, cell_y)).tolist()}")
                left, down = cell_x < x, cell_y < y
                steps.append(left + 2 * down)
                x, y, level = x - left * (1 << level), y - down * (1 << level), level + 1
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
        self.block, self.used = self.used, self.used + 1

    def split_to(self, cells: Cells, *, inherit: bool) -> None:
        """Split the leaves of cells `(n, 2)` down to single cells."""
        done = 0
        while done < len(cells):
            self._make_room(self.level)
            self.used, done = loops.split_to_cells(
                self.vis, self.occ, self.used, self.block, self.level, cells, done, inherit
            )

    def count_ends(self, cells: Cells) -> None:
        """Count end points in their cells `(n, 2)`, which are leaves."""
        loops.count_ends(self.vis, self.occ, self.block, self.level, cells)

    def split_along(self, sensor: Cells, ends: Cells, masked: int, level: int) -> None:
        """Split what rays cross above this level, all but their last `masked` steps.

        The sensor's cell, (2,) int array, and the ends', `(n, 2)`, are counted from the root's
        corner.
        """
        done = 0
        while done < len(ends):
            self._make_room(self.level)
            done = self._walk(sensor, ends, done, masked, level, 0)

    def count_rays(self, sensor: Cells, ends: Cells, masked: int) -> None:
        """Count the rays that cross each leaf, all but their last `masked` steps.

        The same cells as in `split_along`.
        """
        self._walk(sensor, ends, 0, masked, self.level, 1)

    def _walk(
        self, sensor: Cells, ends: Cells, done: int, masked: int, level: int, add: int
    ) -> int:
        tree = self.vis, self.occ, self.used, self.block, self.level
        self.used, done = loops.walk_rays(*tree, sensor, ends, done, masked, level, add)
        return done

    def join(self) -> None:
        """Make one leaf of every four children that are alike and never hit."""
        self.vis, self.occ, self.used = whole.joined(self.vis, self.occ, self.block, self.used)
        self.block = 0

    def mend(self) -> None:
        """Keep the blocks that the root reaches: a loop may have ended unheard, interrupted."""
        room = len(self.vis) // 4
        self.vis, self.occ, self.used = whole.reached(self.vis, self.occ, self.block, room)
        self.block = 0

    def leaves_at(self, cells: Cells) -> Cells:
        """Leaf of each cell `(n, 2)`; -1 outside the root."""
        return loops.leaves_at(self.vis, self.block, self.level, cells)

    def leaves(self) -> tuple[Cells, Cells, Cells]:
        """Nodes `(n,)`, lower left cells `(n, 2)` and levels `(n,)` of all leaves."""
        found = whole.all_leaves(self.vis, self.block, self.level, self.used)
        return found[:, 0], found[:, 1:3], found[:, 3]

    def _make_room(self, blocks: int) -> None:
        """Make sure that so many blocks can be added."""
        wanted = 4 * (self.used + blocks)
        if wanted > len(self.vis):
            room = 3 * wanted // 2
            self.vis, self.occ = np.resize(self.vis, room), np.resize(self.occ, room)


def in_use(tree: Tree) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Copies of the counts of the nodes in use, `(4 b,)` each."""
    return tree.vis[: 4 * tree.used].copy(), tree.occ[: 4 * tree.used].copy()
