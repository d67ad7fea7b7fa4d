"""Weighted line fitting (A 2.7.3): lines with covariances; two looks within what both allow."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from ...arrays import Array, Metres, Positive, Radians, Segments, at_least, at_most, checked
from ...compiled import compiled
from ...kernels import gap_along, lay
from ...segments import length
from .._index import Index, empty_index, enter, leave, meeting
from .._points import points_behind
from .._runner import (
    Indices,
    Length,
    Reduction,
    Rows,
    Steps,
    Turn,
    by_lowest,
    run_online,
    survivors,
)

#: Centre x and y, metres, angle of the normal, radians, covariance of (offset, angle) about it.
Line = tuple[float, float, float, float, float, float]
#: Angles and gaps closer than this, in radians and metres, are equal; so are chis within TIE.
SAME, TIE = 1e-9, 1e-12
#: No gap in a map is wider, metres.
FAR = 1e8


@checked
def weighted_line_fitting(
    map: Segments,
    *,
    chi2: Positive = 9.21,
    gap: Annotated[Metres, at_least(0), at_most(np.inf)] = 0.30,
    sigma_range: Metres = 0.01,
    sigma_bearing: Radians = np.radians(0.25),
    sigma_place: Length = 0.03,
    sigma_heading: Annotated[Radians, at_least(0)] = np.radians(0.5),
    turn: Turn = np.radians(20),
    spacing: Metres = 0.05,
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
    map : SegmentMap, Reduction or (n, 2, 2) array
        Scans come in ascending order. Best with points and places of the sensor,
        `build_map(..., keep_points=True)`. Without points they are put along the segments; without
        the place of the sensor the noise is the same in all directions.
    chi2
        Largest squared difference of two looks, in units of their covariances: 9.21 holds 99 % of
        looks at one line (two degrees of freedom). A gives no value.
    gap
        Largest gap between two looks along their bisector: 0.30 m, narrower than a door; may be
        infinite.
    sigma_range, sigma_bearing
        Noise of the sensor, of the URG-04LX by default.
    sigma_place, sigma_heading
        Noise of the pose of each scan, what a good alignment leaves.
    turn
        Largest angle between two looks: beyond 20 degrees the linear covariance says nothing.
    spacing
        Distance of the points where the map has none: those of a laser at 4 m to 8 m.

    Returns
    -------
    Reduction
        By the first segment of each line; with seconds and lines in the map for each scan.

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
    noise = np.array([sigma_range, sigma_bearing, sigma_place, sigma_heading])
    limits = np.array([chi2, min(gap, FAR), turn])

    def steps(rows: Rows) -> Steps:
        points, first, sensors, kept = points_behind(map, rows, spacing)
        n, s = len(rows.segments), rows.segments
        fitted, weights = np.empty((n, 6)), np.empty(int(np.diff(first).max(initial=0)))
        _fit_all(points, first, sensors, noise, fitted, weights)
        if not kept:
            points, first = s.reshape(-1, 2), np.arange(0, 2 * n + 1, 2)
        state = State(
            lines=np.empty((n, 6)),
            ends=np.empty((n, 2, 2)),
            rooms=np.empty(n),
            places=empty_index(n, max(1.0, 2 * float(length(s).mean()) if n else 0.0)),
            members=np.empty((n, 2), np.int64),
            after=np.full(n, -1),
            near=np.empty(n + 1, np.int64),
            chis=np.empty(n),
            into=np.arange(n),
        )
        for begin, stop in rows.scans():
            _add(state, fitted, points, first, begin, stop, limits)
            yield int(state.places.levels[-1, 0])
        alive, into = survivors(state.into)
        order, into = by_lowest(into, rows.row, int(alive.sum()))
        return state.ends[alive][order], into

    return run_online("weighted_line_fitting", map, steps)


class State(NamedTuple):
    """The map: a line for each row until another takes it in, and the points that each spans."""

    lines: Array  # (n, 6) as `Line`
    ends: Array  # (n, 2, 2), metres
    rooms: Array  # how far from its ends another line can be that merges with each, metres
    places: Index  # of the live lines
    members: Indices  # (n, 2) first and last row of the list of each line
    after: Indices  # next row of the list, -1 at its end
    near: Indices  # room for the lines that may merge, and the chi of each
    chis: Array
    into: Indices  # which line took each in; its own index until then


# ------------------------------------------------------------------ a line and its covariance
@compiled
def _variance(
    x: float, y: float, nx: float, ny: float, sx: float, sy: float, noise: Array
) -> float:
    """Variance of a point across a line, square metres, seen from (sx, sy); NaN: no place."""
    dx, dy, one = x - sx, y - sy, noise[0] * noise[0]
    square = dx * dx + dy * dy
    if not square > 0.0:
        return one
    along, across = dx * nx + dy * ny, noise[1] * (dy * nx - dx * ny)
    return one * (along * along) / square + across * across


@compiled
def _fit(p: Array, start: int, stop: int, sx: float, sy: float, noise: Array, w: Array) -> Line:
    """Steps 1 and 2: weighted line of a run of points, metres, and its covariance.

    `w` is room for a weight a point.
    """
    x = y = alpha = c = s = total = 0.0
    before = np.nan
    for i in range(start, stop):
        w[i - start] = 1.0
    for _ in range(50):
        x = y = total = xx = xy = yy = 0.0
        for i in range(start, stop):
            total += w[i - start]
            x += w[i - start] * p[i, 0]
            y += w[i - start] * p[i, 1]
        x, y = x / total, y / total
        for i in range(start, stop):
            u, v = p[i, 0] - x, p[i, 1] - y
            xx += w[i - start] * u * u
            xy += w[i - start] * u * v
            yy += w[i - start] * v * v
        alpha = 0.5 * np.arctan2(2 * xy, xx - yy) + np.pi / 2
        c, s = np.cos(alpha), np.sin(alpha)
        for i in range(start, stop):
            w[i - start] = 1 / _variance(p[i, 0], p[i, 1], c, s, sx, sy, noise)
        if abs((alpha - before + np.pi / 2) % np.pi - np.pi / 2) < 1e-12:
            break
        before = alpha
    lever = total = 0.0
    for i in range(start, stop):
        t = (p[i, 1] - y) * c - (p[i, 0] - x) * s
        lever += w[i - start] * t * t
        total += w[i - start]
    arm = 0.0 if np.isnan(sx) else (sy - y) * c - (sx - x) * s
    place, turn = noise[2] * noise[2], noise[3] * noise[3]
    rr = 1 / total + place + arm * arm * turn
    return x, y, alpha, rr, arm * turn, 1 / max(lever, 1.0) + turn


@compiled
def _fit_all(
    p: Array, first: Indices, sensors: Array, noise: Array, out: Array, room: Array
) -> None:
    """Lines of all segments, `(n, 6)`."""
    for i in range(len(out)):
        found = _fit(p, first[i], first[i + 1], sensors[i, 0], sensors[i, 1], noise, room)
        out[i, 0], out[i, 1], out[i, 2] = found[0], found[1], found[2]
        out[i, 3], out[i, 4], out[i, 5] = found[3], found[4], found[5]


@compiled
def _about(line: Array, x: float, y: float) -> tuple[float, float, float]:
    """Step 3: offset of a line from (x, y), metres, and its covariances about that point."""
    c, s = np.cos(line[2]), np.sin(line[2])
    arm = (line[1] - y) * c - (line[0] - x) * s
    offset = (line[0] - x) * c + (line[1] - y) * s
    return offset, line[3] + 2 * arm * line[4] + arm * arm * line[5], line[4] + arm * line[5]


@compiled
def _compare(a: Array, b: Array) -> tuple[float, Line]:
    """Steps 4 and 5, eq. 2.22-2.25: chi of the difference of two lines; the line of both."""
    x, y = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
    ra, rra, raa = _about(a, x, y)
    rb, rrb, rab = _about(b, x, y)
    turns = round((a[2] - b[2]) / np.pi)
    if turns % 2 != 0:
        rb, rab = -rb, -rab
    dr, da = ra - rb, a[2] - (b[2] + turns * np.pi)
    rr, r_a, aa = rra + rrb, raa + rab, a[5] + b[5]
    det = rr * aa - r_a * r_a
    u, v = (aa * dr - r_a * da) / det, (rr * da - r_a * dr) / det  # S^-1 dL
    r, alpha = ra - (rra * u + raa * v), a[2] - (raa * u + a[5] * v)
    f, g = (aa * rrb - r_a * rab) / det, (aa * rab - r_a * b[5]) / det  # S^-1 P_B
    h, k = (rr * rab - r_a * rrb) / det, (rr * b[5] - r_a * rab) / det
    new_rr, new_ra, new_aa = rra * f + raa * h, rra * g + raa * k, raa * g + a[5] * k
    c, s, t = np.cos(alpha), np.sin(alpha), new_ra / new_aa
    centre_x, centre_y = x + r * c - t * s, y + r * s + t * c
    return dr * u + da * v, (centre_x, centre_y, alpha, new_rr - t * new_ra, 0.0, new_aa)


# ------------------------------------------------------------------ step 6: the map and a scan
@compiled
def _best(state: State, a: int, limits: Array) -> int:
    """The live line with the least chi below the threshold; ties: the lowest; -1 for none."""
    ends, lines, near, chis = state.ends, state.lines, state.near, state.chis
    least, best = limits[0], -1
    count = meeting(state.places, ends[a], state.rooms[a], near)
    for k in range(count):
        chis[k], alpha, beta = limits[0], lines[a, 2], lines[near[k], 2]
        turns = round((alpha - beta) / np.pi)
        if abs(alpha - beta - turns * np.pi) <= limits[2] + SAME:
            mean = (alpha + beta + turns * np.pi) / 2
            if gap_along(ends[a], ends[near[k]], -np.sin(mean), np.cos(mean)) <= limits[1] + SAME:
                chis[k] = _compare(lines[a], lines[near[k]])[0]
        least = min(least, chis[k])
    for k in range(count):
        if chis[k] < limits[0] and chis[k] <= least + TIE and (best < 0 or near[k] < best):
            best = near[k]
    return best


@compiled
def _settle(state: State, a: int, points: Array, first: Indices, limits: Array) -> None:
    """End points of line a from its points, and its room.

    At any place where two lines with a small chi can meet, their distance is at most
    sqrt(chi2) times the sum of what each may be off there. That much is its room, a tenth more
    for what the linear covariance leaves out, and its share of the gap.
    """
    x, y, alpha = state.lines[a, 0], state.lines[a, 1], state.lines[a, 2]
    c, s, low, high = np.cos(alpha), np.sin(alpha), np.inf, -np.inf
    i = state.members[a, 0]
    while i >= 0:
        for j in range(first[i], first[i + 1]):
            u = (points[j, 1] - y) * c - (points[j, 0] - x) * s
            low, high = min(low, u), max(high, u)
        i = state.after[i]
    gap, off = 0.75 * limits[1], 0.0
    lay(state.ends[a], x, y, -s, c, low, high)
    for u in (low - gap, high + gap):
        rr = state.lines[a, 3] - 2 * u * state.lines[a, 4] + u * u * state.lines[a, 5]
        wide = state.lines[a, 3] + 2 * u * state.lines[a, 4] + u * u * state.lines[a, 5]
        off = max(off, rr, wide)
    state.rooms[a] = 1.1 * np.sqrt(limits[0] * off) + gap


@compiled
def _take_in(state: State, a: int, b: int) -> None:
    """Line a becomes the merge of a and b, which leaves the map; b's members follow a's."""
    merged, lines = _compare(state.lines[a], state.lines[b])[1], state.lines
    lines[a, 0], lines[a, 1], lines[a, 2] = merged[0], merged[1], merged[2]
    lines[a, 3], lines[a, 4], lines[a, 5] = merged[3], merged[4], merged[5]
    state.after[state.members[a, 1]] = state.members[b, 0]
    state.members[a, 1] = state.members[b, 1]
    state.into[b] = a
    leave(state.places, b)


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
    for a in range(begin, stop):
        for k in range(6):
            state.lines[a, k] = fitted[a, k]
        state.members[a, 0], state.members[a, 1] = a, a
        _settle(state, a, points, first, limits)
        b = _best(state, a, limits)
        while b >= 0:
            _take_in(state, a, b)
            _settle(state, a, points, first, limits)
            b = _best(state, a, limits)
        enter(state.places, a, state.ends[a], state.rooms[a])
