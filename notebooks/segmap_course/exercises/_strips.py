"""Exercises on mean shift and Fusion: one step, one strip."""

from __future__ import annotations

from typing import Any

import numpy as np

from segmap import reduction
from segmap.angles import axial_difference
from segmap.arrays import Array

from ..literal import best_strip
from ..literal.reduction import fusion, mean_shift
from ..literal.reduction.mean_shift import mean_difference
from ._answers import same_poses
from ._exercise import Exercise
from .draws import maps as draws_maps


# ------------------------------------------------------------------------- mean shift
def _literal_step(centres: Array, pieces: Array, sigma: float, bandwidth: float) -> list[Any]:
    """One step of phase 1 (A 4.8)."""

    def square(d: Any) -> float:
        return float((d[0] ** 2 + d[1] ** 2 + (d[2] / bandwidth) ** 2) / sigma**2)

    points = pieces.tolist()
    return [at + mean_difference(points, at.tolist(), square) for at in centres]


def _mean_shift_step(
    centres: Array,
    pieces: Array,
    sigma: float,
    bandwidth: float,
    *,
    divisor: float = 2.0,
    axial: bool = True,
    normal: bool = True,
) -> Array:
    """The same in arrays, with the details that the mistakes change."""
    d = pieces - centres[:, None]
    if axial:
        d[..., 2] = axial_difference(d[..., 2], 0.0)
    w = _weights(d, sigma, bandwidth, divisor)
    move = (w[..., None] * d).sum(axis=1)
    return centres + (move / w.sum(axis=1)[:, None] if normal else move)


def _weights(d: Array, sigma: float, bandwidth: float, divisor: float = 2.0) -> Array:
    square = (d * [1, 1, 1 / bandwidth]) ** 2
    return np.asarray(np.exp(-square.sum(axis=-1) / (divisor * sigma**2)))


def _plain_mean(centres: Array, pieces: Array, sigma: float, bandwidth: float) -> Array:
    """Weights with axial differences, but angles averaged as numbers."""
    d = pieces - centres[:, None]
    d[..., 2] = axial_difference(d[..., 2], 0.0)
    w = _weights(d, sigma, bandwidth)
    return w @ pieces / w.sum(axis=1)[:, None]


def _by_distance(centres: Array, pieces: Array, sigma: float, bandwidth: float) -> Array:
    """exp(-d / (2 sigma)) in the place of the kernel."""
    d = pieces - centres[:, None]
    d[..., 2] = axial_difference(d[..., 2], 0.0)
    away = np.linalg.norm(d * [1, 1, 1 / bandwidth], axis=-1)
    w = np.exp(-away / (2 * sigma))
    return centres + (w[..., None] * d).sum(axis=1) / w.sum(axis=1)[:, None]


