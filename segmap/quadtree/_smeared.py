"""Walls that a quadtree shows smeared, since scans of one place were laid beside each other."""

from __future__ import annotations

import numpy as np

from .. import arrays
from ._map import QuadtreeMap

#: Cells have this side, metres, or the map's own where that is larger.
SMEARED_CELL_M = 0.05
#: So many occupied cells a side are no wall: of one a laser sees the front.
SMEARED_WIDTH_CELLS = 5
#: A cell is occupied only where at least so many rays ended.
LEAST_ENDED_RAYS = 2
#: A cell is occupied only where this share of its rays ended: fewer end on people who pass.
LEAST_ENDED_SHARE = 0.1


def smeared_walls(map: QuadtreeMap) -> float:
    """Share of the occupied cells of a map that lie in squares of five by five occupied ones.

    Cells are 5 cm wide, or the map's. A laser sees the front of a wall, a cell or two thick; scans
    that are laid wrong draw it at many places, and these grow together. Of eighty scans of a box
    that err by 8 cm and more it shows 30 % and more, of the bundled logs nothing, of long real logs
    up to 12 %: furniture, and people who come and go. Cells coarser than 5 cm see less.

    Returns
    -------
    float
        0 to 1; NaN where no cell is occupied.

    Examples
    --------
    >>> tree, wall = QuadtreeMap(resolution=0.05), np.arange(0.025, 2, 0.05)
    >>> for y in (1.025, 1.025, 1.075, 1.075):
    ...     tree.insert_scan((1, 0), [(x, y) for x in wall])
    >>> smeared_walls(tree)
    0.0
    >>> for y in (1.125, 1.125, 1.175, 1.175, 1.225, 1.225):
    ...     tree.insert_scan((1, 0), [(x, y) for x in wall])
    >>> smeared_walls(tree)
    1.0
    """
    leaves = arrays.instance(map, "map", QuadtreeMap).leaves()
    hit = leaves.occ > 0
    hit[hit] = leaves.occ[hit] >= LEAST_ENDED_SHARE * leaves.vis[hit]
    side = max(SMEARED_CELL_M, map.resolution)
    middle = np.stack([leaves.x, leaves.y], -1)[hit] + leaves.side[hit, None] / 2
    cell = np.floor((middle - map.corner) / side).astype(np.int64)
    row = 1 << 32  # one number for both indices
    keys, where = np.unique(cell @ [row, 1], return_inverse=True)
    seen = keys[np.bincount(where, leaves.occ[hit], len(keys)) >= LEAST_ENDED_RAYS]
    if not len(seen):
        return float("nan")
    width = np.arange(SMEARED_WIDTH_CELLS)
    square = (width[:, None] * row + width).ravel()
    first = seen  # the lower left cells of squares that are full so far
    for step in square:
        first = first[np.isin(first + step, seen)]
    return float(np.isin(seen, (first[:, None] + square).ravel()).mean())
