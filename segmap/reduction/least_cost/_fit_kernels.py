"""The loops of least cost that draw one segment for two clusters, and say what it costs.

Costs are metres: distances of quality (A 2.7.7, equal weights), and a price for each metre of wall
that the segment misses or invents.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import compiled
from ...kernels import (
    ACROSS_WEIGHT,
    ANGULAR_WEIGHT,
    APART_WEIGHT,
    Line,
    apart,
    mean_line_terms,
    off_segment,
    order_by_first,
    place_on_line,
    seen_from,
    span_of,
)

Indices = NDArray[np.int64]
#: A merge is looked at whose first estimate is up to so many penalties: estimates are too high.
ESTIMATE_PENALTIES = 3.0
#: Pairs come by their estimate over this. The higher, the more are fitted for a merge. The sum of
#: costs is at most 0.04 % above that of the first version, which visited all in every round, at 2,
#: and 0.26 % at 1.5: chosen on six cases of seven real and simulated maps, tried on 22 others.
ESTIMATE_RATIO = 2.0
#: A member may lie so many times the distance off the line, or the line is refused.
HARD = 2.0
#: Rounds in which a line is turned and shifted; each halves what it tried where nothing helped.
LINE_FIT_ROUNDS = 6
#: Costs that differ by less are equal, metres: then what was tried first counts.
EQUAL = 1e-12


class Limits(NamedTuple):
    """Thresholds of `least_cost`: metres, a sine, and prices of a metre missed or invented."""

    penalty: float
    missed: float
    invented: float
    distance: float
    sine: float
    gap: float


class Workspace(NamedTuple):
    """The inputs for which a segment is drawn, and scratch arrays."""

    who: Indices  # (n,) index of the input
    order: Indices  # (n,) spans by where they begin
    caps: Array  # (n,) what each costs elsewhere: it is charged no more
    spans: Array  # (n, 2) projections of those that are kept
    line: Array  # (2, 2) the segment that was drawn last
    frame: Array  # (5,) its middle, direction and half length
    sums: Array  # (6,) weight, centre and scatter of both clusters


def empty_workspace(n: int) -> Workspace:
    """Scratch arrays for n inputs, which cost any price elsewhere."""
    shapes = n, (n, 2), (2, 2), 5, 6
    work = Workspace(*np.empty((2, n), np.int64), *(np.empty(shape) for shape in shapes))
    work.caps[:] = np.inf
    return work


def segment_sums(d: Array) -> Array:
    """Weight, centre and scatter xx, xy, yy of segments that are described, `(n, 6)`."""
    whole, (x, y) = 2 * d[:, 4], d[:, 2:4].T
    scatter = (whole**3 / 12 * p for p in (x * x, x * y, y * y))
    return np.column_stack([whole, d[:, :2], *scatter])


@compiled
def round_off(cost: float) -> float:
    """Costs that are equal but for rounding become the same number."""
    return np.floor(cost / EQUAL + 0.5) * EQUAL


@compiled
def insert_ranked(nearest: Array, who: Indices, i: int, j: int, value: float) -> None:
    """Put a neighbour into the list of the nearest of i, where it is among them (ties: lower)."""
    at = who.shape[1]
    while at > 0 and (
        value < nearest[i, at - 1] or (value == nearest[i, at - 1] and j < who[i, at - 1])
    ):
        at -= 1
        if at + 1 < who.shape[1]:
            nearest[i, at + 1], who[i, at + 1] = nearest[i, at], who[i, at]
    if at < who.shape[1]:
        nearest[i, at], who[i, at] = value, j


@compiled
def assignment_cost(
    s: Array, d: Array, i: int, line: Array, about: Array, f: int, limits: Limits, most: float
) -> float:
    """What input i of (n, 2, 2) costs if it goes to segment f of (m, 2, 2); `inf`: too far off.

    Both are described by (n, 5) and (m, 5). Its distance, and the price of the metres that are not
    beside the segment. `inf`, too, where it is above `most`: the slow terms come last.
    """
    dx, dy = about[f, 2], about[f, 3]
    u, one, v, other = seen_from((about[f, 0], about[f, 1], dx, dy), s[i])
    low, high, off = min(u, v), max(u, v), max(abs(one), abs(other))
    lost, sine = 2.0 * d[i, 4], abs(d[i, 2] * dy - d[i, 3] * dx)
    if off <= limits.distance and sine <= limits.sine and low < high:
        beside = max(min(high, about[f, 4]) - max(low, -about[f, 4]), 0.0)
        lost *= 1.0 - beside / (high - low)
    if limits.missed * lost > most + EQUAL:
        return np.inf
    angular, across = mean_line_terms(d[i], about[f])
    cost = ANGULAR_WEIGHT * angular + ACROSS_WEIGHT * across + limits.missed * lost
    if cost > most + EQUAL:
        return np.inf
    near = apart(s[i], line[f])
    return cost + APART_WEIGHT * near if near <= HARD * limits.distance * (1 + 1e-9) else np.inf


@compiled
def _assignment_line_cost(
    s: Array, d: Array, work: Workspace, count: int, limits: Limits, line: Line, most: float
) -> float:
    """Cost of the segment on a line that spans all members; `inf` from `most` on."""
    (x, y, dx, dy), frame = line, work.frame
    first, last = span_of(s, work.who[:count], line)
    x, y, whole = x + first * dx, y + first * dy, last - first
    if whole < 1e-9:
        return np.inf
    frame[0], frame[1], frame[4] = x + whole / 2.0 * dx, y + whole / 2.0 * dy, whole / 2.0
    frame[2], frame[3] = dx, dy
    total, span_count, covered = 0.0, 0, False
    for k in range(count):
        i = work.who[k]
        u, one, v, other = seen_from((x, y, dx, dy), s[i])
        off, near = max(abs(one), abs(other)), min(abs(one), abs(other))
        if off > HARD * limits.distance:
            return np.inf
        low, high = min(u, v), max(u, v)
        if one * other < 0.0 and (low < near or whole - high < near):  # an end of it is nearer
            near = min(near, off_segment(x, y, s[i]))
            near = min(near, off_segment(x + whole * dx, y + whole * dy, s[i]))
        angular, across = mean_line_terms(d[i], frame)
        cost = ANGULAR_WEIGHT * angular + ACROSS_WEIGHT * across + APART_WEIGHT * near
        if off > limits.distance or abs(dx * d[i, 3] - dy * d[i, 2]) > limits.sine:
            cost += limits.missed * 2.0 * d[i, 4]
        elif not covered:
            work.spans[span_count, 0], work.spans[span_count, 1] = low, high
            covered = low <= limits.gap and high >= whole - limits.gap
            span_count += 1
        total += min(cost, work.caps[k])
        if total >= most:
            return np.inf
    if not covered:  # metres in longer gaps between the spans of those that are kept
        order_by_first(work.order[:span_count], work.spans)
        reached, metres = 0.0, 0.0
        for k in range(span_count + 1):
            begin = work.spans[work.order[k], 0] if k < span_count else whole
            metres += begin - reached if begin - reached > limits.gap or span_count == 0 else 0.0
            reached = max(reached, work.spans[work.order[k], 1]) if k < span_count else whole
        total += limits.invented * metres
    return total if total < most else np.inf


@compiled
def fit_cheapest_line(
    s: Array, d: Array, work: Workspace, count: int, limits: Limits, guess: Array, most: float
) -> float:
    """Leave the segment of least cost for the members in `work.line`; its cost, `inf`: too dear.

    From the line of total least squares, `work.sums`, or that of a guess, whichever costs less, to
    the best of four moves, or of half of each, again and again.
    """
    theta = np.arctan2(2.0 * work.sums[4], work.sums[3] - work.sums[5]) / 2.0
    line = work.sums[1], work.sums[2], np.cos(theta), np.sin(theta)
    best = _assignment_line_cost(s, d, work, count, limits, line, most)
    mx, my = (guess[0, 0] + guess[1, 0]) / 2.0, (guess[0, 1] + guess[1, 1]) / 2.0
    along = np.arctan2(guess[1, 1] - guess[0, 1], guess[1, 0] - guess[0, 0])
    other = mx, my, np.cos(along), np.sin(along)
    cost = _assignment_line_cost(s, d, work, count, limits, other, min(best - EQUAL, most))
    if cost < best:
        best, line, theta = cost, other, along
    if best == np.inf:
        return np.inf
    low, high = span_of(s, work.who[:count], line)
    (x, y, _, _), shift, offset = line, 0.2 * limits.distance, 0.0
    turn, was = min(0.1, 4.0 * shift / max(high - low, 2.0 * shift)), (np.inf, np.inf)
    for _ in range(LINE_FIT_ROUNDS):
        now, then, base = (theta, offset), was, line
        for k in range(4):
            t = now[0] + (turn if k == 0 else -turn if k == 1 else 0.0)
            o = now[1] + (shift if k == 2 else -shift if k == 3 else 0.0)
            if t == then[0] and o == then[1]:  # back again: that cost more
                continue
            dx, dy = (np.cos(t), np.sin(t)) if k < 2 else (base[2], base[3])
            at = x - o * dy, y + o * dx, dx, dy
            cost = _assignment_line_cost(s, d, work, count, limits, at, best - EQUAL)
            if cost < best:
                best, line, theta, offset = cost, at, t, o
        was = now
        if (theta, offset) == now:
            turn, shift = turn / 2.0, shift / 2.0
    low, high = span_of(s, work.who[:count], line)
    place_on_line(work.line, line, low, high)
    return best
