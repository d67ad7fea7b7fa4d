"""Exercises on mean shift and Fusion: one step, one strip."""

from __future__ import annotations

from typing import Any

import numpy as np

from segmap.angles import axial_difference
from segmap.arrays import Array

from ..literal import best_strip
from ..literal.reduction.mean_shift import mean_difference
from ._answers import Cases, same_poses
from ._exercise import Exercise, Rng, changed, edited


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
        return *places, sigma, float(np.radians(slack)) / sigma

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


def _literal_step(centres: Array, pieces: Array, sigma: float, bandwidth: float) -> list[Any]:
    """One step of phase 1 (A 4.8)."""

    def square(d: Any) -> float:
        return float((d[0] ** 2 + d[1] ** 2 + (d[2] / bandwidth) ** 2) / sigma**2)

    points = pieces.tolist()
    return [at + mean_difference(points, at.tolist(), square) for at in centres]


def _mean_shift_step(centres: Array, pieces: Array, sigma: float, bandwidth: float) -> Array:
    """The same in arrays, of which the mistakes change a part."""
    d = pieces - centres[:, None]
    d[..., 2] = axial_difference(d[..., 2], 0.0)
    away = np.linalg.norm(d * [1, 1, 1 / bandwidth], axis=-1)
    w = np.exp(-((away / sigma) ** 2) / 2)
    return np.asarray(centres + (w[..., None] * d).sum(axis=1) / w.sum(axis=1)[:, None])


check_mean_shift_step = Exercise(
    "mean_shift_step(centres, pieces, sigma, bandwidth) -> (n, 3): centres (n, 3), as x and y in "
    "metres and the angle in radians, after one step towards the pieces (m, 3)",
    _literal_step,
    _pieces,
    {
        "walls at 2 and 177 degrees differ by 5: take the axial difference of the angles": (
            edited(_mean_shift_step, ("axial_difference(d[..., 2], 0.0)", "d[..., 2]"))
        ),
        "the weights are right; add the weighted mean of the axial differences to the angle of the "
        "centre, in place of averaging the angles themselves": (
            edited(_mean_shift_step, ("centres + (w[..., None] * d).sum(axis=1)", "w @ pieces"))
        ),
        "a radian is not a metre: divide the difference of the angles by the bandwidth": (
            lambda c, p, s, b: _mean_shift_step(c, p, s, 1.0)
        ),
        "the bandwidth is in radians a metre: divide by it to get metres": (
            lambda c, p, s, b: _mean_shift_step(c, p, s, 1 / b)
        ),
        "the kernel is exp(-d^2 / (2 sigma^2)): the 2 is missing": (
            lambda c, p, s, b: _mean_shift_step(c, p, s / np.sqrt(2), b)
        ),
        "a weighted mean: divide by the sum of the weights": (
            edited(_mean_shift_step, (" / w.sum(axis=1)[:, None]", ""))
        ),
        "this is how far each centre moves: add it to where the centre is": (
            lambda c, *rest: _mean_shift_step(c, *rest) - c
        ),
        "centres are pulled by the pieces, which stay, not by each other": (
            lambda c, p, s, b: _mean_shift_step(c, c, s, b)
        ),
        "the bandwidth turns the angle into metres; sigma then divides it as it divides x and y": (
            lambda c, p, s, b: _mean_shift_step(c, p, s, b / s)
        ),
        "divide the angle by the bandwidth alone: sigma divides all three afterwards, and not "
        "twice": lambda c, p, s, b: _mean_shift_step(c, p, s, b * s),
        "the bandwidth is in radians a metre: angles stay in radians": (
            lambda c, p, s, b: _mean_shift_step(c, p, s, np.radians(b))
        ),
        "the weight falls with the square of the distance": (
            edited(_mean_shift_step, ("((away / sigma) ** 2)", "(away / sigma)"))
        ),
    },
    same_poses,
)

# ----------------------------------------------------------------------------- Fusion
#: The rounding, metres, that the border of a strip forgives.
_BORDER = 1e-9


