"""Hough space (A 4.2.1): a line as its distance from the origin and the angle of its normal."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array
from ..compiled import compiled
from ..segments import angle, midpoint


def hough(segments: ArrayLike, near: ArrayLike | None = None) -> Array:
    """Lines of segments in Hough space: rho and theta of `x cos(theta) + y sin(theta) = rho`.

    Theta is the angle of the normal, not of the segment. (rho, theta) and (-rho, theta + pi) are
    one line: of all such pairs the one whose theta is nearest to `near` is returned. Theta may then
    lie outside `[0, pi)`.

    Parameters
    ----------
    segments : (..., 2, 2) array, metres
        Each longer than 1e-9 m: a point has no line.
    near : (...) array, radians, or None
        None gives theta in `[0, pi)`.

    Returns
    -------
    (..., 2) array, metres and radians
        Rho, of either sign, and theta.

    Examples
    --------
    >>> upright = np.array([(2.0, 0.0), (2.0, 1.0)])
    >>> hough(upright).round(4)
    array([2., 0.])
    >>> hough(upright, near=3.0).round(4)
    array([-2.    ,  3.1416])
    """
    theta = (angle(segments) + np.pi / 2) % np.pi
    middle = midpoint(segments)
    rho = middle[..., 0] * np.cos(theta) + middle[..., 1] * np.sin(theta)
    # A 5.4.2 compares rho and theta as they come: two upright walls would then seldom agree.
    wanted = theta if near is None else arrays.values(near, "near")
    turns = np.round((wanted - theta) / np.pi)
    return np.stack([np.where(turns % 2 == 0, rho, -rho), theta + turns * np.pi], axis=-1)


@compiled
def hough_line_of(s: Array, i: int) -> tuple[float, float]:
    """Rho, metres, and theta of the normal, in `[0, pi)`, of one of `(n, 2, 2)` segments."""
    theta = (np.arctan2(s[i, 1, 1] - s[i, 0, 1], s[i, 1, 0] - s[i, 0, 0]) + np.pi / 2) % np.pi
    theta = 0.0 if theta == np.pi else theta
    x, y = (s[i, 0, 0] + s[i, 1, 0]) / 2, (s[i, 0, 1] + s[i, 1, 1]) / 2
    return x * np.cos(theta) + y * np.sin(theta), theta
