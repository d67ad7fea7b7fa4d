"""Scores of a scan at a pose on a map of occupied cells: hits, distances, and a search (B 4.3)."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from heapq import heappop, heappush
from itertools import product
from math import dist, floor, hypot, inf

from ..lines import placed
from .quadtree import Cell, Point, Quadtree, Square, quarters

Pose = Sequence[float]


def occupancy_score(
    occupied: Mapping[Cell, float], points: Iterable[Point], pose: Pose, resolution: float
) -> float:
    """Sum of the occupancy of the cells that ends hit; `occupied` has those above 1/2 (B 4.3).

    Examples
    --------
    >>> occupancy_score({(3, 0): 1.0}, [(0.3, 0.0), (9.0, 9.0)], (0.05, 0.05, 0.0), 0.1)
    1.0
    """
    total = 0.0
    for point in points:
        x, y = placed(point, pose)
        total += occupied.get((floor(x / resolution), floor(y / resolution)), 0.0)
    return total


def distance_score(points: Iterable[Point], pose: Pose, centres: Iterable[Point]) -> float:
    """Minus the sum of distances from the ends to the nearest of the centres, metres (B 4.3)."""
    centres = list(centres)
    ends = [placed(point, pose) for point in points]
    return -sum(min(dist(end, centre) for centre in centres) for end in ends)


def squares_above(cells: Iterable[Cell], root: Square) -> set[Square]:
    """The cells, and each larger square that holds one of them, up to the root.

    Examples
    --------
    >>> sorted(squares_above([(3, 0)], (0, 0, 4)))
    [(0, 0, 4), (2, 0, 2), (3, 0, 1)]
    """
    x_min, y_min, size = root
    squares = {root}
    for x, y in cells:
        side = 1
        while side < size:
            squares.add((x - (x - x_min) % side, y - (y - y_min) % side, side))
            side *= 2
    return squares


def square_gap(square: Square, end: Point) -> float:
    """From an end to the nearest centre of a cell that a square may hold, in cells.

    Examples
    --------
    >>> square_gap((0, 0, 4), (5.5, 2.0)), square_gap((0, 0, 4), (1.0, 1.0))
    (2.0, 0.0)
    """
    x_min, y_min, side = square
    dx = max(x_min + 0.5 - end[0], 0.0, end[0] - (x_min + side - 0.5))
    dy = max(y_min + 0.5 - end[1], 0.0, end[1] - (y_min + side - 0.5))
    return hypot(dx, dy)


def nearest_cell(
    squares: Container[Square], root: Square, end: Point
) -> tuple[float, list[Square]]:
    """Distance to the nearest occupied cell's centre, in cells, and the squares opened for it.

    Nearest first: no square is opened that is farther than the answer (Hjaltason and Samet 1999).

    Examples
    --------
    >>> nearest_cell(squares_above([(3, 0)], (0, 0, 4)), (0, 0, 4), (2.5, 0.5))
    (1.0, [(0, 0, 4), (2, 0, 2)])
    """
    opened: list[Square] = []
    todo = [(0.0, root)]
    while todo:
        away, square = heappop(todo)
        x_min, y_min, side = square
        if side == 1:
            return away, opened
        opened.append(square)
        half = side // 2
        for quarter in product((x_min, x_min + half), (y_min, y_min + half), (half,)):
            if quarter in squares:
                heappush(todo, (square_gap(quarter, end), quarter))
    return inf, opened


def descent_score(tree: Quadtree, points: Iterable[Point], pose: Pose) -> float:
    """The same by B's descent: always into the occupied child whose centre is nearest (B 4.3).

    Examples
    --------
    >>> tree = Quadtree(1.0, 8)
    >>> for cell in ((4.5, 0.5), (0.5, 3.5)):
    ...     tree.insert(cell, [cell])
    >>> round(descent_score(tree, [(3.9, 0.5)], (0.0, 0.0, 0.0)), 3)
    -4.534
    """
    centres, (x_min, y_min), size = tree.occupied(), tree.corner, tree.resolution

    def centre(square: Square) -> Point:
        x, y, side = square
        return x_min + (x + side / 2) * size, y_min + (y + side / 2) * size

    def is_occupied(square: Square) -> bool:
        (x, y), half = centre(square), square[2] / 2 * size
        return any(max(abs(at[0] - x), abs(at[1] - y)) < half for at in centres)

    total = 0.0
    for point in points:
        end, square = placed(point, pose), tree.root
        while square[2] > 1:
            parts = [part for part in quarters(square) if is_occupied(part)]
            square = min(parts, key=lambda part: dist(end, centre(part)))
        total -= dist(end, centre(square))
    return total
