"""Floor plans for other programs: sheets to print, drawings in layers, geometries, tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .. import arrays
from ..arrays import Array, checked
from ..files import write_bytes
from ..plan import FloorPlan
from ._segments import METRES, dxf_tags
from ._sheet import ENDS, checked_words, room_sides, write_sheet
from ._world import Direction, Frame, collection

#: Height of letters in a drawing, metres.
LETTER_M = 0.25


@checked
def write_plan(
    path: str | Path,
    plan: FloorPlan,
    *,
    title: str = "",
    verdict: str = "",
    date: str = "",
    north: Direction | None = None,
    world: Frame = Frame(),
) -> None:
    """Write a floor plan in the format that the name asks for.

    - `.pdf`, `.svg`, `.png`: a sheet to print, as `write_sheet`, with names, areas and sides of the
      rooms and the widths of the doors.
    - `.dxf`: a drawing in metres with the layers WALLS, CLUTTER, DOORS, ROOMS and TEXT.
    - `.geojson`: rooms as polygons, doors as points, walls and clutter as lines, each with
      its `kind`.
    - `.csv`: a table of the rooms: name, area, what of it furniture hides, perimeter, sides along
      the axes, doors.

    Parameters
    ----------
    title, verdict, date, north
        What a sheet says, as in `write_sheet`.
    world
        As in `write_segments`, for GeoJSON.

    Examples
    --------
    >>> import tempfile
    >>> from segmap import plan, quadtree
    >>> walls = [[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]]
    >>> free = quadtree.map_of_grid(np.ones((60, 80)), resolution=0.05)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "rooms.csv"
    ...     write_plan(path, plan.floor_plan(walls, free))
    ...     print(path.read_text(), end="")
    name,area_m2,hidden_m2,perimeter_m,length_m,width_m,doors
    room 1,12.00,0.00,14.00,4.00,3.00,0
    """
    place = arrays.file(path)
    arrays.instance(plan, "plan", FloorPlan)
    arrays.instance(world, "world", Frame)
    checked_words(title, verdict, date)
    end = place.suffix.lower()
    if end in ENDS:
        write_sheet(
            place, plan.walls, title=title, verdict=verdict, date=date, north=north, plan=plan
        )
    elif end in PLAN_WRITERS:
        write_bytes(place, "".join(PLAN_WRITERS[end](plan, world)).encode())
    else:
        known = ", ".join([*ENDS, *PLAN_WRITERS])
        raise ValueError(f"path: the name must end in {known}, got {place.name!r}")


def _csv_rooms(plan: FloorPlan, world: Frame) -> Iterator[str]:
    kept = io.StringIO()
    rows = csv.writer(kept, lineterminator="\n")
    names = ("area_m2", "hidden_m2", "perimeter_m", "length_m", "width_m")
    rows.writerow(["name", *names, "doors"])
    for k, room in enumerate(plan.rooms):
        sizes = room.area, room.hidden, room.perimeter, *room_sides(plan, room)
        doors = sum(k in door.rooms for door in plan.doors)
        rows.writerow([room.name, *(f"{size:.2f}" for size in sizes), doors])
    yield kept.getvalue()


def _geojson_plan(plan: FloorPlan, world: Frame) -> Iterator[str]:
    def feature(kind: str, geometry: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
        placed = {"type": geometry, "coordinates": coordinates}
        return {"type": "Feature", "properties": {"kind": kind, **properties}, "geometry": placed}

    def ring(corners: Array) -> Any:
        return world.coordinates(np.concatenate([corners, corners[:1]])).tolist()

    features = [
        feature("room", "Polygon", [ring(room.outline), *(ring(hole[::-1]) for hole in room.holes)],
                name=room.name, area=round(room.area, 3), hidden=round(room.hidden, 3),
                perimeter=round(room.perimeter, 3))
        for room in plan.rooms
    ]  # fmt: skip
    features += [
        feature("door", "Point", world.coordinates(door.place).tolist(),
                width=round(door.width, 3), rooms=[plan.rooms[k].name for k in door.rooms])
        for door in plan.doors
    ]  # fmt: skip
    for kind, segments in (("wall", plan.walls.segments), ("clutter", plan.clutter.segments)):
        lines = world.coordinates(segments).tolist()
        features += [feature(kind, "LineString", ends) for ends in lines]
    yield collection(features, world)


def _dxf_plan(plan: FloorPlan, world: Frame) -> Iterator[str]:
    yield dxf_tags((0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"))
    yield dxf_tags((9, "$INSUNITS"), (70, METRES), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES"))
    lines = {"WALLS": plan.walls.segments, "CLUTTER": plan.clutter.segments}
    lines["DOORS"] = np.reshape([door.ends for door in plan.doors], (-1, 2, 2))
    for layer, segments in lines.items():
        for a, b, c, d in segments.reshape(-1, 4).tolist():
            start, end = ((10, a), (20, b), (30, 0.0)), ((11, c), (21, d), (31, 0.0))
            yield dxf_tags((0, "LINE"), (8, layer), *start, *end)
    for room in plan.rooms:
        for corners in (room.outline, *room.holes):
            yield dxf_tags((0, "POLYLINE"), (8, "ROOMS"), (66, 1), (70, 1))
            for x, y in corners.tolist():
                yield dxf_tags((0, "VERTEX"), (8, "ROOMS"), (10, x), (20, y), (30, 0.0))
            yield dxf_tags((0, "SEQEND"), (8, "ROOMS"))
        x, y = room.place.tolist()
        words = "".join(
            c if c.isascii() else f"\\U+{ord(c):04X}" for c in f"{room.name}, {room.area:.1f} m2"
        )
        text = (10, x), (20, y), (30, 0.0), (40, LETTER_M), (1, " ".join(words.split()))
        yield dxf_tags((0, "TEXT"), (8, "TEXT"), *text)
    yield dxf_tags((0, "ENDSEC"), (0, "EOF"))


#: Formats that are text, by the end of their name.
PLAN_WRITERS: dict[str, Callable[[FloorPlan, Frame], Iterator[str]]] = {
    ".dxf": _dxf_plan, ".geojson": _geojson_plan, ".csv": _csv_rooms,
}  # fmt: skip
