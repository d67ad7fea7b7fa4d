"""Weighted line fitting (A 2.7.3; Pfister et al. 2003): two looks within what both allow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from ..lines import (
    SAME,
    Found,
    Point,
    Segment,
    axial_difference,
    by_scan,
    extreme_projections,
    gap_along,
    parents_of,
)
from ..points import points_behind, sums_of


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
    ends: Segment
    points: list[Point]
    members: list[int]


def wall_of(line: Line, points: list[Point], members: list[int]) -> Wall:
    """The part of a line that its points span."""
    through = line.x, line.y, -math.sin(line.alpha), math.cos(line.alpha)
    return Wall(line, extreme_projections(points, through), points, members)


def variance(p: Point, s: Point | None, alpha: float, range_: float, bearing: float) -> float:
    """Variance of a point across a line, square metres, seen from s with noise in both."""
    if s is None or (p[0] == s[0] and p[1] == s[1]):
        return range_ * range_
    r, turn = math.hypot(p[0] - s[0], p[1] - s[1]), math.atan2(p[1] - s[1], p[0] - s[0])
    along, across = range_ * math.cos(alpha - turn), bearing * r * math.sin(alpha - turn)
    return along * along + across * across


def fit(points: Sequence[Point], s: Point | None, range_: float, bearing: float) -> Line:
    """The weighted line of the points of one scan, step 1: weights follow from its angle."""
    weights, before = [1.0] * len(points), math.inf
    for _ in range(50):
        sums = sums_of(points, weights)
        x, y, alpha = sums.x, sums.y, sums.direction() + math.pi / 2
        weights = [1 / variance(p, s, alpha, range_, bearing) for p in points]
        if before < math.inf and abs(axial_difference(alpha, before)) < 1e-12:
            break
        before = alpha
    lever = 0.0
    for w, p in zip(weights, points, strict=True):
        t = (p[1] - y) * math.cos(alpha) - (p[0] - x) * math.sin(alpha)
        lever += w * t * t
    return Line(x, y, alpha, 1 / sum(weights), 0.0, 1 / max(lever, 1.0))


def add_pose(line: Line, s: Point | None, place: float, heading: float) -> Line:
    """Step 2, eq. 2.20: what the pose of the scan leaves open; place in metres, heading radians."""
    x, y = s or (line.x, line.y)
    arm = (y - line.y) * math.cos(line.alpha) - (x - line.x) * math.sin(line.alpha)
    turn = heading * heading
    rr = line.rr + place * place + arm * arm * turn
    return Line(line.x, line.y, line.alpha, rr, line.ra + arm * turn, line.aa + turn)


def about(line: Line, x: float, y: float) -> tuple[float, float, float]:
    """Step 3: offset of a line from (x, y), and its covariances `rr`, `ra` about that point."""
    c, s = math.cos(line.alpha), math.sin(line.alpha)
    arm = (line.y - y) * c - (line.x - x) * s
    offset = (line.x - x) * c + (line.y - y) * s
    return offset, line.rr + 2 * arm * line.ra + arm * arm * line.aa, line.ra + arm * line.aa


def compare(a: Line, b: Line) -> tuple[float, Line]:
    """Steps 4 and 5: chi of the difference of two lines, and the line that both make."""
    x, y = (a.x + b.x) / 2, (a.y + b.y) / 2
    (ra, rra, raa), (rb, rrb, rab) = about(a, x, y), about(b, x, y)
    turns = round((a.alpha - b.alpha) / math.pi)
    if turns % 2:
        rb, rab = -rb, -rab
    dr, da = ra - rb, a.alpha - (b.alpha + turns * math.pi)
    rr, r_a, aa = rra + rrb, raa + rab, a.aa + b.aa
    det = rr * aa - r_a * r_a
    u, v = (aa * dr - r_a * da) / det, (rr * da - r_a * dr) / det  # S^-1 dL
    r, alpha = ra - (rra * u + raa * v), a.alpha - (raa * u + a.aa * v)
    f, g = (aa * rrb - r_a * rab) / det, (aa * rab - r_a * b.aa) / det  # S^-1 P_B
    h, k = (rr * rab - r_a * rrb) / det, (rr * b.aa - r_a * rab) / det
    new_rr, new_ra, new_aa = rra * f + raa * h, rra * g + raa * k, raa * g + a.aa * k
    c, s, t = math.cos(alpha), math.sin(alpha), new_ra / new_aa
    centre = x + r * c - t * s, y + r * s + t * c
    return dr * u + da * v, Line(*centre, alpha, new_rr - t * new_ra, 0.0, new_aa)


def gap_between(a: Wall, b: Wall) -> float:
    """Metres between both along the bisector of their lines, 0 where they overlap."""
    turns = round((a.line.alpha - b.line.alpha) / math.pi)
    alpha = (a.line.alpha + b.line.alpha + turns * math.pi) / 2
    return max(0.0, gap_along(a.ends, b.ends, alpha + math.pi / 2))


def weighted_line_fitting(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    points: Sequence[Sequence[Point]] | None = None,
    sensors: Sequence[Point] | None = None,
    chi2: float = 9.21,
    gap: float = 0.30,
    sigma_range: float = 0.01,
    sigma_bearing: float = math.radians(0.25),
    sigma_place: float = 0.03,
    sigma_heading: float = math.radians(0.5),
    turn: float = math.radians(20),
    spacing: float = 0.05,
) -> Found:
    """Each new line takes in the line of the map that agrees best, until none does, step 6."""
    behind, walls = points_behind(segments, points, spacing), list[Wall]()
    for i in (i for new in by_scan(segments, scans) for i in new):
        s = None if sensors is None else sensors[scans[i]]
        line = add_pose(
            fit(behind[i], s, sigma_range, sigma_bearing), s, sigma_place, sigma_heading
        )
        wall = wall_of(line, list(segments[i] if points is None else points[i]), [i])
        while True:
            near = [
                (compare(wall.line, other.line)[0], k)
                for k, other in enumerate(walls)
                if abs(axial_difference(wall.line.alpha, other.line.alpha)) <= turn + SAME
                and gap_between(wall, other) <= gap + SAME
            ]
            near = [(chi, k) for chi, k in near if chi < chi2]
            if not near:
                break
            other = walls.pop(next(k for chi, k in near if chi <= min(near)[0] + 1e-12))
            merged = compare(wall.line, other.line)[1]
            wall = wall_of(merged, wall.points + other.points, wall.members + other.members)
        walls.append(wall)
    walls.sort(key=lambda wall: min(wall.members))
    return [wall.ends for wall in walls], parents_of(
        (wall.members for wall in walls), len(segments)
    )
