"""Points move the walls of a cell: Dave's adaptive clustering with noise (A 2.7.6, step 2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from .._runner import Indices
from .lines import SAME, Point

#: Prototypes rest when no membership changes by more.
MEMBERSHIP_REST = 1e-6
#: Prototypes move at most this many times.
MOST_MOVES = 100


class Prototype(NamedTuple):
    """A cluster while it forms: centre, unit direction, and mixing: 1 for a line, 0 for a point.

    The compiled loops take a row of an array for each.
    """

    x: float
    y: float
    dx: float
    dy: float
    mixing: float = 1.0


@compiled
def square_off(p: Array, q: Array) -> float:
    """Squared distance of a point, across the direction of a prototype more than along it."""
    u, v = p[0] - q[0], p[1] - q[1]
    along = u * q[2] + v * q[3]
    return max(u * u + v * v - q[4] * along * along, 1e-12)


@compiled
def share_out(p: Array, prototypes: Array, noise: float, shares: Array) -> None:
    """Step 2: write what share of a point belongs to each prototype; noise has the rest."""
    total = 0.0
    for j in range(len(prototypes)):
        shares[j] = 1 / square_off(p, prototypes[j])
        total += shares[j]
    total += 1 / (noise * noise)
    for j in range(len(prototypes)):
        shares[j] /= total


@compiled
def move(q: Array, points: Array, shares: Array, total: float) -> None:
    """A prototype goes to its points, weighted with the squares of their shares."""
    x = y = xx = xy = yy = 0.0
    for i in range(len(points)):
        w = shares[i] * shares[i] / total
        x, y = x + w * points[i, 0], y + w * points[i, 1]
    for i in range(len(points)):
        w, dx, dy = shares[i] * shares[i], points[i, 0] - x, points[i, 1] - y
        xx, xy, yy = xx + w * dx * dx, xy + w * dx * dy, yy + w * dy * dy
    spread = np.hypot(xx - yy, 2 * xy)
    q[0], q[1] = x, y
    if xx + yy + spread > 0.0:
        theta = 0.5 * np.arctan2(2 * xy, xx - yy)
        q[2], q[3] = np.cos(theta), np.sin(theta)
        q[4] = 1 - max(xx + yy - spread, 0.0) / (xx + yy + spread)


@compiled
def settle(points: Array, starts: Array, noise: float) -> Array:
    """Step 2: move prototypes until no membership changes; drop those that are left with little."""
    prototypes, k, has_before = starts.copy(), len(starts), False
    shares, before = np.zeros((len(points), k)), np.zeros((len(points), k))
    for _ in range(MOST_MOVES):
        change, totals, survivors = 0.0, np.zeros(k), 0
        for i in range(len(points)):
            share_out(points[i], prototypes[:k], noise, shares[i])
            for j in range(k):
                change = max(change, abs(shares[i, j] - before[i, j]))
                before[i, j] = shares[i, j]
                totals[j] += shares[i, j] * shares[i, j]
        for j in range(k):
            if totals[j] >= 2.0:
                for d in range(5):
                    prototypes[survivors, d] = prototypes[j, d]
                survivors += 1
        if survivors < k:
            k, has_before = survivors, False
            continue
        if k == 0 or (has_before and change < MEMBERSHIP_REST):
            break
        has_before = True
        for j in range(k):
            move(prototypes[j], points, shares[:, j], totals[j])
    return prototypes[:k]


@compiled
def pick_prototypes(points: Array, prototypes: Array, noise: float) -> Indices:
    """Step 3: the prototype of the largest share of each point, the first of equals; -1: noise."""
    picks, shares = np.full(len(points), -1), np.zeros(len(prototypes))
    for i in range(len(points)):
        share_out(points[i], prototypes, noise, shares)
        most = rest = 0.0
        for j in range(len(prototypes)):
            most, rest = max(most, shares[j]), rest + shares[j]
        for j in range(len(prototypes)):
            if picks[i] < 0 and 1 - rest <= most + SAME and shares[j] >= most - SAME:
                picks[i] = j
    return picks


def clustered(
    points: Sequence[Point], starts: Sequence[Prototype], noise: float
) -> list[Prototype]:
    """What the points of one cell make of prototypes; noise is so many metres from every point."""
    rows = settle(np.array(points, float), np.array(starts, float), noise)
    return [Prototype(*row) for row in rows.tolist()]


def memberships(p: Point, prototypes: Sequence[Prototype], noise: float) -> list[float]:
    """The share of a point that belongs to each prototype."""
    shares = np.zeros(len(prototypes))
    share_out(np.array(p, float), np.array(prototypes, float).reshape(-1, 5), noise, shares)
    return shares.tolist()
