"""Six ways to find the lines of a scan (Nguyen et al. 2007), beside split and merge and clusters.

Each takes points `(n, 2)`, metres, in the order of the beams, and returns segments `(2, 2)`. The
first two go along the beams; the last three look at all points at once, and forget their order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from segmap.arrays import Array

from .extraction import cut_at_gaps, fit_total, off_line
from .lines import Line, Point, extreme_projections, segment_length

#: Fewer points, and shorter pieces in metres, are no wall.
LEAST_POINTS = 5
LEAST_LENGTH_M = 0.10
Found = list[list[tuple[float, float]]]


def kept(runs: Sequence[Sequence[Point]]) -> Found:
    """A segment for each run of points that is large enough."""
    large = [run for run in runs if len(run) >= LEAST_POINTS]
    found = [extreme_projections(run, fit_total(run)) for run in large]
    return [s for s in found if segment_length(s) >= LEAST_LENGTH_M]


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


def lines_regression(
    points: Array, *, gap: float = 0.30, angle: float = math.radians(15), window: int = 7
) -> Found:
    """A line through each window of neighbours; windows that follow each other and agree are one.

    Where the direction turns from window to window, at corners, there is no line.
    """
    runs: list[Sequence[Point]] = []
    for run in cut_at_gaps(list(points), gap):
        lines = [fit_total(run[k : k + window]) for k in range(len(run) - window + 1)]
        turns = [math.atan2(line[3], line[2]) for line in lines]
        first = 0
        for k in range(1, len(turns) + 1):
            apart = k < len(turns) and abs(math.remainder(turns[k] - turns[first], math.pi)) > angle
            if apart or k == len(turns):
                runs.append(run[first + (first > 0) * window // 2 : k + window // 2 + 1])
                first = k
        if turns:
            runs[-1] = [*runs[-1], *run[len(turns) + window // 2 :]]
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
    count: int = 20, rounds: int = 15,
) -> Found:  # fmt: skip
    """Many lines at once: points belong to lines in parts, lines are fitted to these parts."""
    all_of_them = np.asarray(points, float)
    if len(all_of_them) < 8:
        return []
    start = rng.integers(len(all_of_them) - 7, size=count)
    lines = np.array([fit_total(all_of_them[k : k + 8].tolist()) for k in start])
    for sigma in np.geomspace(0.30, tolerance / 2, rounds):
        normal = lines[:, 3:1:-1] * (-1, 1)
        off = ((all_of_them[:, None] - lines[:, :2]) * normal).sum(-1)
        near = np.exp(-(off**2) / (2 * sigma**2))
        part = near / (near.sum(1, keepdims=True) + 0.1)  # a tenth for no line at all
        fitted = [weighted(all_of_them, w) for w in part.T if w.sum() > LEAST_POINTS]
        lines = np.reshape(fitted, (-1, 4))
        if not len(lines):
            return []
    normal = lines[:, 3:1:-1] * (-1, 1)
    off = np.abs(((all_of_them[:, None] - lines[:, :2]) * normal).sum(-1))
    own = np.where(off.min(1) <= tolerance, off.argmin(1), -1)
    cut = [cut_along(all_of_them[own == k], lines[k], gap) for k in set(own.tolist()) - {-1}]
    return kept([run for runs in cut for run in runs])


def weighted(points: Array, weights: Array) -> Line:
    """The line with the least weighted sum of squared distances: a place and its direction."""
    middle = weights @ points / weights.sum()
    _, _, axes = np.linalg.svd((points - middle) * np.sqrt(weights)[:, None], full_matrices=False)
    return (*middle, *axes[0])
