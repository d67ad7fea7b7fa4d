"""Angles: headings, which wrap at a full turn, and lines, which wrap at half a turn.

A segment has no direction, so its angle is *axial*: 1 and 179 degrees are two degrees apart, and
their mean is 0, not 90. Deambrogi and Ferrario (2012) average such angles as plain numbers; every
method here uses the axial forms below.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array, share_of_second, values


def wrap(angle: ArrayLike) -> Array:
    """Headings, radians, in `[-pi, pi)` (up to rounding).

    Examples
    --------
    >>> np.degrees(wrap(np.radians([190.0, -180.0, 540.0]))).round(9)
    array([-170., -180., -180.])
    """
    return (values(angle, "angle") + np.pi) % (2 * np.pi) - np.pi


def axial_difference(a: ArrayLike, b: ArrayLike) -> Array:
    """Turn, radians, from the undirected line b to a by the shorter way, in `[-pi/2, pi/2)`.

    Examples
    --------
    >>> np.degrees(axial_difference(np.radians(179.0), np.radians(1.0))).round(9)
    np.float64(-2.0)
    """
    return (values(a, "a") - values(b, "b") + np.pi / 2) % np.pi - np.pi / 2


def axial_mean(angles: ArrayLike, weights: ArrayLike = 1.0) -> Array:
    """Weighted mean angle of many undirected lines, radians, along the last axis, in `[0, pi)`.

    The double angles are averaged as unit vectors. Lines that balance each other (0 and 90 degrees
    with equal weights) have no mean; the result is then decided by rounding.

    Examples
    --------
    >>> float(np.degrees(axial_mean(np.radians([1.0, 179.0, 3.0]))).round(9))
    1.0
    """
    doubled, weights = 2 * values(angles, "angles"), values(weights, "weights")
    if not doubled.ndim:
        raise ValueError("angles must be (..., n), got one number")
    y = np.sum(weights * np.sin(doubled), axis=-1)
    x = np.sum(weights * np.cos(doubled), axis=-1)
    mean = np.arctan2(y, x) / 2 % np.pi
    return np.where(mean == np.pi, 0.0, mean)  # -1e-20 % pi rounds up to pi


def axial_mean_of_two(
    a: ArrayLike, b: ArrayLike, weight_a: ArrayLike = 1.0, weight_b: ArrayLike = 1.0
) -> Array:
    """Weighted mean angle of two undirected lines, radians: the share of b of the way from a to b.

    This is the form that the reduction methods use; for more than two lines, or for exactness under
    regrouping, use `axial_mean`. The weights are not negative, and not both zero.

    Examples
    --------
    >>> float(np.degrees(axial_mean_of_two(np.radians(1.0), np.radians(179.0), 3.0, 1.0)).round(9))
    0.5
    """
    part = share_of_second(weight_a, weight_b, ("weight_a", "weight_b"))
    return values(a, "a") + part * axial_difference(b, a)
