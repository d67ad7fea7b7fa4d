"""Exercises: a student's function beside the library's; each known mistake has a hint."""

from ._alignment import (
    check_least_translation,
    check_match_value,
    check_move_onto_walls,
)
from ._exercise import (
    Check,
    Exercise,
)
from ._lines import (
    check_axial_mean,
    check_farthest_point,
    check_fit_line,
)
from ._maps import (
    check_best_run,
    check_mean_wall_error,
    check_quality,
    check_reduction_at,
    check_reduction_rate,
)
from ._notice import (
    Watch,
    plain,
)
from ._poses import (
    check_carried,
    check_climb_step,
    check_edge_error,
    check_scan_score,
)
from ._quadtree import (
    check_cell_of,
    check_grown,
    check_occupancy,
    check_pixel,
    check_ray_cells,
)
from ._reduction import (
    check_hough,
    check_matches,
    check_merged,
)
from ._scans import (
    check_beam_angles,
    check_cast_ray,
    check_compose,
    check_heading_between,
)
from ._sensor import (
    check_distances,
    check_unwrapped,
)
from ._strips import (
    check_best_shift,
    check_inside_strip,
    check_mean_shift_step,
)
from ._surveyed import (
    check_invented_metres,
    check_memberships,
    check_pose_covariance,
    check_verdict,
)
