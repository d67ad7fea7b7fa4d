"""Exercises on lines that err, the viewing sector, fuzzy clustering and least cost."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform
from segmap.reduction.surveyed import Line, add_pose, kept_pieces

from ..literal.reduction.least_cost_merges import cost_of
from ._answers import Cases, near
from ._exercise import Exercise, Rng, anywhere, changed, edited


# -------------------------------------------------------------- weighted line fitting
def _lines_seen(rng: Rng) -> Cases:
    """Walls ahead, aside and aslant, seen from anywhere, and a place that is known exactly."""
    place, heading = rng.uniform(0.01, 0.05, 2)
    turn, at = rng.uniform(-np.pi, np.pi, 4), rng.uniform(-5, 5, (8, 2))
    ahead = at[1] + rng.uniform(1, 3) * np.array([np.cos(turn[0]), np.sin(turn[0])])
    aside = at[1] + rng.uniform(1, 3) * np.array([-np.sin(turn[1]), np.cos(turn[1])])
    return {
        "a wall straight ahead": (ahead, float(turn[0]), at[1], place, heading),
        "a wall along which the sensor looks": (aside, float(turn[1]), at[1], place, heading),
        "a slanted wall": (at[2], float(turn[2]), at[3], place, heading),
        "a place known exactly": (at[4], float(turn[3]), at[5], 0.0, heading),
    }


def _pose_covariance(
    centre: Array, alpha: float, sensor: Array, sigma_place: float, sigma_heading: float
) -> Array:
    """What eq. 2.20 adds to a line that was known exactly."""
    exact = Line(float(centre[0]), float(centre[1]), alpha, 0.0, 0.0, 0.0)
    line = add_pose(exact, sensor.tolist(), sigma_place, sigma_heading)
    return np.array([[line.rr, line.ra], [line.ra, line.aa]])


def _by_jacobian(c: Array, alpha: float, s: Array, place: float, heading: float) -> Array:
    """K diag K', of which the mistakes change a part."""
    d = s - c
    arm = d[1] * np.cos(alpha) - d[0] * np.sin(alpha)
    jacobian = np.array([(np.cos(alpha), np.sin(alpha), arm), (0, 0, 1)])
    return np.asarray(jacobian @ np.diag([place, place, heading]) ** 2 @ jacobian.T)


#: Where its arm stands.
_ARM = "d[1] * np.cos(alpha) - d[0] * np.sin(alpha)"


check_pose_covariance = Exercise(
    "pose_covariance(centre, alpha, sensor, sigma_place, sigma_heading) -> (2, 2): what the pose "
    "of a scan adds to the covariance of (offset, angle), metres and radians, of a line with its "
    "normal at alpha, about its centre (2,), seen from sensor (2,)",
    _pose_covariance,
    _lines_seen,
    {
        "a turn of the sensor swings a wall that lies aside: the third entry of K's first row is "
        "its arm, (s - c) . n'": edited(_by_jacobian, (_ARM, "0.0")),
        "the arm is measured along the wall, by n' = (-sin, cos), not across it": (
            edited(_by_jacobian, (_ARM, "d[0] * np.cos(alpha) + d[1] * np.sin(alpha)"))
        ),
        "the arm leads from the centre to the sensor, s - c: the other way round the sign of the "
        "off-diagonal is wrong": edited(_by_jacobian, ("s - c", "c - s")),
        "the arm is how far the sensor lies along the wall, not its whole distance": (
            edited(_by_jacobian, (_ARM, "np.hypot(*d)"))
        ),
        "a covariance holds squares of the standard deviations": edited(
            _by_jacobian, (" ** 2", "")
        ),
        "offset and angle err together: K diag K' is not diagonal": (
            edited(_by_jacobian, ("jacobian.T", "jacobian.T * np.eye(2)"))
        ),
        "the offset comes first, then the angle": changed(_pose_covariance, np.flip),
    },
    near,
)


