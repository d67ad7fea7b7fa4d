"""Rooms as polygons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..arrays import Array
from ..display import pip_install


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
        The middle of the widest circle in it.
    hidden : float
        Square metres of the area that nobody saw: under furniture, and behind it.
    reason : str
        What made it a room.
    """

    name: str
    outline: Array
    holes: list[Array]
    area: float
    perimeter: float
    place: Array
    hidden: float
    reason: str

    @property
    def polygon(self) -> Any:
        """Its floor, a polygon of shapely."""
        return shapely_or_hint().Polygon(self.outline, self.holes)

    def __repr__(self) -> str:
        return f"Room({self.name!r}, {self.area:.1f} m2, {len(self.outline)} corners)"


def shapely_or_hint() -> Any:
    """The package of polygons, or how to get it."""
    try:
        import shapely
    except ImportError:
        raise ImportError(f"plans need shapely: {pip_install('plan')}") from None
    return shapely
