"""Exercises on Basic, Hybrid, similarity: what matches, from where, and how much a look counts."""

from __future__ import annotations

from typing import Any

import numpy as np

from segmap.angles import axial_difference
from segmap.arrays import Array
from segmap.poses import transform
from segmap.segments import angle, length, midpoint

from ..literal.lines import SAME, point_to_segment
from ..literal.reduction import basic, hybrid
from ..literal.reduction.segment_similarity import mean_segment
from ._answers import Cases, same_segment
from ._exercise import Exercise, Rng, anywhere, edited


def _wall(middle: tuple[float, float], size: float, degrees: float) -> Array:
    """A segment (2, 2) about its middle."""
    half = size / 2 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    return np.array([middle - half, middle + half])


# ---------------------------------------------------------------------------- a match
def _pairs(rng: Rng) -> Cases:
    """Pairs that match and pairs that fail one of the tests, placed anywhere where that is safe."""
    place, shift = anywhere(rng), rng.integers(-8, 9, 2) / 4
    size, lean = rng.uniform(1.5, 3), rng.uniform(3, 7)
    limits = 0.25, np.radians(rng.uniform(8, 12))
    flat, low, high = (_wall((-size / 2, 0), size, d) for d in (0, 1, 179))
    next_to = _wall((1.1, 0), 2, lean)

    def placed(a: Array, b: Array, *given: float) -> tuple[Any, ...]:
        return transform(place, a), transform(place, b), *(given or limits)

    corner = _wall((0, size / 2), size, 90)

    def joined(gap: float, turn: float) -> Array:
        """A wall that begins so far behind the end of `flat`, turned by so much."""
        c, s = np.cos(turn), np.sin(turn)
        return np.array([(gap, 0), (gap + size * c, size * s)])

    border = np.array([[(0.0, 0), (2, 0)], [(2.25, 0), (4, 0)]]) + shift
    return {
        "end to end on one wall": placed(flat, next_to),
        "the same, with swapped ends": placed(flat, next_to[::-1]),
        "walls at 1 and 179 degrees": (low + shift, high + (size, 0) + shift, *limits),
        "a corner": placed(flat, corner),
        "a corner, to 1 degree": placed(flat, corner, 0.25, np.radians(1)),
        "a piece beside the middle of a wall": placed(flat, _wall((-size / 2, 0.02), size / 3, 0)),
        "a wall behind the piece in its middle": placed(
            _wall((-size / 2, 0.02), size / 3, 0), flat
        ),
        "two walls that begin together": placed(flat, _wall((0, 0.1), 2 * size, 0)),
        "a turn a little too large": placed(flat, joined(0.1, 1.5 * limits[1])),
        "a turn that is just small enough": placed(flat, joined(0.1, -0.8 * limits[1])),
        "a gap a little too wide": placed(flat, joined(0.375, 0)),
        "a gap that is just small enough": placed(flat, joined(0.2, 0)),
        "walls turned by 30 degrees": placed(flat, _wall((0.75, 0.4), 1.6, 30)),
        "ends exactly 0.25 m apart": (*border, *limits),
        "middles that meet and ends that do not": placed(flat, _wall((-size / 2, 0), size + 2, 2)),
    }


def _matches(a: Array, b: Array, distance: float, angle: float) -> bool:
    return _near(a, b, distance) and _turn(a, b) < angle - SAME


def _gaps(a: Array, b: Array) -> Array:
    """Distances of the four ends from the other segment, `(2, 2)`, metres: a from b, b from a."""
    pairs = ((a, b), (b, a))
    return np.array([[point_to_segment(p, t.tolist()) for p in s.tolist()] for s, t in pairs])


def _turn(a: Array, b: Array) -> float:
    return float(abs(axial_difference(angle(a), angle(b))))


def _directed_turn(a: Array, b: Array) -> float:
    (ax, ay), (bx, by) = a[1] - a[0], b[1] - b[0]
    return float(abs(np.arctan2(ay, ax) - np.arctan2(by, bx)))


