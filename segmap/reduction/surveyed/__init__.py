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
from ._viewing_sector import kept_pieces, viewing_sector
from ._views import SAYS, cross, mix, share, views
from ._weighted_line_fitting import (
    Line,
    about,
    add_pose,
    compare,
    fit,
    solved,
    variance,
    weighted_line,
    weighted_line_fitting,
)

__all__ = [
    "SAYS", "Line", "Prototype", "UncertainWall", "about", "add_pose", "clustered", "compare",
    "cross", "farthest_ends", "fit", "fused", "fuzzy_clustering", "fuzzy_set", "kept_pieces",
    "looks_at_it", "memberships", "mix", "polyline", "polyline_through", "segment_similarity",
    "share", "solved", "uncertain", "uncertain_parameters", "variance", "viewing_sector", "views",
    "weighted_line", "weighted_line_fitting",
]  # fmt: skip
