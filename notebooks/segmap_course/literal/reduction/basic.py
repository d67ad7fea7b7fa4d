"""Basic (A 4.1, 5.3) as the double loop over all pairs."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..lines import SAME, Found, Segment, axial_difference, line_angle, segment_length, spanning


def match(a: Segment, b: Segment, distance: float, angle: float) -> bool:
    """Whether two end points are nearer than `distance`, and the angles than `angle`; strictly."""
    near = any(math.dist(p, q) < distance - SAME for p in a for q in b)
    return near and abs(axial_difference(line_angle(a), line_angle(b))) < angle - SAME


def merge(a: Segment, b: Segment) -> Segment:
    """Span of all four end points on the mean line of two segments, weighted by length."""
    size_a, size_b = segment_length(a), segment_length(b)
    share = size_b / (size_a + size_b)
    turn = axial_difference(line_angle(b), line_angle(a))
    x, y = ((1 - share) * (a[0][k] + a[1][k]) / 2 + share * (b[0][k] + b[1][k]) / 2 for k in (0, 1))
    direction = line_angle(a) + share * turn
    return spanning(x, y, direction, (*a, *b))


def basic_offline(
    segments: Sequence[Segment], *, distance: float = 0.20, angle: float = math.pi / 18
) -> Found:
    """Basic over the whole map: its scans do not matter."""
    return basic_online(segments, [0] * len(segments), distance=distance, angle=angle)


def basic_online(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    distance: float = 0.20,
    angle: float = math.pi / 18,
) -> Found:
    """After each scan passes over the map until one merges nothing; survivors and parents."""
    went = {i: i for i in range(len(segments)) if segment_length(segments[i]) >= SAME}
    live: dict[int, Segment] = {}
    for scan in sorted(set(scans)):
        live |= {i: segments[i] for i in went if scans[i] == scan}
        while one_pass(live, went, distance, angle):
            pass
    place = {i: k for k, i in enumerate(live)}
    return list(live.values()), [
        place[_last(i, went)] if i in went else -1 for i in range(len(scans))
    ]


def one_pass(live: dict[int, Segment], went: dict[int, int], distance: float, angle: float) -> bool:
    """Each segment in turn takes in all others that match it as it grows; whether any did."""
    merged = False
    for i in list(live):
        for j in list(live):
            if i != j and i in live and j in live and match(live[i], live[j], distance, angle):
                live[i], went[j], merged = merge(live[i], live.pop(j)), i, True
    return merged


def _last(i: int, went: dict[int, int]) -> int:
    while went[i] != i:
        i = went[i]
    return i
