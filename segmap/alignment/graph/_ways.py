"""Shortest ways through a pose graph: along the steps, and across by the loops."""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heappop, heappush

import numpy as np

from ...arrays import Array
from ._equations import Indices


class Ways:
    """Ways between key frames, kept ready while loops are added; each search stays near its start.

    A loop costs `across`, metres, whatever lies between its ends.
    """

    def __init__(self, across: float) -> None:
        self.across = across
        self.linked: dict[int, list[int]] = {}
        self.count, self.last = 0, (-1, -1)  # how many loops are linked, and the last of them

    def between(
        self,
        start: int,
        wanted: Indices,
        path: Sequence[float],
        loops: Sequence[tuple[int, int]],
        most: float = np.inf,
    ) -> Array:
        """Shortest ways from one key frame to others (Dijkstra 1959), `(len(wanted),)`, metres.

        `path` is the path length to each key frame; `loops` are pairs of them, of which the list
        only grows, but for what an interrupt undoes. Ways longer than `most` are infinite.
        """
        if self.count > len(loops) or not (self.count and loops[self.count - 1] is self.last):
            self.linked, self.count = {}, 0  # an interrupt has undone some: all anew
        fresh, self.last = loops[self.count :], (-1, -1)  # nothing counts until all is in
        for first, second in fresh:
            self.linked.setdefault(first, []).append(second)
            self.linked.setdefault(second, []).append(first)
        if loops:
            self.count, self.last = len(loops), loops[-1]
        left, best, end = set(wanted.tolist()), {start: 0.0}, len(path) - 1
        done, heap = dict.fromkeys(left, np.inf), [(0.0, start)]
        while heap and left:
            way, at = heappop(heap)
            if way > best[at]:
                continue
            if way > most:
                break
            if at in left:
                left.remove(at)
                done[at] = way
            ahead = [(k, way + self.across) for k in self.linked.get(at, ())]
            if at > 0:
                ahead.append((at - 1, way + (path[at] - path[at - 1])))
            if at < end:
                ahead.append((at + 1, way + (path[at + 1] - path[at])))
            for k, far in ahead:
                if far < best.get(k, np.inf):
                    best[k] = far
                    heappush(heap, (far, k))
        return np.array([done[k] for k in wanted.tolist()])
