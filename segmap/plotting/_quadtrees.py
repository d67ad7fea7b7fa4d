"""Quadtree maps: leaves as squares of grey (B 6), cells of them, rays, grids for robots."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array, checked
from ..quadtree import QuadtreeMap, extent
from ._style import ERROR, RESULT, axes_or_new, map_axes

#: Outlines of leaves smaller than this part of the picture would hide what they surround.
SMALLEST_LEAF_PART = 1 / 80


@checked
def draw_quadtree(
    map: QuadtreeMap,
    *,
    ax: Axes | None = None,
    robot: ArrayLike | None = None,
    outlines: bool = True,
) -> Axes:
    """Draw a map as the thesis does: black is occupied, white is free, half grey is unknown.

    Parameters
    ----------
    robot
        Where the robot is, `(2,)` or a pose: an orange square.
    outlines
        Blue outlines of all leaves that are large enough to be seen inside them; without them the
        look is that of any occupancy map. The part where beams ended is shown.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> tree = QuadtreeMap(resolution=0.1, size=1.6)
    >>> tree.insert_scan((0.2, 0.2), [(1.0, 0.2)])
    >>> ax = draw_quadtree(tree, ax=Figure().subplots())
    >>> len(ax.collections[0].get_array())
    13
    """
    map = deepcopy(arrays.instance(map, "map", QuadtreeMap))  # as it is now
    leaves = map.leaves()
    place = None if robot is None else arrays.row(robot, "robot")[:2]
    ax = axes_or_new(ax)
    squares = square_corners(leaves.x, leaves.y, leaves.side)
    grey = PolyCollection(squares, cmap="gray", antialiased=False, linewidth=0)
    grey.set_array(1 - map.leaf_occupancy())
    grey.set_clim(0, 1)
    ax.add_collection(grey, autolim=False)
    x_min, y_min, x_max, y_max = extent(map)
    if outlines:
        seen = leaves.side >= SMALLEST_LEAF_PART * max(x_max - x_min, y_max - y_min)
        lines = PolyCollection(squares[seen], edgecolor=RESULT, facecolor="none", linewidth=0.4)
        ax.add_collection(lines, autolim=False)
    if place is not None:
        ax.plot(*arrays.point(place, "robot"), "s", color=ERROR, markersize=5)
    map_axes(ax).set(xlim=(x_min, x_max), ylim=(y_min, y_max))
    return ax


def square_corners(left: NDArray[Any], low: NDArray[Any], side: Array) -> Any:
    """Corners of squares, `(n, 4, 2)`."""
    x = left[:, None] + side[:, None] * (0, 1, 1, 0)
    y = low[:, None] + side[:, None] * (0, 0, 1, 1)
    return np.stack([x, y], -1)
