"""Floor plans: walls, rooms and doors, from the segments and the free space of a map.

Rooms are nodes and doors edges of the topological map of A 2.1; the walls come from A's segments,
the free space from B's quadtree.
"""

from ._doors import Door
from ._plan import FloorPlan, floor_plan
from ._polygons import Room, shapely_or_hint
from .edits import Furniture, Join, Name, NewDoor, NoDoor, Split, Wall

__all__ = [
    "Door", "FloorPlan", "Furniture", "Join", "Name", "NewDoor", "NoDoor", "Room", "Split", "Wall",
    "floor_plan", "shapely_or_hint",
]  # fmt: skip
