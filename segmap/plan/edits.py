"""What a person changes in a floor plan, and how: records of places, in metres as recorded.

They hold no numbers of rooms, which another run would change. `floor_plan` and `FloorPlan.edited`
do one after the other what they say.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import astuple, dataclass, fields, replace

import numpy as np
import scipy

from .. import arrays
from ..arrays import Array
from ..poses import transform
from ..segments import MIN_LENGTH, point_distance
from ._cells import LEAST_HOLE_M2, Grid, Mask
from ._doors import Door
from ._lines import Indices
from ._walls import THICKEST_WALL_M

__all__ = ["Edit", "Join", "Name", "NoDoor", "Split", "read"]

#: A place belongs to the nearest room or door, metres; a split goes so far beyond its ends.
EDIT_REACH_M = 0.5

Place = tuple[float, float]


@dataclass(frozen=True)
class Edit:
    """What all edits are: places `(x, y)`, metres, and perhaps a text."""

    def __post_init__(self) -> None:
        for name, value in vars(self).copy().items():
            if name != "text":
                object.__setattr__(self, name, tuple(arrays.point(value, name).tolist()))
            elif not arrays.instance(value, name, str).isprintable() or not value.strip():
                raise ValueError(f"text must be a name, got {value!r}")

    def __str__(self) -> str:
        words = [k if isinstance(k, str) else "{:.10g} {:.10g}".format(*k) for k in astuple(self)]
        return " ".join([type(self).__name__, *words])

    def turned(self, angle: float) -> Edit:
        """The same in a map that is turned about (0, 0), radians."""
        places = {name: place for name, place in vars(self).items() if name != "text"}
        turned = transform((0.0, 0.0, angle), [*places.values()])
        return replace(self, **dict(zip(places, turned, strict=True)))

    def on_squares(self, grid: Grid, parts: Indices) -> str:
        """Change the room of each square; why that cannot be, or nothing."""
        return ""

    def on_doors(self, doors: list[Door], before: list[Door]) -> str:
        """Change the doors, which were these before any edit; why that cannot be, or nothing."""
        return ""


@dataclass(frozen=True)
class Join(Edit):
    """The rooms at two places are one."""

    a: Place
    b: Place

    def on_squares(self, grid: Grid, parts: Indices) -> str:
        """Both rooms become one, with what is narrower than a wall between them."""
        one, other = (room_near(grid, parts, place) for place in (self.a, self.b))
        if min(one, other) < 0:
            return "no room at one of the places"
        if one == other:
            return "both places are in one room"
        box = scipy.ndimage.find_objects(((parts == one) | (parts == other)).astype(int))[0]
        own = parts[box]  # a view
        rooms, between = ((own == one), (own == other)), own < -1
        if not _touch(rooms[0] | rooms[1]):
            across = sum(scipy.ndimage.distance_transform_edt(~room) for room in rooms)
            between = (own < 0) & (across * grid.side <= THICKEST_WALL_M)
            if not _touch(rooms[0] | rooms[1] | between):
                return f"more than {THICKEST_WALL_M:g} m lie between the two rooms"
        own[rooms[0] | rooms[1] | between] = parts.max() + 1
        return ""


@dataclass(frozen=True)
class Split(Edit):
    """The room in the middle of a line is cut along it, from wall to wall."""

    start: Place
    end: Place

    @property
    def line(self) -> Array:
        """From wall to wall `(2, 2)`, metres: somewhat longer than it was drawn."""
        start, end = np.array(self.start), np.array(self.end)
        beyond = EDIT_REACH_M * (end - start) / max(float(np.hypot(*(end - start))), MIN_LENGTH)
        return np.stack([start - beyond, end + beyond])

    def on_squares(self, grid: Grid, parts: Indices) -> str:
        """Each piece becomes a room; small ones go to their neighbours."""
        line = self.line
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
        large = 1 + np.flatnonzero(areas >= LEAST_HOLE_M2)
        if len(large) < 2:
            return f"no two rooms of {LEAST_HOLE_M2:g} m2 are left: draw it from wall to wall"
        near = scipy.ndimage.distance_transform_edt(~np.isin(pieces, large), return_indices=True)[1]
        parts[box][own] = (parts.max() + pieces[tuple(near)])[own]
        return ""


@dataclass(frozen=True)
class NoDoor(Edit):
    """At a place there is no door."""

    at: Place

    def on_doors(self, doors: list[Door], before: list[Door]) -> str:
        """The nearest door goes, where it did not go with a join already."""
        both = (doors, before)
        away = [[float(point_distance(np.array(self.at), k.ends)) for k in each] for each in both]
        near, was = (min(each, default=np.inf) <= EDIT_REACH_M for each in away)
        if near:
            del doors[int(np.argmin(away[0]))]
        return "" if near or was else "no door there"


@dataclass(frozen=True)
class Name(Edit):
    """The room at a place has a name; of two for one room the later counts."""

    at: Place
    text: str


#: How edits are written.
FORMS = "'Join X Y X Y', 'Split X Y X Y', 'NoDoor X Y' or 'Name X Y TEXT'"
KINDS: dict[str, type[Edit]] = {kind.__name__: kind for kind in (Join, Split, NoDoor, Name)}


def read(text: str) -> Edit:
    """The edit that a text says, as `str(edit)` writes it.

    Raises
    ------
    ValueError
        Where a text is none.

    Examples
    --------
    >>> read("Name 1 2.5 the hall")
    Name(at=(1.0, 2.5), text='the hall')
    >>> str(read("Join 0 0 4.25 1"))
    'Join 0 0 4.25 1'
    """
    name, _, rest = arrays.instance(text, "edit", str).partition(" ")
    if kind := KINDS.get(name):
        count = 2 * sum(each.name != "text" for each in fields(kind))
        words = rest.split(" ", count)
        with suppress(TypeError, ValueError):
            numbers = [*map(float, words[:count])]
            return kind(*zip(numbers[::2], numbers[1::2], strict=True), *words[count:])
    raise ValueError(f"edit must be like {FORMS}, metres, got {text!r}")


def room_near(grid: Grid, parts: Indices, place: Place | Array) -> int:
    """The number of the room at a place, or of the nearest that is not far; -1 for none."""
    squares = [int(k) for k in grid.squares(np.asarray(place))]
    reach = int(EDIT_REACH_M / grid.side) + 1
    row, column = (slice(max(k - reach, 0), k + reach + 1) for k in squares)
    near = parts[row, column]
    away = np.hypot(*np.moveaxis(grid.places((row, column)) - place, -1, 0))
    away[near < 0] = np.inf
    return int(near.flat[away.argmin()]) if away.min() <= EDIT_REACH_M else -1


def _touch(mask: Mask) -> bool:
    """Whether a mask is in one piece."""
    return int(scipy.ndimage.label(mask)[1]) == 1
