"""Maps of segments, before and after a reduction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Segments
from ..scans import LaserScan
from ._scans import draw_scan
from ._style import (
    ERRORS,
    MAP,
    RESULT,
    TRUTH,
    axes_grid,
    axes_or_new,
    axes_row,
    group_colors,
    map_axes,
    shade,
    thickness,
    titled,
)

#: A result is drawn over what it was made of; a line's own place is 2.
ABOVE = 3
#: Least end of the scale of errors, metres, so that rounding errors do not look like errors.
LEAST_ERROR = 1e-3


def draw_segments(
    segments: Segments,
    *,
    ax: Axes | None = None,
    color: str = MAP,
    width: float = 1.0,
    scan: ArrayLike | None = None,
    group: ArrayLike | None = None,
    error: ArrayLike | None = None,
    label: str | None = None,
) -> Axes:
    """Draw segments, in one colour or coloured by scan, by group or by error.

    Parameters
    ----------
    segments : SegmentMap, Reduction or (n, 2, 2) array, metres
    ax : matplotlib Axes or None
    color : str
        Used where none of `scan`, `group`, `error` is given.
    width : float
        Of the lines, in points.
    scan : (n,) int array or None
        Early scans dark, late ones light, with a scale.
    group : (n,) int array or None
        Each group has a colour, in turn; -1 is drawn in grey.
    error : (n,) array, metres, or None
        Light for none, red for much, with a scale.
    label : str or None
        For a legend.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        Where more than one of `scan`, `group`, `error` is given, or not one value a segment.

    Examples
    --------
    >>> ax = draw_segments([[(0, 0), (1, 0)], [(0, 1), (1, 1)]], ax=Figure().subplots())
    >>> len(ax.collections[0].get_segments())
    2
    """
    array = arrays.segments(segments)
    name, values = _chosen({"scan": scan, "group": group, "error": error}, len(array))
    order = np.argsort(values, kind="stable") if name == "error" else slice(None)  # largest on top
    shade(color)
    ax, width = axes_or_new(ax), thickness(width, "width")
    lines = LineCollection(list(array[order]), linewidths=width, label=label)
    ax.add_collection(lines)
    if name == "group":
        lines.set(color=group_colors(arrays.indices(values, "group")))
    elif name:
        _scaled(ax, lines, name, values[order])
    else:
        lines.set_color(color)
    return map_axes(ax)


def draw_before_after(before: Segments, after: Segments, *, ax: Axes | None = None) -> Axes:
    """Draw a map, thin and black, and over it what a method made of it, thick and blue.

    Parameters
    ----------
    before, after : SegmentMap, Reduction or (n, 2, 2) array, metres
    ax : matplotlib Axes or None

    Returns
    -------
    Axes
        With a legend that counts the segments.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (1, 0)]])
    >>> ax = draw_before_after(wall, wall, ax=Figure().subplots())
    >>> [text.get_text() for text in ax.get_legend().get_texts()]
    ['after: 1 segment', 'before: 1 segment']
    """
    before, after = arrays.segments(before, "before"), arrays.segments(after, "after")
    ax = draw_segments(after, ax=ax, color=RESULT, width=1.8, label=_counted("after", after))
    ax.collections[-1].set_zorder(ABOVE)
    draw_segments(before, ax=ax, width=0.7, label=_counted("before", before))
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2, frameon=False)
    return ax


def draw_side_by_side(before: Segments, after: Segments) -> list[Axes]:
    """Draw a map, black, and beside it what a method leaves of it, blue, at one scale.

    Parameters
    ----------
    before, after : SegmentMap, Reduction or (n, 2, 2) array, metres

    Returns
    -------
    list of Axes
        Two, of a new figure, with titles that count the segments.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (1, 0)]])
    >>> [ax.get_title() for ax in draw_side_by_side(np.repeat(wall, 3, axis=0), wall)]
    ['Before: 3 segments', 'After: 1']
    """
    before, after = arrays.segments(before, "before"), arrays.segments(after, "after")
    left, right = axes_row(2, (9.0, 4.6), shared="xy")
    draw_segments(before, ax=left).set_title(f"Before: {len(before)} segments")
    draw_segments(after, ax=right, color=RESULT).set_title(f"After: {len(after)}")
    return [left, right]


def draw_provenance(before: Segments, reduction: Any, *, ax: Axes | None = None) -> Axes:
    """Draw each segment of a reduced map, thick, in one colour with the inputs that made it, thin.

    Inputs that were dropped are grey.

    Parameters
    ----------
    before : SegmentMap or (n, 2, 2) array, metres
    reduction : Reduction
        Of that map: its `parents` are `(n,)`.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        Where the reduction is one of another map.

    Examples
    --------
    >>> from segmap.reduction import fusion
    >>> twice = np.array([[(0, 0), (1, 0)], [(0, 0.01), (1, 0.01)]])
    >>> ax = draw_provenance(twice, fusion(twice), ax=Figure().subplots())
    >>> [len(lines.get_segments()) for lines in ax.collections]
    [1, 2]
    """
    inputs, outputs = arrays.segments(before, "before"), arrays.segments(reduction, "reduction")
    given = getattr(reduction, "parents", None)
    parents = _column("reduction.parents", given, len(inputs))
    ax = draw_segments(outputs, ax=ax, group=np.arange(len(outputs)), width=4.0)
    ax.collections[-1].set(alpha=0.6, zorder=ABOVE)
    return draw_segments(inputs, ax=ax, group=parents, width=0.8)


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
    drawn = titled(maps, "maps").items()
    walls = {name: arrays.segments(map, f"maps[{name!r}]") for name, map in drawn}
    below = None if truth is None else arrays.segments(truth, "truth")
    columns = len(maps) if columns is None else arrays.whole(columns, "columns", most=100)
    colors, width = _colors(color, len(maps)), thickness(width, "width")
    if scan is not None:
        arrays.instance(scan, "scan", LaserScan)
    pictures = axes_grid(list(maps), columns, size)
    for ax, segments, one in zip(pictures, walls.values(), colors, strict=True):
        if below is not None:
            draw_segments(below, ax=ax, color=TRUTH, width=4.0)
        if scan is not None:
            draw_scan(scan, ax=ax)
        group = np.arange(len(segments)) if one is None else None
        draw_segments(segments, ax=ax, color=one or MAP, group=group, width=width)
    return pictures


def _colors(color: str | Sequence[str] | None, count: int) -> list[str | None]:
    """A colour for each map; None colours each of its segments in turn."""
    if color is None or isinstance(color, str):
        return [None if color is None else shade(color)] * count
    if not np.ndim(color) or len(color) != count:
        raise ValueError(f"color must have {count} entries, one a map, got {arrays.brief(color)}")
    return [shade(one) for one in color]


def _chosen(given: dict[str, ArrayLike | None], count: int) -> tuple[str, Array]:
    """The one keyword that has values, and those; no name and no values where none has."""
    names = [name for name, values in given.items() if values is not None]
    if len(names) > 1:
        raise ValueError(f"expected only one of {', '.join(given)}, got {' and '.join(names)}")
    return (names[0], _column(names[0], given[names[0]], count)) if names else ("", np.empty(0))


def _scaled(ax: Axes, lines: LineCollection, name: str, values: Array) -> None:
    """Colour lines by values and draw the scale beside the picture."""
    lines.set_array(values)
    lines.set_cmap("viridis" if name == "scan" else ERRORS)
    if name == "error":
        largest = max(values[np.isfinite(values)].max(initial=0), LEAST_ERROR)
        lines.set_array(np.minimum(values, largest))  # infinite where nothing is left of a map
        lines.set_clim(0, float(largest))
    assert isinstance(ax.figure, Figure)
    ax.figure.colorbar(lines, ax=ax, label="scan" if name == "scan" else "error [m]")


def _column(name: str, values: ArrayLike | None, count: int) -> Array:
    column = arrays.numbers(values, name)
    if column.shape != (count,):
        raise ValueError(
            f"{name} must have shape ({count},), one value a segment, got {column.shape}"
        )
    return column


def _counted(word: str, segments: Segments) -> str:
    n = len(arrays.segments(segments))
    return f"{word}: {n} segment{'s' * (n != 1)}"
