"""Exercises on lines: their mean direction, the line of a cluster, the corner of a polyline."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from segmap.angles import axial_mean
from segmap.arrays import Array
from segmap.extraction import fit_line
from segmap.poses import transform

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


# ------------------------------------------------------------------ the line of a cluster
def _noisy_walls(rng: Rng) -> Cases:
    """Nine points of a 1 m wall, 3 cm off it at random."""

    def wall(degrees: float, through: Any) -> tuple[Array]:
        points = np.stack([np.linspace(-0.5, 0.5, 9), rng.normal(0, 0.03, 9)], 1)
        return (transform((*through, np.radians(degrees)), points),)

    along, far = rng.uniform(20, 70), rng.uniform(0, 2)
    return {
        "a wall": wall(rng.uniform(10, 60), rng.uniform(2, 4, 2)),
        "an upright wall": wall(90, (rng.uniform(1, 4), 0)),
        "a wall in line with the sensor": wall(
            along, far * np.array([np.cos(np.radians(along)), np.sin(np.radians(along))])
        ),
        "a wall that leans to the left": wall(rng.uniform(95, 170), rng.uniform(-4, -2, 2)),
    }


def _fit_line(points: Array) -> float:
    return fit_line(points)[1]


def _regression(points: Array) -> float:
    """Angle of y = m x + q: squares of the vertical distances only."""
    d = points - points.mean(axis=0)
    return float(np.arctan((d[:, 0] * d[:, 1]).sum() / (d[:, 0] ** 2).sum()))


def _algebraic(points: Array) -> float:
    """Angle of a x + b y = 1 (A 3.1-3.3): depends on the origin."""
    a, b = np.linalg.lstsq(points, np.ones(len(points)), rcond=None)[0]
    return float(np.arctan2(-a, b))


def _not_centred(points: Array) -> float:
    x, y = np.linalg.eigh(points.T @ points)[1][:, -1]
    return float(np.arctan2(y, x))


check_fit_line = Exercise(
    "fit_line(points) -> radians: angle of the line with the least squared distances from "
    "points (n, 2) in metres",
    _fit_line,
    _noisy_walls,
    {
        "y = m x + q measures upright and fails for upright walls: use distances from the line": (
            _regression
        ),
        "a x + b y = 1 depends on where the origin is and fails for a line through it: "
        "subtract the mean of the points first": _algebraic,
        "the first and last point have noise like all others: let every point count": (
            lambda points: np.arctan2(*(points[-1] - points[0])[::-1])
        ),
        "this is the direction across the wall: turn it by 90 degrees": (
            lambda points: _fit_line(points) + np.pi / 2
        ),
        "subtract the mean of the points first: of points far from the origin this is the "
        "direction towards them": _not_centred,
        "the formula with arctan2 gives twice the angle: halve it": (
            lambda points: 2 * _fit_line(points)
        ),
        "np.arctan2 takes y first, then x": lambda points: np.pi / 2 - _fit_line(points),
        "the answer is wanted in radians": changed(_fit_line, np.degrees),
    },
    same_line,
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
