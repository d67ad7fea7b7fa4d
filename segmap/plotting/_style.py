"""Colours, sizes and axes that all pictures share."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Annotated, Any, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, is_color_like, to_rgba, to_rgba_array
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array, Quantity

T = TypeVar("T")
#: The width of a line or the size of a dot.
Points = Annotated[float, Quantity("points", least=0, most=1000)]

RAW = "#949494"  #: grey: what the sensor measured, and what a method dropped
MAP = "#000000"  #: black: a map of segments
RESULT = "#0072b2"  #: blue: what a method makes of it
TRUTH = "#007a58"  #: green: how it really is
ERROR = "#d55e00"  #: orange: what is wrong, and by how much

#: Colours of groups, used in turn.
GROUPS = (
    *("#c47f00", "#2299c4", "#009e73", "#0072b2", "#d55e00"),
    *("#cc79a7", "#882255", "#999933", "#332288"),
)
#: From no error (grey) to the largest (dark red).
ERRORS = LinearSegmentedColormap.from_list("errors", ["#949494", "#c47f00", ERROR, "#7a1f00"])

#: Inches: such a picture takes about 30 KB in a notebook.
FIGURE_INCHES = (6.0, 4.5)
#: Dots an inch.
DPI = 72


def sharp_figures() -> None:
    """Show the figures of a notebook at 72 dots an inch, and sharp on screens with finer dots.

    Each figure is drawn with two dots in a row for each dot on the page; its size stays. Outside
    of a notebook only `figure.dpi` is set.

    Examples
    --------
    >>> sharp_figures()
    """
    import matplotlib.pyplot as plt

    plt.rcParams["figure.dpi"] = DPI
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if hasattr(shell, "kernel"):
        from matplotlib_inline.backend_inline import set_matplotlib_formats

        set_matplotlib_formats("retina")  # type: ignore[no-untyped-call]


def group_colors(groups: NDArray[np.int64]) -> Array:
    """Red, green, blue and opacity, `(n, 4)`, of groups `(n,)`; -1 is none.

    Examples
    --------
    >>> group_colors(np.array([0, 9, -1]))[:, 0].round(2)
    array([0.77, 0.77, 0.58])
    """
    return np.where(groups[:, None] < 0, to_rgba(RAW), to_rgba_array(GROUPS)[groups % len(GROUPS)])


def axes_or_new(ax: Axes | None, size: tuple[float, float] = FIGURE_INCHES) -> Axes:
    """The axes given, or those of a new pyplot figure of a size in inches."""
    return arrays.instance(ax, "ax", Axes) if ax is not None else axes_row(1, size)[0]


def shade(color: Any, name: str = "color") -> Any:
    """One colour that matplotlib knows, called by the name of an argument."""
    if color is None or not is_color_like(color):
        expected = f"must be a colour, '{RESULT}' or 'red' say, got {arrays.brief(color)}"
        raise ValueError(f"{name} {expected}")
    return color


def not_empty(things: Mapping[str, T], name: str) -> Mapping[str, T]:
    """What is drawn side by side: one picture at least."""
    if not arrays.instance(things, name, Mapping):
        raise ValueError(f"{name} must hold one thing to draw at least, got none")
    return things


def inches(size: tuple[float, float]) -> tuple[float, float]:
    """Width and height of a picture."""
    width, height = (
        arrays.number(side, "size", above=0, most=1000, unit="inches")
        for side in arrays.row(size, "size", 2)
    )
    return width, height


def axes_row(count: int, size: tuple[float, float], *, shared: str = "") -> list[Axes]:
    """Axes side by side in a new pyplot figure of a size in inches; "y" or "xy" are shared."""
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=inches(size), dpi=DPI, layout="constrained")
    x, y = "x" in shared, "y" in shared
    return list(figure.subplots(1, count, squeeze=False, sharex=x, sharey=y)[0])


def legend_below(ax: Axes) -> None:
    """Put the legend below a map."""
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2, frameon=False)


def axes_grid(titles: list[str], columns: int, size: tuple[float, float]) -> list[Axes]:
    """Axes in a new pyplot figure, one a title, in rows of so many columns, with common limits."""
    import matplotlib.pyplot as plt

    rows, (width, height) = -(-len(titles) // arrays.whole(columns, "columns")), inches(size)
    whole = plt.figure(figsize=(columns * width, rows * height), dpi=DPI, layout="constrained")
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
