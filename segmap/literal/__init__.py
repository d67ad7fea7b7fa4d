"""Every method as the theses print it: plain loops over plain numbers, slow and readable.

They are the oracle of the tests, the code that chapters show, and the yardstick of the benchmarks.
Nothing here calls the fast version of what it does.

A reduction takes segments, for an on-line method the scan of each, and its thresholds by the names
of the fast version: `fusion(segments, tolerance=0.04)`, `hybrid(segments, scans, distance=0.2)`. It
returns the outputs and, for each input, the number of the output that it went into, -1 for none.
"""

from .basic import basic_offline, basic_online
from .extraction import extract_clusters, extract_polylines, fit_algebraic, fit_total
from .fusion import best_strip, chain, fusion
from .hybrid import hough, hybrid, hybrid_fusion
from .lines import axial_difference, line_angle, point_to_segment, segment_length
from .mean_shift import mean_shift
from .metrics import quality, segment_distance

__all__ = [
    "axial_difference",
    "basic_offline",
    "basic_online",
    "best_strip",
    "chain",
    "extract_clusters",
    "extract_polylines",
    "fit_algebraic",
    "fit_total",
    "fusion",
    "hough",
    "hybrid",
    "hybrid_fusion",
    "line_angle",
    "mean_shift",
    "point_to_segment",
    "quality",
    "segment_distance",
    "segment_length",
]
