"""Key frames that are near: by their places, and by the path driven and by loops."""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled

#: A believed loop is so long a part of a way, metres.
LOOP_PATH = 0.5


@compiled
def key_frames_in_square(poses: Array, new: int, half: float, near: NDArray[np.int64]) -> int:
    """Write which poses lie in a square about the new one, half a side in metres; their number."""
    count = 0
    for k in range(len(near)):
        off = max(abs(poses[k, 0] - poses[new, 0]), abs(poses[k, 1] - poses[new, 1]))
        near[count], count = k, count + (off < half)
    return count


@compiled
def path_lengths(
    along: Array,
    ways: NDArray[np.int64],
    begin: int,
    wanted: NDArray[np.int64],
    most: float,
    metres: Array,
) -> None:
    """Write the metres of the shortest ways, up to `most`, to wanted key frames (Dijkstra 1959).

    Before that they are infinite. `along`, (n,), is the path driven; `ways`, (w, 2), join old key
    frames and new ones. Ends when all that are wanted are reached: most often near.
    """
    head, link, left = np.full(len(along), -1), np.empty(2 * len(ways), np.int64), len(wanted)
    asked = np.zeros(len(along), np.bool_)
    for slot in range(2 * len(ways)):
        end = ways[slot // 2, slot % 2]
        if abs(end - ways[slot // 2, 1 - slot % 2]) > 1:
            link[slot], head[end] = head[end], slot
    for k in wanted:
        asked[k] = True
    heap, metres[begin] = [(0.0, begin)], 0.0
    while left and len(heap):
        far, k = heapq.heappop(heap)
        if far > metres[k]:
            continue
        left -= asked[k]
        slot, side = head[k], -1
        while slot >= 0 or side < 2:
            if side < 2:  # the key frames before and after it, then those at ways
                j = min(max(k + side, 0), len(along) - 1)
                step, side = abs(along[j] - along[k]), side + 2
            else:
                j, step, slot = ways[slot // 2, 1 - slot % 2], LOOP_PATH, link[slot]
            if far + step <= most and far + step < metres[j]:
                metres[j] = far + step
                heapq.heappush(heap, (metres[j], j))
