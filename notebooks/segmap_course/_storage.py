"""One building represented in five ways: what each takes, how far it is from the walls."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from segmap import arrays
from segmap.arrays import Array, Metres, Segments, checked
from segmap.extraction import build_map
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap
from segmap.quadtree import build_map as build_quadtree
from segmap.reduction import fusion
from segmap.scans import Log
from segmap.segments import length, point_distance

if TYPE_CHECKING:
    import pandas as pd

#: Distance of samples along segments and walls, metres: a fifth of the smallest error that matters.
SPACING = 0.01


class Representation(NamedTuple):
    """One way to keep a building; a dense grid has the cells of the quadtree."""

    #: Points `(n, 2)` or segments `(n, 2, 2)`, metres, or a `QuadtreeMap`.
    map: Any
    parts: int
    nbytes: int
    #: Where it says that walls are, `(n, 2)`, metres: the points themselves, samples along
    #: segments, or centres of occupied cells.
    points: Array


def represent(
    log: Log, poses: ArrayLike, *, resolution: float = 0.05, tolerance: float = 0.04
) -> dict[str, Representation]:
    """An aligned log as points, segments, reduced segments, quadtree and dense grid.

    Scans with NaN in their pose are left out of all five. The resolution is that of quadtree and
    grid, and the tolerance that of Fusion, which reduces the segments. Bytes: 16 a point, 32 a
    segment, 8 a node of the tree, and two counts of 4 bytes for each cell of a grid that just holds
    the occupied cells.

    Examples
    --------
    >>> from segmap import load
    >>> log = load("room")
    >>> list(represent(log, log.truth))
    ['points', 'segments', 'reduced segments', 'quadtree', 'dense grid']
    """
    map = build_quadtree(log, poses, resolution=resolution)  # checks the poses
    at = np.asarray(poses, float).reshape(-1, 3)
    placed = np.flatnonzero(np.isfinite(at).all(1)).tolist()
    parts = [transform(at[k], log[k].points()) for k in placed]
    points = np.concatenate([np.empty((0, 2)), *parts])
    segments = build_map(log, at).segments
    reduced = fusion(segments, tolerance=tolerance).segments
    cells = occupied_centres(map)
    grid = np.ptp(np.rint(cells / resolution), axis=0) + 1 if len(cells) else np.zeros(2)
    count = int(grid.prod())
    return {
        "points": Representation(points, len(points), points.nbytes, points),
        "segments": _of_segments(segments),
        "reduced segments": _of_segments(reduced),
        "quadtree": Representation(map, len(map.leaves().x), map.nbytes, cells),
        "dense grid": Representation(map, count, 8 * count, cells),
    }


def compare_with_walls(
    found: Mapping[str, Representation], walls: Segments, *, within: float = 0.05
) -> pd.DataFrame:
    """Compare representations with the true walls: a table with a row for each.

    Its columns are parts; nbytes; error: mean distance of the points from the walls, metres;
    covered: share of the samples of walls seen that have a point `within` so many metres, NaN where
    none was. Walls that the first, the points, do not reach were never seen, and do not count.
    """
    import pandas as pd
    from scipy.spatial import cKDTree

    truth = sample_points(walls)
    away = np.array([cKDTree(way.points).query(truth)[0] for way in found.values()])
    near = away[:, away[0] <= within] <= within
    rows = [
        (way.parts, way.nbytes, _mean(wall_errors(way.points, walls)), _mean(covered))
        for way, covered in zip(found.values(), near, strict=True)
    ]
    return pd.DataFrame(rows, list(found), ["parts", "nbytes", "error", "covered"])


def occupied_centres(map: QuadtreeMap) -> Array:
    """Centres of the occupied cells, `(n, 2)`, metres."""
    leaves = map.leaves()
    occupied = leaves.occ > leaves.vis - leaves.occ
    corner = np.stack([leaves.x[occupied], leaves.y[occupied]], -1)
    return corner + leaves.side[occupied, None] / 2


@checked
def sample_points(segments: Segments, spacing: Metres = SPACING) -> Array:
    """Points `(n, 2)`, metres, along segments, evenly, at most so far apart, with both ends.

    Examples
    --------
    >>> sample_points([[(0, 0), (1, 0)]], 0.5)
    array([[0. , 0. ],
           [0.5, 0. ],
           [1. , 0. ]])
    """
    ends = arrays.segments(segments)
    counts = np.maximum(np.ceil(length(ends) / spacing - 1e-9), 1).astype(int)
    parts = [
        a + np.linspace(0, 1, n + 1)[:, None] * (b - a)
        for (a, b), n in zip(ends, counts, strict=True)
    ]
    return np.concatenate([np.empty((0, 2)), *parts])


def wall_errors(points: Array, walls: Segments) -> Array:
    """Distance of each point from the nearest wall, `(n,)`, metres.

    Examples
    --------
    >>> wall_errors(np.array([(0.5, 0.2), (2, 0)]), [[(0, 0), (1, 0)]])
    array([0.2, 1. ])
    """
    lines = arrays.segments(walls, "walls")
    if not len(lines):
        raise ValueError("walls must hold at least one: without, there is no distance to them")
    return np.min([point_distance(points, wall) for wall in lines], axis=0)


def _of_segments(segments: Array) -> Representation:
    return Representation(segments, len(segments), segments.nbytes, sample_points(segments))


def _mean(values: NDArray[Any]) -> float:
    return float(values.mean()) if len(values) else float("nan")
