"""Drawings of the chapter on comparing methods: runs on several buildings, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes

from segmap.experiments import select
from segmap.plotting import axes_grid, draw_curves

if TYPE_CHECKING:
    import pandas as pd


def draw_buildings(frame: pd.DataFrame, *, filtered: bool = False) -> list[Axes]:
    """Draw reduction against quality for several buildings: a picture for each, two a row.

    The runs are those of `experiments.sweep`, with a filter or without. All pictures, of a new
    figure, have the same scales.

    Examples
    --------
    >>> from segmap_course import thesis_results
    >>> axes = draw_buildings(thesis_results())
    >>> [ax.get_title() for ax in axes]
    ['polimi', 'stanford', 'bicocca', 'usc']
    """
    import matplotlib.pyplot as plt

    names = _buildings(frame)
    axes = axes_grid(names, 2, (3.8, 2.8))
    for ax, name in zip(axes, names, strict=True):
        draw_curves(select(frame, map=name, filtered=filtered), ax=ax)
        ax.label_outer()
    axes[0].set(xlim=(0.4, 1), ylim=(0.2, 1))
    named = axes[-1].get_legend_handles_labels()
    legend = axes[0].figure.legend(*named, loc="outside lower center", ncols=3, fontsize="small")
    plt.setp(legend.get_lines(), linewidth=5)
    return axes


def _buildings(frame: pd.DataFrame) -> list[str]:
    return list(dict.fromkeys(frame["map"]))
