"""Segment similarity clustering (A 2.7.7): the cheapest pair becomes its mean, again and again."""

from __future__ import annotations

import heapq
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
from ...segments import angle, length
from .._index import Index, empty_index, enter, enter_all, meeting, take_out
from .._runner import Found, Indices, Reduction, Rows, resolve_merges, run_offline

#: Costs are compared in steps of so many metres: rounding must not choose.
COST_STEP_M = 1e-12
#: A heap of pairs: cost, in steps, both groups, and after how many merges they cost that.
Pairs = list[tuple[float, int, int, int]]


@checked
def segment_similarity(map: Segments, *, distance: Metres = 0.03) -> Reduction:
    """Merge the two most similar segments while they cost less than `distance` (A 2.7.7).

    The cost of two segments is their `metrics.segment_distance`, weighted by the number of
    segments that each stands for. The two become their span on that weighted mean line. Of equal
    costs, to 1e-12 m, the pair of the lowest indices comes first.

    A weight counts looks and not length: a scrap of 0.1 m pulls the mean line as much as another
    look at the whole wall. Nothing bounds a group: a chain of similar segments can drift. The
    cost grows with the map, and with nearly the square of the looks at each wall.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Its scans are ignored.
    distance
        What a merge may cost; A gives no value. At 0.03 m parallel walls 0.10 m apart may merge,
        and a gap of up to 0.12 m is bridged: of 18 simulated drives (poses within 2 cm) 15 keep the
        faces of a wall of 0.10 m, one those of 0.08 m. At 0.02 m all do, and leave a third more
        segments a wall.

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


class State(NamedTuple):
    """The groups and where they are."""

    s: Array  # (n, 2, 2), metres
    lines: Array  # (n, 3) direction, radians, length, metres, how many segments each stands for
    parents: Indices  # which group took each in; its own index until then
    changed: Indices  # after how many merges each has changed
    costs: Array  # of the cheapest pair of each that was offered, in steps
    places: Index
    near: Indices  # room for neighbours


def _reduce(rows: Rows, distance: float) -> Found:
    n, lengths = len(rows.segments), length(rows.segments)
    state = State(
        s=rows.segments.copy(),
        lines=np.column_stack([angle(rows.segments), lengths, np.ones(n)]),
        parents=np.arange(n),
        changed=np.zeros(n, np.int64),
        costs=np.empty(n),
        places=empty_index(n, max(2 * distance / APART_WEIGHT, lengths.mean() if n else 0.0)),
        near=np.empty(n + 1, np.int64),
    )
    _cluster(state, distance)
    alive, parents = resolve_merges(state.parents)
    return state.s[alive], parents


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
    left_cost = _direction_cost(s, lines, i, j, share, np.pi / 2)
    right_cost = _direction_cost(s, lines, i, j, share, -np.pi / 2)
    return -np.pi / 2 if right_cost < left_cost - COST_STEP_M else np.pi / 2


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
def _merge_to_mean(state: State, i: int, j: int) -> None:
    """i becomes the mean segment of both and takes in j."""
    s, lines = state.s, state.lines
    share = lines[j, 2] / (lines[i, 2] + lines[j, 2])
    direction = lines[i, 0] + share * _turn(s, lines, i, j, share)
    take_out(state.places, i)
    take_out(state.places, j)
    lines[i, 0], lines[i, 1] = direction, replace_by_mean(s, i, j, share, direction)
    lines[i, 2] += lines[j, 2]
    state.parents[j] = i
    enter(state.places, i, s[i], 0.0)


@compiled
def _offer(state: State, i: int, distance: float, merges: int, changed: bool, pairs: Pairs) -> None:
    """Put the cheapest pair of i and one behind it among the pairs.

    Those before i know it as it was: where it has `changed`, their pairs with it come too.
    """
    cheapest, partner = np.inf, -1
    for k in range(meeting(state.places, state.s[i], distance / APART_WEIGHT, state.near)):
        j = state.near[k]
        if j > i:
            cost = _pair_cost(state.s, state.lines, i, j, distance)
            if cost < cheapest or (cost == cheapest and j < partner):
                cheapest, partner = cost, j
        elif j < i and changed:
            cost = _pair_cost(state.s, state.lines, j, i, distance)
            if cost <= state.costs[j] and cost < np.inf:
                state.costs[j] = cost
                heapq.heappush(pairs, (cost, j, i, merges))
    state.costs[i] = cheapest
    if partner >= 0:
        heapq.heappush(pairs, (cheapest, i, partner, merges))


@compiled
def _cluster(state: State, distance: float) -> None:
    """Merge the cheapest pair until none costs less than `distance`, metres."""
    pairs, merges, parents, changed = [(0.0, 0, 0, 0)], 0, state.parents, state.changed
    pairs.pop()
    enter_all(state.places, state.s)
    for i in range(len(state.s)):
        _offer(state, i, distance, 0, False, pairs)
    while len(pairs):
        _, i, j, then = heapq.heappop(pairs)
        if parents[i] != i or changed[i] > then:
            continue
        is_current = parents[j] == j and changed[j] <= then
        if is_current:
            merges += 1
            _merge_to_mean(state, i, j)
            changed[i] = merges
        _offer(state, i, distance, merges, is_current, pairs)
