"""Correlative search as plain loops: every pose of a window is tried (Olson 2009)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from ..lines import Point, placed

Cell = tuple[int, int]


def likelihoods(points: Sequence[Point], corner: Point) -> dict[Cell, int]:
    """Likelihood, 0 to 255, of the 5 cm cells around points: a wall is a band of 6 cm.

    The corner is the lower left one of cell (0, 0); cells that are left out have 0.

    Examples
    --------
    >>> likelihoods([(0.0, 0.0)], (0.0, 0.0))[1, 0]
    180
    """
    likelihood: dict[Cell, int] = {}
    for x, y in points:
        i, j = math.floor((x - corner[0]) / 0.05), math.floor((y - corner[1]) / 0.05)
        for a in range(-3, 4):
            for b in range(-3, 4):
                away = (a * a + b * b) * 0.05**2
                value = int(255 * math.exp(-away / (2 * 0.06**2)))
                likelihood[i + a, j + b] = max(likelihood.get((i + a, j + b), 0), value)
    return likelihood


def correlative_search(
    cells: dict[Cell, int],
    corner: Point,
    current: Sequence[Point],
    start: Point,
    radius: int,
    headings: Sequence[float],
    reach_cost: float = 0.1,
) -> Iterator[tuple[float, tuple[float, float, float]]]:
    """Score of every pose of a window, and the pose: the best is where the scan lies best.

    The window is `radius` cells to each side of the start, and has so many headings, radians from
    the start's. A score is the mean likelihood of the points, 0 to 1, less what the distance from
    the start costs: `reach_cost` at the window's edge.

    Examples
    --------
    >>> wall = [(0.02 * k, 0.0) for k in range(50)]
    >>> cells = likelihoods(wall, (-1, -1))
    >>> score, pose = max(correlative_search(cells, (-1, -1), wall, (0, 0.1, 0), 3, [0.0]))
    >>> round(score, 3), pose
    (0.956, (0.0, 0.0, 0.0))
    """
    widest = max(abs(h) for h in headings) or 1.0
    for h in headings:
        turned = [placed(p, (start[0], start[1], start[2] + h)) for p in current]
        at = [
            (math.floor((x - corner[0]) / 0.05), math.floor((y - corner[1]) / 0.05))
            for x, y in turned
        ]
        for i in range(-radius, radius + 1):
            for j in range(-radius, radius + 1):
                total = sum(cells.get((a + i, b + j), 0) for a, b in at)
                cost = reach_cost * ((i * i + j * j) / radius**2 + (h / widest) ** 2)
                pose = start[0] + 0.05 * i, start[1] + 0.05 * j, start[2] + h
                yield total / 255 / len(current) - cost, pose
