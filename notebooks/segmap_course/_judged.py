"""Maps, matches and ways to choose from: `decide_floor`, `decide_match`, `decide_way`."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from segmap import reduction
from segmap.alignment import angle_candidates
from segmap.arrays import Array
from segmap.extraction import extract_polylines
from segmap.poses import between, transform
from segmap.readers import load
from segmap.segments import length
from segmap.simulation import square_room

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


class Weighed(NamedTuple):
    """The guess with the longest match of two scans, and what speaks for and against it, metres.

    `match` is the length that agrees, `hidden` what was seen through walls, `next` the longest
    match at another place, `across` the matched wall across the direction that is fixed least.
    """

    match: float
    hidden: float
    next: float
    across: float


@cache
def four_matches() -> dict[str, Weighed]:
    """Pairs of scans P to S: the guess that the length of the match alone would take.

    Examples
    --------
    >>> matches = four_matches()
    >>> max(matches, key=lambda name: matches[name].match)
    'S'
    """
    log = load("malaga")
    ends = [[(-3, 1), (3, 1)], [(-3, -1), (1, -1)], [(1.45, -1), (3, -1)], [(-3, -1), (-3, 1)]]
    others = [[(-1, 1), (5, 1)], [(-1, -1), (0.36, -1)], [(1, -1), (5, -1)], [(5, -1), (5, 1)]]
    stub, square = [[(1, -1), (1, -0.7)]], square_room(4)
    post = np.array([[(0, 0), (8, 0)], [(0, 2), (8, 2)], [(3, 0), (3, 0.2)]])
    malaga, ahead = log[69], log[75]
    slipped, middle = (0.3, -0.2, 0.4), (2.0, 2.0)
    far, near = np.array([*ends, *stub]), np.array([*others, *stub])
    return {
        "P": _weighed(
            extract_polylines(malaga.points()),
            extract_polylines(ahead.points()),
            (malaga.sensor_pose[:2], ahead.sensor_pose[:2]),
        ),
        "Q": _weighed(square, transform(slipped, square), (middle, transform(slipped, middle))),
        "R": _weighed(far, near, ((0.0, 0.0), (2.5, 0.0))),
        "S": _weighed(post, transform(slipped, post), (middle, transform(slipped, middle))),
    }


def _weighed(
    first: ArrayLike, second: ArrayLike, viewpoints: tuple[ArrayLike, ArrayLike]
) -> Weighed:
    rng = np.random.default_rng(1)
    guesses = angle_candidates(first, second, rng=rng, viewpoints=viewpoints)
    best = max(guesses, key=lambda guess: guess.value)
    elsewhere = [0.0]
    for guess in guesses:
        x, y, turn = between(best.pose, guess.pose)
        if np.hypot(x, y) > 0.3 or abs(turn) > 0.2:
            elsewhere.append(guess.value)
    return Weighed(best.value, best.hidden, max(elsewhere), best.wall_across())


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
