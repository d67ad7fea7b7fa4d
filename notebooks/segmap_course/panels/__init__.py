"""Lesson panels: one method, its controls and what they change."""

from ._alignment import (
    AnglePanel,
    BackbonePanel,
    GlobalPanel,
    GroundTruthPanel,
    SegmentIcpPanel,
)
from ._chosen import EarlyMethodsPanel, FusionPanel, LineErrorPanel, OnePerWallPanel
from ._finders import FinderPanel
from ._graphs import IcpPanel, PoseGraphPanel
from ._matching import KalmanPanel, LandscapePanel, MatcherPanel, ParticlePanel, PlacePanel
from ._quadtree import ClassesPanel, EndsPanel, RayPanel, RoutePanel, StoragePanel, insert_variant
from ._reduction import (
    BasicPanel,
    HybridPanel,
    LeastCostPanel,
    MeanShiftPanel,
    SectorPanel,
)
from ._scans import ClusterPanel, MovingPanel, PolylinePanel, RoomPanel
from ._tape import TapePanel

__all__ = [
    "AnglePanel", "BackbonePanel", "BasicPanel", "ClassesPanel", "ClusterPanel",
    "EarlyMethodsPanel", "EndsPanel", "FinderPanel", "FusionPanel", "GlobalPanel",
    "GroundTruthPanel", "HybridPanel", "IcpPanel", "KalmanPanel", "LandscapePanel",
    "LeastCostPanel", "LineErrorPanel", "MatcherPanel", "MeanShiftPanel", "MovingPanel",
    "OnePerWallPanel", "ParticlePanel", "PlacePanel", "PolylinePanel",
    "PoseGraphPanel", "RayPanel", "RoomPanel", "RoutePanel", "SectorPanel", "SegmentIcpPanel",
    "StoragePanel", "TapePanel", "insert_variant",
]  # fmt: skip
