"""Leaves of a quadtree as arrays, and their numbers as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array

if TYPE_CHECKING:
    import pandas as pd


class Leaves(NamedTuple):
    """Leaves as arrays `(n,)`: lower left corner and side in metres, rays that crossed, ends.

    Examples
    --------
    >>> from segmap.quadtree import QuadtreeMap
    >>> QuadtreeMap(resolution=0.5, size=2).leaves().side
    array([1., 1., 1., 1.])
    """

    x: Array
    y: Array
    side: Array
    vis: NDArray[np.int32]
    occ: NDArray[np.int32]


def counted(level: NDArray[np.int64], resolution: float, nbytes: int, top: int) -> pd.DataFrame:
    """Leaves by side from their levels, and the bytes of a tree of `2^top` cells a side."""
    import pandas as pd

    sides, counts = np.unique(level, return_counts=True)
    names = [f"leaves of {side:.6g} m" for side in np.ldexp(resolution, sides)]
    rows = dict(zip(names, counts.tolist(), strict=True))
    rows |= {"leaves": len(level), "bytes": nbytes, "bytes of a grid": 4**top}
    return pd.DataFrame({"count": rows})
