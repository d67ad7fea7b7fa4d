"""Methods at equal quality: the curves of their runs, and the map that each makes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import ipywidgets as W
from matplotlib.figure import Figure

from ..experiments import Record, Records
from ..plotting import ERROR, draw_before_after, draw_curves
from ..reduction import METHODS, Reduction
from ..segments import SegmentMap
from ._base import Panel, slider, text

#: Pixels: two pictures side by side.
WIDTH, HEIGHT = 600, 270


class ComparePanel(Panel):
    """The run of a method that reduces most at a quality, among its others and on the map.

    Parameters
    ----------
    map : SegmentMap
    records : iterable of Record
        Runs on this map, unfiltered.

    Attributes
    ----------
    method : dropdown
    wanted : slider, per cent
        Least quality. Where no run reaches it the best one is shown.
    thresholds, rate, kept : labels
    record : Record
        The run that is shown.
    reduction : Reduction
        Made anew with its thresholds.

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

    record: Record
    reduction: Reduction

    def __init__(self, map: SegmentMap, records: Iterable[Record]) -> None:
        self.map, self.records = map, Records(records)
        names = list(dict.fromkeys(record.method for record in self.records))
        first = "fusion" if "fusion" in names else names[0]
        self.method: Any = W.Dropdown(options=names, value=first, description="method")
        self.wanted = slider("least quality", 80, 40, 98, 1, "%")
        self.thresholds, self.rate, self.kept = text(), text(), text()
        texts = (self.thresholds, self.rate, self.kept)
        self._assemble(self.method, self.wanted, texts, width=WIDTH, height=HEIGHT)

    def _draw(self, figure: Figure) -> None:
        self.record = self._chosen()
        self.reduction = METHODS[self.record.method].function(self.map, **self.record.thresholds)
        self.thresholds.value = self.record.words
        left = f"{len(self.reduction)} of {len(self.map)} left"
        self.rate.value = f"reduction {self.record.reduction:.1%}: {left}"
        self.kept.value = f"quality {self.record.quality:.1%}"
        curves, walls = figure.subplots(1, 2)
        draw_curves(self.records, ax=curves, quality=self.wanted.value / 100)
        here = (self.record.quality, self.record.reduction)
        curves.plot(
            *here, "o", markersize=12, markerfacecolor="none", color=ERROR, markeredgewidth=2
        )
        curves.legend(fontsize="x-small")
        draw_before_after(self.map, self.reduction, ax=walls)

    def _chosen(self) -> Record:
        runs = self.records.select(method=self.method.value)
        good = [run for run in runs if run.quality >= self.wanted.value / 100]
        if good:
            return max(good, key=lambda run: run.reduction)
        return max(runs, key=lambda run: run.quality)

    def __repr__(self) -> str:
        wanted = f"{self.method.value} at {self.wanted.value} %"
        return f"ComparePanel({wanted}: {self.thresholds.value}, {self.rate.value})"
