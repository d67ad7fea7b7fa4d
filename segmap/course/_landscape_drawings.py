"""Scores around a pose, the way of a matcher over them, and who was lost."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ..matching import DistanceField
from ..plotting import ERROR, RESULT, TRUTH, axes_or_new, map_axes
from ._landscapes import Landscape, peaks, profile_peaks
from ._trials import Trial

#: Marks of matchers, used in turn.
MARKS = "os^vDX"


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


def draw_profile(
    turn: ArrayLike, values: ArrayLike, *, ax: Axes | None = None, tops: bool = True
) -> Axes:
    """Draw scores over the heading: a blue line, red dots at its peaks.

    Parameters
    ----------
    turn : (m,) array, radians
        From the true heading.
    values : (m,) array
        Both from `heading_profile`.
    ax : matplotlib Axes or None
    tops : bool
        Mark all peaks.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_profile([-1, 0, 1, 2], [0, 2, 0, 1], ax=Figure().subplots())
    >>> ax.lines[1].get_ydata().tolist()
    [2.0, 1.0]
    """
    ax, scores = axes_or_new(ax), np.asarray(values, float)
    degrees = np.degrees(np.asarray(turn, float))
    ax.plot(degrees, scores, color=RESULT)
    if tops:
        found = profile_peaks(np.radians(degrees), scores)
        ax.plot(degrees[found], scores[found], "o", color=ERROR)
    ax.set(xlabel="heading off by [degrees]", ylabel="score")
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
    return map_axes(ax)


def draw_trials(trials: Iterable[Trial], *, ax: Axes | None = None) -> Axes:
    """Draw the error of each trial over the leaves of its map, a mark a matcher (B Fig. 6.17).

    Those with the thesis' steps are red, the others blue. Both axes are logarithmic.

    Parameters
    ----------
    trials : iterable of Trial
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.course import load_trials
    >>> len(draw_trials(load_trials(), ax=Figure().subplots()).lines)
    4
    """
    ax, all_of = axes_or_new(ax), list(trials)
    for k, matcher in enumerate(dict.fromkeys(trial.matcher for trial in all_of)):
        mine = [trial for trial in all_of if trial.matcher == matcher]
        leaves, off = [t.leaves for t in mine], [1000 * t.median for t in mine]
        color = ERROR if "thesis" in matcher else RESULT
        ax.plot(leaves, off, MARKS[k % len(MARKS)], color=color, label=matcher)
    ax.set(xscale="log", yscale="log", xlabel="leaves of the map", ylabel="median error [mm]")
    ax.legend(fontsize=9)
    return ax
