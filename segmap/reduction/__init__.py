"""Reduction: one segment for each wall instead of one for each time that it was seen.

Every method has one signature, `method(map, *, thresholds) -> Reduction`, and stands in `METHODS`.
"""

from ..methods import Method
from ._basic import basic_offline, basic_online
from ._fusion import fusion
from ._hough import hough
from ._hybrid import hybrid
from ._hybrid_fusion import hybrid_fusion
from ._mean_shift import Directions, common_directions, mean_shift
from ._result import Methods, Reduction

#: Name of each method -> the method, with its place in A's table 2.16. A calls the class of Basic
#: "simple", after its conditions; like the class 2 -> 1 it makes one segment of two.
METHODS = Methods(
    basic_offline=Method(
        basic_offline,
        "A 4.1",
        "Gonzalez-Banos, Latombe 2002",
        merges="2 -> 1",
        keeps="end points",
    ),
    basic_online=Method(
        basic_online,
        "A 4.1",
        "Gonzalez-Banos, Latombe 2002",
        merges="2 -> 1",
        keeps="end points",
        online=True,
    ),
    hybrid=Method(
        hybrid,
        "A 4.2",
        "Kuo et al. 2009",
        merges="2 -> 1",
        keeps="rho, theta, length, end points, count",
        online=True,
    ),
    mean_shift=Method(mean_shift, "A 4.3", "Lakaemper 2009", merges="m -> n", keeps="end points"),
    fusion=Method(fusion, "A 4.4", "Amigoni, Vailati 2009", merges="m -> 1", keeps="end points"),
    hybrid_fusion=Method(
        hybrid_fusion,
        "A 7",
        merges="m -> 1",
        keeps="rho, theta, length, end points, count",
        online=True,
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
