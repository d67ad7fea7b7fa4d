"""Pictures: `draw_*(..., ax=None) -> ax`, maps in metres, with equal scales.

Without `ax` a new pyplot figure is made, small enough for a notebook. Each colour means the same in
every picture, and the colour-blind can tell them apart (Okabe and Ito, 2008).
"""

from ._alignments import (
    draw_alignment,
    draw_basin,
    draw_candidate,
    draw_step,
    draw_uncertainty,
)
from ._backbones import draw_backbone
from ._buildings import (
    draw_buildings,
    draw_filter,
    draw_initials,
    draw_threshold,
    draw_times,
)
from ._distances import draw_distance_terms
from ._experiments import METHOD_STYLES, draw_curves, draw_online
from ._lessons_scans import draw_frames, draw_maps, draw_poses
from ._pictures import figure_png, thumbnail
from ._quadtrees import (
    draw_cells,
    draw_classes,
    draw_field,
    draw_quadtree,
    draw_quadtrees,
    draw_ray,
)
from ._reduction_steps import draw_centres, draw_merge, draw_normals, draw_strip
from ._reductions import draw_beside, draw_cases, draw_growth, draw_marked, draw_trade
from ._scans import draw_log, draw_path, draw_points, draw_scan
from ._segments import draw_before_after, draw_provenance, draw_segments
from ._style import DPI, ERROR, ERRORS, GROUPS, MAP, RAW, RESULT, SIZE, TRUTH, group_colors
from ._ways import draw_drift, draw_logs

__all__ = [
    "DPI",
    "ERROR",
    "ERRORS",
    "GROUPS",
    "MAP",
    "METHOD_STYLES",
    "RAW",
    "RESULT",
    "SIZE",
    "TRUTH",
    "draw_alignment",
    "draw_backbone",
    "draw_basin",
    "draw_before_after",
    "draw_beside",
    "draw_buildings",
    "draw_candidate",
    "draw_cases",
    "draw_cells",
    "draw_centres",
    "draw_classes",
    "draw_curves",
    "draw_distance_terms",
    "draw_drift",
    "draw_field",
    "draw_filter",
    "draw_frames",
    "draw_growth",
    "draw_initials",
    "draw_log",
    "draw_logs",
    "draw_maps",
    "draw_marked",
    "draw_merge",
    "draw_normals",
    "draw_online",
    "draw_path",
    "draw_points",
    "draw_poses",
    "draw_provenance",
    "draw_quadtree",
    "draw_quadtrees",
    "draw_ray",
    "draw_scan",
    "draw_segments",
    "draw_step",
    "draw_strip",
    "draw_threshold",
    "draw_times",
    "draw_trade",
    "draw_uncertainty",
    "figure_png",
    "group_colors",
    "thumbnail",
]
