"""Cells join to rooms where nothing stands between them; doorways stay between rooms."""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Callable

import numpy as np
import scipy

from ..arrays import Array
from ..quadtree import OCCUPIED
from ._cells import LEAST_HOLE_M2, Edges, Grid, unseen_border
from ._lines import Indices

#: In the border of two rooms this stands for all of it; runs of the edges are its open parts.
WHOLE = -2
#: Where a corridor ends in a room, its mouth is a doorway if the room is so many times wider than
#: else is asked, and the corridor so many times longer: else it is a niche, or a part of the room.
CORRIDOR_TIMES = 2.5


class Partition:
    """Rooms that grow by joining.

    `members` are the cells of each room, `near` its neighbours with the squares of their border:
    all of them, and those in each open run of the edges.
    """

    def __init__(self, grid: Grid, cells: Indices, edges: Edges, narrowest: float) -> None:
        self.cells, self.edges, self.side, self.narrowest = cells, edges, grid.side, narrowest
        self.boxes = scipy.ndimage.find_objects(cells + 1)
        self.members = {cell: [cell] for cell in range(len(self.boxes))}
        self.area = np.bincount(cells[cells >= 0]) * grid.side**2
        self.near: dict[int, dict[int, Counter[int]]] = {cell: {} for cell in self.members}
        self.widths: dict[int, float] = {}
        walls = (scipy.ndimage.maximum_filter(grid.kind, 3) == OCCUPIED) & (cells >= 0)
        self.open_ends = unseen_border(grid, cells, 0.0) / grid.side
        self.open_ends -= np.bincount(cells[walls], minlength=len(self.boxes))
        met = (edges.squares[:, :2] >= 0).all(1) & (edges.squares[:, 0] != edges.squares[:, 1])
        for one, other, run in edges.squares[met].tolist():
            border = self.near[one].setdefault(other, Counter())
            self.near[other][one] = border
            border[WHOLE] += 1
            border[run] += run >= 0

    def join(self, a: int, b: int) -> list[tuple[int, int]]:
        """Two rooms become one, that with more neighbours: its borders that have changed."""
        host, gone = (a, b) if len(self.near[a]) >= len(self.near[b]) else (b, a)
        changed = self.near.pop(gone)
        del self.near[host][gone], changed[host]
        for other, border in changed.items():
            del self.near[other][gone]
            self.near[host].setdefault(other, Counter()).update(border)
            self.near[other][host] = self.near[host][other]
        self.members[host] += self.members.pop(gone)
        self.area[host] += self.area[gone]
        self.open_ends[host] += self.open_ends[gone]
        self.widths = {room: self.widths[room] for room in self.widths.keys() - {host, gone}}
        return [(min(host, other), max(host, other)) for other in changed]

    def opening(self, a: int, b: int, *, doors: bool) -> dict[int, float]:
        """Metres of the border in each open run, doorways or others."""
        runs, side, border = self.edges.runs, self.side, self.near[a][b].items()
        return {k: n * side for k, n in border if k >= 0 and bool(runs[k].door) == doors}

    def is_glimpse(self, room: int) -> bool:
        """Whether a room was only looked into: nobody saw most of its border.

        It is not the largest, and has no openings but doorways and narrower ones.
        """
        if self.open_ends[room] <= 0 or self.area[room] == self.area.max():
            return False
        runs, border = self.edges.runs, sum(self.near[room].values(), Counter[int]())
        wide = max((n for k, n in border.items() if k >= 0 and not runs[k].door), default=0)
        return bool(self.open_ends[room] > border[WHOLE] and wide * self.side < self.narrowest)

    def width(self, room: int) -> float:
        """Diameter of the largest circle in a room, metres."""
        if room not in self.widths:
            sides = zip(*(self.boxes[cell] for cell in self.members[room]), strict=True)
            box = tuple(slice(min(b.start for b in s), max(b.stop for b in s)) for s in sides)
            own = np.isin(self.cells[box], self.members[room])
            away = scipy.ndimage.distance_transform_edt(np.pad(own, 1))
            self.widths[room] = float(2 * away.max() - 1) * self.side
        return self.widths[room]

    def merge(self, score: Callable[[int, int], tuple[float, float]]) -> None:
        """Join neighbours, those with the lowest score first, while one is finite."""

        def cost(*pair: int) -> tuple[float, float]:
            return (np.inf, 0.0) if any(map(self.is_glimpse, pair)) else score(*pair)

        heap = [(*cost(a, b), a, b) for a in self.near for b in self.near[a] if a < b]
        heapq.heapify(heap)
        while heap and heap[0][0] < np.inf:
            *was, a, b = heapq.heappop(heap)
            if b in self.near.get(a, ()):
                for pair in self.join(a, b) if cost(a, b) == tuple(was) else [(a, b)]:
                    heapq.heappush(heap, (*cost(*pair), *pair))


def find_rooms(
    grid: Grid, cells: Indices, edges: Edges, kappa: float, share: float, run: Array, least: float
) -> tuple[Indices, list[str]]:
    """The room of each square, -1 for none, and what made each room, in words.

    `run` are the narrowest doorway, and the opening that joins rooms, metres.
    """
    part = Partition(grid, cells, edges, run[0])

    def openness(a: int, b: int) -> tuple[float, float]:
        openings = part.opening(a, b, doors=False)
        metres = sum(openings.values())
        shared = metres / (part.near[a][b][WHOLE] * grid.side)
        joins = bool(openings) and (shared >= share or max(openings.values()) >= run[1])
        return (-metres, -shared) if joins else (np.inf, 0.0)

    def narrowness(a: int, b: int) -> tuple[float, float]:
        openings = part.opening(a, b, doors=True)
        if not openings:
            return (np.inf, 0.0)
        door = edges.runs[max(openings, key=lambda run: openings[run])]
        wide, (low, high) = door.high - door.low, sorted((part.width(a), part.width(b)))
        if door.mouth:
            length = min(part.area[a], part.area[b]) / wide
            low = min(low, min(high, length) / CORRIDOR_TIMES)
        return (low / wide, 0.0) if low < kappa * wide else (np.inf, 0.0)

    def smallness(a: int, b: int) -> tuple[float, float]:
        size, border = min(part.area[a], part.area[b]), part.near[a][b]
        runs = [k for k in border if k >= 0 and (size < LEAST_HOLE_M2 or not edges.runs[k].door)]
        wide = sum(border[k] for k in runs)
        return (float(size), -wide) if size < least and wide else (np.inf, 0.0)

    part.merge(openness)
    part.merge(narrowness)
    part.merge(smallness)
    number, notes = np.full(len(part.boxes) + 1, -1), list[str]()
    for room in [k for k in part.near if part.area[k] >= LEAST_HOLE_M2 and not part.is_glimpse(k)]:
        number[part.members[room]] = len(notes)
        what = "cells between lines of walls, joined where open or by a doorway too wide for both"
        notes.append(f"{len(part.members[room])} {what}; a circle of {part.width(room):.2f} m fits")
    return number[cells], notes
