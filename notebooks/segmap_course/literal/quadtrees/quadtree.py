"""The quadtree map of B 4 as its prose says it: a dictionary of leaves, and rays cell by cell."""

from __future__ import annotations

from collections.abc import Iterable
from math import floor
from typing import TypeVar

Point = tuple[float, float]
#: Column and row, counted from the first corner of the map.
Cell = tuple[int, int]
#: Column and row of the lower left cell, and the side in cells.
Square = tuple[int, int, int]
#: What a leaf counts: how many ends, or rays and ends.
Counts = TypeVar("Counts")


def cell_of(x: float, corner: float, resolution: float) -> int:
    """Column that holds a coordinate, in metres: one division and then the floor (B 4.1)."""
    return floor((x - corner) / resolution)


def quarters(square: Square) -> list[Square]:
    """The four squares of half the side."""
    x_min, y_min, side = square
    half = side // 2
    return [(x, y, half) for x in (x_min, x_min + half) for y in (y_min, y_min + half)]


def holds(square: Square, cell: Cell) -> bool:
    """Whether a cell lies in a square."""
    (x_min, y_min, side), (x, y) = square, cell
    return x_min <= x < x_min + side and y_min <= y < y_min + side


def leaf_of(leaves: dict[Square, Counts], root: Square, cell: Cell) -> Square:
    """The leaf that holds a cell: from the root down, each time into the quarter that holds it."""
    square = root
    while square not in leaves:
        square = next(quarter for quarter in quarters(square) if holds(quarter, cell))
    return square


def split(leaves: dict[Square, Counts], root: Square, cell: Cell, least: int = 1) -> None:
    """Cut the leaf of a cell until its side is `least`; quarters keep its counts (B 4.2)."""
    while (leaf := leaf_of(leaves, root, cell))[2] > least:
        counts = leaves.pop(leaf)
        leaves.update({quarter: counts for quarter in quarters(leaf)})


def grown(root: Square, cell: Cell) -> Square:
    """The root, doubled once towards a cell that lies outside it (B 4.2)."""
    x, y, side = root
    return x - side * (cell[0] < x), y - side * (cell[1] < y), 2 * side


def grow(leaves: dict[Square, Counts], root: Square, cell: Cell, empty: Counts) -> Square:
    """Double the root until it holds a cell; the quarters beside the old root are empty leaves."""
    while not holds(root, cell):
        larger = grown(root, cell)
        leaves.update({quarter: empty for quarter in quarters(larger) if quarter != root})
        root = larger
    return root


def occupancy(vis: int, occ: int, bias: int = 20) -> float:
    """Occupancy of a leaf that `vis` rays crossed and `occ` beams ended in, in [0, 1] (B 4.1)."""
    return occ / vis if occ else max(0.5 * (bias - vis) / bias, 0.0)


