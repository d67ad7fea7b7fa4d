"""Methods at equal quality: the curves of their runs, and the map that each makes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import ipywidgets as W
from matplotlib.figure import Figure

from .. import arrays
from ..experiments import select, thresholds_of, thresholds_text
from ..plotting import ERROR, draw_before_after, draw_curves
from ..reduction import METHODS, Reduction
from ..segments import SegmentMap
from ._base import Panel, slider, text

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

#: Width of each of two pictures side by side, pixels.
PAIR_WIDTH = 600
#: Height of two pictures side by side, pixels.
PAIR_HEIGHT = 270


class ComparePanel(Panel):
    """The run of a method that reduces most at a quality, among its others and on the map.

    The runs are of `experiments.sweep`, on this map, unfiltered. `method` is a list, `wanted` a
    slider of the least quality, in per cent: where no run reaches it the best one is shown.
    `thresholds`, `rate` and `kept` tell of `run`, and `reduction` is made anew with its thresholds.

    Examples
    --------
    >>> from segmap.experiments import sweep
    >>> walls = SegmentMap([[(0, y), (2, y)] for y in (0.0, 0.03, 0.1)])
    >>> runs = sweep({"walls": walls}, ["fusion"], {"fusion": {"tolerance": [0.01, 0.02]}})
    >>> panel = ComparePanel(walls, runs)
    >>> panel.wanted.value = 98
    >>> panel.thresholds.value, panel.rate.value
    ('tolerance 0.01', 'reduction 0.0%: 3 of 3 left')
    """

    run: pd.Series[Any]
    reduction: Reduction

    def __init__(self, map: SegmentMap, runs: pd.DataFrame) -> None:
        self.map, self.runs = arrays.instance(map, "map", SegmentMap), runs
        columns = ["map", "method"], ["filtered", "quality", "reduction"]
        if not len(arrays.frame(runs, *columns, name="runs")):
            raise ValueError("runs must hold one run at least, got none")
        for method in runs["method"]:
            arrays.one_of(method, "runs: a method", METHODS)
        names = list(dict.fromkeys(runs["method"]))
        first = "fusion" if "fusion" in names else names[0]
        self.method: Any = W.Dropdown(options=names, value=first, description="method")
        self.wanted = slider("least quality", 80, 40, 98, 1, "%")
        self.thresholds, self.rate, self.kept = text(), text(), text()
        texts = (self.thresholds, self.rate, self.kept)
        self._assemble(self.method, self.wanted, texts, width=PAIR_WIDTH, height=PAIR_HEIGHT)

    def _draw(self, figure: Figure) -> None:
        runs = select(self.runs, method=self.method.value)
        good = runs[runs["quality"] >= self.wanted.value / 100]
        best = good["reduction"].argmax() if len(good) else runs["quality"].fillna(0.0).argmax()
        self.run = run = (good if len(good) else runs).iloc[best]
        self.reduction = METHODS[run["method"]].function(self.map, **thresholds_of(run))
        self.thresholds.value = thresholds_text(run)
        counts = f"{len(self.reduction)} of {len(self.map)} left"
        self.rate.value = f"reduction {run['reduction']:.1%}: {counts}"
        self.kept.value = f"quality {run['quality']:.1%}"
        curves, walls = figure.subplots(1, 2)
        draw_curves(self.runs, ax=curves, quality=self.wanted.value / 100)
        _show_only(curves, run["method"])
        here = (run["quality"], run["reduction"])
        curves.plot(
            *here, "o", markersize=12, markerfacecolor="none", color=ERROR, markeredgewidth=2
        )
        draw_before_after(self.map, self.reduction, ax=walls)

    def __repr__(self) -> str:
        wanted = f"{self.method.value} at {self.wanted.value} %"
        return f"ComparePanel({wanted}: {self.thresholds.value}, {self.rate.value})"


def _show_only(ax: Axes, method: str) -> None:
    """Let the curves of the other methods fade, and name only this one."""
    for line in ax.lines[1:]:
        line.set_alpha(0.25)
    (chosen,) = (k for k, line in enumerate(ax.lines) if line.get_label() == method)
    for line in ax.lines[chosen - 1 : chosen + 1]:
        line.set(alpha=1.0, zorder=3)
    ax.set_ylim(0, 1)
    ax.legend(handles=[ax.lines[chosen]], loc="lower left")
