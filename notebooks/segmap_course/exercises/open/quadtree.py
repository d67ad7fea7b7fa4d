"""An open exercise on quadtree maps: walls that fade."""

from __future__ import annotations

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap
from segmap.simulation import cast_rays

from ._open import Challenge, admit

#: A beam each half degree, all round.
_BEAMS = np.radians(np.arange(720) / 2)
_REACH = 5.6  #: metres, of these beams


def _ends(walls: Array, pose: Array) -> Array:
    """End points of a scan without noise, in the robot's frame."""
    ranges = cast_rays(walls, pose, _BEAMS, max_range=_REACH)
    far, turn = ranges[np.isfinite(ranges)], _BEAMS[np.isfinite(ranges)]
    return far[:, None] * np.stack([np.cos(turn), np.sin(turn)], -1)


def _mapped(walls: Array, poses: Array, resolution: float) -> QuadtreeMap:
    map = QuadtreeMap(resolution=resolution)
    for pose in poses:
        map.insert_scan(pose[:2], transform(pose, _ends(walls, pose)))
    return map


def _faded(walls: Array, places: Array) -> str:
    poses = np.column_stack([admit(places, "places", 1, 30), np.zeros(len(places))])
    map = _mapped(admit(walls, "walls", 1, 400), poses, 0.05)
    hit = map.leaves().occ > 0
    lost = int((map.leaf_occupancy()[hit] <= 0.5).sum())
    if lost >= 20 and lost >= 0.1 * hit.sum():
        return ""
    words = f"{lost} of {int(hit.sum())} cells that were hit are not occupied"
    return f"{words}, 20 are wanted and a tenth of all"


break_cells = Challenge(
    "break_cells((walls, places)): 1 to 400 walls, (n, 2, 2), and 1 to 30 places of the sensor, "
    "(k, 2), metres, within 20 m of (0, 0). At each place one scan (720 beams, no noise, 5.6 m, "
    "true poses) goes into a map with cells of 5 cm. Of the cells in which beams ended, "
    "20 or more, and a tenth or more, must not be occupied (occupancy 0.5 or less)",
    _faded,
    praise="A cell has one answer for all that is in it: where a part of it stops rays and a part "
    "lets more of them through, the wall in it is gone",
)
