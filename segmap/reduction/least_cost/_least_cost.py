"""Least cost, a method of our own: merge in the order of what a merge costs under quality."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...arrays import Array, Metres, Segments, checked
from ...kernels import describe
from ...progress import announce, parts
from ...segments import length
from .._index import by_cell, empty_index
from .._runner import Length, Reduction, Rows, Turn, run_offline
from ._exchange import exchanged
from ._fit_kernels import Limits, empty_workspace, segment_sums
from ._merge_kernels import State, estimate_all, merge_some, nearest_neighbours

#: Neighbours of each input that may merge with it.
NEIGHBOURS = 8
#: What a metre missed or invented costs, in metres of summed distance. At 0.1, one or two segments
#: of a hundred fewer remain, but at low quality more is invented than by Fusion (chapter 21).
PRICE = 0.25
#: Clusters whose merges are sought together, at least: their groups stand side by side in memory.
GROUPED = 256
#: Two segments at a distance d across cost together about this share of d.
ACROSS_COST_SHARE = 0.3


@checked
def least_cost(
    map: Segments,
    *,
    penalty: Metres = 0.05,
    distance: Metres = 0.05,
    angle: Turn = np.radians(5),
    gap: Length = 0.05,
) -> Reduction:
    """Merge clusters of segments in the order of what a merge costs under quality; ours, off-line.

    Quality (A 6.2.2) charges each segment of the map its distance from the nearest one after. What
    it does not see has a price here: metres that an output invents, and metres of the map that lie
    beside no output. First, clusters merge, the cheapest pair first, each new segment drawn where
    it costs least, until every further merge costs more than `penalty`. Then each segment goes to
    the output where it costs least: outputs are drawn anew for their members, close where these
    lose less than the penalty elsewhere, and give way to a segment of the map, while the sum of
    costs and penalties falls.

    So `quality(map, result) >= exp(-penalty * (n - m) / n / 0.05)` for n segments with a length
    before and m after. Every segment comes within twice the distance of its output, but it may end
    farther off, and beyond its ends.

    Parameters
    ----------
    penalty
        What one segment fewer may cost; from 0.008 to 0.3 the map stays near what was seen. For a
        floor plan, one segment a wall, 0.5 to 1.6: the more, the more the poses err. A metre
        invented costs 0.25, one missed 0.25 in the first phase and 0.075 in the second; more where
        the penalty is above 10 and 3 times the distance.
    distance, angle
        A segment whose end lies farther off the line of its output, or that is turned by more,
        counts as missed.
    gap
        Gaps up to this are bridged at no cost; across longer ones clusters never merge. Segments
        farther apart than twice the distance are not tried, so that more hardly changes a map.

    Returns
    -------
    Reduction
        In the order of the first segment of each output.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(1, 0.01), (3, 0.01)], [(0, 1), (2, 1)]]
    >>> least_cost(wall).parents
    array([0, 0, 1])
    """
    price = max(PRICE, penalty / distance / 40)
    limits = Limits(penalty, price, price, distance, float(np.sin(angle)), gap)
    return run_offline(
        "least_cost", map, lambda rows: exchanged(rows, merged_greedily(rows, limits), limits)
    )


def merged_greedily(rows: Rows, limits: Limits) -> Array:
    """The first phase: the outputs, each where its first segment stands.

    No merge reaches beyond a group of segments that pairs tie together. So a few groups are merged
    after the other, and what belongs together stands together in memory.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    # step 1: pairs that may merge
    n, unit = len(rows.segments), length(rows.segments).mean() if len(rows.segments) else 0.0
    reach = min(max(limits.penalty / ACROSS_COST_SHARE, limits.gap), 2 * limits.distance)
    who, least = np.full((n, NEIGHBOURS), -1), np.full((n, NEIGHBOURS), np.inf)
    places, room = empty_index(n, max(2 * reach, unit)), np.empty(n + 1, np.int64)
    place = by_cell(rows.segments, max(2 * reach, unit))
    s = rows.segments[place]
    d = describe(s)
    for part in parts(np.arange(n), "least cost: looking around segment"):
        nearest_neighbours(s, d, reach, part, places, room, least, who)
    i, k = np.nonzero(who >= 0)
    i, j = place[i], place[who[i, k]]
    ties = coo_array((np.ones(len(i)), (i, j)), shape=(n, n))
    label = connected_components(ties, directed=False)[1]
    # step 2: every segment is a cluster
    own, order = np.arange(n), np.argsort(label, kind="stable")
    place = np.argsort(order)
    pairs = np.sort(n * np.minimum(place[i], place[j]) + np.maximum(place[i], place[j]))
    low, high = np.divmod(pairs[np.diff(pairs, prepend=-1) > 0], n)
    near = np.column_stack([high, low]).ravel()
    s = rows.segments[order]
    d = describe(s)
    state = State(
        s=s,
        d=d,
        drawn=s.copy(),
        sums=np.column_stack([segment_sums(d), np.zeros(n)]),
        link=np.column_stack([own, 0 * own + 1, own, own, 0 * own - 1]),
        after=np.full(n, -1),
        near=np.column_stack([near, 0 * near]),
        key=np.empty(len(low)),
        exact=np.zeros(len(low), np.int64),
        mark=np.full(n, -1),
        cheapest=np.full(n, -1),
        cost=np.full(n, np.inf),
    )
    fitting = empty_workspace(n)
    for part in parts(np.arange(len(low)), "least cost: estimating merges of pair"):
        estimate_all(state, fitting, part, limits)
    first = np.flatnonzero(np.diff(label[order], prepend=-1, append=n))
    for begin, end in pairwise(first[np.searchsorted(first, [*range(0, n, GROUPED), n])].tolist()):
        while not merge_some(state, fitting, begin, end, limits):
            announce(begin / n, f"least cost: merging {n} segments")
        announce(end / n, f"least cost: merging {n} segments")
    return state.drawn[place[state.link[place, 0] == place]]
