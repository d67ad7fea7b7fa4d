"""One to many on-line, and drawn again after a loop (Wen et al. 2020), as plain loops."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..lines import Found, Segment, segment_length, spanning


def heading(segment: Segment) -> float:
    """Direction from first to last end, radians: the two faces of a wall have opposite ones."""
    (ax, ay), (bx, by) = segment
    return math.atan2(by - ay, bx - ax)


def joins(wall: Segment, segment: Segment, distance: float, angle: float) -> bool:
    """Whether a segment lies along a wall, its face turned the same way, and meets or nearly so."""
    if abs(math.remainder(heading(segment) - heading(wall), math.tau)) > angle:
        return False
    (x, y), size, turn = wall[0], segment_length(wall), heading(wall)
    ux, uy = math.cos(turn), math.sin(turn)
    away = [abs(ux * (q - y) - uy * (p - x)) for p, q in segment]
    along = [ux * (p - x) + uy * (q - y) for p, q in segment]
    return max(away) <= distance and min(along) <= size + distance and max(along) >= -distance


def drawn(members: Sequence[Segment]) -> Segment:
    """One wall through the mean of all ends, along the sum of all vectors, as far as all reach."""
    ends = [end for segment in members for end in segment]
    x, y = (sum(end[k] for end in ends) / len(ends) for k in (0, 1))
    along = [sum(b[k] - a[k] for a, b in members) for k in (0, 1)]
    return spanning(x, y, math.atan2(along[1], along[0]), ends)


def one_to_many(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    distance: float = 0.10,
    angle: float = math.radians(4),
) -> Found:
    """A new segment and all walls that it joins become one, drawn from the members of all."""
    members: list[list[int]] = []
    walls: list[Segment] = []
    for i in sorted(range(len(segments)), key=lambda i: scans[i]):
        hit = [joins(wall, segments[i], distance, angle) for wall in walls]
        mine = [m for held, met in zip(members, hit, strict=True) if met for m in held] + [i]
        members = [held for held, met in zip(members, hit, strict=True) if not met] + [mine]
        walls = [wall for wall, met in zip(walls, hit, strict=True) if not met]
        walls.append(drawn([segments[m] for m in mine]))
    place = {m: k for k, held in enumerate(members) for m in held}
    return walls, [place[i] for i in range(len(segments))]


def drawn_again(segments: Sequence[Segment], parents: Sequence[int]) -> list[Segment]:
    """After a loop: each wall anew from its members, which went where their poses went."""
    return [
        drawn([s for s, parent in zip(segments, parents, strict=True) if parent == wall])
        for wall in range(max(parents) + 1)
    ]
