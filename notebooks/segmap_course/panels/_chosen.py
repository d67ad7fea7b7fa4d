"""Panels in which one of several methods of reduction is chosen, each with its thresholds."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.plotting import draw_before_after
from segmap.reduction import (
    METHODS,
    Reduction,
    fusion,
    fusion_online,
    fuzzy_clustering,
    fuzzy_set,
    hybrid_fusion,
    one_per_wall,
    polyline,
    segment_similarity,
    uncertain_parameters,
    weighted_line_fitting,
)
from segmap.segments import SegmentMap, length

from ._lesson import keyword, note, pick
from ._reduction import WIDE, ReductionPanel


class ChosenPanel(ReductionPanel):
    """A map, and what is left of it by the method that `by` says; thresholds of others are grey."""

    words = "{by}: {count}"

    def _draw(self, figure: Figure) -> None:
        self.method = METHODS[self.by.value].function
        super()._draw(figure)


class CloserPanel(ReductionPanel):
    """A map and what is left of it, by the method or by what `by` says; beside it a window, larger.

    The window is left, low, right and top, metres; by default two metres around the middle of the
    longest segment.
    """

    pixels = WIDE

    def __init__(self, map: SegmentMap, *, window: ArrayLike | None = None, **first: Any) -> None:
        segments = arrays.segments(map)
        middle = segments[length(segments).argmax()].mean(axis=0) if len(segments) else np.zeros(2)
        self.window = [*(middle - 1), *(middle + 1)] if window is None else window
        super().__init__(map, **first)

    def _draw(self, figure: Figure) -> None:
        if "by" in self._parts:
            self.method = METHODS[self.by.value].function
        self._tell(self.method(self.map, **self.chosen()))
        x_min, y_min, x_max, y_max = np.asarray(self.window, float)
        axes = figure.subplots(1, 2)
        for ax in axes:
            draw_before_after(self.map, self.reduction, ax=ax)
        axes[1].set(xlim=(x_min, x_max), ylim=(y_min, y_max), title="closer", aspect="auto")


class FusionPanel(CloserPanel):
    """Fusion of a map: at the end, after each scan, or of Hybrid's map now and then (A 4.4, 7)."""

    by = pick(("fusion", "fusion_online", "hybrid_fusion"), "method")
    tolerance = keyword(0.01, 0.20, 0.01, by=(fusion, fusion_online, hybrid_fusion))
    every = keyword(1, 100, 1, by=(hybrid_fusion,))
    distance = keyword(0.05, 0.60, 0.05, by=(hybrid_fusion,))
    min_length = keyword(0.0, 1.0, 0.05, by=(hybrid_fusion,))
    rows = ("by", "tolerance", "every", "distance", "min_length", "count", "rate quality")
    words = "{by}, tolerance {tolerance:.2f} m: {count}"


class OnePerWallPanel(CloserPanel):
    """A map, best with scans and places of the sensor, what one per wall leaves, and its noise."""

    method = staticmethod(one_per_wall)
    factor = keyword(0.2, 4.0, 0.2)
    estimate = note()
    rows = ("factor", "count", "rate quality", "estimate")
    words = "factor {factor:.1f}: {count}"

    def _tell(self, found: Reduction) -> None:
        super()._tell(found)
        self.estimate.value = f"looks lie off by {1000 * found.noise:.0f} mm, it says"


class LineErrorPanel(CloserPanel):
    """A map, best with points and places of the sensor, and three methods that weigh lines.

    Weighted line fitting for each error that poses may have, of place and of heading (A 2.7.3),
    uncertain parameters (A 2.7.8), and segment similarity, which knows no errors (A 2.7.7).
    Points take the place of uncertain parameters' eps, and without points all segments share it.
    """

    by = pick(("weighted_line_fitting", "uncertain_parameters", "segment_similarity"), "method")
    place = keyword(
        0.0, 0.20, 0.005, of="sigma_place", label="error of place", by=(weighted_line_fitting,)
    )
    heading = keyword(
        0.0, 3.0, 0.1, of="sigma_heading", label="heading", by=(weighted_line_fitting,)
    )
    chi2 = keyword(1.0, 30.0, 0.2, value=9.2, by=(weighted_line_fitting,))
    gap = keyword(0.0, 2.0, 0.05, by=(weighted_line_fitting,))
    distance = keyword(0.01, 0.30, 0.01, by=(uncertain_parameters,))
    angle = keyword(1, 30, 1, by=(uncertain_parameters,))
    cost = keyword(
        0.005, 0.15, 0.005, of="distance", label="cost of a merge", by=(segment_similarity,)
    )
    rows = ("by", "place heading", "chi2 gap", "distance angle", "cost", "count", "rate quality")
    words = "{by}, poses within {place:.3f} m, {heading:.1f} degrees: {count}"


class EarlyMethodsPanel(ChosenPanel):
    """A map and three early methods: polylines, fuzzy set, fuzzy clustering (A 2.7.10, 4, 6).

    Of polylines, segments farther apart than `far` do not match; longer links than `bridge`, which
    nobody saw, are left out.
    """

    by = pick(("polyline", "fuzzy_set", "fuzzy_clustering"), "method")
    tolerance = keyword(0.01, 0.40, 0.01, by=(polyline,))
    far = keyword(0.02, 0.30, 0.01, by=(polyline,))
    bridge = keyword(0.0, 2.0, 0.1, by=(polyline,))
    across = keyword(0.02, 0.60, 0.02, by=(fuzzy_set,))
    along = keyword(0.05, 1.0, 0.05, by=(fuzzy_set,))
    angle = keyword(1, 45, 1, by=(fuzzy_set,))
    cell = keyword(0.5, 5.0, 0.5, by=(fuzzy_clustering,))
    noise = keyword(0.02, 0.30, 0.01, by=(fuzzy_clustering,))
    rows = (
        "by",
        "tolerance far",
        "bridge",
        "across along",
        "angle",
        "cell noise",
        "count",
        "rate quality",
    )
    words = "{by}, tolerance {tolerance:.2f} m: {count}"
