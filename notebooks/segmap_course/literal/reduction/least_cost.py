"""Least cost as one page of plain Python: the yardstick of `reduction.least_cost`.

Clusters of segments merge in the order of what a merge costs: how far each member then is from the
one segment that stands for all, what this segment invents, and what it misses. Then each segment
goes to its nearest output: lines are drawn anew, close, and give way to others.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence
from itertools import combinations

from ..lines import (
    SAME,
    Segment,
    is_longer,
    line_angle,
    line_at,
    line_of,
    parents_of,
    seen_from,
    segment_length,
    span_on,
    spanning,
)
from ..metrics import apart, segment_distance, segments_apart
from ..points import sums_along

#: Price of a metre, distance, sine of the angle, and gap.
Limits = tuple[float, float, float, float]
#: Number of an output -> its segment, and what each input costs there.
Outputs = dict[int, tuple[Segment, list[float]]]
#: Of each input what it costs at its nearest output, and that one's number; the same of the next.
Ranks = list[tuple[tuple[float, int], tuple[float, int]]]

#: Constants of `reduction.least_cost`.
HARD, NEIGHBOURS, STEPS, WIDE, RATIO = 2.0, 8, 6, 3.0, 2.0
#: Costs that differ by less are equal, metres: then the lower index comes first. In decimals, too.
EQUAL, DECIMALS = 1e-12, 12
#: Those of its second phase.
MISSED, TRIED, ROUNDS, FALL, LEAST = 0.075, 0.5, 6, 1e-4, 1e-6


def least_cost(
    segments: Sequence[Segment],
    *,
    penalty: float = 0.05,
    distance: float = 0.05,
    angle: float = math.radians(5),
    gap: float = 0.05,
) -> tuple[list[Segment], list[int]]:
    """Reduced segments, and the index of the output that each of the inputs went into."""
    price = max(0.25, penalty / distance / 40)
    limits = price, distance, math.sin(angle), gap
    drawn = merged(segments, penalty, limits)
    long = [i for i, s in enumerate(segments) if segment_length(s) >= SAME]
    limits = max(MISSED, penalty / distance / 40), distance, math.sin(angle), gap
    lines, nearest = exchanged([segments[i] for i in long], drawn, penalty, limits, price)
    order = sorted(set(nearest), key=nearest.index)
    groups = ([i for k, i in enumerate(long) if nearest[k] == f] for f in order)
    return [lines[f] for f in order], parents_of(groups, len(segments))


def merged(segments: Sequence[Segment], penalty: float, limits: Limits) -> list[Segment]:
    """The first phase: the segment of each cluster, once every merge costs too much."""
    _, distance, _, gap = limits
    members = {i: [i] for i, s in enumerate(segments) if segment_length(s) >= SAME}
    drawn = {i: segments[i] for i in members}
    cost = dict.fromkeys(members, 0.0)
    version = dict.fromkeys(members, 0)
    near = neighbour_sets(drawn, penalty, distance, gap)
    heap: list[tuple[float, int, int, int, int, bool]] = []

    def estimate(a: int, b: int) -> None:  # step 3
        q = estimated(segments, members, drawn, cost, a, b, gap)
        if q <= WIDE * penalty:
            key = round(max(q, 0.0) / RATIO, DECIMALS)
            heapq.heappush(heap, (key, a, b, version[a], version[b], False))

    for a, others in near.items():
        for b in others:
            if a < b:
                estimate(a, b)

    while heap:  # step 4
        _, a, b, of_a, of_b, exact = heapq.heappop(heap)
        if (version.get(a), version.get(b)) != (of_a, of_b):
            continue
        before = cost[a] + cost[b]
        both = [segments[i] for i in members[a] + members[b]]
        segment, both_cost = fit(both, drawn[a], drawn[b], before + WIDE * penalty, limits)
        delta = round(both_cost - before, DECIMALS) if both_cost < math.inf else math.inf
        if not exact:
            if delta > penalty:
                continue
            while heap and (version.get(heap[0][1]), version.get(heap[0][2])) != heap[0][3:5]:
                heapq.heappop(heap)
            if heap and delta > heap[0][0]:
                heapq.heappush(heap, (delta, a, b, of_a, of_b, True))
                continue
        members[a] += members.pop(b)
        drawn[a], cost[a], version[a] = segment, both_cost, of_a + 1
        del version[b], drawn[b], cost[b]
        near[a] = (near[a] | near.pop(b)) - {a, b}
        for c in near[a]:
            near[c] = (near[c] - {b}) | {a}
            estimate(min(a, c), max(a, c))
    return [drawn[a] for a in sorted(members)]


def neighbour_sets(
    segments: dict[int, Segment], penalty: float, distance: float, gap: float
) -> dict[int, set[int]]:
    """Step 1: pairs nearer than the reach that are among the nearest of one of them."""
    reach = min(max(penalty / 0.3, gap), 2 * distance)
    costs: dict[int, list[tuple[float, int, int]]] = {i: [] for i in segments}
    for i, j in combinations(segments, 2):
        if segments_apart(segments[i], segments[j]) <= reach:
            d = round(segment_distance(segments[i], segments[j]), DECIMALS)
            costs[i].append((d, i, j))
            costs[j].append((d, i, j))
    near: dict[int, set[int]] = {i: set() for i in costs}
    for pairs in costs.values():
        for _, i, j in sorted(pairs)[:NEIGHBOURS]:
            near[i].add(j)
            near[j].add(i)
    return near


def estimated(
    segments: Sequence[Segment],
    members: dict[int, list[int]],
    drawn: dict[int, Segment],
    cost: dict[int, float],
    a: int,
    b: int,
    gap: float,
) -> float:
    """Step 3: what it costs to draw the larger cluster's segment out over the smaller one's."""
    longer = b if is_longer(drawn[b], drawn[a]) else a
    low_a, high_a = span_on(drawn[longer], drawn[a])
    low_b, high_b = span_on(drawn[longer], drawn[b])
    if max(low_a, low_b) - min(high_a, high_b) > gap:
        return math.inf
    more = len(members[b]) - len(members[a])
    larger = more > 0 or (more == 0 and is_longer(drawn[b], drawn[a]))
    big, small = (b, a) if larger else (a, b)
    x, y = drawn[big][0]
    out = spanning(x, y, line_angle(drawn[big]), [*drawn[a], *drawn[b]])
    return sum(segment_distance(segments[i], out) for i in members[small]) - cost[small]


def fit(
    members: Sequence[Segment],
    of_a: Segment,
    of_b: Segment,
    most: float,
    limits: Limits,
    caps: Sequence[float] | None = None,
    bridged: float | None = None,
) -> tuple[Segment, float]:
    """Step 5: the segment of least cost for all members, and its cost; `inf` from `most` on."""
    ends = [p for s in members for p in s]
    longer = of_b if is_longer(of_b, of_a) else of_a
    best, at = most, None
    middle = [(longer[0][k] + longer[1][k]) / 2 for k in (0, 1)]
    for x, y, theta in (total_least_squares(members), (*middle, line_angle(longer))):
        cost = cost_of(members, spanning(x, y, theta, ends), limits, best, caps, bridged)
        if cost < best - (EQUAL if at else 0.0):
            best, at = cost, (x, y, theta)
    if at is None:
        return of_a, math.inf
    (x, y, theta), offset = at, 0.0
    shift = 0.2 * limits[1]
    whole = segment_length(line_at(x, y, theta, offset, ends))
    turn = min(0.1, 4 * shift / max(whole, 2 * shift))
    for _ in range(STEPS):
        moves = ((turn, 0.0), (-turn, 0.0), (0.0, shift), (0.0, -shift))
        better = None
        for d_theta, d_offset in moves:
            line = line_at(x, y, theta + d_theta, offset + d_offset, ends)
            cost = cost_of(members, line, limits, math.inf, caps, bridged)
            if cost < best - EQUAL:
                best, better = cost, (theta + d_theta, offset + d_offset)
        if better:
            theta, offset = better
        else:
            turn, shift = turn / 2, shift / 2
    return line_at(x, y, theta, offset, ends), best


def cost_of(
    members: Sequence[Segment],
    line: Segment,
    limits: Limits,
    most: float = math.inf,
    caps: Sequence[float] | None = None,
    bridged: float | None = None,
) -> float:
    """Cost of one segment for its members: distances, metres missed and metres invented.

    No member costs more than its cap, what it costs elsewhere. A metre invented costs as much as
    one missed, or the price `bridged`.
    """
    price, distance, sine, gap = limits
    x, y, dx, dy = line_of(line)
    costs, spans = [], []
    for s in members:
        off = max(abs((px - x) * dy - (py - y) * dx) for px, py in s)
        if off > HARD * distance:
            return math.inf
        cost = segment_distance(s, line)
        _, _, ex, ey = line_of(s)
        if off > distance or abs(dx * ey - dy * ex) > sine:
            cost += price * segment_length(s)
        else:
            spans.append(span_on(line, s))
        costs.append(cost)
    total = sum(map(min, costs, caps or costs))
    price = price if bridged is None else bridged
    total += price * invented(spans, segment_length(line), gap)
    return total if total < most else math.inf


def invented(spans: list[tuple[float, float]], whole: float, gap: float) -> float:
    """Metres of a segment in gaps longer than `gap` between the members that it keeps."""
    reached, metres = 0.0, 0.0
    for low, high in [*sorted(spans), (whole, whole)]:
        if not spans or low - reached > gap:
            metres += low - reached
        reached = max(reached, high)
    return metres


def total_least_squares(members: Sequence[Segment]) -> tuple[float, float, float]:
    """Centre and angle of the line that lies nearest to all the material of the members."""
    sums, *others = (sums_along(s, segment_length(s)) for s in members)
    for other in others:
        sums = sums + other
    return sums.x, sums.y, sums.direction()


# ----------------------------------------------------------------------------- second phase
def exchanged(
    inputs: Sequence[Segment],
    drawn: Sequence[Segment],
    penalty: float,
    limits: Limits,
    bridged: float,
) -> tuple[dict[int, Segment], list[int]]:
    """Outputs by their numbers, and the number of the nearest one of each input."""
    outputs = {f: (line, charges(inputs, line, limits)) for f, line in enumerate(drawn)}
    free = len(drawn)
    sizes = [round(segment_length(s), 9) for s in inputs]
    for _ in range(ROUNDS if inputs else 0):
        before = summed(ranks(outputs), outputs, penalty)
        for f in by_size(outputs):
            line = refitted(inputs, outputs, f, penalty, limits, bridged)
            if line:
                outputs[free] = line, charges(inputs, line, limits)
                del outputs[f]
                free = f
        close_all(outputs, penalty)
        turn, nearest = by_size(outputs), [at for (_, at), _ in ranks(outputs)]
        for j in sorted(range(len(inputs)), key=lambda i: (turn.index(nearest[i]), -sizes[i])):
            offer = charges(inputs, inputs[j], limits)
            free = exchange(outputs, j, free, inputs[j], offer, penalty)
        if summed(ranks(outputs), outputs, penalty) >= before * (1 - FALL):
            break
    lines = {f: line for f, (line, _) in outputs.items()}
    return lines, [first[1] for first, _ in ranks(outputs)]


def by_size(outputs: Outputs) -> list[int]:
    """The outputs, the longest first (ties: the lower number)."""
    return sorted(outputs, key=lambda f: (-round(segment_length(outputs[f][0]) / 2, DECIMALS), f))


def charge(s: Segment, line: Segment, limits: Limits) -> float:
    """What an input costs at an output: its distance, and the metres that are not beside it."""
    price, distance, sine, _ = limits
    if apart(s, line) > HARD * distance * (1 + 1e-9):
        return math.inf
    seen = [seen_from(line_of(line), p) for p in s]
    (_, _, dx, dy), (_, _, ex, ey) = line_of(line), line_of(s)
    (low, high), lost = sorted(a for a, _ in seen), segment_length(s)
    beside = max(abs(o) for _, o in seen) <= distance and abs(dx * ey - dy * ex) <= sine
    if beside and low < high:
        lost *= 1 - max(min(high, segment_length(line)) - max(low, 0.0), 0.0) / (high - low)
    return segment_distance(s, line) + price * lost


def charges(inputs: Sequence[Segment], line: Segment, limits: Limits) -> list[float]:
    """What each input costs at an output."""
    return [round_off(charge(s, line, limits)) for s in inputs]


def round_off(cost: float) -> float:
    """Costs that are equal but for rounding become the same number."""
    return round(cost, DECIMALS) if cost < math.inf else cost


def ranks(outputs: Outputs) -> Ranks:
    """The two cheapest outputs of each input (ties: the lower number)."""
    none = [(math.inf, -1), (math.inf, -1)]
    table = zip(*([(c, f) for c in costs] for f, (_, costs) in outputs.items()), strict=True)
    return [tuple(sorted([*row, *none], key=lambda r: (r[0], r[1] < 0, r[1]))[:2]) for row in table]


def summed(ranked: Ranks, outputs: Outputs, penalty: float) -> float:
    """What is minimised."""
    return sum(first for (first, _), _ in ranked) + penalty * len(outputs)


def loss(ranked: Ranks, f: int, offer: Sequence[float] | None = None) -> float:
    """What the members of an output lose by going elsewhere, to the line that is tried too."""
    total = 0.0
    for i, ((first, at), (second, _)) in enumerate(ranked):
        if at == f:
            tried = offer[i] if offer else math.inf
            total += min(second, tried) - min(first, tried)
    return round_off(total)


def refitted(
    inputs: Sequence[Segment],
    outputs: Outputs,
    f: int,
    penalty: float,
    limits: Limits,
    bridged: float,
) -> Segment | None:
    """A line that costs the members of an output less; none where there is no such line."""
    line, ranked = outputs[f][0], ranks(outputs)
    members = [i for i, ((_, at), _) in enumerate(ranked) if at == f]
    if not members:
        return None
    most = sum(ranked[i][0][0] for i in members) - LEAST * penalty
    caps = [ranked[i][1][0] for i in members]
    segment, cost = fit([inputs[i] for i in members], line, line, most, limits, caps, bridged)
    return segment if cost < math.inf else None


def close_all(outputs: Outputs, penalty: float) -> None:
    """Close outputs, the cheapest first, until every one would lose more than the penalty."""
    while outputs:
        ranked = ranks(outputs)
        lost, f = min((loss(ranked, f), f) for f in outputs)
        if lost >= penalty:
            return
        del outputs[f]


def saved(ranked: Ranks, f: int, offer: Sequence[float], penalty: float) -> float:
    """What a line would save among the members of an output: some move to it, and f may close."""
    moves = [(r[0][0], cost) for r, cost in zip(ranked, offer, strict=True) if r[0][1] == f]
    return sum(max(first - cost, 0.0) for first, cost in moves) + max(
        penalty - loss(ranked, f, offer), 0.0
    )


def exchange(
    outputs: Outputs, j: int, h: int, line: Segment, offer: list[float], penalty: float
) -> int:
    """Open a line, input j, as output h, and close all that lose less than the penalty then.

    The number that is free then: h again where the sum does not fall, or where its nearest output
    and the next would save too little.
    """
    ranked = ranks(outputs)
    beside = [f for cost, f in ranked[j] if cost < math.inf]
    if sum(saved(ranked, f, offer, penalty) for f in beside) <= TRIED * penalty:
        return h
    pairs = zip(ranked, offer, strict=True)
    others = {at for ((_, at), (second, _)), cost in pairs if cost < second}
    gain = sum(max(r[0][0] - cost, 0.0) for r, cost in zip(ranked, offer, strict=True)) - penalty
    gain += sum(max(penalty - loss(ranked, g, offer), 0.0) for g in others)
    if gain <= LEAST * penalty:
        return h
    now: Outputs = {**outputs, h: (line, offer)}
    closed = []
    while others:
        tried = ranks(now)
        lost, g = min((loss(tried, g), g) for g in others)
        if lost >= penalty:
            break
        del now[g]
        others.remove(g)
        closed.append(g)
    most = summed(ranked, outputs, penalty) - LEAST * penalty
    if not closed or summed(ranks(now), now, penalty) >= most:
        return h
    for g in closed:
        del outputs[g]
    outputs[h] = line, offer
    return closed[0]
