"""The second phase of least cost: each input is charged to its nearest output, as by quality.

Clusters that merged are not for good here: lines are drawn anew, close, and give way to others.
"""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import compiled
from ...kernels import describe, describe_one, join_sums
from ...progress import parts
from ...segments import length
from .._index import LEVEL_COLUMN, Index, by_cell, empty_index, enter, enter_all, meeting, take_out
from .._runner import Found, Indices, Rows, ordered_by_first_input
from ._fit_kernels import (
    EQUAL,
    HARD,
    Limits,
    Workspace,
    assignment_cost,
    empty_workspace,
    fit_cheapest_line,
    insert_ranked,
    round_off,
    segment_sums,
)

#: What a metre missed costs here. Of 0.0375, 0.05, 0.075, 0.1, 0.15 and 0.25 the least at which, on
#: three buildings with and without the filter, no more is missed or invented at qualities of 0.9,
#: 0.85 and 0.8 than by segment similarity, the best of the others.
MISSED = 0.075
#: An input is tried as an output where its nearest output and the next alone would save so much of
#: the penalty. At 0.25, 0.5 and 0.7 the sum of costs is at most 0.1 % above that of looking at all
#: that is near each input, on four real and simulated maps, and 0.17 % on a made-up one.
TRIED_SHARE = 0.5
#: Rounds at most.
MOST_EXCHANGE_ROUNDS = 6
#: Another round follows where one lowers the sum by this share.
LEAST_FALL_SHARE = 1e-4
#: What lowers the sum by less than this share of the penalty changes nothing.
LEAST_GAIN_SHARE = 1e-6


class State(NamedTuple):
    """Inputs and the outputs that they may go to; m at first, and a number that is free."""

    s: Array  # (n, 2, 2) inputs
    d: Array  # (n, 5) middle, direction and half length of each
    sums: Array  # (n, 6) weight, centre and scatter
    line: Array  # (m + 1, 2, 2) outputs
    about: Array  # (m + 1, 5)
    who: Indices  # (n, 2) nearest output, and the next, -1 for none
    cost: Array  # (n, 2) what each input costs there, inf for none
    total: Array  # (1,) sum of the least costs and of the penalties
    ring: Indices  # (n + m + 1, 2) next and previous member of an output, which is n + f itself
    inputs: Index
    outputs: Index
    lists: Indices  # (4, n + 2) what an index finds
    offer: Array  # (n,) what each costs at a line that is tried, inf elsewhere
    seen: Indices  # (m + 1,) whether an output stands beside that line
    now: Indices  # (1,) tries so far
    when: Indices  # (m + 1,) the last that changed the members of an output, or what they lose
    tried: Indices  # (n + m + 1,) the last of each input as an output, of a new line for output f


def exchanged(rows: Rows, drawn: Array, limits: Limits) -> Found:
    """Outputs, and the nearest of each segment; their sum is not above that of the first phase."""
    n, m, reach = len(rows.segments), len(drawn), 2 * HARD * limits.distance
    unit = max(reach, length(rows.segments).mean() if n else 0.0)
    place = by_cell(rows.segments, unit)
    s, own = rows.segments[place], np.argsort(place)
    rank = np.argsort(own[np.argsort(-np.round(length(rows.segments), 9), kind="stable")])
    line, d = np.concatenate([drawn, np.zeros((1, 2, 2))]), describe(s)
    state = State(
        s=s,
        d=d,
        sums=segment_sums(d),
        line=line,
        about=describe(line),
        who=np.full((n, 2), -1),
        cost=np.full((n, 2), np.inf),
        total=np.zeros(1),
        ring=np.arange(n + m + 1).repeat(2).reshape(-1, 2),
        inputs=empty_index(n, unit),
        outputs=empty_index(m + 1, max(reach, length(drawn).mean() if n else 0.0)),
        lists=np.empty((4, n + 2), np.int64),
        offer=np.full(n, np.inf),
        seen=np.zeros(m + 1, np.int64),
        now=np.zeros(1, np.int64),
        when=np.zeros(m + 1, np.int64),
        tried=np.zeros(n + m + 1, np.int64),
    )
    limits = limits._replace(missed=max(MISSED, limits.penalty / limits.distance / 40))
    enter_all(state.inputs, s)
    free, work = m, empty_workspace(n)
    for part in parts(np.arange(m), "least cost: finding the segments of output", size=64):
        _switch_all(state, part, limits)
    for _ in range(MOST_EXCHANGE_ROUNDS):
        before = state.total[0]
        for part in parts(_by_size(state), "least cost: drawing anew output", size=64):
            free = _refit(state, work, part, free, limits)
        _close_all(state, limits)
        for part in parts(_by_output(state, rank), "least cost: trying as an output segment"):
            free = _exchange_all(state, part, free, limits)
        if state.total[0] >= before * (1.0 - LEAST_FALL_SHARE):
            break
    alive = state.outputs.link[:, LEVEL_COLUMN] >= 0
    into = (np.cumsum(alive) - 1)[state.who[own, 0]]
    order, into = ordered_by_first_input(into, np.arange(n), int(alive.sum()))
    return line[alive][order], into


