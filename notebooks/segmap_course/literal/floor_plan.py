"""Walls become rooms and doors: the core of `segmap.plan.floor_plan`, on squares of free space.

Squares are an array `(rows, columns)`, row 0 lowest; walls run along x and y. Left out are walls
with closed corners, polygons, leaves of doors, and rules for corridors.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from segmap.arrays import Array
from segmap.segments import angle, length, midpoint

Labels = NDArray[np.int64]
#: How wide an opening is, metres, and two cells or rooms that meet there.
Doorway = tuple[float, int, int]


def axis_of(walls: Array) -> float:
    """The direction along or across which most metres run, degrees in [0, 90).

    A wall votes for all directions within 6 degrees of its own, the more the nearer.

    Examples
    --------
    >>> axis_of(np.array([[(0, 0), (2, 2)], [(0, 0), (1, -1)], [(0, 0), (3, 0)]]))
    45.0
    """
    places = np.arange(0, 90, 0.25)
    apart = abs((places[:, None] - np.degrees(angle(walls)) + 45) % 90 - 45)
    return float(places[(np.clip(1 - apart / 6, 0, None) @ length(walls)).argmax()])


def offsets_of(walls: Array, across: int, band: float = 0.15, least: float = 2.0) -> Array:
    """Offsets of lines across x (0) or y (1): the densest walls within a band, then the next.

    `walls` are `(n, 2, 2)`; offsets, band and the metres that a line needs at least are in metres.

    Examples
    --------
    >>> ends = [(0, 2), (0.1, 2), (4, 3), (6, 1)]
    >>> walls = np.array([[(x, 0), (x, y)] for x, y in ends])
    >>> offsets_of(walls, 0)
    array([0.05, 4.  ])
    """
    mine = walls[abs(walls[:, 1] - walls[:, 0])[:, across] < 0.14 * length(walls)]
    place, metres, offsets = midpoint(mine)[:, across], length(mine), []
    while metres.sum() >= least:
        inside = (place >= place[:, None]) & (place <= place[:, None] + band)
        chosen = inside[(inside @ metres).argmax()]
        if metres[chosen].sum() >= least:
            offsets.append(np.average(place[chosen], weights=metres[chosen]))
        place, metres = place[~chosen], metres[~chosen]
    return np.sort(offsets)


def cells_of(
    free: NDArray[np.bool_], corner: Sequence[float], side: float, lines: Sequence[Array]
) -> Labels:
    """The cell of each free square, else -1: squares between the same lines have one number.

    `corner` is where the first column and the lowest row begin, `side` that of a square, metres;
    `lines` are the offsets of the lines across x, and across y.

    Examples
    --------
    >>> free = np.array([[True, True, False], [True, True, True]])
    >>> cells_of(free, (0, 0), 1.0, 2 * [np.array([1.0])])
    array([[ 0,  1, -1],
           [ 2,  3,  3]])
    """
    middles = [corner[k] + side * (np.arange(n) + 0.5) for k, n in enumerate(free.shape[::-1])]
    column, row = (np.searchsorted(*pair) for pair in zip(lines, middles, strict=True))
    key = column + (len(lines[0]) + 1) * row[:, None]
    cells = np.full(free.shape, -1)
    cells[free] = np.unique(key[free], return_inverse=True)[1]
    return cells


def openings_of(cells: Labels) -> list[tuple[int, int, int]]:
    """Where one walks over a line: how many squares wide, and each two cells that meet there.

    Examples
    --------
    >>> openings_of(np.array([[0, 1], [0, 1], [0, -1], [2, 1]]))
    [(2, 0, 1), (1, 2, 1), (1, 0, 2)]
    """
    openings: list[tuple[int, int, int]] = []
    for turned in (cells, cells.T):
        for one, other in zip(turned.T[:-1], turned.T[1:], strict=True):
            meet = (one >= 0) & (other >= 0) & (one != other)
            for start, end in np.flatnonzero(np.diff(meet, prepend=0, append=0)).reshape(-1, 2):
                pairs = np.unique([one[start:end], other[start:end]], axis=1).T.tolist()
                openings += [(int(end - start), a, b) for a, b in pairs]
    return openings


def join(room: Labels, one: int, other: int) -> None:
    """The rooms of two cells become one, which has the lower number of both."""
    low, high = sorted((room[one], room[other]))
    room[room == high] = low


def join_open(
    cells: Labels, side: float, door: tuple[float, float] = (0.7, 2.5)
) -> tuple[Labels, list[Doorway]]:
    """The room of each cell, when cells are joined but where an opening is as wide as a door.

    And these doorways; `door` is the narrowest and the widest, metres.

    Examples
    --------
    >>> join_open(np.array([[0, 1], [0, 1], [0, -1], [2, -1]]), 0.5)
    (array([0, 1, 0]), [(1.0, 0, 1)])
    """
    room, doorways = np.arange(cells.max() + 1), []
    for squares, one, other in openings_of(cells):
        if door[0] <= side * squares <= door[1]:
            doorways.append((side * squares, one, other))
        else:
            join(room, one, other)
    return room, doorways


def widest_circle(squares: NDArray[np.bool_], side: float) -> float:
    """Diameter of the largest circle that such squares hold, metres.

    Examples
    --------
    >>> widest_circle(np.ones((4, 3), bool), 0.5)
    1.5
    """
    return side * float(2 * scipy.ndimage.distance_transform_edt(np.pad(squares, 1)).max() - 1)


def join_narrow(
    cells: Labels, side: float, room: Labels, doorways: list[Doorway], kappa: float
) -> set[Doorway]:
    """Join rooms at doorways that are too wide for one of them, the worst first: doors are left.

    `room` is changed; doors are between rooms, doorways between cells.

    Examples
    --------
    >>> cells = np.array([[0, 0, 0, 1, 2, 2, 2]] * 3)
    >>> room, doorways = np.arange(3), [(1.0, 0, 1), (1.0, 1, 2)]
    >>> join_narrow(cells, 0.5, room, doorways, 1.3), room
    ({(1.0, 0, 2)}, array([0, 0, 2]))
    """
    while True:
        doors = {(w, *sorted(room[[a, b]].tolist())) for w, a, b in doorways if room[a] != room[b]}
        rooms = np.where(cells < 0, -1, room[cells])
        circle = {k: widest_circle(rooms == k, side) for k in set(room.tolist())}
        ratios = [(min(circle[a], circle[b]) / w, a, b) for w, a, b in doors]
        if not ratios or min(ratios)[0] >= kappa:
            return doors
        join(room, *min(ratios)[1:])