# -------------------------------------------------------------- viewing sector
def _said_of_a_wall(rng: Rng) -> Cases:
    """A wall of 4 m, and what looks from several scans say of it, from where to where."""
    u, far = rng.uniform(0.4, 0.9, 2), rng.uniform(2.5, 3.5)

    def case(*said: tuple[str, float, float], forget: bool = True) -> tuple[Any, ...]:
        return 4.0, list(said), 0.1, forget

    return {
        "one look through the wall": case(("gone", u[0], 2.0)),
        "two looks, which overlap": case(("gone", u[0], 2.0), ("gone", 1 + u[1], far)),
        "two looks at different places": case(("gone", u[0], 1.2), ("gone", 2.0, far)),
        "two looks, and one on the wall": case(
            ("gone", u[0], far), ("matches", 1.5, 2.0), ("gone", u[1], far)
        ),
        "two looks, and one before the wall": case(
            ("gone", u[0], far), ("gone", 0.0, far), ("hides", far - 0.5, 4.0)
        ),
        "two looks that overlap by 5 cm": case(("gone", u[0], 2.05), ("gone", 2.0, far)),
        "three looks": case(("gone", u[0], 3.0), ("gone", 1.2, far), ("gone", 1.0, 2.5)),
        "nothing is forgotten": case(("gone", u[0], 2.0), ("gone", u[1], 2.0), forget=False),
    }


def _surely_kept(
    size: float, seen: list[tuple[str, float, float]], min_length: float, forget: bool
) -> list[tuple[float, float]]:
    """As the chapter's kept pieces; but one look through the wall is not enough."""
    gone: list[tuple[float, float]] = []
    cuts = sorted({0.0, size, *(u for _, *ends in seen for u in ends)})
    for a, b in pairwise(cuts):
        says = [word for word, low, high in seen if low < (a + b) / 2 < high]
        if len(says) >= 2 and set(says) == {"gone"}:
            gone.append((gone.pop()[0] if gone and gone[-1][1] == a else a, b))
    gone = [(a, b) for a, b in gone if forget and b - a >= min_length]
    edges = [0.0, *(u for piece in gone for u in piece), size]
    kept = list(zip(edges[::2], edges[1::2], strict=True))
    return [(a, b) for a, b in kept if not gone or b - a >= min_length]


check_surely_kept = Exercise(
    "surely_kept(size, seen, min_length, forget) -> the pieces (from, to) that stay of a wall, "
    "metres along it, ascending: all but those through which at least two stretches of `seen` went "
    "and none says otherwise; seen holds what each says ('matches', 'hides' or 'gone'), from, to",
    _surely_kept,
    _said_of_a_wall,
    {
        "this is the function of the chapter, where one look through the wall is enough": (
            kept_pieces
        ),
        "two looks must go through the same piece, not anywhere through the wall": edited(
            _surely_kept,
            (
                'len(says) >= 2 and set(says) == {"gone"}',
                'says and set(says) == {"gone"} and [w for w, *_ in seen].count("gone") > 1',
            ),
        ),
        "what another look saw on the wall or before it stays": edited(
            _surely_kept, ('set(says) == {"gone"}', 'says.count("gone") >= 2')
        ),
        "two looks are enough": edited(_surely_kept, ("len(says) >= 2", "len(says) >= 3")),
        "pieces below min_length are not cut out": edited(
            _surely_kept, ("forget and b - a >= min_length", "forget")
        ),
        "where nothing may be forgotten the whole wall stays": edited(
            _surely_kept, ("if forget and", "if")
        ),
        "return what stays, not what is gone": edited(
            _surely_kept, ("for a, b in kept if not gone or b", "for a, b in gone if b")
        ),
    },
)


# ------------------------------------------------------------------ fuzzy clustering
def _squares(rng: Rng) -> Cases:
    near, far = rng.uniform(1e-5, 1e-3), rng.uniform(0.2, 1, 3)
    noise = np.array(rng.uniform(0.05, 0.3))
    return {
        "on one wall, far from another": (np.array([near, far[0]]), noise),
        "between three walls": (rng.uniform(0.005, 0.02, 3), noise),
        "far from all": (far, noise),
    }


def _shares(squares: Array, noise: float, power: float = 1.0) -> Array:
    weights = squares**-power
    return np.asarray(weights / (weights.sum() + noise ** (-2 * power)))


