"""Lesson panels: one method, its controls and what they change."""

from ._alignment import AnglePanel, BackbonePanel, GroundTruthPanel
from ._graphs import IcpPanel, PoseGraphPanel
from ._matching import LandscapePanel, MatcherPanel, ParticlePanel, PlacePanel
from ._quadtree import ClassesPanel, RayPanel, RoutePanel, StoragePanel, insert_variant
from ._reduction import (
    BasicPanel,
    ChainPanel,
    FusionPanel,
    HybridPanel,
    LeastCostPanel,
    MeanShiftPanel,
    SectorPanel,
    WallsPanel,
    WeightedPanel,
)
from ._scans import ClusterPanel, DistancePanel, MovingPanel, PolylinePanel, RoomPanel

__all__ = [
    "AnglePanel", "BackbonePanel", "BasicPanel", "ChainPanel", "ClassesPanel", "ClusterPanel",
    "DistancePanel", "FusionPanel", "GroundTruthPanel", "HybridPanel", "IcpPanel", "LandscapePanel",
    "LeastCostPanel", "MatcherPanel", "MeanShiftPanel", "MovingPanel", "ParticlePanel",
    "PlacePanel", "PolylinePanel", "PoseGraphPanel", "RayPanel", "RoomPanel", "RoutePanel",
    "SectorPanel", "StoragePanel", "WallsPanel", "WeightedPanel", "insert_variant",
]  # fmt: skip
