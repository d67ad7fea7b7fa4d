"""Where a scan lies on a map: scores, the two greedy matchers of B (4.3), filters; and routes."""

from ._field import DistanceField
from ._kalman import KalmanState, localize_ekf
from ._live_map import LiveMap, Step
from ._localize import Belief, localize
from ._mapping import MATCHERS, SCORES, map_scans
from ._matchers import Score, field_score, hill_climb, sample_and_rank
from ._merge import merge
from ._particles import Particles, particle_mapping, particle_paths
from ._route import NoRoute, route
from ._scores import descent_score, distance_score, nearest_score, occupancy_score
from ._search import Places, Uncertainty, search
from ._weights import effective_number, systematic

__all__ = [
    "MATCHERS", "SCORES", "Belief", "DistanceField", "KalmanState", "LiveMap", "NoRoute",
    "Particles", "Places", "Score", "Step", "Uncertainty", "descent_score", "distance_score",
    "effective_number", "field_score", "hill_climb", "localize", "localize_ekf", "map_scans",
    "merge", "nearest_score", "occupancy_score", "particle_mapping", "particle_paths", "route",
    "sample_and_rank", "search", "systematic",
]  # fmt: skip
