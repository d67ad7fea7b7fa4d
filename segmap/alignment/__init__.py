"""Alignment: one pose for each scan of a log whose odometry drifts.

Every method has one signature, `method(log, *, thresholds) -> Alignment`, and stands in `METHODS`.
"""

from ..methods import Family, Method
from ..scans.causes import Unmatched
from ._baselines import align_to_truth, ground_truth, odometry, position_errors, usual_method
from ._deskew import deskew
from ._point_icp import point_icp
from ._result import Alignment, Match
from ._verdict import Verdict
from .angle_correspondence import angle_candidates, angle_correspondence, match_angles, match_values
from .backbone import backbone, backbone_steps, least_translation, mean_rotation
from .global_segments import global_segments
from .graph import Graph, solve_graph
from .points import match_points, point_steps
from .pose_graph import LiveGraph, LoopClosing, Tracking, merge_graphs, pose_graph
from .preparation import prepared
from .segment_icp import match_segments, segment_icp

__all__ = [
    "METHODS", "Alignment", "Graph", "LiveGraph", "LoopClosing", "Match", "Tracking", "Unmatched",
    "Verdict", "align_to_truth", "angle_candidates", "angle_correspondence", "backbone",
    "backbone_steps", "deskew", "global_segments", "ground_truth", "least_translation",
    "match_angles", "match_points", "match_segments", "match_values", "mean_rotation",
    "merge_graphs", "odometry", "point_icp", "point_steps", "pose_graph", "position_errors",
    "prepared", "segment_icp", "solve_graph", "usual_method",
]  # fmt: skip

#: Name of each method -> the method, with what it needs.
METHODS = Family[Alignment](
    odometry=Method(odometry, "the baseline", works="alone", needs_odometry=True),
    ground_truth=Method(ground_truth, "A 3.3.3", works="alone"),
    angle_correspondence=Method(
        angle_correspondence, "A 2.5.1, 3.3.1", "Amigoni, Gasparini, Gini 2006", works="pairs"
    ),
    backbone=Method(backbone, "A 3.3.2, 5.2", works="map", needs_odometry=True),
    segment_icp=Method(
        segment_icp, "A 2.5.1", "Amigoni, Fontana, Garigiola 2006", works="map", needs_odometry=True
    ),
    point_icp=Method(point_icp, "A 2.5.1", "Lu, Milios 1997", works="map", needs_odometry=True),
    global_segments=Method(
        global_segments,
        "A 2.5.1",
        "Elseberg, Creed, Lakaemper 2010",
        works="all",
        needs_odometry=True,
    ),
    pose_graph=Method(pose_graph, "beyond A", "Olson 2009, Grisetti et al. 2010", works="all"),
)
