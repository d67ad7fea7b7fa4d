"""Exercises on mean shift and Fusion: one step, one strip."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.angles import axial_difference
from segmap.arrays import Array, Segments

from ..literal import chain
from ..literal.reduction.mean_shift import moves
from ._answers import Cases, same_poses
from ._exercise import Exercise, Rng, edited


# ------------------------------------------------------------------------- mean shift
def _pieces(rng: Rng) -> Cases:
    """Pieces of walls at any angle, so near that none is beyond the three sigma of the thesis."""
    sigma, slack, way = rng.uniform(0.15, 0.3), rng.uniform(8, 14), rng.uniform(40, 140)

    def about(middle: float, count: int) -> Array:
        place = np.array([1, 2, middle]) + rng.uniform(-1, 1, (count, 3)) * (0.08, 0.08, 6)
        return place % (1e6, 1e6, 180)

    def case(centres: Any, pieces: Any) -> tuple[Any, ...]:
        scale = [1, 1, np.pi / 180]
        places = np.array(centres, float) * scale, np.array(pieces, float) * scale
        lengths = sigma * rng.uniform(0.1, 1, len(pieces))
        return *places, lengths, sigma, float(np.radians(slack)) / sigma

    return {
        "two pieces": case(about(way, 1), about(way, 2)),
        "two centres among four pieces": case(about(way, 2), about(way, 4)),
        "walls on both sides of 0 degrees": case(
            [(1, 2, 2)], [(1, 2, rng.uniform(1, 5)), (1.1, 2, rng.uniform(174, 179))]
        ),
        "a centre that turned past 180 degrees": case(
            about(0, 1) % (1e6, 1e6, 5) + (0, 0, 180), about(0, 5)
        ),
    }


def _mean_shift_step(
    centres: Array, pieces: Array, lengths: Array, sigma: float, bandwidth: float
) -> Array:
    """One step of phase 1 (A 4.8), in which a piece counts by its length."""
    d = pieces - centres[:, None]
    d[..., 2] = axial_difference(d[..., 2], 0.0)
    away = np.linalg.norm(d * [1, 1, 1 / bandwidth], axis=-1)
    w = lengths * np.exp(-((away / sigma) ** 2) / 2)
    return np.asarray(centres + (w[..., None] * d).sum(axis=1) / w.sum(axis=1)[:, None])


def _unweighted_step(
    centres: Array, pieces: Array, lengths: Array, sigma: float, bandwidth: float
) -> Array:
    """The chapter's own step."""
    return centres + moves(pieces, centres, np.array([sigma, sigma, sigma * bandwidth]))


check_mean_shift_step = Exercise(
    "mean_shift_step(centres, pieces, lengths, sigma, bandwidth) -> (n, 3): centres (n, 3), as x "
    "and y in metres and the angle in radians, after one step towards the pieces (m, 3), in which "
    "a piece counts by its length (m,), metres",
    _mean_shift_step,
    _pieces,
    {
        "this is the chapter's step, where a scrap pulls as much as a long piece: multiply the "
        "weights by the lengths": _unweighted_step,
        "multiply the weights by the lengths, and not the kernel's distance": (
            edited(
                _mean_shift_step, ("away / sigma", "lengths * away / sigma"), ("lengths * np", "np")
            )
        ),
        "a length counts once: divide by the sum of the weights with their lengths": (
            edited(_mean_shift_step, ("w.sum(axis=1)", "(w / lengths).sum(axis=1)"))
        ),
        "walls at 2 and 177 degrees differ by 5: take the axial difference of the angles": (
            edited(_mean_shift_step, ("axial_difference(d[..., 2], 0.0)", "d[..., 2]"))
        ),
        "the weights are right; add the weighted mean of the axial differences to the angle of the "
        "centre, in place of averaging the angles themselves": (
            edited(
                _mean_shift_step,
                ("centres + (w[..., None] * d).sum(axis=1)", "w @ pieces"),
            )
        ),
        "a radian is not a metre: divide the difference of the angles by the bandwidth": (
            lambda c, p, n, s, b: _mean_shift_step(c, p, n, s, 1.0)
        ),
        "the bandwidth is in radians a metre: divide by it to get metres": (
            lambda c, p, n, s, b: _mean_shift_step(c, p, n, s, 1 / b)
        ),
        "the kernel is exp(-d^2 / (2 sigma^2)): the 2 is missing": (
            lambda c, p, n, s, b: _mean_shift_step(c, p, n, s / np.sqrt(2), b)
        ),
        "a weighted mean: divide by the sum of the weights": (
            edited(_mean_shift_step, (" / w.sum(axis=1)[:, None]", ""))
        ),
        "this is how far each centre moves: add it to where the centre is": (
            lambda c, *rest: _mean_shift_step(c, *rest) - c
        ),
        "the bandwidth turns the angle into metres; sigma then divides it as it divides x and y": (
            lambda c, p, n, s, b: _mean_shift_step(c, p, n, s, b / s)
        ),
        "divide the angle by the bandwidth alone: sigma divides all three afterwards, and not "
        "twice": lambda c, p, n, s, b: _mean_shift_step(c, p, n, s, b * s),
        "the bandwidth is in radians a metre: angles stay in radians": (
            lambda c, p, n, s, b: _mean_shift_step(c, p, n, s, np.radians(b))
        ),
        "the weight falls with the square of the distance": (
            edited(_mean_shift_step, ("((away / sigma) ** 2)", "(away / sigma)"))
        ),
    },
    same_poses,
)

