"""Exercise of the chapter on angle correspondence: what two segments say together."""

import numpy as np

from ..alignment import match_values
from ..arrays import Array
from ..segments import length, midpoint, point_distance
from ._exercise import Case, Exercise, Mistake

#: Metres: so far that nothing is too far.
ANYWHERE = 1e6


def match_value(u: Array, v: Array, distance: float) -> float:
    """What the library finds for one pair, however far apart."""
    found = match_values(u[None], v[None], distance=distance, far=ANYWHERE, whole=True)
    return float(found[0, 0])


def _covered(u: Array, v: Array) -> float:
    """Length of u that v covers when projected on it."""
    along = (u[1] - u[0]) / length(u)
    low, high = np.sort((v - u[0]) @ along)
    return float(max(0.0, min(high, length(u)) - max(low, 0.0)))


def _mean(u: Array, v: Array) -> float:
    return (_covered(u, v) + _covered(v, u)) / 2


def _directed(u: Array, v: Array) -> float:
    return float(point_distance(v, u).max())


def _fading(apart: float, distance: float) -> float:
    return float(0.95 ** (apart / distance))


def _hausdorff(u: Array, v: Array) -> float:
    return min(_directed(u, v), _directed(v, u))


def _case(words: str, u: list[tuple[float, float]], v: list[tuple[float, float]]) -> Case:
    return Case(words, (np.array(u, float), np.array(v, float), 0.05))


check_match_value = Exercise(
    "match_value",
    "match_value(u, v, distance) -> float, metres: of two segments (2, 2) that do not cross, the "
    "mean of the lengths that they cover of each other, times 0.95 ** (D / distance)",
    match_value,
    (
        _case("two parallel walls", [(0, 0), (2, 0)], [(0, 0.1), (2, 0.1)]),
        _case("a short wall beside a long one", [(0, 0), (4, 0)], [(1, 0.05), (2, 0.1)]),
        _case("the same, exchanged", [(1, 0.05), (2, 0.1)], [(0, 0), (4, 0)]),
        _case("a leaning wall, end points exchanged", [(0, 0), (3, 0)], [(2, 0.8), (1, 0.1)]),
        _case("walls that overlap in part", [(0, 0), (2, 0)], [(1, 0.1), (3, 0.1)]),
        _case("walls beside each other", [(0, 0), (1, 0)], [(2, 0), (3, 0)]),
        _case("two upright walls", [(1, 0), (1, 3)], [(1.05, 2), (1.05, 0.5)]),
    ),
    (
        Mistake(
            "one side",
            lambda u, v, distance: _covered(u, v) * _fading(_hausdorff(u, v), distance),
            "this is the length of u that v covers; take the mean of it and of the length of v "
            "that u covers",
        ),
        Mistake(
            "sum",
            lambda u, v, distance: 2 * match_value(u, v, distance),
            "the mean of both lengths is wanted, not their sum",
        ),
        Mistake(
            "no penalty",
            lambda u, v, distance: _mean(u, v),
            "the length is right; multiply it by 0.95 ** (D / distance)",
        ),
        Mistake(
            "not divided",
            lambda u, v, distance: _mean(u, v) * _fading(_hausdorff(u, v), 1.0),
            "D is measured in units of `distance`: divide it by that",
        ),
        Mistake(
            "larger distance",
            lambda u, v, distance: (
                _mean(u, v) * _fading(max(_directed(u, v), _directed(v, u)), distance)
            ),
            "D is the smaller of the two directed Hausdorff distances (A 2.39), not the larger",
        ),
        Mistake(
            "nearest points",
            lambda u, v, distance: (
                _mean(u, v)
                * _fading(
                    float(min(point_distance(v, u).min(), point_distance(u, v).min())), distance
                )
            ),
            "D asks for the farthest point of one from the other, not for the nearest",
        ),
        Mistake(
            "middles",
            lambda u, v, distance: (
                _mean(u, v) * _fading(float(np.hypot(*(midpoint(u) - midpoint(v)))), distance)
            ),
            "D is measured from the end points of one to the other segment, not between middles",
        ),
        Mistake(
            "negative overlap",
            lambda u, v, distance: _negative(u, v) * _fading(_hausdorff(u, v), distance),
            "two walls beside each other cover nothing: no length is less than 0",
        ),
    ),
)


def _negative(u: Array, v: Array) -> float:
    """The mean of the common lengths, where a gap counts as a negative one."""
    found = 0.0
    for a, b in ((u, v), (v, u)):
        low, high = np.sort((b - a[0]) @ (a[1] - a[0]) / length(a))
        found += float(min(high, length(a)) - max(low, 0.0)) / 2
    return found
