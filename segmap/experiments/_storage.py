"""One building kept in five ways: what each takes, and how far it is from the walls."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from .._display import Table
from ..arrays import Array, Segments
from ..extraction import build_map
from ..poses import transform
from ..quadtree import QuadtreeMap
from ..quadtree import build_map as build_quadtree
from ..reduction import fusion
from ..scans import Log
from ..segments import length, point_distance

#: Samples along segments and walls, metres: a fifth of the smallest error that matters here.
SPACING = 0.01


class Kept(NamedTuple):
    """One way to keep a building.

    `points` `(n, 2)`, metres, are what it says of walls: the places themselves, samples along
    segments, or centres of occupied cells.
    """

    name: str
    parts: int
    nbytes: int
    points: Array


class Ways(NamedTuple):
    """All five, the map of segments before `(n, 2, 2)` and after Fusion, and the quadtree."""

    kept: list[Kept]
    segments: Array
    reduced: Array
    map: QuadtreeMap


class Judged(NamedTuple):
    """How good it is: mean distance from the walls, metres, and the share of walls covered."""

    kept: Kept
    error: float
    covered: float


def keep(log: Log, poses: ArrayLike, *, resolution: float = 0.05, tolerance: float = 0.04) -> Ways:
    """An aligned log as points, segments, reduced segments, quadtree and grid.

    Parameters
    ----------
    log : Log
    poses : (k, 3) array, metres and radians
        One a scan; scans with NaN in their pose are left out of all five.
    resolution : float, metres
        Of the quadtree and the grid.
    tolerance : float, metres
        Of Fusion, which reduces the segments.

    Returns
    -------
    Ways
        Bytes: 16 a point, 32 a segment, 8 a node of the tree, and two counts of 4 bytes for each
        cell of a grid that just holds the occupied cells.

    Raises
    ------
    ValueError
        As `quadtree.build_map`, for poses that do not fit the log say; for a tolerance that is not
        positive.

    Examples
    --------
    >>> from segmap import load
    >>> log = load("room")
    >>> [kept.name for kept in keep(log, log.truth).kept]
    ['points', 'segments', 'reduced segments', 'quadtree', 'dense grid']
    """
    map = build_quadtree(log, poses, resolution=resolution)  # which looks at the poses
    at = np.asarray(poses, float).reshape(-1, 3)
    placed = np.flatnonzero(np.isfinite(at).all(1)).tolist()
    points = np.concatenate(
        [np.empty((0, 2)), *(transform(at[k], log[k].points()) for k in placed)]
    )
    segments = build_map(log, at)
    reduced = fusion(segments, tolerance=tolerance).segments
    cells = occupied_centres(map)
    grid = np.ptp(np.rint(cells / resolution), axis=0) + 1 if len(cells) else np.zeros(2)
    size = int(grid.prod())
    found = [
        Kept("points", len(points), points.nbytes, points),
        Kept("segments", len(segments), segments.segments.nbytes, along(segments.segments)),
        Kept("reduced segments", len(reduced), reduced.nbytes, along(reduced)),
        Kept("quadtree", len(map.leaves().x), map.nbytes, cells),
        Kept("dense grid", size, 8 * size, cells),
    ]
    return Ways(found, segments.segments, reduced, map)


def occupied_centres(map: QuadtreeMap) -> Array:
    """Centres of the occupied cells, `(n, 2)`, metres."""
    leaves = map.leaves()
    occupied = leaves.occ > leaves.vis - leaves.occ
    corner = np.stack([leaves.x[occupied], leaves.y[occupied]], -1)
    return corner + leaves.side[occupied, None] / 2


def along(segments: Segments, spacing: float = SPACING) -> Array:
    """Points `(n, 2)`, metres, along segments, evenly, at most so far apart, both ends among them.

    Raises
    ------
    ValueError
        For a spacing that is not positive.

    Examples
    --------
    >>> along([[(0, 0), (1, 0)]], 0.5)
    array([[0. , 0. ],
           [0.5, 0. ],
           [1. , 0. ]])
    """
    if not 0 < spacing < np.inf:
        raise ValueError(f"spacing must be positive and finite, in metres, got {spacing}")
    ends = arrays.segments(segments)
    counts = np.maximum(np.ceil(length(ends) / spacing - 1e-9), 1).astype(int)
    parts = [
        a + np.linspace(0, 1, n + 1)[:, None] * (b - a)
        for (a, b), n in zip(ends, counts, strict=True)
    ]
    return np.concatenate([np.empty((0, 2)), *parts])


def wall_errors(points: Array, walls: Segments) -> Array:
    """Distance of each point from the nearest wall, `(n,)`, metres.

    Raises
    ------
    ValueError
        Without walls.

    Examples
    --------
    >>> wall_errors(np.array([(0.5, 0.2), (2, 0)]), [[(0, 0), (1, 0)]])
    array([0.2, 1. ])
    """
    known = arrays.segments(walls)
    if not len(known):
        raise ValueError("walls must hold at least one: without, there is no distance to them")
    return np.min([point_distance(points, wall) for wall in known], axis=0)


def judge(kept: Iterable[Kept], walls: Segments, *, within: float = 0.05) -> list[Judged]:
    """Compare with the true walls; what the first, the points, do not reach was never seen.

    Parameters
    ----------
    kept : iterable of Kept
        As `keep` gives them: first the points.
    walls : (n, 2, 2) array, metres
    within : float, metres
        A sample of a wall counts as covered where something kept is so near.

    Returns
    -------
    list of Judged
        Covered: of those samples of walls that the first covers; NaN where it covers none.

    Raises
    ------
    ValueError
        Without walls.
    """
    from scipy.spatial import cKDTree

    ways, truth = list(kept), along(walls)
    near = np.array([cKDTree(way.points).query(truth)[0] <= within for way in ways])
    return [
        Judged(way, _mean(wall_errors(way.points, walls)), _mean(covers[near[0]]))
        for way, covers in zip(ways, near, strict=True)
    ]


def _mean(values: NDArray[Any]) -> float:
    return float(values.mean()) if len(values) else float("nan")


def storage_table(judged: Iterable[Judged]) -> Table:
    """Ways to keep a building as a table."""
    rows = [
        (
            found.kept.name,
            found.kept.parts,
            f"{found.kept.nbytes / 1e3:.1f}",
            f"{1e3 * found.error:.1f}",
            f"{100 * found.covered:.1f}",
        )
        for found in judged
    ]
    return Table(["kept as", "parts", "kB", "off the walls [mm]", "walls covered [%]"], rows)
