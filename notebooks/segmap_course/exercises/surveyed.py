"""Exercises on lines that err, the viewing sector, fuzzy clustering and least cost."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform
from segmap.reduction.surveyed import Line, fit, kept_pieces, variance

from ..literal.reduction.least_cost_merges import cost_of
from ._answers import Cases, same_poses
from ._exercise import Exercise, Rng, anywhere, changed, edited


# -------------------------------------------------------------- weighted line fitting
def _wall_behind_a_person(rng: Rng) -> Cases:
    """A wall of 41 points, seen from anywhere; something stands before or behind it, or nothing."""
    noise = np.array((0.01, 0.004))

    def case(where: list[int], off: Any = 0.0) -> tuple[Any, ...]:
        place, far = anywhere(rng), rng.uniform(1.5, 2.5)
        across = rng.normal(0, noise[0], 41).clip(-1.5 * noise[0], 1.5 * noise[0])
        across[where] = off
        wall = np.stack([np.linspace(-1.5, 1.5, 41), far + across], 1)
        return transform(place, wall), place[:2], *noise.tolist()

    return {
        "nobody": case([]),
        "somebody amid the wall": case([18, 19, 20], -rng.uniform(0.25, 0.3)),
        "somebody at its end": case([36, 37, 38, 39], -rng.uniform(0.1, 0.15)),
        "a niche near its begin": case([3, 4, 5, 6], rng.uniform(0.1, 0.15)),
        "four points at 23 mm": case([8, 18, 22, 32], [0.023, -0.023, -0.023, 0.023]),
    }


def _steady_fit(points: Array, s: Array, range_: float, bearing: float, most: float = 3.0) -> Line:
    """As the chapter's fit, again without what lies far across, until the same points count."""
    near, before = np.full(len(points), True), np.full(len(points), False)
    for _ in range(50):
        if (near == before).all():
            break
        line, before = fit(points[near], s, range_, bearing), near
        across = np.array([np.cos(line.alpha), np.sin(line.alpha)])
        sigma = [variance(p, s, line.alpha, range_, bearing) ** 0.5 for p in points]
        near = np.abs((points - (line.x, line.y)) @ across) <= most * np.array(sigma)
    return line


check_steady_fit = Exercise(
    "steady_fit(points, s, range_, bearing) -> Line: that of points (n, 2), metres, seen from s "
    "(2,), as `fit` finds it; but what lies more than three deviations across the line has no "
    "weight, and the line is fitted again until the same points count",
    _steady_fit,
    _wall_behind_a_person,
    {
        "this is the fit of the chapter: a person before the wall bends the line": fit,
        "one time is not enough: without the person the line lies elsewhere": edited(
            _steady_fit, ("range(50)", "range(2)")
        ),
        "three deviations, not two": edited(
            _steady_fit, ("most: float = 3.0", "most: float = 2.0")
        ),
        "a deviation is the root of the variance": edited(_steady_fit, (" ** 0.5", "")),
        "what lies behind the wall counts no more than what lies before it": edited(
            _steady_fit,
            (
                "np.abs((points - (line.x, line.y)) @ across)",
                "-np.sign((s - (line.x, line.y)) @ across)"
                " * ((points - (line.x, line.y)) @ across)",
            ),
        ),
    },
    same_poses,
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
    pieces = list(zip(edges[::2], edges[1::2], strict=True))
    return [(a, b) for a, b in pieces if not gone or b - a >= min_length]


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
            _surely_kept, ("for a, b in pieces if not gone or b", "for a, b in gone if b")
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
