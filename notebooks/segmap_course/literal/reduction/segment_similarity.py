"""Segment similarity clustering (A 2.7.7; Elseberg, Creed, Lakaemper 2010): cheapest first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..lines import SAME, Segment, segment_length, spanning
from ..metrics import line_cost, mean_directions, mean_middle, segment_distance

#: Costs are compared in steps of so many metres: rounding must not choose.
STEP = 1e-12


def mean_segment(u: Segment, v: Segment, weight_u: float, weight_v: float) -> Segment:
    """Span of two segments on their mean line; of two such lines the cheaper, or the first."""
    share = weight_v / (weight_u + weight_v)
    x, y = mean_middle(u, v, share)
    directions = mean_directions(u, v, share)
    cheapest = min(directions, key=lambda at: round(line_cost(u, v, at, share) / STEP))
    return spanning(x, y, cheapest, (*u, *v))


def costs_with(
    i: int, live: Mapping[int, Segment], weights: Mapping[int, int], distance: float
) -> dict[tuple[int, int], float]:
    """What a segment costs with each other one, by both their numbers, if less than `distance`."""
    pairs = [(min(i, k), max(i, k)) for k in live if k != i]
    costs = {(a, b): segment_distance(live[a], live[b], weights[a], weights[b]) for a, b in pairs}
    return {pair: cost for pair, cost in costs.items() if cost < distance}


def segment_similarity(
    segments: Sequence[Segment], *, distance: float = 0.03
) -> tuple[list[Segment], list[int]]:
    """While two segments cost less than `distance`, the cheapest two become their mean segment."""
    live = {i: s for i, s in enumerate(segments) if segment_length(s) >= SAME}
    weights, into = dict.fromkeys(live, 1), {i: i for i in live}
    costs = {p: c for i in live for p, c in costs_with(i, live, weights, distance).items()}
    while costs:
        i, j = min(costs, key=lambda pair: (round(costs[pair] / STEP), pair))
        live[i] = mean_segment(live[i], live.pop(j), weights[i], weights[j])
        weights[i] += weights[j]
        into = {k: i if root == j else root for k, root in into.items()}
        costs = {pair: cost for pair, cost in costs.items() if not {i, j} & {*pair}}
        costs |= costs_with(i, live, weights, distance)
    order = list(live)
    parents = [order.index(into[k]) if k in into else -1 for k in range(len(segments))]
    return list(live.values()), parents
