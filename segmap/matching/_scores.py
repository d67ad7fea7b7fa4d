"""How well a scan lies on a quadtree map at a pose: three scores, the higher the better (B 4.3)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..angles import Array
from ..poses import transform
from ..quadtree import QuadtreeMap
from . import _loops as loops


class Index(NamedTuple):
    """A tree with the nodes marked that hold an occupied cell."""

    vis: loops.Counts
    holds: NDArray[np.bool_]
    block: int
    level: int


def index_of(map: QuadtreeMap) -> Index:
    """Mark the nodes of a map.

    Raises
    ------
    ValueError
        Where nothing is occupied: an empty map has no score.
    """
    tree = map.tree
    holds = loops.occupied_below(tree.vis, tree.occ, tree.block, tree.used)
    first = 4 * tree.block
    if not holds[first : first + 4].any():
        raise ValueError("the map holds no occupied cell, so no pose has a score: insert a scan")
    return Index(tree.vis, holds, tree.block, tree.level)


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
    index_of(map)
    ends, at = checked(points, poses)
    value = map.occupancy(_all_placed(ends, at)).reshape(len(at), len(ends))
    return np.where(value > 0.5, value, 0.0).sum(1)


def distance_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """Minus the sum of the distances from the ends to the nearest occupied cell's centre, exact.

    Over all occupied cells, by a kd-tree; parameters, errors as `occupancy_score`.

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

    index_of(map)
    ends, at = checked(points, poses)
    leaves = map.leaves()
    occupied = 2 * leaves.occ > leaves.vis
    corner = np.stack([leaves.x[occupied], leaves.y[occupied]], -1)
    distance = cKDTree(corner + map.resolution / 2).query(_all_placed(ends, at))[0]
    return -np.asarray(distance).reshape(len(at), len(ends)).sum(1)


def nearest_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """The value of `distance_score`, found in the tree: nearest squares first, exact.

    Squares farther than the best so far are not entered. Parameters, errors as `occupancy_score`.

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
    return _searched(loops.exact_distances, map, points, poses)


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
    return _searched(loops.greedy_distances, map, points, poses)


def _searched(search, map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:  # type: ignore[no-untyped-def]
    index, (ends, at) = index_of(map), checked(points, poses)
    origin = map.corner + map.tree.corner * map.resolution
    cells = (_all_placed(ends, at) - origin) / map.resolution
    distance = search(*index, cells) * map.resolution
    return -np.asarray(distance).reshape(len(at), len(ends)).sum(1)


def _all_placed(points: Array, poses: Array) -> Array:
    """Points of all poses, `(k n, 2)`."""
    return np.concatenate([transform(pose, points) for pose in poses])


def checked(points: ArrayLike, poses: ArrayLike) -> tuple[Array, Array]:
    """Points `(n, 2)` and poses `(k, 3)` as arrays.

    Raises
    ------
    ValueError
    """
    ends, at = np.asarray(points, float), np.atleast_2d(np.asarray(poses, float))
    ends = ends.reshape(-1, 2) if ends.size == 0 else ends
    if ends.ndim != 2 or ends.shape[1] != 2:
        raise ValueError(f"points must have shape (n, 2), got {ends.shape}")
    if at.ndim != 2 or at.shape[1] != 3:
        raise ValueError(f"poses must have shape (k, 3), got {at.shape}")
    if not (np.isfinite(ends).all() and np.isfinite(at).all()):
        raise ValueError("points and poses must be finite: leave out beams without return")
    return ends, at
