"""Weighted line fitting (A 2.7.3): lines with covariances; two looks within what both allow."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ... import arrays
from ...arrays import Array, Segments
from ...compiled import compiled
from ...kernels import gap_along, lay
from .._boxes import Boxes, empty_boxes, enter, leave, meeting
from .._points import check_spacing, points_behind
from .._runner import Indices, Reduction, Rows, Steps, by_lowest, run_online
from ._line_fits import compare, fit_all

#: Angles and gaps closer than this, in radians and metres, are equal; so are chis within TIE.
SAME, TIE = 1e-9, 1e-12
#: No gap in a map is wider, metres.
FAR = 1e8


def weighted_line_fitting(
    map: Segments,
    *,
    chi2: float = 9.21,
    gap: float = 0.30,
    sigma_range: float = 0.01,
    sigma_bearing: float = np.radians(0.25),
    sigma_place: float = 0.03,
    sigma_heading: float = np.radians(0.5),
    turn: float = np.radians(20),
    spacing: float = 0.05,
) -> Reduction:
    """Merge lines whose difference both covariances allow (A 2.7.3; Pfister et al. 2003).

    Each line is fitted to its points, weighted by the noise of the sensor, and knows the covariance
    of its offset and angle; the noise of the pose of its scan is added. A new line takes in the
    line of the map with the smallest chi, the squared difference in units of both covariances,
    below `chi2`; the merged line, better known than both, looks again until none is left, and
    joins the map. Its end points are the extreme projections of all points.

    The pose term decides how much merges, and it is a guess: of the 1227 segments of the bundled
    Malaga 439 are left with the noise of the sensor alone, and 249 with the defaults. A names no
    test of extent, so two far walls on one line would merge: that is what `gap` is for. The
    covariance is the exact inverse about the centre of the points; the closed form of the paper
    leaves the lever of the centre out. A runs it off-line too: with all segments in one scan.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        Scans come in ascending order. Best with points and places of the sensor,
        `build_map(..., keep_points=True)`. Without points they are put along the segments; without
        the place of the sensor the noise is the same in all directions.
    chi2 : float
        9.21 holds 99 % of looks at one line (two degrees of freedom). A gives no value.
    gap : float, metres
        Largest gap between two looks along their bisector: 0.30 m, narrower than a door; may be
        infinite.
    sigma_range, sigma_bearing : float, metres and radians
        Noise of the sensor, of the URG-04LX by default.
    sigma_place, sigma_heading : float, metres and radians
        Noise of the pose of each scan, what a good alignment leaves.
    turn : float, radians
        Largest angle between two looks: beyond 20 degrees the linear covariance says nothing.
    spacing : float, metres
        Distance of the points where the map has none: those of a laser at 4 m to 8 m.

    Returns
    -------
    Reduction
        By the first segment of each line; with seconds and lines in the map for each scan.

    Raises
    ------
    ValueError
        For coordinates that are not finite, thresholds out of range.

    References
    ----------
    Pfister, Roumeliotis, Burdick, "Weighted line fitting algorithms for mobile robot map building
    and efficient data representation", ICRA 2003.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(1, 0.03), (3, 0.03)], [(1, 0.3), (3, 0.3)]]
    >>> found = weighted_line_fitting(wall)
    >>> found, found.parents
    (Reduction(weighted_line_fitting: 3 -> 2 segments), array([0, 0, 1]))
    """
    arrays.positive(chi2=chi2)
    arrays.number(gap, "gap", least=0, most=np.inf, unit="metres")
    arrays.positive("metres", sigma_range=sigma_range)
    arrays.number(sigma_bearing, "sigma_bearing", least=0, unit="radians")
    arrays.number(sigma_place, "sigma_place", least=0, unit="metres")
    arrays.number(sigma_heading, "sigma_heading", least=0, unit="radians")
    arrays.number(turn, "turn", above=0, most=np.pi / 2, unit="radians")
    check_spacing(spacing)
    noise = np.array([sigma_range, sigma_bearing, sigma_place, sigma_heading], float)
    limits = np.array([chi2, min(gap, FAR), turn], float)
    return run_online(
        "weighted_line_fitting", map, lambda rows: _steps(map, rows, noise, limits, spacing)
    )


class State(NamedTuple):
    """The map: lines numbered as they joined, and the points that each has to span.

    Parameters
    ----------
    lines : (n, 6) array
        As `Line` of `_line_fits`.
    ends : (n, 2, 2) array, metres
    boxes : Boxes
        Around each live line: where another can be that merges with it.
    members : (n, 2) int array
        First and last row of the list of each line.
    after : (n,) int array
        Next row of the list, -1 at its end.
    near : (n,) int array
        Room for the lines that may merge.
    chis : (n,) array
        Room for the chi of each.
    used : (1,) int array
        Lines that ever joined.
    """

    lines: Array
    ends: Array
    boxes: Boxes
    members: Indices
    after: Indices
    near: Indices
    chis: Array
    used: Indices


def _steps(map: Segments, rows: Rows, noise: Array, limits: Array, spacing: float) -> Steps:
    points, first, sensors, kept = points_behind(map, rows, spacing)
    n, s = len(rows.segments), rows.segments
    fitted = np.empty((n, 6))
    fit_all(points, first, sensors, noise, fitted, np.empty(int(np.diff(first).max(initial=0))))
    if not kept:
        points, first = s.reshape(-1, 2), np.arange(0, 2 * n + 1, 2)
    unit = max(1.0, 2 * float(np.hypot(*(s[:, 1] - s[:, 0]).T).mean())) if n else 1.0
    state = State(
        np.empty((n, 6)),
        np.empty((n, 2, 2)),
        empty_boxes(n, unit),
        np.empty((n, 2), np.int64),
        np.full(n, -1),
        np.empty(n, np.int64),
        np.empty(n),
        np.zeros(1, np.int64),
    )
    for begin, stop in rows.scans():
        _add(state, fitted, points, first, begin, stop, limits)
        yield int(state.boxes.levels.sum())
    live = np.flatnonzero(state.boxes.cell[:, 2] >= 0)
    into = _parents(live, state.members, state.after, np.empty(n, np.int64))
    order, into = by_lowest(into, rows.row, len(live))
    return state.ends[live[order]], into


@compiled
def _parents(live: Indices, members: Indices, after: Indices, into: Indices) -> Indices:
    """Which of the live lines each row went into."""
    for k in range(len(live)):
        i = members[live[k], 0]
        while i >= 0:
            into[i] = k
            i = after[i]
    return into


@compiled
def _may_meet(state: State, a: int, b: int, gap: float, turn: float) -> bool:
    """Whether two lines differ by at most an angle, radians, and leave at most a gap, metres."""
    alpha, beta = state.lines[a, 2], state.lines[b, 2]
    turns = round((alpha - beta) / np.pi)
    if abs(alpha - beta - turns * np.pi) > turn + SAME:
        return False
    mean = (alpha + beta + turns * np.pi) / 2
    found = gap_along(state.ends[a], state.ends[b], -np.sin(mean), np.cos(mean))
    return found <= gap + SAME


@compiled
def _best(state: State, a: int, limits: Array) -> int:
    """The live line with the least chi below the threshold; ties: the lowest; -1 for none."""
    boxes, near, chis, least, best = state.boxes, state.near, state.chis, limits[0], -1
    low, high = boxes.low, boxes.high
    count = meeting(boxes, low[a, 0], low[a, 1], high[a, 0], high[a, 1], near)
    for k in range(count):
        chis[k] = limits[0]
        if _may_meet(state, a, near[k], limits[1], limits[2]):
            chis[k] = compare(state.lines[a], state.lines[near[k]])[0]
        least = min(least, chis[k])
    for k in range(count):
        if chis[k] < limits[0] and chis[k] <= least + TIE and (best < 0 or near[k] < best):
            best = near[k]
    return best


@compiled
def _settle(state: State, a: int, points: Array, first: Indices, limits: Array) -> None:
    """End points of line a from its points, metres, and its box.

    At any place where two lines with a small chi can meet, their distance is at most
    sqrt(chi2) times the sum of what each may be off there. The box leaves that much room, a tenth
    more for what the linear covariance leaves out, and its share of the gap.
    """
    x, y, alpha = state.lines[a, 0], state.lines[a, 1], state.lines[a, 2]
    c, s, low, high = np.cos(alpha), np.sin(alpha), np.inf, -np.inf
    i = state.members[a, 0]
    while i >= 0:
        for j in range(first[i], first[i + 1]):
            u = (points[j, 1] - y) * c - (points[j, 0] - x) * s
            low, high = min(low, u), max(high, u)
        i = state.after[i]
    ends, boxes, gap, off = state.ends, state.boxes, 0.75 * limits[1], 0.0
    lay(ends[a], x, y, -s, c, low, high)
    for u in (low - gap, high + gap):
        rr = state.lines[a, 3] - 2 * u * state.lines[a, 4] + u * u * state.lines[a, 5]
        wide = state.lines[a, 3] + 2 * u * state.lines[a, 4] + u * u * state.lines[a, 5]
        off = max(off, rr, wide)
    room = 1.1 * np.sqrt(limits[0] * off) + gap
    for k in range(2):
        boxes.low[a, k] = min(ends[a, 0, k], ends[a, 1, k]) - room
        boxes.high[a, k] = max(ends[a, 0, k], ends[a, 1, k]) + room


@compiled
def _take_in(state: State, a: int, b: int) -> None:
    """Line a becomes the merge of a and b, which leaves the map; b's members follow a's."""
    merged, lines = compare(state.lines[a], state.lines[b])[1], state.lines
    lines[a, 0], lines[a, 1], lines[a, 2] = merged[0], merged[1], merged[2]
    lines[a, 3], lines[a, 4], lines[a, 5] = merged[3], merged[4], merged[5]
    state.after[state.members[a, 1]] = state.members[b, 0]
    state.members[a, 1] = state.members[b, 1]
    leave(state.boxes, b)


@compiled
def _add(
    state: State,
    fitted: Array,
    points: Array,
    first: Indices,
    begin: int,
    stop: int,
    limits: Array,
) -> None:
    """Step 6: each line from `begin` to `stop` merges until none fits, then joins the map."""
    for i in range(begin, stop):
        a = state.used[0]
        for k in range(6):
            state.lines[a, k] = fitted[i, k]
        state.members[a, 0], state.members[a, 1] = i, i
        _settle(state, a, points, first, limits)
        b = _best(state, a, limits)
        while b >= 0:
            _take_in(state, a, b)
            _settle(state, a, points, first, limits)
            b = _best(state, a, limits)
        enter(state.boxes, a)
        state.used[0] += 1
