"""Ways to choose from: `decide_way`."""

from __future__ import annotations

import numpy as np

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
