"""What only the chapters need: exercises, lesson panels and drawings, and the theses' results.

`check_<name>(my_<name>)` compares a function with the library's and answers with a hint.
"""

from __future__ import annotations

from ._angles_panel import AnglePanel
from ._backbone_panel import BackbonePanel
from ._basic_panel import BasicPanel
from ._classes_panel import ClassesPanel
from ._clusters_panel import ClusterPanel
from ._distance_panel import DistancePanel
from ._draw_backbones import draw_backbone
from ._draw_buildings import draw_buildings, draw_filter, draw_initials, draw_threshold, draw_times
from ._draw_cells import draw_cells, draw_classes, draw_ray
from ._draw_distances import draw_distance_terms
from ._draw_frames import draw_frames
from ._draw_matches import draw_basin, draw_candidate, draw_step, draw_uncertainty
from ._draw_reduction_steps import draw_centres, draw_merge, draw_normals, draw_strip
from ._draw_reductions import draw_cases, draw_growth, draw_marked, draw_trade
from ._exercise import Check, Exercise
from ._exercises_lines import (
    check_axial_mean,
    check_farthest_point,
    check_fit_line,
    check_least_translation,
    check_match_value,
)
from ._exercises_maps import (
    check_mean_wall_error,
    check_quality,
    check_reduction_at,
    check_reduction_rate,
)
from ._exercises_poses import (
    check_climb_step,
    check_edge_error,
    check_move_onto_walls,
    check_scan_score,
    move_onto_walls,
)
from ._exercises_quadtree import (
    check_cell_of,
    check_grown,
    check_occupancy,
    check_pixel,
    check_ray_cells,
)
from ._exercises_reduction import check_hough, check_matches, check_merged
from ._exercises_scans import (
    check_beam_angles,
    check_cast_ray,
    check_compose,
    check_distances,
    check_heading_between,
    check_unwrapped,
)
from ._exercises_strips import check_best_shift, check_inside_strip, check_mean_shift_step
from ._fusion_panel import FusionPanel
from ._ground_truth_panel import GroundTruthPanel
from ._hybrid_panel import HybridPanel
from ._icp_panel import IcpPanel
from ._landscape_drawings import draw_climb, draw_field, draw_landscape, draw_profile, draw_trials
from ._landscape_panel import LandscapePanel
from ._landscapes import Landscape, heading_profile, landscape, peaks, profile_peaks
from ._matcher_panel import MatcherPanel
from ._mean_shift_panel import MeanShiftPanel
from ._polylines_panel import PolylinePanel
from ._pose_graph_panel import PoseGraphPanel
from ._ray_variants import insert_variant
from ._rays_panel import RayPanel
from ._room_panel import RoomPanel
from ._storage_panel import StoragePanel
from ._trials import (
    Trial,
    load_columns,
    load_trials,
    room_walk,
    room_walls,
    trial_table,
    try_pair,
    write_trials,
)

#: Name of each exercise -> its check.
EXERCISES: dict[str, Exercise] = {
    found.name: found for found in list(globals().values()) if isinstance(found, Exercise)
}

__all__ = [
    "EXERCISES",
    "AnglePanel",
    "BackbonePanel",
    "BasicPanel",
    "Check",
    "ClassesPanel",
    "ClusterPanel",
    "DistancePanel",
    "Exercise",
    "FusionPanel",
    "GroundTruthPanel",
    "HybridPanel",
    "IcpPanel",
    "Landscape",
    "LandscapePanel",
    "MatcherPanel",
    "MeanShiftPanel",
    "PolylinePanel",
    "PoseGraphPanel",
    "RayPanel",
    "RoomPanel",
    "StoragePanel",
    "Trial",
    "check_axial_mean",
    "check_beam_angles",
    "check_best_shift",
    "check_cast_ray",
    "check_cell_of",
    "check_climb_step",
    "check_compose",
    "check_distances",
    "check_edge_error",
    "check_farthest_point",
    "check_fit_line",
    "check_grown",
    "check_heading_between",
    "check_hough",
    "check_inside_strip",
    "check_least_translation",
    "check_match_value",
    "check_matches",
    "check_mean_shift_step",
    "check_mean_wall_error",
    "check_merged",
    "check_move_onto_walls",
    "check_occupancy",
    "check_pixel",
    "check_quality",
    "check_ray_cells",
    "check_reduction_at",
    "check_reduction_rate",
    "check_scan_score",
    "check_unwrapped",
    "draw_backbone",
    "draw_basin",
    "draw_buildings",
    "draw_candidate",
    "draw_cases",
    "draw_cells",
    "draw_centres",
    "draw_classes",
    "draw_climb",
    "draw_distance_terms",
    "draw_field",
    "draw_filter",
    "draw_frames",
    "draw_growth",
    "draw_initials",
    "draw_landscape",
    "draw_marked",
    "draw_merge",
    "draw_normals",
    "draw_profile",
    "draw_ray",
    "draw_step",
    "draw_strip",
    "draw_threshold",
    "draw_times",
    "draw_trade",
    "draw_trials",
    "draw_uncertainty",
    "heading_profile",
    "insert_variant",
    "landscape",
    "load_columns",
    "load_trials",
    "move_onto_walls",
    "peaks",
    "profile_peaks",
    "room_walk",
    "room_walls",
    "trial_table",
    "try_pair",
    "write_trials",
]
