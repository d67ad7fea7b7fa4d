"""Extraction: clusters (A 3.2); split and merge (A 6.2; Gonzalez-Banos and Latombe 2002)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

from .lines import SAME, Line, Point, extreme_projections, line_of, seen_from

Points = Sequence[Point]


def fit_total(points: Points) -> Line:
    """Line with the least sum of squared distances: the mean, and the direction of most spread."""
    n = len(points)
    cx, cy = sum(x for x, _ in points) / n, sum(y for _, y in points) / n
    xx = sum((x - cx) ** 2 for x, _ in points)
    yy = sum((y - cy) ** 2 for _, y in points)
    xy = sum((x - cx) * (y - cy) for x, y in points)
    angle = math.atan2(2 * xy, xx - yy) / 2
    return cx, cy, math.cos(angle), math.sin(angle)


def fit_algebraic(points: Points) -> Line | None:
    """A 3.1-3.3: least squares on `a x + b y = 1`; None for a line through the origin."""
    sx, sy = sum(x for x, _ in points), sum(y for _, y in points)
    xx, yy = sum(x**2 for x, _ in points), sum(y**2 for _, y in points)
    xy = sum(x * y for x, y in points)
    det = xx * yy - xy * xy
    if det <= 1e-12 * (xx + yy) ** 2:
        return None
    a, b = (sx * yy - sy * xy) / det, (sy * xx - sx * xy) / det
    norm = math.hypot(a, b)
    return (a / norm**2, b / norm**2, -b / norm, a / norm) if norm > 0 else None


def cut_at_gaps(points: Points, gap: float) -> list[list[Point]]:
    """Runs of points that are nearer to their neighbour than the gap, metres."""
    runs = [[p] for p in points[:1]]
    for before, point in pairwise(points):
        if math.dist(before, point) >= gap:
            runs.append([])
        runs[-1].append(point)
    return runs


def from_a_gap(points: Points, gap: float) -> Points:
    """A scan all round, from behind its first gap on, else from the point farthest out."""
    points, n = list(points), len(points)
    if n < 3:
        return points
    behind = [k for k in range(n) if math.dist(points[k - 1], points[k]) >= gap]
    middle = [sum(p[k] for p in points) / n for k in (0, 1)]
    k = behind[0] if behind else max(range(n), key=lambda k: math.dist(points[k], middle))
    return points[k:] + points[:k]


def segments_at_gaps(
    points: Points, gap: float = 0.30, fit: Callable[[Points], Line | None] = fit_total
) -> list[list[tuple[float, float]]]:
    """One segment for each run of more than one place (A 3.2)."""
    lines = [(run, fit(run)) for run in cut_at_gaps(points, gap)]
    segments = [extreme_projections(run, line) for run, line in lines if line]
    return [ends for ends in segments if math.dist(*ends) > SAME]


def extract_clusters(
    points: Points, *, gap: float = 0.30, fit: str = "total", closed: bool = False
) -> list[list[tuple[float, float]]]:
    """Segments of the runs, by one of both fits; a scan all round has no seam where closed."""
    ordered = from_a_gap(points, gap) if closed else points
    return segments_at_gaps(ordered, gap, fit_total if fit == "total" else fit_algebraic)


def off_line(point: Point, line: Line) -> float:
    """Distance of a point from a line, metres."""
    return abs(seen_from(line, point)[1])


def split(points: Points, tolerance: float, first: int, last: int) -> list[int]:
    """Cut a run at the point farthest from its chord, again and again: last index of each piece."""
    ends = points[first], points[last]
    if math.dist(*ends) >= SAME:
        chord = line_of(ends)
    else:  # the ends coincide: measure along the points
        _, _, dx, dy = fit_total(points[first : last + 1])
        chord = ends[0][0], ends[0][1], -dy, dx
    far = max(range(first, last + 1), key=lambda k: off_line(points[k], chord))
    if off_line(points[far], chord) <= tolerance or far in (first, last):
        return [last]
    return split(points, tolerance, first, far) + split(points, tolerance, far, last)


def merge(points: Points, tolerance: float, ends: list[int]) -> list[int]:
    """Join the two neighbours that one line fits best, while it fits within tolerance, metres."""
    while len(ends) > 1:
        starts, errors = [0, *ends], []
        for k in range(len(ends) - 1):
            both = points[starts[k] : ends[k + 1] + 1]
            line = fit_total(both)
            errors.append(max(off_line(p, line) for p in both))
        if min(errors) > tolerance:
            break
        best = errors.index(min(errors))
        ends = ends[:best] + ends[best + 1 :]
    return ends


def border(points: Points, first: int, corner: int, last: int) -> int:
    """First point of the second of two pieces that share a corner: each to the nearer wall.

    From the corner on, at most up to the middle of a piece. Beside a piece that is too short for a
    line the corner belongs to the longer one.
    """
    if min(corner - first, last - corner) < 3:
        return corner + (last - corner < corner - first)
    before, after = fit_total(points[first:corner]), fit_total(points[corner + 1 : last + 1])
    is_left = [off_line(p, before) < off_line(p, after) - SAME for p in points]
    if is_left[corner]:
        middle = (corner + last) / 2
        return next(k for k in range(corner + 1, last + 1) if k >= middle or not is_left[k])
    middle = (first + corner) / 2
    return next(k for k in range(corner, first, -1) if k - 1 <= middle or is_left[k - 1])


def extract_polylines(
    points: Points,
    *,
    gap: float = 0.30,
    tolerance: float = 0.03,
    min_points: int = 5,
    min_length: float = 0.10,
    closed: bool = False,
) -> list[list[tuple[float, float]]]:
    """Split each run, merge its pieces, fit a line to each that is large enough."""
    segments = []
    for run in cut_at_gaps(from_a_gap(points, gap) if closed else points, gap):
        ends, start = merge(run, tolerance, split(run, tolerance, 0, len(run) - 1)), 0
        for k, end in enumerate(ends):
            first, last = ends[k - 1] if k else 0, k + 1 == len(ends)
            stop = end + 1 if last else border(run, first, end, ends[k + 1])
            piece, start = run[start:stop], stop
            if len(piece) >= max(min_points, 2):
                segments.append(extreme_projections(piece, fit_total(piece)))
    return [s for s in segments if math.dist(*s) >= min_length]
