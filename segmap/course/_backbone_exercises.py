"""The exercise of the chapter on the backbone: how a scan moves onto lines."""

import numpy as np

from ..alignment import least_translation
from ..arrays import Array
from ._exercise import Case, Exercise, Mistake


def _normals(*degrees: float) -> Array:
    """Unit normals of lines at these angles."""
    turn = np.radians(degrees)
    return np.stack([-np.sin(turn), np.cos(turn)], -1)


def _along(normals: Array, offsets: Array, weights: Array) -> Array:
    return least_translation(normals[:, ::-1] * (1, -1), offsets, weights)


def _normal_equations(normals: Array, offsets: Array, weights: Array) -> Array:
    weighted = normals * weights[:, None]
    return np.asarray(np.linalg.solve(weighted.T @ normals, -weighted.T @ offsets), float)


def _added(normals: Array, offsets: Array, weights: Array) -> Array:
    return -(normals * (weights * offsets)[:, None]).sum(0) / weights.sum()


def _case(words: str, angles: list[float], offsets: list[float], weights: list[float]) -> Case:
    return Case(words, (_normals(*angles), np.array(offsets), np.array(weights)))


check_least_translation = Exercise(
    "least_translation",
    "least_translation(normals, offsets, weights) -> (2,) metres: the shortest of the shifts that "
    "minimise the weighted squares of the distances from lines, given their normals (m, 2) and how "
    "far the points now lie from them, (m,) metres",
    least_translation,
    (
        _case("a corner seen askew", [10, 100, 40], [0.10, -0.05, 0.02], [1, 1, 1]),
        _case("a long wall and two short ones", [0, 0, 90], [0.10, 0.02, 0.07], [6, 1, 2]),
        _case("a corridor", [0, 0, 0], [0.08, 0.12, 0.10], [3, 3, 2]),
        _case("a corridor that runs askew", [30, 30], [0.05, 0.07], [2, 1]),
        _case("three directions that disagree", [0, 60, 120], [0.1, 0.1, 0.1], [1, 2, 3]),
    ),
    (
        Mistake(
            "away from the lines",
            lambda normals, offsets, weights: -least_translation(normals, offsets, weights),
            "this doubles the distances: a point above its line must come down, so mind the sign",
        ),
        Mistake(
            "along the lines",
            _along,
            "points move across the lines, along the normals: a shift along a line changes nothing",
        ),
        Mistake(
            "without weights",
            lambda normals, offsets, weights: least_translation(
                normals, offsets, np.ones(len(weights))
            ),
            "each row counts by its weight: a long wall says more than a short one",
        ),
        Mistake(
            "weights squared",
            lambda normals, offsets, weights: least_translation(normals, offsets, weights**2),
            "least squares squares its rows: multiply them by the root of the weight",
        ),
        Mistake(
            "normal equations",
            _normal_equations,
            "in a corridor the matrix is singular: take the shortest solution (numpy.linalg.lstsq)",
        ),
        Mistake(
            "mean of the corrections",
            _added,
            "a mean of the single corrections goes only part of the way where lines differ in "
            "direction: solve for the shift",
        ),
    ),
)
