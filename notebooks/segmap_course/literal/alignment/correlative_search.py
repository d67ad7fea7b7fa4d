"""Correlative search as plain loops: every pose of a window is tried (Olson 2009)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

Point = Sequence[float]
Cell = tuple[int, int]


def likelihoods(points: Sequence[Point], corner: Point) -> dict[Cell, int]:
    """Likelihood, 0 to 255, of the 5 cm cells around points: a wall is a band of 6 cm.

    Parameters
    ----------
    points : points of the map, metres
    corner : x, y, metres
        Lower left corner of cell (0, 0).

    Returns
    -------
    dict of (i, j) to int
        Cells that are left out have 0.

    Examples
    --------
    >>> likelihoods([(0.0, 0.0)], (0.0, 0.0))[1, 0]
    180
    """
    found: dict[Cell, int] = {}
    for x, y in points:
        i, j = math.floor((x - corner[0]) / 0.05), math.floor((y - corner[1]) / 0.05)
        for a in range(-3, 4):
            for b in range(-3, 4):
                away = (a * a + b * b) * 0.05**2
                value = int(255 * math.exp(-away / (2 * 0.06**2)))
                found[i + a, j + b] = max(found.get((i + a, j + b), 0), value)
    return found


def correlative_search(
    cells: dict[Cell, int],
    corner: Point,
    current: Sequence[Point],
    start: Point,
    radius: int,
    headings: Sequence[float],
    reach_cost: float = 0.1,
) -> Iterator[tuple[float, tuple[float, float, float]]]:
    """Score of every pose of a window: the best one is where the scan lies best on the map.

    Parameters
    ----------
    cells, corner : as for `likelihoods`
    current : points of the scan, metres, in the robot's frame
    start : x, y, heading, metres and radians
        The middle of the window.
    radius : int
        Half side of the window in cells.
    headings : radians, from the start's
    reach_cost : float
        What a pose at the window's edge costs.

    Yields
    ------
    score : float
        Mean likelihood of the points, 0 to 1, less what the distance from the start costs.
    pose : x, y, heading

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
        c, s = math.cos(start[2] + h), math.sin(start[2] + h)
        turned = [(c * x - s * y + start[0], s * x + c * y + start[1]) for x, y in current]
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
