"""Alignment: one pose for each scan of a log whose odometry drifts.

Every method has one signature, `method(log, *, thresholds) -> Alignment`, and stands in `METHODS`.
"""

from ._angle_candidates import Candidate, angle_candidates, match_values
from ._angle_correspondence import angle_correspondence, match_angles
from ._backbone import backbone, backbone_steps
from ._backbone_lines import least_translation, mean_rotation
from ._backbone_steps import BackboneStep
from ._errors import laid_on_truth, place_errors
from ._global_segments import global_segments
from ._odometry import ground_truth, odometry
from ._point_icp import match_points, point_icp
from ._point_steps import PointStep, point_steps
from ._pose_graph import pose_graph
from ._result import Alignment, Graph, Match, Method, Rejected
from ._segment_icp import match_segments, segment_icp
from ._solve_graph import solve_graph

#: Name of each method -> the method, with what it needs.
METHODS: dict[str, Method] = {
    "odometry": Method(odometry, "alone", True, "the baseline"),
    "ground_truth": Method(ground_truth, "alone", False, "A 3.3.3"),
    "angle_correspondence": Method(angle_correspondence, "pairs", False, "A 2.5.1, 3.3.1, [30]"),
    "backbone": Method(backbone, "map", True, "A 3.3.2, 5.2"),
    "segment_icp": Method(segment_icp, "map", True, "A 2.5.1, [31]"),
    "point_icp": Method(point_icp, "map", True, "A 2.5.1, [41]"),
    "global_segments": Method(global_segments, "all", True, "A 2.5.1, [42]"),
    "pose_graph": Method(pose_graph, "all", False, "Olson 2009, Grisetti et al. 2010"),
}

__all__ = [
    "METHODS",
    "Alignment",
    "BackboneStep",
    "Candidate",
    "Graph",
    "Match",
    "Method",
    "PointStep",
    "Rejected",
    "angle_candidates",
    "angle_correspondence",
    "backbone",
    "backbone_steps",
    "global_segments",
    "ground_truth",
    "laid_on_truth",
    "least_translation",
    "match_angles",
    "match_points",
    "match_segments",
    "match_values",
    "mean_rotation",
    "odometry",
    "place_errors",
    "point_icp",
    "point_steps",
    "pose_graph",
    "segment_icp",
    "solve_graph",
]
