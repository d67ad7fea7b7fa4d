"""The seven reduction methods that A surveys (2.7)."""

from ._fuzzy_clustering import fuzzy_clustering
from ._fuzzy_set import fuzzy_set
from ._polyline import polyline
from ._segment_similarity import segment_similarity
from ._uncertain_parameters import uncertain_parameters
from ._weighted_line_fitting import weighted_line_fitting
from .viewing_sector import viewing_sector

__all__ = [
    "fuzzy_clustering", "fuzzy_set", "polyline", "segment_similarity", "uncertain_parameters",
    "viewing_sector", "weighted_line_fitting",
]  # fmt: skip
