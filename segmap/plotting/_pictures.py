"""Pictures as bytes: for notebooks and for panels."""

from __future__ import annotations

import io
from typing import Annotated, Any

import numpy as np
from matplotlib.figure import Figure

from .. import arrays
from ..alignment import Alignment
from ..arrays import Count, at_most, checked
from ..display import picture
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

    A PNG, 320 x 240. Of a log without any pose it shows the first scan; of an alignment, which
    knows no scans, the path, its loops, and orange crosses where a scan was not used.

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
        poses = value.odometry if value.truth is None else value.truth
        if len(value) and not np.isfinite(poses).all(1).any():
            draw_scan(value[0], ax=ax)
        else:
            draw_log(value, ax=ax)
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


@checked
def figure_png(figure: Figure, *, finer: Annotated[Count, at_most(8)] = 1) -> bytes:
    """A figure as a PNG, whatever the backend; the same pixels give the same bytes.

    `finer` is how many dots in a row there are for each dot of the figure.

    Examples
    --------
    >>> figure_png(Figure())[:4]
    b'\\x89PNG'
    """
    target = io.BytesIO()
    arrays.instance(figure, "figure", Figure)
    figure.savefig(target, format="png", dpi=finer * figure.dpi, metadata={"Software": None})
    return target.getvalue()
