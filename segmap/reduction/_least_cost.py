"""Least cost, a method of our own: merge in the order of what a merge costs under quality."""

from __future__ import annotations

import numpy as np

from .. import arrays
from ..arrays import Array, Segments
from ..kernels import describe
from . import _least_cost_loops as loops
from ._least_cost_fit import Indices, Limits, Room
from ._runner import Found, Reduction, run

#: Neighbours of each input that may merge with it.
NEIGHBOURS = 8
#: Two segments at a distance d across cost together about this share of d.
SHARE = 0.3


def least_cost(
    map: Segments,
    *,
    penalty: float = 0.05,
    distance: float = 0.05,
    angle: float = np.radians(5),
    gap: float = 0.05,
) -> Reduction:
    """Merge clusters of segments in the order of what a merge costs, the cheapest first.

    x"""
    arrays.positive("metres", penalty=penalty, distance=distance)
    arrays.number(angle, "angle", above=0, most=np.pi / 2, unit="radians")
    arrays.number(gap, "gap", least=0, unit="metres")
    price = max(0.1, penalty / 2)
    limits = Limits(float(penalty), price, float(distance), float(np.sin(angle)), float(gap))
    return run("least_cost", map, lambda rows: _reduce(rows.segments, limits))


def _reduce(s: Array, limits: Limits) -> Found:
    """Outputs, and the output of each segment."""
    state, n = _singles(s), len(s)
    reach = min(max(limits.penalty / SHARE, limits.gap), 2 * limits.distance)
    state = _linked(state, _neighbours(state, reach))
    room = Room(np.empty(n, np.int64), *(np.empty(k) for k in ((n, 4), (n, 5), (n, 2), (2, 2), 5, 6)))
    loops.merge_all(state, room, limits)
    roots = state.link[:, 0]
    while (roots != roots[roots]).any():
        roots = roots[roots]
    live, parents = np.unique(roots, return_inverse=True)
    return state.drawn[live], parents


def _singles(s: Array) -> loops.State:
    """Every segment as a cluster of its own, without neighbours."""
    n, d = len(s), describe(s)
    own, whole = np.arange(n), 2 * d[:, 4]
    x, y = d[:, 2], d[:, 3]
    sums = np.column_stack([whole, d[:, :2], *(whole**3 / 12 * p for p in (x * x, x * y, y * y)), 0 * whole])
    link = np.column_stack([own, 0 * own, 0 * own + 1, own, own, 0 * own - 1])
    none = np.full(n, -1)
    return loops.State(s, d, s.copy(), sums, link, none, np.empty((0, 2), np.int64), none.copy(), np.full((n, 3), -1), np.empty((n, 5)))


def _neighbours(state: loops.State, reach: float) -> Indices:
    """Pairs that may merge, `(p, 2)`, both ways, ascending: those nearest to one of them."""
    cell, half = 2 * reach, state.d[:, 4]
    steps = np.maximum(np.ceil(4 * half / cell), 1).astype(np.int64)
    slots = 1 << int(np.ceil(np.log2(max(4 * len(half), 16))))
    begin = np.zeros(slots + 1, np.int64)
    loops.fill(state.s, steps, cell, begin, np.empty(0, np.int64))
    begin = np.cumsum(begin)
    held = np.empty(begin[-1], np.int64)
    loops.fill(state.s, steps, cell, begin, held)
    who = np.full((len(half), NEIGHBOURS), -1)
    loops.nearest_neighbours(state, steps, begin, held, reach, who)
    i, k = np.nonzero(who >= 0)
    pairs = np.column_stack([i, who[i, k]])
    return np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)


def _linked(state: loops.State, pairs: Indices) -> loops.State:
    """The same clusters with a list of neighbours each."""
    near = np.column_stack([pairs[:, 1], np.arange(1, len(pairs) + 1)])
    first = np.searchsorted(pairs[:, 0], np.arange(len(state.s) + 1))
    some = first[1:] > first[:-1]
    near[first[1:][some] - 1, 1] = -1
    state.link[some, 5] = first[:-1][some]
    return state._replace(near=near)
