"""Pictures: `draw_*(..., ax=None) -> ax`, maps in metres, with equal scales.

Without `ax` a new pyplot figure is made, small enough for a notebook. Each colour means the same in
every picture, and the colour-blind can tell them apart (Okabe and Ito, 2008).
"""

from ._alignments import draw_alignment
from ._experiments import METHOD_STYLES, draw_curves, draw_online, method_style
from ._maps import axes_grid, draw_maps, draw_poses
from ._pictures import figure_png, thumbnail
from ._quadtrees import draw_quadtree, draw_quadtrees, square_corners
from ._scans import draw_log, draw_path, draw_points, draw_robot, draw_scan
from ._segments import draw_before_after, draw_beside, draw_provenance, draw_segments
from ._style import (
    DPI,
    ERROR,
    ERRORS,
    GROUPS,
    MAP,
    RAW,
    RESULT,
    SIZE,
    TRUTH,
    axes_or_new,
    axes_row,
    group_colors,
    map_axes,
)
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
    "axes_grid",
    "axes_or_new",
    "axes_row",
    "draw_alignment",
    "draw_before_after",
    "draw_beside",
    "draw_curves",
    "draw_drift",
    "draw_log",
    "draw_logs",
    "draw_maps",
    "draw_online",
    "draw_path",
    "draw_points",
    "draw_poses",
    "draw_provenance",
    "draw_quadtree",
    "draw_quadtrees",
    "draw_robot",
    "draw_scan",
    "draw_segments",
    "figure_png",
    "group_colors",
    "map_axes",
    "method_style",
    "square_corners",
    "thumbnail",
]
