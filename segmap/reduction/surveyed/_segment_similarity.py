"""Segment similarity clustering (A 2.7.7): the cheapest pair becomes its mean, again and again."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Array, Metres, Segments, checked
from ...compiled import compiled
from ...kernels import (
    ACROSS_WEIGHT,
    ANGULAR_WEIGHT,
    APART_WEIGHT,
    PERPENDICULAR,
    apart,
    replace_by_mean,
    turn_between,
)
from ...segments import angle, length, midpoint
from .._index import Index, empty_index, enter, meeting, take_out
from .._runner import Found, Indices, Reduction, Rows, resolve_merges, run_offline

#: Costs are compared in steps of so many metres: rounding must not choose.
COST_STEP_M = 1e-12


@checked
def segment_similarity(map: Segments, *, distance: Metres = 0.03) -> Reduction:
    """Merge the two most similar segments while they cost less than `distance` (A 2.7.7).

    The cost of two segments is their `metrics.segment_distance`, weighted by the number of
    segments that each stands for. The two become their span on that weighted mean line. Of equal
    costs, to 1e-12 m, the pair of the lowest indices comes first.

    A weight counts looks and not length: a scrap of 0.1 m pulls the mean line as much as another
    look at the whole wall. Nothing bounds a group: a chain of similar segments can drift.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Its scans are ignored.
    distance
        What a merge may cost; A gives no value. At 0.03 m parallel walls 0.10 m apart still merge,
        and a gap of up to 0.12 m is bridged.

    Returns
    -------
    Reduction
        In the order of the lowest index among the segments that went into each.

    References
    ----------
    Elseberg, Creed, Lakaemper, "A line segment based system for 2D global mapping", ICRA 2010.

    Examples
    --------
    >>> walls = [[(0, 0), (2, 0)], [(1, 0.1), (3, 0.1)], [(0, 1), (0, 2)]]
    >>> reduction = segment_similarity(walls)
    >>> reduction, reduction.parents
    (Reduction(segment_similarity: 3 -> 2 segments), array([0, 0, 1]))
    >>> reduction.segments[0].round(6)
    array([[0.  , 0.05],
           [3.  , 0.05]])
    """
    return run_offline("segment_similarity", map, lambda rows: _reduce(rows, distance))


def _reduce(rows: Rows, distance: float) -> Found:
    n, lengths, reach = len(rows.segments), length(rows.segments), distance / APART_WEIGHT
    unit, (x, y) = max(2 * reach, lengths.mean() if n else 0.0), midpoint(rows.segments).T
    order = np.lexsort((y, np.floor(x / unit)))  # what is near in space is near in memory
    s, leaves = rows.segments[order], 1 << max(int(np.ceil(np.log2(max(n, 1)))), 1)
    winners = np.full(2 * leaves, -1)
    winners[leaves + order] = np.arange(n)
    partner, changed, looked = np.zeros((3, n), np.int64)
    state = State(
        s=s,
        lines=np.column_stack([angle(s), lengths[order], np.ones(n)]),
        rank=order,
        parents=np.arange(n),
        costs=np.full(n, np.inf),
        partner=partner,
        changed=changed,
        looked=looked,
        winners=winners,
        places=empty_index(n, unit),
        near=np.empty(n + 1, np.int64),
    )
    _cluster(state, distance)
    into, left = np.empty(n, np.int64), np.empty_like(s)
    into[order], left[order] = order[state.parents], s
    alive, parents = resolve_merges(into)
    return left[alive], parents


class State(NamedTuple):
    """The groups, where they are, and for each the cheapest partner that stands behind it.

    Each group knows its cheapest partner of a higher index, and a tree of winners knows the
    cheapest of all. So the memory grows with n, not with the number of pairs. When a group has
    changed, its neighbours compare it with their partner; one whose own partner has changed looks
    again only when it wins.
    """

    s: Array  # (n, 2, 2), metres
    lines: Array  # (n, 3) direction, radians, length, metres, how many segments each stands for
    rank: Indices  # of each among the inputs: "lower" and "behind" mean this
    parents: Indices  # which group took each in; its own index until then
    costs: Array  # of each with its partner, in steps; infinite without one
    partner: Indices
    changed: Indices  # after how many merges each has changed
    looked: Indices  # and has got its partner
    winners: Indices  # of nodes 2 k and 2 k + 1 the cheaper group stands in k; ties: the lower
    places: Index
    near: Indices  # room for neighbours


@compiled
def _direction_cost(s: Array, lines: Array, i: int, j: int, share: float, turn: float) -> float:
    """`0.66 D_ang + 0.09 D_uva`, metres, where j lies at `turn` from i and pulls with `share`."""
    direction = lines[i, 0] + share * turn
    dx = (s[i, 0, 0] + s[i, 1, 0] - s[j, 0, 0] - s[j, 1, 0]) / 2
    dy = (s[i, 0, 1] + s[i, 1, 1] - s[j, 0, 1] - s[j, 1, 1]) / 2
    off, rest = abs(dx * np.sin(direction) - dy * np.cos(direction)), 1 - share
    angular = rest * lines[i, 1] * np.tan(abs(share * turn))
    angular += share * lines[j, 1] * np.tan(abs(rest * turn))
    most = max(  # each has its middle beside the mean line, and turns about it
        share * off + lines[i, 1] / 2 * np.sin(abs(share * turn)),
        rest * off + lines[j, 1] / 2 * np.sin(abs(rest * turn)),
    )
    return ANGULAR_WEIGHT * angular + ACROSS_WEIGHT * most


@compiled
def _turn(s: Array, lines: Array, i: int, j: int, share: float) -> float:
    """From i to j, radians; of the two of perpendicular segments the cheaper, or the left one."""
    turn = turn_between(lines[i, 0], lines[j, 0])
    if abs(abs(turn) - np.pi / 2) > PERPENDICULAR:
        return turn
    left = _direction_cost(s, lines, i, j, share, np.pi / 2)
    right = _direction_cost(s, lines, i, j, share, -np.pi / 2)
    return -np.pi / 2 if right < left - COST_STEP_M else np.pi / 2


@compiled
def _pair_cost(s: Array, lines: Array, i: int, j: int, distance: float) -> float:
    """Cost of i < j (A 2.33 to 2.35) in steps; infinite where not below `distance`, metres."""
    share = lines[j, 2] / (lines[i, 2] + lines[j, 2])
    turn = _turn(s, lines, i, j, share)
    least = share * (1 - share) * abs(turn) * (lines[i, 1] + lines[j, 1])
    if ANGULAR_WEIGHT * least >= distance:  # no tangent is smaller than its angle
        return np.inf
    cost = _direction_cost(s, lines, i, j, share, turn)
    if cost < distance:
        cost += APART_WEIGHT * apart(s[i], s[j])
    return np.rint(cost / COST_STEP_M) if cost < distance else np.inf


@compiled
def _play(state: State, i: int) -> None:
    """Group i has another cost: find the winners above it."""
    winners, costs = state.winners, state.costs
    node = (len(winners) // 2 + state.rank[i]) // 2
    while node > 0:
        left, right = winners[2 * node], winners[2 * node + 1]
        winners[node] = right if right >= 0 and costs[right] < costs[left] else left
        node //= 2


@compiled
def _find_partner(state: State, i: int, distance: float, merges: int, tell: bool) -> None:
    """Find the cheapest partner behind i; where asked, `tell` those before i what i costs."""
    s, lines, rank, costs, partner = state.s, state.lines, state.rank, state.costs, state.partner
    costs[i], partner[i], state.looked[i] = np.inf, -1, merges
    for k in range(meeting(state.places, s[i], distance / APART_WEIGHT, state.near)):
        j = state.near[k]
        if rank[j] > rank[i]:
            cost = _pair_cost(s, lines, i, j, distance)
            if cost < costs[i] or (cost == costs[i] and rank[j] < rank[partner[i]]):
                costs[i], partner[i] = cost, j
        elif j != i and tell:
            cost = _pair_cost(s, lines, j, i, distance)
            if cost < costs[j] or (cost == costs[j] and rank[i] < rank[partner[j]]):
                costs[j], partner[j], state.looked[j] = cost, i, merges
                _play(state, j)
    _play(state, i)


@compiled
def _merge_to_mean(state: State, i: int, j: int) -> None:
    """i becomes the mean segment of both and takes in j."""
    s, lines = state.s, state.lines
    share = lines[j, 2] / (lines[i, 2] + lines[j, 2])
    direction = lines[i, 0] + share * _turn(s, lines, i, j, share)
    take_out(state.places, i)
    take_out(state.places, j)
    lines[i, 0], lines[i, 1] = direction, replace_by_mean(s, i, j, share, direction)
    lines[i, 2] += lines[j, 2]
    state.parents[j], state.costs[j] = i, np.inf
    enter(state.places, i, s[i], 0.0)


@compiled
def _cluster(state: State, distance: float) -> None:
    """Merge the cheapest pair until none costs less than `distance`, metres."""
    s, merges = state.s, 0
    for i in range(len(s)):
        enter(state.places, i, s[i], 0.0)
    for i in range(len(state.s)):
        _find_partner(state, i, distance, merges, False)
    while len(state.s) > 0 and state.costs[state.winners[1]] < np.inf:
        i = state.winners[1]
        j = state.partner[i]
        if state.parents[j] != j or state.changed[j] > state.looked[i]:
            _find_partner(state, i, distance, merges, False)
            continue
        merges += 1
        _merge_to_mean(state, i, j)
        state.changed[i] = merges
        _play(state, j)
        _find_partner(state, i, distance, merges, True)
