"""Two ways of inserting rays that fail, for the chapter and its panel only (B 4.4).

The map itself knows neither. Both are written as the prose says them: cell by cell.
"""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..quadtree import QuadtreeMap
from ._exercises_quadtree import Cell, Cells, ray_cells

#: Nearer than this to a line of the grid, in cells, is on it.
TOUCH = 1e-9


def insert_variant(
    map: QuadtreeMap,
    sensor_xy: ArrayLike,
    points: ArrayLike,
    *,
    touched: bool = False,
    mask: bool = True,
) -> None:
    """Insert a scan as `map.insert_scan` does, or with one of the thesis' two failures.

    Parameters
    ----------
    map : QuadtreeMap
        Without `free_resolution`.
    sensor_xy : (2,) array, metres
    points : (n, 2) array, metres
    touched : bool
        Instead of Bresenham's cells, all that the segment between both cells' corners touches: B's
        coordinates are whole centimetres (B fig. 4.5).
    mask : bool
        Whether the end cell's eight neighbours are left out (B 4.4.2); the end cell always is.

    Examples
    --------
    >>> maps = [QuadtreeMap(resolution=0.1) for _ in range(2)]
    >>> maps[0].insert_scan((1, 1), [(2, 1.3), (2, 1.4)])
    >>> insert_variant(maps[1], (1, 1), [(2, 1.3), (2, 1.4)])
    >>> bool((maps[0].leaves().vis == maps[1].leaves().vis).all())
    True
    """
    sensor, ends, _ = map.cells_of_scan(sensor_xy, points)
    tree, walk = map.tree, touched_cells if touched else ray_cells
    tree.split_to(ends, inherit=False)
    tree.count_ends(ends)
    for end in ends:
        cells = walk((int(sensor[0]), int(sensor[1])), (int(end[0]), int(end[1])))
        seen = cells[abs(cells - end).max(1) > int(mask)]
        found = np.unique(tree.leaves_at(seen))
        tree.vis[found[found >= 0]] += 1
    map.scans += 1


def touched_cells(start: Cell, end: Cell) -> Cells:
    """Cells whose square, border included, meets the segment between two cells' corners.

    Parameters
    ----------
    start, end : (2,) int

    Returns
    -------
    (n, 2) int array

    Examples
    --------
    >>> touched_cells((0, 0), (1, 1)).tolist()
    [[-1, -1], [-1, 0], [0, -1], [0, 0], [0, 1], [1, 0], [1, 1]]
    """
    a, b = np.array(start, float), np.array(end, float)
    cuts = np.unique(np.concatenate([_cuts(a[i], b[i]) for i in (0, 1)]))
    part = np.concatenate([cuts, (cuts[:-1] + cuts[1:]) / 2])
    points = a + part[:, None] * (b - a)
    low, high = np.floor(points - TOUCH), np.floor(points + TOUCH)
    corners = [
        np.stack([x, y], -1) for x in (low[:, 0], high[:, 0]) for y in (low[:, 1], high[:, 1])
    ]
    return np.unique(np.concatenate(corners).astype(np.int64), axis=0)


def _cuts(a: float, b: float) -> Array:
    """Where on its way from a to b a coordinate is whole, as parts of the way, with both ends."""
    lines = np.arange(min(a, b), max(a, b) + 1)
    return np.append((lines - a) / (b - a), (0.0, 1.0)) if a != b else np.array([0.0, 1.0])
