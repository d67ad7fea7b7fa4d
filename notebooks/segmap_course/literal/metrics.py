"""Segment distance and quality (A 2.7.7, 6.2.2), term by term."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from .lines import (
    SAME,
    Point,
    Segment,
    axial_difference,
    extreme_projections,
    line_angle,
    line_of,
    point_to_segment,
    seen_from,
    segment_length,
)


def mean_directions(u: Segment, v: Segment, share: float = 0.5) -> list[float]:
    """Direction of the line midway, radians: both of them where the segments are perpendicular."""
    at_u, at_v = line_angle(u), line_angle(v)
    if min(segment_length(u), segment_length(v)) < SAME:  # a point takes the other's direction
        return [at_u if segment_length(u) >= SAME else at_v]
    turn = axial_difference(at_v, at_u)
    turns = [turn] if abs(abs(turn) - math.pi / 2) > 1e-9 else [math.pi / 2, -math.pi / 2]
    return [at_u + share * turn for turn in turns]


def turned(u: Segment, v: Segment, direction: float, share: float = 0.5) -> float:
    """Length times tangent of the angle to the line midway, the mean of both, metres."""
    return sum(
        part * segment_length(s) * math.tan(abs(axial_difference(line_angle(s), direction)))
        for part, s in ((1 - share, u), (share, v))
    )


def mean_middle(u: Segment, v: Segment, share: float = 0.5) -> Point:
    """The mean of both middles, metres: the line midway passes through it."""
    x, y = ((1 - share) * (u[0][k] + u[1][k]) / 2 + share * (v[0][k] + v[1][k]) / 2 for k in (0, 1))
    return x, y


def shifted(u: Segment, v: Segment, direction: float, share: float = 0.5) -> float:
    """The largest distance of an end from the line midway, metres."""
    (x, y), dx, dy = mean_middle(u, v, share), math.cos(direction), math.sin(direction)
    return max(abs((p[1] - y) * dx - (p[0] - x) * dy) for p in (*u, *v))


def apart(u: Segment, v: Segment) -> float:
    """The least distance from an end of one segment to the other one, metres."""
    return min(*(point_to_segment(p, v) for p in u), *(point_to_segment(p, u) for p in v))


def segments_apart(u: Segment, v: Segment) -> float:
    """Smallest distance between two segments, 0 where they cross."""

    def side(s: Segment, p: Point) -> float:
        (x, y), (ex, ey) = s
        return (ex - x) * (p[1] - y) - (ey - y) * (p[0] - x)

    if side(u, v[0]) * side(u, v[1]) < 0 and side(v, u[0]) * side(v, u[1]) < 0:
        return 0.0
    return apart(u, v)


def line_cost(u: Segment, v: Segment, direction: float, share: float = 0.5) -> float:
    """What a line midway costs: the weighted sum of *turned* and *shifted*, metres."""
    return 0.66 * turned(u, v, direction, share) + 0.09 * shifted(u, v, direction, share)


def segment_distance(u: Segment, v: Segment, weight_u: float = 1.0, weight_v: float = 1.0) -> float:
    """`0.66 turned + 0.09 shifted + 0.25 apart`, metres; of two lines midway the cheaper one."""
    share = weight_v / (weight_u + weight_v)
    costs = [line_cost(u, v, direction, share) for direction in mean_directions(u, v, share)]
    return min(costs) + 0.25 * apart(u, v)


def quality(before: Sequence[Segment], after: Sequence[Segment], *, scale: float = 0.050) -> float:
    """`exp(-mean distance to the nearest segment left / scale)`; scale in metres."""
    walls = [s for s in before if segment_length(s) >= SAME]  # what has no length is no wall
    if len(walls) == 0:
        return 1.0 if len(before) or len(after) else math.nan
    if len(after) == 0:
        return 0.0
    mean = sum(min(segment_distance(s, t) for t in after) for s in walls) / len(walls)
    return math.exp(-mean / scale)


def joined_walls(walls: Sequence[Segment]) -> list[Segment]:
    """Longest first: walls whose ends lie within 1 mm of its line, and that touch it, join it."""
    rest = sorted((w for w in walls if segment_length(w) >= SAME), key=segment_length, reverse=True)
    joined: list[Segment] = []
    while rest:
        wall: Segment = rest.pop(0)
        while True:
            line, size = line_of(wall), segment_length(wall)
            for other in rest:
                seen = [seen_from(line, p) for p in other]
                low, high = min(a for a, _ in seen), max(a for a, _ in seen)
                if max(abs(o) for _, o in seen) <= 1e-3 and low <= size + 1e-3 and high >= -1e-3:
                    wall = extreme_projections((*wall, *other), line)
                    rest.remove(other)
                    break
            else:
                break
        joined.append((wall[0], wall[1]))
    return joined


def beside(wall: Segment, s: Segment, distance: float, angle: float) -> tuple[float, float] | None:
    """From which share of a segment to which it lies beside a wall; None where nowhere."""
    line, size, length = line_of(wall), segment_length(wall), segment_length(s)
    (a, o), (b, p) = (seen_from(line, point) for point in s)
    if abs(p - o) / length > max(math.sin(angle), min(0.5, distance / 2 / length)):
        return None
    start, end = 0.0, 1.0
    for at, to, low, high in ((a, b, 0.0, size), (o, p, -distance, distance)):
        if at != to:
            first, last = sorted(((low - at) / (to - at), (high - at) / (to - at)))
            start, end = max(start, first), min(end, last)
        elif not low <= at <= high:
            return None
    return (start, end) if (end - start) * length > SAME else None


def squared_offset(wall: Segment, s: Segment, a: float, b: float) -> float:
    """Mean squared distance of a piece of a segment, from share to share, from a wall's line."""
    o, p = (seen_from(line_of(wall), point)[1] for point in s)
    u, v = o + a * (p - o), o + b * (p - o)
    return (u * u + u * v + v * v) / 3


