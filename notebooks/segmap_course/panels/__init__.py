"""Lesson panels: one method, its controls and what they change."""

from ._alignment import (
    AnglePanel,
    BackbonePanel,
    GlobalPanel,
    GroundTruthPanel,
    SegmentIcpPanel,
)
from ._chosen import EarlyMethodsPanel, LineErrorPanel, OnlinePanel
from ._graphs import IcpPanel, PoseGraphPanel
from ._matching import LandscapePanel, MatcherPanel, ParticlePanel, PlacePanel
from ._quadtree import ClassesPanel, RayPanel, RoutePanel, StoragePanel, insert_variant
from ._reduction import (
    BasicPanel,
    FusionPanel,
    HybridPanel,
    LeastCostPanel,
    MeanShiftPanel,
    SectorPanel,
    WallsPanel,
)
from ._scans import ClusterPanel, DistancePanel, MovingPanel, PolylinePanel, RoomPanel

__all__ = [
    "AnglePanel", "BackbonePanel", "BasicPanel", "ClassesPanel", "ClusterPanel", "DistancePanel",
    "EarlyMethodsPanel", "FusionPanel", "GlobalPanel", "GroundTruthPanel", "HybridPanel",
    "IcpPanel", "LandscapePanel", "LeastCostPanel", "LineErrorPanel", "MatcherPanel",
    "MeanShiftPanel", "MovingPanel", "OnlinePanel", "ParticlePanel", "PlacePanel", "PolylinePanel",
    "PoseGraphPanel", "RayPanel", "RoomPanel", "RoutePanel", "SectorPanel", "SegmentIcpPanel",
    "StoragePanel", "WallsPanel", "insert_variant",
]  # fmt: skip
