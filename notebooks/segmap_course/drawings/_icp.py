"""Drawings of the chapter on ICP: scans at several poses, normals, weights, a free direction."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.alignment.points import PointMap
from segmap.arrays import Array
from segmap.plotting import ERROR, RAW, RESULT, axes_or_new, axes_row, map_axes
from segmap.poses import transform

from ._alignments import draw_scans
from ._charts import label_axes

#: Ticks across walls, metres.
_TICK_M = 0.15
#: How far a scan is shifted there and back, metres.
_SHIFTS_M = np.linspace(-0.3, 0.3, 31)


def draw_scan_poses(
    first: ArrayLike, second: ArrayLike, poses: Mapping[str, ArrayLike], view: ArrayLike
) -> list[Axes]:
    """Draw the second scan on the first at several poses, side by side, by the title of each.

    A view is left, low, right and top, metres. The figure is new.
    """
    x_min, y_min, x_max, y_max = np.asarray(view, float)
    width = 9.6 / len(poses)
    height = max(3.5, (width - 0.6) * (y_max - y_min) / (x_max - x_min) + 0.9)
    row = axes_row(len(poses), (9.6, height), shared="xy")
    for ax, (title, pose) in zip(row, poses.items(), strict=True):
        draw_scans(first, second, pose, ax=ax, view=view, title=title)
    for ax in row[1:]:
        ax.set_ylabel("")
    return row


def draw_wall_normals(points: ArrayLike, normals: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw a blue tick across the wall at each point that has a normal; the others are orange."""
    ax, points, normals = axes_or_new(ax), arrays.points(points, "points"), np.asarray(normals)
    wall = ~np.isnan(normals[:, 0])
    ticks = np.stack([points[wall], points[wall] + _TICK_M * normals[wall]], axis=1)
    ax.add_collection(LineCollection(list(ticks), colors=RESULT, linewidths=0.8))
    ax.plot(*points[wall].T, ".", color=RAW, markersize=4, label="on a wall")
    ax.plot(*points[~wall].T, ".", color=ERROR, markersize=6, label="on no wall")
    ax.legend()  # where fewest points are
    ax.set_title("Each tick is a normal: it stands across its wall")
    return map_axes(ax)


def draw_weights(r: ArrayLike, weights: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw the weight of each residual, metres, and the curve on which all of them lie."""
    ax, away = axes_or_new(ax, (6.0, 3.5)), np.abs(np.asarray(r, float))
    sigma = max(1.4826 * float(np.median(away)), 0.01)
    line = np.linspace(0, max(6 * sigma, away.max()), 200)
    ax.plot(100 * line, 1 / (1 + (line / (2 * sigma)) ** 2), color=RAW)
    ax.plot(100 * away, np.asarray(weights), ".", color=ERROR)
    ax.axvline(100 * sigma, color=RAW, linestyle="--", linewidth=0.8)
    ax.text(100 * sigma, 0.05, " sigma", color=RAW)
    label_axes(ax, "A large residual counts less", "residual [cm]", "weight")
    ax.set(ylim=(0, 1.05), xlim=(0, None))
    return ax


def draw_shifts(
    first: ArrayLike, second: ArrayLike, pose: ArrayLike, directions: Mapping[str, ArrayLike]
) -> list[Axes]:
    """Draw two scans, and beside them what shifts along directions do to the mean residual.

    Directions are unit vectors `(2,)` by their names, in the frame of the first scan; the residuals
    are offsets across walls within 0.3 m. The figure is new.
    """
    walls, scan = PointMap(arrays.points(first, "first")), arrays.points(second, "second")
    maps, chart = axes_row(2, (9.6, 3.6))
    draw_scans(first, second, pose, ax=maps)
    for (name, direction), color in zip(directions.items(), (ERROR, RESULT), strict=False):
        x, y = np.asarray(direction, float)
        means = [_mean_residual(walls, scan, np.add(pose, (d * x, d * y, 0))) for d in _SHIFTS_M]
        chart.plot(100 * _SHIFTS_M, 100 * np.array(means), color=color, label=name)
        at = np.asarray(pose, float)[:2]
        for sign in (-1, 1):
            arrow = {"arrowstyle": "->", "color": color, "lw": 1.5}
            maps.annotate("", tuple(at + (sign * x, sign * y)), tuple(at), arrowprops=arrow)
    maps.set_title("Where the scan comes to rest")
    title = "What a shift does to the residuals"
    legend = {"loc": "upper center"}
    label_axes(chart, title, "shift [cm]", "mean residual [cm]", legend=legend, ylim=(0, None))
    return [maps, chart]


def _mean_residual(walls: PointMap, scan: Array, pose: Array) -> float:
    """Mean offset of a scan's points from walls within reach, metres; NaN where none are near."""
    rows = walls.descend(scan, pose, 0.3, 0.3, stride=1, rounds=1).rows
    return float(np.abs(rows[:, 3]).mean()) if len(rows) else np.nan


def icp_frames(
    first: ArrayLike, second: ArrayLike, poses: ArrayLike, view: ArrayLike
) -> Iterator[Figure]:
    """Figures of a descent for a film: at each pose but the last the residuals, then the move.

    Poses are `(k, 3)`, from the start on; a view is left, low, right and top, metres.
    """
    walls, scan = PointMap(arrays.points(first, "first")), arrays.points(second, "second")
    for before, after in pairwise(arrays.poses(poses, "poses")):
        rows = walls.descend(scan, before, 0.6, 0.6, stride=1, rounds=1).rows
        points = transform(before, scan)[rows[:, 5].astype(int)]
        pulls = np.stack([points, points - rows[:, 3:4] * rows[:, :2]], axis=1)
        for title, pose, shown in (("Partners", before, pulls), ("Move", after, ())):
            ax = draw_scans(first, second, pose, pulls=shown, view=view, title=title)
            figure = ax.get_figure(root=True)
            assert figure is not None
            yield figure
