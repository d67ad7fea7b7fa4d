"""The loops of one per wall that draw the walls: grow them, look for what hid a gap, take in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled
from ...kernels import (
    SAME,
    Line,
    length_of,
    line_through,
    order_by_first,
    place_on_line,
    seen_from,
    span,
    span_of,
)
from .._index import Index, enter, enter_all, meeting, take_out

Indices = NDArray[np.int64]
#: Gaps that are bridged, metres.
BRIDGED_GAP_M = 0.3
#: Gaps that are bridged if something stood before them, metres.
HIDDEN_GAP_M = 1.0
#: A beam that passed through this length of a gap, metres, saw that there is no wall.
THROUGH_M = 0.1
#: A thing that hides a gap stands at least this far in front of it, metres: a nearer one, a
#: pilaster, is part of the wall.
NICHE_DEPTH_M = 0.3
#: A thing that hides a gap stands at most this far in front of it, metres.
SHADOW_DEPTH_M = 2.0
#: What hides at least this share of a gap hides it.
SHADE = 0.5
#: A look turns no more from its wall: sine of 30 degrees.
LOOK_TURN_SINE = 0.5
#: How often a wall may change its members.
MOST_MEMBER_CHANGES = 12
#: Least weight of a member in the fit of a line.
WEIGHT = 0.01
#: A wall absorbs one with so many times less metres.
LONGER_RATIO = 1.5
#: An absorbed wall is at most so many tolerances off.
ABSORBED_TOLERANCES = 1.5
#: At least this share of an absorbed wall lies beside the other.
ABSORBED_OVERLAP = 0.8


class Walls(NamedTuple):
    """Looks, the walls that they become, and scratch arrays."""

    s: Array  # (n, 2, 2) looks, metres
    sensors: Array  # (n, 2) where the sensor was, NaN where nobody knows
    places: Index  # of the looks that have no wall yet
    fans: Index  # of the triangles between sensor and look, and the shadow behind it
    drawn: Array  # (n, 2, 2) the walls
    label: Indices  # (n,) the wall of each look, -1 for none
    mark: Indices  # (n,) when a look was last a member
    near: Indices  # (n + 1,) room for neighbours, and then for members
    seen: Indices  # (n + 1,)
    who: Indices  # (n + 1,) candidates
    order: Indices  # (n + 1,)
    spans: Array  # (n, 2) where they lie along the wall
    grown: Array  # (2, 2) the wall that grows


@compiled
def _gap_is_hidden(walls: Walls, line: Line, low: float, high: float, tolerance: float) -> bool:
    """Whether something hid a gap, from low to high along a line, and no beam passed through it."""
    s, sensors, gap, hidden = walls.s, walls.sensors, np.empty((2, 2)), False
    x, y, dx, dy = line
    place_on_line(gap, line, low, high)
    for k in range(meeting(walls.fans, gap, 0.0, walls.seen)):
        j = walls.seen[k]
        px, py = sensors[j, 0] - x, sensors[j, 1] - y
        from_u, from_v = px * dx + py * dy, py * dx - px * dy
        begin, end, behind, before = np.inf, -np.inf, True, True
        u0, v0, u1, v1 = seen_from(line, s[j])
        for u, v in ((u0, v0), (u1, v1)):
            if from_v < 0.0:
                v = -v
            behind, before = behind and v < -tolerance, before and NICHE_DEPTH_M < v < abs(from_v)
            if behind or before:
                on = from_u + (u - from_u) * abs(from_v) / (abs(from_v) - v)
                begin, end = min(begin, on), max(end, on)
                before = before and np.hypot(on - u, v) <= SHADOW_DEPTH_M
        shared = min(high, end) - max(low, begin)
        if behind and abs(from_v) > tolerance and shared > THROUGH_M:
            return False
        hidden = hidden or (before and shared >= SHADE * (high - low))
    return hidden


@compiled
def _fitting_looks(walls: Walls, seed: int, line: Line, tolerance: float) -> int:
    """Write the looks that fit a line and hang together with the seed into `near`; how many."""
    s, near, spans, count = walls.s, walls.near, walls.spans, 1
    low, high = span(walls.grown, line)
    walls.who[0] = seed
    spans[0, 0], spans[0, 1] = span(s[seed], line)
    for k in range(meeting(walls.places, walls.grown, HIDDEN_GAP_M + tolerance, near)):
        i = near[k]
        u0, v0, u1, v1 = seen_from(line, s[i])
        off, rise = max(abs(v0), abs(v1)), abs(v0 - v1)
        begin, end = min(u0, u1), max(u0, u1)
        near_by = begin <= high + HIDDEN_GAP_M and end >= low - HIDDEN_GAP_M
        if i != seed and near_by and off <= tolerance and rise <= LOOK_TURN_SINE * length_of(s[i]):
            walls.who[count], spans[count, 0], spans[count, 1] = i, begin, end
            count += 1
    order = walls.order
    order_by_first(order[:count], spans)
    members, has, reached = 0, False, spans[order[0], 0]
    for k in range(count):
        low = spans[order[k], 0]
        if low - reached > BRIDGED_GAP_M + SAME and not (
            low - reached <= HIDDEN_GAP_M + SAME
            and _gap_is_hidden(walls, line, reached, low, tolerance)
        ):
            if has:
                break
            members, reached = 0, low
        near[members] = walls.who[order[k]]
        has, members = has or near[members] == seed, members + 1
        reached = max(reached, spans[order[k], 1])
    return members


@compiled
def _robust_line(walls: Walls, members: Indices, line: Line, tolerance: float) -> Line:
    """The line of total least squares of some looks; those that lie far off it count less."""
    s, weight, sums = walls.s, walls.spans, np.zeros(6)
    x, y, _, _ = line
    for k in range(len(members)):
        i = members[k]
        _, one, _, other = seen_from(line, s[i])
        share = max(1.0 - (max(abs(one), abs(other)) / tolerance) ** 2, 0.0)
        w = length_of(s[i]) * max(share * share, WEIGHT)
        weight[k, 0] = w
        sums[0] += w
        sums[1] += w * ((s[i, 0, 0] + s[i, 1, 0]) / 2 - x)
        sums[2] += w * ((s[i, 0, 1] + s[i, 1, 1]) / 2 - y)
    x, y = x + sums[1] / sums[0], y + sums[2] / sums[0]
    for k in range(len(members)):
        i, w = members[k], weight[k, 0]
        ex, ey = (s[i, 1, 0] - s[i, 0, 0]) / 2, (s[i, 1, 1] - s[i, 0, 1]) / 2
        mx, my = s[i, 0, 0] + ex - x, s[i, 0, 1] + ey - y
        sums[3] += w * (mx * mx + ex * ex / 3)
        sums[4] += w * (mx * my + ex * ey / 3)
        sums[5] += w * (my * my + ey * ey / 3)
    theta = np.arctan2(2 * sums[4], sums[3] - sums[5]) / 2
    return x, y, np.cos(theta), np.sin(theta)


@compiled
def enter_looks(walls: Walls) -> None:
    """Put all looks, and what each beam passed through, into their indices."""
    s, fan = walls.s, np.empty((3, 2))
    enter_all(walls.places, s)
    for i in range(len(s)):
        if np.isfinite(walls.sensors[i, 0]):
            for c in range(2):
                fan[0, c] = walls.sensors[i, c]
            for e in range(2):
                x, y = s[i, e, 0] - fan[0, 0], s[i, e, 1] - fan[0, 1]
                longer = 1.0 + SHADOW_DEPTH_M / max(np.hypot(x, y), SAME)
                fan[1 + e, 0], fan[1 + e, 1] = fan[0, 0] + longer * x, fan[0, 1] + longer * y
            enter(walls.fans, i, fan, 0.0)


@compiled
def grow(walls: Walls, seeds: Indices, count: int, tolerance: float) -> int:
    """Let looks that have no wall gather one each, after `count` walls; how many there are."""
    s, drawn, mark = walls.s, walls.drawn, walls.mark
    for seed in seeds:
        if walls.label[seed] >= 0:
            continue
        stamp = count * (MOST_MEMBER_CHANGES + 1)
        line, members = line_through(s[seed]), walls.near[:0]
        place_on_line(walls.grown, line, 0.0, length_of(s[seed]))
        for _ in range(MOST_MEMBER_CHANGES):
            before = len(members)
            members = walls.near[: _fitting_looks(walls, seed, line, tolerance)]
            stamp, same = stamp + 1, len(members) == before
            for i in members:
                same = same and mark[i] == stamp - 1
                mark[i] = stamp
            if same:
                break
            line = _robust_line(walls, members, line, tolerance)
            low, high = span_of(s, members, line)
            place_on_line(walls.grown, line, low, high)
        low, high = span_of(s, members, line)
        place_on_line(drawn[count], line, low, high)
        for i in members:
            walls.label[i] = count
            take_out(walls.places, i)
        count += 1
    return count


@compiled
def absorb_weaker(
    drawn: Array, metres: Array, weakest: Indices, places: Index, reach: float, into: Indices
) -> None:
    """Write the wall that each goes into: the nearest stronger one that it lies beside, or itself.

    `metres` are those of the looks at each, `(m,)`; the stronger keeps its line.
    """
    near = np.empty(len(drawn) + 1, np.int64)
    enter_all(places, drawn)
    for a in weakest:
        best, least, size = -1, reach, length_of(drawn[a])
        for k in range(meeting(places, drawn[a], reach, near)):
            b = near[k]
            if b == a or metres[b] < LONGER_RATIO * metres[a] - SAME:
                continue
            u0, v0, u1, v1 = seen_from(line_through(drawn[b]), drawn[a])
            shared = min(max(u0, u1), length_of(drawn[b])) - max(min(u0, u1), 0.0)
            off, beside = max(abs(v0), abs(v1)), shared >= ABSORBED_OVERLAP * size - SAME
            if beside and (off < least - SAME or (off <= least + SAME and b < best)):
                best, least = b, min(off, least)
        if best >= 0:
            into[a] = best
            metres[best] += metres[a]
            take_out(places, a)
