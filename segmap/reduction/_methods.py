"""All reduction methods by name."""

from __future__ import annotations

from ..methods import Method
from ._basic import basic_offline, basic_online
from ._fusion import fusion, fusion_online
from ._hybrid import hybrid
from ._hybrid_fusion import hybrid_fusion
from ._mean_shift import mean_shift
from ._runner import Methods
from .least_cost import least_cost
from .one_per_wall import one_per_wall
from .surveyed import (
    fuzzy_clustering,
    fuzzy_set,
    polyline,
    segment_similarity,
    uncertain_parameters,
    viewing_sector,
    weighted_line_fitting,
)

#: The method where nothing else is chosen.
USUAL_METHOD = "least_cost"
#: Thresholds of the usual method. By each of five lasers it leaves at
#: most 1.2 segments a wall of random buildings, with 10 % invented and 2 % missed; at 0.28 a wall
#: has more, and 1.6 misses more (docs/which_method.md).
USUAL_THRESHOLDS = {"penalty": 1.0}

#: Name of each method -> the method, with its place in A's table 2.16. A calls the class of Basic
#: "simple", after its conditions; like the class 2 -> 1 it makes one segment of two.
METHODS = Methods(
    basic_offline=Method(
        basic_offline, "A 4.1", "Gonzalez-Banos, Latombe 2002",
        merges="2 -> 1", keeps="end points", varies="distance",
    ),
    basic_online=Method(
        basic_online, "A 4.1", "Gonzalez-Banos, Latombe 2002",
        merges="2 -> 1", keeps="end points", varies="distance", online=True,
    ),
    hybrid=Method(
        hybrid, "A 4.2", "Kuo et al. 2009",
        merges="2 -> 1", keeps="rho, theta, length, end points, count", varies="distance",
        online=True,
    ),
    mean_shift=Method(
        mean_shift, "A 4.3", "Lakaemper 2009",
        merges="m -> n", keeps="end points", varies="sigma",
    ),
    fusion=Method(
        fusion, "A 4.4", "Amigoni, Vailati 2009",
        merges="m -> 1", keeps="end points", varies="tolerance",
    ),
    hybrid_fusion=Method(
        hybrid_fusion, "A 7",
        merges="m -> 1", keeps="rho, theta, length, end points, count", varies="tolerance",
        online=True,
    ),
    # m -> 1 in A's text, m -> n in its table, which is right: a chain becomes several pieces
    polyline=Method(
        polyline, "A 2.7.10", "Amigoni, Gasparini, Gini 2006",
        merges="m -> n", keeps="end points", varies="tolerance", online=True,
    ),
    segment_similarity=Method(
        segment_similarity, "A 2.7.7", "Elseberg, Creed, Lakaemper 2010",
        merges="2 -> 1", keeps="end points, weight", varies="distance",
    ),
    # 2 -> 1 in A's text and table; in effect a new segment takes in all its matches at once
    uncertain_parameters=Method(
        uncertain_parameters, "A 2.7.8", "Amigoni, Fontana, Garigiola 2006",
        merges="2 -> 1", keeps="rho, theta, both sigmas, end points", varies="distance",
        online=True, needs_points=True,
    ),
    weighted_line_fitting=Method(
        weighted_line_fitting, "A 2.7.3", "Pfister, Roumeliotis, Burdick 2003",
        merges="2 -> 1", keeps="line, covariance, end points", varies="chi2",
        online=True, needs_points=True,
    ),
    least_cost=Method(
        least_cost, "ours",
        merges="m -> 1", keeps="end points, sums, members", varies="penalty",
    ),
    one_per_wall=Method(
        one_per_wall, "ours",
        merges="m -> 1", keeps="end points, scans, members", varies="factor", needs_points=True,
    ),
    fusion_online=Method(
        fusion_online, "A 2.7.9", "Amigoni, Vailati 2009",
        merges="m -> 1", keeps="end points", varies="tolerance", online=True,
    ),
    # the table's row drops e, which the text has
    fuzzy_set=Method(
        fuzzy_set, "A 2.7.4", "Lopez-Sanchez, Esteva, Lopez de Mantaras, Sierra 1998",
        merges="2 -> 1", keeps="end points, e, e1, e2", varies="across", needs_points=True,
    ),
    # A reconstruction: A has the frame and no formula. The table says 2 -> 1, and a weight where
    # eq. 2.30 has the centre
    fuzzy_clustering=Method(
        fuzzy_clustering, "A 2.7.6", "Ip, Rad, Chow, Wong 2002 (reconstruction)",
        merges="m -> 1", keeps="direction, mixing, end points, centre", varies="distance",
        online=True, needs_points=True,
    ),
    viewing_sector=Method(
        viewing_sector, "A 2.7.5", "Gonzalez, Ollero, Reina 1994",
        merges="2 -> 1", keeps="end points, running sums", varies="distance",
        online=True, needs_points=True, needs_sensors=True,
    ),
)  # fmt: skip
