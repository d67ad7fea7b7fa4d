"""Maps for programs that draw: GeoJSON and SVG."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ..quadtree import QuadtreeMap, extent
from ._files import write_bytes

#: Outlines of leaves, and their width as a part of the drawing's, which is so many pixels.
BLUE, THIN, WIDTH = "#0072b2", 1 / 2000, 800


def write_geojson(path: str | Path, map: QuadtreeMap, *, occupied: float = 0.5) -> None:
    """Write the occupied leaves as squares, with their occupancy and both counts.

    Coordinates are metres in the map's frame, x before y: GeoJSON programs that take them for
    degrees must be told (QGIS: set the layer's reference system to one in metres).

    Parameters
    ----------
    path : str or Path
    map : QuadtreeMap
    occupied : float
        Leaves of greater occupancy are written.

    Raises
    ------
    ValueError
        For a threshold outside `[0, 1)`.
    OSError
        A folder that does not exist, or cannot be written to.

    Examples
    --------
    >>> import tempfile
    >>> map = QuadtreeMap(resolution=0.5, size=4)
    >>> map.insert_scan((0.2, 0.2), [(1.2, 0.2)])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_geojson(Path(folder) / "it.geojson", map)
    ...     found = json.loads((Path(folder) / "it.geojson").read_text())
    >>> found["features"][0]["geometry"]["coordinates"][0][0]
    [1.0, 0.0]
    """
    if not 0 <= occupied < 1:
        raise ValueError(f"occupied must be at least 0 and below 1, got {occupied}")
    features = list(_features(map, occupied))
    text = json.dumps({"type": "FeatureCollection", "features": features}, separators=(",", ":"))
    write_bytes(Path(path), text.encode("ascii"))


def _features(map: QuadtreeMap, occupied: float) -> Iterator[dict[str, object]]:
    value = map.leaf_occupancy()
    digits = _digits(map.resolution)
    table = np.stack([*map.leaves(), value], -1)[value > occupied]
    for x, y, side, vis, occ, occupancy in table.tolist():
        left, low, right, high = (round(v, digits) for v in (x, y, x + side, y + side))
        ring = [(left, low), (right, low), (right, high), (left, high), (left, low)]
        yield {
            "type": "Feature",
            "properties": {"occupancy": round(occupancy, 6), "vis": int(vis), "occ": int(occ)},
            "geometry": {"type": "Polygon", "coordinates": [ring]},
        }


def write_svg(path: str | Path, map: QuadtreeMap, *, outlines: bool = True) -> None:
    """Write all leaves as squares of grey, black where occupied; y upwards, units are metres.

    The picture shows where beams ended, with a margin; the other leaves lie beyond its border.

    Parameters
    ----------
    path : str or Path
    map : QuadtreeMap
    outlines : bool
        Blue ones, as the thesis draws them.

    Raises
    ------
    OSError
        A folder that does not exist, or cannot be written to.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_svg(Path(folder) / "it.svg", QuadtreeMap(resolution=0.5, size=4))
    ...     (Path(folder) / "it.svg").read_text().count("<path")
    1
    """
    left, low, right, high = extent(map)
    wide, tall = right - left, high - low
    line = f' stroke="{BLUE}" stroke-width="{THIN * wide:.6g}"' if outlines else ""
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" '
        f'height="{WIDTH * tall / wide:.0f}" '
        f'viewBox="{left:.9g} {-high:.9g} {wide:.9g} {tall:.9g}">\n'
        f'<g transform="scale(1 -1)" shape-rendering="crispEdges"{line}>\n'
    )
    text = head + "\n".join(_paths(map)) + "\n</g>\n</svg>\n"
    write_bytes(Path(path), text.encode("ascii"))


def _paths(map: QuadtreeMap) -> Iterator[str]:
    """A path for each grey, that holds all its squares."""
    x, y, side = (v.round(_digits(map.resolution)) for v in map.leaves()[:3])
    greys = np.rint(255 * (1 - map.leaf_occupancy())).astype(int)
    for grey in np.unique(greys).tolist():
        rows = np.stack([x, y, side], -1)[greys == grey].tolist()
        squares = "".join(f"M{x:.15g} {y:.15g}h{a:.15g}v{a:.15g}h-{a:.15g}z" for x, y, a in rows)
        yield f'<path fill="#{3 * f"{grey:02x}"}" d="{squares}"/>'


def _digits(resolution: float) -> int:
    """Decimals that keep a thousandth of a cell."""
    return max(0, 3 - int(np.floor(np.log10(resolution))))
