"""Quadtree maps: leaves as squares of grey (B 6), cells of them, rays, grids for robots."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..exports import Classes
from ..matching import DistanceField
from ..quadtree import QuadtreeMap, extent
from ..testing import ray_cells
from ._style import ERROR, RAW, RESULT, axes_or_new, dressed, new_row

#: Outlines of leaves smaller than this part of the picture would hide what they surround.
SMALLEST = 1 / 80


def draw_quadtree(
    map: QuadtreeMap,
    *,
    ax: Axes | None = None,
    robot: ArrayLike | None = None,
    outlines: bool = True,
    whole: bool = False,
) -> Axes:
    """Draw a map as the thesis does: black is occupied, white is free, half grey is unknown.

    Parameters
    ----------
    map : QuadtreeMap
    ax : matplotlib Axes or None
    robot : (2,) or (3,) array, metres, or None
        Where the robot is: a red square.
    outlines : bool
        Blue outlines of all leaves that are large enough to be seen inside them; without them the
        look is that of any occupancy map.
    whole : bool
        Show the whole root instead of the part where beams ended.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> map = QuadtreeMap(resolution=0.1, size=1.6)
    >>> map.insert_scan((0.2, 0.2), [(1.0, 0.2)])
    >>> ax = draw_quadtree(map, ax=Figure().subplots(), whole=True)
    >>> len(ax.collections[0].get_array())
    13
    """
    ax, leaves = axes_or_new(ax), map.leaves()
    squares = _squares(leaves.x, leaves.y, leaves.side)
    grey = PolyCollection(squares, cmap="gray", antialiased=False, linewidth=0)
    grey.set_array(1 - map.leaf_occupancy())
    grey.set_clim(0, 1)
    ax.add_collection(grey, autolim=False)
    left, low, right, high = map.bounds if whole else extent(map)
    if outlines:
        seen = leaves.side >= SMALLEST * max(right - left, high - low)
        lines = PolyCollection(squares[seen], edgecolor=RESULT, facecolor="none", linewidth=0.4)
        ax.add_collection(lines, autolim=False)
    if robot is not None:
        ax.plot(*np.asarray(robot, float)[:2], "s", color=ERROR, markersize=5)
    dressed(ax).set(xlim=(left, right), ylim=(low, high))
    return ax


def draw_quadtrees(
    maps: Mapping[str, QuadtreeMap], *, size: tuple[float, float] = (2.25, 2.5), **options: Any
) -> list[Axes]:
    """Draw maps side by side, each with limits of its own.

    Parameters
    ----------
    maps : mapping from title to QuadtreeMap
    size : (width, height) in inches
        Of one picture.
    **options
        Of `draw_quadtree`, the same for all.

    Returns
    -------
    list of Axes
        One a map, in a new figure.

    Examples
    --------
    >>> maps = {f"{size} m": QuadtreeMap(resolution=1, size=size) for size in (4, 8)}
    >>> [(ax.get_title(), float(ax.get_xlim()[1])) for ax in draw_quadtrees(maps, whole=True)]
    [('4 m', 4.0), ('8 m', 8.0)]
    """
    row = new_row(len(maps), (len(maps) * size[0], size[1]))
    for ax, (title, map) in zip(row, maps.items(), strict=True):
        draw_quadtree(map, ax=ax, **options).set_title(title, fontsize=10)
    return row


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
    squares = _squares(left + columns * side, low + rows * side, np.full(len(rows), side))
    ax.add_collection(PolyCollection(squares, facecolor=color, antialiased=False, linewidth=0))
    return dressed(ax)


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
    cells = ray_cells((a, b), (c, d))
    spared = np.abs(cells - ends[1]).max(1) <= 1
    for part, color in ((cells[~spared], RESULT), (cells[spared], RAW)):
        squares = _squares(part[:, 0], part[:, 1], np.ones(len(part)))
        ax.add_collection(PolyCollection(squares, facecolor=color, linewidth=0))
    ax.plot(*(ends + 0.5).T, color=ERROR)
    (left, low), (right, high) = ends.min(0), ends.max(0) + 1
    ax.set(xlim=(left, right), ylim=(low, high), xlabel="column", ylabel="row", aspect="equal")
    ax.set(xticks=range(left, right + 1), yticks=range(low, high + 1))
    ax.grid(alpha=0.5)
    return ax


def draw_field(field: DistanceField, *, ax: Axes | None = None) -> Axes:
    """Draw a distance field: the darker, the nearer an occupied cell; a bar tells the metres.

    Parameters
    ----------
    field : DistanceField
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.quadtree import QuadtreeMap
    >>> map = QuadtreeMap(resolution=0.1, size=1.6)
    >>> map.insert_scan((0.2, 0.2), [(1.0, 0.2)])
    >>> draw_field(DistanceField(map), ax=Figure().subplots()).images[0].get_array().shape
    (16, 16)
    """
    ax, (left, low, right, high) = axes_or_new(ax), field.bounds
    picture = ax.imshow(field.distance, origin="lower", extent=(left, right, low, high))
    ax.figure.colorbar(picture, ax=ax, label="distance [m]")
    return dressed(ax)


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
    return dressed(ax)


def _squares(left: NDArray[Any], low: NDArray[Any], side: Array) -> Any:
    """Corners of squares, `(n, 4, 2)`."""
    x = left[:, None] + side[:, None] * (0, 1, 1, 0)
    y = low[:, None] + side[:, None] * (0, 0, 1, 1)
    return np.stack([x, y], -1)
