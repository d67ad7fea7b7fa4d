"""Weighted line fitting (A 2.7.3; Pfister et al. 2003): two looks within what both allow."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, Metres, Positive, Radians, Segments, at_least, at_most, checked
from ...compiled import compiled
from ...kernels import gap_along
from .._points import points_behind
from .._runner import Length, Reduction, Rows, Steps, Turn, ordered_by_first_input, run_online
from .lines import SAME, Point, parents_of

#: Chis closer than this are equal; a line rests when its angle moves by less, radians.
TIE = REST = 1e-12
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

    Each new line is compared with all lines of the map, and keeps all points of its own: the cost
    grows with the power 1.7 of the segments, 24 s for 80 000, and 1.6 of the looks at each wall.

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
    limits = np.array([chi2, gap, turn])

    def steps(rows: Rows) -> Steps:
        points, first, sensors, has_points = points_behind(map, rows, spacing)
        walls, lines = list[Wall](), np.empty((len(rows.segments), 6))
        ends = np.empty((len(rows.segments), 2, 2))
        for begin, stop in rows.scans():
            for i in range(begin, stop):
                behind, s = points[first[i] : first[i + 1]], sensors[i].tolist()
                line = fit(behind, s, sigma_range, sigma_bearing)
                line = add_pose(line, s, sigma_place, sigma_heading)
                wall = wall_of(line, behind if has_points else rows.segments[i], [i])
                count = len(walls)
                while (k := agreeing_line(wall.line, wall.ends, lines[:count], ends, limits)) >= 0:
                    other, count = walls.pop(k), count - 1
                    for array in (lines, ends):
                        array[k:count] = array[k + 1 : count + 1]
                    merged = compare(wall.line, other.line)[1]
                    both = np.concatenate([wall.points, other.points])
                    wall = wall_of(merged, both, wall.members + other.members)
                walls.append(wall)
                lines[count], ends[count] = wall.line, wall.ends
            yield len(walls)
        into = parents_of((wall.members for wall in walls), len(rows.segments))
        order, into = ordered_by_first_input(into, rows.source_row, len(walls))
        return ends[: len(walls)][order], into

    return run_online("weighted_line_fitting", map, steps)


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


class Wall(NamedTuple):
    """A line of the map, its part that its points span, and the segments that it stands for."""

    line: Line
    ends: Array
    points: Array
    members: list[int]


def wall_of(line: Line, points: Array, members: list[int]) -> Wall:
    """The part of a line that its points span."""
    along = np.array([-math.sin(line.alpha), math.cos(line.alpha)])
    u = (points - (line.x, line.y)) @ along
    ends = np.array([u.min(), u.max()])[:, None] * along + (line.x, line.y)
    return Wall(line, ends, points, members)


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
def fitted(points: Array, s: Array, range_: float, bearing: float) -> Line:
    """The weighted line of the points of one scan, step 1: weights follow from its angle."""
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


def fit(points: ArrayLike, s: Point, range_: float, bearing: float) -> Line:
    """Step 1: the line of points, metres, seen from s; NaN where nobody knows from where."""
    return fitted(np.array(points, float), np.array(s, float), range_, bearing)


def add_pose(line: Line, s: Point, place: float, heading: float) -> Line:
    """Step 2, eq. 2.20: what the pose of the scan leaves open; place in metres, heading radians."""
    x, y = s if not math.isnan(s[0]) else (line.x, line.y)
    arm = (y - line.y) * math.cos(line.alpha) - (x - line.x) * math.sin(line.alpha)
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
def agreeing_line(a: Line, own: Array, lines: Array, ends: Array, limits: Array) -> int:
    """The line with the smallest chi below the limit, of those near; ties: the first; -1: none.

    Lines of the map are rows of a `Line`; the limits are of chi, of the gap and of the turn.
    """
    chis, least = np.full(len(lines), np.inf), np.inf
    for k in range(len(lines)):
        b = Line(lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3], lines[k, 4], lines[k, 5])
        turns = round((a.alpha - b.alpha) / np.pi)
        if abs(a.alpha - b.alpha - turns * np.pi) <= limits[2] + SAME:
            mean = (a.alpha + b.alpha + turns * np.pi) / 2
            if gap_along(own, ends[k], -np.sin(mean), np.cos(mean)) <= limits[1] + SAME:
                chis[k] = compare(a, b)[0]
                least = min(least, chis[k])
    for k in range(len(lines)):
        if chis[k] < limits[0] and chis[k] <= least + TIE:
            return k
    return -1
