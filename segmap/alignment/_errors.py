"""How far the poses that a method found are from the true ones."""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..poses import compose, inverse, transform


def laid_on_truth(poses: ArrayLike, truth: ArrayLike, *, best: bool = False) -> Array:
    """Carry all poses by one motion to where they can be compared with the true ones.

    A method does not know where its first pose lies in the world of the truth: what it found is
    right or wrong only up to one motion of the whole.

    Parameters
    ----------
    poses : (k, 3) array, metres and radians
        Rows of NaN have no pose.
    truth : (k, 3) array, metres and radians
        Rows of NaN are not known.
    best : bool
        False lays the first pose whose truth is known on that one, place and heading. True takes
        the motion that makes the squared distances of all known places least.

    Returns
    -------
    (k, 3) array, metres and radians
        In the frame of the truth.

    Raises
    ------
    ValueError
        Where the shapes differ, or where no scan has both.

    Examples
    --------
    >>> found = laid_on_truth([(0, 0, 0), (1, 0, 0)], [(5, 5, np.pi / 2), (5, 6.5, np.pi / 2)])
    >>> found[:, :2].round(6)
    array([[5., 5.],
           [5., 6.]])
    """
    p, q = _pair(poses, truth)
    known = np.isfinite(p).all(1) & np.isfinite(q).all(1)
    if not known.any():
        raise ValueError("poses and truth must share a scan where both are known, got none")
    first = np.flatnonzero(known)[0]
    move = _least(p[known], q[known]) if best else compose(q[first], inverse(p[first]))
    return compose(move, p)


def place_errors(poses: ArrayLike, truth: ArrayLike, *, best: bool = False) -> Array:
    """Distances between found and true places, where both are known, after `laid_on_truth`.

    Parameters
    ----------
    poses, truth : (k, 3) array, metres and radians
        Rows of NaN are passed over.
    best : bool
        As for `laid_on_truth`.

    Returns
    -------
    (m,) array, metres
        For the m <= k scans where both are known, in their order.

    Raises
    ------
    ValueError
        As `laid_on_truth`.

    Examples
    --------
    >>> truth = [(0, 0, 0), (1, 0, 0), (np.nan, np.nan, np.nan), (3, 0, 0)]
    >>> place_errors([(2, 2, 0), (3, 2, 0), (4, 2, 0), (5, 2.1, 0)], truth).round(6)
    array([0. , 0. , 0.1])
    """
    away = (laid_on_truth(poses, truth, best=best) - np.asarray(truth, float))[:, :2]
    far: Array = np.hypot(*away.T)
    return far[np.isfinite(far)]


def _pair(poses: ArrayLike, truth: ArrayLike) -> tuple[Array, Array]:
    p, q = np.asarray(poses, float), np.asarray(truth, float)
    if p.ndim != 2 or p.shape[1] != 3 or p.shape != q.shape:
        raise ValueError(f"poses and truth must both be (k, 3), got {p.shape} and {q.shape}")
    return p, q


def _least(p: Array, q: Array) -> Array:
    """Motion that brings the places of p to those of q with the least squares."""
    a, b = p[:, :2] - p[:, :2].mean(0), q[:, :2] - q[:, :2].mean(0)
    turn = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum())
    shift = q[:, :2].mean(0) - transform((0.0, 0.0, turn), p[:, :2].mean(0))
    return np.array([*shift, turn])
