"""Two ways of inserting rays that fail, for the chapter and its panel only (B 4.4).

The map itself knows neither. Both are written as the prose says them: cell by cell.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..literal import cell_of, ray_cells
from ..quadtree import QuadtreeMap

Cell = tuple[int, int]
Cells = NDArray[np.int64]

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
        Without `free_resolution`. It counts more scans than one.
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
    ends = np.asarray(points, float)
    map.insert_scan(sensor_xy, [])  # the root grows towards the sensor first
    for end in ends:  # each end from its own cell, which the mask spares
        map.insert_scan(end, [end])
    start, *last = (_cell(map, point) for point in (sensor_xy, *ends))
    crossed = np.concatenate([_leaves_crossed(map, start, end, touched, mask) for end in last])
    for leaf, rays in zip(*np.unique(crossed, axis=0, return_counts=True), strict=True):
        map.insert_scan(leaf, [], np.tile(leaf, (rays, 1)))  # rays of a single cell


def _cell(map: QuadtreeMap, point: ArrayLike) -> Cell:
    x, y = np.asarray(point, float).tolist()
    left, low = map.corner.tolist()
    return cell_of(x, left, map.resolution), cell_of(y, low, map.resolution)


def _leaves_crossed(map: QuadtreeMap, start: Cell, end: Cell, touched: bool, mask: bool) -> Array:
    """A place in each leaf that holds a cell of a ray, `(n, 2)`, metres."""
    cells = np.array(touched_cells(start, end) if touched else ray_cells(start, end))
    seen = cells[abs(cells - end).max(1) > int(mask)]
    leaf, first = np.unique(map.tree.leaves_at(seen - map.tree.corner), return_index=True)
    return map.corner + (seen[first[leaf >= 0]] + 0.5) * map.resolution


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
