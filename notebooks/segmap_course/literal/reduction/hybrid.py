"""Hybrid (A 4.2, 5.4): a new segment against the whole map; and with Fusion now and then (A 7)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

from ..lines import (
    SAME,
    Found,
    Point,
    Segment,
    by_scan,
    extreme_projections,
    line_angle,
    line_of,
    parents_of,
    seen_from,
    segment_length,
)
from .fusion import Wall, online

#: Point about which the lines of a wall and of a new segment are compared.
Origin = Callable[[Segment, Segment], Point]


def hough(s: Segment, near: float = math.pi / 2, at: Point = (0.0, 0.0)) -> tuple[float, float]:
    """Of the normal from a point to a line: length, metres, and angle, radians, nearest to one."""
    theta = line_angle(s) + math.pi / 2
    theta -= math.pi * math.floor((theta - near) / math.pi + 1 / 2)
    x, y = (s[0][0] + s[1][0]) / 2 - at[0], (s[0][1] + s[1][1]) / 2 - at[1]
    return x * math.cos(theta) + y * math.sin(theta), theta


def nearness(a: Segment, wall: Segment) -> float:
    """Least distance of an end of a from an end of a wall, or from one it lies beside; metres."""
    gaps = [math.dist(p, q) for p in a for q in wall]
    for along, across in (seen_from(line_of(wall), p) for p in a):
        if 0 <= along <= segment_length(wall):
            gaps.append(abs(across))
    return min(gaps)


def agree(wall: Segment, a: Segment, distance: float, angle: float, at: Point) -> bool:
    """Whether the normals from a point to two lines differ by less than a distance and an angle."""
    rho, theta = hough(wall, at=at)
    other_rho, other_theta = hough(a, theta, at)
    return abs(other_rho - rho) < distance - SAME and abs(other_theta - theta) < angle - SAME


def absorbing_wall(
    walls: list[Wall], a: Segment, distance: float, angle: float, origin: Origin
) -> int | None:
    """The number of the nearest wall of which the line agrees; None where none does."""
    gaps = []
    for k, (wall, _) in enumerate(walls):
        gap = nearness(a, wall)
        if gap < distance - SAME and agree(wall, a, distance, angle, origin(wall, a)):
            gaps.append((gap, k))
    return next((k for gap, k in gaps if gap <= min(gaps)[0] + SAME), None)


def absorbed(wall: Segment, count: int, a: Segment, at: Point) -> Segment:
    """A wall that stands for so many and one more: on the mean line, it spans all four ends."""
    rho, theta = hough(wall, at=at)
    other_rho, other_theta = hough(a, theta, at)
    rho = (count * rho + other_rho) / (count + 1)
    theta = (count * theta + other_theta) / (count + 1)
    c, s = math.cos(theta), math.sin(theta)
    return extreme_projections((*wall, *a), (at[0] + rho * c, at[1] + rho * s, -s, c))


def map_origin(wall: Segment, a: Segment) -> Point:
    """The origin of the map, wherever both lie (A 4.2)."""
    return 0.0, 0.0


def pair_origin(wall: Segment, a: Segment) -> Point:
    """Mean of the middles of two segments, weighted by their lengths."""
    share = segment_length(a) / (segment_length(wall) + segment_length(a))
    x, y = ((1 - share) * (p + q) / 2 for p, q in zip(*wall, strict=True))
    u, v = (share * (p + q) / 2 for p, q in zip(*a, strict=True))
    return x + u, y + v


def hybrid_scan(
    walls: list[Wall],
    segments: Sequence[Segment],
    new: list[int],
    distance: float = 0.20,
    angle: float = math.pi / 18,
    min_length: float = 0.10,
    origin: Origin = map_origin,
) -> None:
    """Each new segment goes into a wall of the map, joins the map, or is dropped as too short."""
    for i in new:
        k = absorbing_wall(walls, segments[i], distance, angle, origin)
        if k is not None:
            wall, members = walls[k]
            at = origin(wall, segments[i])
            walls[k] = absorbed(wall, len(members), segments[i], at), [*members, i]
        elif segment_length(segments[i]) >= min_length:
            walls.append((segments[i], [i]))


ORIGINS = {"map": map_origin, "pair": pair_origin}


def hybrid(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    distance: float = 0.20,
    angle: float = math.pi / 18,
    min_length: float = 0.10,
    origin: str = "map",
) -> Found:
    """Scan after scan into the map."""
    walls: list[Wall] = []
    for new in by_scan(segments, scans):
        hybrid_scan(walls, segments, new, distance, angle, min_length, ORIGINS[origin])
    return [wall for wall, _ in walls], parents_of((those for _, those in walls), len(segments))


def hybrid_fusion(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    distance: float = 0.20,
    angle: float = math.pi / 18,
    min_length: float = 0.10,
    origin: str = "map",
    tolerance: float = 0.04,
    every: int = 50,
) -> Found:
    """Hybrid; Fusion of its whole map after every so many scans and after the last (A 7)."""
    take = partial(
        hybrid_scan,
        distance=distance,
        angle=angle,
        min_length=min_length,
        origin=ORIGINS[origin],
    )
    walls = online(segments, by_scan(segments, scans), take, every, tolerance)
    return [ends for ends, _ in walls], parents_of((those for _, those in walls), len(segments))
