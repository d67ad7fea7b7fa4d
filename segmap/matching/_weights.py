"""Weights of particles: how many of these count, and which go on."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array

#: Beams are not independent: neighbours meet one wall, which errs alike for metres. Of its
#: logarithm each gives this part to a weight: with all of it one particle soon holds the whole
#: weight of 15 in the corridor loop, and a wrong place all of it after one scan.
BEAM_WEIGHT_PART = 1 / 3


def _shares(weights: ArrayLike) -> Array:
    """Weights as an array."""
    share = arrays.values(weights, "weights")
    if share.ndim != 1 or not (share >= 0).all() or not abs(share.sum() - 1) < 1e-6:
        raise ValueError(f"weights must be (n,), none negative, and sum to 1, got {share}")
    return share


def effective_number(weights: ArrayLike) -> float:
    """How many particles count, `1 / sum(w^2)` (Liu 1996); weights `(n,)` that sum to 1.

    Examples
    --------
    >>> effective_number([0.5, 0.5, 0.0])
    2.0
    """
    share = _shares(weights)
    return float(1 / (share @ share))


def systematic(weights: ArrayLike, offset: float, count: int | None = None) -> NDArray[np.int64]:
    """Which particle each of the new ones goes on from, `(count,)`, ascending (Kitagawa 1996).

    A comb of `count` teeth, as many as there are particles by default, 1 / count apart, the first
    at `offset / count`, is laid on the weights `(n,)` in a row: a particle is taken once for each
    tooth on it.

    Examples
    --------
    >>> systematic([0.7, 0.1, 0.2], 0.5)
    array([0, 0, 2])
    """
    share = _shares(weights)
    n = len(share) if count is None else arrays.whole(count, "count")
    teeth = (np.arange(n) + arrays.number(offset, "offset", least=0, most=1)) / n
    particles = np.searchsorted(np.cumsum(share), teeth, side="right")
    return np.minimum(particles, len(share) - 1)
