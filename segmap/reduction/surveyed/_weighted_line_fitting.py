"""Weighted line fitting (A 2.7.3; Pfister et al. 2003): two looks within what both allow."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from ...arrays import Array, Metres, Positive, Radians, Segments, at_least, at_most, checked
from ...compiled import compiled
from ...kernels import gap_along, place_on_line
from .._points import points_behind
from .._runner import (
    Indices,
    Length,
    Reduction,
    Rows,
    Steps,
    Turn,
    ordered_by_first_input,
    resolve_merges,
    run_online,
)
from .lines import SAME

#: Chis closer than this are equal; a line rests when its angle moves by less, radians.
TIE = REST = 1e-12
#: More segments take more than ten seconds: it warns.
MOST_SEGMENTS = 60_000
#: A line is fitted so often at most.
MOST_FITS = 50


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

    The pose term decides how much merges, and it is a guess: of the 1226 segments of the bundled
    Malaga 436 are left with the noise of the sensor alone, and 246 with the defaults. A names no
    test of extent, so two far walls on one line would merge: that is what `gap` is for. The
    covariance is the exact inverse about the centre of the points; the closed form of the paper
    leaves the lever of the centre out. A runs it off-line too: with all segments in one scan.

    Each new line is compared with all lines of the map: the cost grows with the square of the
    segments, 16 s for 80 000. Maps with more than 60 000 are warned of.

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
    >>> reduction = weighted_line_fitting(wall)
    >>> reduction, reduction.parents
    (Reduction(weighted_line_fitting: 3 -> 2 segments), array([0, 0, 1]))
    """
    noise = sigma_range, sigma_bearing, sigma_place, sigma_heading

    def steps(rows: Rows) -> Steps:
        s, count, live = rows.segments, len(rows.segments), 0
        points, first, sensors, has_points = points_behind(map, rows, spacing)
        numbers, lines = np.arange(count), np.empty((count, 6))
        fitted_lines(points, first, sensors, noise, lines)
        if not has_points:
            points, first = s.reshape(-1, 2), 2 * np.arange(count + 1)
        walls = Walls(lines, s.copy(), numbers, numbers.copy(), numbers.copy(), np.empty(count))
        for begin, stop in rows.scans():
            live = take_in(walls, live, begin, stop, points, first, (chi2, gap, turn))
            yield live
        alive, into = resolve_merges(walls.into)
        order, into = ordered_by_first_input(into, rows.source_row, live)
        return walls.ends[alive][order], into

    return run_online("weighted_line_fitting", map, steps, most_segments=MOST_SEGMENTS)


#: Of chi, of the gap, metres, and of the turn, radians.
Limits = tuple[float, float, float]
#: Of ranges, metres, and bearings, radians; of places, metres, and headings, radians.
Noise = tuple[float, float, float, float]
#: Of (offset, angle): square metres, metres times radians, square radians.
Covariance = tuple[float, float, float]


class Line(NamedTuple):
    """Centre, metres, angle of the normal, radians, and covariance of (offset, angle) about it."""

    x: float
    y: float
    alpha: float
    rr: float
    ra: float
    aa: float


class Walls(NamedTuple):
    """Lines, each with the number of the last segment that went into it; lengths are in metres."""

    lines: Array  # (n, 6) rows of a `Line`
    ends: Array  # (n, 2, 2) the part that its points span
    into: Indices  # the line that took it in; itself where none has
    after: Indices  # the next segment of the same line, round to the first again
    alive: Indices  # those of the map, ascending, come first
    chis: Array  # room for how well each agrees with another


@compiled
def take_in(
    walls: Walls, live: int, begin: int, stop: int, points: Array, first: Indices, limits: Limits
) -> int:
    """Each line of a scan takes in those of the map that agree, and joins it: how many it has."""
    into, after, alive = walls.into, walls.after, walls.alive
    for i in range(begin, stop):
        span_points(walls, i, points, first)
        at = agreeing_line(walls, i, live, limits)
        while at >= 0:
            k, live = alive[at], live - 1
            for n in range(at, live):
                alive[n] = alive[n + 1]
            into[k], after[i], after[k] = i, after[k], after[i]
            write(walls.lines[i], compare(line_of(walls.lines[i]), line_of(walls.lines[k]))[1])
            span_points(walls, i, points, first)
            at = agreeing_line(walls, i, live, limits)
        alive[live] = i
        live += 1
    return live


