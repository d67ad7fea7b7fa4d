"""Drawings of the chapter on comparing methods: runs on several buildings, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from segmap.experiments import select, thresholds_of
from segmap.plotting import RAW, RESULT, axes_grid, axes_or_new, draw_curves

if TYPE_CHECKING:
    import pandas as pd

#: What a method calls its threshold in metres.
_LENGTHS = ("distance", "sigma", "tolerance")
#: Letters nearer than this part of the picture's height are moved apart.
_LETTER = 0.08


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


def draw_threshold(*groups: pd.DataFrame, method: str, ax: Axes | None = None) -> Axes:
    """Draw quality against the threshold of a method, a length: a line for each building.

    One or two groups of runs: the last is blue, another grey. Runs with a filter are left out. The
    initial of a building stands at the end of its line.

    Raises
    ------
    ValueError
        For a method that was run over something else, or not at all.
    """
    runs = [select(group, method=method, filtered=False) for group in groups]
    name = _only_length(method, runs)
    ax, ends = axes_or_new(ax, (4.0, 3.0)), []
    for group, color in zip(runs, (RAW, RESULT)[-len(runs) :], strict=True):
        for building in _buildings(group):
            part = select(group, map=building)
            points = list(zip(1000 * part[name], part["quality"], strict=True))
            ax.plot(*np.transpose(points), "o-", color=color)
            ends.append((building, points[-1]))
    ax.set(xlabel=f"{name} [mm]", ylabel="quality")
    ax.margins(x=0.12)
    _spread_letters(ends, ax)
    return ax


def _only_length(method: str, groups: list[pd.DataFrame]) -> str:
    """The threshold that is a length; refuses runs without one, and those at several angles."""
    values: dict[str, set[object]] = {}
    for group in groups:
        for _, run in group.iterrows():
            for name, value in thresholds_of(run).items():
                values.setdefault(name, set()).add(value)
    varied = [n for n, found in values.items() if len(found) > 1 or n in _LENGTHS]
    if len(varied) != 1 or varied[0] not in _LENGTHS:
        raise ValueError(f"method must be run over one length, {method} is over {sorted(varied)}")
    return varied[0]


def _buildings(frame: pd.DataFrame) -> list[str]:
    return list(dict.fromkeys(frame["map"]))


def _spread_letters(ends: list[tuple[str, tuple[float, float]]], ax: Axes) -> None:
    """Initials beside the ends of lines; where they are moved apart, a thin line leads to each."""
    from scipy.optimize import isotonic_regression

    low, high = ax.get_ylim()
    ordered = sorted(ends, key=lambda end: end[1][1])
    steps = _LETTER * (high - low) * np.arange(len(ordered))
    heights = isotonic_regression([y for _, (_, y) in ordered] - steps).x + steps
    for (name, end), y in zip(ordered, heights, strict=True):
        at = end[0] + 0.05 * np.ptp(ax.get_xlim()), y
        leader = {"arrowstyle": "-", "linewidth": 0.6, "shrinkA": 0, "shrinkB": 0}
        ax.annotate(name[0].upper(), end, at, va="center", fontsize="small", arrowprops=leader)