check_memberships = Exercise(
    "memberships(squares, noise) -> (k,): the share of a point in each of k prototypes, from its "
    "squared distances (k,), m^2, above 0; the noise, always noise metres away, has the rest",
    _shares,
    _squares,
    {
        "the noise has a share too: the memberships add up to less than 1": (
            lambda squares, noise: 1 / squares / (1 / squares).sum()
        ),
        "the noise is a distance: square it": lambda s, noise: _shares(s, noise**0.5),
        "weights go with 1 / squares, not with 1 / distance": lambda s, n: _shares(s, n, 0.5),
        "squares are squared already": lambda s, n: _shares(s, n, 2.0),
        "the nearer a prototype, the larger its share": lambda s, n: _shares(s, n, -1.0),
        "the shares of the k prototypes are asked for; that of the noise is the rest": (
            changed(_shares, lambda shares: np.append(shares, 1 - shares.sum()))
        ),
        "the shares and that of the noise add up to 1: divide by the sum of all weights": (
            lambda s, n: 1 / s
        ),
    },
)


# ------------------------------------------------------------------------- least cost
def _looks_at_faces(rng: Rng) -> Cases:
    """Looks at a wall, each from its first beam to its last, and the line that would stand there.

    The line runs as the first look does or the other way, which means nothing.
    """
    pose = anywhere(rng)

    def case(*ways: int, size: float = 2.0, turn: float = 0.0) -> tuple[Array, Array]:
        low = np.column_stack(
            [rng.uniform(0, 0.04, len(ways)), rng.uniform(-0.02, 0.02, len(ways))]
        )
        high = low + np.column_stack([rng.uniform(0.9, 1, len(ways)) * size, 0 * low[:, 1]])
        high[-1, 1] += turn * size
        looks = np.stack([low, high], axis=1)
        looks = np.array([look[::way] for look, way in zip(looks, ways, strict=True)])
        line = np.array([(0, 0), (size + 0.1, 0)])[:: int(rng.choice([-1, 1]))]
        return transform(pose, looks), transform(pose, line)

    return {
        "four looks from one side": case(1, 1, 1, 1),
        "four looks from the other side": case(-1, -1, -1, -1),
        "three looks from one side and one from the other": case(1, 1, 1, -1),
        "one look from the side of the others, which come first": case(-1, -1, -1, 1),
        "two looks from each side": case(1, -1, 1, -1),
        "a short wall, and a look that is turned": case(1, 1, 1, size=0.4, turn=0.12),
        "a wall whose last look ends too far off": case(1, 1, turn=0.08),
        "a line that is longer than its only look": case(1),
    }


def _cost_of_faces(members: Array, line: Array) -> float:
    """As the chapter's cost; but two faces of a wall are two."""
    along = members[:, 1] - members[:, 0]
    if (along @ along[0] < 0).any():
        return np.inf
    return cost_of(members, line)


def _faces(*changes: tuple[str, str]) -> Callable[[Array, Array], float]:
    return edited(_cost_of_faces, *changes)


check_cost_of_faces = Exercise(
    "cost_of_faces(members, line) -> cost_of(members, line), metres, of looks (n, 2, 2) and the "
    "segment (2, 2) in their place; infinite where two looks were made from opposite sides",
    _cost_of_faces,
    _looks_at_faces,
    {
        "this is the chapter's own cost: two faces of one wall still cost a finite sum": cost_of,
        "the line in their place has no side: compare the looks with each other": (
            _faces(("along @ along[0]", "along @ (line[1] - line[0])"))
        ),
        "one look from the other side is enough, not half of all": (
            _faces(("(along @ along[0] < 0).any()", "(along @ along[0] < 0).mean() >= 0.5"))
        ),
        "looks from one side may have a line in common: only opposite ones may not": (
            _faces(("< 0).any()", "> 0).any()"))
        ),
        "looks from the other side are not left out of the sum: they forbid the line": (
            _faces(
                ("if (along @ along[0] < 0).any():", "if False:"),
                ("cost_of(members, line)", "cost_of(members[along @ along[0] > 0], line)"),
            )
        ),
        "a price is paid as soon as the penalty is high enough: it must be infinite": (
            _faces(("return np.inf", "return cost_of(members, line) + 0.25"))
        ),
        "all else costs what it did: the metres missed and invented too": (
            _faces(("return cost_of(members, line)", "return errors(members, [line]).sum()"))
        ),
    },
)
