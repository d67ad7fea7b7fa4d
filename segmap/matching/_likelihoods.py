"""What the end of a beam is worth in each cell of a map: for the search and the particles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..poses.motions import transform
from ..segments import SegmentMap
from ._field import (
    MATCHER_MARGIN_M,
    MOST_WINDOW_DISTANCE,
    NO_OCCUPIED_CELL,
    DistanceField,
    Map,
    fits,
    transform_cells,
)

Levels = NDArray[np.uint8]
#: Standard deviation of an end of a beam about its wall, metres: noise, cells, and what moved.
LIKELIHOOD_SIGMA_M = 0.1
#: Share of the beams that anything may stop, in the fit of a pose.
ANYTHING = 0.1
#: Side of a cell, metres; smaller cells of a quadtree are joined up to it.
LIKELIHOOD_CELL_M = 0.05
#: The widest squares are 2^TOP cells a side.
TOP = 6


class Likelihoods:
    """What ends of beams are worth in each cell of a map, and the most in squares of 2, 4, 8, ...

    Attributes
    ----------
    corner, size
        Where the cells begin, (2,) array, and their side, metres.
    levels : (l, rows, columns) array of bytes
        From the first level on; before the first cell, and after the last, lies a border of 0.
    """

    def __init__(self, map: Map) -> None:
        distance, self.corner, self.size = _distances(map)
        self.shape, border = distance.shape, 1 << TOP
        rows, columns = self.shape
        levels = np.zeros((TOP + 1, rows + border + 1, columns + border + 1), np.uint8)
        levels[0, border:-1, border:-1] = np.rint(
            255 * np.exp(-0.5 * (distance / LIKELIHOOD_SIGMA_M) ** 2)
        )
        for k in range(TOP):
            step, wide = 1 << k, levels[k + 1]
            wide[:] = levels[k]
            np.maximum(wide[:, :-step], levels[k][:, step:], out=wide[:, :-step])
            np.maximum(wide[:-step], wide[step:], out=wide[:-step])
        self.levels = levels

    def likelihood(self, places: Array) -> Array:
        """What an end of a beam is worth at places `(..., 2)`, metres: 0 to 1."""
        cell = (places - self.corner) / self.size + (1 << TOP)
        most = np.array(self.levels.shape[:0:-1]) - 1
        i, j = np.moveaxis(np.clip(cell, 0, most).astype(np.int64), -1, 0)
        return self.levels[0, j, i] / 255

    def fits(self, points: Array, poses: Array) -> Array:
        """How well points `(n, 2)` fit at poses `(k, 3)`, metres and radians: (k,), 0 to 1."""
        worth = self.likelihood(transform(poses, points))
        return np.asarray(np.exp(np.log((1 - ANYTHING) * worth + ANYTHING).mean(-1)))


def _distances(map: Map) -> tuple[Array, Array, float]:
    """Distances of cells from the nearest wall `(rows, columns)`, where they begin, their side."""
    if isinstance(map, SegmentMap):
        field = DistanceField(map, resolution=LIKELIHOOD_CELL_M)
        return field.distance, np.array(field.bounds[:2]), LIKELIHOOD_CELL_M
    join = max(int(np.floor(np.log2(LIKELIHOOD_CELL_M / map.resolution) + 1e-9)), 0)
    size = float(np.ldexp(map.resolution, join))
    with map.lock:
        tree = map.tree
        cells = tree.occupied_cells(np.array([0, 0, 1, 1]) << tree.level) + tree.corner >> join
    edge = int(np.ceil(MATCHER_MARGIN_M / size))
    first = cells.min(0) - edge
    columns, rows = (cells.max(0) + edge + 1 - first).tolist()
    fits(columns, rows)
    grid, unit = (
        np.full((rows, columns), NO_OCCUPIED_CELL, np.int32),
        MOST_WINDOW_DISTANCE // (columns + rows),
    )
    x, y = (cells - first).T
    grid[y, x] = 0
    transform_cells(grid, unit)
    return grid * (size / unit), map.corner + first * size, size
