"""What only the chapters need: exercises, lesson panels and drawings, and the theses' results.

`check_<name>(my_<name>)` compares a function with the library's and answers with a hint.
"""

from __future__ import annotations

from ._conclusions import conclusions, density, filter_change
from ._draw_alignments import (
    draw_backbone,
    draw_basin,
    draw_candidate,
    draw_frames,
    draw_icp_step,
    draw_uncertainty,
)
from ._draw_buildings import draw_buildings, draw_threshold
from ._draw_quadtrees import (
    draw_cells,
    draw_classes,
    draw_climb,
    draw_field,
    draw_landscape,
    draw_profile,
    draw_ray,
    draw_trials,
)
from ._draw_reductions import draw_cases, draw_growth, draw_trade_off
from ._draw_segments import (
    draw_centres,
    draw_distance_terms,
    draw_marked,
    draw_merge,
    draw_normals,
    draw_strip,
)
from ._exercise import Check, Exercise
from ._exercises_alignment import (
    check_least_translation,
    check_match_value,
    check_move_onto_walls,
)
from ._exercises_lines import check_axial_mean, check_farthest_point, check_fit_line
from ._exercises_maps import (
    check_best_run,
    check_mean_wall_error,
    check_quality,
    check_reduction_at,
    check_reduction_rate,
)
from ._exercises_poses import (
    check_carried,
    check_climb_step,
    check_edge_error,
    check_scan_score,
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
    check_heading_between,
)
from ._exercises_sensor import check_distances, check_unwrapped
from ._exercises_strips import check_best_shift, check_inside_strip, check_mean_shift_step
from ._exercises_surveyed import (
    check_invented_metres,
    check_memberships,
    check_pose_covariance,
    check_verdict,
)
from ._landscapes import Landscape, heading_profile, landscape, peaks, profile_peaks
from ._open_alignment import (
    break_icp,
    break_loss,
    break_sum,
    predict_scan_time,
    predict_sparse_icp,
    predict_turned_quality,
)
from ._open_exercises import Challenge, Prediction, break_quality, predict_beams_on_wall
from ._open_log import OwnLog, check_own_log
from ._open_quadtree import break_cells, break_matching, predict_coarse_leaves
from ._open_reduction import (
    break_basic_order,
    break_fusion,
    break_viewing_sector,
    predict_fusion_left,
    predict_fusion_twice,
)
from ._open_scans import break_line, break_reader, predict_drift, predict_pieces
from ._panels_alignment import AnglePanel, BackbonePanel, GroundTruthPanel
from ._panels_graphs import IcpPanel, PoseGraphPanel
from ._panels_matching import LandscapePanel, MatcherPanel
from ._panels_quadtree import ClassesPanel, RayPanel, insert_variant
from ._panels_reduction import BasicPanel, FusionPanel, HybridPanel, MeanShiftPanel
from ._panels_scans import ClusterPanel, DistancePanel, PolylinePanel, RoomPanel
from ._panels_surveyed import ChainPanel, LeastCostPanel, SectorPanel, WeightedPanel
from ._storage import (
    Representation,
    StoragePanel,
    compare_with_walls,
    occupied_centres,
    represent,
    sample_points,
    wall_errors,
)
from ._thesis import (
    PUBLISHED,
    THESIS_FILTERS,
    THESIS_GRIDS,
    alignment_table,
    thesis_grid,
    thesis_results,
)
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

#: Name of each open exercise -> what judges it: predict and test, break it, a log of one's own.
OPEN_EXERCISES: dict[str, Prediction | Challenge | OwnLog] = {
    found.name: found
    for found in list(globals().values())
    if isinstance(found, Prediction | Challenge | OwnLog)
}

__all__ = [
    "EXERCISES",
    "OPEN_EXERCISES",
    "PUBLISHED",
    "THESIS_FILTERS",
    "THESIS_GRIDS",
    "AnglePanel",
    "BackbonePanel",
    "BasicPanel",
    "ChainPanel",
    "Challenge",
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
    "LeastCostPanel",
    "MatcherPanel",
    "MeanShiftPanel",
    "OwnLog",
    "PolylinePanel",
    "PoseGraphPanel",
    "Prediction",
    "RayPanel",
    "Representation",
    "RoomPanel",
    "SectorPanel",
    "StoragePanel",
    "Trial",
    "WeightedPanel",
    "alignment_table",
    "break_basic_order",
    "break_cells",
    "break_fusion",
    "break_icp",
    "break_line",
    "break_loss",
    "break_matching",
    "break_quality",
    "break_reader",
    "break_sum",
    "break_viewing_sector",
    "check_axial_mean",
    "check_beam_angles",
    "check_best_run",
    "check_best_shift",
    "check_carried",
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
    "check_invented_metres",
    "check_least_translation",
    "check_match_value",
    "check_matches",
    "check_mean_shift_step",
    "check_mean_wall_error",
    "check_memberships",
    "check_merged",
    "check_move_onto_walls",
    "check_occupancy",
    "check_own_log",
    "check_pixel",
    "check_pose_covariance",
    "check_quality",
    "check_ray_cells",
    "check_reduction_at",
    "check_reduction_rate",
    "check_scan_score",
    "check_unwrapped",
    "check_verdict",
    "compare_with_walls",
    "conclusions",
    "density",
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
    "draw_frames",
    "draw_growth",
    "draw_icp_step",
    "draw_landscape",
    "draw_marked",
    "draw_merge",
    "draw_normals",
    "draw_profile",
    "draw_ray",
    "draw_strip",
    "draw_threshold",
    "draw_trade_off",
    "draw_trials",
    "draw_uncertainty",
    "filter_change",
    "heading_profile",
    "insert_variant",
    "landscape",
    "load_columns",
    "load_trials",
    "occupied_centres",
    "peaks",
    "predict_beams_on_wall",
    "predict_coarse_leaves",
    "predict_drift",
    "predict_fusion_left",
    "predict_fusion_twice",
    "predict_pieces",
    "predict_scan_time",
    "predict_sparse_icp",
    "predict_turned_quality",
    "profile_peaks",
    "represent",
    "room_walk",
    "room_walls",
    "sample_points",
    "thesis_grid",
    "thesis_results",
    "trial_table",
    "try_pair",
    "wall_errors",
    "write_trials",
]