def _strips(rng: Rng) -> Cases:
    """A segment of 3 m on the line, and others that a shift takes in or none does, in 64ths."""
    e = int(rng.integers(3, 7))
    up, down, long = e + 1, -e - 1, 1.5 + 0.25 * int(rng.integers(0, 4))
    return {
        words: (np.array([(0, 0), *offsets]) / 64, np.array([3, *lengths], float), e / 64)
        for words, offsets, lengths in (
            ("a long segment above, a short one below", [(up, up + 1), (down, 0)], [long, 1]),
            (
                "a long segment above, three short ones below",
                *([(up, up), *[(down, down)] * 3], [long, 0.25, 0.25, 0.25]),
            ),
            ("as much above as below", [(up, up), (down - 1, down - 1)], [long, long]),
            ("as much below as above", [(up + 1, up + 1), (down, down)], [long, long]),
            ("a segment below", [(down - 1, down)], [long]),
            ("a longer wall far away", [(20, 20), (20, 21)], [2.75, long]),
            ("a longer wall far below", [(-20, -20), (-21, -20)], [2.75, long]),
            ("a wall that takes the whole tolerance", [(e, 2 * e)], [long]),
            ("nothing to gain", [(e - 2, e - 1)], [1]),
            ("a slanted segment, one of its ends near", [(up, up + 2 * e + 2)], [long]),
        )
    }


def _best_shift(offsets: Array, lengths: Array, tolerance: float) -> float:
    """The sweep of `literal.fusion` over segments that all overlap, the longest first."""
    spans = [(0.0, 1.0)] * len(offsets)
    return best_strip(spans, np.sort(offsets).tolist(), lengths.tolist(), 0, tolerance)[0]


def _shift_in_arrays(offsets: Array, lengths: Array, tolerance: float) -> float:
    """The same in arrays, of which the mistakes change a part."""
    shifts = np.append(0.0, offsets.max(axis=1) - tolerance)
    shifts = np.append(shifts, offsets.min(axis=1) + tolerance)
    shifts = shifts[np.abs(shifts) <= tolerance + _BORDER]
    away = np.abs(offsets - shifts[:, None, None]).max(axis=2)
    totals = ((away <= tolerance + _BORDER) * lengths).sum(axis=1)
    best = shifts[totals >= totals.max() - _BORDER]
    return float(best[np.argmin(np.abs(best))])


check_best_shift = Exercise(
    "best_shift(offsets, lengths, tolerance) -> metres: the shift whose strip holds the greatest "
    "total of lengths (n,), among 0 and those where a segment enters or leaves",
    _best_shift,
    _strips,
    {
        "length decides, not number: noise makes many short segments": (
            lambda offsets, lengths, e: _best_shift(offsets, lengths**0, e)
        ),
        "the line may move: try the shifts at which a segment enters or leaves": (
            lambda offsets, lengths, e: 0.0
        ),
        "a segment below enters as the line moves down: try the lower ends plus tolerance too": (
            edited(_shift_in_arrays, ("offsets.min(axis=1) + tolerance", "[]"))
        ),
        "this moves the line away from what it wants to include, as row 72 of the thesis does": (
            changed(_best_shift, np.negative)
        ),
        "the strip must keep the longest segment: shift by no more than the tolerance": (
            edited(_shift_in_arrays, ("shifts[np.abs(shifts) <= tolerance + _BORDER]", "shifts"))
        ),
        "of equal shifts the one nearest to 0 counts, not the most negative one": (
            edited(_shift_in_arrays, ("best[np.argmin(np.abs(best))]", "best.min()"))
        ),
        "of equal shifts the one nearest to 0 counts, not the largest one": (
            edited(_shift_in_arrays, ("best[np.argmin(np.abs(best))]", "best.max()"))
        ),
        "the tolerance lies on both sides of the line: it is half the width of the strip": (
            lambda o, lengths, e: _best_shift(o, lengths, e / 2)
        ),
        "both ends of a segment must lie in the strip, not one of them": (
            edited(_shift_in_arrays, (".max(axis=2)", ".min(axis=2)"))
        ),
    },
)
