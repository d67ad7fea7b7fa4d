"""What lies behind the segments of a map: their points, and the places of the sensor."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array


def take_points(
    points: Array, first: NDArray[np.int64], rows: NDArray[np.int64]
) -> tuple[Array, NDArray[np.int64]]:
    """Points of the segments `rows` of a map, and where those of each begin.

    Examples
    --------
    >>> points, first = np.arange(10.0).reshape(5, 2), np.array([0, 2, 5])
    >>> take_points(points, first, np.array([1]))[0][:, 0], take_points(points, first, [1])[1]
    (array([4., 6., 8.]), array([0, 3]))
    """
    counts = np.diff(first)[rows]
    starts = np.append(0, np.cumsum(counts))
    shift = np.repeat(first[:-1][rows] - starts[:-1], counts)
    return points[np.arange(starts[-1]) + shift], starts


def cut_evenly(segments: Array, counts: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
    """Equal pieces of segments, `(p, 2, 2)`, so many of each, from end point 0 on; and their rows.

    Examples
    --------
    >>> pieces, owner = cut_evenly(np.array([[(0.0, 0.0), (2.0, 0.0)]]), np.array([2]))
    >>> pieces[:, :, 0].tolist(), owner.tolist()
    ([[0.0, 1.0], [1.0, 2.0]], [0, 0])
    """
    owner = np.repeat(np.arange(len(counts)), counts)
    nth = (np.arange(len(owner)) - (np.cumsum(counts) - counts)[owner])[:, None]
    begin, step = segments[owner, 0], ((segments[:, 1] - segments[:, 0]) / counts[:, None])[owner]
    return np.stack([begin + nth * step, begin + (nth + 1) * step], 1), owner


def copy_points(
    points: ArrayLike | None, first: ArrayLike | None, count: int
) -> tuple[Array | None, NDArray[np.int64] | None]:
    """Copies of the points behind `count` segments, metres, and where those of each begin."""
    if points is None and first is None:
        return None, None
    if points is None or first is None:
        raise ValueError("points and first must be given together, or neither of them")
    p, starts = np.array(arrays.points(points)), arrays.indices(first, "first")
    counts = np.diff(starts) if starts.shape == (count + 1,) else np.zeros(1)
    if starts.shape != (count + 1,) or (counts < 2).any() or [starts[0], starts[-1]] != [0, len(p)]:
        raise ValueError(
            f"first must rise from 0 to {len(p)}, the number of points, in {count} steps of at "
            f"least 2 points a segment, got {starts.size} values"
        )
    return p, starts


def checked_places(sensors: ArrayLike, scan: NDArray[np.int64]) -> Array:
    """A copy of the places of the sensor, metres, of which each scan with segments has one."""
    places = np.array(arrays.table(sensors, "sensors", 2, missing=True))
    low, high = (scan.min(), scan.max()) if len(scan) else (0, -1)
    if low < 0 or high >= len(places) or not np.isfinite(places[scan]).all():
        raise ValueError(
            f"sensors must hold a place for each scan that has segments, {low} to {high}, "
            f"got {len(places)} places"
        )
    return places


def clip(segments: Array, low: Array, high: Array) -> tuple[Array, NDArray[np.bool_]]:
    """What of segments `(n, 2, 2)` lies in a rectangle, metres, and which have something in it.

    Liang and Barsky 1984: a segment enters where it is inside the last of four borders.
    """
    start, span = segments[:, 0], segments[:, 1] - segments[:, 0]
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        cuts = np.sort([(low - start) / span, (high - start) / span], axis=0)
    beside = (span == 0) & ~((low <= start) & (start <= high))
    cuts[:, span == 0] = [[-np.inf], [np.inf]]  # along a border: inside all the way, or never
    enter, leave = cuts[0].max(1).clip(0, 1), cuts[1].min(1).clip(0, 1)
    ends = start[:, None] + np.stack([enter, leave], -1)[..., None] * span[:, None]
    ends[leave == 1, 1] = segments[leave == 1, 1]
    return ends.clip(low, high), (enter < leave) & ~beside.any(1)
