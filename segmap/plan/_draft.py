"""A plan while a person's edits change it: the rooms of squares, walls, doorways."""

from __future__ import annotations

from collections.abc import Hashable
from copy import deepcopy

import numpy as np
import scipy

from ..arrays import Array
from ..segments import MIN_LENGTH, length, point_distance
from ._cells import Grid, Mask
from ._lines import Indices
from ._outlines import SNAP_M, Bounds, room_of
from ._polygons import Room, shapely_or_hint
from ._walls import SHORTEST_WALL_M, Faces, with_gaps

#: A place belongs to the nearest room, door or run of wall, metres; a cut goes so far beyond its
#: ends.
EDIT_REACH_M = 0.5

#: Places of a run at which it is looked at what it stands on.
RUN_PLACES = 101

Place = tuple[float, float]


class Draft:
    """A plan while edits change it, one after the other.

    Parameters
    ----------
    grid : Grid
    parts : (rows, columns) int array
        The room of each square, -1 for none.
    faces : Faces
        Runs of wall and clutter.
    pins : dict of int
        The walls by which a person changed nothing as yet, if they are no furniture.
    cuts : (k, 2, 2) array, metres
        Borders of rooms that a person drew.
    doorways : dict of (2, 2) arrays, metres
        The jambs of the doors that a person drew.
    least_area : float, square metres
        Of a room that a wall cuts off.
    sills : (d, 2) array, metres
        Places of the doors before any edit.
    outlined : dict of Room
        Outlines by squares and walls: what no edit changed is not made anew.
    """

    def __init__(
        self, grid: Grid, parts: Indices, faces: Faces, least_area: float, sills: Array,
        outlined: dict[bytes, Room],
    ) -> None:  # fmt: skip
        self.grid, self.parts, self.least_area = grid, parts.copy(), least_area
        self.sills, self.outlined = sills, outlined
        self.faces, self.was_wall, self.pins = deepcopy(faces), faces.wall, dict[Hashable, int]()
        self.cuts, self.doorways = np.zeros((0, 2, 2)), dict[Hashable, Array]()

    def run_near(self, place: Place | Array, runs: Mask) -> int:
        """The number of the nearest of such runs; -1 where none is near."""
        away = np.where(runs, point_distance(np.array(place), self.faces.segments), np.inf)
        return int(away.argmin()) if away.min(initial=np.inf) <= EDIT_REACH_M else -1

    def bounds(self) -> Bounds:
        """What bounds rooms: walls, and what a person drew."""
        faces, wall, cuts = self.faces, self.faces.wall, self.cuts
        side = np.append(faces.side[wall], np.zeros(len(cuts), np.int64))
        size = np.append(faces.size[wall], length(cuts))
        return np.concatenate([faces.segments[wall], cuts]), side, size

    def outline(self, number: int, box: tuple[slice, ...], doorways: Array) -> Room:
        """The room of the squares in a box that have a number, without a name."""
        grid, reach = self.grid, int(SNAP_M / self.grid.side) + 2
        low, high = np.array([(each.start, each.stop) for each in box]).T

        def near(points: Array) -> Mask:
            places = np.stack(grid.squares(points), -1)
            return np.asarray(
                ((places.min(1) <= high + reach) & (places.max(1) >= low - reach)).all(1)
            )

        segments, side, size = self.bounds()
        which, doors = near(segments), doorways[near(doorways[:, None])]
        walls = segments[which], side[which], size[which]
        own = self.parts[box]
        squares = np.where(own < 0, 0, 1 + (own == number)).astype(np.int8)
        key = b"".join(each.tobytes() for each in (low, high, squares, *walls, doors))
        if key not in self.outlined:
            self.outlined[key] = room_of(
                self.parts, number, box, grid, walls, doors, self.least_area
            )
        return self.outlined[key]

    def floor(self, number: int) -> tuple[tuple[slice, ...], Mask]:
        """The box of a room, and which squares its outline goes round, behind furniture too."""
        box = scipy.ndimage.find_objects((self.parts == number).astype(int))[0]
        room = self.outline(number, box, self.sills)
        box = self.grid.box(room.outline)
        places = np.moveaxis(self.grid.places(box), -1, 0)
        return box, shapely_or_hint().contains_xy(room.polygon, *places)

    def take_walls(self, where: Indices) -> None:
        """Take the pieces of runs away that stand on such squares, but for a person's walls."""
        faces, share = self.faces, np.linspace(0, 1, RUN_PLACES)
        along = faces.segments[:, :1] + share[:, None] * np.diff(faces.segments, axis=1)
        is_on = (self.grid.at(along, where) > 0) & np.isfinite(faces.size)[:, None]
        cut = np.flatnonzero(is_on.mean(1) * length(faces.segments) >= SHORTEST_WALL_M)
        ends = [share[is_on[run]][[0, -1]] for run in cut]
        pinned, self.was_wall = np.isinf(faces.size), np.append(self.was_wall, self.was_wall[cut])
        self.faces = with_gaps(faces, cut, np.reshape(ends, (-1, 2)))
        self.faces.size[: len(pinned)][pinned] = np.inf

    def cut(self, ends: Array, least: float) -> str:
        """Cut the room in the middle of a line `(2, 2)`, somewhat longer than it is, along it.

        Each piece becomes a room; small ones go to their neighbours.
        """
        start, end = ends
        beyond = EDIT_REACH_M * (end - start) / max(float(np.hypot(*(end - start))), MIN_LENGTH)
        line, grid, parts = np.stack([start - beyond, end + beyond]), self.grid, self.parts
        room, size = room_near(grid, parts, line.mean(0)), float(np.hypot(*(line[1] - line[0])))
        if room < 0:
            return "no room at its middle"
        box = scipy.ndimage.find_objects((parts == room).astype(int))[0]
        own, way = parts[box] == room, (line[1] - line[0]) / max(size, MIN_LENGTH)
        to = grid.places(box) - line[0]
        along, across = to @ way, to @ (-way[1], way[0])
        # so wide that no way over sides of squares leads past
        cut = (along >= 0) & (along <= size) & (abs(across) <= grid.side * np.sqrt(0.5))
        pieces = scipy.ndimage.label(own & ~cut)[0]
        areas = np.bincount(pieces.ravel())[1:] * grid.side**2
        large = 1 + np.flatnonzero(areas >= least)
        if len(large) < 2:
            return f"no two rooms of {least:g} m2 are left: draw it from wall to wall"
        near = scipy.ndimage.distance_transform_edt(~np.isin(pieces, large), return_indices=True)[1]
        parts[box][own] = (parts.max() + pieces[tuple(near)])[own]
        self.cuts = np.concatenate([self.cuts, line[None]])
        return ""


def room_near(grid: Grid, parts: Indices, place: Place | Array) -> int:
    """The number of the room at a place, or of the nearest that is not far; -1 for none."""
    ways = EDIT_REACH_M * np.stack([grid.right, grid.up])
    box = grid.box(np.concatenate([place + ways, place - ways]))
    near, away = parts[box], np.hypot(*np.moveaxis(grid.places(box) - place, -1, 0))
    away[near < 0] = np.inf
    return int(near.flat[away.argmin()]) if away.min() <= EDIT_REACH_M else -1