def owned_pieces(
    walls: Sequence[Segment], s: Segment, distance: float, angle: float
) -> list[tuple[float, float, int, float]]:
    """A segment in pieces: from and to, as shares; the wall, -1 for none; mean squared offset."""
    parts = {k: beside(wall, s, distance, angle) for k, wall in enumerate(walls)}
    spans = {k: part for k, part in parts.items() if part}
    cuts, pieces = [0.0], []
    for cut in sorted([1.0, *(end for span in spans.values() for end in span)]):
        if (cut - cuts[-1]) * segment_length(s) > SAME:
            cuts.append(cut)
    for a, b in pairwise([*cuts[:-1], 1.0]):
        near = [k for k, (start, end) in spans.items() if start <= (a + b) / 2 <= end]
        offsets = [(squared_offset(walls[k], s, a, b), k) for k in near]
        square, owner = min(offsets, key=lambda o: round(o[0], 12), default=(0.0, -1))
        pieces.append((a, b, owner, square))
    return pieces


def covered(spans: Sequence[tuple[float, float]]) -> float:
    """Metres that lie in at least one of some spans."""
    metres, reached = 0.0, -math.inf
    for low, high in sorted(map(tuple, spans)):
        metres += max(0.0, high - max(low, reached))
        reached = max(reached, high)
    return metres


def spans_along(
    walls: Sequence[Segment], segments: Sequence[Segment], distance: float, angle: float
) -> tuple[list[list[tuple[float, float]]], float]:
    """From where to where along each wall segments lie, and metres of them beside no wall."""
    spans: list[list[tuple[float, float]]] = [[] for _ in walls]
    invented = 0.0
    for s in segments:
        for a, b, k, _ in owned_pieces(walls, s, distance, angle):
            if k < 0:
                invented += (b - a) * segment_length(s)
            else:
                at, to = (seen_from(line_of(walls[k]), p)[0] for p in s)
                low, high = sorted((at + a * (to - at), at + b * (to - at)))
                spans[k].append((low, high))
    return spans, invented


def against_walls(
    walls: Sequence[Segment],
    map: Sequence[Segment],
    *,
    seen: Sequence[Segment] | None = None,
    distance: float = 0.10,
    angle: float = math.radians(5),
    least: float = 0.10,
) -> dict[str, float]:
    """What a map keeps of the true walls, misses, invents and has twice, in metres."""
    whole = joined_walls(walls)
    looks, drawn = ([s for s in m if segment_length(s) >= SAME] for m in (seen or [], map))
    views, _ = spans_along(whole, looks, distance, angle)
    spans, invented = spans_along(whole, drawn, distance, angle)
    squares = turns = metres = 0.0
    wall_numbers = set()
    for s in drawn:
        length, mine = segment_length(s), [0.0] * len(whole)
        for a, b, k, square in owned_pieces(whole, s, distance, angle):
            if k >= 0:
                o, p = (seen_from(line_of(whole[k]), point)[1] for point in s)
                mine[k] += (b - a) * length
                metres += (b - a) * length
                squares += (b - a) * length * square
                turns += (b - a) * length * math.asin((p - o) / length) ** 2
        if max(mine) > 0:
            wall_numbers.add(mine.index(max(mine)))
    if seen is None:
        views = [[(0.0, segment_length(w))] for w in whole]
    counts = [
        covered(each) >= min(least, segment_length(w)) - SAME
        for w, each in zip(whole, views, strict=True)
    ]
    both = [covered(a) + covered(b) - covered([*a, *b]) for a, b in zip(views, spans, strict=True)]
    return {
        "missed": sum(covered(a) for a in views) - sum(both),
        "invented": invented,
        "doubled": sum(b - a for each in spans for a, b in each)
        - sum(covered(each) for each in spans),
        "per_wall": sum(segment_length(s) >= SAME for s in map) / sum(counts),
        "found": sum(counts[k] for k in wall_numbers) / sum(counts),
        "offset": math.sqrt(squares / metres) if metres else math.nan,
        "angle": math.sqrt(turns / metres) if metres else math.nan,
    }
