"""Scores around a pose: hills and needles, and the way of a matcher over them."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ..matching import Landscape, peaks
from ._style import ERROR, RESULT, TRUTH, axes_or_new


def draw_landscape(
    land: Landscape, *, ax: Axes | None = None, tops: bool = True, truth: bool = True
) -> Axes:
    """Draw scores around a pose: white is best, red dots are the peaks.

    Parameters
    ----------
    land : Landscape
    ax : matplotlib Axes or None
    tops : bool
        Mark all peaks.
    truth : bool
        A green cross in the middle.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> land = Landscape(np.array([-0.1, 0.0, 0.1]), np.array([[0, 0, 0], [0, 2, 0], [0, 0, 1]]))
    >>> draw_landscape(land, ax=Figure().subplots()).get_xlabel()
    'offset in x [m]'
    """
    ax = axes_or_new(ax)
    half = (land.offsets[1] - land.offsets[0]) / 2
    edges = land.offsets[0] - half, land.offsets[-1] + half
    ax.imshow(land.values, origin="lower", extent=(*edges, *edges), cmap="gray")
    if tops:
        rows, columns = peaks(land.values).T
        ax.plot(land.offsets[columns], land.offsets[rows], ".", color=ERROR, markersize=4)
    if truth:
        ax.plot(0, 0, "+", color=TRUTH, markersize=15, markeredgewidth=3)
    ax.set(xlabel="offset in x [m]", ylabel="offset in y [m]", aspect="equal")
    ax.set(xlim=edges, ylim=edges)
    return ax


def draw_climb(offsets: ArrayLike, *, ax: Axes, joined: bool = True) -> Axes:
    """Draw poses of a matcher over a landscape: in blue, the last one larger.

    Parameters
    ----------
    offsets : (k, 2) or (k, 3) array, metres
        From the middle of the landscape.
    ax : matplotlib Axes
    joined : bool
        A line through them in their order; else dots.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_climb([(0.1, 0.1), (0.0, 0.1)], ax=Figure().subplots())
    >>> len(ax.lines)
    2
    """
    way = np.asarray(offsets, float)[:, :2]
    ax.plot(*way.T, "-o" if joined else ".", color=RESULT, markersize=3, linewidth=1)
    ax.plot(*way[-1], "o", color=RESULT, markersize=8, markeredgecolor="white")
    return ax
