"""Poses: arrays `(..., 3)` of x, y in metres and heading in radians, counter-clockwise, x forward.

A pose is a frame and the motion that leads to it: `a_from_b` is the pose of b in the frame of a,
and carries points given in b into a. So `compose(a_from_b, b_from_c)` is `a_from_c`.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..angles import wrap
from ..arrays import Array, Seconds, at_least, at_most, checked, numbers, values, with_axes
from . import motions


def compose(a_from_b: ArrayLike, b_from_c: ArrayLike) -> Array:
    """Chain two motions `(..., 3)`, which broadcast: the pose of c in a, heading in `[-pi, pi)`.

    Examples
    --------
    >>> compose((1, 2, np.pi / 2), (1, 0, 0)).round(6)
    array([1.      , 3.      , 1.570796])
    """
    a, b = with_axes(a_from_b, "a_from_b", 3), with_axes(b_from_c, "b_from_c", 3)
    return motions.compose(a, b)


def inverse(a_from_b: ArrayLike) -> Array:
    """The motion back, `(..., 3)`: the pose of a in b.

    Examples
    --------
    >>> inverse((1, 2, np.pi / 2)).round(6)
    array([-2.      ,  1.      , -1.570796])
    """
    return motions.inverse(with_axes(a_from_b, "a_from_b", 3))


def between(a: ArrayLike, b: ArrayLike) -> Array:
    """Pose of b in the frame of a, `(..., 3)` each, in one world: `inverse(a)` followed by b.

    Examples
    --------
    >>> between((1, 2, np.pi / 2), (1, 3, np.pi / 2)).round(6)
    array([1., 0., 0.])
    """
    return motions.between(with_axes(a, "a", 3), with_axes(b, "b", 3))


def transform(a_from_b: ArrayLike, points: ArrayLike) -> Array:
    """Carry points (or segments) `(..., 2)`, given in b, into a.

    One pose `(3,)` moves everything; k poses `(k, 3)` move k groups `(k, m, 2)`, or give k copies
    of one group `(m, 2)`.

    Examples
    --------
    >>> transform((1, 2, np.pi / 2), [(1, 0), (0, 1)]).round(6)
    array([[1., 3.],
           [0., 2.]])
    """
    return motions.transform(with_axes(a_from_b, "a_from_b", 3), with_axes(points, "points", 2))


@checked
def interpolate(
    times: ArrayLike,
    poses: ArrayLike,
    at: ArrayLike,
    *,
    max_gap: Annotated[Seconds, at_least(0), at_most(np.inf)] = np.inf,
) -> Array:
    """Poses at other times: linear in x and y, by the shorter way round in heading (A 3.3.3).

    Parameters
    ----------
    times, poses : (k,) array, seconds; (k, 3) array, metres and radians
        The known ones; times do not decrease.
    at : (m,) array, seconds
        Where poses are wanted.
    max_gap
        Between two poses farther apart than this nothing is claimed.

    Returns
    -------
    (m, 3) array, metres and radians
        A row of NaN for each time outside `times` or inside a gap longer than `max_gap`.

    Examples
    --------
    >>> interpolate([0, 1], [(0, 0, 3), (1, 0, -3)], [0.5, 2]).round(6)
    array([[ 0.5     ,  0.      , -3.141593],
           [      nan,       nan,       nan]])
    """
    t, p, at = numbers(times, "times"), with_axes(poses, "poses", 3), values(at, "at")
    if t.ndim != 1 or p.shape != (len(t), 3):
        raise ValueError(f"poses must be ({t.size}, 3), one for each time, got {p.shape}")
    if not len(t) or not np.isfinite(t).all() or np.any(np.diff(t) < 0):
        raise ValueError("times must hold at least one time, be finite and not decrease")
    if at.ndim != 1:
        raise ValueError(f"at must have shape (m,), got {at.shape}")
    after = np.clip(np.searchsorted(t, at, side="left"), 0, len(t) - 1)
    before = np.where(t[after] == at, after, np.maximum(after - 1, 0))
    span = t[after] - t[before]
    part = np.where(span > 0, (at - t[before]) / np.where(span > 0, span, 1), 0)
    step = p[after] - p[before]
    step[:, 2] = wrap(step[:, 2])
    poses_at = p[before] + part[:, None] * step
    poses_at[:, 2] = wrap(poses_at[:, 2])
    covered = (at >= t[0]) & (at <= t[-1]) & (span <= max_gap)
    return np.where(covered[:, None], poses_at, np.nan)
