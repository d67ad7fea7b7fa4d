"""Quadtree maps for other programs: grey values for map servers, GeoJSON, and SVG."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Quantity, checked
from ..files import write_bytes
from ..quadtree import QuadtreeMap, extent
from ._world import Frame, collection, feature

#: Grey values of classes: free, unknown, occupied.
GREYS = np.array([254, 205, 0], np.uint8)
#: Colour of the outlines of leaves.
OUTLINE_COLOUR = "#0072b2"
#: Their width, pixels.
OUTLINE_PIXELS = 0.6
#: The part of a small leaf that they take at most.
OUTLINE_PART = 0.1
#: Width of a drawing, pixels.
LEAVES_WIDTH_PIXELS = 800
#: A threshold that is checked together with another.
Number = Annotated[float, Quantity("")]


class Classes(NamedTuple):
    """Grey values `(rows, columns)`, row 0 lowest; lower left corner and side of a cell, metres."""

    greys: NDArray[np.uint8]
    left: float
    low: float
    side: float


@checked
def ros_classes(
    map: QuadtreeMap,
    *,
    resolution: float | None = None,
    occupied: Number = 0.5,
    free: Number = 0.25,
) -> Classes:
    """A map as the grey values of ROS' map_server: 254 free, 205 unknown, 0 occupied.

    `segmap_app.files.write_ros_map` writes this grid, with the same parameters.

    It shows the part where something is known; the whole root where nothing is.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.5, size=4, bias=1)
    >>> tree.insert_scan((0.2, 0.2), [(1.2, 0.2)])
    >>> ros_classes(tree).greys[0]
    array([254, 254,   0, 254], dtype=uint8)
    """
    arrays.instance(map, "map", QuadtreeMap)
    if not 0 <= free < 0.5 <= occupied < 1:
        raise ValueError(f"wanted 0 <= free < 0.5 <= occupied < 1, got {free} and {occupied}")
    with map.lock:
        value = map.leaf_occupancy()
        kind = np.select([value > occupied, value <= free], [2.0, 0.0], 1.0)
        is_known = kind != 1 if (kind != 1).any() else None
        grid, x_min, y_min, side = map.rasterize(kind, shown=is_known, resolution=resolution)
    return Classes(GREYS[grid.astype(np.int64)], x_min, y_min, side)


# ------------------------------------------------------------------------- drawings
@checked
def write_geojson(path: str | Path, map: QuadtreeMap, *, world: Frame = Frame()) -> None:
    """Write the leaves of an occupancy above 0.5 as squares, with both counts.

    Coordinates are metres in the map's frame, x before y; the file says so in its `crs`, a local
    reference system. GDAL and QGIS read it; who follows RFC 7946 to the letter takes degrees. With
    a `world` (`segmap_app.files` has some) they are degrees of WGS84, or metres of a grid.

    Examples
    --------
    >>> import json, tempfile
    >>> tree = QuadtreeMap(resolution=0.5, size=4)
    >>> tree.insert_scan((0.2, 0.2), [(1.2, 0.2)])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_geojson(Path(folder) / "it.geojson", tree)
    ...     collection = json.loads((Path(folder) / "it.geojson").read_text())
    >>> collection["features"][0]["geometry"]["coordinates"][0][0]
    [1.0, 0.0]
    """
    with arrays.instance(map, "map", QuadtreeMap).lock:
        value, leaves = map.leaf_occupancy(), map.leaves()
    arrays.instance(world, "world", Frame)
    digits, features = _digits(map.resolution), []
    table = np.stack([*leaves, value], -1)[value > 0.5]
    for x, y, side, vis, occ, occupancy in table.tolist():
        x_min, y_min, x_max, y_max = (round(v, digits) for v in (x, y, x + side, y + side))
        ring = [(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max), (x_min, y_min)]
        corners = world.coordinates(ring).tolist()
        counts: Any = {"occupancy": round(occupancy, 6), "vis": int(vis), "occ": int(occ)}
        features.append(feature("Polygon", [corners], **counts))
    write_bytes(arrays.file(path), collection(features, world).encode("ascii"))


@checked
def write_svg(path: str | Path, map: QuadtreeMap) -> None:
    """Write all leaves as squares of grey, black where occupied; y upwards, units are metres.

    The picture shows where beams ended, with a margin; the other leaves lie beyond its border.

    Outlines are blue, as the thesis draws them: as thin in any building, at most a tenth of a leaf.

    Examples
    --------
    >>> import json, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_svg(Path(folder) / "it.svg", QuadtreeMap(resolution=0.5, size=4))
    ...     (Path(folder) / "it.svg").read_text().count("<path")
    1
    """
    map = deepcopy(arrays.instance(map, "map", QuadtreeMap))  # as it is now
    x_min, y_min, x_max, y_max = extent(map)
    wide, tall = x_max - x_min, y_max - y_min
    thin = OUTLINE_PIXELS * wide / LEAVES_WIDTH_PIXELS
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{LEAVES_WIDTH_PIXELS}" '
        f'height="{LEAVES_WIDTH_PIXELS * tall / wide:.0f}" '
        f'viewBox="{x_min:.9g} {-y_max:.9g} {wide:.9g} {tall:.9g}">\n'
        f'<g transform="scale(1 -1)" stroke="{OUTLINE_COLOUR}" stroke-width="{thin:.6g}">\n'
    )
    text = head + "\n".join(_paths(map, thin / OUTLINE_PART)) + "\n</g>\n</svg>\n"
    write_bytes(arrays.file(path), text.encode("ascii"))


def _paths(map: QuadtreeMap, small: float) -> Iterator[str]:
    """For each grey a path that holds all its squares, and one for each side below `small`.

    Lines of the first have the width of the drawing's, so that none vanishes in a large building;
    those of the others shrink with their squares, so that walls of small leaves stay black.
    """
    x, y, side = (v.round(_digits(map.resolution)) for v in map.leaves()[:3])
    greys = np.rint(255 * (1 - map.leaf_occupancy())).astype(int)
    kinds = np.stack([greys, np.where(side < small, side, 0.0)], -1)
    for kind in np.unique(kinds, axis=0):
        rows = np.stack([x, y, side], -1)[(kinds == kind).all(1)].tolist()
        squares = "".join(f"M{x:.15g} {y:.15g}h{a:.15g}v{a:.15g}h-{a:.15g}z" for x, y, a in rows)
        line = f' stroke-width="{OUTLINE_PART * kind[1]:.6g}"' if kind[1] else ""
        yield f'<path fill="#{3 * f"{int(kind[0]):02x}"}"{line} d="{squares}"/>'


def _digits(resolution: float) -> int:
    """How many decimals keep a thousandth of a cell."""
    return 3 - int(np.floor(np.log10(resolution)))