def _by_size(state: State) -> Indices:
    """The outputs, the longest first (ties: the lower number)."""
    outputs = np.flatnonzero(state.outputs.link[:, LEVEL_COLUMN] >= 0)
    return outputs[np.argsort(-np.floor(state.about[outputs, 4] / EQUAL + 0.5), kind="stable")]


def _by_output(state: State, rank: Indices) -> Indices:
    """The inputs, those of the longest output first, and of each output the longest first."""
    outputs, turn = _by_size(state), np.empty(len(state.line))
    turn[outputs] = np.arange(len(outputs))
    return np.lexsort((rank, turn[state.who[:, 0]]))


# ------------------------------------------------------------------ who goes where
@compiled
def _switch(state: State, f: int, limits: Limits) -> None:
    """Open an output that is drawn already, or close it: what is near goes where it costs least."""
    opens, near = state.outputs.link[f, LEVEL_COLUMN] < 0, state.lists[1]
    if opens:
        enter(state.outputs, f, state.line[f], 0.0)
        state.total[0] += limits.penalty
    else:
        take_out(state.outputs, f)
        state.total[0] -= limits.penalty
    for k in range(meeting(state.inputs, state.line[f], HARD * limits.distance, near)):
        _assign(state, near[k], f, opens, limits)


@compiled
def _switch_all(state: State, part: Indices, limits: Limits) -> None:
    """Open some outputs."""
    for f in part:
        _switch(state, f, limits)


@compiled
def _assign(state: State, i: int, f: int, opens: bool, limits: Limits) -> None:
    """Find the two cheapest outputs of input i anew, where the one that opens or closes is one."""
    cost, who, near = state.cost, state.who, state.lists[0]
    best, other, first, second = who[i, 0], who[i, 1], cost[i, 0], cost[i, 1]
    if opens:
        value = assignment_cost(state.s, state.d, i, state.line, state.about, f, limits, second)
        insert_ranked(cost, who, i, f, round_off(value))
    elif f in (best, other):
        for k in range(2):
            cost[i, k], who[i, k] = np.inf, -1
        for k in range(meeting(state.outputs, state.s[i], HARD * limits.distance, near)):
            f, most = near[k], cost[i, 1]
            value = assignment_cost(state.s, state.d, i, state.line, state.about, f, limits, most)
            insert_ranked(cost, who, i, f, round_off(value))
    if who[i, 0] == best and who[i, 1] == other:
        return
    if best >= 0:
        state.total[0] -= first
        state.when[best] = state.now[0]
    state.total[0] += cost[i, 0]
    _enlist(state, i, len(state.s) + who[i, 0])
    state.when[who[i, 0]] = state.now[0]


@compiled
def _enlist(state: State, i: int, head: int) -> None:
    """Take input i out of its ring of members, and into another."""
    ring = state.ring
    ring[ring[i, 0], 1], ring[ring[i, 1], 0] = ring[i, 1], ring[i, 0]
    ring[i, 0], ring[i, 1] = ring[head, 0], head
    ring[ring[i, 0], 1] = ring[head, 0] = i


@compiled
def _loss(state: State, f: int) -> float:
    """What the members of an output lose by going elsewhere, to the line that is tried too."""
    cost, offer, n, total = state.cost, state.offer, len(state.s), 0.0
    i = state.ring[n + f, 0]
    while i < n:
        total += min(cost[i, 1], offer[i]) - min(cost[i, 0], offer[i])
        i = state.ring[i, 0]
    return round_off(total)


