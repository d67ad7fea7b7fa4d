"""Drawings of the chapter on what a line knows: how a point errs, how a line, and two looks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from segmap.arrays import Array
from segmap.plotting import ERROR, MAP, RAW, RESULT, TRUTH, axes_or_new, map_axes
from segmap.reduction.surveyed import Line

#: Errors of a point are drawn so many times larger.
LARGER = 15
#: Blue, orange, green, in the order of what is drawn.
COLORS = (RESULT, ERROR, TRUTH)


def draw_seen_wall(
    points: ArrayLike, sensor: ArrayLike, sigmas: ArrayLike, *, ax: Axes | None = None
) -> Axes:
    """Draw a wall's points along x, their mean, and how the last one errs: along a beam and across.

    The deviations are those of range, metres, and bearing, radians; both errors are drawn 15 times
    larger. Dashed is the normal of the wall at the point, and green is how far the sensor, a
    triangle, stands from the mean along the wall.
    """
    ax, array, at = axes_or_new(ax, (6.5, 4.0)), np.asarray(points, float), np.array(sensor)
    range_, bearing = np.asarray(sigmas, float)
    last, mean = array[-1], array.mean(axis=0)
    beam = last - at
    along, across = beam / np.hypot(*beam), np.array([-beam[1], beam[0]]) * bearing
    ax.plot(*np.transpose([at, last]), color=RAW, linewidth=1.5, label="beam, of length r")
    for way, color, word in ((range_ * along, ERROR, "range"), (across, RESULT, "bearing")):
        ends = np.transpose([last - LARGER * way, last + LARGER * way])
        ax.plot(*ends, color=color, linewidth=3, label=f"error of the {word}, {LARGER} times")
    ax.plot([last[0]] * 2, [at[1], last[1]], "--", color=MAP, linewidth=1, label="normal")
    ax.plot([at[0], mean[0]], [mean[1]] * 2, color=TRUTH, linewidth=4, alpha=0.6, label="arm")
    ax.plot(*array.T, ".", color=MAP)
    ax.plot(*mean, "+", color=MAP, markersize=16, label="mean of the points")
    ax.plot(*at, "^", color=MAP, label="sensor")
    ax.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    return map_axes(ax)


def draw_known_line(line: Line, fits: Sequence[Line], *, ax: Axes | None = None) -> Axes:
    """Draw how fits err beside a line, grey, and two of its deviations, blue, along the wall."""
    ax, t = axes_or_new(ax, (6.5, 3.6)), np.linspace(-4, 4, 81)
    x, y, alpha = np.array(fits)[:, :3].T
    offset = (x - line.x) * np.cos(alpha) + (y - line.y) * np.sin(alpha)
    ax.plot(t, 1000 * (offset + t[:, None] * (alpha - line.alpha)), color=RAW, linewidth=0.5)
    band = 2000 * np.sqrt(line.rr + 2 * line.ra * t + line.aa * t * t)
    ax.plot(t, np.stack([band, -band], 1), "--", color=RESULT)
    ax.set(xlabel="along the wall, from the mean [m]", ylabel="across [mm]")
    return ax


def draw_contradiction(
    off: ArrayLike, covariances: Mapping[str, Array], chi2: float, *, ax: Axes | None = None
) -> Axes:
    """Draw the difference of two lines, a cross, and for each covariance what agrees with it.

    Differences are of offset, metres, and angle, radians; inside an ellipse chi squared is less
    than `chi2`.
    """
    ax, turn = axes_or_new(ax, (6.0, 3.6)), np.linspace(0, 2 * np.pi, 120)
    for (name, matrix), color in zip(covariances.items(), COLORS, strict=False):
        ring = np.sqrt(chi2) * np.linalg.cholesky(matrix) @ [np.cos(turn), np.sin(turn)]
        ax.plot(1000 * ring[0], np.degrees(ring[1]), color=color, label=name)
    offset, angle = np.asarray(off, float)
    ax.plot(1000 * offset, np.degrees(angle), "x", color=MAP, markersize=10, label="two looks")
    ax.set(xlabel="difference of the offsets [mm]", ylabel="of the angles [degrees]")
    ax.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    return ax
