"""Six ways to find the lines of a scan (Nguyen et al. 2007), beside split and merge and clusters.

Each takes points `(n, 2)`, metres, in the order of the beams, and returns segments `(2, 2)`. The
first two go along the beams; the last three look at all points at once, and forget their order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby, pairwise
from typing import Any, NamedTuple

import numpy as np

from segmap.arrays import Array

from .extraction import cut_at_gaps, fit_total, off_line
from .lines import Line, Point, extreme_projections, segment_length

#: Fewer points, and shorter pieces in metres, are no wall.
LEAST_POINTS = 5
LEAST_LENGTH_M = 0.10
#: A line that moves by less than this at each of the points stands, metres.
STANDS_M = 0.001
Found = list[list[tuple[float, float]]]


def kept(runs: Sequence[Sequence[Point]]) -> Found:
    """A segment for each run of points that is large enough."""
    large = [run for run in runs if len(run) >= LEAST_POINTS]
    segments = [extreme_projections(run, fit_total(run)) for run in large]
    return [s for s in segments if segment_length(s) >= LEAST_LENGTH_M]


def cut_along(points: Array, line: Line, gap: float) -> list[list[Point]]:
    """Points near a line, cut where there is a gap along it, metres."""
    x, y, dx, dy = line
    u = (points - (x, y)) @ (dx, dy)
    order = np.argsort(u, kind="stable")
    parts = np.split(points[order], np.flatnonzero(np.diff(u[order]) >= gap) + 1)
    return [part.tolist() for part in parts]


def lines_incremental(points: Array, *, gap: float = 0.30, tolerance: float = 0.03) -> Found:
    """A line grows by the next point as long as it fits; else the next line begins with it.

    Examples
    --------
    >>> corner = [(0.1 * k, 0) for k in range(11)] + [(1, 0.1 * k) for k in range(1, 11)]
    >>> [[tuple(round(x, 1) for x in end) for end in s] for s in lines_incremental(corner)]
    [[(0.0, 0.0), (1.0, 0.0)], [(1.0, 0.1), (1.0, 1.0)]]
    """
    runs: list[list[Point]] = []
    for run in cut_at_gaps(list(points), gap):
        runs.append([])
        for point in run:
            if len(runs[-1]) > 2 and off_line(point, fit_total(runs[-1])) > tolerance:
                runs.append([])
            runs[-1].append(point)
    return kept(runs)


class WindowLine(NamedTuple):
    """The line through neighbours: middle, direction, and the variances of turn and place."""

    middle: Array
    along: Array
    turn_variance: float
    offset_variance: float


def window_line(points: Sequence[Point], sigma: float) -> WindowLine:
    """The line through points whose ranges err by sigma, metres."""
    x, y, dx, dy = fit_total(points)
    middle, along = np.array((x, y)), np.array((dx, dy))
    spread = float((((np.array(points) - middle) @ along) ** 2).sum())
    return WindowLine(middle, along, sigma**2 / max(spread, 1e-12), sigma**2 / len(points))


def between_windows(a: WindowLine, b: WindowLine) -> float:
    """How far two windows are apart: turn and place, each by its variance (Mahalanobis)."""
    (ax, ay), (bx, by) = a.along, b.along
    turn = math.remainder(math.atan2(by, bx) - math.atan2(ay, ax), math.pi)
    dx, dy = a.along + (b.along if a.along @ b.along > 0 else -b.along)
    offset = float((b.middle - a.middle) @ (-dy, dx)) / math.hypot(dx, dy)
    return turn**2 / (a.turn_variance + b.turn_variance) + offset**2 / (
        a.offset_variance + b.offset_variance
    )


def lines_regression(
    points: Array, *, gap: float = 0.30, tolerance: float = 0.03, window: int = 7, most: float = 4.0
) -> Found:
    """A line through each window of neighbours; three windows that agree belong to one wall.

    The fidelity of a window is how far it is from the one before and the one behind it together,
    each by the noise, a third of the tolerance; chance gives 4. Runs of windows below it are walls.
    """
    runs: list[Sequence[Point]] = []
    for run in cut_at_gaps(list(points), gap):
        count = len(run) - window + 1
        lines = [window_line(run[k : k + window], tolerance / 3) for k in range(count)]
        apart = [0.0, *(between_windows(a, b) for a, b in pairwise(lines)), 0.0]
        agree = [before + behind < most for before, behind in pairwise(apart)]
        for is_wall, group in groupby(range(count), key=agree.__getitem__):
            if is_wall:
                own = list(group)
                runs.append(run[own[0] : own[-1] + window])
    return kept(runs)


def lines_ransac(
    points: Array, rng: np.random.Generator, *, gap: float = 0.30, tolerance: float = 0.03,
    trials: int = 60, least: int = LEAST_POINTS,
) -> Found:  # fmt: skip
    """Lines through two random points; that with most points near it is taken, with its points."""
    left, found = np.asarray(points, float), []
    while len(left) >= least:
        i, j = rng.integers(len(left), size=(2, trials))
        along = left[j] - left[i]
        size = np.hypot(*along.T)
        normal = along[:, ::-1] * (-1, 1) / np.where(size > 0, size, np.inf)[:, None]
        off = np.abs(((left[:, None] - left[i]) * normal).sum(-1)) + (size == 0)
        near = off <= tolerance
        best = near[:, near.sum(0).argmax()]
        if best.sum() < least:
            break
        found += kept(cut_along(left[best], fit_total(left[best].tolist()), gap))
        left = left[~best]
    return found


def lines_hough(
    points: Array, *, gap: float = 0.30, tolerance: float = 0.03, steps: int = 180,
    least: int = LEAST_POINTS,
) -> Found:  # fmt: skip
    """Each point votes for all lines through it; the cell with most votes is a line."""
    left, found = np.asarray(points, float), []
    turns = np.arange(steps) * np.pi / steps
    normals = np.stack([np.cos(turns), np.sin(turns)])
    while len(left) >= least:
        rho = np.floor(left @ normals / (2 * tolerance)).astype(int)  # (points, directions)
        rho -= rho.min()
        votes = [np.bincount(column) for column in rho.T]
        t = int(np.argmax([cells.max() for cells in votes]))
        best = rho[:, t] == votes[t].argmax()
        if best.sum() < least:
            break
        found += kept(cut_along(left[best], fit_total(left[best].tolist()), gap))
        left = left[~best]
    return found


def lines_em(
    points: Array, rng: np.random.Generator, *, gap: float = 0.30, tolerance: float = 0.03,
    trials: int = 50, rounds: int = 20,
) -> Found:  # fmt: skip
    """One line after the other: from a random start, until it stands; then its points are taken.

    Where none of the trials leads to a line, the points that are left are no wall.
    """
    left, found, fails = np.asarray(points, float), list[Any](), 0
    while len(left) >= LEAST_POINTS and fails < trials:
        line = stands(left, random_line(left, rng), tolerance, rounds)
        near = distances_from(left, line) <= tolerance
        walls = kept(cut_along(left[near], line, gap))
        fails = 0 if walls else fails + 1
        if walls:
            found, left = found + walls, left[~near]
    return found


def random_line(points: Array, rng: np.random.Generator) -> Line:
    """The line through two points."""
    i, j = rng.choice(len(points), 2, replace=False)
    turn = math.atan2(*(points[j] - points[i])[::-1])
    return (*points[i], math.cos(turn), math.sin(turn))


def distances_from(points: Array, line: Line) -> Array:
    """How far points are from a line, (n,) metres."""
    x, y, dx, dy = line
    return np.asarray(np.abs((points - (x, y)) @ (-dy, dx)))


def stands(points: Array, line: Line, sigma: float, rounds: int) -> Line:
    """A line after rounds of E and M: points count by their distance, then the line is fitted."""
    for _ in range(rounds):
        off = distances_from(points, line)
        weights = np.exp(-(off**2) / (2 * sigma**2))  # E
        line = weighted(points, weights)  # M
        if np.abs(distances_from(points, line) - off).max() < STANDS_M:
            break
    return line


def weighted(points: Array, weights: Array) -> Line:
    """The line with the least weighted sum of squared distances: a place and its direction."""
    middle = weights @ points / weights.sum()
    _, _, axes = np.linalg.svd((points - middle) * np.sqrt(weights)[:, None], full_matrices=False)
    return (*middle, *axes[0])
