"""Points of walls to match scans with: by search in a window, and by point-to-line ICP."""

from ._match import PointStep, match_points, point_steps
from ._moving import (
    AND_ACCELERATION,
    AND_JUMP,
    BENT_REACH_M,
    POSE_AND_VELOCITY,
    match_moving,
    poses_at,
)
from ._point_kernels import place_clouds
from ._point_map import (
    FARTHEST_POINT_M,
    LAST,
    LEAST_POINTS,
    SEARCH_CELL_M,
    SEARCH_POINTS,
    PointMap,
    decimate,
    in_range,
    shows_no_place,
)

__all__ = [
    "AND_ACCELERATION", "AND_JUMP", "BENT_REACH_M", "FARTHEST_POINT_M", "LAST", "LEAST_POINTS",
    "POSE_AND_VELOCITY", "SEARCH_CELL_M", "SEARCH_POINTS", "PointMap", "PointStep", "decimate",
    "in_range", "match_moving", "match_points", "place_clouds", "point_steps", "poses_at",
    "shows_no_place",
]  # fmt: skip
