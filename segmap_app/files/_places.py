"""Where a map lies on the earth: latitude and longitude, or the metres of a grid with a name."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.arrays import LIMIT, Array, Quantity
from segmap.exports import Direction, Frame
from segmap.poses import transform

#: Half the axis of WGS84 through the equator, metres.
WGS84_AXIS_M = 6378137.0
#: The square of its eccentricity.
WGS84_ECCENTRICITY2 = (2 - 1 / 298.257223563) / 298.257223563
#: Decimals of degrees: a hundredth of a millimetre.
DEGREES_DIGITS = 10
#: Decimals of the metres of a grid: a hundredth of a millimetre.
GRID_DIGITS = 5

Far = Annotated[float, Quantity("metres", least=-LIMIT, most=LIMIT)]


@dataclass(frozen=True)
class Earth(Frame):
    """The place of a map's origin on the earth: its coordinates become degrees of WGS84.

    The map is the plane that touches the ellipsoid there: over a kilometre its lengths are right to
    a hundredth of a millimetre.

    Parameters
    ----------
    latitude, longitude : float
        Of the map's (0, 0), degrees to the north and to the east.
    north : float
        Where north is in the map, counter-clockwise from x; by default y points north.

    Examples
    --------
    >>> Earth(52.5, 13.4).coordinates([(0, 0), (0, 1000)]).round(6)
    array([[13.4     , 52.5     ],
           [13.4     , 52.508987]])
    """

    latitude: Annotated[float, Quantity("degrees", least=-90, most=90)]
    longitude: Annotated[float, Quantity("degrees", least=-180, most=180)]
    north: Direction = np.pi / 2

    @property
    def crs(self) -> None:
        """None: degrees of WGS84."""

    def coordinates(self, points: ArrayLike) -> Array:
        """Longitude and latitude, degrees, `(..., 2)`, of points `(..., 2)` of the map, metres."""
        east, north = np.moveaxis(_east_and_north(points, self.north), -1, 0)
        (sin, sin_long), (cos, cos_long) = (
            f(np.radians([self.latitude, self.longitude])) for f in (np.sin, np.cos)
        )
        normal = WGS84_AXIS_M / np.sqrt(
            1 - WGS84_ECCENTRICITY2 * sin**2
        )  # radius of curvature to the east
        outwards = normal * cos - sin * north  # from the axis, in the plane of the meridian
        x, y = outwards * cos_long - east * sin_long, outwards * sin_long + east * cos_long
        z, off = normal * (1 - WGS84_ECCENTRICITY2) * sin + cos * north, np.hypot(x, y)
        # Bowring 1976: near the ellipsoid one step from the reduced latitude is exact
        flat = np.sqrt(1 - WGS84_ECCENTRICITY2)
        reduced = np.arctan2(z, flat * off)
        up = z + WGS84_ECCENTRICITY2 / flat * WGS84_AXIS_M * np.sin(reduced) ** 3
        latitude = np.arctan2(up, off - WGS84_ECCENTRICITY2 * WGS84_AXIS_M * np.cos(reduced) ** 3)
        degrees = np.degrees(np.stack([np.arctan2(y, x), latitude], -1))
        return degrees.round(DEGREES_DIGITS)


@dataclass(frozen=True)
class Grid(Frame):
    """The place of a map's origin in a national grid: its coordinates become metres of that.

    What the grid stretches is not put in: with UTM up to 0.4 mm a metre.

    Parameters
    ----------
    name
        Of a grid in metres: `EPSG:25832` and the like.
    east, northing : float
        Of the map's (0, 0).
    north : float
        Where the grid's north is in the map, counter-clockwise from x; by default y points there.

    Examples
    --------
    >>> Grid("EPSG:25832", 500_000, 5_800_000, north=0.0).coordinates([(0, 0), (3, 1)])
    array([[ 500000., 5800000.],
           [ 499999., 5800003.]])
    """

    name: str
    east: Far
    northing: Far
    north: Direction = np.pi / 2

    def __post_init__(self) -> None:
        if not (isinstance(self.name, str) and re.fullmatch(r"EPSG:[1-9]\d{3,5}", self.name)):
            raise ValueError(
                f"name must be like EPSG:25832, a grid in metres, got {arrays.brief(self.name)}"
            )
        if self.name == "EPSG:4326":
            raise ValueError("name: EPSG:4326 is in degrees, no grid in metres: take Earth")
        super().__post_init__()

    @property
    def crs(self) -> str:
        """The name of the reference system in a file."""
        return self.name.replace("EPSG:", "urn:ogc:def:crs:EPSG::")

    def coordinates(self, points: ArrayLike) -> Array:
        """East and north of points `(..., 2)` of the map, in the grid, metres."""
        return (_east_and_north(points, self.north) + [self.east, self.northing]).round(GRID_DIGITS)


def placed_at(
    place: Sequence[float] | None = None, north: float | None = None, crs: str | None = None
) -> Frame:
    """The frame that the options --place, --north (degrees, else 90) and --crs of a map mean.

    Examples
    --------
    >>> placed_at((500_000, 5_800_000), crs="EPSG:25832")
    Grid(name='EPSG:25832', east=500000.0, northing=5800000.0, north=1.5707963267948966)
    """
    turn = np.radians(arrays.number(90.0 if north is None else north, "north", unit="degrees"))
    if place is None:
        return Frame()
    first, second = arrays.row(place, "place", 2).tolist()
    if crs is not None and abs(first) <= 90 and abs(second) <= 180:
        raise ValueError(
            f"place {first:g} {second:g} looks like degrees, and {crs} takes metres to the east "
            "and north: leave the grid out, or give the place in it"
        )
    try:
        return Earth(first, second, turn) if crs is None else Grid(crs, first, second, turn)
    except ValueError as error:
        swapped = crs is None and 90 < abs(first) <= 180 and abs(second) <= 90
        raise ValueError(f"{error}{'; the latitude comes first' * swapped}") from error


def _east_and_north(points: ArrayLike, north: float) -> Array:
    """Points `(..., 2)` of a map, metres, to the east and to the north of its origin."""
    return transform((0, 0, np.pi / 2 - north), points)
