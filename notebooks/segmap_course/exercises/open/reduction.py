"""Open exercises on reduced maps: what Fusion leaves, and inputs that fool three methods."""

from __future__ import annotations

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform
from segmap.reduction import basic_online, fusion, viewing_sector
from segmap.segments import SegmentMap, length, point_distance

from ._open import ROOM, Challenge, Prediction, admit, malaga, metres_away, samples

predict_fusion_left = Prediction(
    "predict_fusion_left(guess): how many of the 1227 segments of the Malaga map Fusion leaves "
    "with a tolerance of 15 mm; within a tenth",
    lambda: len(fusion(malaga(), tolerance=0.015)),
    "segments",
    factor=1.1,
    because="Fusion leaves 649 at 10 mm and 412 at 20 mm, and the curve is steeper on the left",
)

predict_fusion_twice = Prediction(
    "predict_fusion_twice(guess): how many segments Fusion leaves at its default tolerance, 40 mm, "
    "of the Malaga map in which each of the 1227 segments stands twice; the number itself",
    lambda: len(fusion(np.repeat(malaga(), 2, axis=0))),
    "segments",
    because="A copy lies in each strip that holds its original, and all chains become twice as "
    "long, so the longest one stays the longest",
)


# ------------------------------------------------------------------------------------ Fusion
def _fusion_fooled(walls: Array) -> str:
    admit(walls, "walls", 2, 20, within=100, of="the origin")
    if length(walls).min() < 1:
        raise ValueError(f"a wall is {length(walls).min():.2f} m long, 1 m at least is wanted")
    away = point_distance(samples(walls)[:, :, None], walls).min(axis=0)
    if (gap := (away + np.diag(np.full(len(walls), np.inf))).min()) < 0.07 - 1e-9:
        raise ValueError(f"two walls are only {1000 * gap:.3g} mm apart, 70 mm are wanted")
    count = len(fusion(walls, tolerance=0.04))
    return "" if count == 1 else f"Fusion leaves {count} of the {len(walls)} walls, not one"


break_fusion = Challenge(
    "break_fusion(walls): 2 to 20 different walls, (n, 2, 2) in metres, each at least 1 m long and "
    "every two at least 70 mm apart, of which Fusion leaves one with its tolerance of 40 mm",
    _fusion_fooled,
    praise="The strip is two tolerances wide: both faces of a partition thinner than that are one",
)


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
