"""Drawings of the chapters on poses and on alignment: frames, backbone, ICP, candidates."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.patches import Ellipse
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.alignment import Match
from segmap.alignment.backbone import BackboneStep
from segmap.alignment.points import PointStep
from segmap.arrays import Segments
from segmap.plotting import (
    ERROR,
    GROUPS,
    MAP,
    RAW,
    RESULT,
    axes_grid,
    axes_or_new,
    draw_robot,
    draw_scan,
    draw_segments,
    map_axes,
)
from segmap.poses import transform
from segmap.scans import LaserScan

#: Lines from points to walls; more cannot be told apart.
_MOST_LINES = 120
#: What may come of a start -> its colour.
OUTCOMES = {"no match": "#e8e8e8", "right": RESULT, "free": GROUPS[0], "wrong": ERROR}


def draw_frames(scan: LaserScan, frames: Mapping[str, ArrayLike], *, every: int = 30) -> list[Axes]:
    """Draw the same scan in several frames side by side, and the axes of each frame.

    The frames are the robot's pose by the name of each. One beam in so many is drawn, from the
    sensor to its end. All pictures, of a new figure, have the same limits.
    """
    some = slice(None, None, every)
    few = LaserScan(
        scan.ranges[some], scan.angles[some], sensor_pose=scan.sensor_pose, max_range=scan.max_range
    )
    row = axes_grid([f"In the frame of the {name}" for name in frames], len(frames), (3.7, 4.0))
    for ax, pose in zip(row, frames.values(), strict=True):
        draw_scan(few, pose, ax=ax, beams=True)
        draw_scan(scan, pose, ax=ax, color=RESULT)
        ax.axhline(0, color=MAP, linewidth=0.5)
        ax.axvline(0, color=MAP, linewidth=0.5)
    return row


def draw_backbone(step: BackboneStep, *, ax: Axes | None = None) -> Axes:
    """Draw what the backbone method did with one scan, a step of `alignment.backbone_steps`.

    The lines of the backbone are black and dashed. The relevant segments of the scan are orange
    where odometry would place them, and blue where the method placed them, with the robot there.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap import load
    >>> from segmap.alignment import backbone_steps
    >>> step = backbone_steps(load("corridor")[:2])[1]
    >>> len(draw_backbone(step, ax=Figure().subplots()).lines) == len(step.lines.angle)
    True
    """
    ax = axes_or_new(ax)
    draw_segments(transform(step.guess, step.segments), ax=ax, color=ERROR, width=1.0)
    draw_segments(transform(step.pose, step.segments), ax=ax, color=RESULT, width=2.5)
    draw_robot(step.pose, ax=ax)
    x, y = ax.get_xlim(), ax.get_ylim()
    along = step.lines.normal[:, ::-1] * (1, -1)
    for place, d in zip(step.lines.through, along, strict=True):
        ax.axline(tuple(place), tuple(place + d), color=MAP, linewidth=0.7, linestyle="--")
    ax.set(xlim=x, ylim=y)
    return ax


def draw_icp_step(reference: ArrayLike, step: PointStep, *, ax: Axes | None = None) -> Axes:
    """Draw a scan as point ICP sees it: points with orange lines to their places on the wall.

    Points of the walls are grey, those of the scan blue, and lines of little weight thin. Where
    there are many points, only every second or third has a line.
    """
    ax, walls = axes_or_new(ax), arrays.points(reference, "reference")
    ax.plot(*walls.T, ".", color=RAW, markersize=4, markeredgewidth=0)
    some = slice(None, None, 1 + len(step.points) // _MOST_LINES)
    lines, widths = np.stack([step.points, step.feet], 1)[some], 0.2 + step.weights[some]
    ax.add_collection(LineCollection(list(lines), colors=ERROR, linewidths=widths))
    ax.plot(*step.points.T, ".", color=RESULT, markersize=4, markeredgewidth=0)
    return map_axes(ax)


def draw_scans(
    first: ArrayLike,
    second: ArrayLike,
    pose: ArrayLike,
    *,
    ax: Axes | None = None,
    pulls: ArrayLike = (),
    view: ArrayLike | None = None,
    title: str = "",
) -> Axes:
    """Draw the first scan in grey, the second at a pose in blue with its robot, pulls in orange.

    Scans are points `(n, 2)` and `(m, 2)`; a pull leads from a point to its partner, `(k, 2, 2)`.
    A view is left, low, right and top, metres; by default all that is drawn.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_scans([(0, 1), (1, 1)], [(0, 1)], (0.5, 0, 0), ax=Figure().subplots())
    >>> ax.lines[1].get_xydata().tolist()
    [[0.5, 1.0]]
    """
    ax, (x, y, turn) = axes_or_new(ax), arrays.pose(pose)
    ax.plot(*arrays.points(first, "first").T, ".", color=RAW, markersize=5, markeredgewidth=0)
    pairs = np.reshape(np.asarray(pulls, float), (-1, 2, 2))
    ax.add_collection(LineCollection(list(pairs), colors=ERROR, linewidths=0.8))
    placed = transform((x, y, turn), arrays.points(second, "second"))
    ax.plot(*placed.T, ".", color=RESULT, markersize=4, markeredgewidth=0)
    ax.plot([x, x + 0.35 * np.cos(turn)], [y, y + 0.35 * np.sin(turn)], color=RESULT)
    ax.plot([x], [y], "o", color=RESULT, markersize=7)
    map_axes(ax).set_title(title)
    if view is not None:
        x_min, y_min, x_max, y_max = np.asarray(view, float)
        ax.set(xlim=(x_min, x_max), ylim=(y_min, y_max))
    return ax


def draw_uncertainty(match: Match, *, ax: Axes | None = None) -> Axes:
    """Draw where a matched scan may be: the ellipse of two standard deviations in x and y.

    Raises
    ------
    ValueError
        Where nothing matched: there the covariance is infinite.
    """
    if not match.matched:
        raise ValueError(f"match must be one that was found, got {match!r}")
    ax = axes_or_new(ax)
    variance, axes = np.linalg.eigh(match.covariance[:2, :2])
    width, height = 2 * 2 * np.sqrt(np.maximum(variance, 0))
    turn = float(np.degrees(np.arctan2(axes[1, 0], axes[0, 0])))
    x, y = match.pose[:2]
    ax.add_patch(Ellipse((x, y), width, height, angle=turn, color=RESULT, alpha=0.3))
    ax.plot([x], [y], "+", color=RESULT)
    return map_axes(ax)


def draw_laid(first: Segments, second: Segments, poses: Mapping[str, ArrayLike]) -> list[Axes]:
    """Draw the walls of two scans, the second laid on the first at several poses, side by side.

    The first walls are black and thick; those of the second, with its robot, are blue. A pose has
    its title; where that ends with "wrong" they are orange. The figure is new.

    Examples
    --------
    >>> wall = [[(0, 0), (1, 0)]]
    >>> [ax.get_title() for ax in draw_laid(wall, wall, {"right": (0, 0, 0), "wrong": (1, 1, 0)})]
    ['right', 'wrong']
    """
    row = axes_grid(list(poses), len(poses), (min(6.0, 10.4 / len(poses)), 3.6))
    for ax, (title, pose) in zip(row, poses.items(), strict=True):
        draw_segments(first, ax=ax, width=3)
        color = ERROR if title.endswith("wrong") else RESULT
        draw_segments(transform(pose, arrays.segments(second)), ax=ax, color=color, width=1.5)
        draw_robot(pose, ax=ax)
    return row


def draw_basin(outcomes: ArrayLike, x: ArrayLike, y: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw the outcome of a match from each start, with a legend: the basin of attraction is blue.

    Of the outcomes `(m, n)` "no match" is light grey, "right" blue, "free" (along one direction)
    dark yellow with a dash and "wrong" orange with a cross, which the colour-blind see apart, too;
    x `(n,)` and y `(m,)` are where the columns and the rows start, in any unit.
    """
    words, shape = np.asarray(outcomes), (np.size(y), np.size(x))
    if words.shape != shape or not np.isin(words, list(OUTCOMES)).all():
        got = f"{words.shape} of {sorted(map(str, np.unique(words)))}"
        raise ValueError(f"outcomes must be {shape} of {list(OUTCOMES)}, got {got}")
    ax, colors = axes_or_new(ax), ListedColormap(list(OUTCOMES.values()))
    numbers = (words[..., None] == np.array(list(OUTCOMES))).argmax(-1)
    ax.pcolormesh(np.asarray(x), np.asarray(y), numbers, cmap=colors, vmin=0, vmax=3)
    for word in np.unique(words):
        ax.plot([], [], "s", color=OUTCOMES[word], label=word)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=4, frameon=False)
    for word, mark in (("free", "_"), ("wrong", "x")):
        rows, columns = np.nonzero(words == word)
        if len(rows):
            ax.plot(np.asarray(x)[columns], np.asarray(y)[rows], mark, color=MAP, markersize=5)
    return ax
