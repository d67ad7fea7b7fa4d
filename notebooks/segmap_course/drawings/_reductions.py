"""Drawings of the chapters on reduction: small cases, growth on-line, rates over a threshold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from segmap.arrays import Segments
from segmap.plotting import ERROR, MAP, RESULT, axes_or_new, axes_row, draw_segments
from segmap.reduction import Reduction
from segmap.segments import SegmentMap


def draw_cases(
    maps: Mapping[str, Segments], method: Callable[[Any], Segments], *, height: float = 3.6
) -> list[Axes]:
    """Draw what a method makes of small maps, each in a picture of its own with its title.

    A map is thin and black, and lies over what the method leaves, thick and blue. Scales of x and y
    differ, so that what is near can be told apart. The pictures of the new figure have the y axis
    in common; its height is in inches.

    Examples
    --------
    >>> from segmap.reduction import fusion
    >>> twice = np.array([[(0, 0), (1, 0)], [(0, 0.01), (1, 0.01)]])
    >>> ax = draw_cases({"Two faces": twice}, fusion)[0]
    >>> [len(lines.get_segments()) for lines in ax.collections]
    [1, 2]
    """
    axes = axes_row(len(maps), (9.0, height), shared="y")
    for ax, (title, map) in zip(axes, maps.items(), strict=True):
        draw_segments(method(map), ax=ax, color=RESULT, width=4.0)
        draw_segments(map, ax=ax, width=1.2)
        ax.set(title=title, aspect="auto")
        ax.label_outer()
    return axes


def draw_growth(map: SegmentMap, reduction: Reduction, *, ax: Axes | None = None) -> Axes:
    """Draw how many segments were seen up to each scan, and how many an on-line method keeps.

    Raises
    ------
    ValueError
        Where the reduction is off-line, or one of another drive.
    """
    seen, live = np.cumsum([len(scan) for scan in map.by_scan()]), reduction.scan_live
    if live is None or len(live) != len(seen):
        raise ValueError(f"reduction must be an on-line one of these {len(seen)} scans")
    ax, scans = axes_or_new(ax, (6.0, 3.5)), np.arange(1, len(seen) + 1)
    ax.plot(scans, seen, "--", color=MAP, label="segments seen")
    ax.plot(scans, live, color=RESULT, label="segments in the map")
    ax.set(xlabel="scans", ylabel="segments")
    ax.legend()
    return ax


def draw_trade_off(
    values: ArrayLike, reduction: ArrayLike, quality: ArrayLike, *, ax: Axes | None = None
) -> Axes:
    """Draw reduction, blue, and quality, orange, of one method against its threshold.

    Both are rates in `[0, 1]`; the name and the unit of the threshold are for the x label.
    """
    ax = axes_or_new(ax, (6.0, 3.6))
    ax.plot(values, reduction, "o-", color=RESULT, label="reduction")
    ax.plot(values, quality, "s--", color=ERROR, label="quality")
    ax.set_ylabel("rate")
    ax.legend()
    return ax
