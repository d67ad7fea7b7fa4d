"""Alignment: one pose for each scan of a log whose odometry drifts.

Every method has one signature, `method(log, *, thresholds) -> Alignment`, and stands in `METHODS`.
"""

from ._result import Alignment, Graph, Match, Method, Rejected

#: Name of each method -> the method, with what it needs.
METHODS: dict[str, Method] = {}

__all__ = ["METHODS", "Alignment", "Graph", "Match", "Method", "Rejected"]
