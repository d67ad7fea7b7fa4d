"""Likelihood of the end of a beam in each cell of a map: for the search and `localize`."""

from __future__ import annotations

import numpy as np

from ..alignment.points.correlation import Levels, fill_maxima
from ..arrays import Array
from ..compiled import compiled
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
from ._scores import Counts

#: Standard deviation of an end of a beam about its wall, metres: noise, cells, and what moved.
LIKELIHOOD_SIGMA_M = 0.1
#: Share of the beams that anything may stop, in the fit of a pose.
ANYTHING = 0.1
#: Side of a cell, metres; smaller cells of a quadtree are joined up to it.
LIKELIHOOD_CELL_M = 0.05
#: The widest squares are 2^TOP cells a side.
TOP = 6
#: Logarithm of what a beam is worth whose end lies in a cell of each of the 256 values.
LOGARITHMS = np.log((1 - ANYTHING) * (np.arange(256) / 255) + ANYTHING)


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
        fill_maxima(levels.reshape(TOP + 1, -1), levels.shape[2])
        self.levels = levels

    def likelihood(self, places: Array) -> Array:
        """What an end of a beam is worth at places `(..., 2)`, metres: 0 to 1."""
        cell = (places - self.corner) / self.size + (1 << TOP)
        most = np.array(self.levels.shape[:0:-1]) - 1
        i, j = np.moveaxis(np.clip(cell, 0, most).astype(np.int64), -1, 0)
        return self.levels[0, j, i] / 255

    def fits(self, points: Array, poses: Array) -> Array:
        """How well points `(n, 2)` fit at poses `(k, 3)`, metres and radians: (k,), 0 to 1."""
        turn = poses[:, 2:]
        placed = np.concatenate([poses[:, :2], np.cos(turn), np.sin(turn)], 1)
        rows, columns = self.levels.shape[1:]
        frame = np.array([*self.corner, self.size, 1 << TOP, columns, rows])
        ends, sums = np.ascontiguousarray(points.T), np.empty(len(poses))
        room = np.empty(len(points), np.int32)
        weigh_poses(self.levels[0].ravel(), frame, ends, placed, room, sums)
        return np.exp(sums / len(points))


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
    grid = np.full((rows, columns), NO_OCCUPIED_CELL, np.int32)
    unit = MOST_WINDOW_DISTANCE // (columns + rows)
    x, y = (cells - first).T
    grid[y, x] = 0
    transform_cells(grid, unit)
    return grid * (size / unit), map.corner + first * size, size


# ---------------------------------------------------------------------------------- loops
@compiled
def weigh_poses(
    level: Levels, frame: Array, points: Array, placed: Array, cells: Counts, sums: Array
) -> None:
    """Write the sum of the logarithms under points `(2, n)` at each pose `(k, 4)`.

    A pose is x, y, and cosine and sine of its heading; a point beyond the edge counts as on it.
    `frame` holds left and low edge of the map, cell side, cells of the border, columns and rows
    with it; `cells`, `(n,)`, is room to work in: so the compiler takes several beams at a time.
    """
    west, south, side, border, columns = frame[0], frame[1], frame[2], frame[3], np.int32(frame[4])
    last_x, last_y = frame[4] - 1.0, frame[5] - 1.0
    for k in range(len(placed)):
        x0, y0, c, s = placed[k, 0], placed[k, 1], placed[k, 2], placed[k, 3]
        for m in range(points.shape[1]):
            x = (x0 + c * points[0, m] - s * points[1, m] - west) / side + border
            y = (y0 + s * points[0, m] + c * points[1, m] - south) / side + border
            x, y = min(last_x, max(0.0, x)), min(last_y, max(0.0, y))
            cells[m] = np.int32(y) * columns + np.int32(x)
        total = 0.0
        for m in range(points.shape[1]):
            total += LOGARITHMS[level[cells[m]]]
        sums[k] = total
