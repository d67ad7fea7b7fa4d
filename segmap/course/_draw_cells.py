"""Cells of a quadtree map, rays, grids for robots."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import ArrayLike

from ..exports import Classes
from ..literal import crossed_cells, ray_cells
from ..plotting import ERROR, RAW, RESULT, axes_or_new, map_axes, square_corners
from ..quadtree import QuadtreeMap


def draw_cells(
    map: QuadtreeMap, cells: ArrayLike, *, ax: Axes | None = None, color: str = ERROR
) -> Axes:
    """Draw chosen cells of a map's grid as squares, over what the axes show already.

    Parameters
    ----------
    map : QuadtreeMap
    cells : (n, n) bool array
        Which cells of `map.to_grid()`, or of a coarser one: row 0 is the lowest.
    ax : matplotlib Axes or None
    color : str

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        For an array that is not square: the grid of a map is.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> map = QuadtreeMap(resolution=0.1, size=1.6)
    >>> map.insert_scan((0.2, 0.2), [(1.0, 0.2)])
    >>> ax = draw_cells(map, map.to_grid() > 0.5, ax=Figure().subplots())
    >>> len(ax.collections[0].get_paths())
    1
    """
    chosen = np.asarray(cells, bool)
    if chosen.ndim != 2 or chosen.shape[0] != chosen.shape[1]:
        raise ValueError(f"cells must be those of a square grid, got shape {chosen.shape}")
    ax, (left, low, _, _) = axes_or_new(ax), map.bounds
    side = map.side / max(len(chosen), 1)
    rows, columns = np.nonzero(chosen)
    squares = square_corners(left + columns * side, low + rows * side, np.full(len(rows), side))
    ax.add_collection(PolyCollection(squares, facecolor=color, antialiased=False, linewidth=0))
    return map_axes(ax)


def draw_ray(start: ArrayLike, end: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw the cells of a ray (B 4.4): blue what it crosses, grey what the mask at its end spares.

    Parameters
    ----------
    start, end : (2,) int
        Column and row.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_ray((0, 0), (14, 5), ax=Figure().subplots())
    >>> [len(squares.get_paths()) for squares in ax.collections]
    [13, 2]
    """
    ax, ends = axes_or_new(ax), np.array([start, end], np.int64)
    (a, b), (c, d) = ends.tolist()
    crossed = crossed_cells((a, b), (c, d))
    spared = [cell for cell in ray_cells((a, b), (c, d)) if cell not in crossed]
    for cells, color in ((crossed, RESULT), (spared, RAW)):
        x, y = np.reshape(cells, (-1, 2)).T
        squares = square_corners(x, y, np.ones(len(x)))
        ax.add_collection(PolyCollection(squares, facecolor=color, linewidth=0))
    ax.plot(*(ends + 0.5).T, color=ERROR)
    (left, low), (right, high) = ends.min(0), ends.max(0) + 1
    ax.set(xlim=(left, right), ylim=(low, high), xlabel="column", ylabel="row", aspect="equal")
    ax.set(xticks=range(left, right + 1), yticks=range(low, high + 1))
    ax.grid(alpha=0.5)
    return ax


def draw_classes(classes: Classes, *, ax: Axes | None = None) -> Axes:
    """Draw what a robot is given: white is free, black occupied, grey unknown.

    Parameters
    ----------
    classes : Classes
        From `exports.ros_classes`, or a picture read back, its rows turned so that 0 is the lowest.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> greys = np.array([[254, 205, 0]], np.uint8)
    >>> ax = draw_classes(Classes(greys, left=2.0, low=0.0, side=0.5), ax=Figure().subplots())
    >>> [float(x) for x in ax.get_xlim()]
    [2.0, 3.5]
    """
    ax, (rows, columns) = axes_or_new(ax), classes.greys.shape
    right, high = classes.left + columns * classes.side, classes.low + rows * classes.side
    edges = (classes.left, right, classes.low, high)
    ax.imshow(classes.greys, cmap="gray", vmin=0, vmax=254, origin="lower", extent=edges)
    return map_axes(ax)
