"""Exercises on lines: their mean direction, those of a scan all round, the corner of a polyline."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from segmap.angles import axial_mean
from segmap.arrays import Array
from segmap.poses import transform

from ..literal.extraction import cut_at_gaps, fit_total, segments_at_gaps
from ..literal.lines import extreme_projections
from ._answers import Cases, same_line
from ._exercise import Exercise, Rng, anywhere, changed, edited


# --------------------------------------------------------------------- a mean direction
def _bundles(rng: Rng) -> Cases:
    def bundle(middle: float, count: int) -> tuple[Array]:
        return (np.radians((middle + rng.uniform(-25, 25, count)) % 180),)

    return {
        "two lines on both sides of 0 degrees": (
            np.radians([rng.uniform(1, 20), rng.uniform(150, 179)]),
        ),
        "three lines about 0 degrees": bundle(0, 3),
        "five lines about an upright one": bundle(90, 5),
        "four lines": bundle(rng.uniform(40, 140), 4),
        "one line": bundle(45, 1),
    }


def _mean_vector(angles: Array) -> float:
    return float(np.arctan2(np.sin(angles).sum(), np.cos(angles).sum()))


check_axial_mean = Exercise(
    "axial_mean(angles) -> radians: mean direction of undirected lines at (n,) radians",
    axial_mean,
    _bundles,
    {
        "1 and 179 degrees are two degrees apart: their mean is no number between them": np.mean,
        "a line has no direction: its vector may as well be turned round. Double the angles": (
            _mean_vector
        ),
        "the mean of the doubled angles is double the angle: halve it": (
            lambda angles: _mean_vector(2 * angles)
        ),
        "the answer is wanted in radians": changed(axial_mean, np.degrees),
        "np.arctan2 takes the sum of the sines first, then that of the cosines": (
            lambda angles: np.arctan2(np.cos(2 * angles).sum(), np.sin(2 * angles).sum()) / 2
        ),
        "np.arctan of the quotient loses half of the circle: np.arctan2 keeps the signs": (
            lambda angles: np.arctan(np.sin(2 * angles).sum() / np.cos(2 * angles).sum()) / 2
        ),
    },
    same_line,
)


# ------------------------------------------------------------------ a scan all round
def _rounds(rng: Rng) -> Cases:
    """Walls round a robot, with gaps between them; the first point is anywhere."""
    sizes = rng.permutation([7, 9, 11])

    def wall(k: int, size: int) -> Array:
        along = 0.1 * (np.arange(size) - size / 2)
        points = np.column_stack([along, rng.normal(0, 0.01, size) - 1.5])
        return transform((0.0, 0.0, k * np.pi / 2), points)

    def round_of(first: int, *, ends: Array = np.empty((0, 2))) -> tuple[Array, float]:
        points = np.concatenate([*(wall(k, int(n)) for k, n in enumerate(sizes)), ends])
        return np.roll(points, -first, axis=0), 0.3

    return {
        "a wall at the seam": round_of(int(rng.integers(2, 5))),
        "a wall at the seam, most of it at the end": round_of(int(sizes[0]) + 5),
        "a gap at the seam": round_of(0),
        "one wall only": (wall(0, 9), 0.3),
        "a point alone": round_of(3, ends=rng.uniform(2, 3, (1, 2)) * (-1, 1)),
    }


def _segments_all_round(points: Array, gap: float) -> Array:
    """As the chapter's; but the first run goes on where the last one ends."""
    runs = cut_at_gaps(points.tolist(), gap)
    if len(runs) > 1 and math.dist(points[-1], points[0]) < gap:
        runs[0] = runs.pop() + runs[0]
    lines = [(run, fit_total(run)) for run in runs if len(run) > 1]
    return np.array([extreme_projections(run, line) for run, line in lines])


def _same_segments(found: Any, expected: Any) -> bool:
    """Whether both hold the same segments, in any order, whichever end comes first."""
    a, b = np.asarray(found, float), np.asarray(expected, float)
    if a.shape != b.shape or a.ndim != 3 or not np.isfinite(a).all():
        return False
    one, other = (sorted(sorted(ends.tolist()) for ends in each.round(7)) for each in (a, b))
    return np.allclose(one, other, rtol=0, atol=1e-6)


def _round(*changes: tuple[str, str]) -> Callable[[Array, float], Array]:
    return edited(_segments_all_round, *changes)


check_segments_all_round = Exercise(
    "segments_all_round(points, gap) -> (k, 2, 2) metres: the segments of points (n, 2) all round, "
    "by total least squares; the last point is the neighbour of the first",
    _segments_all_round,
    _rounds,
    {
        "this is the chapter's own: a wall at the seam is still in two parts": segments_at_gaps,
        "the first and the last run are one only if the last point is nearer than the gap to the "
        "first": _round((" and math.dist(points[-1], points[0]) < gap", "")),
        "where both are joined, the last run must not stay as well": (
            _round(("runs.pop() + runs[0]", "runs[-1] + runs[0]"))
        ),
        "the last run must not be dropped: it is a part of the first": (
            _round(("runs.pop() + runs[0]", "runs.pop() and runs[0]"))
        ),
        "without a cut at its gaps the scan is one line": (
            lambda points, gap: segments_at_gaps(points, np.inf)
        ),
    },
    _same_segments,
)


