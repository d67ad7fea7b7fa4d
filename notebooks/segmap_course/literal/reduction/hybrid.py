"""Hybrid (A 4.2, 5.4): a new segment against the whole map; and with Fusion now and then (A 7)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from ..lines import (
    SAME,
    Found,
    Segment,
    by_scan,
    extreme_projections,
    line_angle,
    line_of,
    parents_of,
    seen_from,
    segment_length,
)
from .fusion import Wall as FusedWall
from .fusion import online


@dataclass
class Wall:
    """A segment of the map, its line in Hough space, and how many segments it stands for."""

    ends: Segment
    rho: float
    theta: float
    count: int = 1


def hough(s: Segment) -> tuple[float, float]:
    """Distance of the origin from a line, metres, and angle of its normal, in `[0, pi)` radians."""
    theta = (line_angle(s) + math.pi / 2) % math.pi
    x, y = (s[0][0] + s[1][0]) / 2, (s[0][1] + s[1][1]) / 2
    return x * math.cos(theta) + y * math.sin(theta), theta


def nearness(a: Segment, b: Segment) -> float:
    """Least distance of an end of a from an end of b, or from b where it lies beside it; metres."""
    found = [math.dist(p, q) for p in a for q in b]
    for along, across in (seen_from(line_of(b), p) for p in a):
        if 0 <= along <= segment_length(b):
            found.append(abs(across))
    return min(found)


def between(a: Segment, b: Segment) -> tuple[float, float]:
    """Mean of the middles of two segments, weighted by their lengths."""
    share = segment_length(b) / (segment_length(a) + segment_length(b))
    x, y = ((1 - share) * (p + q) / 2 for p, q in zip(*a, strict=True))
    u, v = (share * (p + q) / 2 for p, q in zip(*b, strict=True))
    return x + u, y + v


def rho_about(x: float, y: float, rho: float, theta: float) -> float:
    """Distance of a point from a line, where the origin is at rho."""
    return rho - x * math.cos(theta) - y * math.sin(theta)


def absorbing_wall(
    walls: list[Wall], a: Segment, distance: float, angle: float, origin: str
) -> tuple[int, float, float] | None:
    """The nearest wall whose line agrees, and the line of a by the name nearest to its; or None."""
    rho, theta = hough(a)
    found = []
    for k, wall in enumerate(walls):
        turns = round((wall.theta - theta) / math.pi)
        r, t = rho if turns % 2 == 0 else -rho, theta + turns * math.pi
        near = nearness(a, wall.ends)
        x, y = between(wall.ends, a) if origin == "pair" else (0.0, 0.0)
        apart = rho_about(x, y, wall.rho, wall.theta) - rho_about(x, y, r, t)
        far = max(near, abs(apart))
        if far < distance - SAME and abs(wall.theta - t) < angle - SAME:
            found.append((near, k, r, t))
    least = min(found)[0] if found else 0.0
    return next((entry[1:] for entry in found if entry[0] <= least + SAME), None)


def absorb(wall: Wall, a: Segment, rho: float, theta: float, origin: str) -> None:
    """The line becomes the mean of all that the wall stands for; it spans all four end points."""
    x, y = between(wall.ends, a) if origin == "pair" else (0.0, 0.0)
    old, new = rho_about(x, y, wall.rho, wall.theta), rho_about(x, y, rho, theta)
    mean = (wall.count * old + new) / (wall.count + 1)
    wall.theta = (wall.count * wall.theta + theta) / (wall.count + 1)
    wall.rho = rho_about(-x, -y, mean, wall.theta)
    wall.count += 1
    c, s = math.cos(wall.theta), math.sin(wall.theta)
    wall.ends = extreme_projections((*wall.ends, *a), (wall.rho * c, wall.rho * s, -s, c))


def take_scan(
    walls: list[Wall],
    parents: list[int],
    segments: Sequence[Segment],
    new: list[int],
    thresholds: tuple[float, float, float],
    origin: str,
) -> None:
    """Each new segment goes into a wall of the map, joins the map, or is dropped as too short."""
    distance, angle, min_length = thresholds
    for i in new:
        found = absorbing_wall(walls, segments[i], distance, angle, origin)
        if found is not None:
            parents[i] = found[0]
            absorb(walls[found[0]], segments[i], *found[1:], origin)
        elif segment_length(segments[i]) >= min_length:
            parents[i] = len(walls)
            walls.append(Wall(segments[i], *hough(segments[i])))


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
    parents = [-1] * len(segments)
    for new in by_scan(segments, scans):
        take_scan(walls, parents, segments, new, (distance, angle, min_length), origin)
    return [wall.ends for wall in walls], parents


def hybrid_scan(
    walls: list[FusedWall],
    segments: Sequence[Segment],
    new: list[int],
    distance: float = 0.20,
    angle: float = math.pi / 18,
    min_length: float = 0.10,
    origin: str = "map",
) -> None:
    """Hybrid takes a scan into walls that know their members, as many as they count."""
    lines = [Wall(ends, *hough(ends), len(members)) for ends, members in walls]
    parents = [-1] * len(segments)
    take_scan(lines, parents, segments, new, (distance, angle, min_length), origin)
    members = [list(those) for _, those in walls] + [[] for _ in lines[len(walls) :]]
    for i in new:
        if parents[i] >= 0:
            members[parents[i]].append(i)
    walls[:] = zip((wall.ends for wall in lines), members, strict=True)


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
        hybrid_scan, distance=distance, angle=angle, min_length=min_length, origin=origin
    )
    walls = online(segments, by_scan(segments, scans), take, every, tolerance)
    return [ends for ends, _ in walls], parents_of((those for _, those in walls), len(segments))
