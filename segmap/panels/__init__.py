"""Panels to play with in a notebook: a few controls bound to one drawing each.

They show their still picture where no kernel runs. Set a control from Python and read a text:
`panel.tolerance.value = 0.06; panel.count.value`.
"""

from ._angles import AnglePanel
from ._backbone import BackbonePanel
from ._base import Panel
from ._basic import BasicPanel
from ._classes import ClassesPanel
from ._clusters import ClusterPanel
from ._compare import ComparePanel
from ._distance import DistancePanel
from ._fusion import FusionPanel
from ._ground_truth import GroundTruthPanel
from ._hybrid import HybridPanel
from ._icp import IcpPanel
from ._live import LivePanel
from ._mean_shift import MeanShiftPanel
from ._polylines import PolylinePanel
from ._pose_graph import PoseGraphPanel
from ._quadtree import QuadtreePanel
from ._ray_variants import insert_variant
from ._rays import RayPanel
from ._room import RoomPanel
from ._scan import ScanPanel
from ._storage import StoragePanel

__all__ = [
    "AnglePanel",
    "BackbonePanel",
    "BasicPanel",
    "ClassesPanel",
    "ClusterPanel",
    "ComparePanel",
    "DistancePanel",
    "FusionPanel",
    "GroundTruthPanel",
    "HybridPanel",
    "IcpPanel",
    "LivePanel",
    "MeanShiftPanel",
    "Panel",
    "PolylinePanel",
    "PoseGraphPanel",
    "QuadtreePanel",
    "RayPanel",
    "RoomPanel",
    "ScanPanel",
    "StoragePanel",
    "insert_variant",
]
