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


def take_in(
    live: dict[int, Segment], went: dict[int, int], i: int, distance: float, angle: float
) -> None:
    """A segment takes in, one after another, all others that match it as it grows."""
    for j in list(live):
        if j != i and match(live[i], live[j], distance, angle):
            live[i], went[j] = merge(live[i], live.pop(j)), i


def one_pass(live: dict[int, Segment], went: dict[int, int], distance: float, angle: float) -> bool:
    """Each segment that is still there has its turn; whether any took in another."""
    before = len(live)
    for i in list(live):
        if i in live:
            take_in(live, went, i, distance, angle)
    return len(live) < before


def last(i: int, went: dict[int, int]) -> int:
    """The segment into which another went at last."""
    while went[i] != i:
        i = went[i]
    return i


def basic_online(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    distance: float = 0.20,
    angle: float = math.pi / 18,
) -> Found:
    """After each scan passes over the map until one merges nothing; survivors and parents."""
    went = {i: i for i, s in enumerate(segments) if segment_length(s) >= SAME}
    live: dict[int, Segment] = {}
    for scan in sorted(set(scans)):
        live |= {i: segments[i] for i in went if scans[i] == scan}
        while one_pass(live, went, distance, angle):
            pass
    place = {i: k for k, i in enumerate(live)}
    return list(live.values()), [
        place[last(i, went)] if i in went else -1 for i in range(len(scans))
    ]


def basic_offline(
    segments: Sequence[Segment], *, distance: float = 0.20, angle: float = math.pi / 18
) -> Found:
    """Basic over the whole map: its scans do not matter."""
    return basic_online(segments, [0] * len(segments), distance=distance, angle=angle)
