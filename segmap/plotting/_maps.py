"""Pictures that lessons on scans, poses and extraction use again and again."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Segments
from ..scans import LaserScan
from ._scans import draw_path, draw_scan
from ._segments import draw_segments
from ._style import DPI, MAP, RESULT, TRUTH, axes_or_new, map_axes

#: Length of the arrow of a pose, in metres.
ARROW = 0.3


def draw_poses(
    poses: ArrayLike, *, ax: Axes | None = None, color: str = RESULT, label: str | None = None
) -> Axes:
    """Draw poses as arrows that point ahead, and a dotted line from each to the next.

    Parameters
    ----------
    poses : (k, 3) array, metres and radians
    ax : matplotlib Axes or None
    color : str
    label : str or None
        For a legend.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_poses([(0, 0, 0), (1, 2, 0)], ax=Figure().subplots())
    >>> ax.lines[0].get_ydata().tolist(), len(ax.patches)
    ([0.0, 2.0], 2)
    """
    ax, rows = axes_or_new(ax), np.asarray(poses, float).reshape(-1, 3)
    draw_path(rows, ax=ax, color=color, label=label).lines[-1].set_linestyle(":")
    for x, y, heading in rows:
        ahead = ARROW * np.array([np.cos(heading), np.sin(heading)])
        ax.arrow(x, y, *ahead, width=ARROW / 10, color=color, length_includes_head=True)
    return map_axes(ax)


def draw_maps(
    maps: Mapping[str, Segments],
    *,
    truth: Segments | None = None,
    scan: LaserScan | None = None,
    color: str | Sequence[str] | None = None,
    width: float = 2.0,
    columns: int | None = None,
    size: tuple[float, float] = (3.4, 2.8),
) -> list[Axes]:
    """Draw maps side by side at one scale, each over the same truth or the same scan.

    Parameters
    ----------
    maps : mapping from title to SegmentMap, Reduction or (n, 2, 2) array, metres
    truth : SegmentMap, Reduction or (n, 2, 2) array, metres, or None
        How the walls really are: thick and green, below each map.
    scan : LaserScan or None
        Its points and the robot, grey and red, below each map.
    color : str, one str a map, or None
        None draws each segment in a colour of its own, in turn.
    width : float
        Of the lines, in points.
    columns : int or None
        None draws all maps in one row.
    size : (width, height) in inches
        Of one map.

    Returns
    -------
    list of Axes
        One a map, in a new figure, all with the same limits.

    Raises
    ------
    ValueError
        Where there are several colours, and not one a map.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (1, 0)]])
    >>> axes = draw_maps({"one": wall, "two": np.concatenate([wall, wall + 1])}, color=RESULT)
    >>> [(ax.get_title(), len(ax.collections[0].get_segments())) for ax in axes]
    [('one', 1), ('two', 2)]
    """
    colors = [color] * len(maps) if color is None or isinstance(color, str) else list(color)
    if len(colors) != len(maps):
        raise ValueError(f"color must have {len(maps)} entries, one a map, got {len(colors)}")
    pictures = axes_grid(list(maps), columns or len(maps), size)
    for ax, segments, shade in zip(pictures, maps.values(), colors, strict=True):
        if truth is not None:
            draw_segments(truth, ax=ax, color=TRUTH, width=4.0)
        if scan is not None:
            draw_scan(scan, ax=ax)
        group = np.arange(len(arrays.segments(segments))) if shade is None else None
        draw_segments(segments, ax=ax, color=shade or MAP, group=group, width=width)
    return pictures


def axes_grid(titles: list[str], columns: int, size: tuple[float, float]) -> list[Axes]:
    """Axes in a new figure, one a title, in rows of so many columns, with limits in common."""
    import matplotlib.pyplot as plt

    rows = -(-len(titles) // columns)
    whole = plt.figure(figsize=(columns * size[0], rows * size[1]), dpi=DPI, layout="constrained")
    grid = whole.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for ax in grid.flat[len(titles) :]:
        ax.remove()
    for ax, title in zip(grid.flat, titles, strict=False):
        ax.set_title(title)
    return list(grid.flat[: len(titles)])
