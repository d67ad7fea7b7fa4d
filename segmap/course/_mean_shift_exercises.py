"""Exercise of the chapter on mean shift: one step of its first phase."""

from typing import Any

import numpy as np

from ..angles import axial_difference
from ..arrays import Array
from ._exercise import Case, Exercise, Mistake, numbers


def mean_shift_step(centres: Array, pieces: Array, sigma: float, bandwidth: float) -> Array:
    """Centres after one step of phase 1 of mean shift (A 4.8), without leaving out far pieces.

    Parameters
    ----------
    centres, pieces : (n, 3) and (m, 3) arrays, metres and radians
        x, y and angle. The pieces stay where they are.
    sigma : float, metres
    bandwidth : float, radians a metre
        The angle that counts as much as a metre.

    Returns
    -------
    (n, 3) array, metres and radians
        Angles are not wrapped.

    Examples
    --------
    >>> mean_shift_step(np.zeros((1, 3)), np.array([(0.0, 0, 0), (0, 0, 0.2)]), 1.0, 1e9)
    array([[0. , 0. , 0.1]])
    """
    return _step(centres, pieces, sigma, bandwidth, centres)


def _step(
    centres: Array,
    pieces: Array,
    sigma: float,
    bandwidth: float,
    place: Array | float,
    divisor: float = 2.0,
    axial: bool = True,
    power: int = -1,
    normal: bool = True,
) -> Array:
    """One step, with the details that the mistakes change."""
    d = pieces - centres[:, None]
    if axial:
        d[..., 2] = axial_difference(d[..., 2], 0.0)
    square = (d * [1, 1, bandwidth**power]) ** 2
    w = np.exp(-square.sum(axis=-1) / (divisor * sigma**2))
    move = (w[..., None] * d).sum(axis=1)
    return place + (move / w.sum(axis=1)[:, None] if normal else move)


def _plain_mean(centres: Array, pieces: Array, sigma: float, bandwidth: float) -> Array:
    """Weights with axial differences, but angles averaged as numbers."""
    d = pieces - centres[:, None]
    d[..., 2] = axial_difference(d[..., 2], 0.0)
    square = (d * [1, 1, 1 / bandwidth]) ** 2
    w = np.exp(-square.sum(axis=-1) / (2 * sigma**2))
    return w @ pieces / w.sum(axis=1)[:, None]


def _same_places(found: Any, expected: Any) -> bool:
    """Whether x and y agree, and the angles as those of undirected lines."""
    a, b = numbers(found), numbers(expected)
    if a is None or b is None or a.shape != b.shape or not np.isfinite(a).all():
        return False
    off = a - b
    off[..., 2] = axial_difference(off[..., 2], 0.0)
    return np.allclose(off, 0, atol=1e-9)


def _case(words: str, centres: list[Any], pieces: list[Any], sigma: float, slack: float) -> Case:
    """Angles in degrees; `slack` is the angle, in degrees, that counts as much as sigma."""
    scale = [1, 1, np.pi / 180]
    places = np.array(centres, float) * scale, np.array(pieces, float) * scale
    return Case(words, (*places, sigma, float(np.radians(slack)) / sigma))


check_mean_shift_step = Exercise(
    "mean_shift_step",
    "mean_shift_step(centres, pieces, sigma, bandwidth) -> (n, 3): centres (n, 3), as x and y in "
    "metres and the angle in radians, after one step towards the pieces (m, 3)",
    mean_shift_step,
    (
        _case("two parallel pieces", [(0, 0, 30)], [(0, 0, 30), (0, 0.1, 30)], 0.2, 10),
        _case(
            "two centres among three pieces",
            [(0.1, 0, 80), (0.3, 0.1, 84)],
            [(0, 0, 80), (0.2, 0.05, 84), (0.3, 0.1, 95)],
            0.3,
            15,
        ),
        _case("walls at 2 and 177 degrees", [(0, 0, 2)], [(0, 0, 2), (0.1, 0, 177)], 0.2, 10),
        _case(
            "a centre that turned past 180 degrees",
            [(1, 2, 183), (1, 2, 1)],
            [(1, 2, 1), (1.1, 2, 178), (0.9, 2.1, 5)],
            0.2,
            8,
        ),
    ),
    (
        Mistake(
            "plain differences",
            lambda c, p, s, b: _step(c, p, s, b, c, axial=False),
            "walls at 2 and 177 degrees differ by 5: take the axial difference of the angles",
        ),
        Mistake(
            "plain mean",
            _plain_mean,
            "the weights are right; add the weighted mean of the axial differences to the angle of "
            "the centre, in place of averaging the angles themselves",
        ),
        Mistake(
            "no bandwidth",
            lambda c, p, s, b: _step(c, p, s, b, c, power=0),
            "a radian is not a metre: divide the difference of the angles by the bandwidth",
        ),
        Mistake(
            "times the bandwidth",
            lambda c, p, s, b: _step(c, p, s, b, c, power=1),
            "the bandwidth is in radians a metre: divide by it to get metres",
        ),
        Mistake(
            "without the 2",
            lambda c, p, s, b: _step(c, p, s, b, c, divisor=1.0),
            "the kernel is exp(-d^2 / (2 sigma^2)): the 2 is missing",
        ),
        Mistake(
            "not divided",
            lambda c, p, s, b: _step(c, p, s, b, c, normal=False),
            "a weighted mean: divide by the sum of the weights",
        ),
        Mistake(
            "the move",
            lambda c, p, s, b: _step(c, p, s, b, 0.0),
            "this is how far each centre moves: add it to where the centre is",
        ),
        Mistake(
            "among centres",
            lambda c, p, s, b: _step(c, c, s, b, c),
            "centres are pulled by the pieces, which stay, not by each other",
        ),
    ),
    _same_places,
)
