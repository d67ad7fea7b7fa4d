"""Reduction: one segment for each wall instead of one for each time that it was seen.

Every method has one signature, `method(map, *, thresholds) -> Reduction`, and stands in `METHODS`.
"""

from ._basic import basic_offline, basic_online
from ._fusion import fusion
from ._hough import hough
from ._hybrid import hybrid
from ._result import Method, Reduction

#: Name of each method -> the method, with its place in A's table 2.16.
METHODS: dict[str, Method] = {
    "basic_offline": Method(
        basic_offline, "2 -> 1", online=False, needs_points=False, source="A 4.1"
    ),
    "basic_online": Method(basic_online, "2 -> 1", online=True, needs_points=False, source="A 4.1"),
    "hybrid": Method(hybrid, "2 -> 1", online=True, needs_points=False, source="A 4.2"),
    "fusion": Method(fusion, "m -> 1", online=False, needs_points=False, source="A 4.4"),
}

__all__ = [
    "METHODS",
    "Method",
    "Reduction",
    "basic_offline",
    "basic_online",
    "fusion",
    "hough",
    "hybrid",
]
