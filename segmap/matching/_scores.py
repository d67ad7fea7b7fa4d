"""How well a scan lies on a quadtree map at a pose: scores, the higher the better (B 4.3)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array
from ..quadtree import QuadtreeMap, Tree
from . import _loops as loops
from ._loops import Holds


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
    occupied_blocks(map)
    ends, at = scan_and_poses(points, poses)
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

    occupied_blocks(map)
    ends, at = scan_and_poses(points, poses)
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
    tree, holds, places, found = _searched(map, points, poses)
    path, todo = np.empty(tree.level + 1, np.int64), np.empty((3 * tree.level + 4, 4), np.int64)
    path[-1] = tree.block
    loops.nearest_distances(tree.vis, tree.occ, holds, places, path, todo, found)
    return -map.resolution * found


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
    tree, holds, places, found = _searched(map, points, poses)
    nodes = tree.vis, tree.occ, holds, tree.block, tree.level
    loops.descent_distances(*nodes, places, found)
    return -map.resolution * found


def _searched(
    map: QuadtreeMap, points: ArrayLike, poses: ArrayLike
) -> tuple[Tree, Holds, Array, Array]:
    """What a search needs: the tree, blocks that hold something, ends `(k, n, 2)` in cells of the
    root, and room for the answers `(k,)`."""
    holds = occupied_blocks(map)
    ends, at = scan_and_poses(points, poses)
    x, y, _ = at.T[:, :, None]
    c, s = (
        np.array([turn(angle) for angle in at[:, 2]]).reshape(-1, 1)
        for turn in (math.cos, math.sin)
    )
    left, low = map.corner + map.tree.corner * map.resolution
    places = np.empty((len(at), len(ends), 2))
    places[:, :, 0] = (c * ends[:, 0] - s * ends[:, 1] + (x - left)) / map.resolution
    places[:, :, 1] = (s * ends[:, 0] + c * ends[:, 1] + (y - low)) / map.resolution
    return map.tree, holds, places, np.empty(len(at))


def all_placed(points: Array, poses: Array) -> Array:
    """Points of all poses in the frame of the map, metres: the n points at each of the k poses."""
    c, s = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
    x, y = points.T
    placed = np.stack([c * x - s * y + poses[:, :1], s * x + c * y + poses[:, 1:2]], -1)
    return placed.reshape(-1, 2)


def occupied_blocks(map: QuadtreeMap) -> Holds:
    """Which blocks of a map hold an occupied cell, (b,) bool array.

    Raises
    ------
    ValueError
        Where none does: an empty map has no score.
    """
    holds = map.tree.occupied_blocks()
    if not holds[map.tree.block]:
        raise ValueError("the map holds no occupied cell, so no pose has a score: insert a scan")
    return holds


def scan_and_poses(points: ArrayLike, poses: ArrayLike) -> tuple[Array, Array]:
    """Points `(n, 2)`, metres, and poses `(k, 3)` or one, metres and radians, as arrays.

    Raises
    ------
    ValueError
        For other shapes, or values that are not finite.
    """
    ends = arrays.table(points, "points", 2, limit=np.inf)
    at = arrays.numbers(poses, "poses", "a (k, 3) array")
    at = at[None] if at.ndim == 1 and at.size else at
    return ends, arrays.table(at, "poses", 3, unit="metres and radians", limit=np.inf)
