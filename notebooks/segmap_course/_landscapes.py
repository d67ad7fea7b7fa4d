"""A score around a pose: the landscape that matchers climb."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from segmap import arrays
from segmap.arrays import Array
from segmap.matching import Score, field_score
from segmap.quadtree import QuadtreeMap


class Landscape(NamedTuple):
    """Scores `(m, m)` at offsets `(m,)` in metres: rows along the map's y, columns along its x."""

    offsets: Array
    values: Array


def landscape(
    map: QuadtreeMap,
    points: ArrayLike,
    pose: ArrayLike,
    *,
    score: Score = field_score,
    reach: float = 0.3,
    step: float = 0.01,
) -> Landscape:
    """Scores of a scan at places around a pose, its heading kept (after B 4.3).

    So far to each side, `reach`, and in steps of `step`, metres.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.1)
    >>> tree.insert_scan((0, 0), [(1.05, 0.05)])
    >>> landscape(tree, [(1.05, 0.05)], (0, 0, 0), reach=0.1, step=0.1).values.round(3)[1]
    array([-0.1, -0. , -0.1])
    """
    ends, middle = arrays.points(points), arrays.pose(pose)
    offsets = _offsets(reach, step)
    x, y = np.meshgrid(offsets, offsets)
    poses = middle + np.stack([x, y, 0 * x], -1).reshape(-1, 3)
    return Landscape(offsets, score(map, ends, poses).reshape(x.shape))


def heading_profile(
    map: QuadtreeMap,
    points: ArrayLike,
    pose: ArrayLike,
    *,
    score: Score = field_score,
    reach: float = np.pi,
    step: float = np.radians(1.0),
) -> tuple[Array, Array]:
    """Scores of a scan turned about a pose: offsets `(m,)` in radians and scores `(m,)` (B 4.3).

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.1)
    >>> tree.insert_scan((0, 0), [(1.05, 0.05)])
    >>> turn, values = heading_profile(tree, [(1.05, 0.05)], (0, 0, 0))
    >>> len(turn), bool(values[180] == values.max())
    (361, True)
    """
    ends, middle = arrays.points(points), arrays.pose(pose)
    offsets = _offsets(reach, step)
    poses = np.tile(middle, (len(offsets), 1))
    poses[:, 2] += offsets
    return offsets, score(map, ends, poses)


def _offsets(reach: float, step: float) -> Array:
    if not (0 < step <= reach < np.inf):
        raise ValueError(f"step must be positive and reach no less, got {step:g} and {reach:g}")
    count = int(np.floor(reach / step + 1e-9))
    return np.arange(-count, count + 1, dtype=np.float64) * step


def peaks(values: ArrayLike) -> NDArray[np.int64]:
    """Places that are higher than all around them, `(k, dimensions)`, the highest first.

    A plateau counts once; what touches the border counts where nothing beside it is higher. NaN is
    refused: it is neither higher nor lower.

    Examples
    --------
    >>> peaks([0, 3, 1, 2, 2, 0])
    array([[1],
           [3]])
    """
    from scipy.ndimage import label, maximum_filter

    heights = np.asarray(values, float)
    if np.isnan(heights).any():
        where = np.argwhere(np.isnan(heights))[0].tolist()
        raise ValueError(f"values must not be NaN, got one at {where}")
    beaten = maximum_filter(heights, 3, mode="nearest") > heights
    for _ in range(heights.size):  # whoever is as high as a beaten neighbour is beaten too
        spread = maximum_filter(np.where(beaten, heights, -np.inf), 3, mode="nearest")
        if not (lost := ~beaten & (spread == heights)).any():
            break
        beaten |= lost
    plateaus, count = label(~beaten, np.ones((3,) * heights.ndim))
    first = [tuple(np.argwhere(plateaus == k + 1)[0]) for k in range(count)]
    first.sort(key=lambda place: -heights[place])
    return np.array(first, np.int64).reshape(count, heights.ndim)


def profile_peaks(turn: ArrayLike, values: ArrayLike) -> NDArray[np.int64]:
    """Places of a `heading_profile` that are higher than all around, the highest first, `(k,)`.

    As `peaks`, but after a whole turn the last value is the first again: the ends are no border.

    Examples
    --------
    >>> turn, values = np.radians([-180, -90, 0, 90, 180]), [2, 1, 0, 3, 2]
    >>> profile_peaks(turn, values), peaks(values)[:, 0]
    (array([3]), array([3, 0]))
    """
    angles, heights = np.asarray(turn, float), np.asarray(values, float)
    if not np.isclose(angles[-1] - angles[0], 2 * np.pi):
        return peaks(heights)[:, 0]
    count = len(heights) - 1
    tops = peaks(np.tile(heights[:-1], 3))[:, 0] - count  # in the middle one of three turns
    inside = tops[(tops >= 0) & (tops < count)]
    return inside if len(inside) else np.zeros(1, np.int64)
