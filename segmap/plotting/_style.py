"""Colours, sizes and axes that all pictures share."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgba, to_rgba_array
from numpy.typing import NDArray

from ..arrays import Array

RAW = "#b0b0b0"  #: light grey: what the sensor measured, and what a method dropped
MAP = "#000000"  #: black: a map of segments
RESULT = "#0072b2"  #: blue: what a method makes of it
TRUTH = "#009e73"  #: green: how it really is
ERROR = "#d55e00"  #: red: what is wrong, and by how much

#: Colours of groups, used in turn.
GROUPS = (
    *("#e69f00", "#56b4e9", "#009e73", "#0072b2", "#d55e00"),
    *("#cc79a7", "#882255", "#999933", "#332288"),
)
#: From no error (light grey) to the largest (dark red).
ERRORS = LinearSegmentedColormap.from_list("errors", ["#d0d0d0", "#e69f00", ERROR, "#7a1f00"])

#: Inches, and dots an inch: such a picture takes about 30 KB in a notebook.
SIZE, DPI = (6.0, 4.5), 72


def group_colors(groups: NDArray[np.int64]) -> Array:
    """Colours of groups.

    Parameters
    ----------
    groups : (n,) int array
        -1 for none.

    Returns
    -------
    (n, 4) array
        Red, green, blue, opacity in `[0, 1]`.

    Examples
    --------
    >>> group_colors(np.array([0, 9, -1]))[:, 0].round(2)
    array([0.9 , 0.9 , 0.69])
    """
    return np.where(groups[:, None] < 0, to_rgba(RAW), to_rgba_array(GROUPS)[groups % len(GROUPS)])


def axes_or_new(ax: Axes | None, size: tuple[float, float] = SIZE) -> Axes:
    """The axes given, or those of a new pyplot figure of a size in inches."""
    return ax if ax is not None else axes_row(1, size)[0]


def axes_row(count: int, size: tuple[float, float], *, shared: str = "") -> list[Axes]:
    """Axes side by side in a new pyplot figure of a size in inches; "y" or "xy" are shared."""
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=size, dpi=DPI, layout="constrained")
    x, y = "x" in shared, "y" in shared
    return list(figure.subplots(1, count, squeeze=False, sharex=x, sharey=y)[0])


def axes_grid(titles: list[str], columns: int, size: tuple[float, float]) -> list[Axes]:
    """Axes in a new pyplot figure, one a title, in rows of so many columns, with common limits."""
    import matplotlib.pyplot as plt

    rows = -(-len(titles) // columns)
    whole = plt.figure(figsize=(columns * size[0], rows * size[1]), dpi=DPI, layout="constrained")
    grid = whole.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for ax in grid.flat[len(titles) :]:
        ax.remove()
    for ax, title in zip(grid.flat, titles, strict=False):
        ax.set_title(title)
    return list(grid.flat[: len(titles)])


def map_axes(ax: Axes) -> Axes:
    """The axes with equal scales, fitted to what they hold, labelled in metres."""
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    return ax
