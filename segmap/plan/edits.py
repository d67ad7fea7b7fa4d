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
from ..segments import MIN_LENGTH, length, midpoint, point_distance
from ._cells import BRIDGED_M, LEAST_HOLE_M2, THICKEST_WALL_M
from ._doors import DRAWN, Door, rooms_beside
from ._draft import EDIT_REACH_M, Draft, Place, room_near
from ._furniture import go_through
from ._walls import ALONG_COSINE, SHORTEST_WALL_M, closed, normals

__all__ = ["Edit", "Furniture", "Join", "Name", "NewDoor", "NoDoor", "Split", "Wall", "read"]


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

    def on_rooms(self, draft: Draft) -> str:
        """Change rooms and walls; why that cannot be, or nothing."""
        return ""

    def on_doors(self, doors: list[Door], before: list[Door], draft: Draft) -> str:
        """Change the doors, which were these before any edit; why that cannot be, or nothing."""
        return ""


@dataclass(frozen=True)
class Join(Edit):
    """The rooms at two places are one."""

    a: Place
    b: Place

    def on_rooms(self, draft: Draft) -> str:
        """Both rooms become one, with their floor behind furniture.

        Where no way leads from one to the other, so does what is narrower than a wall between
        them, and walls that stand there are none.
        """
        grid, parts = draft.grid, draft.parts
        one, other = (room_near(grid, parts, place) for place in (self.a, self.b))
        if min(one, other) < 0:
            return "no room at one of the places"
        if one == other:
            return "both places are in one room"
        box = scipy.ndimage.find_objects(((parts == one) | (parts == other)).astype(int))[0]
        floors = parts.copy()
        for room in np.unique(parts[box][parts[box] >= 0]):
            around, is_floor = draft.floor(room)
            floors[around][is_floor & (floors[around] < 0)] = room
        joined = (floors == one) | (floors == other)
        if scipy.ndimage.label(joined)[1] > 1:
            box = scipy.ndimage.find_objects(joined.astype(int))[0]
            own = floors[box]
            away = (scipy.ndimage.distance_transform_edt(own != room) for room in (one, other))
            across = np.where(own < 0, sum(away) * grid.side, np.inf)
            if across.min() > THICKEST_WALL_M:
                return f"more than {THICKEST_WALL_M:g} m lie between the two rooms"
            joined[box] |= (between := across <= across.min() + 2 * grid.side)
            near = np.zeros(parts.shape, np.int64)
            near[box] = scipy.ndimage.maximum_filter(between, 3)
            draft.take_walls(near)
        parts[joined] = parts.max() + 1
        return ""


@dataclass(frozen=True)
class Split(Edit):
    """The room in the middle of a line is cut along it, from wall to wall."""

    start: Place
    end: Place

    def on_rooms(self, draft: Draft) -> str:
        """Each piece becomes a room; small ones go to their neighbours."""
        return draft.cut(np.array([self.start, self.end]), LEAST_HOLE_M2)


@dataclass(frozen=True)
class Wall(Edit):
    """The run of wall or clutter at a place is a wall: no furniture, and it bounds rooms.

    A room through which it runs from wall to wall is cut along it.
    """

    at: Place

    def on_rooms(self, draft: Draft) -> str:
        """The run counts as a wall, and cuts what it divides."""
        faces = draft.faces
        run = draft.run_near(self.at, np.ones(len(faces.wall), bool))
        if run < 0:
            return "no wall and no clutter there"
        runs, reach = faces.segments, faces.size[run] + 2 * EDIT_REACH_M
        is_new, faces.size[run], faces.wall[run] = ~faces.wall[run], np.inf, True
        if is_new:
            near = faces.wall & (point_distance(np.array(self.at), runs) <= reach)
            shut = closed(runs[near], draft.grid)[near[:run].sum()]
            if length(shut) >= SHORTEST_WALL_M:
                faces.segments[run] = shut
        if draft.cut(faces.segments[run], draft.least_area) and draft.was_wall[run]:
            draft.pins[self] = run
        return ""


