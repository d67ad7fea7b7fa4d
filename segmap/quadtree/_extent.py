"""The part of a map that is worth looking at."""

import numpy as np

from ._map import QuadtreeMap


def extent(map: QuadtreeMap, *, margin: float = 0.08) -> tuple[float, float, float, float]:
    """Left, low, right and high edge of where beams ended; the whole root where none did.

    Parameters
    ----------
    map : QuadtreeMap
    margin : float
        Space around it, as a part of the larger of width and height.

    Returns
    -------
    (4,) tuple, metres

    Raises
    ------
    ValueError
        For a margin that is negative or not finite.

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.5)
    >>> map.insert_scan((0, 0), [(10, 2)])
    >>> extent(map, margin=1)
    (9.5, 1.5, 11.0, 3.0)
    """
    if not 0 <= margin < np.inf:
        raise ValueError(f"margin must be at least 0, got {margin}")
    leaves = map.leaves()
    hit = leaves.occ > 0
    if not hit.any():
        return map.bounds
    x, y, side = leaves.x[hit], leaves.y[hit], leaves.side[hit]
    left, low, right, high = x.min(), y.min(), (x + side).max(), (y + side).max()
    space = margin * max(right - left, high - low)
    return float(left - space), float(low - space), float(right + space), float(high + space)
