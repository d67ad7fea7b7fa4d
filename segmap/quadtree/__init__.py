"""Occupancy in a quadtree: a map that grows by itself, small and built scan by scan (B 4)."""

from ._build import build_map, extent, free_ends, without_passers
from ._frontiers import Frontier, frontiers
from ._grid import FREE, OCCUPIED, UNKNOWN, map_of_grid
from ._map import QuadtreeMap
from ._squares import NINE, Squares

__all__ = [
    "FREE", "NINE", "OCCUPIED", "UNKNOWN", "Frontier", "QuadtreeMap", "Squares", "build_map",
    "extent", "free_ends", "frontiers", "map_of_grid", "without_passers",
]  # fmt: skip