# ------------------------------------------------------------------ the three steps
@compiled
def _copy(state: State, line: Array, f: int) -> None:
    """Let a line be output f."""
    for k in range(4):
        state.line[f, k // 2, k % 2] = line[k // 2, k % 2]
    describe_one(state.line[f], state.about[f])


@compiled
def _refit(state: State, work: Workspace, part: Indices, free: int, limits: Limits) -> int:
    """Draw some outputs anew for their members, as the free one; the number that is free then."""
    n = len(state.s)
    for f in part:
        count, before, i = 0, 0.0, state.ring[n + f, 0]
        if state.when[f] < state.tried[n + f]:
            continue
        while i < n:
            work.who[count], work.caps[count] = i, state.cost[i, 1]
            if count == 0:
                for j in range(6):
                    work.sums[j] = state.sums[i, j]
            else:
                join_sums(work.sums, state.sums[i], work.sums)
            count, before, i = count + 1, before + state.cost[i, 0], state.ring[i, 0]
        guess, most = state.line[f], before - LEAST_GAIN_SHARE * limits.penalty
        state.now[0] += 1
        if count and fit_cheapest_line(state.s, state.d, work, count, limits, guess, most) < np.inf:
            _copy(state, work.line, free)
            _switch(state, free, limits)
            _switch(state, f, limits)
            free = f
        else:
            state.tried[n + f] = state.now[0]
    return free


@compiled
def _close_all(state: State, limits: Limits) -> None:
    """Close outputs, the cheapest first, until every one would lose more than the penalty."""
    heap = [(0.0, 0)]  # the compiler learns what an entry is
    heap.pop()
    for f in range(len(state.line)):
        if state.outputs.link[f, LEVEL_COLUMN] >= 0:
            heapq.heappush(heap, (_loss(state, f), f))
    while len(heap):
        key, f = heapq.heappop(heap)
        loss = _loss(state, f)
        if loss > key + EQUAL:  # losses only rise while others close
            heapq.heappush(heap, (loss, f))
        elif loss < limits.penalty:
            _switch(state, f, limits)


@compiled
def _saving(state: State, f: int, h: int, limits: Limits) -> float:
    """What output h would save among the members of output f: some move to it, and f may close."""
    n, cost, saved, loss = len(state.s), state.cost, 0.0, 0.0
    i = state.ring[n + f, 0]
    while i < n:
        most = cost[i, 1] if loss < limits.penalty else cost[i, 0]
        value = assignment_cost(state.s, state.d, i, state.line, state.about, h, limits, most)
        saved += max(cost[i, 0] - value, 0.0)
        loss += max(min(value, cost[i, 1]) - cost[i, 0], 0.0)
        i = state.ring[i, 0]
    return round_off(saved + max(limits.penalty - loss, 0.0))


@compiled
def _exchange(state: State, j: int, h: int, limits: Limits) -> int:
    """Open input j as output h, and close all that lose less than the penalty then.

    Returns the number that is free: h again where the sum does not fall, or where its nearest
    output and the next would save too little for a look at all that is near.
    """
    cost, offer, near, beside = state.cost, state.offer, state.lists[2], state.lists[3]
    penalty, saved, gain, others = limits.penalty, 0.0, -limits.penalty, 0
    _copy(state, state.s[j], h)
    for f in state.who[j]:
        if f >= 0:
            saved += _saving(state, f, h, limits)
    if saved <= TRIED_SHARE * penalty:
        return h
    count = meeting(state.inputs, state.line[h], HARD * limits.distance, near)
    for k in range(count):
        i, most = near[k], cost[near[k], 1]
        value = assignment_cost(state.s, state.d, i, state.line, state.about, h, limits, most)
        offer[i] = round_off(value)
        gain += max(cost[i, 0] - offer[i], 0.0)
    for k in range(count):
        f = state.who[near[k], 0]
        if offer[near[k]] < cost[near[k], 1] and not state.seen[f]:
            beside[others], state.seen[f], others = f, 1, others + 1
            gain += max(penalty - _loss(state, f), 0.0)
    for k in range(count):
        offer[near[k]] = np.inf
    for k in range(others):
        state.seen[beside[k]] = 0
    if gain <= LEAST_GAIN_SHARE * penalty:
        return h
    before, closed = state.total[0], 0
    _switch(state, h, limits)
    while closed < others:
        best, least = closed, np.inf
        for k in range(closed, others):
            loss = _loss(state, beside[k])
            if loss < least or (loss == least and beside[k] < beside[best]):
                best, least = k, loss
        if least >= penalty:
            break
        beside[closed], beside[best] = beside[best], beside[closed]
        _switch(state, beside[closed], limits)
        closed += 1
    if closed > 0 and state.total[0] < before - LEAST_GAIN_SHARE * penalty:
        return beside[0]
    for k in range(closed):
        _switch(state, beside[k], limits)
    _switch(state, h, limits)
    return h


@compiled
def _exchange_all(state: State, part: Indices, free: int, limits: Limits) -> int:
    """Try some inputs as outputs, one after the other; the number that is free then.

    An input is tried again when the members of its nearest output or the next, or what they lose,
    have changed.
    """
    for j in part:
        f, g = state.who[j]  # g of -1, for none, looks at the last: then it is tried once too often
        if max(state.when[f], state.when[g]) >= state.tried[j]:
            h, free = free, _exchange(state, j, free, limits)
            if free == h:
                state.now[0] += 1
                state.tried[j] = state.now[0]
    return free
