"""Drawings of the chapter on comparing methods: runs on several buildings, side by side."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from ..experiments import select, thresholds_of
from ..plotting import DPI, RAW, RESULT, axes_or_new, draw_curves, method_style
from ._conclusions import filter_change
from ._thesis import THESIS_GRIDS

if TYPE_CHECKING:
    import pandas as pd

#: What a method calls its threshold in metres.
_LENGTHS = ("distance", "sigma", "tolerance")
#: Thresholds of angle up to here, in radians, count as A's tight one of 10 degrees.
_TIGHT = 0.2
#: Letters nearer than this part of the picture's height are moved apart.
_LETTER = 0.08


def draw_buildings(*groups: pd.DataFrame, filtered: bool = False) -> list[list[Axes]]:
    """Draw reduction against quality for many buildings: a row for each group of runs.

    Parameters
    ----------
    *groups : DataFrame
        Runs of `experiments.sweep`, each on as many maps.
    filtered : bool
        Which of their runs.

    Returns
    -------
    list of list of Axes
        Of a new figure; all have the same scales.

    Examples
    --------
    >>> from segmap.course import thesis_results
    >>> axes = draw_buildings(thesis_results())
    >>> [ax.get_title() for ax in axes[0]]
    ['polimi', 'stanford', 'bicocca', 'usc']
    """
    import matplotlib.pyplot as plt

    names = [_buildings(group) for group in groups]
    shape, size = (len(groups), len(names[0])), (7, 1.8 * len(groups))
    figure, axes = plt.subplots(
        *shape, figsize=size, dpi=DPI, layout="constrained", sharex=True, sharey=True, squeeze=False
    )
    for row, group, maps in zip(axes, groups, names, strict=True):
        for ax, name in zip(row, maps, strict=True):
            draw_curves(select(group, map=name, filtered=filtered), ax=ax).set_title(name)
            ax.label_outer()
    axes[0, 0].set(xlim=(0.4, 1), ylim=(0.2, 1))
    named = axes[-1, 0].get_legend_handles_labels()
    legend = figure.legend(*named, loc="outside lower center", ncols=6, fontsize="x-small")
    plt.setp(legend.get_lines(), linewidth=5)
    return [list(row) for row in axes]


def draw_threshold(*groups: pd.DataFrame, method: str, ax: Axes | None = None) -> Axes:
    """Draw quality against the threshold of a method, a length: a line for each building.

    Parameters
    ----------
    *groups : DataFrame
        One or two: the last is blue, another grey. Runs with a filter are left out.
    method : str
        One whose other thresholds stay the same.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes
        With the initial of a building at the end of its line.

    Raises
    ------
    ValueError
        For a method that was run over something else, or not at all.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.course import thesis_results
    >>> ax = draw_threshold(thesis_results(), method="fusion", ax=Figure().subplots())
    >>> ax.get_xlabel(), [text.get_text() for text in ax.texts]  # upwards
    ('tolerance [mm]', ['S', 'P', 'B', 'U'])
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


def draw_times(frame: pd.DataFrame, *, ax: Axes | None = None) -> Axes:
    """Draw the time of methods on one building against their threshold, as a share of the loosest.

    Runs with a filter are dotted; of methods with an angle only those at a tight one are drawn.

    Parameters
    ----------
    frame : DataFrame
        Of one building.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.course import thesis_results
    >>> ax = draw_times(select(thesis_results(), map="usc"), ax=Figure().subplots())
    >>> [line.get_linestyle() for line in ax.lines[:2]]
    ['-', ':']
    """
    ax = axes_or_new(ax, (4.0, 3.0))
    tight = frame[~(frame["angle"] >= _TIGHT)] if "angle" in frame else frame
    for k, (method, runs) in enumerate(tight.groupby("method", sort=False)):
        name = next(n for n in _LENGTHS if n in thresholds_of(runs.iloc[0]))
        color = method_style(str(method), k)[0]
        for filtered, line in ((False, "-"), (True, ":")):
            part = select(runs, filtered=filtered)
            label = None if filtered else str(method)
            at = part[name] / runs[name].max()
            ax.plot(at, part["seconds"], line, color=color, label=label)
    ax.set(yscale="log", xlabel="threshold, share of the loosest", ylabel="time [s]")
    return ax


def draw_filter(
    frame: pd.DataFrame, *, methods: Iterable[str] = tuple(THESIS_GRIDS), ax: Axes | None = None
) -> Axes:
    """Draw what the filter adds to the mean quality and reduction: a dot a method and building.

    Parameters
    ----------
    frame : DataFrame
        Filtered and not.
    methods : iterable of str
    ax : matplotlib Axes or None

    Returns
    -------
    Axes
        In points: hundredths of the rates.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.course import thesis_results
    >>> ax = draw_filter(thesis_results(), methods=["hybrid"], ax=Figure().subplots())
    >>> len(ax.lines[0].get_xdata())
    4
    """
    ax = axes_or_new(ax, (4.0, 3.0))
    for k, method in enumerate(methods):
        color, marker, _ = method_style(method, k)
        change = [filter_change(select(frame, map=n), method) for n in _buildings(frame)]
        ax.plot(*(100 * np.transpose(change)), marker, color=color, label=method)
    ax.set(xlabel="change of quality [points]", ylabel="change of reduction [points]")
    return ax


def draw_initials(
    values: Mapping[str, tuple[float, float]], *, ax: Axes | None = None, color: str = RESULT
) -> Axes:
    """Draw two numbers of each building as a dot with the initial of its name.

    Parameters
    ----------
    values : mapping of str to (float, float)
    ax : matplotlib Axes or None
    color : str
        Of the dots.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> draw_initials({"office": (2.0, 0.9)}, ax=Figure().subplots()).texts[0].get_text()
    'O'
    """
    ax = axes_or_new(ax, (4.0, 3.0))
    for name, place in values.items():
        ax.plot(*place, "o", color=color, markersize=4)
        ax.annotate(name[0].upper(), place, (5, 3), textcoords="offset points")
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
    """Initials beside the ends of lines, moved apart where lines end close together."""
    from scipy.optimize import isotonic_regression

    low, high = ax.get_ylim()
    ordered = sorted(ends, key=lambda end: end[1][1])
    steps = _LETTER * (high - low) * np.arange(len(ordered))
    heights = isotonic_regression([y for _, (_, y) in ordered] - steps).x + steps
    for (name, (x, _)), y in zip(ordered, heights, strict=True):
        text = ax.annotate(name[0].upper(), (x, y), (6, -3), textcoords="offset points")
        text.set_fontsize("small")
