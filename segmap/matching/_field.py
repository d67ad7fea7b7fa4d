"""A distance field: distances to the nearest occupied cell, transformed once and then looked up."""

import numpy as np
from numpy.typing import ArrayLike

from ..angles import Array
from ..poses import transform
from ..quadtree import QuadtreeMap
from . import _loops as loops
from ._scores import checked, index_of

#: The field counts in this fraction of a cell.
UNIT = 4096
#: Around the ends of a scan at its start: what a matcher may move them by, metres.
MARGIN = 0.5


class DistanceField:
    """Distances to the nearest occupied cell of a window, looked up by cell.

    A point counts as its cell's centre: the score differs from `distance_score` by at most
    `resolution / sqrt(2)` a beam where the window holds all ends and the cells nearest to them.

    Parameters
    ----------
    map : QuadtreeMap
        As it is now: later scans do not change the field.
    window : (4,) sequence, metres, or None
        Left, low, right, high edge; the whole root by default. A point beyond counts as on it.

    Raises
    ------
    ValueError
        For a window without area, or one that holds no occupied cell.

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.1)
    >>> map.insert_scan((0, 0), [(1.05, 0.05)])
    >>> DistanceField(map).score([(1.05, 0.05)], [(0, 0, 0), (0.3, 0, 0)]).round(6) + 0
    array([ 0. , -0.3])
    """

    def __init__(self, map: QuadtreeMap, window: ArrayLike | None = None) -> None:
        edges = np.array(map.bounds if window is None else window, float)
        if edges.shape != (4,) or not np.isfinite(edges).all() or (edges[2:] <= edges[:2]).any():
            raise ValueError(f"window must be left, low, right, high in metres, got {window!r}")
        index, side = index_of(map), map.resolution
        first = np.floor((edges[:2] - map.corner) / side).astype(np.int64)
        columns, rows = np.floor((edges[2:] - map.corner) / side).astype(np.int64) - first + 1
        left, low = first - map.tree.corner
        grid = loops.paint(*index, left, low, columns, rows)
        if grid.min() > 0:
            raise ValueError(f"the window {edges.tolist()} holds no occupied cell")
        loops.transform_columns(grid)
        self.cells = loops.transform_rows(grid, UNIT)
        corner = map.corner + first * side
        self._frame = np.array([*corner, side, columns, rows])

    @classmethod
    def around(cls, map: QuadtreeMap, points: ArrayLike, pose: ArrayLike) -> "DistanceField":
        """The field that a scan `(n, 2)` needs near a pose: its box, and half a metre more."""
        ends = transform(np.asarray(pose, float), np.asarray(points, float))
        return cls(map, [*(ends.min(0) - MARGIN), *(ends.max(0) + MARGIN)])

    @property
    def distance(self) -> Array:
        """Distances, `(rows, columns)`, metres, row 0 lowest."""
        return self.cells * (self._frame[2] / UNIT)

    def score(self, points: ArrayLike, poses: ArrayLike) -> Array:
        """Minus the sum of the distances at each pose.

        Parameters
        ----------
        points : (n, 2) array, metres, in the robot's frame
        poses : (k, 3) or (3,) array, metres and radians

        Returns
        -------
        (k,) array, metres
        """
        return self.scorer(points)(checked(points, poses)[1])

    def scorer(self, points: ArrayLike):  # type: ignore[no-untyped-def]
        """A function of poses `(k, 3)` alone, for those who ask often."""
        ends = np.ascontiguousarray(np.asarray(points, float).T, np.float32)
        room, flat = np.empty(ends.shape[1], np.int32), self.cells.ravel()
        unit = -self._frame[2] / UNIT
        return lambda poses: unit * loops.look_up(flat, self._frame, ends, poses, room)
