"""Help for tests and for students: assertions, a zoo of inputs, checks of exercises.

`check_<name>(my_<name>)` compares a function with the library's and answers with a hint.
"""

from ._angle_exercises import check_match_value, match_value
from ._assertions import assert_poses_equal, assert_segments_equal
from ._backbone_exercises import check_least_translation
from ._basic_exercises import check_matches, check_merged, matches, merged
from ._comparison_exercises import check_reduction_at
from ._exercise import Case, Check, Exercise, Mistake
from ._graph_exercises import check_edge_error, edge_error
from ._hough_exercises import check_hough
from ._laser_exercises import check_distances, check_unwrapped, unwrapped
from ._line_exercises import check_axial_mean, check_farthest_point, check_fit_line
from ._map_exercises import (
    best_shift,
    check_best_shift,
    check_inside_strip,
    check_quality,
    check_reduction_rate,
)
from ._matching_exercises import (
    check_climb_step,
    check_mean_wall_error,
    check_scan_score,
    climb_step,
    scan_score,
)
from ._mean_shift_exercises import check_mean_shift_step, mean_shift_step
from ._point_exercises import (
    check_heading_between,
    check_move_onto_walls,
    heading_between,
    move_onto_walls,
)
from ._quadtree_exercises import (
    check_cell_of,
    check_grown,
    check_occupancy,
    check_pixel,
    check_ray_cells,
    ray_cells,
)
from ._scan_exercises import check_beam_angles, check_cast_ray, check_compose
from ._zoo import point_zoo, scan_zoo, segment_zoo

#: Name of each exercise -> its check.
EXERCISES: dict[str, Exercise] = {
    exercise.name: exercise
    for exercise in (
        check_compose,
        check_beam_angles,
        check_cast_ray,
        check_fit_line,
        check_farthest_point,
        check_axial_mean,
        check_reduction_rate,
        check_quality,
        check_heading_between,
        check_match_value,
        check_least_translation,
        check_move_onto_walls,
        check_edge_error,
        check_hough,
        check_matches,
        check_merged,
        check_mean_shift_step,
        check_inside_strip,
        check_best_shift,
        check_reduction_at,
        check_cell_of,
        check_grown,
        check_occupancy,
        check_ray_cells,
        check_scan_score,
        check_climb_step,
        check_pixel,
        check_mean_wall_error,
        check_distances,
        check_unwrapped,
    )
}

__all__ = [
    "EXERCISES",
    "Case",
    "Check",
    "Exercise",
    "Mistake",
    "assert_poses_equal",
    "assert_segments_equal",
    "best_shift",
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
    "climb_step",
    "edge_error",
    "heading_between",
    "match_value",
    "matches",
    "mean_shift_step",
    "merged",
    "move_onto_walls",
    "point_zoo",
    "ray_cells",
    "scan_score",
    "scan_zoo",
    "segment_zoo",
    "unwrapped",
]
