"""The steps of a particle filter as loops: effective number, resampling, and the proposal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from math import dist, exp, log

Row = list[float]


def effective_number(weights: Sequence[float]) -> float:
    """How many particles count: 1 over the sum of the squared weights (Liu 1996).

    Examples
    --------
    >>> effective_number([0.25, 0.25, 0.25, 0.25])
    4.0
    """
    return 1 / sum(weight * weight for weight in weights)


def systematic(weights: Sequence[float], offset: float, count: int | None = None) -> list[int]:
    """Which particle each new one goes on from: a comb on the weights (Kitagawa 1996).

    It has `count` teeth, or as many as there are weights.

    Examples
    --------
    >>> systematic([0.7, 0.1, 0.2], 0.5)
    [0, 0, 2]
    """
    taken, at, reached, count = [], 0, weights[0], count or len(weights)
    for k in range(count):
        tooth = (k + offset) / count
        while reached <= tooth and at < len(weights) - 1:
            at += 1
            reached += weights[at]
        taken.append(at)
    return taken


def log_likelihood(
    ends: Sequence[tuple[float, float]],
    centres: Sequence[tuple[float, float]],
    *,
    sigma: float,
    astray: float,
) -> float:
    """Of ends of beams on a map of occupied centres: each is near one, or astray by chance."""
    total = 0.0
    for end in ends:
        away = min(dist(end, centre) for centre in centres)
        total += log((1 - astray) * exp(-(away**2) / (2 * sigma**2)) + astray)
    return total


def information(value: Callable[[Row], float], apart: Sequence[float]) -> list[Row]:
    """How sharply a value bends down about 0, by the parabola that fits 3 x 3 x 3 samples best.

    Examples
    --------
    >>> bent = information(lambda p: -(p[0] ** 2) - p[0] * p[1], (0.5, 0.5, 0.1))
    >>> [[round(part, 9) + 0 for part in row] for row in bent]
    [[2.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    """
    found = [[0.0] * 3 for _ in range(3)]
    for place in product((-1, 0, 1), repeat=3):
        here = value([step * size for step, size in zip(place, apart, strict=True)])
        for i, j in product(range(3), repeat=2):
            part = (place[i] ** 2 - 2 / 3) / 3 if i == j else place[i] * place[j] / 12
            found[i][j] -= here * part / (apart[i] * apart[j])
    return found
