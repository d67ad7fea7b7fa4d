"""The core of least cost, as chapter 21 writes it: a line's cost, and the cheapest merge first.

Every pair is tried, and each line is drawn by its cost. What `least_cost` does beside, to be fast
and to undo merges, is left out: where nothing is to be undone, both end with the same segments.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.metrics import errors
from segmap.segments import angle, extreme_projections, length, midpoint

#: The numbers of its looks, the segment that stands for them, and what that costs.
Cluster = tuple[Any, Any, Any]
#: What a segment costs its members `(n, 2, 2)`, metres.
Cost = Callable[[Array, Array], float]


def nearest_line(members: Array) -> tuple[Array, Any]:
    """A point and the angle of the line nearest to all members, each as heavy as it is long."""
    size, along = length(members), members[:, 1] - members[:, 0]
    centre = size @ midpoint(members) / size.sum()
    off = midpoint(members) - centre
    (xx, xy), (_, yy) = (size * off.T) @ off + (size * along.T) @ along / 12
    return centre, np.arctan2(2 * xy, xx - yy) / 2


def line_at(members: Array, centre: Array, theta: Any, offset: float = 0.0) -> Array:
    """The segment that spans all members, on a line that is shifted across by the offset."""
    across = np.array([-np.sin(theta), np.cos(theta)])
    return extreme_projections(members.reshape(-1, 2), centre + offset * across, theta)


def gap_metres(spans: Array, whole: Any, gap: float) -> float:
    """Metres of a segment in gaps longer than `gap` between the spans (k, 2) of members."""
    low, high = np.sort(spans).T
    order = np.argsort(low)
    gaps = np.append(low[order], whole) - np.maximum.accumulate(np.append(0.0, high[order]))
    return float(gaps[gaps > gap].sum())


def cost_of(
    members: Array,
    line: Array,
    price: float = 0.25,
    distance: float = 0.05,
    turn: float = np.radians(5),
    gap: float = 0.05,
) -> float:
    """Distances of all members, and the price of each metre that is missed or invented."""
    dx, dy = (line[1] - line[0]) / length(line)
    x, y = np.moveaxis(members - line[0], 2, 0)
    along, across = x * dx + y * dy, y * dx - x * dy
    off, size = abs(across).max(axis=1), length(members)
    if off.max() > 2 * distance:
        return np.inf
    beside = (off <= distance) & (abs(across[:, 1] - across[:, 0]) <= size * np.sin(turn))
    invented = gap_metres(along[beside], length(line), gap)
    return errors(members, [line]).sum() + price * (size[~beside].sum() + invented)


def cheapest_line(members: Array, longer: Array, cost: Cost = cost_of) -> tuple[Array, float]:
    """The segment of least cost for all members, by small turns and shifts, and its cost."""
    starts = [nearest_line(members), (midpoint(longer), angle(longer))]
    least, k = min((cost(members, line_at(members, *start)), k) for k, start in enumerate(starts))
    (centre, theta), offset, shift = starts[k], 0.0, 0.01
    turn = np.minimum(0.1, 0.04 / length(line_at(members, centre, theta)))
    for _ in range(6 if least < np.inf else 0):
        ways = (turn, 0), (-turn, 0), (0, shift), (0, -shift)
        moves = [(theta + a, offset + b) for a, b in ways]
        costs = [cost(members, line_at(members, centre, *move)) for move in moves]
        if min(costs) < least:
            least, (theta, offset) = min(costs), moves[np.argmin(costs)]
        else:
            turn, shift = turn / 2, shift / 2
    return line_at(members, centre, theta, offset), least


def merge(looks: Array, a: Cluster, b: Cluster, cost: Cost = cost_of) -> tuple[float, Cluster]:
    """What one cluster costs more than two, and that cluster: its looks, its line, its cost."""
    (in_a, line_a, cost_a), (in_b, line_b, cost_b) = a, b
    line, total = cheapest_line(looks[[*in_a, *in_b]], max(line_a, line_b, key=length), cost)
    return total - cost_a - cost_b, (in_a + in_b, line, total)


def merge_all(looks: Array, penalty: float, cost: Cost = cost_of) -> list[Cluster]:
    """Clusters after the cheapest merges, one after the other, that cost at most the penalty."""
    clusters = [((k,), look, 0.0) for k, look in enumerate(looks)]
    merges = {}
    while len(clusters) > 1:
        pairs = [(a[0] + b[0], a, b) for a, b in combinations(clusters, 2)]
        merges.update({k: merge(looks, a, b, cost) for k, a, b in pairs if k not in merges})
        key, a, b = min(pairs, key=lambda pair: merges[pair[0]][0])
        if merges[key][0] > penalty:
            break
        clusters = [merges[key][1] if c is a else c for c in clusters if c is not b]
    return clusters