# ----------------------------------------------------------------------------- Fusion
#: Which way a segment is measured: the robot stood on its left.
_SEEN, _FROM_BEHIND = 1, -1


def _faces(rng: Rng) -> Cases:
    """Segments along the line of the first, some of them seen from the other side of the wall."""

    def case(*spans: tuple[float, float, int], outside: tuple[int, ...] = ()) -> tuple[Any, ...]:
        """Low, high and way of each span, the first one first, in an order that is drawn."""
        at, size = rng.uniform(-5, 5), rng.uniform(0.8, 1.2)
        order = rng.permutation(len(spans))
        rows = [spans[k] for k in order]
        u = [[at + size * x for x in (low, high)[::way]] for low, high, way in rows]
        inside = [i for i, k in enumerate(order) if k not in outside]
        return u, inside, int(np.argmin(order))

    more = rng.uniform(0.1, 0.4)
    return {
        "a chain of three, and one beyond a gap": case(
            (0, 3, _SEEN), (2, 4 + more, _SEEN), (4, 5, _SEEN), (6, 7, _SEEN)
        ),
        "the other face of the wall": case(
            (0, 3, _SEEN), (0.5, 2 + more, _FROM_BEHIND), (1, 2, _SEEN)
        ),
        "the other face bridges a gap": case(
            (0, 3, _SEEN), (2, 5, _FROM_BEHIND), (4 + more, 6, _SEEN), (7, 8, _FROM_BEHIND)
        ),
        "one of them is not in the strip": case(
            (0, 3, _SEEN), (1 + more, 4, _SEEN), (3.5, 5, _SEEN), outside=(1,)
        ),
        "nothing but the first": case((0, 3, _SEEN), (3 + more, 4, _FROM_BEHIND)),
        "small ones amid the first": case(
            (0, 3, _SEEN), (1, 1 + more, _SEEN), (2, 2.5, _SEEN), (4, 5, _SEEN), (4.5, 6, _SEEN)
        ),
    }


def robot_on_the_left(segments: Segments, places: ArrayLike) -> Array:
    """Segments `(n, 2, 2)`, their ends in such an order that their places lie on their left.

    Places `(n, 2)` are where the sensor stood when each was seen, metres. So both faces of a wall
    run in opposite ways.

    Examples
    --------
    >>> robot_on_the_left([[(0, 0), (1, 0)], [(0, 0), (1, 0)]], [(0, 2), (0, -2)]).tolist()
    [[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 0.0]]]
    """
    ends = arrays.segments(segments)
    (x, y), (u, v) = (ends[:, 1] - ends[:, 0]).T, (np.asarray(places, float) - ends[:, 0]).T
    return np.where((x * v > y * u)[:, None, None], ends, ends[:, ::-1])


def _chain_of_a_face(u: Sequence[Sequence[float]], inside: Sequence[int], first: int) -> list[int]:
    """The chain of those that were seen from the side from which the first was."""
    return chain(u, [i for i in inside if u[i][0] < u[i][1]], first)


def _overlap(a: Sequence[float], b: Sequence[float]) -> bool:
    return min(a) <= max(b) and min(b) <= max(a)


check_chain = Exercise(
    "chain(u, inside, first) -> the rows of the chain, ascending: those of `inside` that overlap "
    "one after another from the first, and were seen from its side; u holds where both ends of "
    "each segment lie along the line, metres: u[i][0] < u[i][1] where it was seen from the side of "
    "the first, which is forwards, and u[i][0] > u[i][1] where it was seen from the other side",
    _chain_of_a_face,
    _faces,
    {
        "this is the chain of the chapter, which joins both faces of a wall: leave out those that "
        "run backwards, u[i][0] > u[i][1]": chain,
        "the other face must not bridge a gap: leave it out before you look for neighbours, not "
        "afterwards": (
            lambda u, inside, first: [i for i in chain(u, inside, first) if u[i][0] < u[i][1]]
        ),
        "this is the other face: the first runs forwards, and so do those of its side": (
            lambda u, inside, first: chain(
                u, [i for i in inside if u[i][0] > u[i][1] or i == first], first
            )
        ),
        "one after another: what overlaps a member belongs to the chain, also where it does not "
        "overlap the first": (
            lambda u, inside, first: sorted(
                i for i in inside if u[i][0] < u[i][1] and _overlap(u[i], u[first])
            )
        ),
        "a gap ends the chain: not all that are inside belong to it": (
            lambda u, inside, first: sorted(i for i in inside if u[i][0] < u[i][1])
        ),
        "only those of `inside` lie in the strip": (
            lambda u, inside, first: _chain_of_a_face(u, range(len(u)), first)
        ),
        "the first is a member of its chain too": (
            lambda u, inside, first: [i for i in _chain_of_a_face(u, inside, first) if i != first]
        ),
        "return the rows of the chain, and not how many they are": (
            lambda u, inside, first: len(_chain_of_a_face(u, inside, first))
        ),
    },
)
