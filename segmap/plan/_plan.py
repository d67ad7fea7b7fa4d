"""Floor plans: walls, clutter, rooms and doors from the segments and the free space of a map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array, Metres, Positive, Segments, Share, checked
from ..progress import announce
from ..quadtree import FREE, OCCUPIED, UNKNOWN, QuadtreeMap
from ..reduction import Reduction
from ..segments import angle, length, midpoint
from ._cells import (
    LEAST_HOLE_M2,
    WIDEST_LEAF_M,
    Edges,
    Grid,
    cell_keys,
    completed,
    connected,
    edges_between,
    grid_along,
    unseen_border,
)
from ._doors import DRAWN, Door, find_doors
from ._draft import Draft
from ._lines import AXIS_BAND_RAD, Indices, Line, building_axes, quarter_turn, wall_lines
from ._outlines import SLIT_M, SNAP_M, apart
from ._polygons import Room, shapely_or_hint
from ._rooms import find_rooms
from ._walls import Faces, draw_faces, normals, walls_and_clutter, with_doorway
from .edits import Edit, Name

#: Side of the squares of free space, metres.
SQUARE_M = 0.05
#: A building is at most so wide: farther, coordinates are likely millimetres; metres.
WIDEST_BUILDING_M = 400.0
#: And so wide at least, metres: coordinates are likely kilometres.
NARROWEST_BUILDING_M = 0.5
#: Segments below this length make no line, metres.
LEAST_LINE_PIECE_M = 0.3


class Base(NamedTuple):
    """What a plan is made of before a person edits it."""

    grid: Grid
    lines: list[Line]
    edges: Edges
    parts: Indices  # the room of each square, -1 for none
    reasons: dict[int, str]
    faces: Faces
    axes: Array
    opening: float
    least_area: float
    doors: list[Door]
    outlined: dict[bytes, Room]  # by squares and walls: what no edit changed is not made anew


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """What a person would draw.

    Parameters
    ----------
    walls, clutter : Reduction
        Straight faces of walls with closed corners, and what is none; `members` are the segments
        behind each.
    thickness : (w,) array, metres
        From each wall to the other face of the same wall, NaN where that was not seen.
    side : (w,) int array
        1 where the free side of a wall lies to the left on the way from its first end to its
        second, -1 to the right, 0 where both are free, or neither.
    residual : (w,) array, metres
        Root mean square distance of the segments behind: a long wall that poses have bent.
    rooms : list of Room
        The largest first.
    doors : list of Door
    axes : (k,) array, radians
        Along and across which walls run.
    openings_to_nowhere : list of Door
        Doorways behind which nothing was seen.
    unseen : (r,) array, metres
        Of the border of each room, behind which nobody saw anything.
    edits : tuple of Edit
        What a person changed.
    unplaced : list of str
        The edits that changed nothing, and why: their rooms are not where they were.
    """

    walls: Reduction
    clutter: Reduction
    thickness: Array
    side: Indices
    residual: Array
    rooms: list[Room]
    doors: list[Door]
    axes: Array
    openings_to_nowhere: list[Door]
    unseen: Array
    edits: tuple[Edit, ...]
    unplaced: list[str]
    base: Base = field(repr=False)

    def edited(self, edits: Sequence[Edit]) -> FloorPlan:
        """The plan with these edits in the place of its own; walls and free space stay.

        Examples
        --------
        >>> from segmap.plan import Name, floor_plan
        >>> from segmap.quadtree import map_of_grid
        >>> walls = [[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]]
        >>> plan = floor_plan(walls, map_of_grid(np.ones((60, 80)), resolution=0.05))
        >>> plan.edited([Name((1, 1), "hall")]).rooms
        [Room('hall', 12.0 m2, 4 corners)]
        """
        return _form_plan(self.base, edits)

    @property
    def doubt(self) -> str:
        """What is not as the method assumes; nothing where all is."""
        from scipy.sparse.csgraph import connected_components

        doors = [door for door in self.doors if min(door.rooms) >= 0]
        narrow = [door for door in doors if door.width <= WIDEST_LEAF_M]
        part = connected_components(replace(self, doors=narrow).graph)[1]
        wide = sum(d.width > WIDEST_LEAF_M and not np.ptp(part[[*d.rooms]]) for d in doors)
        away, names = len(self.openings_to_nowhere), [room.name for room in self.rooms]
        joined = {-1, *(k for door in self.doors for k in door.rooms)}
        alone = [names[k] for k in range(len(names)) if k not in joined] * (len(names) > 1)
        ends = [f"{names[k]} ({self.unseen[k]:.1f} m)" for k in np.flatnonzero(self.unseen)]
        doubts = {
            "no room was found: where the walls are, nothing was seen free": not self.rooms,
            f"openings to where nothing was seen, windows or glass: {away}": away,
            f"doors wider than a leaf where a way leads round, perhaps glass: {wide}": wide,
            "walls along no axis stand in a room, and may divide it": self._has_walls_aslant,
            f"no door was seen of {', '.join(alone)}": alone,
            f"free space ends where nothing was seen, and may go on: {', '.join(ends)}": ends,
            f"edits that change nothing: {', '.join(self.unplaced)}": self.unplaced,
        }
        return "; ".join(words for words, so in doubts.items() if so)

    @property
    def _has_walls_aslant(self) -> bool:
        """Whether a wall along no axis, longer than a leaf, has one room before both faces."""
        walls, turn = self.walls.segments, angle(self.walls.segments)[:, None]
        is_aslant = (abs(quarter_turn(turn - self.axes)) > AXIS_BAND_RAD).all(1)
        is_aslant &= (length(walls) > WIDEST_LEAF_M) & np.isfinite(self.thickness)
        front = (self.side[:, None] * normals(walls))[is_aslant]
        middle, thickness = midpoint(walls)[is_aslant], self.thickness[is_aslant, None]
        before = self.room_at(middle + SNAP_M * front)
        behind = self.room_at(middle - (thickness + SNAP_M) * front)
        return bool(((before >= 0) & (before == behind)).any())

    @property
    def graph(self) -> NDArray[np.bool_]:
        """Which rooms a door joins, `(r, r)`: the topological map of A 2.1."""
        is_joined = np.zeros((len(self.rooms),) * 2, bool)
        for door in self.doors:
            if door.rooms[0] >= 0:
                is_joined[door.rooms] = is_joined[door.rooms[::-1]] = True
        return is_joined

    def room_at(self, points: ArrayLike) -> Indices:
        """The room of points `(n, 2)`, metres: `(n,)` int array, -1 for none."""
        shapely = shapely_or_hint()
        places, numbers = arrays.points(points), np.full(len(arrays.points(points)), -1)
        for k, room in reversed([*enumerate(self.rooms)]):
            numbers[shapely.contains_xy(room.polygon, *places.T)] = k
        return numbers

    def __repr__(self) -> str:
        rooms = f"{len(self.rooms)} rooms of {sum(room.area for room in self.rooms):.1f} m2"
        words = f"{rooms}, {len(self.doors)} doors, {len(self.walls)} walls", self.doubt
        return f"FloorPlan({'; '.join(filter(None, words))})"


@checked
def floor_plan(
    map: Segments,
    free: QuadtreeMap,
    *,
    door: tuple[float, float] = (0.55, 2.5),
    kappa: Positive = 0.8,
    share: Share = 0.5,
    opening: Metres = 2.0,
    band: Metres = 0.15,
    least_area: Positive = 1.5,
    edits: Sequence[Edit] = (),
) -> FloorPlan:
    """A floor plan: straight walls with closed corners, rooms with their areas, doors.

    Walls of a building run along few axes, so their lines cut the plane into cells (Mura et al.
    2014 do so in space). What is free in a cell joins the next one where neither a wall nor a
    doorway stands between both. A room reaches to the faces of its walls; what is smaller than
    `least_area` and stands in it, or at a wall, counts as its floor, and is `Room.hidden`. What was
    only looked into, through a doorway or less, is no room where nobody saw most of its border.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Best reduced, by `one_per_wall`.
    free : QuadtreeMap
        Of the same scans, with a `free_resolution` of 0.05 m.
    door : two floats, metres
        The narrowest and the widest doorway.
    kappa
        A doorway stands between two rooms that hold a circle of so many times its width; where a
        corridor ends in a room with its full width, that must hold one of 2.5 times as much, and
        the corridor be as long. Without this rule every niche is a room. Drives that see rooms in
        part, behind furniture, are cut into more rooms than a person would: a larger kappa, or a
        narrower `door`, joins them.
    share, opening
        Two cells join where so much of their border is open, or an opening is so wide.
    band
        Segments whose offsets differ by less are on one line.
    least_area : float, square metres
        Smaller ones go into the room to which they are open, if that is no doorway; what is larger
        and stands in a room is none of it.
    edits : list of `Edit`, in their order
        What a person changed, by places: see `plan.edits`. What finds nothing there is in
        `unplaced`.

    Raises
    ------
    ValueError
        Where coordinates are likely in another unit, all walls are short, or nothing was seen free.

    Examples
    --------
    >>> from segmap import load, build_map, quadtree, reduction
    >>> log = load("room")
    >>> walls = reduction.one_per_wall(build_map(log, log.truth, keep_points=True))
    >>> free = quadtree.build_map(log, log.truth, resolution=0.05, free_resolution=0.05)
    >>> plan = floor_plan(walls, free)
    >>> len(plan.rooms), len(plan.doors)
    (3, 2)
    """
    shapely_or_hint()
    segments = arrays.segments(map, "map")
    arrays.instance(free, "free", QuadtreeMap)
    widths = arrays.row(door, "door", 2)
    if not 0 < widths[0] < widths[1]:
        raise ValueError(f"door must be the narrowest and the widest, metres, got {door}")
    long = segments[length(segments) >= LEAST_LINE_PIECE_M]
    across = float(np.ptp(long.reshape(-1, 2), axis=0).max()) if len(long) else 0.0
    if not NARROWEST_BUILDING_M <= across <= WIDEST_BUILDING_M:
        extent = f"its walls of {LEAST_LINE_PIECE_M:g} m and more reach over {across:.6g} m"
        raise ValueError(f"map must be a building in metres, but {extent}")
    leaves = free.leaves()
    if not (seen := leaves.vis > 0).any():
        raise ValueError("free must hold a scan, got a map in which nothing was seen")
    low = np.stack([leaves.x, leaves.y], -1)[seen]
    ends = np.concatenate([low, low + leaves.side[seen, None], segments.reshape(-1, 2)])
    if (reach := float(np.ptp(ends, axis=0).max())) > WIDEST_BUILDING_M:
        raise ValueError(
            f"free must be of one building, but what the scans saw reaches over {reach:.6g} m, and "
            f"its walls over {across:.6g} m: crop both to the building (map --crop, free.cropped)"
        )
    announce(0.0, "plan: lines of the walls")
    axes = building_axes(long)
    grid = grid_along(free, float(axes[0]) if len(axes) else 0.0, segments, SQUARE_M)
    lines, run = wall_lines(long, axes, band), np.array([widths[0], opening])
    grid = completed(grid, lines, segments, least_area)
    cells = connected(cell_keys(grid.places(), lines), grid.kind == FREE, 1)
    edges = edges_between(lines, grid, cells, widths, band)
    labels, words = find_rooms(grid, cells, edges, kappa, share, run, least_area)
    parts = connected(labels, labels >= 0, LEAST_HOLE_M2 / grid.side**2)
    reasons = {k: words[labels[parts == k][0]] for k in range(parts.max() + 1)}
    slit = np.ones((max(round(SLIT_M / grid.side), 2),) * 2, bool)
    for k, box in enumerate(scipy.ndimage.find_objects(parts + 1)):
        own = parts[box] == k
        if not scipy.ndimage.binary_opening(own, slit).any():
            parts[box][own] = -1  # no room is narrower than a slit
    faces = draw_faces(segments, grid, parts)
    doors = find_doors(edges, lines, grid, parts)
    base = Base(grid, lines, edges, parts, reasons, faces, axes, opening, least_area, doors, {})
    return _form_plan(base, edits)


def _form_plan(base: Base, edits: Sequence[Edit]) -> FloorPlan:
    """Rooms and doors of a plan, after what a person changed."""
    if not isinstance(edits, list | tuple) or not all(isinstance(each, Edit) for each in edits):
        raise ValueError(f"edits must be a list of edits, got {arrays.brief(edits)}")
    sills = np.reshape([one.place for one in base.doors], (-1, 2))
    draft = Draft(base.grid, base.parts, base.faces, base.least_area, sills, base.outlined)
    grid = base.grid
    unplaced = [f"{edit} ({why})" for edit in edits if (why := edit.on_rooms(draft))]
    parts, faces = draft.parts, draft.faces
    old, numbers = np.unique(parts[parts >= 0], return_inverse=True)
    parts[parts >= 0] = numbers
    openings = find_doors(base.edges, base.lines, grid, parts)
    places = np.reshape([one.place for one in openings], (-1, 2))
    rooms = _outline_rooms(base, draft, places)
    for wall, run in draft.pins.items():
        faces.size[run] = length(faces.segments[run])
        without = _outline_rooms(base, draft, places)
        if [room.area for room in without] == [room.area for room in rooms]:
            unplaced.append(f"{wall} (it changes no room)")
        faces.size[run] = np.inf
    order = np.argsort([-room.area for room in rooms], kind="stable")
    number = np.append(np.argsort(order), -1)
    draft.parts = number[parts]
    rooms = [
        replace(rooms[k], name=f"room {n}", reason=base.reasons.get(old[k], "mended by hand"))
        for n, k in enumerate(order, 1)
    ]
    openings = [replace(k, rooms=tuple(sorted(number[[*k.rooms]].tolist()))) for k in openings]
    doors = [one for one in openings if one.rooms[0] >= 0]
    away = [one for one in openings if one.rooms[0] < 0 and grid.seen[grid.squares(one.place)]]
    unplaced += [f"{k} ({why})" for k in edits if (why := k.on_doors(doors, base.doors, draft))]
    for door in doors:
        faces = with_doorway(faces, door.ends) if door.reason == DRAWN else faces
    kind = np.where(draft.parts >= 0, FREE, grid.kind)
    # Free space goes on neither behind a wall nor where no room fits.
    hidden = scipy.ndimage.label(kind == UNKNOWN)[0]
    kind[(np.bincount(hidden.ravel()) * grid.side**2 < base.least_area)[hidden]] = FREE
    kind[grid.on(faces.segments[faces.wall])] = OCCUPIED
    seen = grid._replace(kind=kind)
    unseen = unseen_border(seen, np.where(base.parts >= 0, draft.parts, -1), base.opening)
    plan = FloorPlan(
        *walls_and_clutter(faces), rooms, doors, base.axes, away, unseen,
        tuple(edits), unplaced, base,
    )  # fmt: skip
    for name in [edit for edit in edits if isinstance(edit, Name)]:
        room = int(plan.room_at([name.at])[0])
        if room >= 0:
            rooms[room] = replace(rooms[room], name=name.text)
        else:
            unplaced.append(f"{name} (no room there)")
    return plan


def _outline_rooms(base: Base, draft: Draft, doorways: Array) -> list[Room]:
    """The rooms of squares; those around which no edit changed anything are known."""
    boxes = scipy.ndimage.find_objects(draft.parts + 1)
    rooms = [draft.outline(k, box, doorways) for k, box in enumerate(boxes)]
    return apart(rooms, base.grid, draft.parts)
