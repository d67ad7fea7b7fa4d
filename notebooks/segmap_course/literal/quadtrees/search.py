"""Where a scan lies on a whole map: every pose is tried, then the places are told apart."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import ceil, dist, exp, floor, pi

from ..lines import Point, placed

Cell = tuple[int, int]
#: A sum of likelihoods, and the pose: its heading's number, column and row.
Scored = tuple[int, tuple[int, int, int]]


def likelihood(distance: float, sigma: float = 0.1) -> int:
    """What an end so far from its wall is worth, 0 to 255; distance and sigma in metres.

    Examples
    --------
    >>> likelihood(0.0), likelihood(0.1)
    (255, 155)
    """
    return round(255 * exp(-(distance**2) / (2 * sigma**2)))


def headings(points: Sequence[Point], size: float) -> int:
    """How many headings make a turn, so that the mean beam moves one cell of a size, metres.

    Examples
    --------
    >>> headings([(3.0, 0.0), (0.0, 2.0)], 0.05)
    315
    """
    mean = sum(dist(point, (0.0, 0.0)) for point in points) / len(points)
    return ceil(2 * pi * max(mean / size, 20))


def every_pose(
    cells: dict[Cell, int], shape: Cell, points: Sequence[Point], size: float, count: int
) -> Iterator[Scored]:
    """Sum of likelihoods of points with the robot in the middle of each cell, at each heading.

    Cells that are left out are worth 0; `shape` counts the columns and rows for the robot; points
    and the size of a cell are in metres.

    Examples
    --------
    >>> wall = {(2, 1): 255}
    >>> max(every_pose(wall, (3, 3), [(0.1, 0.0)], 0.1, 4))
    (255, (3, 2, 2))
    """
    for h in range(count):
        turned = [placed(point, (0.0, 0.0, 2 * pi * h / count)) for point in points]
        ends = [(floor(x / size + 0.5), floor(y / size + 0.5)) for x, y in turned]
        for i in range(shape[0]):
            for j in range(shape[1]):
                yield sum(cells.get((a + i, b + j), 0) for a, b in ends), (h, i, j)


def places(
    scored: Iterable[Scored], size: float, count: int, margin: int, least: int = 0
) -> list[Scored]:
    """The best pose, and each other that scores `margin` less at most and lies apart from better.

    Apart is farther than 0.3 m or 0.3 radians; `size` is that of a cell, metres, and `count` that
    of the headings of a turn.

    Examples
    --------
    >>> places([(9, (0, 0, 0)), (8, (0, 1, 0)), (8, (0, 5, 0)), (2, (0, 9, 0))], 0.1, 4, 1)
    [(9, (0, 0, 0)), (8, (0, 5, 0))]
    """
    ranked = sorted(scored, key=lambda pose: (-pose[0], pose[1]))
    apart_places: list[Scored] = []
    for total, (h, i, j) in ranked:
        if total < max(ranked[0][0] - margin, least):
            break
        turns = [abs(h - there) for _, (there, _, _) in apart_places]
        turned = [min(turn, count - turn) * 2 * pi / count for turn in turns]
        moved = [size * dist((i, j), (a, b)) for _, (_, a, b) in apart_places]
        if all(m > 0.3 or t > 0.3 for m, t in zip(moved, turned, strict=True)):
            apart_places.append((total, (h, i, j)))
    return apart_places
