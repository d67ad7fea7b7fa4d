"""Reduction: one segment for each wall instead of one for each time that it was seen.

Every method has one signature, `method(map, *, thresholds) -> Reduction`, and stands in `METHODS`.

A new method is one file and one entry in `METHODS`. Plain loops are enough where those that look at
each pair are compiled, as in `surveyed`; where that is ten times too slow for 3 600 segments, the
fast version has a plain one beside it in `segmap_course.literal`:

1. Its file, `_<name>.py`, has the public function with its docstring. Its thresholds declare their
   units and bounds (`distance: Metres = 0.20`), `@checked` holds them to it, and it ends in
   `return run_offline("<name>", map, reduce)`.
2. `reduce` gets `rows.segments`, `(k, 2, 2)`, which all have a length, and returns the outputs,
   `(m, 2, 2)`, and the output that each row went into, `(k,)`, -1 where it was dropped.
   `rows.source_row` tells which row of the map each is, for a method that needs what lies behind
   it.
3. An on-line method is a generator for `run_online`: it takes one scan of `rows.scans()` at a time,
   yields how many segments its map then holds, and returns the same two arrays.
4. Loops that are compiled stand beside it in the same file, marked `@compiled`. They look around in
   an `Index`.

The runner sorts by scan, measures the time, carries the parents back to the rows of the map and
checks the result on every call. What lies within a nanometre of a limit lies at it.
"""

from __future__ import annotations

from ._basic import basic_offline, basic_online
from ._fusion import fusion, fusion_online
from ._hough import hough
from ._hybrid import hybrid
from ._hybrid_fusion import LiveReduction, hybrid_fusion
from ._mean_shift import Directions, common_directions, mean_shift
from ._methods import METHODS, USUAL_METHOD, USUAL_THRESHOLDS
from ._runner import Methods, Reduction
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

__all__ = [
    "METHODS", "USUAL_METHOD", "USUAL_THRESHOLDS", "Directions", "LiveReduction", "Methods",
    "Reduction", "basic_offline", "basic_online", "common_directions", "fusion", "fusion_online",
    "fuzzy_clustering", "fuzzy_set", "hough", "hybrid", "hybrid_fusion", "least_cost", "mean_shift",
    "one_per_wall", "polyline", "segment_similarity", "uncertain_parameters",
    "viewing_sector", "weighted_line_fitting",
]  # fmt: skip
