"""Scans, logs, poses and paths of robots."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, checked
from ..poses import transform
from ..scans import LaserScan, Log
from ._style import ERROR, RAW, RESULT, TRUTH, Points, axes_or_new, map_axes, shade

#: Points that a log is drawn with; more cannot be told apart at this size.
MOST_DRAWN_POINTS = 60_000
#: Length of the arrow of a pose, in metres.
ARROW = 0.3


@checked
def draw_scan(
    scan: LaserScan,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    *,
    ax: Axes | None = None,
    color: str = RAW,
    beams: bool = False,
) -> Axes:
    """Draw the end points of a scan and the robot at its pose; with `beams` also the valid beams.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_scan(LaserScan([1.0, 2.0], [0.0, 1.0]), ax=Figure().subplots())
    >>> ax.get_xlabel(), len(ax.lines[0].get_xdata())
    ('x [m]', 2)
    """
    ax, points = axes_or_new(ax), arrays.instance(scan, "scan", LaserScan).points()
    points = transform(arrays.pose(pose), points)
    if beams:
        start = transform(pose, scan.sensor_pose[:2])
        rays = np.stack([np.broadcast_to(start, points.shape), points], 1)
        ax.add_collection(LineCollection(list(rays), colors=shade(color), linewidths=0.3))
    draw_points(points, ax=ax, color=color)
    return draw_robot(pose, ax=ax)


@checked
def draw_points(
    points: ArrayLike, *, ax: Axes | None = None, color: str = RAW, size: Points = 3.0
) -> Axes:
    """Draw points `(n, 2)` as dots.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> draw_points([(0, 1), (2, 3)], ax=Figure().subplots()).lines[0].get_ydata().tolist()
    [1.0, 3.0]
    """
    ax, rows = axes_or_new(ax), arrays.points(points)
    look = {"markersize": size, "color": shade(color), "markeredgewidth": 0}
    ax.plot(*rows.T, ".", **look)
    return map_axes(ax)


def draw_log(
    log: Log,
    poses: ArrayLike | None = None,
    *,
    ax: Axes | None = None,
    color: str = RAW,
    path: str | None = None,
) -> Axes:
    """Draw the end points of all scans at their poses, and the path of the robot.

    Parameters
    ----------
    poses
        None takes the log's truth, or its odometry where it has no truth. Scans whose pose is NaN
        are left out.
    color
        Of the points.
    path
        Colour of the path; None takes green for truth, orange for odometry, blue for poses given.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> log = Log("one", [LaserScan([1.0, 2.0], [0.0, 1.0])], truth=[(0, 0, 0)])
    >>> len(draw_log(log, ax=Figure().subplots()).lines)
    2
    """
    rows, line = arrays.instance(log, "log", Log).odometry, ERROR
    if poses is not None:
        rows, line = arrays.poses(poses, count=len(log), missing=True), RESULT
    elif log.truth is not None:
        rows, line = log.truth, TRUTH
    line, ax = line if path is None else shade(path, "path"), axes_or_new(ax)
    draw_cloud(log, rows, ax, color)
    return draw_path(rows[np.isfinite(rows).all(1)], ax=ax, color=line)


def draw_path(
    poses: ArrayLike, *, ax: Axes | None = None, color: str = TRUTH, label: str | None = None
) -> Axes:
    """Draw the path of a robot; rows of NaN interrupt it.

    It is green (`TRUTH`) for true poses, `ERROR` for raw odometry, `RESULT` for aligned poses.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> draw_path([(0, 0, 0), (1, 2, 0)], ax=Figure().subplots()).lines[0].get_ydata().tolist()
    [0.0, 2.0]
    """
    ax, rows = axes_or_new(ax), arrays.poses(poses, missing=True)
    ax.plot(rows[:, 0], rows[:, 1], color=shade(color), linewidth=1.2, label=label)
    return map_axes(ax)


def draw_poses(
    poses: ArrayLike, *, ax: Axes | None = None, color: str = RESULT, label: str | None = None
) -> Axes:
    """Draw poses as arrows that point ahead, and a dotted line from each to the next.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_poses([(0, 0, 0), (1, 2, 0)], ax=Figure().subplots())
    >>> ax.lines[0].get_ydata().tolist(), len(ax.patches)
    ([0.0, 2.0], 2)
    """
    ax, rows = axes_or_new(ax), arrays.poses(poses, missing=True)
    draw_path(rows, ax=ax, color=color, label=label).lines[-1].set_linestyle(":")
    for x, y, heading in rows:
        ahead = ARROW * np.array([np.cos(heading), np.sin(heading)])
        ax.arrow(x, y, *ahead, width=ARROW / 10, color=color, length_includes_head=True)
    return map_axes(ax)


def draw_cloud(log: Log, poses: Array, ax: Axes, color: str = RAW) -> None:
    """Draw the end points of all scans that have a pose, thinned evenly."""
    scans = np.flatnonzero(np.isfinite(poses).all(1))
    clouds = [transform(poses[k], log.scans[k].points()) for k in scans]
    points = np.concatenate([np.empty((0, 2)), *clouds])
    thinned = points[:: max(1, -(-len(points) // MOST_DRAWN_POINTS))]
    draw_points(thinned, ax=ax, color=color, size=1.5)


def draw_robot(pose: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw where a robot stands: an orange triangle of 0.2 m that points ahead.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> draw_robot((1, 2, 0), ax=Figure().subplots()).patches[0].get_xy()[0].tolist()
    [1.15, 2.0]
    """
    ax = axes_or_new(ax)
    corners = transform(arrays.pose(pose), [(0.15, 0), (-0.1, 0.1), (-0.1, -0.1)])
    ax.fill(*corners.T, color=ERROR, zorder=3)
    return map_axes(ax)
