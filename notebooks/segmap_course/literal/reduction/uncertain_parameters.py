"""Uncertain parameters (A 2.7.8; Amigoni, Fontana, Garigiola 2006): lines with deviations."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..lines import (
    SAME,
    Found,
    Point,
    Segment,
    axial_difference,
    by_scan,
    gap_along,
    line_angle,
    parents_of,
    point_to_segment,
    segment_length,
    spanning,
)
from ..metrics import nearness

#: No fused line is known better than this, metres and radians.
LEAST_RHO, LEAST_THETA = 0.001, 1e-4


@dataclass
class UncertainWall:
    """A segment of the map, the standard deviations of its line, and the inputs it stands for."""

    ends: Segment
    sigma_rho: float
    sigma_theta: float
    members: list[int]


def uncertain(s: Segment, eps: float, i: int) -> UncertainWall:
    """A 2.37: a segment whose points lie within eps, metres, of it."""
    theta = math.asin(min(1.0, 2 * eps / segment_length(s)))
    return UncertainWall(s, max(eps, LEAST_RHO), theta, [i])


def overlap(u: Segment, v: Segment) -> bool:
    """Whether the projections of two segments on the bisector of their lines share a point."""
    at = line_angle(u) + axial_difference(line_angle(v), line_angle(u)) / 2
    return gap_along(u, v, at) <= SAME


def fused(walls: Sequence[UncertainWall], origin: str) -> UncertainWall:
    """One wall for all: weighted means of theta, and of rho about a point near all of them."""
    lengths = [segment_length(wall.ends) for wall in walls]
    shares = [length / sum(lengths) for length in lengths]
    longest = next(k for k, length in enumerate(lengths) if length >= max(lengths) - SAME)
    at = line_angle(walls[longest].ends)
    middles = [[(wall.ends[0][k] + wall.ends[1][k]) / 2 for k in (0, 1)] for wall in walls]
    x, y = (
        sum(share * middle[k] for share, middle in zip(shares, middles, strict=True))
        for k in (0, 1)
    )
    if origin == "map":
        x, y = 0.0, 0.0
    sums = [0.0, 0.0, 0.0, 0.0]
    for wall, share, middle in zip(walls, shares, middles, strict=True):
        turn = axial_difference(line_angle(wall.ends), at)
        rho = (middle[1] - y) * math.cos(at + turn) - (middle[0] - x) * math.sin(at + turn)
        of_rho, of_theta = share / wall.sigma_rho**2, share / wall.sigma_theta**2
        for k, term in enumerate((of_rho * rho, of_rho, of_theta * turn, of_theta)):
            sums[k] += term
    rho, at = sums[0] / sums[1], at + sums[2] / sums[3]
    at_x, at_y = x - rho * math.sin(at), y + rho * math.cos(at)
    ends = spanning(at_x, at_y, at, [p for wall in walls for p in wall.ends])
    known_rho = sum(1 / wall.sigma_rho**2 for wall in walls)
    known_theta = sum(1 / wall.sigma_theta**2 for wall in walls)
    return UncertainWall(
        ends,
        max(known_rho**-0.5, LEAST_RHO),
        max(known_theta**-0.5, LEAST_THETA),
        [i for wall in walls for i in wall.members],
    )


def uncertain_parameters(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    points: Sequence[Sequence[Point]] | None = None,
    distance: float = 0.10,
    angle: float = math.pi / 18,
    eps: float = 0.01,
    origin: str = "pair",
) -> Found:
    """Each new segment becomes one with all segments of the map that it may be a look at."""
    walls: list[UncertainWall] = []
    for i in (i for new in by_scan(segments, scans) for i in new):
        s = segments[i]
        if points is not None:
            eps = max(LEAST_RHO, *(point_to_segment(p, s) for p in points[i]))
        same = [
            k
            for k, wall in enumerate(walls)
            if abs(axial_difference(line_angle(wall.ends), line_angle(s))) < angle - SAME
            and nearness(s, wall.ends) < distance - SAME
            and overlap(s, wall.ends)
        ]
        new = uncertain(s, eps, i)
        if not same:
            walls.append(new)
            continue
        walls[same[0]] = fused([*(walls[k] for k in same), new], origin)
        walls = [wall for k, wall in enumerate(walls) if k not in same[1:]]
    return [wall.ends for wall in walls], parents_of(
        (wall.members for wall in walls), len(segments)
    )
