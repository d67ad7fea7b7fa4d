"""Line segments: arrays `(n, 2, 2)` in metres, `segments[i, k]` is end point k of segment i.

A segment has no direction: swapping its end points gives the same segment.
"""

from ._segments import (
    MIN_LENGTH,
    SegmentMap,
    angle,
    cut_evenly,
    extreme_projections,
    length,
    main_direction,
    midpoint,
    point_distance,
    take_points,
)

__all__ = [
    "MIN_LENGTH", "SegmentMap", "angle", "cut_evenly", "extreme_projections", "length",
    "main_direction", "midpoint", "point_distance", "take_points",
]  # fmt: skip