def _near(a: Array, b: Array, distance: float) -> bool:
    return bool(_gaps(a, b).min() < distance - SAME)


def _by_ends(a: Array, b: Array, distance: float, angle: float) -> bool:
    """The chapter's own match."""
    return basic.match(a.tolist(), b.tolist(), distance, angle)


check_matches = Exercise(
    "matches(a, b, distance, angle) -> bool: whether some end point of one of two segments (2, 2) "
    "is closer than distance, metres, to any point of the other, and their lines differ by less "
    "than angle, radians",
    _matches,
    _pairs,
    {
        "this is the match of the chapter, which looks at end points alone: a piece beside the "
        "middle of a wall is near to the wall, too": _by_ends,
        "lines have no direction: 1 and 179 degrees lie 2 degrees apart, use axial_difference": (
            lambda a, b, d, t: _near(a, b, d) and abs(angle(a) - angle(b)) < t
        ),
        "swapping the end points must change nothing: segments have no direction": (
            lambda a, b, d, t: _near(a, b, d) and _directed_turn(a, b) < t
        ),
        "angle is in radians: compare radians with radians": (
            lambda a, b, d, t: _near(a, b, d) and np.degrees(_turn(a, b)) < t
        ),
        "angle is in radians already: this lets nearly every turn through": (
            lambda a, b, d, t: _near(a, b, d) and _turn(a, b) < np.degrees(t)
        ),
        "near segments are not enough: at a corner they meet too, compare the angles": (
            lambda a, b, d, t: _near(a, b, d)
        ),
        "similar angles are not enough: the segments must be near": (
            lambda a, b, d, t: _turn(a, b) < t
        ),
        "both conditions must hold, not one of them": (
            lambda a, b, d, t: _near(a, b, d) or _turn(a, b) < t
        ),
        "an end must be near, not the middles": (
            lambda a, b, d, t: np.hypot(*(midpoint(a) - midpoint(b))) < d and _turn(a, b) < t
        ),
        "the ends of both count: a long wall has none near the middle of a piece beside it, but "
        "the piece has": lambda a, b, d, t: _gaps(a, b)[0].min() < d and _turn(a, b) < t,
        "the ends of both count, also those of the first": (
            lambda a, b, d, t: _gaps(a, b)[1].min() < d and _turn(a, b) < t
        ),
        "one near end is enough: take the smallest of the four distances": (
            lambda a, b, d, t: _gaps(a, b).max() < d and _turn(a, b) < t
        ),
        "both tests are strict: exactly at the distance is not closer": (
            lambda a, b, d, t: _gaps(a, b).min() <= d and _turn(a, b) < t
        ),
    },
)


# ----------------------------------------------------------------------------- Hybrid
def _two_looks(rng: Rng) -> Cases:
    """A wall and a segment beside it, far from the origin of the map and of other lengths."""

    def case(long: float, short: float) -> tuple[Any, ...]:
        x, y = rng.uniform(5, 40, 2) * rng.choice([-1, 1], 2)
        looks = _wall((0, 0), long, 4), _wall((rng.uniform(0.5, 1), 0.05), short, 2)
        return tuple(transform((x, y, rng.uniform(-3, 3)), look) for look in looks)

    return {
        "a wall and a scrap": case(rng.uniform(4, 6), rng.uniform(0.2, 0.4)),
        "a scrap of the map and a long wall": case(rng.uniform(0.2, 0.4), rng.uniform(4, 6)),
        "two walls": case(rng.uniform(2, 3), rng.uniform(1, 1.5)),
    }


def _weighted(wall: Array, a: Array, u: Array | float, v: Array | float) -> Array:
    """The mean of both middles, with these weights."""
    return np.asarray((u * midpoint(wall) + v * midpoint(a)) / (u + v))


