"""How well a scan lies on a quadtree map at a pose: three scores, the higher the better (B 4.3)."""

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..quadtree import QuadtreeMap
from . import _search_loops as loops

#: What `held` found last, after how many scans, in how many blocks of which array: an interrupted
#: scan changes the tree and is not counted.
_HELD: WeakKeyDictionary[QuadtreeMap, tuple[tuple[int, int], loops.Counts, loops.Holds]] = (
    WeakKeyDictionary()
)


def occupancy_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """Sum of the occupancy of the cells that the beams end in, where above 0.5 (B 4.3).

    Flat wherever no beam meets an occupied cell: it knows where it is, not where to go.

    Parameters
    ----------
    map : QuadtreeMap
    points : (n, 2) array, metres
        Ends of the beams in the robot's frame.
    poses : (k, 3) or (3,) array, metres and radians

    Returns
    -------
    (k,) array

    Raises
    ------
    ValueError
        For an empty map, other shapes, or values that are not finite.

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.1)
    >>> map.insert_scan((0, 0), [(1, 0), (1, 0.5)])
    >>> occupancy_score(map, [(1, 0), (1, 0.5)], [(0, 0, 0), (0.3, 0, 0)])
    array([2., 0.])
    """
    held(map)
    ends, at = checked(points, poses)
    value = map.occupancy(all_placed(ends, at)).reshape(len(at), len(ends))
    return np.where(value > 0.5, value, 0.0).sum(1)


def distance_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """Minus the sum of the distances from the ends to the nearest occupied cell's centre, exact.

    Over all occupied cells, by a kd-tree; parameters, errors as `occupancy_score`. B 4.3 measures
    to the corners of cells, from ends cut to whole centimetres.

    Returns
    -------
    (k,) array, metres

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.1)
    >>> map.insert_scan((0, 0), [(1.05, 0.05)])
    >>> distance_score(map, [(1.05, 0.05)], [(0, 0, 0), (0.3, 0, 0)]).round(6) + 0
    array([ 0. , -0.3])
    """
    from scipy.spatial import cKDTree

    held(map)
    ends, at = checked(points, poses)
    leaves = map.leaves()
    occupied = leaves.occ > leaves.vis - leaves.occ
    corner = np.stack([leaves.x[occupied], leaves.y[occupied]], -1)
    distance = cKDTree(corner + map.resolution / 2).query(all_placed(ends, at))[0]
    return -np.asarray(distance).reshape(len(at), len(ends)).sum(1)


def nearest_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """The value of `distance_score`, found in the tree: nearest squares first, exact.

    Squares farther than the best so far are not entered (Roussopoulos, Kelley and Vincent 1995; B
    names such a score as future work). Parameters, errors as `occupancy_score`.

    Returns
    -------
    (k,) array, metres

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.1)
    >>> map.insert_scan((0, 0), [(1.05, 0.05)])
    >>> nearest_score(map, [(1.05, 0.05)], (0.3, 0, 0)).round(6)
    array([-0.3])
    """
    return _searched(map, points, poses, exact=True)


def descent_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """The same by B's greedy descent, which can miss the nearest cell (B 4.3; for comparison).

    Always into the child that holds something and whose centre is nearest. Parameters, errors as
    `occupancy_score`.

    Returns
    -------
    (k,) array, metres
        Never above that of `nearest_score`.

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.1)
    >>> map.insert_scan((0, 0), [(1.05, 0.05)])
    >>> descent_score(map, [(1.05, 0.05)], (0.3, 0, 0)).round(6)
    array([-0.3])
    """
    return _searched(map, points, poses, exact=False)


def _searched(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike, *, exact: bool) -> Array:
    """Minus the sum of the distances that a search of the tree finds."""
    (ends, at), tree, holds = checked(points, poses), map.tree, held(map)
    frame = np.append(map.corner + tree.corner * map.resolution, map.resolution)
    nodes = tree.vis, tree.occ, holds, tree.block, tree.level
    return -map.resolution * loops.distances(*nodes, frame, ends, at, exact)


def all_placed(points: Array, poses: Array) -> Array:
    """Points of all poses in the frame of the map, metres: the n points at each of the k poses."""
    c, s = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
    x, y = points.T
    placed = np.stack([c * x - s * y + poses[:, :1], s * x + c * y + poses[:, 1:2]], -1)
    return placed.reshape(-1, 2)


def held(map: QuadtreeMap) -> loops.Holds:
    """Which blocks of a map hold an occupied cell, (b,) bool array; kept until the next scan.

    Raises
    ------
    ValueError
        Where none does: an empty map has no score.
    """
    tree, (state, vis, holds) = map.tree, _HELD.get(map, (None, None, None))
    if holds is None or state != (map.scans, tree.used) or vis is not tree.vis:
        holds = loops.occupied_blocks(tree.vis, tree.occ, tree.block, tree.used)
        _HELD[map] = (map.scans, tree.used), tree.vis, holds
    if not holds[tree.block]:
        raise ValueError("the map holds no occupied cell, so no pose has a score: insert a scan")
    return holds


def checked(points: ArrayLike, poses: ArrayLike) -> tuple[Array, Array]:
    """Points `(n, 2)`, metres, and poses `(k, 3)`, metres and radians, as arrays.

    Raises
    ------
    ValueError
        For other shapes, or values that are not finite.
    """
    ends, at = np.asarray(points, float), np.atleast_2d(np.asarray(poses, float))
    ends = ends.reshape(-1, 2) if ends.size == 0 else ends
    if ends.ndim != 2 or ends.shape[1] != 2:
        raise ValueError(f"points must have shape (n, 2), got {ends.shape}")
    if at.ndim != 2 or at.shape[1] != 3:
        raise ValueError(f"poses must have shape (k, 3), got {np.shape(poses)}")
    for name, values in (("points", ends), ("poses", at)):
        if not np.isfinite(values).all():
            row = int(np.isfinite(values).all(1).argmin())
            raise ValueError(f"{name} must be finite, got {values[row].tolist()} at row {row}")
    return ends, at
