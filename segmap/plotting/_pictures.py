"""Pictures as bytes: for notebooks and for panels."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .. import arrays
from .._display import picture
from ..alignment import Alignment
from ..quadtree import QuadtreeMap
from ..reduction import Reduction
from ..scans import LaserScan, Log
from ..segments import SegmentMap
from ._alignments import draw_aligned_path
from ._quadtrees import draw_quadtree
from ._scans import draw_log, draw_scan
from ._segments import draw_segments
from ._style import DPI, MAP, RESULT


def thumbnail(value: Any) -> bytes:
    """A small picture of a scan, a log, an alignment, a map or a reduction, as a notebook shows it.

    Of a log without any pose it shows the first scan; of an alignment, which knows no scans, the
    path, its loops, and red crosses where a scan was not used.

    Parameters
    ----------
    value : LaserScan, Log, Alignment, QuadtreeMap, SegmentMap, Reduction or (n, 2, 2) array, metres

    Returns
    -------
    bytes
        A PNG, 320 x 240.

    Examples
    --------
    >>> thumbnail([[(0, 0), (1, 0)]])[:4]
    b'\\x89PNG'
    """
    figure = Figure(figsize=(320 / DPI, 240 / DPI), dpi=DPI, layout="constrained")
    ax = figure.subplots()
    if isinstance(value, LaserScan):
        draw_scan(value, ax=ax)
    elif isinstance(value, Log):
        _draw_any_log(value, ax)
    elif isinstance(value, Alignment):
        draw_aligned_path(value, ax)
    elif isinstance(value, QuadtreeMap):
        draw_quadtree(value, ax=ax, outlines=False)
    else:
        arrays.segments(value, "value")
        draw_segments(value, ax=ax, color=RESULT if hasattr(value, "parents") else MAP, width=1.2)
    return figure_png(figure)


for _kind in (LaserScan, Log, Alignment, QuadtreeMap, SegmentMap, Reduction):
    picture.register(_kind, thumbnail)


def _draw_any_log(log: Log, ax: Axes) -> None:
    placed = np.isfinite(log.odometry if log.truth is None else log.truth).all(1).any()
    if placed or not len(log):
        draw_log(log, ax=ax)
    else:
        draw_scan(log[0], ax=ax)


def figure_png(figure: Figure, *, finer: int = 1) -> bytes:
    """A figure as a PNG, whatever the backend; the same pixels give the same bytes.

    Parameters
    ----------
    figure : matplotlib Figure
    finer : int
        How many dots in a row there are for each dot of the figure, 8 at most.

    Returns
    -------
    bytes
        Of the shape that the figure's size and dots an inch give, times `finer`.

    Examples
    --------
    >>> figure_png(Figure())[:4]
    b'\\x89PNG'
    """
    target = io.BytesIO()
    arrays.instance(figure, "figure", Figure)
    dots = arrays.whole(finer, "finer", most=8) * figure.dpi
    figure.savefig(target, format="png", dpi=dots, metadata={"Software": None})
    return target.getvalue()
