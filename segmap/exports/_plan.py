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
from ..display import pip_install
from ..files import write_bytes
from ..plan import FloorPlan
from ..segments import angle
from ._segments import METRES
from ._sheet import (
    ENDS,
    Paper,
    checked_words,
    labels_of,
    paper_of,
    rings_of,
    room_sides,
    wall_bodies,
    write_sheet,
)
from ._world import Direction, Frame, collection, feature

#: Layers of a drawing: index of the colour, and width of lines, hundredths of a millimetre.
LAYERS = {"WALLS": (7, 50), "CLUTTER": (9, 18), "DOORS": (1, 35), "ROOMS": (5, 13), "TEXT": (7, 18)}


@checked
def write_plan(
    path: str | Path,
    plan: FloorPlan,
    *,
    title: str = "",
    verdict: str = "",
    date: str = "",
    source: str = "",
    north: Direction | None = None,
    world: Frame = Frame(),
    as_recorded: bool = False,
) -> None:
    """Write a floor plan in the format that the name asks for.

    - `.pdf`, `.svg`, `.png`: a sheet to print, as `write_sheet`, with names, areas and sides of the
      rooms and the widths of the doors.
    - `.dxf`: a drawing in metres (R2010) with the layers WALLS, CLUTTER, DOORS, ROOMS and
      TEXT: walls whose other face was seen and rooms as closed outlines, doors as blocks. It
      stands as the sheet does, and its words are those of the sheet at the scale of the sheet.
    - `.geojson`: rooms as polygons, doors as points, walls and clutter as lines, each with
      its `kind`, and with the keys of OpenStreetMap's Simple Indoor Tagging; a room whose name says
      so is a corridor.
    - `.csv`: a table of the rooms: name, area, what of it furniture hides, perimeter, sides along
      the axes, doors.

    Parameters
    ----------
    title, verdict, date, source, north, as_recorded
        What a sheet says, and how sheet and drawing stand, as in `write_sheet`.
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
    checked_words(title, verdict, date, source)
    end = place.suffix.lower()
    if end in ENDS:
        words: Any = {"title": title, "verdict": verdict, "date": date, "source": source}
        write_sheet(place, plan.walls, **words, north=north, plan=plan, as_recorded=as_recorded)
    elif end == ".dxf":
        drawing = _dxf_plan(plan, paper_of(plan.walls.segments, plan, as_recorded))
        write_bytes(place, drawing.encode())
    elif end in PLAN_WRITERS:
        write_bytes(place, "".join(PLAN_WRITERS[end](plan, world)).encode())
    else:
        endings = ", ".join([*ENDS, ".dxf", *PLAN_WRITERS])
        raise ValueError(f"path: the name must end in {endings}, got {place.name!r}")


def _csv_rooms(plan: FloorPlan, world: Frame) -> Iterator[str]:
    stream = io.StringIO()
    rows = csv.writer(stream, lineterminator="\n")
    names = ("area_m2", "hidden_m2", "perimeter_m", "length_m", "width_m")
    rows.writerow(["name", *names, "doors"])
    for k, room in enumerate(plan.rooms):
        sizes = room.area, room.hidden, room.perimeter, *room_sides(plan, room)
        doors = sum(k in door.rooms for door in plan.doors)
        rows.writerow([room.name, *(f"{size:.2f}" for size in sizes), doors])
    yield stream.getvalue()


def _geojson_plan(plan: FloorPlan, world: Frame) -> Iterator[str]:
    def part(kind: str, geometry: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
        properties = {"level": "0", **INDOOR.get(kind, {}), **properties}
        return feature(geometry, coordinates, kind=kind, **properties)

    def ring(corners: Array) -> Any:
        return world.coordinates(np.concatenate([corners, corners[:1]])).tolist()

    features = [
        part("room", "Polygon", [ring(room.outline), *(ring(hole[::-1]) for hole in room.holes)],
                name=room.name, **(CORRIDOR if "corridor" in room.name.lower() else {}),
                area=round(room.area, 3), hidden=round(room.hidden, 3),
                perimeter=round(room.perimeter, 3))
        for room in plan.rooms
    ]  # fmt: skip
    features += [
        part("door", "Point", world.coordinates(door.place).tolist(),
                width=round(door.width, 3),
                rooms=[plan.rooms[k].name for k in door.rooms if k >= 0])
        for door in plan.doors
    ]  # fmt: skip
    for kind, segments in (("wall", plan.walls.segments), ("clutter", plan.clutter.segments)):
        lines = world.coordinates(segments).tolist()
        features += [part(kind, "LineString", ends) for ends in lines]
    yield collection(features, world)


def _dxf_plan(plan: FloorPlan, paper: Paper) -> str:
    """Closed outlines of walls and rooms, doors as blocks of a unit width, words of the sheet."""
    ezdxf, stream = ezdxf_or_hint(), io.StringIO()
    drawing = ezdxf.new("R2010", units=METRES)
    for layer, (color, weight) in LAYERS.items():
        drawing.layers.add(layer, color=color, lineweight=weight)
    gap = drawing.blocks.new("DOOR")
    gap.add_line((-0.5, 0), (0.5, 0))
    space = drawing.modelspace()
    bodies, faces = wall_bodies(plan)
    for layer, parts in {"WALLS": bodies, "ROOMS": [room.polygon for room in plan.rooms]}.items():
        for ring in [ring for part in parts for ring in rings_of(part)]:
            corners = paper.turned(ring).tolist()
            space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    for layer, segments in (("WALLS", faces), ("CLUTTER", plan.clutter.segments)):
        for start, end in paper.turned(segments).tolist():
            space.add_line(start, end, dxfattribs={"layer": layer})
    for door in plan.doors:
        turn = np.degrees(float(angle(door.ends[None])[0]) + paper.turn)
        size = {"xscale": door.width, "yscale": door.width, "rotation": turn, "layer": "DOORS"}
        space.add_blockref("DOOR", paper.turned(door.place).tolist(), dxfattribs=size)
    for label in labels_of(plan, paper):
        if label.leader is not None:
            space.add_line(*paper.metres(label.leader).tolist(), dxfattribs={"layer": "TEXT"})
        height = label.letters * paper.scale / 1000
        for words, middle in label.lines():
            text = space.add_text(words, height=height, dxfattribs={"layer": "TEXT"})
            aligned = ezdxf.enums.TextEntityAlignment.MIDDLE_CENTER
            text.set_placement(paper.metres(middle).tolist(), align=aligned)
    drawing.write(stream)
    return stream.getvalue()


def ezdxf_or_hint() -> Any:
    """The package of drawings, set so that the same plan gives the same file; or how to get it."""
    try:
        import ezdxf
        import ezdxf.enums
    except ImportError:
        raise ImportError(f"drawings of plans need ezdxf: {pip_install('plan')}") from None
    ezdxf_options: Any = vars(ezdxf)["options"]
    ezdxf_options.write_fixed_meta_data_for_testing = True
    return ezdxf


#: Keys of Simple Indoor Tagging, by the kind of a feature.
INDOOR = {"room": {"indoor": "room"}, "wall": {"indoor": "wall"}, "door": {"door": "yes"}}
CORRIDOR = {"indoor": "corridor"}
#: Formats that are text, by the end of their name.
PLAN_WRITERS: dict[str, Callable[[FloorPlan, Frame], Iterator[str]]] = {
    ".geojson": _geojson_plan, ".csv": _csv_rooms,
}  # fmt: skip