# ------------------------------------------------------------------ the corner of a polyline
def _chords(rng: Rng) -> Cases:
    """Points that are farthest to the left and to the right of chords of all directions."""

    def chord(side: float, degrees: float) -> tuple[Array]:
        count = int(rng.integers(4, 8))
        off = rng.uniform(-0.3, 0.3, count)
        off[[0, -1]] = 0
        off[rng.integers(1, count - 1)] = side * rng.uniform(0.5, 0.9)
        points = np.stack([np.linspace(0, rng.uniform(1, 3), count), off], 1)
        return (transform(anywhere(rng, degrees, degrees), points),)

    def two_far(first: float, second: float) -> tuple[Array]:
        points = np.array([(0, 0), (0.5, first), (1.2, 0.1), (1.9, second), (2.4, 0)])
        return (transform(anywhere(rng), points * (1, rng.choice([-1, 1]))),)

    upright = chord(1, 0)[0][:, ::-1]
    return {
        "the farthest to the left": chord(1, rng.uniform(-30, 30)),
        "the farthest to the right": chord(-1, rng.uniform(-30, 30)),
        "a chord that stands upright": (upright - upright[0] * (1, 0),),
        "two that are far, the second farther": two_far(0.5, 0.6),
        "two that are far, the first farther": two_far(0.6, 0.5),
        "a steep chord": chord(-1, rng.uniform(70, 80)),
        "a steep chord, to the left": chord(1, rng.uniform(100, 110)),
    }


def _farthest_point(points: Array) -> int:
    d, r = points[-1] - points[0], points - points[0]
    off = (d[0] * r[:, 1] - d[1] * r[:, 0]) / np.hypot(*d)  # positive to the left
    return int(np.argmax(np.abs(off)))


check_farthest_point = Exercise(
    "farthest_point(points) -> int: index of the one of points (n, 2) that is farthest from the "
    "line through the first and the last",
    _farthest_point,
    _chords,
    {
        "points lie on both sides of the chord: take absolute distances": (
            edited(_farthest_point, ("np.abs(off)", "off"))
        ),
        "points lie on both sides of the chord: the sign must not decide": (
            edited(_farthest_point, ("argmax(np.abs(off))", "argmin(off)"))
        ),
        "measure across the chord, not upright: an upright chord has no slope": (
            edited(_farthest_point, ("(d[0] * r[:, 1]", "(r[:, 1]"), ("d[1]", "d[1] / d[0]"))
        ),
        "this is the distance from the first point, wanted is the one from the chord": (
            lambda points: int(np.argmax(np.hypot(*(points - points[0]).T)))
        ),
        "the index counts from the first point of all, not from the first inner one": (
            edited(_farthest_point, ("np.abs(off)", "np.abs(off)[1:-1]"))
        ),
        "this is the distance from the last point, wanted is the one from the chord": (
            lambda points: int(np.argmax(np.hypot(*(points - points[-1]).T)))
        ),
        "give the index of the point, not its distance": (
            edited(_farthest_point, ("int(np.argmax(np.abs(off)))", "np.abs(off).max()"))
        ),
    },
)


# ------------------------------------------------------------------------- two random points
def _shares(rng: Rng) -> Cases:
    return {
        "half of the points on the line": (float(rng.uniform(0.4, 0.6)), 0.99),
        "a wall among many": (float(rng.uniform(0.08, 0.2)), float(rng.uniform(0.9, 0.999))),
        "nearly all": (float(rng.uniform(0.8, 0.9)), float(rng.uniform(0.95, 0.999))),
    }


def _trials(share: float, sure: float) -> int:
    return math.ceil(math.log(1 - sure) / math.log(1 - share**2))


check_ransac_trials = Exercise(
    "ransac_trials(share, sure) -> int: how many pairs of random points are needed so that with "
    "this probability at least one pair lies on a line that holds this share of the points",
    _trials,
    _shares,
    {
        "both points must lie on the line: the share counts twice": (
            edited(_trials, ("share**2", "share"))
        ),
        "so many pairs hit once on average; asked is how many make one hit this probable": (
            lambda share, sure: math.ceil(sure / share**2)
        ),
        "too few are not enough: round up": edited(_trials, ("math.ceil(", "int(")),
        "all trials must fail for none to hit: the power of 1 - share**2": (
            edited(_trials, ("1 - share**2", "share**2"))
        ),
        "1 - sure is the probability that none hits": (
            edited(_trials, ("math.log(1 - sure)", "math.log(sure)"))
        ),
        "a pair fails unless both points hit: 1 - share**2, not (1 - share)**2": (
            edited(_trials, ("1 - share**2", "(1 - share) ** 2"))
        ),
        "1 over the share of good pairs is the mean number of trials, not enough to be sure": (
            lambda share, sure: math.ceil(1 / share**2)
        ),
        "a number of trials is whole": (
            lambda share, sure: math.log(1 - sure) / math.log(1 - share**2)
        ),
    },
)
