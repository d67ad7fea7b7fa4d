"""What the distance between two segments measures."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ..angles import axial_mean_of_two
from ..arrays import Array
from ..plotting import ERROR, MAP, RAW, axes_grid, draw_segments
from ..segments import angle, length, midpoint


def draw_distance_terms(u: ArrayLike, v: ArrayLike) -> list[Axes]:
    """Draw, red, where the three terms of the distance between two segments are measured.

    *Turned* is the mean of the lengths of the two red lines; from where both are laid off, a dotted
    line runs parallel to the line midway. *Shifted* and *apart* are one red line each.

    Parameters
    ----------
    u, v : (2, 2) array, metres
        That do not cross and are not perpendicular; drawn black, the line midway between them grey.

    Returns
    -------
    list of Axes
        Three, in a new figure, titled with what the red lines measure.

    Examples
    --------
    >>> u, v = [(0, 0), (2, 0)], [(0, 0.1), (2, 0.1)]
    >>> [ax.get_title() for ax in draw_distance_terms(u, v)]
    ['Turned: 0.00 m', 'Shifted: 0.05 m', 'Apart: 0.10 m']
    """
    both = np.asarray([u, v], float)
    middle, mean = _mean_line(both)
    turns = np.stack([_turn(s, mean) for s in both])
    shift, gap = _shift(both, middle, mean), _gap(both)
    sizes = float(length(turns).mean()), float(length(shift)), float(length(gap))
    names = ("Turned", "Shifted", "Apart")
    titles = [f"{name}: {size:.2f} m" for name, size in zip(names, sizes, strict=True)]
    row = axes_grid(titles, 3, (3.0, 2.2))
    for ax, marks in zip(row, (turns, [shift], [gap]), strict=True):
        _pair(ax, both, middle, mean)
        draw_segments(np.asarray(marks), ax=ax, color=ERROR, width=2.5)
    for s, (_, top) in zip(both, turns, strict=True):
        row[0].plot(*np.array([s[0], top]).T, ":", color=ERROR)
    return row


def _mean_line(both: Array) -> tuple[Array, float]:
    """Point and direction of the line midway, both segments with equal weights."""
    return midpoint(both).mean(0), float(axial_mean_of_two(*angle(both)))


def _pair(ax: Axes, both: Array, middle: Array, mean: float) -> None:
    along = 1.1 * float(length(both).max()) * np.array([np.cos(mean), np.sin(mean)])
    draw_segments([[middle - along, middle + along]], ax=ax, color=RAW)
    draw_segments(both, ax=ax, color=MAP, width=2)


def _turn(s: Array, mean: float) -> Array:
    """From the end of s, across s, to the parallel to the line midway through its start."""
    across = np.array([s[0, 1] - s[1, 1], s[1, 0] - s[0, 0]])
    return np.array([s[1], s[1] + np.tan(mean - angle(s)) * across])


def _shift(both: Array, middle: Array, mean: float) -> Array:
    """From the end point farthest from the line midway to its foot there."""
    along = np.array([np.cos(mean), np.sin(mean)])
    points = both.reshape(-1, 2)
    feet = middle + ((points - middle) @ along)[:, None] * along
    worst = int(np.argmax(np.hypot(*(points - feet).T)))
    return np.array([points[worst], feet[worst]])


def _gap(both: Array) -> Array:
    """From the end point nearest to the other segment to its foot there."""
    found = [_to_segment(p, s) for s, q in (both, both[::-1]) for p in q]
    return min(found, key=lambda line: float(length(line)))


def _to_segment(point: Array, s: Array) -> Array:
    d = s[1] - s[0]
    share = np.clip((point - s[0]) @ d / max(float(d @ d), 1e-12), 0.0, 1.0)
    return np.array([point, s[0] + share * d])
