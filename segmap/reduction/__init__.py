"""Reduction: one segment for each wall instead of one for each time that it was seen.

Every method has one signature, `method(map, *, thresholds) -> Reduction`, and stands in `METHODS`.

A new method is one file, one entry in `METHODS` and one plain version in `segmap_course.literal`:

1. Its file, `_<name>.py`, has the public function with its docstring. Its thresholds declare their
   units and bounds (`distance: Metres = 0.20`), `@checked` holds them to it, and it ends in
   `return run("<name>", map, reduce)`.
2. `reduce` gets `rows.segments`, `(k, 2, 2)`, which all have a length, and returns the outputs,
   `(m, 2, 2)`, and the output that each row went into, `(k,)`, -1 where it was dropped.
   `rows.row` tells which row of the map each is, for a method that needs what lies behind it.
3. An on-line method is a generator for `run_online`: it takes one scan of `rows.scans()` at a time,
   yields how many segments its map then holds, and returns the same two arrays.
4. Loops that are compiled stand beside it in the same file, marked `@compiled`. They look around in
   an `Index`.

The runner sorts by scan, measures the time, carries the parents back to the rows of the map and
checks the result on every call. What lies within a nanometre of a limit lies at it.
"""

from __future__ import annotations

from ..methods import Method
from ._basic import basic_offline, basic_online
from ._fusion import fusion, fusion_online
from ._hough import hough
from ._hybrid import hybrid
from ._hybrid_fusion import LiveReduction, hybrid_fusion
from ._mean_shift import Directions, common_directions, mean_shift
from ._runner import Methods, Reduction
from .least_cost import least_cost, reduce_to
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

__all__ = [
    "METHODS", "Directions", "LiveReduction", "Methods", "Reduction", "basic_offline",
    "basic_online", "common_directions", "fusion", "fusion_online", "fuzzy_clustering", "fuzzy_set",
    "hough", "hybrid", "hybrid_fusion", "least_cost", "mean_shift", "one_per_wall", "polyline",
    "reduce_to", "segment_similarity", "uncertain_parameters", "viewing_sector",
    "weighted_line_fitting",
]  # fmt: skip

#: Name of each method -> the method, with its place in A's table 2.16. A calls the class of Basic
#: "simple", after its conditions; like the class 2 -> 1 it makes one segment of two.
METHODS = Methods(
    basic_offline=Method(
        basic_offline,
        "A 4.1",
        "Gonzalez-Banos, Latombe 2002",
        merges="2 -> 1",
        keeps="end points",
        varies="distance",
    ),
    basic_online=Method(
        basic_online,
        "A 4.1",
        "Gonzalez-Banos, Latombe 2002",
        merges="2 -> 1",
        keeps="end points",
        varies="distance",
        online=True,
    ),
    hybrid=Method(
        hybrid,
        "A 4.2",
        "Kuo et al. 2009",
        merges="2 -> 1",
        keeps="rho, theta, length, end points, count",
        varies="distance",
        online=True,
    ),
    mean_shift=Method(
        mean_shift,
        "A 4.3",
        "Lakaemper 2009",
        merges="m -> n",
        keeps="end points",
        varies="sigma",
    ),
    fusion=Method(
        fusion,
        "A 4.4",
        "Amigoni, Vailati 2009",
        merges="m -> 1",
        keeps="end points",
        varies="tolerance",
    ),
    hybrid_fusion=Method(
        hybrid_fusion,
        "A 7",
        merges="m -> 1",
        keeps="rho, theta, length, end points, count",
        varies="tolerance",
        online=True,
    ),
    # m -> 1 in A's text, m -> n in its table, which is right: a chain becomes several pieces
    polyline=Method(
        polyline,
        "A 2.7.10",
        "Amigoni, Gasparini, Gini 2006",
        merges="m -> n",
        keeps="end points",
        varies="tolerance",
        online=True,
    ),
    segment_similarity=Method(
        segment_similarity,
        "A 2.7.7",
        "Elseberg, Creed, Lakaemper 2010",
        merges="2 -> 1",
        keeps="end points, weight",
        varies="distance",
    ),
    # 2 -> 1 in A's text and table; in effect a new segment takes in all its matches at once
    uncertain_parameters=Method(
        uncertain_parameters,
        "A 2.7.8",
        "Amigoni, Fontana, Garigiola 2006",
        merges="2 -> 1",
        keeps="rho, theta, both sigmas, end points",
        varies="distance",
        online=True,
        needs_points=True,
    ),
    weighted_line_fitting=Method(
        weighted_line_fitting,
        "A 2.7.3",
        "Pfister, Roumeliotis, Burdick 2003",
        merges="2 -> 1",
        keeps="line, covariance, end points",
        varies="chi2",
        online=True,
        needs_points=True,
    ),
    least_cost=Method(
        least_cost,
        "ours",
        merges="m -> 1",
        keeps="end points, sums, members",
        varies="penalty",
    ),
    one_per_wall=Method(
        one_per_wall,
        "ours",
        merges="m -> 1",
        keeps="end points, scans, members",
        varies="factor",
        needs_points=True,
    ),
    fusion_online=Method(
        fusion_online,
        "A 2.7.9",
        "Amigoni, Vailati 2009",
        merges="m -> 1",
        keeps="end points",
        varies="tolerance",
        online=True,
    ),
    # the table's row drops e, which the text has
    fuzzy_set=Method(
        fuzzy_set,
        "A 2.7.4",
        "Lopez-Sanchez, Esteva, Lopez de Mantaras, Sierra 1998",
        merges="2 -> 1",
        keeps="end points, e, e1, e2",
        varies="across",
        needs_points=True,
    ),
    # A reconstruction: A has the frame and no formula. The table says 2 -> 1, and a weight where
    # eq. 2.30 has the centre
    fuzzy_clustering=Method(
        fuzzy_clustering,
        "A 2.7.6",
        "Ip, Rad, Chow, Wong 2002 (reconstruction)",
        merges="m -> 1",
        keeps="direction, mixing, end points, centre",
        varies="distance",
        online=True,
        needs_points=True,
    ),
    viewing_sector=Method(
        viewing_sector,
        "A 2.7.5",
        "Gonzalez, Ollero, Reina 1994",
        merges="2 -> 1",
        keeps="end points, running sums",
        varies="distance",
        online=True,
        needs_points=True,
        needs_sensors=True,
    ),
)