def ray_cells(start: Cell, end: Cell) -> list[Cell]:
    """Cells of a ray, both ends included: one for each step along the longer axis (B 4.4.1).

    Examples
    --------
    >>> ray_cells((0, 0), (-3, 1))
    [(-3, 1), (-2, 1), (-1, 0), (0, 0)]
    """
    (x0, y0), (x1, y1) = start, end
    if abs(y1 - y0) > abs(x1 - x0):
        return [(x, y) for y, x in ray_cells((y0, x0), (y1, x1))]
    if x1 < x0:
        return ray_cells(end, start)
    dx, dy, y, cells = x1 - x0, abs(y1 - y0), y0, []
    error = -(dx // 2)
    for x in range(x0, x1 + 1):
        cells.append((x, y))
        error += dy
        if error > 0:
            y, error = y + (1 if y1 > y0 else -1), error - dx
    return cells


def crossed_cells(start: Cell, end: Cell) -> list[Cell]:
    """Cells of a ray without the mask: its end and the end's eight neighbours (B 4.4.2)."""
    cells = ray_cells(start, end)
    return [(x, y) for x, y in cells if max(abs(x - end[0]), abs(y - end[1])) > 1]


def cut(leaves: dict[Square, tuple[int, int]], root: Square, cell: Cell) -> None:
    """Cut the leaf of an end down to its cell; each part starts with one ray (B 4.2)."""
    leaf = leaf_of(leaves, root, cell)
    if leaf[2] > 1:
        leaves[leaf] = 1, 0
    split(leaves, root, cell)


def count_end(leaves: dict[Square, tuple[int, int]], root: Square, cell: Cell) -> None:
    """Count an end and its ray; that of the first end was counted by the cut (B 4.2)."""
    leaf = leaf_of(leaves, root, cell)
    rays, ends = leaves[leaf]
    leaves[leaf] = rays + (ends > 0 or rays == 0), ends + 1


def crossed_leaves(
    leaves: dict[Square, Counts], root: Square, cells: Iterable[Cell]
) -> list[Square]:
    """The leaves that hold a cell of a ray, each once."""
    return sorted({leaf_of(leaves, root, cell) for cell in cells})


def count_ray(leaves: dict[Square, tuple[int, int]], root: Square, cells: Iterable[Cell]) -> None:
    """Count a ray in each leaf that it crosses (B 4.3)."""
    for leaf in crossed_leaves(leaves, root, cells):
        rays, ends = leaves[leaf]
        leaves[leaf] = rays + 1, ends


def insert(
    leaves: dict[Square, tuple[int, int]], root: Square, sensor: Cell, ends: Iterable[Cell]
) -> None:
    """Add a scan: first cut for all ends, then count ends and rays (B 4.2-4.4)."""
    for end in ends:
        cut(leaves, root, end)
    for end in ends:
        count_end(leaves, root, end)
        count_ray(leaves, root, crossed_cells(sensor, end))


class Quadtree:
    """Leaves `(x, y, side)`, in cells from the first corner, with their two counts.

    The resolution and the corner are in metres. The side of the root is `cells` at first, a power
    of two, and grows up to `largest`. `finest` is the `free_resolution` of
    `segmap.quadtree.QuadtreeMap`, in cells: rays split leaves too, splits hand their counts on, and
    equal children join. B has nothing like it.

    Examples
    --------
    >>> tree = Quadtree(1.0, 4)
    >>> tree.insert((0.5, 0.5), [(3.5, 0.5)])
    >>> tree.leaves[3, 0, 1], tree.leaves[0, 0, 2]
    ((1, 1), (1, 0))
    """

    def __init__(
        self,
        resolution: float,
        cells: int = 512,
        *,
        corner: Point = (0.0, 0.0),
        finest: int | None = None,
        largest: int = 2**16,
    ) -> None:
        self.resolution, self.corner, self.largest = resolution, corner, largest
        self.root, self.finest = (0, 0, cells), finest
        self.leaves = dict.fromkeys(quarters(self.root), (0, 0))

    def insert(self, sensor: Point, points: Iterable[Point], free: Iterable[Point] = ()) -> None:
        """Add the rays of a scan, metres: those that ended, and those that met nothing (B 4.2-4.4).

        Raises
        ------
        ValueError
            For a point beyond the largest root.
        """
        start, ends, last = self.cell(sensor), [*map(self.cell, points)], [*map(self.cell, free)]
        for cell in [start, *ends, *last]:
            self.grow(cell)
        for end in ends:
            self.split(end, 1)
        for end in ends:
            count_end(self.leaves, self.root, end)
        rays = [crossed_cells(start, end) for end in ends] + [ray_cells(start, end) for end in last]
        if self.finest is not None:
            for cell in (cell for ray in rays for cell in ray):
                self.split(cell, self.finest)
        for ray in rays:
            count_ray(self.leaves, self.root, ray)
        while self.finest is not None and any([self.join(leaf) for leaf in list(self.leaves)]):
            pass

    def cell(self, point: Point) -> Cell:
        """Cell that holds a point, metres."""
        (x, y), (x_min, y_min) = point, self.corner
        return cell_of(x, x_min, self.resolution), cell_of(y, y_min, self.resolution)

    def grow(self, cell: Cell) -> None:
        """Double the root until it holds a cell."""
        root = self.root
        while not holds(root, cell):
            root = grown(root, cell)
        if root[2] > self.largest:
            raise ValueError(f"cell {cell} lies beyond {self.largest} cells a side")
        self.root = grow(self.leaves, self.root, cell, (0, 0))

    def leaf(self, cell: Cell) -> Square:
        """Leaf that holds a cell."""
        return leaf_of(self.leaves, self.root, cell)

    def split(self, cell: Cell, least: int) -> None:
        """Split the leaf of a cell down to this side; without `finest` as `cut` does."""
        if self.finest is None:
            cut(self.leaves, self.root, cell)
        else:
            split(self.leaves, self.root, cell, least)

    def join(self, leaf: Square) -> bool:
        """Make one leaf of four that are alike and never hit, this one being the first of them."""
        x, y, side = leaf
        square = x, y, 2 * side
        counts = [self.leaves.get(part) for part in quarters(square)]
        aligned = (x - self.root[0]) % (2 * side) == (y - self.root[1]) % (2 * side) == 0
        alike = counts[0] is not None and not counts[0][1] and counts == 4 * counts[:1]
        if not (aligned and alike and 2 * side < self.root[2]):
            return False
        self.leaves[square] = [self.leaves.pop(part) for part in quarters(square)][-1]
        return True

    def occupied(self) -> list[Point]:
        """Centres of the cells that are occupied, above one half, metres."""
        (x_min, y_min), size = self.corner, self.resolution
        return [
            (x_min + (x + 0.5) * size, y_min + (y + 0.5) * size)
            for (x, y, side), (vis, occ) in self.leaves.items()
            if side == 1 and occupancy(vis, occ) > 0.5
        ]


def mean_and_variance(tree: Quadtree, square: Square) -> tuple[float, float]:
    """Of the occupancy over a square: those of its four children's means and variances (B 2.1).

    Examples
    --------
    >>> tree = Quadtree(1.0, 4)
    >>> tree.leaves[0, 0, 2] = 4, 2
    >>> tree.insert((3.5, 3.5), [], free=[(3.5, 3.5)] * 20)
    >>> mean_and_variance(tree, tree.root)
    (0.375, 0.046875)
    """
    if square in tree.leaves:
        vis, occ = tree.leaves[square]
        return occupancy(vis, occ), 0.0
    four = [mean_and_variance(tree, quarter) for quarter in quarters(square)]
    mean = sum(m for m, _ in four) / 4
    return mean, sum(v + (m - mean) ** 2 for m, v in four) / 4
