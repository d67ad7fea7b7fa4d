"""Leaves of a quadtree as arrays, and their numbers as a table."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._display import Table
from ..arrays import Array


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


def counted(level: NDArray[np.int64], resolution: float, nbytes: int, top: int) -> Table:
    """Leaves by side from their levels, and the bytes of a tree of `2^top` cells a side."""
    sides, counts = np.unique(level, return_counts=True)
    rows: list[tuple[object, object]] = [
        (f"leaves of {np.ldexp(resolution, side):.6g} m", count)
        for side, count in zip(sides.tolist(), counts.tolist(), strict=True)
    ]
    rows += [("leaves", len(level)), ("bytes", nbytes)]
    return Table(["", "count"], [*rows, ("bytes of a grid", 4**top)])
