"""Pose graph: each scan on a map of the last key frames, loops closed, all poses solved."""

from ._front_end import FrontEnd, TrackedScan, Tracking
from ._given_poses import poses_compared
from ._in_motion import turn_of
from ._loop_closing import LoopClosing
from ._merge import merge_graphs
from ._pose_graph import LiveGraph, Placed, pose_graph
from ._wheels import Wheels

__all__ = [
    "FrontEnd", "LiveGraph", "LoopClosing", "Placed", "TrackedScan", "Tracking", "Wheels",
    "merge_graphs", "pose_graph", "poses_compared", "turn_of",
]  # fmt: skip
