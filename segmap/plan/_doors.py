"""Which doorways lead from one room to another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..quadtree import OCCUPIED
from ..segments import length, midpoint
from ._cells import Edges, Grid
from ._lines import Indices, Line

#: The room on one side of a doorway is looked for so far off it, metres: through a thick wall.
ROOM_REACH_M = 0.8
#: Doorways between the same rooms whose middles are so near are one, metres.
ONE_DOOR_M = 1.0
#: Why one is a door that a person drew.
DRAWN = "drawn by hand"


@dataclass(frozen=True, eq=False)
class Door:
    """A doorway.

    Parameters
    ----------
    ends : (2, 2) array, metres
        Both jambs.
    rooms : two int
        Indices in `FloorPlan.rooms`, ascending; -1 where nothing was seen: a door to the outside,
        which only a person draws.
    reason : str
        Why it is one.
    """

    ends: Array
    rooms: tuple[int, int]
    reason: str

    @property
    def width(self) -> float:
        """From jamb to jamb, metres."""
        return float(length(self.ends))

    @property
    def place(self) -> Array:
        """Its middle, `(2,)`, metres."""
        return midpoint(self.ends)

    def __repr__(self) -> str:
        return f"Door({self.width:.2f} m, between {self.rooms[0]} and {self.rooms[1]})"


def find_doors(edges: Edges, lines: list[Line], grid: Grid, labels: Indices) -> list[Door]:
    """Doorways with two rooms, or a room and none: of two faces of a wall the narrower."""
    candidates, doors = list[Door](), list[Door]()
    for run in [one for one in edges.runs if one.door]:
        line = lines[run.line]
        ends = np.reshape(run.jambs, (2, 1)) * line.way + line.offset * line.normal
        rooms = rooms_beside(midpoint(ends), line.normal, grid, labels)
        if rooms[0] != rooms[1]:
            words = f"open for {length(ends):.2f} m between {run.door}"
            candidates.append(Door(ends, rooms, words))
    for door in sorted(candidates, key=lambda one: one.width):
        same = [one.place for one in doors if one.rooms == door.rooms]
        if all(np.hypot(*(place - door.place)) > ONE_DOOR_M for place in same):
            doors.append(door)
    return doors


def rooms_beside(
    place: Array, normal: Array, grid: Grid, labels: Indices, *, is_shut: bool = False
) -> tuple[int, int]:
    """The rooms on both sides of a doorway, ascending, -1 for none.

    A shut one is a face of a wall as yet, which may lie in a square of its room; and the sill of a
    doorway may be of one room up to its other face.
    """
    start, ways = grid.side * (1.5 if is_shut else 0.5), list[Indices]()
    steps = np.arange(start, ROOM_REACH_M, grid.side)[:, None]
    for side in (1, -1):
        row, column = grid.squares(place + side * steps * normal)
        before = np.logical_and.accumulate((grid.kind[row, column] != OCCUPIED) | is_shut)
        ways.append(labels[row, column][before & (labels[row, column] >= 0)])
    first, second = (int(next(iter(way), -1)) for way in ways)
    if is_shut and first == second:
        second = next((int(k) for k in np.concatenate(ways) if k != first), first)
    return min(first, second), max(first, second)
