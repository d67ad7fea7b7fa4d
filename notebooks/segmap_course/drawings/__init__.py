"""What the chapters draw, on the axes `ax` or on new ones; what is drawn on is returned."""

from ._alignments import (
    draw_backbone,
    draw_basin,
    draw_frames,
    draw_icp_step,
    draw_laid,
    draw_scans,
    draw_uncertainty,
)
from ._charts import label_axes, mark_places, set_ticks, write_names
from ._clinic import draw_corner, wardrobe
from ._icp import (
    draw_scan_poses,
    draw_shifts,
    draw_wall_normals,
    draw_weights,
    icp_frames,
)
from ._known_lines import draw_contradiction, draw_known_line, draw_seen_wall
from ._mean_shift import climb_frames, draw_hill, draw_phases
from ._plans import draw_labels
from ._pose_graph import draw_edges, draw_method_errors, loop_frames
from ._quadtrees import (
    draw_cells,
    draw_cells_of_a_wall,
    draw_classes,
    draw_climb,
    draw_counts,
    draw_ends,
    draw_ends_on_map,
    draw_equal_squares,
    draw_frontiers,
    draw_landscape,
    draw_landscapes,
    draw_leaf_row,
    draw_leaves,
    draw_profile,
    draw_ray,
    draw_sizes_of_halls,
)
from ._reductions import (
    draw_cases,
    draw_closer,
    draw_clusters,
    draw_costs,
    draw_leaning,
    draw_live,
    draw_moved,
    draw_pieces,
    draw_sweep,
    merge_frames,
    say_stretch,
)
from ._segments import (
    draw_distance_curves,
    draw_distance_terms,
    draw_fits,
    draw_marked,
    draw_match,
    draw_match_value,
    draw_merge,
    draw_missed,
    draw_normals,
    draw_runs,
    draw_sector,
    draw_splits,
    draw_strip,
)

__all__ = [
    "climb_frames", "draw_backbone", "draw_basin", "draw_cases", "draw_cells",
    "draw_cells_of_a_wall", "draw_classes", "draw_climb", "draw_closer", "draw_clusters",
    "draw_contradiction", "draw_corner", "draw_costs", "draw_counts", "draw_distance_curves",
    "draw_distance_terms", "draw_edges", "draw_ends", "draw_ends_on_map", "draw_equal_squares",
    "draw_fits", "draw_frames", "draw_frontiers", "draw_hill", "draw_icp_step", "draw_known_line",
    "draw_labels", "draw_laid", "draw_landscape", "draw_landscapes", "draw_leaf_row",
    "draw_leaning", "draw_leaves", "draw_live", "draw_marked", "draw_match", "draw_match_value",
    "draw_merge", "draw_method_errors", "draw_missed", "draw_moved", "draw_normals", "draw_phases",
    "draw_pieces", "draw_profile", "draw_ray", "draw_runs", "draw_scan_poses", "draw_scans",
    "draw_sector", "draw_seen_wall", "draw_shifts", "draw_sizes_of_halls", "draw_splits",
    "draw_strip", "draw_sweep", "draw_uncertainty", "draw_wall_normals", "draw_weights",
    "icp_frames", "label_axes", "loop_frames", "mark_places", "merge_frames", "say_stretch",
    "set_ticks", "wardrobe", "write_names",
]  # fmt: skip
