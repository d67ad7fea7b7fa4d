"""Ways to choose from: `decide_way`."""

from __future__ import annotations

from itertools import chain, product

import numpy as np

from segmap.arrays import Array

#: Parts of ways over the map of chapter 61, corners in metres: out of the room where the robot
#: stands, along the corridor, and into the room of the goal. Which of them are clear is not said.
OUT = (
    [(9.88, 3.85), (9.84, 4.18), (9.64, 4.38)],
    [(10, 3.9), (9.9, 4.6)],
    [(9.7, 4.12), (9.5, 4.25)],
    [(9.88, 3.85), (10, 7), (9.84, 5.82), (9.68, 5.68)],
)
ALONG: tuple[list[tuple[float, float]], ...] = (
    [],
    [(6, 4.6)],
    [(5, 4.2), (3.5, 4.2)],
    [(8.3, 5.4), (6.8, 4.4), (5.3, 5.5), (3.8, 4.4)],
)
INTO = (
    [(2.28, 5.7), (2.18, 5.8)],
    [(2.05, 5.8)],
    [(2.32, 5.85)],
    [(2.28, 5.7), (2.18, 5.8), (2.1, 6.9), (1.8, 7.4)],
)
#: Where the robot stands and where it is sent, and each way that the parts make.
HERE, GOAL = (9.77, 3.28), (2, 7)
WAYS = [np.array([HERE, *chain(*parts), GOAL]) for parts in product(OUT, ALONG, INTO)]


def four_ways(number: int) -> dict[str, Array]:
    """Four ways, K to N, from where the robot of chapter 61 stands to (2, 7): corners, metres.

    Examples
    --------
    >>> {name: len(way) for name, way in four_ways(0).items()}
    {'K': 5, 'L': 6, 'M': 10, 'N': 9}
    """
    drawn = np.random.default_rng(number).choice(len(WAYS), 4, replace=False)
    return dict(zip("KLMN", (WAYS[k] for k in drawn), strict=True))
