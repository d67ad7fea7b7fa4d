"""Exercises of the chapters on clusters, lines, polylines and undirected angles."""

import numpy as np

from ..angles import axial_mean
from ..arrays import Array
from ..extraction import fit_line
from ._exercise import Case, Exercise, Mistake, same_line


def _mean_vector(angles: Array) -> float:
    return float(np.arctan2(np.sin(angles).sum(), np.cos(angles).sum()))


check_axial_mean = Exercise(
    "axial_mean",
    "axial_mean(angles) -> radians: mean direction of undirected lines at (n,) radians",
    axial_mean,
    tuple(
        Case(f"lines at {', '.join(map(str, degrees))} degrees", (np.radians(degrees),))
        for degrees in ((1, 179), (10, 20, 60), (170, 10, 20), (80, 100, 120, 130), (30,))
    ),
    (
        Mistake(
            "plain mean",
            np.mean,
            "1 and 179 degrees are two degrees apart: their mean is no number between them",
        ),
        Mistake(
            "vectors without doubling",
            _mean_vector,
            "a line has no direction: its vector may as well be turned round. Double the angles",
        ),
        Mistake(
            "not halved",
            lambda angles: _mean_vector(2 * angles),
            "the mean of the doubled angles is double the angle: halve it",
        ),
        Mistake(
            "degrees",
            lambda angles: np.degrees(axial_mean(angles)),
            "the answer is wanted in radians",
        ),
    ),
    same_line,
)


def _regression(points: Array) -> float:
    """Angle of y = m x + q: squares of the vertical distances only."""
    d = points - points.mean(axis=0)
    return float(np.arctan((d[:, 0] * d[:, 1]).sum() / (d[:, 0] ** 2).sum()))


def _algebraic(points: Array) -> float:
    """Angle of a x + b y = 1 (A 3.1-3.3): depends on the origin."""
    a, b = np.linalg.lstsq(points, np.ones(len(points)), rcond=None)[0]
    return float(np.arctan2(-a, b))


def _noisy_wall(degrees: float, through: tuple[float, float], seed: int) -> Array:
    """Nine points of a 1 m wall, 3 cm off it at random."""
    rng, turn = np.random.default_rng(seed), np.radians(degrees)
    u, v = np.linspace(-0.5, 0.5, 9), rng.normal(0, 0.03, 9)
    return through + np.stack(
        [u * np.cos(turn) - v * np.sin(turn), u * np.sin(turn) + v * np.cos(turn)], 1
    )


check_fit_line = Exercise(
    "fit_line",
    "fit_line(points) -> radians: angle of the line with the least squared distances from "
    "points (n, 2) in metres",
    lambda points: fit_line(points)[1],
    (
        Case("a wall at 30 degrees, 3 m away", (_noisy_wall(30, (3, 1), 1),)),
        Case("an upright wall", (_noisy_wall(90, (2, 0), 2),)),
        Case("a wall in line with the sensor", (_noisy_wall(45, (0, 0), 3),)),
        Case("a wall at 100 degrees", (_noisy_wall(100, (-1, 2), 4),)),
    ),
    (
        Mistake(
            "y = m x + q",
            _regression,
            "y = m x + q measures upright and fails for upright walls: use distances from the line",
        ),
        Mistake(
            "a x + b y = 1",
            _algebraic,
            "a x + b y = 1 depends on where the origin is and fails for a line through it: "
            "subtract the mean of the points first",
        ),
        Mistake(
            "first to last point",
            lambda points: np.arctan2(*(points[-1] - points[0])[::-1]),
            "the first and last point have noise like all others: let every point count",
        ),
        Mistake(
            "normal",
            lambda points: fit_line(points)[1] + np.pi / 2,
            "this is the direction across the wall: turn it by 90 degrees",
        ),
    ),
    same_line,
)


def _off_chord(points: Array) -> Array:
    """Distances from the line through the first and last point, with a sign."""
    d, r = points[-1] - points[0], points - points[0]
    return (d[0] * r[:, 1] - d[1] * r[:, 0]) / np.hypot(*d)


def _off_upright(points: Array) -> Array:
    d, r = points[-1] - points[0], points - points[0]
    return np.abs(r[:, 1] - d[1] / d[0] * r[:, 0])


check_farthest_point = Exercise(
    "farthest_point",
    "farthest_point(points) -> int: index of the one of points (n, 2) that is farthest from the "
    "line through the first and the last",
    lambda points: int(np.argmax(np.abs(_off_chord(points)))),
    (
        Case("a corner", (np.array([(0, 0), (1, 0), (2, 0), (2, 0.5), (2, 1)], float),)),
        Case("a bend to the other side", (np.array([(0, 0), (0.5, 0.1), (1, 0.8), (2, 0)]),)),
        Case(
            "a chord that stands upright",
            (np.array([(0, 0), (0.2, 0.9), (0.6, 1), (-0.1, 2), (0, 3)]),),
        ),
        Case("a steep chord", (np.array([(0, 0), (0.5, 1.0), (0.1, 2.1), (1, 3)]),)),
    ),
    (
        Mistake(
            "signed",
            lambda points: int(np.argmax(_off_chord(points))),
            "points lie on both sides of the chord: take absolute distances",
        ),
        Mistake(
            "other sign",
            lambda points: int(np.argmin(_off_chord(points))),
            "points lie on both sides of the chord: the sign must not decide",
        ),
        Mistake(
            "measured upright",
            lambda points: int(np.argmax(_off_upright(points))),
            "measure across the chord, not upright: an upright chord has no slope",
        ),
        Mistake(
            "from the first point",
            lambda points: int(np.argmax(np.hypot(*(points - points[0]).T))),
            "this is the distance from the first point, wanted is the one from the chord",
        ),
        Mistake(
            "counted without the first point",
            lambda points: int(np.argmax(np.abs(_off_chord(points))[1:-1])),
            "the index counts from the first point of all, not from the first inner one",
        ),
    ),
)