check_mean_shift_step = Exercise(
    "mean_shift_step(centres, pieces, sigma, bandwidth) -> (n, 3): centres (n, 3), as x and y in "
    "metres and the angle in radians, after one step towards the pieces (m, 3)",
    _literal_step,
    {
        "two parallel pieces": draws_maps.pieces_case(
            [(0, 0, 30)], [(0, 0, 30), (0, 0.1, 30)], 0.2, 10
        ),
        "two centres among three pieces": draws_maps.pieces_case(
            [(0.1, 0, 80), (0.3, 0.1, 84)],
            [(0, 0, 80), (0.2, 0.05, 84), (0.3, 0.1, 95)],
            *(0.3, 15),
        ),
        "walls at 2 and 177 degrees": draws_maps.pieces_case(
            [(0, 0, 2)], [(0, 0, 2), (0.1, 0, 177)], 0.2, 10
        ),
        "a centre that turned past 180 degrees": draws_maps.pieces_case(
            [(1, 2, 183), (1, 2, 1)], [(1, 2, 1), (1.1, 2, 178), (0.9, 2.1, 5)], 0.2, 8
        ),
    },
    {
        "walls at 2 and 177 degrees differ by 5: take the axial difference of the angles": (
            lambda *given: _mean_shift_step(*given, axial=False)
        ),
        "the weights are right; add the weighted mean of the axial differences to the angle of the "
        "centre, in place of averaging the angles themselves": _plain_mean,
        "a radian is not a metre: divide the difference of the angles by the bandwidth": (
            lambda c, p, s, b: _mean_shift_step(c, p, s, 1.0)
        ),
        "the bandwidth is in radians a metre: divide by it to get metres": (
            lambda c, p, s, b: _mean_shift_step(c, p, s, 1 / b)
        ),
        "the kernel is exp(-d^2 / (2 sigma^2)): the 2 is missing": (
            lambda *given: _mean_shift_step(*given, divisor=1.0)
        ),
        "a weighted mean: divide by the sum of the weights": (
            lambda *given: _mean_shift_step(*given, normal=False)
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
        "the weight falls with the square of the distance": _by_distance,
    },
    same_poses,
    draw=draws_maps.mean_shift_step,
    own=(reduction.mean_shift, reduction.common_directions, mean_shift),
)

# ----------------------------------------------------------------------------- Fusion
#: The rounding, metres, that the border of a strip forgives.
_BORDER = 1e-9


def _inside(offsets: Array, shift: float, tolerance: float) -> Array:
    """Which segments lie in the strip: both ends within tolerance of the shifted line."""
    return np.abs(offsets - shift).max(axis=1) <= tolerance + _BORDER


_STRIP = np.array([(0.0, 0.0), (0.03, 0.05), (0.05, 0.03), (-0.05, -0.02), (-0.06, 0.06)])

check_inside_strip = Exercise(
    "inside_strip(offsets, shift, tolerance) -> (n,) bool: which segments, with offsets (n, 2) of "
    "both ends from a line in metres, lie within tolerance of the line moved by shift",
    _inside,
    {
        "a line that is not moved": (_STRIP, 0.0, 0.04),
        "a line moved by 0.02 m": (_STRIP, 0.02, 0.04),
        "a line moved by -0.02 m": (_STRIP, -0.02, 0.04),
        "ends that lie right on the border": (
            *(np.array([(0.0, 0.0625), (-0.0625, 0.0)]), 0.0, 0.0625),
        ),
    },
    {
        "both ends must lie inside, not one of them": (
            lambda offsets, t, e: np.abs(offsets - t).min(axis=1) <= e + _BORDER
        ),
        "both ends must lie inside: the middle of a slanted segment says nothing about them": (
            lambda offsets, t, e: np.abs(offsets.mean(axis=1) - t) <= e + _BORDER
        ),
        "the line moves by +shift, so the offsets from it become smaller by shift": (
            lambda offsets, t, e: _inside(offsets, -t, e)
        ),
        "a strip has two borders: segments below the line can lie outside too": (
            lambda offsets, t, e: (offsets - t).max(axis=1) <= e + _BORDER
        ),
        "the border belongs to the strip: <=, not <": (
            lambda offsets, t, e: np.abs(offsets - t).max(axis=1) < e - _BORDER
        ),
        "the line has moved: measure from where it is now": (
            lambda offsets, t, e: _inside(offsets, 0.0, e)
        ),
    },
    draw=draws_maps.inside_strip,
)


def _best(offsets: Array, lengths: Array, tolerance: float, shifts: Array) -> float:
    """Of these shifts the one whose strip holds most; of equals the smallest."""
    totals = np.array([lengths[_inside(offsets, t, tolerance)].sum() for t in shifts])
    equal = shifts[totals >= totals.max() - _BORDER]
    return float(equal[np.argmin(np.abs(equal))])


def _entering(offsets: Array, tolerance: float) -> Array:
    return np.append(0.0, offsets.max(axis=1) - tolerance)


def _shifts(offsets: Array, tolerance: float) -> Array:
    """0, and where a segment enters or leaves the strip."""
    return np.append(_entering(offsets, tolerance), offsets.min(axis=1) + tolerance)


def _within(shifts: Array, tolerance: float) -> Array:
    return shifts[np.abs(shifts) <= tolerance + _BORDER]


def _best_shift(offsets: Array, lengths: Array, tolerance: float) -> float:
    """The sweep of `literal.fusion` over segments that all overlap, the longest first."""
    spans = [(0.0, 1.0)] * len(offsets)
    return best_strip(spans, np.sort(offsets).tolist(), lengths.tolist(), 0, tolerance)[0]


def _first_of(offsets: Array, lengths: Array, tolerance: float, shifts: Array) -> float:
    """Of equal shifts the first in their order."""
    totals = np.array([lengths[_inside(offsets, t, tolerance)].sum() for t in shifts])
    return float(shifts[np.argmax(totals >= totals.max() - _BORDER)])


def _best_of_either(offsets: Array, lengths: Array, tolerance: float) -> float:
    """The best shift where one end of a segment in the strip is enough."""
    shifts = _within(_shifts(offsets, tolerance), tolerance)
    near = np.abs(offsets - shifts[:, None, None]).min(axis=2) <= tolerance + _BORDER
    totals = (near * lengths).sum(axis=1)
    equal = shifts[totals >= totals.max() - _BORDER]
    return float(equal[np.argmin(np.abs(equal))])


check_best_shift = Exercise(
    "best_shift(offsets, lengths, tolerance) -> metres: the shift whose strip holds the greatest "
    "total of lengths (n,), among 0 and those where a segment enters or leaves",
    _best_shift,
    {  # a segment of 3 m on the line and others; 64ths of a metre are free of rounding
        words: (np.array([(0, 0), *offsets]) / 64, np.array([3, *lengths], float), 4 / 64)
        for words, offsets, lengths in (
            ("a long segment above and a short one below", [(5, 6), (-5, -4)], [2, 1]),
            (
                "a long segment above and three short ones below",
                [(5, 5), (-5, -5), (-5, -5), (-5, -5)],
                [2.5, 0.5, 0.5, 0.5],
            ),
            ("a segment below", [(-6, -5)], [2]),
            ("a longer wall far away", [(20, 20), (20, 21)], [2.9, 2]),
            ("nothing to gain", [(1, 3)], [1]),
            ("a slanted segment, one of its ends near", [(5, 12)], [2]),
        )
    },
    {
        "length decides, not number: noise makes many short segments": (
            lambda offsets, lengths, e: _best_shift(offsets, lengths**0, e)
        ),
        "the line may move: try the shifts at which a segment enters or leaves": (
            lambda offsets, lengths, e: 0.0
        ),
        "a segment below enters as the line moves down: try the lower ends plus tolerance too": (
            lambda o, lengths, e: _best(o, lengths, e, _within(_entering(o, e), e))
        ),
        "this moves the line away from what it wants to include, as row 72 of the thesis does": (
            lambda offsets, lengths, e: -_best_shift(offsets, lengths, e)
        ),
        "the strip must keep the longest segment: shift by no more than the tolerance": (
            lambda o, lengths, e: _best(o, lengths, e, _shifts(o, e))
        ),
        "of equal shifts the one nearest to 0 counts, not the most negative one": (
            lambda o, lengths, e: _first_of(o, lengths, e, np.sort(_within(_shifts(o, e), e)))
        ),
        "of equal shifts the one nearest to 0 counts, not the largest one": (
            lambda o, lengths, e: _first_of(o, lengths, e, np.sort(_within(_shifts(o, e), e))[::-1])
        ),
        "the tolerance lies on both sides of the line: it is half the width of the strip": (
            lambda o, lengths, e: _best_shift(o, lengths, e / 2)
        ),
        "both ends of a segment must lie in the strip, not one of them": (
            lambda o, lengths, e: _best_of_either(o, lengths, e)
        ),
    },
    draw=draws_maps.best_shift,
    own=(reduction.fusion, reduction.fusion_online, fusion),
)
