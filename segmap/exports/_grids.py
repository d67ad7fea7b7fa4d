"""Grids for robots: the PGM and YAML that ROS' map_server reads."""

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..quadtree import QuadtreeMap
from ._files import write_bytes

#: Grey values of classes: free, unknown, occupied.
GREYS = np.array([254, 205, 0], np.uint8)
#: What the YAML states for `(255 - grey) / 255`: 205 lies between the two.
OCCUPIED_THRESH, FREE_THRESH = 0.65, 0.196


class Classes(NamedTuple):
    """Grey values `(rows, columns)`, row 0 lowest; lower left corner and side of a cell, metres.

    Examples
    --------
    >>> ros_classes(QuadtreeMap(resolution=0.5, size=2)).side
    0.5
    """

    greys: NDArray[np.uint8]
    left: float
    low: float
    side: float


def ros_classes(
    map: QuadtreeMap,
    *,
    resolution: float | None = None,
    occupied: float = 0.5,
    free: float = 0.25,
) -> Classes:
    """What `write_ros_map` writes: 254 free, 205 unknown, 0 occupied.

    Parameters
    ----------
    map : QuadtreeMap
    resolution, occupied, free
        As there.

    Returns
    -------
    Classes
        Of the part where something is known; the whole root where nothing is. Greys are
        a (rows, columns) array; corner and side in metres.

    Raises
    ------
    ValueError
        For thresholds out of order, a resolution that does not fit.

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.5, size=4, bias=1)
    >>> map.insert_scan((0.2, 0.2), [(1.2, 0.2)])
    >>> ros_classes(map).greys[0]
    array([254, 254,   0, 254], dtype=uint8)
    """
    if not 0 <= free < 0.5 <= occupied < 1:
        raise ValueError(f"wanted 0 <= free < 0.5 <= occupied < 1, got {free} and {occupied}")
    value = map.leaf_occupancy()
    kind = np.select([value > occupied, value <= free], [2.0, 0.0], 1.0)
    known = kind != 1 if (kind != 1).any() else None
    grid, left, low, side = map.rasterize(kind, shown=known, resolution=resolution)
    return Classes(GREYS[grid.astype(np.int64)], left, low, side)


def write_ros_map(
    path: str | Path,
    map: QuadtreeMap,
    *,
    resolution: float | None = None,
    occupied: float = 0.5,
    free: float = 0.25,
) -> None:
    """Write a map for ROS: a YAML and, beside it, a PGM of the same name.

    White (254) is free, grey (205) unknown, black (0) occupied; row 0 of the picture is the top,
    `origin` the lower left corner of its lower left pixel. Only the part where something is known
    is written.

    Parameters
    ----------
    path : str or Path
        Of the YAML; must end in `.yaml`.
    map : QuadtreeMap
    resolution : float, metres, or None
        Side of a pixel: the map's own by default, or this times a power of two. A pixel that holds
        several cells is occupied where one is, and free where all are.
    occupied : float
        Cells of greater occupancy are occupied.
    free : float
        Cells of at most this occupancy are free: by default those that half the `bias` crossed.

    Raises
    ------
    ValueError
        For another name, thresholds out of order, a resolution that does not fit.
    OSError
        A folder that does not exist, or cannot be written to.

    Notes
    -----
    The picture comes first, so that a new YAML never names a picture that is not there.

    Examples
    --------
    >>> import tempfile
    >>> map = QuadtreeMap(resolution=0.5, size=4, bias=1)
    >>> map.insert_scan((0.2, 0.2), [(1.2, 0.2)], [(0.2, 1.2)] * 2)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_ros_map(Path(folder) / "it.yaml", map)
    ...     print((Path(folder) / "it.yaml").read_text().splitlines()[0])
    image: "it.pgm"
    """
    place = Path(path)
    if place.suffix != ".yaml":
        raise ValueError(f"the name must end in .yaml, got {place.name!r}")
    found = ros_classes(map, resolution=resolution, occupied=occupied, free=free)
    rows, columns = found.greys.shape
    picture, pixels = place.with_suffix(".pgm"), np.flipud(found.greys).tobytes()
    write_bytes(picture, f"P5\n{columns} {rows}\n255\n".encode("ascii") + pixels)
    thresholds = f"free: occupancy <= {free:g}, occupied: occupancy > {occupied:g}"
    lines = [
        f"image: {json.dumps(picture.name, ensure_ascii=False)}",
        f"resolution: {_number(found.side)}",
        f"origin: [{_number(found.left)}, {_number(found.low)}, 0.0]",
        "negate: 0",
        f"occupied_thresh: {OCCUPIED_THRESH}",
        f"free_thresh: {FREE_THRESH}",
        "mode: trinary",
        f"# {thresholds}, else unknown; bias {map.bias}",
    ]
    write_bytes(place, "".join(f"{line}\n" for line in lines).encode())


def _number(value: float) -> str:
    """A number that every YAML reader takes for one: without a point, 1e-05 is a word to some."""
    mantissa, mark, power = repr(value).partition("e")
    return mantissa + (".0" if mark and "." not in mantissa else "") + mark + power
