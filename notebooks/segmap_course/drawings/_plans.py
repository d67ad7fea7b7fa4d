"""Drawings of the chapter on floor plans."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from segmap.arrays import Segments
from segmap.plan import FloorPlan
from segmap.plotting import ERROR, GROUPS, MAP, RAW, RESULT, axes_or_new, draw_segments

#: How much of the colour of a room shows: of one among others, and of the one that lights up.
TINTS = (0.25, 0.8)


def draw_plan(plan: FloorPlan, *, lit: int = -1, ax: Axes | None = None) -> Axes:
    """Draw a floor plan: rooms tinted, with their areas; doors orange, clutter grey.

    The room with the index `lit` is filled darker.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap_course import three_plans
    >>> ax = draw_plan(three_plans()["R"], lit=0, ax=Figure().subplots())
    >>> [text.get_text() for text in ax.texts][:2]
    ['25', '14']
    """
    ax = draw_segments(plan.clutter, ax=ax, color=RAW, width=0.8)
    draw_segments(plan.walls, ax=ax, color=MAP, width=1.2)
    for k, room in enumerate(plan.rooms):
        color = RESULT if k == lit else GROUPS[k % len(GROUPS)]
        ax.fill(*room.outline.T, color=color, alpha=TINTS[k == lit], linewidth=0)
        for hole in room.holes:
            ax.fill(*hole.T, color="white", linewidth=0)
        x, y = room.place
        ax.text(x, y, f"{room.area:.0f}", ha="center", va="center", fontsize="small")
    for door in plan.doors:
        ax.plot(*door.ends.T, color=ERROR, linewidth=3, solid_capstyle="butt")
    return ax


def draw_labels(
    labels: NDArray[np.int64], walls: Segments, side: float, *, ax: Axes | None = None
) -> Axes:
    """Draw squares of one number in one colour, with the number, and walls over them.

    `labels` `(rows, columns)` are -1 for none; the squares have `side` metres, and the frame begins
    half a metre, less one square, left of and below 0.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> labels = np.array([[0, 0, 2], [-1, 0, 2]])
    >>> ax = draw_labels(labels, [[(0, 0), (1, 0)]], 0.1, ax=Figure().subplots())
    >>> [text.get_text() for text in ax.texts]
    ['0', '2']
    """
    start = side - 0.5
    ax = draw_segments(walls, ax=axes_or_new(ax, (6.5, 4.0)), color=MAP, width=2.0)
    high, wide = start + side * np.array(labels.shape)
    shown = np.ma.masked_less(labels, 0)
    box = (start, wide, start, high)
    ax.imshow(shown, extent=box, origin="lower", cmap="Set3", vmin=0, vmax=11)
    for number in np.unique(labels[labels >= 0]).tolist():
        y, x = start + side * (np.argwhere(labels == number).mean(0) + 0.5)
        ax.text(x, y, str(number), ha="center", va="center")
    return ax
