"""Exercises on clusters, polylines, the alignment of scans, and least cost."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..alignment import least_translation, match_values
from ..angles import axial_mean
from ..arrays import Array
from ..extraction import fit_line
from ..literal.least_cost import invented
from ..segments import length, midpoint, point_distance
from ._exercise import Exercise, same_line


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
    },
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
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    u, v = np.linspace(-0.5, 0.5, 9), np.random.default_rng(seed).normal(0, 0.03, 9)
    return through + np.stack([u * c - v * s, u * s + v * c], 1)


check_fit_line = Exercise(
    "fit_line(points) -> radians: angle of the line with the least squared distances from "
    "points (n, 2) in metres",
    lambda points: fit_line(points)[1],
    {
        "a wall at 30 degrees, 3 m away": (_noisy_wall(30, (3, 1), 1),),
        "an upright wall": (_noisy_wall(90, (2, 0), 2),),
        "a wall in line with the sensor": (_noisy_wall(45, (0, 0), 3),),
        "a wall at 100 degrees": (_noisy_wall(100, (-1, 2), 4),),
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
    },
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
    },
)


# --------------------------------------------------------------- angle correspondence
def _match_value(u: Array, v: Array, distance: float) -> float:
    """What the library finds for one pair, however far apart."""
    return float(match_values(u[None], v[None], distance=distance, far=1e6, whole=True)[0, 0])


def _covered(u: Array, v: Array, least: float = 0.0) -> float:
    """Length of u that v covers when projected on it; -inf as the least counts gaps too."""
    low, high = np.sort((v - u[0]) @ (u[1] - u[0]) / length(u))
    return float(max(least, min(high, length(u)) - max(low, 0)))


def _mean(u: Array, v: Array, least: float = 0.0) -> float:
    return (_covered(u, v, least) + _covered(v, u, least)) / 2


def _apart(u: Array, v: Array) -> tuple[float, float]:
    """The two directed Hausdorff distances."""
    return float(point_distance(v, u).max()), float(point_distance(u, v).max())


def _fading(apart: float, distance: float) -> float:
    return float(0.95 ** (apart / distance))


check_match_value = Exercise(
    "match_value(u, v, distance) -> float, metres: of two segments (2, 2) that do not cross, the "
    "mean of the lengths that they cover of each other, times 0.95 ** (D / distance)",
    _match_value,
    {
        words: (np.array(u, float), np.array(v, float), 0.05)
        for words, u, v in (
            ("two parallel walls", [(0, 0), (2, 0)], [(0, 0.1), (2, 0.1)]),
            ("a short wall beside a long one", [(0, 0), (4, 0)], [(1, 0.05), (2, 0.1)]),
            ("the same, exchanged", [(1, 0.05), (2, 0.1)], [(0, 0), (4, 0)]),
            ("a leaning wall, end points exchanged", [(0, 0), (3, 0)], [(2, 0.8), (1, 0.1)]),
            ("walls that overlap in part", [(0, 0), (2, 0)], [(1, 0.1), (3, 0.1)]),
            ("walls beside each other", [(0, 0), (1, 0)], [(2, 0), (3, 0)]),
            ("two upright walls", [(1, 0), (1, 3)], [(1.05, 2), (1.05, 0.5)]),
        )
    },
    {
        "this is the length of u that v covers; take the mean of it and of the length of v that "
        "u covers": lambda u, v, d: _covered(u, v) * _fading(min(_apart(u, v)), d),
        "the mean of both lengths is wanted, not their sum": (
            lambda u, v, d: 2 * _match_value(u, v, d)
        ),
        "the length is right; multiply it by 0.95 ** (D / distance)": lambda u, v, d: _mean(u, v),
        "D is measured in units of `distance`: divide it by that": (
            lambda u, v, d: _mean(u, v) * _fading(min(_apart(u, v)), 1.0)
        ),
        "D is the smaller of the two directed Hausdorff distances (A 2.39), not the larger": (
            lambda u, v, d: _mean(u, v) * _fading(max(_apart(u, v)), d)
        ),
        "D asks for the farthest point of one from the other, not for the nearest": (
            lambda u, v, d: (
                _mean(u, v)
                * _fading(min(point_distance(v, u).min(), point_distance(u, v).min()), d)
            )
        ),
        "D is measured from the end points of one to the other segment, not between middles": (
            lambda u, v, d: _mean(u, v) * _fading(np.hypot(*(midpoint(u) - midpoint(v))), d)
        ),
        "two walls beside each other cover nothing: no length is less than 0": (
            lambda u, v, d: _mean(u, v, -np.inf) * _fading(min(_apart(u, v)), d)
        ),
    },
)


# --------------------------------------------------------------------------- backbone
def _normal_equations(normals: Array, offsets: Array, weights: Array) -> Array:
    weighted = normals * weights[:, None]
    return np.asarray(np.linalg.solve(weighted.T @ normals, -weighted.T @ offsets), float)


def _lines(
    degrees: list[float], offsets: list[float], weights: list[float]
) -> tuple[Array, Array, Array]:
    """Unit normals of lines at these angles, how far points lie off them, and their weights."""
    turn = np.radians(degrees)
    return np.stack([-np.sin(turn), np.cos(turn)], -1), np.array(offsets), np.array(weights)


check_least_translation = Exercise(
    "least_translation(normals, offsets, weights) -> (2,) metres: the shortest of the shifts that "
    "minimise the weighted squares of the distances from lines, given their normals (m, 2) and how "
    "far the points now lie from them, (m,) metres",
    least_translation,
    {
        "a corner seen askew": _lines([10, 100, 40], [0.10, -0.05, 0.02], [1, 1, 1]),
        "a long wall and two short ones": _lines([0, 0, 90], [0.10, 0.02, 0.07], [6, 1, 2]),
        "a corridor": _lines([0, 0, 0], [0.08, 0.12, 0.10], [3, 3, 2]),
        "a corridor that runs askew": _lines([30, 30], [0.05, 0.07], [2, 1]),
        "three directions that disagree": _lines([0, 60, 120], [0.1, 0.1, 0.1], [1, 2, 3]),
    },
    {
        "this doubles the distances: a point above its line must come down, so mind the sign": (
            lambda normals, offsets, weights: -least_translation(normals, offsets, weights)
        ),
        "points move across the lines, along the normals: a shift along a line changes nothing": (
            lambda normals, *rest: least_translation(normals[:, ::-1] * (1, -1), *rest)
        ),
        "each row counts by its weight: a long wall says more than a short one": (
            lambda normals, offsets, weights: least_translation(normals, offsets, weights**0)
        ),
        "least squares squares its rows: multiply them by the root of the weight": (
            lambda normals, offsets, weights: least_translation(normals, offsets, weights**2)
        ),
        "in a corridor the matrix is singular: take the shortest solution (numpy.linalg.lstsq)": (
            _normal_equations
        ),
        "a mean of the single corrections goes only part of the way where lines differ in "
        "direction: solve for the shift": lambda normals, offsets, weights: (
            -(normals * (weights * offsets)[:, None]).sum(0) / weights.sum()
        ),
    },
)


# ------------------------------------------------------------------------- least cost
def _gaps(
    order: str = "sorted", least: float = 1.0, most: bool = True, around: str = "both"
) -> Any:
    """Metres in gaps, with the details that mistakes change."""

    def metres(spans: Array, whole: float, gap: float) -> float:
        spans = spans if order == "as given" else spans[np.argsort(spans[:, 0])]
        if not len(spans):
            return float(whole * (order != "none kept" or whole > gap))
        reached, found = 0.0 if around == "both" else spans[0, 0], 0.0
        for low, high in [*spans, (whole, whole)][: len(spans) + (around != "between")]:
            found += (low - reached) * (low - reached > least * gap)
            reached = max(reached, high) if most else high
        return found

    return metres


check_invented_metres = Exercise(
    "invented_metres(spans, whole, gap) -> metres of a segment, from 0 to whole, in gaps longer "
    "than gap between spans (k, 2), low and high, of the members that it keeps",
    lambda spans, whole, gap: invented([(a, b) for a, b in spans.tolist()], whole, gap),
    {
        words: (np.array(spans, float).reshape(-1, 2), np.array(whole), np.array(0.05))
        for words, spans, whole in (
            ("one member as long as the segment", [(0, 2)], 2.0),
            ("two members and a hole of 1 m", [(3, 5), (0, 2)], 5.0),
            ("a short member inside a long one", [(0, 4), (1, 2), (4.5, 6)], 6.0),
            ("a gap of 0.03 m", [(0, 2), (2.03, 4)], 4.0),
            ("nothing kept at the start", [(0.5, 2)], 2.0),
            ("nothing kept at the end", [(0, 1), (1, 1.5)], 2.0),
            ("no member at all", [], 3.0),
            ("no member, a segment shorter than the gap", [], 0.04),
        )
    },
    {
        "sort the members along the segment first": _gaps("as given"),
        "a short member inside a long one does not end it: keep the highest end": _gaps(most=False),
        "a gap up to `gap` costs nothing": _gaps(least=0.0),
        "look before the first member and behind the last one too": _gaps(around="between"),
        "behind the last member you look; look before the first one too": _gaps(around="end"),
        "where no member is kept, all is invented, however short": _gaps("none kept"),
    },
)
