"""Fuzzy set (A 2.7.4): rectangles along one axis merge, the most precise first."""

from __future__ import annotations

import numpy as np

#: Where a wall lies across its axis, where it begins and ends along it, and its error; metres.
Rectangle = tuple[float, float, float, float]


def joined(f: Rectangle, g: Rectangle) -> Rectangle:
    """One rectangle for two on one axis."""
    across = (f[0] / f[3] + g[0] / g[3]) / (1 / f[3] + 1 / g[3])
    away = [abs(across - rectangle[0]) for rectangle in (f, g)]
    return across, min(f[1], g[1]), max(f[2], g[2]), max(min(f[3], g[3]), *away)


def apart(f: Rectangle, g: Rectangle, across: float = 0.20, along: float = 0.30) -> float:
    """How far two rectangles are apart, metres; infinite where they never merge."""
    side, gap = abs(f[0] - g[0]), max(0.0, max(f[1], g[1]) - min(f[2], g[2]))
    return (side + gap) / 2 if side < across and gap < along else np.inf


def all_joined(walls: list[Rectangle]) -> list[Rectangle]:
    """While one has a partner, the most precise that has one merges with the nearest.

    Examples
    --------
    >>> from segmap.reduction import fuzzy_set
    >>> rng = np.random.default_rng(4)
    >>> walls = [(y, x, x + 1, 0.02) for x, y in rng.uniform(0, 3, (30, 2))]
    >>> map = fuzzy_set([[(low, y), (high, y)] for y, low, high, _ in walls], axes=0.0)
    >>> ours = [[(low, y), (high, y)] for y, low, high, _ in all_joined(walls)]
    >>> len(ours), np.allclose(sorted(ours), sorted(map.segments.tolist()))
    (9, True)
    """
    for f in sorted(walls, key=lambda wall: round(wall[3], 9)):
        others = [g for g in walls if g is not f]
        near = [(round(apart(f, g), 9), round(g[3], 9), k) for k, g in enumerate(others)]
        if near and min(near)[0] < np.inf:
            g = others[min(near)[2]]
            first = next(wall for wall in walls if wall is f or wall is g)
            left = [wall for wall in walls if wall is first or (wall is not f and wall is not g)]
            return all_joined([joined(f, g) if wall is first else wall for wall in left])
    return walls
