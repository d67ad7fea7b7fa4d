"""What text logs leave unsaid of a SICK: where its beams point, and which ranges are none.

Both rules were confirmed on the logs of the Intel Research Lab, Freiburg building 079 and others.
"""

from collections.abc import Iterable

import numpy as np

from ..arrays import Array

#: Top of the scale of each measuring mode and the range from which it means "nothing met", metres.
#: In the last mode the sensor can tell up to 81.91, but answers of 50 m and more are none.
MODES = ((8.2, 8.18), (32.77, 32.76), (np.inf, 50.0))


def half_turn(count: int) -> Array:
    """Directions of the beams of a sensor that looks over half a turn, (count,) array, radians.

    An even number starts at -90 degrees and leaves the end point out; an odd one holds both ends.

    Examples
    --------
    >>> np.degrees(half_turn(5)), np.degrees(half_turn(4))
    (array([-90., -45.,   0.,  45.,  90.]), array([-90., -45.,   0.,  45.]))
    """
    if count == 1:
        return np.zeros(1)
    return np.linspace(-np.pi / 2, np.pi / 2, count, endpoint=count % 2 == 1)


def no_return(ranges: Iterable[Array]) -> float:
    """The range from which on the sensor met nothing, metres, from all `(n,)` ranges of a log.

    It depends on the measuring mode, which the largest finite range of the whole log betrays: a
    wall at 8.18 m is one in a log that also holds 20 m.

    Examples
    --------
    >>> no_return([np.array([1.0, 8.19])]), no_return([np.array([1.0, 8.19]), np.array([20.0])])
    (8.18, 32.76)
    """
    largest = max((float(r[np.isfinite(r)].max(initial=0.0)) for r in ranges), default=0.0)
    return next(limit for top, limit in MODES if largest <= top)


def clean(ranges: Array, limit: float) -> Array:
    """Ranges `(n,)`, metres, with `inf` where nothing was met, NaN where the value is no distance.

    Examples
    --------
    >>> clean(np.array([1.0, 81.83, -1.0, 0.0]), 50.0)
    array([ 1., inf, nan, nan])
    """
    return np.where(ranges >= limit, np.inf, np.where(ranges > 0, ranges, np.nan))


#: Turn from one beam of an URG-04LX to the next, radians, and how far it sees, metres.
URG_STEP = 2 * np.pi / 1024
URG_REACH = 5.6


def centred(count: int, step: float) -> Array:
    """Directions of beams `step` apart, as many left as right: (count,) array, radians.

    Examples
    --------
    >>> centred(3, 0.5)
    array([-0.5,  0. ,  0.5])
    """
    return (np.arange(count, dtype=float) - (count - 1) / 2) * step
