"""Pictures that commands write: PNG, with equal scales in metres, without a display."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from segmap.arrays import Array
from segmap.files import write_bytes
from segmap.plotting import MAP, RESULT, draw_curves, draw_quadtree, draw_segments, figure_png
from segmap.quadtree import QuadtreeMap, extent
from segmap.reduction import Reduction
from segmap.segments import SegmentMap

#: Dots an inch.
PICTURE_DPI = 150
#: Longer side of a map, inches.
PICTURE_SIDE_INCHES = 7.0
#: Around a map for titles and scales, inches.
PICTURE_FRAME_INCHES = 0.9
#: No picture is thinner than this part of its length.
THIN = 0.3


def write_map_picture(path: Path, before: SegmentMap, after: SegmentMap | Reduction) -> None:
    """A map before its reduction, and beside it, or below a wide one, after it."""
    several = isinstance(after, Reduction)
    width, height = _inches(before.segments.reshape(-1, 2))
    stacked = several and width > height
    rows, columns = (2, 1) if stacked else (1, 2 if several else 1)
    figure = Figure((columns * width, rows * height), dpi=PICTURE_DPI, layout="constrained")
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    draw_segments(before, ax=axes[0], color=MAP, width=0.8).set_title(f"Segments: {len(before)}")
    if several:
        draw_segments(after, ax=axes[1], color=RESULT, width=1.2)
        axes[1].set_title(f"Reduced: {len(after)}")
        if stacked:
            axes[0].set_xlabel("")
        else:
            axes[1].set_ylabel("")
    write_bytes(path, figure_png(figure))


def write_quadtree_picture(path: Path, map: QuadtreeMap) -> None:
    """A quadtree: black is occupied, white is free, half grey unknown."""
    x_min, y_min, x_max, y_max = extent(map)
    figure = Figure(
        _inches(np.array([(x_min, y_min), (x_max, y_max)])), dpi=PICTURE_DPI, layout="constrained"
    )
    draw_quadtree(map, ax=figure.subplots(), outlines=False)
    write_bytes(path, figure_png(figure))


def write_curves(path: Path, runs: pd.DataFrame, quality: float) -> None:
    """Reduction against quality, for each method."""
    figure = Figure((9.0, 5.5), dpi=PICTURE_DPI, layout="constrained")
    ax = draw_curves(runs, ax=figure.subplots(), quality=quality)
    ax.set_ylim(0, 1)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    write_bytes(path, figure_png(figure))


def _inches(points: Array) -> tuple[float, float]:
    """Size of a picture of points, `(n, 2)`, metres."""
    wide, tall = np.ptp(points, axis=0) if len(points) else (1.0, 1.0)
    most = max(wide, tall, 1e-9)
    return PICTURE_SIDE_INCHES * max(
        wide / most, THIN
    ) + PICTURE_FRAME_INCHES, PICTURE_SIDE_INCHES * max(tall / most, THIN) + PICTURE_FRAME_INCHES
