"""What charts of the chapters have in common: title and labels, legend, ticks, words in them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from segmap.plotting import MAP, RAW


def label_axes(
    ax: Axes,
    title: str,
    x: str | None = None,
    y: str | None = None,
    *,
    legend: bool | Mapping[str, Any] = True,
    **settings: Any,
) -> Axes:
    """Give axes a title, labels with units, and a legend where something drawn has a label.

    A mapping is for the legend: its `loc`, `title` or `fontsize`. Settings are other properties of
    axes: `xlim`, `yscale`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = Figure().subplots()
    >>> _ = ax.plot([0, 1], [5, 4], label="room")
    >>> _ = label_axes(ax, "The error falls", "time [s]", "error [mm]", ylim=(0, 6))
    >>> ax.get_title(), ax.get_ylabel(), ax.get_legend().get_texts()[0].get_text()
    ('The error falls', 'error [mm]', 'room')
    """
    labels = {"xlabel": x, "ylabel": y}
    ax.set(title=title, **{k: word for k, word in labels.items() if word is not None}, **settings)
    if legend is not False and ax.get_legend_handles_labels()[0]:
        ax.legend(**(legend if isinstance(legend, Mapping) else {}))
    return ax


def set_ticks(ax: Axes, *, x: ArrayLike | None = None, y: ArrayLike | None = None) -> Axes:
    """Set the ticks of logarithmic axes, written as plain numbers, and no minor ones."""
    for axis, places in ((ax.xaxis, x), (ax.yaxis, y)):
        if places is not None:
            values = np.asarray(places)
            axis.set_ticks(values, [f"{value:g}" for value in values])
    ax.minorticks_off()
    return ax


def write_names(
    places: Mapping[str, ArrayLike],
    *,
    ax: Axes,
    offset: tuple[float, float] = (4, 4),
    color: str = MAP,
    size: float | str | None = None,
) -> Axes:
    """Write names beside their places, `(2,)` each, moved to the right and up by points."""
    for name, (x, y) in zip(places, np.array(list(places.values()), float), strict=True):
        ax.annotate(name, (x, y), offset, textcoords="offset points", color=color, fontsize=size)
    return ax


def mark_places(
    places: Mapping[str, float], *, ax: Axes, at: tuple[float, float], **words: Any
) -> Axes:
    """Draw upright grey lines at places on the x axis, each with its words beside it.

    The words begin `at[0]` to the right of the line and at the height `at[1]`; the keywords are
    those of their text.
    """
    for name, place in places.items():
        ax.axvline(place, color=RAW, linewidth=0.8)
        ax.text(place + at[0], at[1], name, **words)
    return ax
