"""Inverse covariances of motions, (3, 3) each: checked, and seen from another frame."""

from __future__ import annotations

import numpy as np

from .. import arrays
from ..arrays import Array

#: Information may lack so much of symmetry by rounding, as a part of its largest entry.
SYMMETRIC = 1e-9


def checked_information(value: object, count: int) -> Array:
    """Information of so many motions, (count, 3, 3) array, metres and radians.

    Raises
    ------
    ValueError
        For another shape, what is not finite, not symmetric, or negative somewhere.
    """
    weight = arrays.values(value, "information")
    if weight.shape != (count, 3, 3) or not np.isfinite(weight).all():
        raise ValueError(
            f"information must be ({count}, 3, 3) and finite, got shape {weight.shape}"
        )
    turned, size = weight.swapaxes(1, 2), np.abs(weight).max(axis=(1, 2))
    wrong = np.abs(weight - turned).max(axis=(1, 2)) > SYMMETRIC * size
    wrong |= np.linalg.eigvalsh((weight + turned) / 2)[:, 0] < -SYMMETRIC * size
    if wrong.any():
        raise ValueError(
            "information must be symmetric and nowhere negative, the inverse of a covariance, but "
            f"information[{wrong.argmax()}] is {weight[wrong.argmax()].tolist()}"
        )
    return weight


def rotate(information: Array, angle: Array) -> Array:
    """Information `(m, 3, 3)` of motions as seen from frames that are turned by angles `(m,)`.

    Examples
    --------
    >>> rotate(np.diag([1.0, 4.0, 9.0])[None], np.array([np.pi / 2])).round(9)[0] + 0.0
    array([[4., 0., 0.],
           [0., 1., 0.],
           [0., 0., 9.]])
    """
    turn = np.zeros((len(angle), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0] = np.sin(angle)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, 2] = 1.0
    in_frames: Array = turn.swapaxes(1, 2) @ information @ turn
    return in_frames
