"""Uncertain parameters (A 2.7.8): lines with standard deviations, fused scan by scan."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from ...arrays import Array, Metres, Segments, checked
from ...compiled import compiled
from ...kernels import apart, gap_along, lay, length_of, span, turn_between
from ...segments import SegmentMap, length, point_distance, take_points
from .._index import Index, empty_index, enter, leave, meeting
from .._runner import Indices, Reduction, Rows, Steps, Turn, run_online, survivors

#: No fused line is known better than this, metres and radians.
LEAST_RHO, LEAST_THETA = 0.001, 1e-4
#: Lengths and gaps closer than this, in metres, are equal: rounding must not choose.
SAME = 1e-9


@checked
def uncertain_parameters(
    map: Segments,
    *,
    distance: Metres = 0.10,
    angle: Turn = np.pi / 18,
    eps: Metres = 0.01,
    origin: Literal["map", "pair"] = "pair",
) -> Reduction:
    """Fuse each new segment with all of the map that it may be a look at (A 2.7.8).

    A segment of length l whose points lie within eps of it has a line with the standard deviations
    `max(eps, 1 mm)` across and `asin(2 eps / l)` in direction. A new segment takes in every segment
    of the map whose direction is within `angle`, from which it is less than `distance` away, and
    with which it overlaps along the bisector. The fused line has the means of rho and theta,
    weighted by `length / sigma^2`, and spans all end points; its deviations are those of a sum of
    independent looks, at least 1 mm and 1e-4 radians. A new segment without a match joins the map.

    Old walls get so certain that no later look can move them, and a bend within `angle` and
    `distance` is ironed out. Segments of one wall that touch and do not overlap never meet.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Scans come in ascending order.
    distance
        Segments farther apart are two walls (A's T_D, without a value): 0.10 m is the noise of two
        looks and of the poses between.
    angle
        A's T_theta: segments that differ more in direction are two walls.
    eps
        For a map without points. With points it is the largest distance of one from its segment.
    origin
        A takes rho about the origin of the map. Theta and rho have different weights, so 50 m away
        the fused line can miss both walls by 0.2 m. "pair" takes it about the mean of the middles,
        weighted by length.

    Returns
    -------
    Reduction
        In the order in which segments joined; with seconds and segments in the map for each scan.

    References
    ----------
    Amigoni, Fontana, Garigiola, "A method for building small-size segment-based maps", DARS 2006.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (4, 0)], [(3, 0.02), (4, 0.04)], [(4.2, 0), (5, 0)]])
    >>> found = uncertain_parameters(wall)
    >>> found, found.parents
    (Reduction(uncertain_parameters: 3 -> 2 segments), array([0, 0, 1]))
    """

    def steps(rows: Rows) -> Steps:
        s, n = rows.segments, len(rows.segments)
        off = np.full(n, float(eps))
        if isinstance(map, SegmentMap) and map.points is not None and map.first is not None and n:
            points, first = take_points(map.points, map.first, rows.row)
            beside = point_distance(points, np.repeat(s, np.diff(first), axis=0))
            off = np.maximum(np.maximum.reduceat(beside, first[:-1]), LEAST_RHO)
        lengths = length(s)
        sigma = np.stack([np.maximum(off, LEAST_RHO), np.minimum(2 * off / lengths, 1.0)], -1)
        sigma[:, 1] = np.arcsin(sigma[:, 1])
        state = State(
            s=np.empty((n + 1, 2, 2)),
            sigma=np.empty((n + 1, 2)),
            into=np.arange(n + 1),
            counts=np.zeros(2, np.int64),
            places=empty_index(n + 1, max(2 * distance, lengths.mean() if n else 0.0)),
            near=np.empty(n + 2, np.int64),
        )
        walls = np.empty(n, np.int64)
        for first_row, stop in rows.scans():
            _add(state, s, sigma, first_row, stop, distance, angle, origin == "pair", walls)
            yield int(state.counts[1])
        alive, into = survivors(state.into[: state.counts[0]])
        return state.s[: len(into)][alive], into[walls]

    return run_online("uncertain_parameters", map, steps)


class State(NamedTuple):
    """The map: its walls in the order in which they joined, and one that is being compared."""

    s: Array  # (n, 2, 2), metres
    sigma: Array  # (n, 2) standard deviations of rho and theta, metres and radians
    into: Indices  # which wall took each in; its own index until then
    counts: Indices  # (2,) how many walls there ever were, and how many are left
    places: Index
    near: Indices  # room for neighbours


@compiled
def _angle(s: Array, i: int) -> float:
    return np.arctan2(s[i, 1, 1] - s[i, 0, 1], s[i, 1, 0] - s[i, 0, 0])


@compiled
def _matches(state: State, b: int, distance: float, angle: float) -> int:
    """Write the walls that b may be a look at, ascending, and behind them b; how many they are."""
    s, near, count, at = state.s, state.near, 0, _angle(state.s, b)
    for k in range(meeting(state.places, s[b], distance, near)):
        j = near[k]
        turn = turn_between(at, _angle(s, j))
        dx, dy = np.cos(at + turn / 2), np.sin(at + turn / 2)
        if abs(turn) >= angle - SAME or gap_along(s[b], s[j], dx, dy) > SAME:
            continue
        if apart(s[b], s[j]) < distance - SAME:
            place = count
            while place > 0 and near[place - 1] > j:
                near[place] = near[place - 1]
                place -= 1
            near[place] = j
            count += 1
    near[count] = b
    return count


@compiled
def _fuse(s: Array, sigma: Array, members: Indices, local: bool) -> None:
    """The first member becomes one wall for them all (A 2.38)."""
    total, longest, x, y, at = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in members:
        size = length_of(s[i])
        total += size
        x += size * (s[i, 0, 0] + s[i, 1, 0]) / 2
        y += size * (s[i, 0, 1] + s[i, 1, 1]) / 2
        if size > longest + SAME:
            longest, at = size, _angle(s, i)
    x, y = (x / total, y / total) if local else (0.0, 0.0)
    rho, of_rho, theta, of_theta, known_rho, known_theta = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in members:
        size = length_of(s[i])
        turn = turn_between(at, _angle(s, i))
        across = ((s[i, 0, 1] + s[i, 1, 1]) / 2 - y) * np.cos(at + turn)
        across -= ((s[i, 0, 0] + s[i, 1, 0]) / 2 - x) * np.sin(at + turn)
        know_rho, know_theta = sigma[i, 0] ** -2.0, sigma[i, 1] ** -2.0
        rho, of_rho = rho + size * know_rho * across, of_rho + size * know_rho
        theta, of_theta = theta + size * know_theta * turn, of_theta + size * know_theta
        known_rho, known_theta = known_rho + know_rho, known_theta + know_theta
    rho, at = rho / of_rho, at + theta / of_theta
    dx, dy = np.cos(at), np.sin(at)
    x, y, low, high, first = x - rho * dy, y + rho * dx, np.inf, -np.inf, members[0]
    for i in members:
        begin, end = span(s[i], x, y, dx, dy)
        low, high = min(low, begin), max(high, end)
    lay(s[first], x, y, dx, dy, low, high)
    sigma[first, 0] = max(known_rho**-0.5, LEAST_RHO)
    sigma[first, 1] = max(known_theta**-0.5, LEAST_THETA)


@compiled
def _add(
    state: State,
    new: Array,
    sigma: Array,
    first: int,
    stop: int,
    distance: float,
    angle: float,
    local: bool,
    walls: Indices,
) -> None:
    """Put the segments `first` to `stop` of `(n, 2, 2)`, metres, into the map; angle in radians.

    Writes which wall took each in, `(n,)`.
    """
    s, counts, near = state.s, state.counts, state.near
    for i in range(first, stop):
        b = counts[0]
        for k in range(2):
            s[b, k, 0], s[b, k, 1] = new[i, k, 0], new[i, k, 1]
            state.sigma[b, k] = sigma[i, k]
        count = _matches(state, b, distance, angle)
        walls[i] = near[0]
        if count == 0:
            counts[0] += 1
            counts[1] += 1
        else:
            for k in range(count):
                leave(state.places, near[k])
                state.into[near[k]] = near[0]
            counts[1] -= count - 1
            _fuse(s, state.sigma, near[: count + 1], local)
        enter(state.places, near[0], s[near[0]], 0.0)
