"""What only the chapters need: exercises, lesson panels and drawings, and the theses' results.

`check_<name>(my_<name>)` compares a function with the library's and answers with a hint.
"""

from __future__ import annotations

from ._conclusions import conclusions, density, filter_change
from ._landscapes import Landscape, heading_profile, landscape, peaks, profile_peaks
from ._storage import (
    Representation,
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
from .drawings import (
    draw_backbone,
    draw_basin,
    draw_buildings,
    draw_candidate,
    draw_cases,
    draw_cells,
    draw_centres,
    draw_classes,
    draw_climb,
    draw_distance_terms,
    draw_field,
    draw_frames,
    draw_growth,
    draw_icp_step,
    draw_landscape,
    draw_marked,
    draw_merge,
    draw_normals,
    draw_profile,
    draw_ray,
    draw_strip,
    draw_threshold,
    draw_trade_off,
    draw_trials,
    draw_uncertainty,
)
from .exercises import (
    Check,
    Exercise,
    check_axial_mean,
    check_beam_angles,
    check_best_run,
    check_best_shift,
    check_carried,
    check_cast_ray,
    check_cell_of,
    check_climb_step,
    check_compose,
    check_distances,
    check_edge_error,
    check_farthest_point,
    check_fit_line,
    check_grown,
    check_heading_between,
    check_hough,
    check_inside_strip,
    check_invented_metres,
    check_least_translation,
    check_match_value,
    check_matches,
    check_mean_shift_step,
    check_mean_wall_error,
    check_memberships,
    check_merged,
    check_move_onto_walls,
    check_occupancy,
    check_pixel,
    check_pose_covariance,
    check_quality,
    check_ray_cells,
    check_reduction_at,
    check_reduction_rate,
    check_scan_score,
    check_unwrapped,
    check_verdict,
)
from .exercises.open import (
    Challenge,
    OwnLog,
    Prediction,
    break_basic_order,
    break_cells,
    break_fusion,
    break_icp,
    break_line,
    break_loss,
    break_matching,
    break_quality,
    break_reader,
    break_sum,
    break_viewing_sector,
    check_own_log,
    predict_beams_on_wall,
    predict_coarse_leaves,
    predict_drift,
    predict_fusion_left,
    predict_fusion_twice,
    predict_pieces,
    predict_scan_time,
    predict_sparse_icp,
    predict_turned_quality,
)
from .panels import (
    AnglePanel,
    BackbonePanel,
    BasicPanel,
    ChainPanel,
    ClassesPanel,
    ClusterPanel,
    DistancePanel,
    FusionPanel,
    GroundTruthPanel,
    HybridPanel,
    IcpPanel,
    LandscapePanel,
    LeastCostPanel,
    MatcherPanel,
    MeanShiftPanel,
    PolylinePanel,
    PoseGraphPanel,
    RayPanel,
    RoomPanel,
    SectorPanel,
    StoragePanel,
    WeightedPanel,
    insert_variant,
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