@compiled
def span_points(walls: Walls, i: int, points: Array, first: Indices) -> None:
    """Write the part of a line that the points of its segments span."""
    a, low, high, j = line_of(walls.lines[i]), np.inf, -np.inf, walls.after[i]
    dx, dy, has_more = -np.sin(a.alpha), np.cos(a.alpha), True
    while has_more:
        for k in range(first[j], first[j + 1]):
            u = (points[k, 0] - a.x) * dx + (points[k, 1] - a.y) * dy
            low, high = min(low, u), max(high, u)
        has_more, j = j != i, walls.after[j]
    place_on_line(walls.ends[i], (a.x, a.y, dx, dy), low, high)


@compiled
def line_of(row: Array) -> Line:
    """A row of lines."""
    return Line(row[0], row[1], row[2], row[3], row[4], row[5])


@compiled
def write(row: Array, line: Line) -> None:
    """Make a line a row of lines."""
    row[0], row[1], row[2], row[3], row[4], row[5] = line


@compiled
def variance(p: Array, s: Array, alpha: float, range_: float, bearing: float) -> float:
    """Variance of a point across a line, square metres, seen from s with noise in both."""
    dx, dy = p[0] - s[0], p[1] - s[1]
    square = dx * dx + dy * dy
    if not square > 0.0:  # the sensor stood there, or nobody knows where: s is NaN
        return range_ * range_
    c, s_ = np.cos(alpha), np.sin(alpha)
    along, across = range_ * (dx * c + dy * s_), bearing * (dy * c - dx * s_)
    return along * along / square + across * across


@compiled
def weighted_line(points: Array, weights: Array) -> tuple[float, float, float]:
    """Weighted mean of points, x and y, and the angle of the normal of the line that fits best."""
    total = x = y = xx = xy = yy = 0.0
    for i in range(len(points)):
        w, p = weights[i], points[i]
        total, x, y = total + w, x + w * p[0], y + w * p[1]
    x, y = x / total, y / total
    for i in range(len(points)):
        w, u, v = weights[i], points[i, 0] - x, points[i, 1] - y
        xx, xy, yy = xx + w * u * u, xy + w * u * v, yy + w * v * v
    return x, y, 0.5 * np.arctan2(2 * xy, xx - yy) + np.pi / 2


@compiled
def fit(points: Array, s: Array, range_: float, bearing: float) -> Line:
    """Step 1: the line of points seen from s, or NaN; the weights follow from its angle."""
    weights, before = np.full(len(points), 1.0), np.nan
    for _ in range(MOST_FITS):
        x, y, alpha = weighted_line(points, weights)
        for i in range(len(points)):
            weights[i] = 1 / variance(points[i], s, alpha, range_, bearing)
        if abs((alpha - before + np.pi / 2) % np.pi - np.pi / 2) < REST:
            break
        before = alpha
    lever = total = 0.0
    for i in range(len(points)):
        t = (points[i, 1] - y) * np.cos(alpha) - (points[i, 0] - x) * np.sin(alpha)
        lever, total = lever + weights[i] * t * t, total + weights[i]
    return Line(x, y, alpha, 1 / total, 0.0, 1 / max(lever, 1.0))


@compiled
def fitted_lines(points: Array, first: Indices, sensors: Array, noise: Noise, lines: Array) -> None:
    """Write the line of each segment, steps 1 and 2, into rows `(n, 6)`."""
    for i in range(len(lines)):
        line = fit(points[first[i] : first[i + 1]], sensors[i], noise[0], noise[1])
        write(lines[i], add_pose(line, sensors[i], noise[2], noise[3]))


