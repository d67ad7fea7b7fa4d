"""Least cost, a method of our own: merge in the order of what a merge costs under quality."""

from __future__ import annotations

import numpy as np

from ... import arrays
from ...arrays import Array, Segments
from ...kernels import describe
from ...metrics import quality as measured
from .._runner import Found, Reduction, run
from . import _kernels as kernels
from ._fit_kernels import Indices, Limits, Room

#: Neighbours of each input that may merge with it.
NEIGHBOURS = 8
#: What a metre missed or invented costs, in metres of summed distance. At 0.1, one or two segments
#: of a hundred fewer remain, but at low quality more is invented than by Fusion (chapter 58).
PRICE = 0.25
#: A segment has at most about so many samples, on average, that its neighbours are found by: cells
#: are as large as that takes, or a wall of a kilometre would fill the memory.
SAMPLES = 64
#: Two segments at a distance d across cost together about this share of d.
SHARE = 0.3
#: Least and largest penalty that `reduce_to` tries, metres.
PENALTIES = 1e-4, 4.0


def least_cost(
    map: Segments,
    *,
    penalty: float = 0.05,
    distance: float = 0.05,
    angle: float = np.radians(5),
    gap: float = 0.05,
) -> Reduction:
    """Merge clusters of segments in the order of what a merge costs under quality; ours, off-line.

    Quality (A 6.2.2) charges each segment of the map its distance from the nearest one after. A
    cluster costs the sum of these distances, and a price for what quality does not see: metres that
    its segment invents, and metres of its members that lie too far off it. The cheapest pair of
    clusters merges first, each new segment is drawn where it costs least, until every further merge
    costs more than `penalty`.

    So `quality(map, result) >= exp(-penalty * (n - m) / n / 0.05)` for n segments before and m
    after. Every segment lies within twice the distance of the line of its output, and inside its
    span.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
    penalty : float, metres
        What one segment fewer may cost; useful from 0.008 to 0.3. A metre missed or invented costs
        0.25, and more where the penalty is above 10 times the distance.
    distance : float, metres
        A segment whose end lies farther off the line of its output counts as missed.
    angle : float, radians
        So does one that is turned by more.
    gap : float, metres
        Gaps up to this are bridged at no cost; across longer ones clusters never merge. Segments
        farther apart than twice the distance are not tried, so that more hardly changes a map.

    Returns
    -------
    Reduction
        In the order of the first segment of each cluster.

    Raises
    ------
    ValueError
        For a threshold that is not positive, coordinates that are not finite.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(1, 0.01), (3, 0.01)], [(0, 1), (2, 1)]]
    >>> least_cost(wall).parents
    array([0, 0, 1])
    """
    arrays.positive("metres", penalty=penalty, distance=distance)
    arrays.number(angle, "angle", above=0, most=np.pi / 2, unit="radians")
    arrays.number(gap, "gap", least=0, unit="metres")
    price = max(PRICE, penalty / distance / 40)
    limits = Limits(float(penalty), price, float(distance), float(np.sin(angle)), float(gap))
    return run("least_cost", map, lambda rows: _reduce(rows.segments, limits))


def reduce_to(map: Segments, *, quality: float = 0.85) -> Reduction:
    """The smallest map by `least_cost` that keeps a quality: the penalty is found by bisection.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
    quality : float
        The least `metrics.quality(map, result)`, above 0 and below 1.

    Returns
    -------
    Reduction
        Where even the least penalty that is tried, 0.1 mm, falls below the quality, it is of that.

    Raises
    ------
    ValueError
        For a quality that is not between 0 and 1, coordinates that are not finite.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(1, 0.01), (3, 0.01)], [(0, 1), (2, 1)]]
    >>> reduce_to(wall, quality=0.9)
    Reduction(least_cost: 3 -> 2 segments)
    """
    arrays.number(quality, "quality", above=0, below=1)
    low, high = np.log(PENALTIES)
    best = least_cost(map, penalty=float(np.exp(low)))
    for _ in range(12):  # the share of the penalty that is left open: 0.3 %
        middle = (low + high) / 2
        found = least_cost(map, penalty=float(np.exp(middle)))
        if measured(map, found) >= quality:
            best, low = found, middle
        else:
            high = middle
    return best


def _reduce(s: Array, limits: Limits) -> Found:
    """Outputs, and the output of each segment."""
    state, n = _singles(s), len(s)
    reach = min(max(limits.penalty / SHARE, limits.gap), 2 * limits.distance)
    state = _linked(state, _neighbours(state, reach))
    room = Room(
        np.empty(n, np.int64), *(np.empty(k) for k in ((n, 4), (n, 5), (n, 2), (2, 2), 5, 6))
    )
    kernels.merge_all(state, room, limits)
    roots = state.link[:, 0]
    while (roots != roots[roots]).any():
        roots = roots[roots]
    live, parents = np.unique(roots, return_inverse=True)
    return state.drawn[live], parents


def _singles(s: Array) -> kernels.State:
    """Every segment as a cluster of its own, without neighbours."""
    n, d = len(s), describe(s)
    own, whole = np.arange(n), 2 * d[:, 4]
    x, y = d[:, 2], d[:, 3]
    sums = np.column_stack(
        [whole, d[:, :2], *(whole**3 / 12 * p for p in (x * x, x * y, y * y)), 0 * whole]
    )
    link = np.column_stack([own, 0 * own, 0 * own + 1, own, own, 0 * own - 1])
    none = np.full(n, -1)
    return kernels.State(
        s,
        d,
        s.copy(),
        sums,
        link,
        none,
        np.empty((0, 2), np.int64),
        none.copy(),
        np.full((n, 3), -1),
        np.empty((n, 5)),
    )


def _neighbours(state: kernels.State, reach: float) -> Indices:
    """Pairs that may merge, `(p, 2)`, both ways, ascending: those nearest to one of them."""
    half = state.d[:, 4]
    cell = max(2 * reach, 4 * half.sum() / (SAMPLES * max(len(half), 1)))
    steps = np.maximum(np.ceil(4 * half / cell), 1).astype(np.int64)
    slots = 1 << int(np.ceil(np.log2(max(4 * len(half), 16))))
    begin = np.zeros(slots + 1, np.int64)
    kernels.fill(state.s, steps, cell, begin, np.empty(0, np.int64))
    begin = np.cumsum(begin)
    held = np.empty(begin[-1], np.int64)
    kernels.fill(state.s, steps, cell, begin, held)
    who = np.full((len(half), NEIGHBOURS), -1)
    kernels.nearest_neighbours(state, np.array([cell, reach]), steps, begin, held, who)
    i, k = np.nonzero(who >= 0)
    pairs = np.column_stack([i, who[i, k]])
    return np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)


def _linked(state: kernels.State, pairs: Indices) -> kernels.State:
    """The same clusters with a list of neighbours each."""
    near = np.column_stack([pairs[:, 1], np.arange(1, len(pairs) + 1)])
    first = np.searchsorted(pairs[:, 0], np.arange(len(state.s) + 1))
    some = first[1:] > first[:-1]
    near[first[1:][some] - 1, 1] = -1
    state.link[some, 5] = first[:-1][some]
    return state._replace(near=near)
