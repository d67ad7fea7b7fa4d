"""The loops of fuzzy clustering: points become clusters, and clusters walls; metres."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from ...kernels import gap_along, join_sums, lay, length_of, span, turn_between
from .._runner import Indices

#: Lengths and memberships closer than this are equal.
SAME = 1e-9


class State(NamedTuple):
    """n clusters, by scan and cell, and behind them as many rows for the walls of the buffer."""

    sums: Array  # (2 n, 6) running sums
    ends: Array  # (2 n, 2, 2), metres
    theta: Array  # (2 n,) direction, radians
    into: Indices  # (2 n,) the cluster or wall that each is in, -1 for itself
    first: Indices  # (k + 1,) where the clusters of each cell begin in `slot`
    held: Indices  # (k,) how many of them are not absorbed
    slot: Indices  # (n,)
    near: Indices  # (n,) room for the walls around one
    nine: Indices  # (k, 9) each cell and its neighbours, -1 for none
    updated: Indices  # (k,) 1 for cells with new clusters
    used: Indices  # (2,) clusters and walls that are a segment of the map; walls that ever were


@compiled
def _memberships(x: Array, q: Array, k: int, noise: float, u: Array) -> float:
    """Step 2: write the share of each point that belongs to each prototype, and their squares.

    The largest change of a share. Row 0 of `u` is room; the sums of squares go into column 5.
    """
    most = 0.0
    for j in range(k):
        q[j, 5] = 0.0
    for i in range(len(x)):
        total = 0.0
        for j in range(k):
            dx, dy = x[i, 0] - q[j, 0], x[i, 1] - q[j, 1]
            along = dx * q[j, 2] + dy * q[j, 3]
            u[0, j] = 1 / max(dx * dx + dy * dy - q[j, 4] * along * along, 1e-12)
            total += u[0, j]
        total += 1 / (noise * noise)
        for j in range(k):
            share = u[0, j] / total
            most = max(most, abs(share - u[i + 1, j]))
            u[i + 1, j] = share
            q[j, 5] += share * share
    return most


@compiled
def _settle(x: Array, q: Array, k: int, noise: float, u: Array) -> int:
    """Step 2: move k prototypes until no membership changes; how many are left."""
    known = False
    for _ in range(100):
        change, kept = _memberships(x, q, k, noise, u), 0
        for j in range(k):
            if q[j, 5] >= 2.0:
                for d in range(6):
                    q[kept, d] = q[j, d]
                kept += 1
        if kept == k and known and change < 1e-6:
            break
        known = kept == k
        k = kept
        for j in range(k if known else 0):  # each becomes the prototype of its points
            mx = my = xx = xy = yy = 0.0
            for i in range(len(x)):
                w = u[i + 1, j] * u[i + 1, j] / q[j, 5]
                mx, my = mx + w * x[i, 0], my + w * x[i, 1]
            for i in range(len(x)):
                w, dx, dy = u[i + 1, j] * u[i + 1, j], x[i, 0] - mx, x[i, 1] - my
                xx, xy, yy = xx + w * dx * dx, xy + w * dx * dy, yy + w * dy * dy
            spread = np.hypot(xx - yy, 2 * xy)
            q[j, 0], q[j, 1] = mx, my
            if xx + yy + spread > 0.0:
                theta = 0.5 * np.arctan2(2 * xy, xx - yy)
                q[j, 2], q[j, 3] = np.cos(theta), np.sin(theta)
                q[j, 4] = 1 - max(xx + yy - spread, 0.0) / (xx + yy + spread)
    return k


@compiled
def cluster(
    points: Array,
    first: Indices,
    pieces: Array,
    begin: Indices,
    noise: float,
    u: Array,
    label: Indices,
    state: State,
) -> None:
    """Steps 2 and 3: points of each scan in each cell become clusters, numbered by their pieces.

    Points and pieces of batch b begin at `first[b]` and `begin[b]`; `u` is room for memberships.
    """
    for b in range(len(first) - 1):
        lo, c, sums = first[b], begin[b], state.sums
        x, q = points[lo : first[b + 1]], pieces[c : begin[b + 1]]
        k = _settle(x, q, len(q), noise, u)
        _memberships(x, q, k, noise, u)
        for i in range(len(x)):
            most = total = 0.0
            for j in range(k):
                most, total = max(most, u[i + 1, j]), total + u[i + 1, j]
            label[lo + i] = -1
            for j in range(k - 1 if 1 - total <= most + SAME else -1, -1, -1):
                if u[i + 1, j] >= most - SAME:
                    label[lo + i] = c + j
            if label[lo + i] >= 0:
                one = sums[label[lo + i]]
                one[0] += 1
                dx, dy, part = x[i, 0] - one[1], x[i, 1] - one[2], (one[0] - 1) / one[0]
                one[1], one[2] = one[1] + dx / one[0], one[2] + dy / one[0]
                one[3], one[4] = one[3] + part * dx * dx, one[4] + part * dx * dy
                one[5] += part * dy * dy
        for j in range(c, c + k):
            state.theta[j] = 0.5 * np.arctan2(2 * sums[j, 4], sums[j, 3] - sums[j, 5])
            cos, sin, low, high = np.cos(state.theta[j]), np.sin(state.theta[j]), np.inf, -np.inf
            for i in range(len(x)):
                if label[lo + i] == j:
                    along = (x[i, 0] - sums[j, 1]) * cos + (x[i, 1] - sums[j, 2]) * sin
                    low, high = min(low, along), max(high, along)
            lay(state.ends[j], sums[j, 1], sums[j, 2], cos, sin, low, high)


@compiled
def _alike(s: State, a: int, b: int, limits: Array) -> bool:
    """Step 4: parallel, on one line, and near each other."""
    ends, theta = s.ends, s.theta
    turn = turn_between(theta[b], theta[a])
    if abs(turn) >= limits[0]:
        return False
    for i, j in ((a, b), (b, a)):
        x = (ends[i, 0, 0] + ends[i, 1, 0]) / 2 - s.sums[j, 1]
        y = (ends[i, 0, 1] + ends[i, 1, 1]) / 2 - s.sums[j, 2]
        if abs(y * np.cos(theta[j]) - x * np.sin(theta[j])) >= limits[1]:
            return False
    cos, sin = np.cos(theta[b] + turn / 2), np.sin(theta[b] + turn / 2)
    return gap_along(ends[a], ends[b], cos, sin) <= limits[2] + SAME


@compiled
def _absorb(s: State, a: int, b: int) -> None:
    """Sums add; the line of the sums spans what both did."""
    join_sums(s.sums[a], s.sums[b], s.sums[a])
    x, y = s.sums[a, 1], s.sums[a, 2]
    s.theta[a] = 0.5 * np.arctan2(2 * s.sums[a, 4], s.sums[a, 3] - s.sums[a, 5])
    cos, sin = np.cos(s.theta[a]), np.sin(s.theta[a])
    (low, high), (begin, end) = span(s.ends[a], x, y, cos, sin), span(s.ends[b], x, y, cos, sin)
    lay(s.ends[a], x, y, cos, sin, min(low, begin), max(high, end))


@compiled
def _root(into: Indices, i: int) -> int:
    """What a cluster or wall is in by now."""
    while into[i] >= 0:
        i = into[i]
    return i


@compiled
def _group(s: State, items: Indices, count: int, limits: Array) -> int:
    """Step 4: each item absorbs those after it that are alike, until none is; how many stay."""
    more = True
    while more:
        more, kept = False, 0
        for a in range(count):
            i = items[a]
            for b in range(a + 1 if i >= 0 else count, count):
                j = items[b]
                if j < 0 or not _alike(s, i, j, limits):
                    continue
                mine, its = _root(s.into, i), _root(s.into, j)
                _absorb(s, i, j)
                s.into[j], items[b], more = i, -1, True
                if mine != i and mine != its:
                    _absorb(s, mine, its)
                    s.into[its] = mine
                if mine != its:
                    s.used[0] -= 1
            if i >= 0:
                items[kept] = i
                kept += 1
        count = kept
    return count


@compiled
def add_scan(
    s: State, place: Indices, begin: Indices, first: int, stop: int, least: Array, limits: Array
) -> None:
    """Step 4: the clusters of batches `first` to `stop` enter their cells, which are grouped."""
    for b in range(first, stop):
        cell = place[b]
        items = s.slot[s.first[cell] : s.first[cell + 1]]
        for c in range(begin[b], begin[b + 1]):
            if s.sums[c, 0] >= least[0] and length_of(s.ends[c]) >= least[1]:
                items[s.held[cell]] = c
                s.held[cell] += 1
                s.used[0] += 1
                s.updated[cell] = 1
        s.held[cell] = _group(s, items, s.held[cell], limits)


@compiled
def group_across(s: State, limits: Array) -> None:
    """Step 5: clusters become walls; those of each updated cell and its neighbours are grouped.

    Walls are grouped in the order of their numbers, each once.
    """
    near = s.near
    for cell in range(len(s.updated)):
        for k in range(s.held[cell] if s.updated[cell] else 0):
            c, wall = s.slot[s.first[cell] + k], len(s.slot) + s.used[1]
            if s.into[c] < 0:
                for d in range(6):
                    s.sums[wall, d] = s.sums[c, d]
                for d in range(4):
                    s.ends[wall, d // 2, d % 2] = s.ends[c, d // 2, d % 2]
                s.theta[wall], s.into[c] = s.theta[c], wall
                s.used[1] += 1
    for cell in range(len(s.updated)):
        if not s.updated[cell]:
            continue
        count = 0
        for n in s.nine[cell]:
            for k in range(s.held[n] if n >= 0 else 0):
                wall, at = _root(s.into, s.slot[s.first[n] + k]), count
                while at > 0 and near[at - 1] > wall:
                    at -= 1
                if at == 0 or near[at - 1] != wall:
                    for i in range(count, at, -1):
                        near[i] = near[i - 1]
                    near[at] = wall
                    count += 1
        _group(s, near, count, limits)
        s.updated[cell] = 0