@dataclass(frozen=True)
class Furniture(Edit):
    """The run of wall at a place is furniture, or a leaf: the room goes through it.

    It goes on to the next wall behind this place, at most 1.5 m, over what nobody saw; where
    another room comes first, both are one.
    """

    at: Place

    def on_rooms(self, draft: Draft) -> str:
        """Run and sides are clutter, and what is behind is of the room before."""
        run = draft.run_near(self.at, draft.faces.wall)
        draft.pins = {wall: own for wall, own in draft.pins.items() if own != run}
        return "no wall there" if run < 0 else go_through(draft, run, np.array(self.at))


@dataclass(frozen=True)
class NewDoor(Edit):
    """A door from jamb to jamb, drawn along a wall: onto its nearest face.

    It leads from room to room or, through an outer wall, to where nothing was seen, and takes the
    place of a door of the same rooms that it overlaps.
    """

    start: Place
    end: Place

    def on_rooms(self, draft: Draft) -> str:
        """Its jambs lie on the wall."""
        ends = np.array([self.start, self.end])
        walls, normal = draft.bounds()[0], normals(ends[None])[0]
        away = point_distance(midpoint(ends), walls)
        is_along = abs(normals(walls) @ normal) > ALONG_COSINE
        if (away[is_along] <= EDIT_REACH_M).any():
            near = walls[is_along][away[is_along].argmin()]
            ends = ends - ((ends - near[0]) @ normals(near[None]).T) * normals(near[None])
        elif (away <= THICKEST_WALL_M / 2).any():
            return "across a wall: draw it along, from jamb to jamb"
        if length(ends) < BRIDGED_M:
            return f"narrower than {BRIDGED_M:g} m"
        pieces = ends[0] + np.array([(0, 1), (0, 0.2), (0.8, 1)])[..., None] * (ends[1] - ends[0])
        rooms, *at_jambs = (rooms_on_both_sides(piece, draft) for piece in pieces)
        if rooms[0] == rooms[1]:
            return "no room, or one, on both sides: draw it along a wall, from jamb to jamb"
        if at_jambs != [rooms, rooms]:
            return "it reaches beyond its wall: draw it from jamb to jamb"
        draft.doorways[self] = ends
        return ""

    def on_doors(self, doors: list[Door], before: list[Door], draft: Draft) -> str:
        """A door more, and those that it overlaps less; none where its rooms were joined later."""
        ends = draft.doorways.get(self, np.zeros((2, 2)))
        new = Door(ends, rooms_on_both_sides(ends, draft), DRAWN)
        if new.rooms[0] != new.rooms[1]:
            for old in [old for old in doors if old.rooms == new.rooms]:
                cosine = (normals(old.ends[None]) @ normals(ends[None]).T).item()
                apart = np.hypot(*(old.place - new.place)) - (old.width + new.width) / 2
                if abs(cosine) > ALONG_COSINE and apart < -MIN_LENGTH:
                    doors.remove(old)
            doors.append(new)
        return ""


@dataclass(frozen=True)
class NoDoor(Edit):
    """At a place there is no door."""

    at: Place

    def on_doors(self, doors: list[Door], before: list[Door], draft: Draft) -> str:
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
FORMS = (
    "'Join X Y X Y', 'Split X Y X Y', 'NewDoor X Y X Y', 'NoDoor X Y', 'Wall X Y', "
    "'Furniture X Y' or 'Name X Y TEXT'"
)
KINDS = {kind.__name__: kind for kind in Edit.__subclasses__()}


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


def rooms_on_both_sides(ends: Array, draft: Draft) -> tuple[int, int]:
    """The rooms on both sides of a door that is drawn, -1 for none."""
    place, way = midpoint(ends), normals(ends[None])[0]
    return rooms_beside(place, way, draft.grid, draft.parts, is_shut=True)
