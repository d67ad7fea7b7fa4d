"""Hidden cases of the exercises on the quadtree, on scores and on matchers.

Each function draws the cases of the exercise of its name, as those of `_exercise_draws_scans` do.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import floor
from typing import Any

import numpy as np

from .scans import Drawn, Rng, anywhere


# ------------------------------------------------------------------------------ cells
def cell_of(rng: Rng) -> Drawn:
    """Inside cells, left of the corner, and where products and floor divisions round wrongly."""
    r = float(rng.choice([0.05, 0.1, 0.2, 0.25]))
    corner, k = round(rng.uniform(0.5, 3), 1), int(rng.integers(5, 40))
    edges = [(round(i * s, 2), s) for s in (0.05, 0.1, 0.2) for i in range(1, 200)]
    product = [(x, s) for x, s in edges if floor(x * (1 / s)) != floor(x / s)]
    floored = [(x, s) for x, s in edges if x // s != floor(x / s)]
    chosen = (
        *((round((k + 0.6) * r, 4), 0.0, r), (round(-0.4 * r, 4), 0.0, r)),
        *((round(-(k + 0.7) * r, 4), 0.0, r), (round(corner + (k + 0.6) * r, 4), corner, r)),
        *((x, 0.0, s) for x, s in (*rng.permutation(product)[:1], *rng.permutation(floored)[:1])),
    )
    return {
        f"x = {x}, corner {c}, cells of {s} m": (float(x), float(c), float(s)) for x, c, s in chosen
    }


def grown(rng: Rng) -> Drawn:
    """A root anywhere and a cell on each of its sides and corners."""
    side = int(2 ** rng.integers(2, 6))
    x, y = (int(v) for v in rng.integers(-20, 20, 2))
    near, far = (int(v) for v in rng.integers(0, side, 2))
    away = side * int(rng.integers(2, 9))
    cells = (
        (x + near + away, y - 1 - far - away),
        *((x + near, y + side + far), (x + side + far, y + near), (x - 1 - far, y + near)),
        *((x + near, y - 1 - far), (x - 1 - far, y + side), (x + side + far, y - 1 - near)),
    )
    return {f"root {(x, y, side)} and cell {cell}": ((x, y, side), cell) for cell in cells}


def occupancy(rng: Rng) -> Drawn:
    """Nothing known, few rays, many rays, hits; also fewer rays than the bias."""
    bias = int(rng.integers(4, 40))
    few, hits = int(rng.integers(1, bias)), int(rng.integers(1, bias))
    return {
        f"vis = {v}, occ = {o}, bias = {bias}": (v, o, bias)
        for v, o in (
            *((0, 0), (few, 0), (bias, 0), (3 * bias + few, 0)),
            *((bias + hits, hits), (hits, hits), (few + 1, 1), (1, 1)),
        )
    }


def ray_cells(rng: Rng) -> Drawn:
    """Rays of all eight directions, along the axes, diagonal, of one cell, with equal errors."""
    x, y = (int(v) for v in rng.integers(-9, 10, 2))
    long, short = int(rng.integers(6, 12)), int(rng.integers(1, 6))
    even = 2 * int(rng.integers(2, 5))
    ways = (
        *((long, short), (-long, short), (short, long), (-short, -long), (long, -short)),
        *((even, even // 2), (-even, 1), (0, 0), (0, -short), (short, -short), (4 * short, 1)),
    )
    return {f"from {(x, y)} to {(x + dx, y + dy)}": ((x, y), (x + dx, y + dy)) for dx, dy in ways}


def pixel(rng: Rng) -> Drawn:
    """Points inside pictures of several origins and sizes."""

    def case() -> tuple[Any, ...]:
        side, rows = float(rng.choice([0.25, 0.5])), int(rng.integers(6, 30))
        origin = tuple(float(v) for v in rng.integers(-8, 9, 2) / 4)
        column, row = (int(v) for v in rng.integers(0, rows, 2))
        part = rng.uniform(0.1, 0.9, 2)
        x, y = origin[0] + (column + part[0]) * side, origin[1] + (row + part[1]) * side
        return round(x, 3), round(y, 3), origin, side, rows

    drawn = [case() for _ in range(4)]
    return {f"({c[0]}, {c[1]}), origin {c[2]}, {c[4]} rows": c for c in drawn}


# --------------------------------------------------------------- scores and matchers
def scan_score(rng: Rng) -> Drawn:
    """Scans of several beams and of one, shifted, turned and both."""
    points, centres = rng.uniform(-3, 3, (5, 2)), rng.uniform(-3, 3, (7, 2))
    moved = np.append(rng.uniform(0.2, 1, 2) * rng.choice([-1, 1], 2), 0.0)
    turned = np.array([0, 0, rng.uniform(0.4, 2.5) * rng.choice([-1, 1])])
    return {
        "a pose that changes nothing": (points, np.zeros(3), centres),
        "a pose that is shifted": (points, moved, centres),
        "a pose that is turned": (points[:3], turned, centres),
        "a pose that is shifted and turned": (points, anywhere(rng), centres),
        "a single beam": (points[:1], moved + turned, centres),
    }


@dataclass(frozen=True)
class Hill:
    """The value of a pose: the less, the farther from the top; y counts twice."""

    x: float
    y: float
    heading: float

    def __call__(self, pose: Any) -> float:
        """The score of a pose."""
        away = abs(pose[0] - self.x) + 2 * abs(pose[1] - self.y) + abs(pose[2] - self.heading)
        return float(-away)


@dataclass(frozen=True)
class Plane:
    """A value that grows with x and y, or with the distance from the x axis."""

    x: float
    y: float
    folded: bool = False

    def __call__(self, pose: Any) -> float:
        """The score of a pose."""
        return float(self.x * pose[0] + self.y * (abs(pose[1]) if self.folded else pose[1]))


def climb_step(rng: Rng) -> Drawn:
    """Hills, a top, a plain, a valley with two ways up, a turned robot, a coarse turn."""
    top = rng.uniform(-1, 1, 3)
    move, right, up = rng.uniform(0.05, 0.2), *rng.uniform(0.3, 0.9, 2)
    hill, start = Hill(*top.tolist()), rng.uniform(-1, 1, 3)
    return {
        words: (value, np.array(pose, float), float(step), float(turn))
        for words, value, pose, step, turn in (
            ("a hill to the right and below", hill, top + (-right, up, 0.3), move, move),
            ("a hill to the left and above", hill, top + (right, -up, -0.3), move, move),
            ("a hill, nearly there", hill, top + (0, move, 0), move, move),
            ("on the top", hill, top, move, move),
            ("a plain", Plane(0, 0), start, move, move),
            ("a valley, both ways up", Plane(0, 1, folded=True), start * (1, 0, 1), 0.125, 0.125),
            ("a slope, the robot turned", Plane(2, 1), start * (1, 1, 0) + (0, 0, 2), move, move),
            ("a coarse turn", hill, top - (0, 0, 0.4), 0.001, 1.0),
        )
    }
