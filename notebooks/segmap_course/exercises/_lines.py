"""Exercises on clusters, polylines, the alignment of scans, and least cost."""

from __future__ import annotations

import numpy as np

from segmap.angles import axial_mean
from segmap.arrays import Array
from segmap.extraction import fit_line

from .. import literal
from ..literal import extraction
from ._answers import same_line
from ._exercise import Exercise
from .draws import scans as draws_scans


# ------------------------------------------------------------------- angles and lines
def _mean_vector(angles: Array) -> float:
    return float(np.arctan2(np.sin(angles).sum(), np.cos(angles).sum()))


check_axial_mean = Exercise(
    "axial_mean(angles) -> radians: mean direction of undirected lines at (n,) radians",
    axial_mean,
    {
        f"lines at {', '.join(map(str, degrees))} degrees": (np.radians(degrees),)
        for degrees in ((1, 179), (10, 20, 60), (170, 10, 20), (80, 100, 120, 130), (30,))
    },
    {
        "1 and 179 degrees are two degrees apart: their mean is no number between them": (
            lambda angles: np.mean(angles)
        ),
        "a line has no direction: its vector may as well be turned round. Double the angles": (
            _mean_vector
        ),
        "the mean of the doubled angles is double the angle: halve it": (
            lambda angles: _mean_vector(2 * angles)
        ),
        "the answer is wanted in radians": lambda angles: np.degrees(axial_mean(angles)),
        "np.arctan2 takes the sum of the sines first, then that of the cosines": (
            lambda angles: np.arctan2(np.cos(2 * angles).sum(), np.sin(2 * angles).sum()) / 2
        ),
        "np.arctan of the quotient loses half of the circle: np.arctan2 keeps the signs": (
            lambda angles: np.arctan(np.sin(2 * angles).sum() / np.cos(2 * angles).sum()) / 2
        ),
    },
    same_line,
    draw=draws_scans.axial_mean,
    own=(axial_mean,),
)


def _regression(points: Array) -> float:
    """Angle of y = m x + q: squares of the vertical distances only."""
    d = points - points.mean(axis=0)
    return float(np.arctan((d[:, 0] * d[:, 1]).sum() / (d[:, 0] ** 2).sum()))


def _algebraic(points: Array) -> float:
    """Angle of a x + b y = 1 (A 3.1-3.3): depends on the origin."""
    a, b = np.linalg.lstsq(points, np.ones(len(points)), rcond=None)[0]
    return float(np.arctan2(-a, b))


def _steepest(matrix: Array) -> float:
    """Angle of the eigenvector with the largest eigenvalue of a symmetric matrix."""
    x, y = np.linalg.eigh(matrix)[1][:, -1]
    return float(np.arctan2(y, x))


check_fit_line = Exercise(
    "fit_line(points) -> radians: angle of the line with the least squared distances from "
    "points (n, 2) in metres",
    lambda points: fit_line(points)[1],
    {
        "a wall at 30 degrees, 3 m away": (draws_scans.noisy_wall(30, (3, 1), 1),),
        "an upright wall": (draws_scans.noisy_wall(90, (2, 0), 2),),
        "a wall in line with the sensor": (draws_scans.noisy_wall(45, (0, 0), 3),),
        "a wall at 100 degrees": (draws_scans.noisy_wall(100, (-1, 2), 4),),
    },
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
            lambda points: fit_line(points)[1] + np.pi / 2
        ),
        "subtract the mean of the points first: of points far from the origin this is the "
        "direction towards them": lambda points: _steepest(points.T @ points),
        "the formula with arctan2 gives twice the angle: halve it": (
            lambda points: 2 * fit_line(points)[1]
        ),
        "np.arctan2 takes y first, then x": lambda points: np.pi / 2 - fit_line(points)[1],
        "the answer is wanted in radians": lambda points: np.degrees(fit_line(points)[1]),
    },
    same_line,
    draw=draws_scans.fit_line,
    own=(fit_line, literal.fit_total),
)


def _off_chord(points: Array) -> Array:
    """Distances from the line through the first and last point, with a sign."""
    d, r = points[-1] - points[0], points - points[0]
    return (d[0] * r[:, 1] - d[1] * r[:, 0]) / np.hypot(*d)


def _off_upright(points: Array) -> Array:
    d, r = points[-1] - points[0], points - points[0]
    return np.abs(r[:, 1] - d[1] / d[0] * r[:, 0])


check_farthest_point = Exercise(
    "farthest_point(points) -> int: index of the one of points (n, 2) that is farthest from the "
    "line through the first and the last",
    lambda points: int(np.argmax(np.abs(_off_chord(points)))),
    {
        words: (np.array(points, float),)
        for words, points in (
            ("a corner", [(0, 0), (1, 0), (2, 0), (2, 0.5), (2, 1)]),
            ("a bend to the other side", [(0, 0), (0.5, 0.1), (1, 0.8), (2, 0)]),
            ("a chord that stands upright", [(0, 0), (0.2, 0.9), (0.6, 1), (-0.1, 2), (0, 3)]),
            ("a steep chord", [(0, 0), (0.5, 1.0), (0.1, 2.1), (1, 3)]),
        )
    },
    {
        "points lie on both sides of the chord: take absolute distances": (
            lambda points: int(np.argmax(_off_chord(points)))
        ),
        "points lie on both sides of the chord: the sign must not decide": (
            lambda points: int(np.argmin(_off_chord(points)))
        ),
        "measure across the chord, not upright: an upright chord has no slope": (
            lambda points: int(np.argmax(_off_upright(points)))
        ),
        "this is the distance from the first point, wanted is the one from the chord": (
            lambda points: int(np.argmax(np.hypot(*(points - points[0]).T)))
        ),
        "the index counts from the first point of all, not from the first inner one": (
            lambda points: int(np.argmax(np.abs(_off_chord(points))[1:-1]))
        ),
        "this is the distance from the last point, wanted is the one from the chord": (
            lambda points: int(np.argmax(np.hypot(*(points - points[-1]).T)))
        ),
        "give the index of the point, not its distance": (
            lambda points: np.abs(_off_chord(points)).max()
        ),
    },
    draw=draws_scans.farthest_point,
    own=(extraction,),
)
