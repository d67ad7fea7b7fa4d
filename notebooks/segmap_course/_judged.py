"""Maps and ways to choose from: `decide_floor`, `decide_way`."""

from __future__ import annotations

from functools import cache

import numpy as np

from segmap import reduction
from segmap.arrays import Array
from segmap.segments import length

from ._known_buildings import known_building


@cache
def ten_maps() -> dict[str, Array]:
    """Maps A to J of the floor whose poses each err by 2 cm: segments `(n, 2, 2)`, metres.

    Examples
    --------
    >>> [len(map) for map in ten_maps().values()]
    [54, 9, 38, 13, 75, 14, 13, 18, 49, 31]
    """
    before = known_building("floor").map
    once = reduction.one_per_wall(before).segments
    return {
        "A": reduction.least_cost(before).segments,
        "B": once[length(once) > 2],
        "C": reduction.fusion(before).segments,
        "D": once + (0.05, 0.03),
        "E": reduction.viewing_sector(before).segments,
        "F": reduction.fusion(before, tolerance=0.2).segments,
        "G": once,
        "H": reduction.weighted_line_fitting(before, gap=1.0).segments,
        "I": reduction.basic_offline(before).segments,
        "J": reduction.mean_shift(before).segments,
    }


#: Ways K to N over the map of chapter 61, from where the robot stands to (2, 7): corners, metres.
FOUR_WAYS = {
    name: np.array([(9.77, 3.28), *corners, (2.0, 7.0)])
    for name, corners in {
        "K": [(9.7, 4.12), (9.5, 4.25), (2.32, 5.85)],
        "L": [(9.88, 3.85), (10, 7), (9.84, 5.82), (9.68, 5.68), (2.28, 5.7), (2.18, 5.8)],
        "M": [(9.88, 3.85), (9.84, 4.18), (9.64, 4.38), (2.28, 5.7), (2.18, 5.8)],
        "N": [
            *((9.88, 3.85), (9.84, 4.18), (9.64, 4.38), (2.28, 5.7), (2.18, 5.8)),
            *((2.1, 6.9), (1.9, 7.7), (2.3, 7.8)),
        ],
    }.items()
}
