"""Exercises on lines: their mean direction, those of a scan all round, the corner of a polyline."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from segmap.angles import axial_mean
from segmap.arrays import Array
from segmap.poses import transform

from ..literal.extraction import cut_at_gaps, fit_total, off_line, segments_at_gaps, split
from ..literal.lines import extreme_projections, line_of
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


# ------------------------------------------------------------------ the corners of a polyline
def _bent_runs(rng: Rng) -> Cases:
    """Runs of straight pieces whose points have tolerances that grow along them, or fall."""

    def bent(corners: list[tuple[float, float]], back: bool = False) -> tuple[Any, ...]:
        x, y = np.array(corners).T
        along = np.unique(np.append(np.linspace(0, x[-1], 23), x))
        points, tolerances = np.stack([along, np.interp(along, x, y)], 1), 0.01 + 0.01 * along
        size, n = rng.uniform(0.5, 2), len(along)
        points = transform(anywhere(rng), size * points * (1, rng.choice([-1, 1])))
        way = slice(None, None, -1) if back else slice(None)
        return points[way], size * tolerances[way], 0, n - 1

    near_and_far = [(0.0, 0.0), (2.0, 0.08), (5.0, 0.0), (8.0, 0.085), (11.0, 0.0)]
    return {
        "a near corner that counts, a far one that does not": bent(near_and_far),
        "the same from its other end": bent(near_and_far, back=True),
        "two corners that count": bent([(0, 0), (3, 0.6), (7, -0.5), (10, 0)]),
        "a corner of one and a half tolerances": bent([(0, 0), (5, 0.09), (10, 0)]),
        "a near corner alone": bent([(0, 0), (2, 0.08), (11, 0)]),
        "a straight wall": bent([(0, 0), (10, 0)]),
        "a bend within the tolerance": bent([(0, 0), (6, 0.05), (10, 0)]),
    }


def _split(points: Array, tolerances: Array, first: int, last: int) -> list[int]:
    chord = line_of((points[first], points[last]))
    off = [off_line(points[k], chord) / tolerances[k] for k in range(first, last + 1)]
    far = first + int(np.argmax(off))
    if off[far - first] <= 1 or far in (first, last):
        return [last]
    return _split(points, tolerances, first, far) + _split(points, tolerances, far, last)


def _with_one(tolerance: Callable[[Array], float]) -> Callable[..., list[int]]:
    """The chapter's split, with one tolerance for all points."""
    return lambda points, tolerances, first, last: split(points, tolerance(tolerances), first, last)


check_split = Exercise(
    "split(points, tolerances, first, last) -> list of int: last index of each piece of "
    "points[first] to points[last], (n, 2) in metres, when each point has a tolerance of its own",
    _split,
    _bent_runs,
    {
        "one tolerance for all cuts far walls at their noise: each point has its own": (
            _with_one(np.min)
        ),
        "one tolerance for all cuts near corners off: each point has its own": _with_one(np.max),
        "the mean tolerance is too large near the robot and too small far from it": (
            _with_one(np.mean)
        ),
        "cut where the distance in tolerances is largest, not where the metres are": edited(
            _split,
            ("/ tolerances[k]", ""),
            ("off[far - first] <= 1", "off[far - first] <= tolerances[far]"),
        ),
        "the tolerance of a point stays with it: it has the index of the point": edited(
            _split, ("tolerances[k]", "tolerances[k - first]")
        ),
        "both parts are cut again: the function calls itself": edited(
            _split,
            (
                "_split(points, tolerances, first, far) + _split(points, tolerances, far, last)",
                "[far, last]",
            ),
        ),
        "the pieces end at their last index, and so does the run": edited(
            _split, ("return [last]", "return []")
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
