"""The seven reduction methods that A surveys (2.7), and the steps of them that chapters show."""

from ._fuzzy_clustering import fuzzy_clustering
from ._fuzzy_set import fuzzy_set
from ._polyline import farthest_ends, polyline, polyline_through
from ._prototypes import Prototype, clustered, memberships
from ._segment_similarity import segment_similarity
from ._uncertain_parameters import (
    UncertainWall,
    fused,
    looks_at_it,
    uncertain,
    uncertain_parameters,
)
from ._viewing_sector import kept_pieces, minus, viewing_sector
from ._views import views
from ._weighted_line_fitting import Line, about, add_pose, compare, fit, weighted_line_fitting

__all__ = [
    "Line", "Prototype", "UncertainWall", "about", "add_pose", "clustered", "compare",
    "farthest_ends", "fit", "fused", "fuzzy_clustering", "fuzzy_set", "kept_pieces", "looks_at_it",
    "memberships", "minus", "polyline", "polyline_through", "segment_similarity", "uncertain",
    "uncertain_parameters", "viewing_sector", "views", "weighted_line_fitting",
]  # fmt: skip
