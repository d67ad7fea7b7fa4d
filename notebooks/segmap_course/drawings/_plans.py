"""Drawings of the chapter on floor plans."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from segmap.arrays import Segments
from segmap.plotting import MAP, RAW, axes_or_new, draw_segments, map_axes


def draw_labels(
    labels: NDArray[np.int64],
    walls: Segments,
    corner: ArrayLike,
    side: float,
    *,
    lines: Sequence[ArrayLike] = ((), ()),
    ax: Axes | None = None,
) -> Axes:
    """Draw squares of one number in one colour, with walls over them, and lines across x and y.

    `labels` `(rows, columns)` are -1 for none; the squares have `side` metres, and begin at a
    corner. The number is written where there is most room for it, if it has a
    square metre or more.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> labels = np.array([[0, 0, 2], [-1, 0, 2]])
    >>> ax = draw_labels(labels, [[(0, 0), (1, 0)]], (0, 0), 0.8, ax=Figure().subplots())
    >>> [text.get_text() for text in ax.texts]
    ['0', '2']
    """
    from scipy.ndimage import distance_transform_edt

    x_min, y_min = np.asarray(corner, float)
    ax = draw_segments(walls, ax=axes_or_new(ax, (6.0, 5.0)), color=MAP, width=1.2)
    numbers, rank = np.unique(labels, return_inverse=True)
    shown = np.ma.masked_array(rank.reshape(labels.shape) % 12, labels < 0)
    box = (x_min, x_min + side * labels.shape[1], y_min, y_min + side * labels.shape[0])
    limits = ax.axis()
    ax.imshow(shown, extent=box, origin="lower", cmap="Set3", vmin=0, vmax=11)
    map_axes(ax).axis(limits)
    for across, draw in zip(lines, (ax.axvline, ax.axhline), strict=True):
        for offset in np.asarray(across, float):
            draw(offset, color=RAW, linestyle=":", linewidth=1)
    for number in numbers[numbers >= 0].tolist():
        inside = distance_transform_edt(np.pad(np.equal(labels, number), 1))[1:-1, 1:-1]
        if np.count_nonzero(inside) * side**2 >= 1:
            widest = np.unravel_index(inside.argmax(), inside.shape)
            y, x = (y_min, x_min) + side * (np.array(widest) + 0.5)
            ax.text(x, y, str(number), ha="center", va="center", fontsize="small")
    return ax
