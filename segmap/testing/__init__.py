"""Help for tests: assertions that know what is the same, and a zoo of inputs."""

from __future__ import annotations

from ._assertions import assert_poses_equal, assert_segments_equal
from ._zoo import point_zoo, scan_zoo, segment_zoo

__all__ = [
    "assert_poses_equal",
    "assert_segments_equal",
    "point_zoo",
    "scan_zoo",
    "segment_zoo",
]
