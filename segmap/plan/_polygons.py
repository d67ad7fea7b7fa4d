"""Rooms as polygons: unions of squares whose sides are drawn to the lines of the walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..display import pip_install
from ._cells import LEAST_HOLE_M2, Grid, Mask
from ._lines import Line

#: Slits and spikes that are narrower, metres, are none.
SLIT_M = 0.15
#: Sides of a polygon that lie so near to a line of walls along them, metres, move there.
SNAP_M = 0.13
#: Steps of one square in a side are none, in squares.
SMOOTHED_SQUARES = 1.2
#: Lines are parallel whose normals have at least this product.
PARALLEL = 1 - 1e-9
#: A room reaches half a square beyond its free squares, and a little more, in squares.
GROWN_SQUARES = 0.7


@dataclass(frozen=True, eq=False)
class Room:
    """A room.

    Parameters
    ----------
    name : str
    outline : (n, 2) array, metres
        Its corners, counter-clockwise, the first not repeated.
    holes : list of (m, 2) arrays, metres
        What stands in it from floor to ceiling.
    area : float
        Square metres.
    perimeter : float
        Metres, holes too.
    place : (2,) array, metres
        A point inside.
    reason : str
        What made it a room.
    """

    name: str
    outline: Array
    holes: list[Array]
    area: float
    perimeter: float
    place: Array
    reason: str

    def __repr__(self) -> str:
        return f"Room({self.name!r}, {self.area:.1f} m2, {len(self.outline)} corners)"


def shapely_or_hint() -> Any:
    """The package of polygons, or how to get it."""
    try:
        import shapely
    except ImportError:
        raise ImportError(f"plans need shapely: {pip_install('plan')}") from None
    return shapely


def room_of(own: Mask, box: tuple[slice, ...], lines: list[Line], grid: Grid, why: str) -> Room:
    """The room that holds squares `own` of a part of the grid, without a name."""
    shapely = shapely_or_hint()
    edge = np.diff(own.astype(np.int8), axis=1, prepend=0, append=0)
    (row, left), right = np.nonzero(edge == 1), np.nonzero(edge == -1)[1]
    whole, slit = shapely.union_all(shapely.box(left, row, right, row + 1)), SLIT_M / grid.side / 2
    for by in (slit, -2 * slit, slit + GROWN_SQUARES):
        whole = shapely.buffer(whole, by, join_style="mitre")
    whole = shapely.simplify(whole, SMOOTHED_SQUARES)
    at = (shapely.get_coordinates(whole) + (box[1].start, box[0].start) - 0.5) * grid.side
    at += (grid.origin @ grid.right, grid.origin @ grid.up)
    for k, way in enumerate((grid.right, grid.up)):
        on = [one.offset * c for one in lines if abs(c := one.normal @ way) > PARALLEL]
        off = np.array([*on, np.inf]) - at[:, k, None]
        off = np.take_along_axis(off, abs(off).argmin(1)[:, None], 1)[:, 0]
        at[:, k] += np.where(abs(off) <= SNAP_M, off, 0)
    placed = shapely.simplify(shapely.set_coordinates(whole, at @ [grid.right, grid.up]), grid.side)
    parts = shapely.get_parts(shapely.orient_polygons(shapely.buffer(placed, 0)))
    whole = max(parts, key=lambda part: part.area)
    outline, *holes = (np.array(r.coords)[:-1] for r in (whole.exterior, *whole.interiors))
    holes = [hole for hole in holes if shapely.Polygon(hole).area >= LEAST_HOLE_M2]
    whole = shapely.Polygon(outline, holes)
    place = np.array(whole.representative_point().coords)[0]
    return Room("", outline, holes, whole.area, whole.length, place, why)
