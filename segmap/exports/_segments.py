"""Segment maps for other programs: CSV, DXF, SVG, GeoJSON, WKT."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from .. import arrays
from ..arrays import Array, Segments
from ..files import write_bytes
from ..segments import SegmentMap
from ._world import Frame, collection, feature

#: Largest side of a drawing, pixels.
DRAWING_PIXELS = 800
#: Width of its lines, pixels.
WALL_PIXELS = 1.5
#: Its margin as a part of that side.
DRAWING_MARGIN = 0.02
#: Metres in the header of a DXF file.
METRES = 6


def write_segments(path: str | Path, map: Segments, *, world: Frame = Frame()) -> None:
    """Write a map of segments in the format that the name asks for.

    - `.csv`: a table `x1,y1,x2,y2,scan`, with as many digits (up to 17) as `readers.read_segments`
      needs to find the same numbers, bit for bit.
    - `.npz`: as `SegmentMap.save`, with the points and sensors that the map keeps.
    - `.svg`: a drawing, y upwards, units are metres, those of the lines' width too.
    - `.geojson`: LineStrings with the property `scan`, x before y, metres in the map's frame. Its
      `crs` names a local reference system, which GDAL and QGIS read; who follows RFC 7946 to the
      letter takes degrees. With a `world` (`segmap_app.files` has some) it is in degrees
      of WGS84, or in metres of a grid; the other formats stay in the map's frame.
    - `.wkt`: one line, a MULTILINESTRING, which `shapely.from_wkt` and QGIS take.
    - `.dxf`: a drawing of LINEs on layer 0, in metres, of the version R12 that every program reads;
      a segment without length is left out.

    All but `.npz` are packed where `.gz` follows. The last four are for other programs: this one
    reads the first two.

    Segments of a reduction come from many scans, and those of an array from none that is known:
    their `scan` is written as 0.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "walls.csv"
    ...     write_segments(path, [[(0, 0), (1.5, 0.1)]])
    ...     print(path.read_text(), end="")
    x1,y1,x2,y2,scan
    0.0,0.0,1.5,0.1,0
    """
    place = arrays.file(path)
    name = place.name.removesuffix(".gz")
    end = Path(name).suffix.lower()
    segment_map = map if isinstance(map, SegmentMap) else SegmentMap(arrays.segments(map, "map"))
    arrays.instance(world, "world", Frame)
    if end == ".npz" and name == place.name:
        segment_map.save(place)
    elif end in TEXT_WRITERS:
        write_bytes(place, "".join(TEXT_WRITERS[end](segment_map, world)).encode("ascii"))
    else:
        endings = ", ".join([*TEXT_WRITERS, *(f"{each}.gz" for each in TEXT_WRITERS)])
        raise ValueError(f"path: the name must end in .npz, {endings}, got {place.name!r}")


# ------------------------------------------------------------------------------ formats
def _rows(map: SegmentMap) -> list[list[float]]:
    """x and y of both ends of each segment, metres."""
    rows: list[list[float]] = map.segments.reshape(-1, 4).tolist()
    return rows


def _csv_lines(map: SegmentMap, world: Frame) -> Iterator[str]:
    yield "x1,y1,x2,y2,scan\n"
    for row, scan in zip(_rows(map), map.scan.tolist(), strict=True):
        yield ",".join([*(repr(value) for value in row), f"{scan}\n"])


def _geojson(map: SegmentMap, world: Frame) -> Iterator[str]:
    placed = world.coordinates(map.segments)
    features = [
        feature("LineString", ends, scan=scan)
        for ends, scan in zip(placed.tolist(), map.scan.tolist(), strict=True)
    ]
    yield collection(features, world)


def _wkt(map: SegmentMap, world: Frame) -> Iterator[str]:
    parts = [f"({a!r} {b!r}, {c!r} {d!r})" for a, b, c, d in _rows(map)]
    yield f"MULTILINESTRING {'(' + ', '.join(parts) + ')' if parts else 'EMPTY'}\n"


def _dxf(map: SegmentMap, world: Frame) -> Iterator[str]:
    yield dxf_tags((0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"))
    yield dxf_tags((9, "$INSUNITS"), (70, METRES), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES"))
    for a, b, c, d in _rows(map):
        if (a, b) != (c, d):
            start, end = ((10, a), (20, b), (30, 0.0)), ((11, c), (21, d), (31, 0.0))
            yield dxf_tags((0, "LINE"), (8, "0"), *start, *end)
    yield dxf_tags((0, "ENDSEC"), (0, "EOF"))


def dxf_tags(*pairs: tuple[int, str | int | float]) -> str:
    """Lines of a DXF file: a code, and its value."""
    return "".join(f"{code}\n{value}\n" for code, value in pairs)


def _svg(map: SegmentMap, world: Frame) -> Iterator[str]:
    (x_min, y_min), (wide, tall) = _drawing_frame(map.segments)
    scale = DRAWING_PIXELS / max(wide, tall)
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{scale * wide:.0f}" '
        f'height="{scale * tall:.0f}" viewBox="{x_min!r} {-y_min - tall!r} {wide!r} {tall!r}">\n'
        f'<g transform="scale(1 -1)" stroke="#000000" stroke-width="{WALL_PIXELS / scale:.6g}" '
        'stroke-linecap="round">\n'
    )
    for a, b, c, d in _rows(map):
        yield f'<line x1="{a!r}" y1="{b!r}" x2="{c!r}" y2="{d!r}"/>\n'
    yield "</g>\n</svg>\n"


def _drawing_frame(segments: Array) -> tuple[list[float], list[float]]:
    """Lower left corner and sides of what a drawing shows, metres: never nothing."""
    ends = segments.reshape(-1, 2) if len(segments) else np.zeros((1, 2))
    low, high = ends.min(0), ends.max(0)
    room = DRAWING_MARGIN * max((high - low).max(), 1.0)
    return (low - room).tolist(), (high - low + 2 * room).tolist()


#: Formats that are text, by the end of their name; GeoJSON alone asks where the map lies.
TEXT_WRITERS: dict[str, Callable[[SegmentMap, Frame], Iterator[str]]] = {
    ".csv": _csv_lines, ".svg": _svg, ".geojson": _geojson, ".wkt": _wkt, ".dxf": _dxf,
}  # fmt: skip
