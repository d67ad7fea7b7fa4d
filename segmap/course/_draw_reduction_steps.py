"""How methods of reduction work: merging, strips, climbing centres, lines by their normals."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Segments
from ..plotting import GROUPS, MAP, RAW, RESULT, axes_or_new, draw_segments, group_colors
from ..reduction import hough
from ._draw_reductions import draw_marked


def draw_merge(
    parts: Segments, wall: ArrayLike, *, ax: Axes | None = None, color: str = RESULT
) -> Axes:
    """Draw the one segment that takes the place of several, and how their ends fall on its line.

    The wall is thick, its parts are thin and black, and a dotted line leads from each of their ends
    to its foot on the line of the wall.

    Parameters
    ----------
    parts : SegmentMap or (n, 2, 2) array, metres
    wall : (2, 2) array, metres
    ax : matplotlib Axes or None
    color : str
        Of the wall.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_merge([[(0, 1), (2, 1)]], [(0, 0), (4, 0)], ax=Figure().subplots())
    >>> ax.collections[0].get_segments()[1].tolist()
    [[2.0, 1.0], [2.0, 0.0]]
    """
    ax, line = axes_or_new(ax, (6.0, 2.4)), np.asarray(wall, float)
    ends, along = arrays.segments(parts).reshape(-1, 2), line[1] - line[0]
    feet = line[0] + ((ends - line[0]) @ along / (along @ along))[:, None] * along
    draw_segments(np.stack([ends, feet], 1), ax=ax, color=RAW, width=1.5)
    ax.collections[-1].set_linestyle(":")
    draw_segments([line], ax=ax, color=color, width=3.0, label="merged")
    return draw_segments(parts, ax=ax, width=1.5, label="its parts")


def draw_strip(walls: Segments, shift: float, tolerance: float, *, ax: Axes | None = None) -> Axes:
    """Draw walls along x and a strip of Fusion: what lies in it is black, the rest red (A 4.4.1).

    Parameters
    ----------
    walls : SegmentMap or (n, 2, 2) array, metres
    shift : float, metres
        Of the line in the middle of the strip, from y = 0.
    tolerance : float, metres
        Half the width of the strip, which is grey.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> walls = np.array([[(0, 0), (1, 0)], [(0, 0.05), (1, 0.05)]])
    >>> ax = draw_strip(walls, 0.0, 0.04, ax=Figure().subplots())
    >>> [len(lines.get_segments()) for lines in ax.collections]
    [1, 1]
    """
    ax, array = axes_or_new(ax, (6.0, 2.4)), arrays.segments(walls)
    ax.axhspan(shift - tolerance, shift + tolerance, color=RAW, alpha=0.4)
    outside = (abs(array[..., 1] - shift) > tolerance + 1e-9).any(axis=1)
    draw_marked(array, outside, ax=ax, color=MAP)
    ax.set_aspect("auto")
    return ax


def draw_centres(ways: ArrayLike, group: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw how the centres of mean shift climb: grey ways from black dots to coloured ones.

    Parameters
    ----------
    ways : (k, n, 2) array
        Where each of n centres is, from the first step to the last.
    group : (n,) int array
        Each group has a colour.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes
        In metres, with a scale of its own for each axis.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ways = [[(0, 0), (1, 0)], [(0.4, 0), (0.6, 0)]]
    >>> ax = draw_centres(ways, [0, 0], ax=Figure().subplots())
    >>> [dots.get_offsets().data.tolist() for dots in ax.collections]
    [[[0.0, 0.0], [1.0, 0.0]], [[0.4, 0.0], [0.6, 0.0]]]
    """
    ax, steps = axes_or_new(ax), np.asarray(ways, float)
    ax.plot(*np.moveaxis(steps, -1, 0), color=RAW, linewidth=0.6)
    (x, y), (to_x, to_y) = steps[0].T, steps[-1].T
    ax.scatter(x, y, s=3, color=MAP, zorder=2)
    ax.scatter(to_x, to_y, s=18, c=group_colors(np.asarray(group, np.int64)), zorder=3)
    ax.set(xlabel="x [m]", ylabel="y [m]")
    return ax


def draw_normals(walls: Segments, *, ax: Axes | None = None) -> Axes:
    """Draw walls, and dashed from the origin the normal of each one's line, in one colour (A 4.2).

    Where the foot of the normal lies beside the wall, the line is dotted up to its middle.

    Parameters
    ----------
    walls : SegmentMap or (n, 2, 2) array, metres
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_normals([[(1, 2), (3, 2)]], ax=Figure().subplots())
    >>> ax.lines[0].get_ydata().round(2).tolist()
    [0.0, 2.0]
    """
    ax, array = axes_or_new(ax), arrays.segments(walls)
    rho, theta = hough(array).T
    feet = rho[:, None] * np.stack([np.cos(theta), np.sin(theta)], -1)
    for k, (foot, wall) in enumerate(zip(feet, array, strict=True)):
        color = GROUPS[k % len(GROUPS)]
        ax.plot(*np.stack([np.zeros(2), foot]).T, "--", color=color)
        ax.plot(*np.stack([foot, wall.mean(axis=0)]).T, ":", color=color, linewidth=1)
    ax.plot(0, 0, "+", color=MAP, markersize=12)
    return draw_segments(array, ax=ax, group=np.arange(len(array)), width=3.0)
