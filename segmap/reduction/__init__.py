"""Reduction: one segment for each wall instead of one for each time that it was seen.

Every method has one signature, `method(map, *, thresholds) -> Reduction`, and stands in `METHODS`.
"""

from ._basic import basic_offline, basic_online
from ._fusion import fusion
from ._hough import hough
from ._hybrid import hybrid
from ._hybrid_fusion import hybrid_fusion
from ._mean_shift import Directions, common_directions, mean_shift
from ._result import Method, Methods, Reduction

#: Name of each method -> the method, with its place in A's table 2.16. A calls the class of Basic
#: "simple", after its conditions; like the class 2 -> 1 it makes one segment of two.
METHODS = Methods(
    basic_offline=Method(
        basic_offline,
        "2 -> 1",
        online=False,
        needs_points=False,
        source="A 4.1",
        paper="Gonzalez-Banos, Latombe 2002",
    ),
    basic_online=Method(
        basic_online,
        "2 -> 1",
        online=True,
        needs_points=False,
        source="A 4.1",
        paper="Gonzalez-Banos, Latombe 2002",
    ),
    hybrid=Method(
        hybrid,
        "2 -> 1",
        online=True,
        needs_points=False,
        source="A 4.2",
        keeps="rho, theta, length, end points, count",
        paper="Kuo et al. 2009",
    ),
    mean_shift=Method(
        mean_shift,
        "m -> n",
        online=False,
        needs_points=False,
        source="A 4.3",
        paper="Lakaemper 2009",
    ),
    fusion=Method(
        fusion,
        "m -> 1",
        online=False,
        needs_points=False,
        source="A 4.4",
        paper="Amigoni, Vailati 2009",
    ),
    hybrid_fusion=Method(
        hybrid_fusion,
        "m -> 1",
        online=True,
        needs_points=False,
        source="A 7",
        keeps="rho, theta, length, end points, count",
    ),
)

__all__ = [
    "METHODS",
    "Directions",
    "Method",
    "Methods",
    "Reduction",
    "basic_offline",
    "basic_online",
    "common_directions",
    "fusion",
    "hough",
    "hybrid",
    "hybrid_fusion",
    "mean_shift",
]
