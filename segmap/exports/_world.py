"""In what coordinates a map is written."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Quantity, Settings

#: A plane in metres that lies nowhere on the earth. GDAL, and so QGIS, takes this text for the name
#: of a reference system; where none is named it takes metres for degrees.
LOCAL = 'LOCAL_CS["frame of the map",UNIT["metre",1],AXIS["x",EAST],AXIS["y",NORTH]]'

Direction = Annotated[float, Quantity("radians", least=-2 * np.pi, most=2 * np.pi)]


@dataclass(frozen=True)
class Frame(Settings):
    """In what coordinates a map is written: here in the metres of its own frame."""

    @property
    def crs(self) -> str | None:
        """The name of the reference system; None for degrees of WGS84, which RFC 7946 takes."""
        return LOCAL

    def coordinates(self, points: ArrayLike) -> Array:
        """Coordinates `(..., 2)` of points `(..., 2)` of the map, metres."""
        return arrays.with_axes(points, "points", 2)


def feature(geometry: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    """A feature of GeoJSON."""
    placed = {"type": geometry, "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": placed}


def collection(features: Sequence[object], world: Frame) -> str:
    """The text of a GeoJSON file, which names the reference system of its coordinates."""
    crs = {"crs": {"type": "name", "properties": {"name": world.crs}}} if world.crs else {}
    document = {"type": "FeatureCollection"} | crs | {"features": features}
    return json.dumps(document, separators=(",", ":"))
