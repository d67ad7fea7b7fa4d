"""The names of the course, as `import segmap_course as course` gives them."""

from __future__ import annotations

from . import drawings, figures, panels
from ._clinic import Answers, Measured, clearance, clearance_at, clinic_walls, measure_clinic
from ._conclusions import conclusions, density, filter_change
from ._explore import Explored, drive_to_frontiers, explore, floor_of
from ._found_lines import (
    LINE_FINDERS,
    LINE_SENSORS,
    View,
    near_metres,
    office_views,
    precision_and_recall,
    visible_walls,
)
from ._judged import four_ways
from ._known_buildings import Known, equal_offices, known_building
from ._landscapes import Landscape, heading_profile, landscape, peaks, profile_peaks
from ._matcher_trials import (
    Trial,
    corridor_walk,
    load_columns,
    load_trials,
    room_walk,
    room_walls,
    try_pair,
)
from ._storage import (
    Representation,
    compare_with_walls,
    occupied_centres,
    represent,
    sample_points,
    wall_errors,
)
from ._thesis import (
    THESIS_FILTERS,
    THESIS_GRIDS,
    thesis_grid,
    thesis_results,
    within_thesis,
)
from ._unknown_building import Taped, Unknown, unknown_building
from .drawings import *
from .exercises import Check, Exercise
from .exercises.alignment import (
    check_flatness,
    check_least_translation,
    check_match_value,
    check_move_onto_walls,
)
from .exercises.basic import check_matches, check_mean_by_length, check_pair_origin
from .exercises.lines import (
    check_axial_mean,
    check_ransac_trials,
    check_segments_all_round,
    check_split,
)
from .exercises.maps import (
    check_best_run,
    check_front,
    check_mean_wall_error,
    check_missed_metres,
    check_quality,
    check_reduction_rate,
)
from .exercises.matching import (
    check_capped_score,
    check_climb_diagonally,
    check_nees,
    check_resampled,
    check_weighed,
)
from .exercises.mechanisms import (
    check_axes_of,
    check_building_axis,
    check_far_ends,
    check_places_between,
    check_pose_cost,
    check_scan_noise,
)
from .exercises.open import Challenge, Decision, OwnLog, Prediction
from .exercises.open.alignment import (
    break_icp,
    predict_sparse_icp,
)
from .exercises.open.decision import decide_map
from .exercises.open.judgement import (
    decide_way,
    predict_crowd,
    predict_survivors,
)
from .exercises.open.my_mapper import check_my_mapper
from .exercises.open.own_log import check_own_log
from .exercises.open.quadtree import break_cells
from .exercises.open.scans import (
    break_reader,
    predict_beams_on_wall,
    predict_drift,
)
from .exercises.poses import (
    check_carried,
    check_carried_beam,
    check_compose,
    check_edge_error,
)
from .exercises.quadtree import (
    check_cell_of,
    check_crossed_leaves,
    check_frontier_cells,
    check_pixel,
)
from .exercises.sensor import (
    check_beam_angles,
    check_cast_ray,
    check_kept_distances,
)
from .exercises.strips import check_chain, check_mean_shift_step, robot_on_the_left
from .exercises.surveyed import (
    check_cost_of_faces,
    check_memberships,
    check_steady_fit,
    check_surely_kept,
)
from .figures import *
from .panels import *

__all__ = [
    "EXERCISES", "LINE_FINDERS", "LINE_SENSORS", "OPEN_EXERCISES", "THESIS_FILTERS",
    "THESIS_GRIDS", "Answers", "Challenge", "Check", "Decision", "Exercise", "Explored", "Known",
    "Landscape", "Measured", "OwnLog", "Prediction", "Representation", "Taped", "Trial", "Unknown",
    "View", "break_cells", "break_icp",
    "break_reader", "check_axes_of", "check_axial_mean",
    "check_beam_angles", "check_best_run", "check_building_axis", "check_capped_score",
    "check_carried", "check_carried_beam", "check_cast_ray", "check_cell_of", "check_chain",
    "check_climb_diagonally", "check_compose", "check_cost_of_faces", "check_crossed_leaves",
    "check_edge_error", "check_far_ends", "check_flatness", "check_front",
    "check_frontier_cells", "check_kept_distances", "check_least_translation",
    "check_match_value", "check_matches",
    "check_mean_by_length", "check_mean_shift_step", "check_mean_wall_error", "check_memberships",
    "check_missed_metres", "check_move_onto_walls", "check_my_mapper", "check_nees",
    "check_own_log", "check_pair_origin", "check_pixel", "check_places_between", "check_pose_cost",
    "check_quality", "check_ransac_trials", "check_reduction_rate", "check_resampled",
    "check_scan_noise", "check_segments_all_round", "check_split", "check_steady_fit",
    "check_surely_kept", "check_weighed", "clearance", "clearance_at",
    "clinic_walls", "compare_with_walls", "conclusions", "corridor_walk",
    "decide_map", "decide_way", "density", "drawings", "drive_to_frontiers", "equal_offices",
    "explore", "figures", "filter_change", "floor_of", "heading_profile", "known_building",
    "landscape", "load_columns", "load_trials", "measure_clinic", "near_metres", "occupied_centres",
    "office_views", "panels", "peaks", "precision_and_recall", "predict_beams_on_wall",
    "predict_crowd", "predict_drift",
    "predict_sparse_icp", "predict_survivors", "profile_peaks", "represent",
    "robot_on_the_left", "room_walk", "room_walls", "sample_points", "thesis_grid",
    "thesis_results", "try_pair", "unknown_building", "visible_walls", "wall_errors",
    "within_thesis",
]  # fmt: skip
__all__ += drawings.__all__
__all__ += figures.__all__
__all__ += panels.__all__

#: Name of each exercise -> its check.
EXERCISES: dict[str, Exercise] = {
    found.name: found for found in list(globals().values()) if isinstance(found, Exercise)
}

#: Name of each open exercise -> its judge: predict and test, break it, decide, a log of one's own.
OPEN_EXERCISES: dict[str, Prediction | Challenge | Decision | OwnLog] = {
    found.name: found
    for found in list(globals().values())
    if isinstance(found, Prediction | Challenge | Decision | OwnLog)
}
