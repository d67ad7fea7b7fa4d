"""Occupancy in a quadtree: a map that grows by itself, small and built scan by scan (B 4)."""

from ._build import build_map
from ._extent import extent
from ._leaves import Leaves
from ._map import QuadtreeMap

__all__ = ["Leaves", "QuadtreeMap", "build_map", "extent"]
