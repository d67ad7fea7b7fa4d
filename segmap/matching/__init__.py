"""Where a scan lies on a quadtree map: scores, and the two greedy matchers of B (4.3)."""

from ._field import DistanceField
from ._landscape import Landscape, heading_profile, landscape, peaks, profile_peaks
from ._mapping import Step, map_scans
from ._matchers import Score, field_score, hill_climb, sample_and_rank
from ._scores import descent_score, distance_score, nearest_score, occupancy_score
from ._trials import (
    MATCHERS,
    SCORES,
    Trial,
    load_columns,
    load_trials,
    room_walk,
    room_walls,
    trial_table,
    try_pair,
    write_trials,
)

__all__ = [
    "MATCHERS",
    "SCORES",
    "DistanceField",
    "Landscape",
    "Score",
    "Step",
    "Trial",
    "descent_score",
    "distance_score",
    "field_score",
    "heading_profile",
    "hill_climb",
    "landscape",
    "load_columns",
    "load_trials",
    "map_scans",
    "nearest_score",
    "occupancy_score",
    "peaks",
    "profile_peaks",
    "room_walk",
    "room_walls",
    "sample_and_rank",
    "trial_table",
    "try_pair",
    "write_trials",
]
