"""Exercise of the chapter on pose graphs."""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..poses import between
from ._exercise import Case, Exercise, Mistake


def edge_error(first: Array, second: Array, relative: Array) -> Array:
    """What two poses leave of the motion that was measured between them (Grisetti et al. 2010).

    Parameters
    ----------
    first, second : (3,) array, metres and radians
    relative : (3,) array, metres and radians
        Measured pose of the second in the frame of the first.

    Returns
    -------
    (3,) array, metres and radians
        The second pose in the frame of where the measurement puts it, heading in `[-pi, pi)`.

    Examples
    --------
    >>> edge_error(np.array([0, 0, np.pi / 2]), np.array([0, 2, np.pi / 2]), np.array([1.9, 0, 0])
    ...            ).round(6) + 0.0
    array([0.1, 0. , 0. ])
    """
    return between(relative, between(first, second))


def _not_wrapped(first: Array, second: Array, relative: Array) -> Array:
    error = edge_error(first, second, relative)
    return np.append(error[:2], second[2] - first[2] - relative[2])


def _edge(words: str, first: ArrayLike, second: ArrayLike, relative: ArrayLike) -> Case:
    return Case(words, tuple(np.array(pose, float) for pose in (first, second, relative)))


check_edge_error = Exercise(
    "edge_error",
    "edge_error(first, second, relative) -> (3,): pose of the second (x, y, heading) in the frame "
    "of where the measured motion `relative`, in the frame of the first, would put it",
    edge_error,
    (
        _edge("two poses along x, one metre measured", (0, 0, 0), (1.2, 0, 0), (1, 0, 0)),
        _edge("a robot that looks along y", (2, 1, np.pi / 2), (2, 3, np.pi / 2), (1.9, 0.1, 0)),
        _edge("a turn on the way", (1, 2, 0.7), (2.5, 3, 1.9), (1.7, 0.2, 1.1)),
        _edge("a turn over half a turn", (0, 0, 3.0), (-1, 0.2, -3.0), (1.0, -0.1, 0.2)),
    ),
    (
        Mistake(
            "plain differences",
            lambda a, b, z: b - a - z,
            "poses are not numbers: where the second lies depends on where the first one looks; "
            "take segmap.poses.between(first, second)",
        ),
        Mistake(
            "measurement subtracted",
            lambda a, b, z: between(a, b) - z,
            "the difference of two motions is again one: seen from where the measurement ends, "
            "which looks elsewhere; compose its inverse in front, do not subtract",
        ),
        Mistake(
            "composed in the other order",
            lambda a, b, z: between(between(a, b), z),
            "the wrong way round: the measured place seen from the second pose is the inverse "
            "of what is asked",
        ),
        Mistake(
            "ends exchanged",
            lambda a, b, z: between(z, between(b, a)),
            "relative is the pose of the second in the frame of the first: between(first, second)",
        ),
        Mistake(
            "not wrapped",
            _not_wrapped,
            "headings 3.0 and -3.0 are 0.28 apart, not 6: wrap the difference",
        ),
        Mistake(
            "length only",
            lambda a, b, z: np.hypot(*edge_error(a, b, z)[:2]),
            "all three parts are asked for, not only how far the place is off",
        ),
    ),
)