def _between(wall: Array, a: Array) -> Array:
    return _weighted(wall, a, length(wall), length(a))


check_pair_origin = Exercise(
    "pair_origin(wall, a) -> (x, y), metres: the mean of the middles of two segments (2, 2), in "
    "which each counts by its length",
    _between,
    _two_looks,
    {
        "this is the origin of the map, as in the chapter: it is far from both": hybrid.map_origin,
        "a longer segment counts more: weigh the middles by the lengths": (
            lambda wall, a: _weighted(wall, a, 1, 1)
        ),
        "the weights are exchanged: the middle of the longer one is nearer": (
            lambda wall, a: _weighted(wall, a, length(a), length(wall))
        ),
        "this is the middle of the wall: the new segment counts, too": (
            lambda wall, a: midpoint(wall)
        ),
        "this is the middle of the new segment: the wall counts, too": lambda wall, a: midpoint(a),
        "each counts by its length, not by the square of it": (
            lambda wall, a: _weighted(wall, a, length(wall) ** 2, length(a) ** 2)
        ),
        "a weighted mean: divide by the sum of the lengths": (
            lambda wall, a: length(wall) * midpoint(wall) + length(a) * midpoint(a)
        ),
    },
)


# -------------------------------------------------------------- segment similarity
def _two_lines(rng: Rng) -> Cases:
    """Two segments that are nearly parallel, also where the numbers of their angles jump."""
    cases: dict[str, tuple[Any, ...]] = {}
    for words, at in (("two slanted walls", rng.uniform(0.3, 1.2)), ("two level walls", 0.0)):
        ends = []
        for turn in rng.uniform(0.02, 0.12, 2) * (1, -1):
            along = np.array([np.cos(at + turn), np.sin(at + turn)])
            middle, half = rng.uniform(-3, 3, 2), rng.uniform(0.5, 2)
            ends.append(np.stack([middle - half * along, middle + half * along]))
        ends[1] = ends[1][::-1]
        cases[words] = *ends, float(rng.integers(2, 5)), 1.0
    return cases


def _mean_by_length(u: Array, v: Array, weight_u: float, weight_v: float) -> Array:
    """As the chapter's mean segment, but a look counts by its length, its direction by the cube."""
    both, looks = np.stack([u, v]), np.array([weight_u, weight_v])
    sizes, (at, other) = length(both), angle(both)
    middle = np.average(both.mean(axis=1), axis=0, weights=looks * sizes)
    turn = (other - at + np.pi / 2) % np.pi - np.pi / 2
    at = at + np.average([0, turn], weights=looks * sizes**3)
    along = np.array([np.cos(at), np.sin(at)])
    reach = (both.reshape(4, 2) - middle) @ along
    return np.asarray(middle + np.outer([reach.min(), reach.max()], along))


check_mean_by_length = Exercise(
    "mean_by_length(u, v, weight_u, weight_v) -> (2, 2): the mean segment, metres, of two segments "
    "(2, 2) that stand for so many looks, in which the middle of a look counts by its length, and "
    "its direction by the third power of its length",
    _mean_by_length,
    _two_lines,
    {
        "this is the mean segment of the chapter, where a scrap pulls as much as a wall": (
            mean_segment
        ),
        "the direction counts by the third power of the length": edited(
            _mean_by_length, ("sizes**3", "sizes")
        ),
        "the middle counts by the length itself, only the direction by its third power": edited(
            _mean_by_length, ("looks * sizes)", "looks * sizes**3)")
        ),
        "a segment that stands for three looks counts three times": edited(
            _mean_by_length, ("looks * sizes", "sizes")
        ),
        "a line has no direction: the second may be told the other way round": edited(
            _mean_by_length, ("(other - at + np.pi / 2) % np.pi - np.pi / 2", "other - at")
        ),
        "it spans all four ends": edited(_mean_by_length, ("both.reshape(4, 2)", "both[0]")),
    },
    same_segment,
)
