"""Rectangles along the axes that merge, the most precise first (A 2.7.4); compiled when called."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from .._boxes import Boxes, enter, leave, meeting
from .._runner import Indices


class State(NamedTuple):
    """Rectangles, first the inputs, then those that merges make.

    Parameters
    ----------
    data : (2 n, 4) array, metres
        Across, low, high, error.
    key : (2 n, 2) int array
        Error in nanometres and lowest input: the smaller is the more precise.
    upright : (2 n,) int array
    boxes : Boxes
        Of the live ones, in the frame of the axes.
    heap : (2 n,) int array
        Those that may have a partner, the most precise first.
    queued : (2 n,) int array
        1 for those in the heap.
    near : (2 n,) int array
        Room for those that are near.
    into : (2 n,) int array
        What each was merged into, -1 for the live ones.
    """

    data: Array
    key: Indices
    upright: Indices
    boxes: Boxes
    heap: Indices
    queued: Indices
    near: Indices
    into: Indices


@compiled
def roots(into: Indices, root: Indices) -> None:
    """The live rectangle that each of all went into."""
    for r in range(len(root) - 1, -1, -1):
        root[r] = r if into[r] < 0 else root[into[r]]


@compiled
def _before(key: Indices, a: int, b: int) -> bool:
    """Whether a comes before b in the order of precision."""
    return key[a, 0] < key[b, 0] or (key[a, 0] == key[b, 0] and key[a, 1] < key[b, 1])


@compiled
def _push(state: State, count: int, r: int) -> int:
    """Put a rectangle into the heap, unless it is there; how many it holds then."""
    heap, key = state.heap, state.key
    if state.queued[r] == 1:
        return count
    state.queued[r] = 1
    k = count
    while k > 0 and _before(key, r, heap[(k - 1) // 2]):
        heap[k] = heap[(k - 1) // 2]
        k = (k - 1) // 2
    heap[k] = r
    return count + 1


@compiled
def _pop(state: State, count: int) -> int:
    """Take the first out of a heap of so many and return it."""
    heap, key, first = state.heap, state.key, state.heap[0]
    last, k, child = heap[count - 1], 0, 1
    while child < count - 1:
        if child + 1 < count - 1 and _before(key, heap[child + 1], heap[child]):
            child += 1
        if not _before(key, heap[child], last):
            break
        heap[k] = heap[child]
        k, child = child, 2 * child + 1
    heap[k] = last
    state.queued[first] = 0
    return first


@compiled
def _enter(state: State, r: int) -> None:
    """Put a rectangle into the index of boxes."""
    boxes, up, d = state.boxes, state.upright[r], state.data
    boxes.low[r, up], boxes.high[r, up] = d[r, 1], d[r, 2]
    boxes.low[r, 1 - up], boxes.high[r, 1 - up] = d[r, 0], d[r, 0]
    enter(boxes, r)


@compiled
def _look(state: State, f: int, limits: Array) -> int:
    """Write those near rectangle f, without itself, to the front of `near`; how many there are."""
    up, d, near = state.upright[f], state.data, state.near
    wide, tall = (limits[0], limits[1]) if up == 1 else (limits[1], limits[0])
    box = state.boxes
    x0, y0 = box.low[f, 0] - wide, box.low[f, 1] - tall
    found = meeting(box, x0, y0, box.high[f, 0] + wide, box.high[f, 1] + tall, near)
    count = 0
    for k in range(found):
        g = near[k]
        if g == f or state.upright[g] != up:
            continue
        dx, dy = abs(d[f, 0] - d[g, 0]), max(d[f, 1], d[g, 1]) - min(d[f, 2], d[g, 2])
        if dx < limits[0] and dy < limits[1]:
            near[count] = g
            count += 1
    return count


@compiled
def _nearest(state: State, f: int, count: int) -> int:
    """The nearest of those found near f, to a nanometre; ties: the most precise; -1 for none."""
    d, best, least = state.data, -1, 0
    for k in range(count):
        g = state.near[k]
        dx, dy = abs(d[f, 0] - d[g, 0]), max(d[f, 1], d[g, 1]) - min(d[f, 2], d[g, 2])
        apart = int(np.floor((dx + max(0.0, dy)) / 2 * 1e9 + 0.5))
        if best < 0 or apart < least or (apart == least and _before(state.key, g, best)):
            best, least = g, apart
    return best


@compiled
def merge_all(state: State, n: int, limits: Array) -> int:
    """Steps 4 and 5 for the first n rectangles; how many there ever were.

    One without a partner waits until a merge brings a rectangle near to it: nothing else can.
    """
    d, key, last, count = state.data, state.key, n, 0
    for r in range(n):
        _enter(state, r)
        count = _push(state, count, r)
    while count > 0:
        f = _pop(state, count)
        count -= 1
        if state.into[f] >= 0:
            continue
        g = _nearest(state, f, _look(state, f, limits))
        if g < 0:
            continue
        r, last = last, last + 1
        across = (d[f, 0] / d[f, 3] + d[g, 0] / d[g, 3]) / (1 / d[f, 3] + 1 / d[g, 3])
        d[r, 0], d[r, 1], d[r, 2] = across, min(d[f, 1], d[g, 1]), max(d[f, 2], d[g, 2])
        d[r, 3] = max(min(d[f, 3], d[g, 3]), abs(across - d[f, 0]), abs(across - d[g, 0]))
        key[r, 0], key[r, 1] = int(np.floor(d[r, 3] * 1e9 + 0.5)), min(key[f, 1], key[g, 1])
        state.upright[r] = state.upright[f]
        state.into[f] = state.into[g] = r
        leave(state.boxes, f)
        leave(state.boxes, g)
        _enter(state, r)
        count = _push(state, count, r)
        for k in range(_look(state, r, limits)):
            count = _push(state, count, state.near[k])
    return last
