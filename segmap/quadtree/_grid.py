"""A quadtree of a grid of cells: what another program says is free or occupied."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import checked
from ._map import QuadtreeMap, Resolution

#: What a cell is: nothing has been measured in it.
UNKNOWN = 0
#: Beams passed through it.
FREE = 1
#: Beams ended in it.
OCCUPIED = 2
#: Stands for a square in which cells differ.
MIXED = -1


@checked
def map_of_grid(
    cells: ArrayLike, *, resolution: Resolution, corner: ArrayLike = (0.0, 0.0)
) -> QuadtreeMap:
    """The map whose occupancy is 0.5, 0 or 1 where a cell is 0 unknown, 1 free, 2 occupied.

    Parameters
    ----------
    cells : (rows, columns) array
        Row 0 is the lowest.
    resolution
        Side of a cell.
    corner : (2,) array, metres
        Lower left corner of the grid.

    Returns
    -------
    QuadtreeMap
        As if one ray had crossed each free cell and one had ended in each occupied one: its bias is
        1, and it holds no scan. What lies beside the grid is unknown.

    Examples
    --------
    >>> tree = map_of_grid([[0, 1, 2]], resolution=0.5)
    >>> tree.occupancy([(0.2, 0.2), (0.7, 0.2), (1.2, 0.2), (0.2, 0.7)])
    array([0.5, 0. , 1. , 0.5])
    """
    grid = arrays.numbers(cells, "cells")
    if grid.ndim != 2 or not grid.size or not np.isin(grid, (UNKNOWN, FREE, OCCUPIED)).all():
        raise ValueError("cells must be a table (rows, columns) of 0, 1 and 2")
    level = max(2, int(max(grid.shape) - 1).bit_length())
    place = arrays.point(corner, "corner")
    map = QuadtreeMap(
        resolution=resolution, size=float(np.ldexp(resolution, level)), corner=place, bias=1
    )
    layers = [grid.astype(np.int8)]
    while len(layers) < level:
        layers.append(_halve(layers[-1]))
    vis, used, squares = [], 1, np.zeros((1, 2), np.int64)
    quarters = np.array([(0, 0), (1, 0), (0, 1), (1, 1)])
    kinds = []
    for layer in reversed(layers):
        squares = (2 * squares[:, None] + quarters).reshape(-1, 2)
        kind = np.zeros(len(squares), np.int8)
        within = (squares < layer.shape[::-1]).all(1)
        kind[within] = layer[squares[within, 1], squares[within, 0]]
        split = kind == MIXED
        counts = (kind > UNKNOWN).astype(np.int32)
        counts[split] = ~np.arange(used, used + split.sum(), dtype=np.int32)
        vis.append(counts)
        kinds.append(kind)
        used, squares = used + int(split.sum()), squares[split]
        if not len(squares):
            break
    tree = map.tree
    tree.vis, tree.occ = np.concatenate(vis), (np.concatenate(kinds) == OCCUPIED).astype(np.int32)
    tree.used, tree.version = used, tree.version + 1
    return map


def _halve(layer: NDArray[np.int8]) -> NDArray[np.int8]:
    """What squares of four are: unknown or free where all four are, else mixed."""
    rows, columns = layer.shape
    even = np.pad(layer, ((0, rows % 2), (0, columns % 2)))
    four = even.reshape(len(even) // 2, 2, -1, 2)
    low, high = four.min((1, 3)), four.max((1, 3))
    return np.where((low == high) & (high < OCCUPIED), low, MIXED).astype(np.int8)
