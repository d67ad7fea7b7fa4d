"""The shortest way for a robot on a quadtree map, through leaves that are far enough from walls."""

from __future__ import annotations

from copy import deepcopy
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Metres, checked
from ..quadtree import NINE, QuadtreeMap, Squares
from ._scores import Cells

QUARTERS = np.array([(0, 0), (1, 0), (0, 1), (1, 1)])
#: Parts of a cell that do not count: a radius that is a whole number of cells is reached.
CELL_ROUNDING = 1e-6


class NoRoute(ValueError):
    """There is no way; the message says why."""


@checked
def route(map: QuadtreeMap, start: ArrayLike, goal: ArrayLike, *, radius: Metres) -> Array:
    """The way of a round robot between two places, at least its radius from all occupied cells.

    Dijkstra (1959) over the leaves that are free: one that is partly too near is split, down to
    cells, as Kambhampati and Davis (1986, in B 2.1) do, and a way leads from the middle of one
    border to that of another. Then corners that see each other are joined by straight lines. Space
    that nobody has seen is never entered, but may come near. Maps are to be built with a
    `free_resolution`: without, a large leaf is free as soon as one ray has crossed it.

    Parameters
    ----------
    start, goal : (2,) array, metres
        Goals may be several, `(m, 2)`: the way leads to the one that is the nearest to drive to.

    Returns
    -------
    (k, 2) array, metres
        Corners of the way, from start to goal.

    Raises
    ------
    NoRoute
        A ValueError: start or goal lies in a wall, too near one, or where nothing has been seen, or
        there is no way between them.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.5, size=8, free_resolution=0.5)
    >>> tree.insert_scan((1, 1), [(4, 4)], free_points=[(x, 7) for x in range(8)])
    >>> route(tree, (1.2, 1.2), [(1.2, 6.2), (7, 7)], radius=0.5)
    array([[1.2, 1.2],
           [1.2, 6.2]])
    """
    map = deepcopy(arrays.instance(map, "map", QuadtreeMap))  # as it is now
    first = arrays.point(start, "start")
    many = np.ndim(arrays.numbers(goal, "goal")) == 2
    goals = arrays.points(goal, "goal") if many else arrays.point(goal, "goal")[None]
    if not len(goals):
        raise ValueError("goal must hold at least one place, got none")
    corner = map.corner + map.tree.corner * map.resolution
    places = (np.concatenate([first[None], goals]) - corner) / map.resolution
    clear = _clear(map, radius)
    square = clear.at(np.floor(places).astype(np.int64))
    if square[0] < 0 or (square[1:] < 0).all():
        raise NoRoute(_reason(map, "goal" if square[0] >= 0 else "start", first, goals[0], radius))
    corners = _way_of(clear, places, square)
    if corners is None:
        least = _clear(map, 0.0)
        square = least.at(np.floor(places).astype(np.int64))
        closed = _way_of(least, places, square) is None
        why = "walls or unknown space close it" if closed else "it is too narrow somewhere"
        raise NoRoute(
            f"no way from start {_place_text(first)} to a goal keeps {radius:g} m from walls: {why}"
        )
    return corner + _straighten(clear, corners) * map.resolution


def _clear(map: QuadtreeMap, radius: float) -> Squares:
    """Free squares that are at least so far from every occupied cell, as large as they come."""
    from scipy.spatial import cKDTree

    _, cell, level = map.tree.leaves()
    free = map.leaf_occupancy() < 0.5
    cell, level, clear = cell[free], level[free], []
    walls = map.tree.occupied_cells(np.array([0, 0, 1, 1]) << map.tree.level)
    # From the side of a cell to that of another it is as far as from the middle of the one to the
    # middle of the nearest of the other's nine.
    near = cKDTree((walls[:, None] + NINE).reshape(-1, 2))
    wanted = radius / map.resolution - CELL_ROUNDING
    while len(cell):
        half = ((1 << level) - 1) / 2
        away = near.query(cell + half[:, None])[0] if len(walls) else np.full(len(cell), np.inf)
        reach = half * np.sqrt(2)  # to the middles of its own outermost cells
        all_of_it = away - reach >= wanted
        clear.append((cell[all_of_it], level[all_of_it]))
        some = ~all_of_it & (away + reach >= wanted)  # never of a cell: its reach is 0
        level = level[some, None] - 1
        cell = (cell[some, None] + (QUARTERS << level[:, None])).reshape(-1, 2)
        level = np.repeat(level, 4)
    parts = [np.concatenate(part) for part in zip(*clear, strict=True)]
    return Squares(*parts) if parts else Squares(np.zeros((0, 2), np.int64), np.zeros(0, np.int64))


def _way_of(clear: Squares, places: Array, squares: Cells) -> Array | None:
    """Corners of the shortest way from the first place to one of the others; None where none is."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    one, other, edges = clear.borders()
    inner, inside = other >= 0, np.flatnonzero(squares >= 0)
    corners = np.concatenate([places, edges[inner].mean(1)])
    number = len(places) + np.arange(inner.sum())
    square = np.concatenate([squares[inside], one[inner], other[inner]])
    corner = np.concatenate([inside, number, number])
    order = np.argsort(square, kind="stable")
    square, corner = square[order], corner[order]

    # From each corner of a square to each other one: a straight line inside it.
    first, count = np.searchsorted(square, square), np.bincount(square)[square]
    number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    a, b = np.repeat(corner, count), corner[np.repeat(first, count) + number]
    length = np.hypot(*(corners[a] - corners[b]).T)
    ends = a.astype(np.int32), b.astype(np.int32)  # scipy before 1.15 finds no way by others
    graph = csr_array((length, ends), shape=(len(corners),) * 2)
    far, before = dijkstra(graph, indices=[0], return_predecessors=True)
    at = 1 + int(far[0, 1 : len(places)].argmin())
    if not np.isfinite(far[0, at]):
        return None
    way = [at]
    while way[-1] != 0:
        way.append(int(before[0, way[-1]]))
    return corners[way[::-1]]


def _straighten(clear: Squares, corners: Array) -> Array:
    """The same way without the corners between two that see each other."""
    way = [corners[0]]
    for here, after in pairwise(corners[1:]):
        if not _sees(clear, way[-1], after):
            way.append(here)
    return np.array([*way, corners[-1]])


def _sees(clear: Squares, start: Array, end: Array) -> bool:
    """Whether all cells that a straight line crosses are clear."""
    step, cuts = end - start, [np.array([0.0, 1.0])]
    for i in np.flatnonzero(step):
        low, high = sorted((start[i], end[i]))
        cuts.append((np.arange(np.ceil(low), np.floor(high) + 1) - start[i]) / step[i])
    t = np.sort(np.concatenate(cuts))
    middle = (t[1:] + t[:-1])[:, None] / 2
    crossed = np.floor(start + middle * step)[t[1:] - t[:-1] > 1e-12]
    return bool((clear.at(crossed.astype(np.int64)) >= 0).all())


def _reason(map: QuadtreeMap, name: str, start: Array, goal: Array, radius: float) -> str:
    """Why a robot cannot stand somewhere."""
    place = start if name == "start" else goal
    value = map.occupancy(place[None])[0]
    where = f"{name} {_place_text(place)} lies"
    if value == 0.5:
        return f"{where} where nothing has been seen"
    return f"{where} in a wall" if value > 0.5 else f"{where} nearer than {radius:g} m to a wall"


def _place_text(place: Array) -> str:
    return f"({place[0]:.6g}, {place[1]:.6g})"
