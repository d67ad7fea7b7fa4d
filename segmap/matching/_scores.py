"""How well a scan lies on a quadtree map at a pose: scores, the higher the better (B 4.3)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array
from ..compiled import compiled
from ..kernels import Nodes, leaves_in
from ..poses.motions import transform
from ..quadtree import QuadtreeMap

Counts = NDArray[np.int32]
Cells = NDArray[np.int64]
Holds = NDArray[np.bool_]
#: Ends of beams and poses may lie so far away, metres: they count as on the edge of the map.
FARTHEST_END_M = 1e300
#: Poses whose ends are looked for together.
POSES_TOGETHER = 16
#: Where cells farther than this may be nearest, in cells, each end is looked for by itself.
FARTHEST_CANDIDATE = 60
#: Makes 64 bits of a number.
whole: Any = np.int64


def occupancy_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """Sum of the occupancy of the cells that the beams end in, where above 0.5 (B 4.3).

    It is flat wherever no beam meets an occupied cell, so it does not tell which way to go.

    Parameters
    ----------
    map : QuadtreeMap
        An empty one has no score: a ValueError.
    points : (n, 2) array, metres
        Ends of the beams in the robot's frame.
    poses : (k, 3) or (3,) array, metres and radians
        Of the robot, on the map.

    Returns
    -------
    (k,) array

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.1)
    >>> tree.insert_scan((0, 0), [(1, 0), (1, 0.5)])
    >>> occupancy_score(tree, [(1, 0), (1, 0.5)], [(0, 0, 0), (0.3, 0, 0)])
    array([2., 0.])
    """
    blocks_of(map)
    ends, at = scan_and_poses(points, poses)
    occupancy = map.occupancy(transform(at, ends).reshape(-1, 2)).reshape(len(at), len(ends))
    return np.where(occupancy > 0.5, occupancy, 0.0).sum(1)


def distance_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """Minus the sum of the distances from the ends to the nearest occupied cell's centre, exact.

    A kd-tree holds all occupied cells. Parameters are those of `occupancy_score`. B 4.3 measures to
    the corners of cells, from ends cut to whole centimetres. Scores `(k,)` are in metres.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.1)
    >>> tree.insert_scan((0, 0), [(1.05, 0.05)])
    >>> distance_score(tree, [(1.05, 0.05)], [(0, 0, 0), (0.3, 0, 0)]).round(6) + 0
    array([ 0. , -0.3])
    """
    from scipy.spatial import cKDTree

    blocks_of(map)
    ends, at = scan_and_poses(points, poses)
    leaves = map.leaves()
    occupied = leaves.occ > leaves.vis - leaves.occ
    corner = np.stack([leaves.x[occupied], leaves.y[occupied]], -1)
    distance = cKDTree(corner + map.resolution / 2).query(transform(at, ends))[0]
    return -np.asarray(distance).sum(1)


def nearest_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """The value of `distance_score`, found in the tree: nearest squares first, exact.

    Squares farther than the best so far are not entered (Roussopoulos, Kelley and Vincent 1995; B
    names such a score as future work). Parameters are those of `occupancy_score`.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.1)
    >>> tree.insert_scan((0, 0), [(1.05, 0.05)])
    >>> nearest_score(tree, [(1.05, 0.05)], (0.3, 0, 0)).round(6)
    array([-0.3])
    """
    with arrays.instance(map, "map", QuadtreeMap).lock:
        nodes, scan, order = _prepare(map, points, poses)
        levels, sums = map.tree.level, np.zeros(len(order))
        path, todo = np.empty(levels + 1, np.int64), np.empty((3 * levels + 4, 4), np.int64)
        path[-1], together = map.tree.block, np.empty((3, POSES_TOGETHER))
        near = np.empty(((2 * FARTHEST_CANDIDATE + 6) ** 2, 4), np.int64)
        nearest_distances(nodes, scan, path, todo, near, together, sums)
    return _scores(map, sums, order)


def descent_score(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """The same by B's greedy descent, which can miss the nearest cell (B 4.3; for comparison).

    It always enters the child that holds something and whose centre is nearest, so its score is
    never above that of `nearest_score`. Parameters are those of `occupancy_score`.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.1)
    >>> tree.insert_scan((0, 0), [(1.05, 0.05)])
    >>> descent_score(tree, [(1.05, 0.05)], (0.3, 0, 0)).round(6)
    array([-0.3])
    """
    with arrays.instance(map, "map", QuadtreeMap).lock:
        nodes, scan, order = _prepare(map, points, poses)
        sums = np.zeros(len(order))
        descent_distances(nodes, map.tree.block, map.tree.level, scan, sums)
    return _scores(map, sums, order)


class Scan(NamedTuple):
    """Ends of beams `(n, 2)`; cosine, sine, x and y of poses `(k, 4)`, from the root's corner; the
    side of a cell. Lengths are in metres."""

    ends: Array
    frames: Array
    cell: float


def _prepare(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> tuple[Nodes, Scan, Cells]:
    """What a search needs, and what sorts the poses by their headings: neighbours are alike."""
    nodes = Nodes(map.tree.vis, map.tree.occ, blocks_of(map))
    ends, at = scan_and_poses(points, poses)
    order, frames = np.argsort(at[:, 2], kind="stable"), np.empty((len(at), 4))
    sorted_poses = at[order]
    frames[:, 0], frames[:, 1] = np.cos(sorted_poses[:, 2]), np.sin(sorted_poses[:, 2])
    frames[:, 2:] = sorted_poses[:, :2] - (map.corner + map.tree.corner * map.resolution)
    return nodes, Scan(np.array(ends, order="C"), frames, map.resolution), order


def _scores(map: QuadtreeMap, sums: Array, order: Cells) -> Array:
    """Scores, metres, in the order of the poses, of sums of distances, in cells."""
    scores = np.empty(len(order))
    scores[order] = -map.resolution * sums
    return scores


def blocks_of(map: QuadtreeMap) -> Holds:
    """Which blocks of a map hold an occupied cell, (b,) bool array; an empty map has no score."""
    with arrays.instance(map, "map", QuadtreeMap).lock:
        holds, root = map.tree.occupied_blocks(), map.tree.block
    if not holds[root]:
        raise ValueError("the map holds no occupied cell, so no pose has a score: insert a scan")
    return holds


def scan_and_poses(points: ArrayLike, poses: ArrayLike) -> tuple[Array, Array]:
    """Points `(n, 2)`, metres, and poses `(k, 3)` or one, metres and radians, as arrays."""
    ends = arrays.table(points, "points", 2, limit=FARTHEST_END_M)
    at = arrays.numbers(poses, "poses", "a (k, 3) array")
    at = at[None] if at.ndim == 1 and at.size else at
    return ends, arrays.table(at, "poses", 3, unit="metres and radians", limit=FARTHEST_END_M)


# ---------------------------------------------------------------------------------- loops
# Callers bring all arrays, since each that a loop makes for itself takes long to compile.
@compiled
def place_in_cells(scan: Scan, m: int, k: int) -> tuple[float, float]:
    """Where end m lies at pose k, in cells of the root."""
    c, s, x, y = scan.frames[k, 0], scan.frames[k, 1], scan.frames[k, 2], scan.frames[k, 3]
    across, up = scan.ends[m, 0], scan.ends[m, 1]
    return (c * across - s * up + x) / scan.cell, (s * across + c * up + y) / scan.cell


@compiled
def nearest_distances(
    nodes: Nodes, scan: Scan, path: Cells, todo: Cells, near: Cells, together: Array, sums: Array
) -> None:
    """Add the sum over the ends of the distance to the nearest occupied cell's centre, in cells.

    At similar poses, one end lies at nearby places. So the nearest cell of each place is within the
    distance of the middle place's nearest, plus twice the way between the two, of the middle place:
    all cells there are tried at once. The last of `path`, `(top + 1,)`, is the root's block; the
    rest of it, `todo`, `near` and `together`, for places and squares of poses, are scratch arrays.
    """
    x, y, squares = together[0], together[1], together[2]
    for m in range(len(scan.ends)):
        for begin in range(0, len(sums), len(x)):
            part, count, wide, reach = sums[begin:], min(len(sums) - begin, len(x)), 0.0, np.inf
            for k in range(count):
                x[k], y[k] = place_in_cells(scan, m, begin + k)
            i, j = x[count // 2], y[count // 2]
            for k in range(count):
                wide = max(wide, (x[k] - i) * (x[k] - i) + (y[k] - j) * (y[k] - j))
            if count > 1 and wide < FARTHEST_CANDIDATE**2:
                reach = np.sqrt(nearest_square(nodes, path, todo, i, j)) + 2 * np.sqrt(wide)
            if reach > FARTHEST_CANDIDATE:
                for k in range(count):
                    part[k] += np.sqrt(nearest_square(nodes, path, todo, x[k], y[k]))
                continue
            todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = path[-1], 0, 0, len(path) - 1
            x_min, y_min = whole(i - reach) - 2, whole(j - reach) - 2
            window = x_min, y_min, whole(i + reach) + 2, whole(j + reach) + 2
            for k in range(count):
                squares[k] = np.inf
            for one in range(leaves_in(nodes, window, todo, near)):
                a, b = near[one, 1] & 1, near[one, 2] & 1
                east, north = near[one, 1] - a + 0.5, near[one, 2] - b + 0.5
                for k in range(count):
                    dx, dy = east - x[k] + a, north - y[k] + b
                    squares[k] = min(squares[k], dx * dx + dy * dy)
            for k in range(count):
                part[k] += np.sqrt(squares[k])


@compiled
def nearest_square(nodes: Nodes, path: Cells, todo: Cells, x: float, y: float) -> float:
    """Square of the distance from a place to the nearest occupied cell's centre, in cells.

    From the leaf that holds it the search goes upwards, until nothing nearer lies outside. Squares
    wait in `todo`, as block, x, y and level, the one to look into first as the last; those beyond
    the best so far are not entered.
    """
    vis, occ, holds = nodes.vis, nodes.occ, nodes.holds
    top = len(path) - 1
    most = (1 << top) - 1.0
    i, j = whole(min(max(x, 0.0), most)), whole(min(max(y, 0.0), most))

    level, child = top, path[top]
    while child >= 0:  # down to the leaf
        path[level] = child
        level -= 1
        child = ~whole(vis[4 * child + ((i >> level) & 1) + 2 * ((j >> level) & 1)])
    best, count = np.inf, 0
    if level == 0:  # a cell: first its block of four
        todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = path[1], i & -2, j & -2, 1
        level, count = 1, 1
    while count > 0 or level < top:
        if count == 0:  # up: the three sisters of the square
            width, quarter = 1 << level, ((i >> level) & 1) + 2 * ((j >> level) & 1)
            x_min, y_min = i & -width, j & -width
            border = min(min(x - x_min, x_min + width - x), min(y - y_min, y_min + width - y)) + 0.5
            if border > 0 and border * border >= best:
                break
            level += 1
            far_x = max(x - x_min if quarter & 1 else x_min + width - x, 0.0) + 0.5
            far_y = max(y - y_min if quarter & 2 else y_min + width - y, 0.0) + 0.5
            for turn in range(3, 0, -1):
                child = ~whole(vis[4 * path[level] + (quarter ^ turn)])
                square = (far_x * far_x if turn & 1 else 0.0) + (far_y * far_y if turn & 2 else 0.0)
                if square < best and child >= 0 and holds[child]:
                    todo[count, 0], todo[count, 3] = child, level - 1
                    todo[count, 1] = x_min ^ (width * (turn & 1))
                    todo[count, 2] = y_min ^ (width * (turn >> 1))
                    count += 1
            continue
        count -= 1
        block, x_min, y_min = todo[count, 0], todo[count, 1], todo[count, 2]
        below = todo[count, 3] - 1
        half = 1 << below
        dx = max(max(x_min + 0.5 - x, x - (x_min + 2 * half - 0.5)), 0.0)
        dy = max(max(y_min + 0.5 - y, y - (y_min + 2 * half - 0.5)), 0.0)
        near_x, near_y = dx * dx, dy * dy
        if near_x + near_y >= best:
            continue
        if below == 0:
            for q in range(4):
                if 2 * whole(occ[4 * block + q]) > vis[4 * block + q]:
                    dx, dy = x_min + 0.5 - x + (q & 1), y_min + 0.5 - y + (q >> 1)
                    best = min(best, dx * dx + dy * dy)
            continue
        dx, dy = x_min + half - x, y_min + half - y
        nearest, flip = (dx <= 0) + 2 * (dy <= 0), 1 if abs(dx) > abs(dy) else 2
        far_x, far_y = (abs(dx) + 0.5) * (abs(dx) + 0.5), (abs(dy) + 0.5) * (abs(dy) + 0.5)
        for turn in (3, flip, 3 - flip, 0):  # the nearest quarter last
            q = nearest ^ turn
            child = ~whole(vis[4 * block + q])
            square = (far_x if turn & 1 else near_x) + (far_y if turn & 2 else near_y)
            if square < best and child >= 0 and holds[child]:
                todo[count, 0], todo[count, 3] = child, below
                todo[count, 1], todo[count, 2] = (x_min + half * (q & 1), y_min + half * (q >> 1))
                count += 1
    return best


@compiled
def descent_distances(nodes: Nodes, root: int, top: int, scan: Scan, sums: Array) -> None:
    """The same by B's descent: always into the occupied child whose centre is nearest (B 4.3)."""
    vis, occ, holds = nodes.vis, nodes.occ, nodes.holds
    for k in range(len(sums)):
        for m in range(len(scan.ends)):
            x, y = place_in_cells(scan, m, k)
            best, x_min, y_min, block = np.inf, 0.0, 0.0, root
            for level in range(top - 1, -1, -1):
                half, chosen, best = 0.5 * (1 << level), -1, np.inf
                for q in range(4):
                    child = ~whole(vis[4 * block + q])
                    dx = x_min + half + 2 * half * (q & 1) - x
                    dy = y_min + half + 2 * half * (q >> 1) - y
                    cell = 2 * whole(occ[4 * block + q]) > vis[4 * block + q]
                    far = dx * dx + dy * dy
                    if (holds[child] if child >= 0 else cell) and (chosen < 0 or far < best):
                        best, chosen = far, q
                x_min, y_min = x_min + 2 * half * (chosen & 1), y_min + 2 * half * (chosen >> 1)
                block = ~whole(vis[4 * block + chosen])
            sums[k] += np.sqrt(best)