@compiled
def add_pose(line: Line, s: Array, place: float, heading: float) -> Line:
    """Step 2, eq. 2.20: what the pose of the scan leaves open; place in metres, heading radians."""
    x, y = (line.x, line.y) if np.isnan(s[0]) else (s[0], s[1])
    arm = (y - line.y) * np.cos(line.alpha) - (x - line.x) * np.sin(line.alpha)
    turn = heading * heading
    rr = line.rr + place * place + arm * arm * turn
    return Line(line.x, line.y, line.alpha, rr, line.ra + arm * turn, line.aa + turn)


@compiled
def about(line: Line, x: float, y: float) -> tuple[float, float, float]:
    """Step 3: offset of a line from (x, y), and its covariances `rr`, `ra` about that point."""
    c, s = np.cos(line.alpha), np.sin(line.alpha)
    arm = (line.y - y) * c - (line.x - x) * s
    offset = (line.x - x) * c + (line.y - y) * s
    return offset, line.rr + 2 * arm * line.ra + arm * arm * line.aa, line.ra + arm * line.aa


@compiled
def solved(p: Covariance, u: float, v: float) -> tuple[float, float]:
    """The inverse of a covariance times a vector (u, v)."""
    det = p[0] * p[2] - p[1] * p[1]
    return (p[2] * u - p[1] * v) / det, (p[0] * v - p[1] * u) / det


@compiled
def difference(a: Line, b: Line) -> tuple[float, float, float, Covariance, Covariance]:
    """Step 4, amid both centres: offset of a, what a differs from b, and both covariances."""
    x, y = (a.x + b.x) / 2, (a.y + b.y) / 2
    (ra, rra, raa), (rb, rrb, rab) = about(a, x, y), about(b, x, y)
    turns = round((a.alpha - b.alpha) / np.pi)
    da, sign = a.alpha - (b.alpha + turns * np.pi), 1 - turns % 2 * 2  # the normal may be turned
    return ra, ra - sign * rb, da, (rra, raa, a.aa), (rrb, sign * rab, b.aa)


@compiled
def compare(a: Line, b: Line) -> tuple[float, Line]:
    """Steps 4 and 5: chi of the difference of two lines, and the line that both make."""
    offset, dr, da, p, q = difference(a, b)
    both = p[0] + q[0], p[1] + q[1], p[2] + q[2]
    u, v = solved(both, dr, da)
    r, alpha = offset - (p[0] * u + p[1] * v), a.alpha - (p[1] * u + p[2] * v)
    (f, h), (g, k) = solved(both, q[0], q[1]), solved(both, q[1], q[2])
    rr, ra, aa = p[0] * f + p[1] * h, p[0] * g + p[1] * k, p[1] * g + p[2] * k
    x, y, t = (a.x + b.x) / 2, (a.y + b.y) / 2, ra / aa
    x, y = x + r * np.cos(alpha) - t * np.sin(alpha), y + r * np.sin(alpha) + t * np.cos(alpha)
    return dr * u + da * v, Line(x, y, alpha, rr - t * ra, 0.0, aa)


@compiled
def agreeing_line(walls: Walls, i: int, live: int, limits: Limits) -> int:
    """Position in `walls.alive` of the line with the smallest chi to line i.

    -1 if none near it is below the limit; of equal ones the first.
    """
    a, own, chis, least = line_of(walls.lines[i]), walls.ends[i], walls.chis, np.inf
    for n in range(live):
        b, chis[n] = line_of(walls.lines[walls.alive[n]]), np.inf
        turns = np.rint((a.alpha - b.alpha) / np.pi)
        if abs(a.alpha - b.alpha - turns * np.pi) <= limits[2] + SAME:
            mean, ends = (a.alpha + b.alpha + turns * np.pi) / 2, walls.ends[walls.alive[n]]
            if gap_along(own, ends, -np.sin(mean), np.cos(mean)) <= limits[1] + SAME:
                chis[n] = compare(a, b)[0]
                least = min(least, chis[n])
    for n in range(live):
        if chis[n] < limits[0] and chis[n] <= least + TIE:
            return n
    return -1
