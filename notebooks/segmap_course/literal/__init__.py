"""Every method as the theses print it: plain loops over plain numbers, slow and readable.

They are the oracle of the tests, the code that chapters show, and the yardstick of the benchmarks.
Nothing here calls the fast version of what it does. A method of which one version is enough stands
in the library alone, and is named here, as `viewing_sector`.

A reduction takes segments, for an on-line method the scan of each, and its thresholds by the names
of the fast version: `fusion(segments, tolerance=0.04)`, `hybrid(segments, scans, distance=0.2)`. It
returns the outputs and, for each input, the number of the output that it went into, -1 for none.
"""

from segmap.reduction.surveyed import (
    fuzzy_clustering,
    fuzzy_set,
    polyline,
    polyline_through,
    uncertain_parameters,
    viewing_sector,
    weighted_line_fitting,
)

from .alignment.angle_correspondence import match_value, transforms, value_of
from .alignment.backbone import least_translation, line_partner, mean_rotation
from .alignment.correlative_search import correlative_search, likelihoods
from .alignment.gauss_newton import (
    edge_jacobians,
    edge_residual,
    gauss_newton,
    normal_equations,
)
from .alignment.global_segments import best_shifts, best_turns, least_squares
from .alignment.moving_laser import after, carry_beam, steady_twist
from .alignment.ndt import match_ndt, ndt_step, normals_of
from .alignment.point_to_line import best_move, icp, point_to_line_step
from .alignment.segment_icp import partners, segment_cost, turn_and_shift
from .extraction import extract_clusters, extract_polylines, fit_algebraic, fit_total
from .line_finders import (
    lines_em,
    lines_hough,
    lines_incremental,
    lines_ransac,
    lines_regression,
)
from .lines import axial_difference, line_angle, placed, point_to_segment, segment_length
from .metrics import against_walls, quality, segment_distance
from .quadtrees.histograms import (
    angle_histogram,
    best_shift,
    histogram,
    hough_lines,
    match_histograms,
    match_hough,
)
from .quadtrees.hypotheses import effective_number, information, log_likelihood, systematic
from .quadtrees.matching import MOVES, climb_step, hill_climb, sample_and_rank
from .quadtrees.particles import enough, fit, localize, weighed
from .quadtrees.quadtree import (
    Quadtree,
    cell_of,
    crossed_cells,
    grown,
    mean_and_variance,
    occupancy,
    quarters,
    ray_cells,
)
from .quadtrees.scores import (
    descent_score,
    distance_score,
    nearest_cell,
    occupancy_score,
    squares_above,
)
from .quadtrees.search import every_pose, headings, likelihood, places
from .reduction.basic import basic_offline, basic_online
from .reduction.fusion import (
    add_scan,
    best_strip,
    chain,
    fuse_longest,
    fusion,
    fusion_online,
    in_strip,
    online,
)
from .reduction.hybrid import hough, hybrid, hybrid_fusion, hybrid_scan
from .reduction.least_cost import least_cost
from .reduction.mean_shift import mean_shift
from .reduction.one_per_wall import one_per_wall
from .reduction.segment_similarity import mean_segment, segment_similarity

__all__ = [
    "MOVES", "Quadtree", "add_scan", "after", "against_walls", "angle_histogram",
    "axial_difference", "basic_offline", "basic_online", "best_move", "best_shift", "best_shifts",
    "best_strip", "best_turns", "carry_beam", "cell_of", "chain", "climb_step",
    "correlative_search", "crossed_cells", "descent_score", "distance_score", "edge_jacobians",
    "edge_residual", "effective_number", "enough", "every_pose", "extract_clusters",
    "extract_polylines", "fit", "fit_algebraic", "fit_total", "fuse_longest", "fusion",
    "fusion_online", "fuzzy_clustering", "fuzzy_set", "gauss_newton", "grown", "headings",
    "hill_climb", "histogram", "hough", "hough_lines", "hybrid", "hybrid_fusion", "hybrid_scan",
    "icp", "in_strip", "information", "least_cost", "least_squares", "least_translation",
    "likelihood", "likelihoods", "line_angle", "line_partner", "lines_em", "lines_hough",
    "lines_incremental", "lines_ransac", "lines_regression", "localize", "log_likelihood",
    "match_histograms", "match_hough", "match_ndt", "match_value", "mean_and_variance",
    "mean_rotation", "mean_segment", "mean_shift", "ndt_step", "nearest_cell", "normal_equations",
    "normals_of", "occupancy", "occupancy_score", "one_per_wall", "online", "partners", "placed",
    "places", "point_to_line_step", "point_to_segment", "polyline", "polyline_through", "quality",
    "quarters", "ray_cells", "sample_and_rank", "segment_cost", "segment_distance",
    "segment_length", "segment_similarity", "squares_above", "steady_twist", "systematic",
    "transforms", "turn_and_shift", "uncertain_parameters", "value_of", "viewing_sector",
    "weighed", "weighted_line_fitting",
]  # fmt: skip
