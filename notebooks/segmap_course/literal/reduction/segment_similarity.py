"""Segment similarity clustering (A 2.7.7; Elseberg, Creed, Lakaemper 2010): cheapest first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..lines import SAME, Segment, extreme_projections, segment_length
from ..metrics import mean_lines, segment_distance

#: Costs are compared in steps of so many metres: rounding must not choose.
STEP = 1e-12


def mean_segment(u: Segment, v: Segment, weight_u: float, weight_v: float) -> Segment:
    """Span of two segments on their mean line; of two such lines the cheaper, or the first."""
    first, *others = mean_lines(u, v, weight_u, weight_v)
    cheaper = [line for cost, line in others if cost < first[0] - STEP]
    return extreme_projections((*u, *v), (cheaper or [first[1]])[0])


def segment_similarity(
    segments: Sequence[Segment], *, distance: float = 0.03
) -> tuple[list[Segment], list[int]]:
    """While two segments cost less than `distance`, the cheapest two become their mean segment."""
    map = {i: s for i, s in enumerate(segments) if segment_length(s) >= SAME}
    weights, into = dict.fromkeys(map, 1), {i: i for i in map}
    costs: dict[tuple[int, int], float] = {}

    def compare(i: int, others: Iterable[int]) -> None:
        """Note what i costs with each of the others, if it is little."""
        for a, b in (sorted((i, k)) for k in others):
            cost = segment_distance(map[a], map[b], weights[a], weights[b])
            if cost < distance:
                costs[a, b] = cost

    for i in map:
        compare(i, (k for k in map if k > i))
    while costs:
        i, j = min(costs, key=lambda pair: (round(costs[pair] / STEP), pair))
        map[i] = mean_segment(map[i], map[j], weights[i], weights[j])
        weights[i] += weights[j]
        del map[j]
        into = {k: i if root == j else root for k, root in into.items()}
        costs = {pair: cost for pair, cost in costs.items() if not {i, j} & {*pair}}
        compare(i, map.keys() - {i})
    order = list(map)
    parents = [order.index(into[k]) if k in into else -1 for k in range(len(segments))]
    return list(map.values()), parents
