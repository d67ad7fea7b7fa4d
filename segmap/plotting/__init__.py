"""Pictures: `draw_*(..., ax=None) -> ax`, maps in metres, with equal scales.

Without `ax` a new pyplot figure is made, small enough for a notebook. Each colour means the same in
every picture, and the colour-blind can tell them apart (Okabe and Ito, 2008).
"""

from __future__ import annotations

from ._alignments import draw_alignment, draw_alignments, draw_position_errors
from ._experiments import draw_curves, method_style
from ._pictures import figure_png, thumbnail
from ._plans import draw_plan
from ._quadtrees import draw_quadtree, square_corners
from ._scans import draw_log, draw_path, draw_points, draw_poses, draw_robot, draw_scan
from ._segments import (
    draw_against_walls,
    draw_before_after,
    draw_maps,
    draw_provenance,
    draw_segments,
)
from ._style import (
    DPI,
    ERROR,
    ERRORS,
    GROUPS,
    MAP,
    RAW,
    RESULT,
    TRUTH,
    axes_grid,
    axes_or_new,
    axes_row,
    group_colors,
    map_axes,
    sharp_figures,
)

__all__ = [
    "DPI", "ERROR", "ERRORS", "GROUPS", "MAP", "RAW", "RESULT", "TRUTH", "axes_grid", "axes_or_new",
    "axes_row", "draw_against_walls", "draw_alignment", "draw_alignments", "draw_before_after",
    "draw_curves", "draw_log", "draw_maps", "draw_path", "draw_plan", "draw_points",
    "draw_poses", "draw_position_errors", "draw_provenance", "draw_quadtree",
    "draw_robot", "draw_scan", "draw_segments", "figure_png", "group_colors",
    "map_axes", "method_style", "sharp_figures", "square_corners", "thumbnail",
]  # fmt: skip
