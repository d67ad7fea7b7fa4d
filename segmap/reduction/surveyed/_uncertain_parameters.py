"""Uncertain parameters (A 2.7.8): lines with standard deviations, fused scan by scan."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from ... import arrays
from ...arrays import Array, Segments
from ...compiled import compiled
from ...segments import SegmentMap, length, point_distance, take_points
from .._basic import check_match
from .._cells import Cells, empty_cells, enter, leave, near
from .._runner import Indices, Reduction, Rows, Steps, run_online

#: No fused line is known better than this, metres and radians.
LEAST_RHO, LEAST_THETA = 0.001, 1e-4
#: Lengths and gaps closer than this, in metres, are equal: rounding must not choose.
SAME = 1e-9


def uncertain_parameters(
    map: Segments,
    *,
    distance: float = 0.10,
    angle: float = np.pi / 18,
    eps: float = 0.01,
    origin: Literal["map"] | None = None,
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
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        Scans come in ascending order.
    distance : float, metres
        A's T_D, without a value: 0.10 m is the noise of two looks and of the poses between.
    angle : float, radians
        A's T_theta: above 0, at most pi/2.
    eps : float, metres
        For a map without points. With points it is the largest distance of one from its segment.
    origin : "map" or None
        A takes rho about the origin of the map. Theta and rho have different weights, so 50 m away
        the fused line can miss both walls by 0.2 m. None takes it about the mean of the middles,
        weighted by length.

    Returns
    -------
    Reduction
        In the order in which segments joined; with seconds and segments in the map for each scan.

    Raises
    ------
    ValueError
        For coordinates that are not finite, thresholds out of range.

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
    check_match(map, distance, angle)
    arrays.positive("metres", eps=eps)
    if origin is not None:
        arrays.one_of(origin, "origin", ("map",))
    return run_online(
        "uncertain_parameters",
        map,
        lambda rows: _steps(rows, _eps(map, rows, eps), float(distance), angle, origin is None),
    )


def _eps(map: Segments, rows: Rows, eps: float) -> Array:
    """Largest distance, metres, of a point behind each row from it, `(k,)`; else `eps`."""
    if not isinstance(map, SegmentMap) or map.points is None or map.first is None:
        return np.full(len(rows.row), float(eps))
    points, first = take_points(map.points, map.first, rows.row)
    if not len(points):
        return np.empty(0)
    off = point_distance(points, np.repeat(rows.segments, np.diff(first), axis=0))
    return np.maximum(np.maximum.reduceat(off, first[:-1]), LEAST_RHO)


def _steps(rows: Rows, eps: Array, distance: float, angle: float, local: bool) -> Steps:
    state = _empty_map(rows.segments, distance)
    sigma = np.stack([np.maximum(eps, LEAST_RHO), 2 * eps / length(rows.segments)], -1)
    sigma[:, 1] = np.arcsin(np.minimum(sigma[:, 1], 1.0))
    walls = np.empty(len(rows.segments), np.int64)
    for first, stop in rows.scans():
        _add(state, rows.segments, sigma, first, stop, angle, local, walls)
        yield int(state.counts[1])
    into = state.into[: state.counts[0]]
    alive = into == np.arange(len(into))
    while not alive[into].all():
        into = into[into]
    return state.s[: len(into)][alive], (np.cumsum(alive) - 1)[into[walls]]


class State(NamedTuple):
    """The map: its walls in the order in which they joined, and a grid of them.

    Parameters
    ----------
    s : (n, 2, 2) array, metres
    sigma : (n, 2) array, metres and radians
        Standard deviations of rho and theta.
    into : (n,) int array
        Which wall took each in; its own index until then.
    counts : (2,) int array
        How many walls there ever were, and how many are left.
    cells : Cells
    found : (n,) int array
        Room for neighbours.
    """

    s: Array
    sigma: Array
    into: Indices
    counts: Indices
    cells: Cells
    found: Indices


def _empty_map(segments: Array, distance: float) -> State:
    n = len(segments) + 1  # the last one has room for a segment that is being compared
    cells, found = empty_cells(segments, distance, n), np.empty(n, np.int64)
    return State(
        np.empty((n, 2, 2)), np.empty((n, 2)), np.arange(n), np.zeros(2, np.int64), cells, found
    )


@compiled
def _angle(s: Array, i: int) -> float:
    return np.arctan2(s[i, 1, 1] - s[i, 0, 1], s[i, 1, 0] - s[i, 0, 0])


@compiled
def _agrees(s: Array, i: int, j: int, angle: float) -> bool:
    """Whether j has the direction of i, radians, and overlaps it along the bisector."""
    at = _angle(s, i)
    turn = (_angle(s, j) - at + np.pi / 2) % np.pi - np.pi / 2
    if abs(turn) >= angle:
        return False
    dx, dy = np.cos(at + turn / 2), np.sin(at + turn / 2)
    a, b = s[i, 0, 0] * dx + s[i, 0, 1] * dy, s[i, 1, 0] * dx + s[i, 1, 1] * dy
    c, d = s[j, 0, 0] * dx + s[j, 0, 1] * dy, s[j, 1, 0] * dx + s[j, 1, 1] * dy
    return min(max(a, b), max(c, d)) >= max(min(a, b), min(c, d)) - SAME


@compiled
def _matches(state: State, b: int, angle: float) -> int:
    """Write the walls that b may be a look at, ascending, and behind them b; how many they are."""
    found, count = state.found, 0
    for k in range(near(state.cells, state.s, state.s[b], found)):
        j = found[k]
        if _agrees(state.s, b, j, angle):
            place = count
            while place > 0 and found[place - 1] > j:
                found[place] = found[place - 1]
                place -= 1
            found[place] = j
            count += 1
    found[count] = b
    return count


@compiled
def _fuse(s: Array, sigma: Array, members: Indices, local: bool) -> None:
    """The first member becomes one wall for them all (A 2.38)."""
    total, longest, x, y, at = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in members:
        size = np.hypot(s[i, 1, 0] - s[i, 0, 0], s[i, 1, 1] - s[i, 0, 1])
        total += size
        x += size * (s[i, 0, 0] + s[i, 1, 0]) / 2
        y += size * (s[i, 0, 1] + s[i, 1, 1]) / 2
        if size > longest + SAME:
            longest, at = size, _angle(s, i)
    x, y = (x / total, y / total) if local else (0.0, 0.0)
    rho, of_rho, theta, of_theta, known_rho, known_theta = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in members:
        size = np.hypot(s[i, 1, 0] - s[i, 0, 0], s[i, 1, 1] - s[i, 0, 1])
        turn = (_angle(s, i) - at + np.pi / 2) % np.pi - np.pi / 2
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
        for k in range(2):
            u = (s[i, k, 0] - x) * dx + (s[i, k, 1] - y) * dy
            low, high = min(low, u), max(high, u)
    s[first, 0, 0], s[first, 0, 1] = x + low * dx, y + low * dy
    s[first, 1, 0], s[first, 1, 1] = x + high * dx, y + high * dy
    sigma[first, 0] = max(known_rho**-0.5, LEAST_RHO)
    sigma[first, 1] = max(known_theta**-0.5, LEAST_THETA)


@compiled
def _add(
    state: State,
    new: Array,
    sigma: Array,
    first: int,
    stop: int,
    angle: float,
    local: bool,
    walls: Indices,
) -> None:
    """Put the segments `first` to `stop` of `(n, 2, 2)`, metres, into the map; angle in radians.

    Writes which wall took each in, `(n,)`.
    """
    s, counts, found = state.s, state.counts, state.found
    for i in range(first, stop):
        b = counts[0]
        for k in range(2):
            s[b, k, 0], s[b, k, 1] = new[i, k, 0], new[i, k, 1]
            state.sigma[b, k] = sigma[i, k]
        count = _matches(state, b, angle)
        walls[i] = found[0]
        if count == 0:
            counts[0] += 1
            counts[1] += 1
        else:
            for k in range(count):
                leave(state.cells, found[k])
                state.into[found[k]] = found[0]
            counts[1] -= count - 1
            _fuse(s, state.sigma, found[: count + 1], local)
        enter(state.cells, s, found[0])
