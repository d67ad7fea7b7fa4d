"""A distance field: distances to the nearest occupied cell, transformed once and then looked up."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..quadtree import QuadtreeMap
from . import _loops as loops
from ._scores import all_placed, occupied_blocks, scan_and_poses

#: Distances are whole numbers, the longest in a window below this: 32 bits.
MOST = 2**31 - 1
#: Around the ends of a scan at its start: what a matcher may move them by, metres.
MARGIN = 0.5
#: Cells of a window: a side, so that 32 bits hold every distance, and in all, a quarter of a GB.
MOST_SIDE, MOST_CELLS = 2**14, 2**26
#: Points beyond lie outside every window, metres.
FAR_AWAY = 1e9


class NothingNear(ValueError):
    """The window holds no occupied cell."""


class DistanceField:
    """Distances to the nearest occupied cell of a window, looked up by cell.

    A point counts as its cell's centre: the score differs from `distance_score` by at most
    `resolution / sqrt(2)` a beam where the window holds all ends and the cells nearest to them.
    What lies outside is not seen, which can only lower the score of ends inside.

    Parameters
    ----------
    map : QuadtreeMap
        As it is now: later scans do not change the field.
    window : (4,) sequence, metres, or None
        Left, low, right, high edge; the whole root by default. A point beyond counts as on it.

    Attributes
    ----------
    cells : (rows, columns) int32 array
        Distances, row 0 lowest, in fractions of a cell: 1 / `unit`. The exact Euclidean transform
        of Meijster, Roerdink and Hesselink (2000); B has none.
    unit : int

    Raises
    ------
    ValueError
        For a window without area, of too many cells, or one that holds no occupied cell.

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.1)
    >>> map.insert_scan((0, 0), [(1.05, 0.05)])
    >>> DistanceField(map).score([(1.05, 0.05)], [(0, 0, 0), (0.3, 0, 0)]).round(6) + 0
    array([ 0. , -0.3])
    """

    def __init__(self, map: QuadtreeMap, window: ArrayLike | None = None) -> None:
        first, (columns, rows) = _cells_of_window(map, window)
        occupied_blocks(map)
        left, low = first - map.tree.corner
        x, y = map.tree.occupied_cells(np.array([left, low, left + columns, low + rows])).T
        if not len(x):
            raise NothingNear("the window holds no occupied cell, so no pose in it has a score")
        self.unit, grid = MOST // (columns + rows), np.full((rows, columns), loops.FAR, np.int32)
        grid[y - low, x - left] = 0
        room, share = np.empty((columns, 3), np.int64), 0.5 / np.arange(1, columns + 1)
        loops.transform(grid, self.unit, room, share)
        self.cells = grid
        corner = map.corner + first * map.resolution
        worth = -map.resolution / self.unit
        self._frame = np.array([*corner, map.resolution, columns, rows, worth])

    @classmethod
    def around(cls, map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> DistanceField:
        """The field that a scan needs near poses: a box about robot and ends, and half a metre.

        Parameters
        ----------
        map : QuadtreeMap
        points : (n, 2) array, metres, in the robot's frame
        poses : (k, 3) or (3,) array, metres and radians, at least one

        Raises
        ------
        ValueError
            As the constructor; for an empty map, other shapes, values that are not finite.

        Examples
        --------
        >>> map = QuadtreeMap(resolution=0.1)
        >>> map.insert_scan((0, 0), [(1.05, 0.05)])
        >>> DistanceField.around(map, [(1.05, 0.05)], (0, 0, 0))
        DistanceField(21 x 11 cells of 0.1 m)
        """
        ends, at = scan_and_poses(points, poses)
        if not len(at):
            raise ValueError("poses must hold at least one pose, to know where the scan is")
        placed = np.concatenate([at[:, :2], all_placed(ends, at)])
        return cls(map, [*(placed.min(0) - MARGIN), *(placed.max(0) + MARGIN)])

    @property
    def distance(self) -> Array:
        """Distances to the nearest occupied cell, (rows, columns) array, metres, row 0 lowest."""
        return self.cells * -self._frame[5]

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, low, right and high edge of the window, metres: whole cells."""
        left, low, side, columns, rows, _ = self._frame.tolist()
        return left, low, left + columns * side, low + rows * side

    def score(self, points: ArrayLike, poses: ArrayLike) -> Array:
        """Minus the sum of the distances at each pose; an example is in the class.

        Parameters
        ----------
        points : (n, 2) array, metres, in the robot's frame
        poses : (k, 3) or (3,) array, metres and radians

        Returns
        -------
        (k,) array, metres

        Raises
        ------
        ValueError
            For other shapes, or values that are not finite.
        """
        ends, at = scan_and_poses(points, poses)
        return self.scorer(ends)(at)

    def scorer(self, points: ArrayLike) -> Callable[[Array], Array]:
        """The score as a function of poses `(k, 3)` alone, for those who ask often.

        The poses are not looked at: they must be finite floats.

        Parameters
        ----------
        points : (n, 2) array, metres, in the robot's frame

        Raises
        ------
        ValueError
            For another shape, or values that are not finite.

        Examples
        --------
        >>> map = QuadtreeMap(resolution=0.1)
        >>> map.insert_scan((0, 0), [(1.05, 0.05)])
        >>> values = DistanceField(map).scorer([(1.05, 0.05)])
        >>> values(np.array([(0.3, 0.0, 0.0)])).round(6)
        array([-0.3])
        """
        near = np.clip(scan_and_poses(points, np.zeros(3))[0], -FAR_AWAY, FAR_AWAY)
        ends = np.ascontiguousarray(near.T, np.float32)
        flat, cells = self.cells.ravel(), np.empty(len(near), np.int32)

        def score(poses: Array) -> Array:
            """The score at each pose."""
            found = np.empty(len(poses))
            loops.look_up(flat, self._frame, ends, poses, cells, found)
            return found

        return score

    def __repr__(self) -> str:
        rows, columns = self.cells.shape
        return f"DistanceField({columns} x {rows} cells of {self._frame[2]:.6g} m)"


def _cells_of_window(
    map: QuadtreeMap, window: ArrayLike | None
) -> tuple[loops.Whole, tuple[int, int]]:
    """First cell of a window, counted from the map's first corner, and its columns and rows."""
    edges = np.array(map.bounds if window is None else window, float)
    if edges.shape != (4,) or not np.isfinite(edges).all() or (edges[2:] <= edges[:2]).any():
        raise ValueError(f"window must be left, low, right, high in metres, got {window!r}")
    edges = (edges.reshape(2, 2) - map.corner) / map.resolution
    first, beyond = np.floor(edges[0]), np.ceil(edges[1])
    count = beyond - first
    if (count > MOST_SIDE).any() or count.prod() > MOST_CELLS:
        raise ValueError(
            f"a window of {count[0]:.9g} x {count[1]:.9g} cells is too large: at most {MOST_SIDE} "
            f"a side and {MOST_CELLS} in all; give a smaller one, or a coarser map"
        )
    if (abs(first) > 2.0**60).any():
        raise NothingNear(f"the window {window!r} lies beyond every map")
    return first.astype(np.int64), (int(count[0]), int(count[1]))
