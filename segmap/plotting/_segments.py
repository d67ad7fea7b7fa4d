"""Maps of segments, before and after a reduction."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Segments, checked
from ..display import plural
from ..metrics import AgainstWalls
from ._style import (
    ERROR,
    ERRORS,
    GROUPS,
    MAP,
    RESULT,
    TRUTH,
    Points,
    axes_grid,
    axes_or_new,
    group_colors,
    legend_below,
    map_axes,
    not_empty,
    shade,
)

#: A result is drawn over what it was made of; a line's own place is 2.
ABOVE = 3
#: Of walls that stand twice: with black, blue and orange 30 apart in CIE Lab or more, however one
#: sees colours; with dark yellow it would be 18.
DOUBLE = GROUPS[6]
#: Least end of the scale of errors, metres, so that rounding errors do not look like errors.
LEAST_ERROR = 1e-3


@checked
def draw_segments(
    segments: Segments,
    *,
    ax: Axes | None = None,
    color: str = MAP,
    width: Points = 1.0,
    group: ArrayLike | None = None,
    error: ArrayLike | None = None,
    label: str | None = None,
) -> Axes:
    """Draw segments, in one colour or coloured by group or by error.

    Parameters
    ----------
    segments
        SegmentMap, Reduction or (n, 2, 2) array, as everywhere here.
    color
        Used where neither `group` nor `error` is given.
    group
        `(n,)`: each group has a colour, in turn; -1 is drawn in grey.
    error
        `(n,)`, metres: light for none, red for much, with a scale.

    Raises
    ------
    ValueError
        Where both `group` and `error` are given, or not one value a segment.

    Examples
    --------
    >>> ax = draw_segments([[(0, 0), (1, 0)], [(0, 1), (1, 1)]], ax=Figure().subplots())
    >>> len(ax.collections[0].get_segments())
    2
    """
    array = arrays.segments(segments)
    if group is not None and error is not None:
        raise ValueError("expected only one of group, error, got both")
    colors = None if error is not None else shade(color)
    lines = LineCollection(list(array), linewidths=width, colors=colors, label=label)
    if group is not None:
        numbers = arrays.indices(_column("group", group, len(array)), "group")
        lines.set_color(list(group_colors(numbers)))
    if error is not None:
        metres = _column("error", error, len(array))
        order = np.argsort(metres, kind="stable")  # the largest on top
        largest = max(metres[np.isfinite(metres)].max(initial=0), LEAST_ERROR)
        lines.set_segments(list(array[order]))
        lines.set(array=metres[order].clip(max=largest), clim=(0, float(largest)), cmap=ERRORS)
    ax = axes_or_new(ax)
    ax.add_collection(lines)
    if error is not None:
        assert isinstance(ax.figure, Figure)
        ax.figure.colorbar(lines, ax=ax, label="error [m]")
    return map_axes(ax)


def draw_before_after(before: Segments, after: Segments, *, ax: Axes | None = None) -> Axes:
    """Draw a map, thin and black, and over it what a method made of it, thick and blue.

    A legend counts the segments.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (1, 0)]])
    >>> ax = draw_before_after(wall, wall, ax=Figure().subplots())
    >>> [text.get_text() for text in ax.get_legend().get_texts()]
    ['after: 1 segment', 'before: 1 segment']
    """
    before, after = arrays.segments(before, "before"), arrays.segments(after, "after")
    after_count, before_count = (plural(len(each), "segment") for each in (after, before))
    ax = draw_segments(after, ax=ax, color=RESULT, width=1.8, label=f"after: {after_count}")
    ax.collections[-1].set_zorder(ABOVE)
    draw_segments(before, ax=ax, width=0.7, label=f"before: {before_count}")
    legend_below(ax)
    return ax


def draw_against_walls(found: AgainstWalls, *, ax: Axes | None = None) -> Axes:
    """Draw what `metrics.against_walls` found: kept, missed, invented and double, with metres.

    What lies beside a wall is blue, beside none orange; walls that are missed are black and thick,
    those that the map has more than once have a wide band below.

    Examples
    --------
    >>> from segmap.metrics import against_walls
    >>> comparison = against_walls([[(0, 0), (4, 0)]], [[(0, 0.02), (3, 0.02)], [(3, 1), (4, 1)]])
    >>> ax = draw_against_walls(comparison, ax=Figure().subplots())
    >>> [text.get_text() for text in ax.get_legend().get_texts()]
    ['double: 0.00 m', 'missed: 1.00 m', 'kept: 3.00 m', 'invented: 1.00 m']
    """
    arrays.instance(found, "found", AgainstWalls)
    ax = axes_or_new(ax)
    for word, segments, metres, color, width in (
        ("double", found.twice, found.doubled.sum(), DOUBLE, 7.0),
        ("missed", found.lost, found.missed, MAP, 3.5),
        ("kept", found.pieces[found.owner >= 0], found.kept.sum(), RESULT, 1.2),
        ("invented", found.pieces[found.owner < 0], found.invented, ERROR, 1.8),
    ):
        draw_segments(segments, ax=ax, color=color, width=width, label=f"{word}: {metres:.2f} m")
    legend_below(ax)
    return ax


def draw_provenance(before: Segments, reduction: Any, *, ax: Axes | None = None) -> Axes:
    """Draw each segment of a reduced map, thick, in one colour with the inputs that made it, thin.

    Inputs that were dropped are grey. The reduction must be one of that map.

    Examples
    --------
    >>> from segmap.reduction import fusion
    >>> twice = np.array([[(0, 0), (1, 0)], [(0, 0.01), (1, 0.01)]])
    >>> ax = draw_provenance(twice, fusion(twice), ax=Figure().subplots())
    >>> [len(lines.get_segments()) for lines in ax.collections]
    [1, 2]
    """
    inputs, outputs = arrays.segments(before, "before"), arrays.segments(reduction, "reduction")
    parents = _column("reduction.parents", getattr(reduction, "parents", None), len(inputs))
    ax = draw_segments(outputs, ax=ax, group=np.arange(len(outputs)), width=4.0)
    ax.collections[-1].set(alpha=0.6, zorder=ABOVE)
    return draw_segments(inputs, ax=ax, group=parents, width=0.8)


@checked
def draw_maps(
    maps: Mapping[str, Segments],
    *,
    truth: Segments | None = None,
    color: str | None = None,
    width: Points = 2.0,
    columns: int | None = None,
    size: tuple[float, float] = (3.4, 2.8),
) -> list[Axes]:
    """Draw maps side by side at one scale, each over the same truth.

    Parameters
    ----------
    maps
        Title -> segments.
    truth
        How the walls really are: thick and green, below each map.
    color
        Of all maps; None draws each segment in a colour of its own, in turn.
    columns
        None draws all maps in one row.
    size
        Inches of one map.

    Returns
    -------
    list of Axes
        One a map, in a new figure, all with the same limits.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (1, 0)]])
    >>> axes = draw_maps({"one": wall, "two": np.concatenate([wall, wall + 1])}, color=RESULT)
    >>> [(ax.get_title(), len(ax.collections[0].get_segments())) for ax in axes]
    [('one', 1), ('two', 2)]
    """
    drawn = not_empty(maps, "maps").items()
    walls = {name: arrays.segments(map, f"maps[{name!r}]") for name, map in drawn}
    under = None if truth is None else arrays.segments(truth, "truth")
    columns = len(maps) if columns is None else arrays.whole(columns, "columns", most=100)
    shown = MAP if color is None else shade(color)
    pictures = axes_grid(list(maps), columns, size)
    for ax, segments in zip(pictures, walls.values(), strict=True):
        if under is not None:
            draw_segments(under, ax=ax, color=TRUTH, width=4.0)
        group = np.arange(len(segments)) if color is None else None
        draw_segments(segments, ax=ax, color=shown, group=group, width=width)
    return pictures


def _column(name: str, values: ArrayLike | None, count: int) -> Array:
    column = arrays.numbers(values, name)
    if column.shape != (count,):
        raise ValueError(
            f"{name} must have shape ({count},), one value a segment, got {column.shape}"
        )
    return column
