"""Open exercises on reduced maps: inputs that fool two methods."""

from __future__ import annotations

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform
from segmap.reduction import basic_online, viewing_sector
from segmap.segments import SegmentMap

from ._open import ROOM, Challenge, metres_away


# ------------------------------------------------------------------------------------- Basic
def _basic_fooled(order: Array) -> str:
    if order.shape != (21,) or not np.array_equal(np.sort(order), np.arange(21)):
        raise ValueError("give each of the numbers 0 to 20 once, in the order of your choice")
    y = 0.1 * order
    shelves = np.stack([np.stack([0 * y, y], 1), np.stack([0 * y + 3, y], 1)], 1)
    count = len(basic_online(SegmentMap(shelves, np.arange(21))))
    return "" if count >= 8 else f"Basic leaves {count} segments, 8 at least are wanted"


break_basic_order = Challenge(
    "break_basic_order(order): an order, (21,), of the shelves 0 to 20 of chapter 14, 0.10 m "
    "apart, one a scan, of which Basic on-line leaves at least 8 segments; from 0 to 20 it leaves "
    "one",
    _basic_fooled,
    praise="The same segments and eight times as many left: the order is part of the result",
)


# ---------------------------------------------------------------------------- viewing sector
SENSOR = (2.0, 1.0)


def _sector_fooled(slip: Array) -> str:
    if slip.shape != (3,):
        raise ValueError(f"give three numbers, metres, metres and degrees, got shape {slip.shape}")
    if np.hypot(*slip[:2]) > 0.12 + 1e-9 or abs(slip[2]) > 1:
        raise ValueError("the pose may err by 0.12 m and by 1 degree at most")
    x, y = SENSOR
    about = transform((x + slip[0], y + slip[1], np.radians(slip[2])), ROOM - SENSOR)
    looks = SegmentMap(np.concatenate([ROOM, about]), np.repeat([0, 1], 4), sensors=[SENSOR] * 2)
    lost = metres_away(ROOM, viewing_sector(looks).segments, 0.05)
    return "" if lost >= 2.5 else f"{lost:.2f} m of the walls are gone, 2.5 m at least are wanted"


break_viewing_sector = Challenge(
    "break_viewing_sector(slip): an error of a pose, [x, y, angle] in metres, metres and degrees, "
    "of at most 0.12 m and 1 degree, so that a second look at `simulation.rectangular_room()` from "
    "(2, 1) removes at least 2.5 m of its walls from the map (default thresholds)",
    _sector_fooled,
    praise="An error just above `distance` is enough: every beam then ends behind a wall that "
    "still stands",
)
