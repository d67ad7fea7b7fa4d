"""Alignment: one pose for each scan of a log whose odometry drifts.

Every method has one signature, `method(log, *, thresholds) -> Alignment`, and stands in `METHODS`.
"""

from ._result import Alignment, Graph, Match, Method, Rejected
from ._segment_icp import match_segments, segment_icp

#: Name of each method -> the method, with what it needs.
METHODS: dict[str, Method] = {
    "segment_icp": Method(segment_icp, "map", True, "A 2.5.1, [31]"),
}

__all__ = [
    "METHODS",
    "Alignment",
    "Graph",
    "Match",
    "Method",
    "Rejected",
    "match_segments",
    "segment_icp",
]
