"""The points behind the segments that a method works on: those of the map, or others instead."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array, Segments
from ..segments import SegmentMap, cut_evenly, length, midpoint, take_points
from ._runner import Indices, Rows

#: More points than this, 16 bytes each, are a mistake in the spacing.
MOST_SPACED_POINTS = 20_000_000


class Behind(NamedTuple):
    """What lies behind k segments.

    Parameters
    ----------
    points : (p, 2) array, metres
    first : (k + 1,) int array
        Points of segment i are `points[first[i] : first[i + 1]]`.
    sensors : (k, 2) array, metres
        Where the sensor was when it saw each; NaN where the map does not tell.
    kept : bool
        Whether they are the points of the map, and no others instead.
    """

    points: Array
    first: Indices
    sensors: Array
    kept: bool


def points_behind(map: Segments, rows: Rows, spacing: float | None) -> Behind:
    """Points and places of the sensor of the rows of a map.

    A map without points gets one each `spacing` metres along its segments, at least two a segment;
    without a spacing it gets none.
    """
    sensors = np.full((len(rows.source_row), 2), np.nan)
    if isinstance(map, SegmentMap) and map.sensors is not None:
        sensors = map.sensors[map.scan[rows.source_row]]
    if isinstance(map, SegmentMap) and map.points is not None and map.first is not None:
        return Behind(*take_points(map.points, map.first, rows.source_row), sensors, True)
    if spacing is None:
        return Behind(
            np.empty((0, 2)), np.zeros(len(rows.source_row) + 1, np.int64), sensors, False
        )
    return Behind(*stand_ins(rows.segments, spacing), sensors, False)


def stand_ins(segments: Array, spacing: float) -> tuple[Array, Indices]:
    """Points `(p, 2)` evenly along segments `(k, 2, 2)`, metres; where those of each begin."""
    share = np.floor(length(segments) / spacing + 1e-9)
    if share.sum() > MOST_SPACED_POINTS:
        raise ValueError(
            f"spacing must make at most {MOST_SPACED_POINTS} points of this map, "
            f"got {spacing} m, which makes {share.sum():.3g}: is it in metres?"
        )
    count = np.maximum(share.astype(np.int64) + 1, 2)
    return midpoint(cut_evenly(segments, count)[0]), np.append(0, np.cumsum(count))
