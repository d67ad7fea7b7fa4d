"""Fuzzy set (A 2.7.4; Lopez-Sanchez et al. 1998): rectangles along the axes of a building."""

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
    line_angle,
    parents_of,
    placed,
    segment_length,
)


@dataclass
class Rectangle:
    """Where a wall along an axis may lie: its line `across`, from low to high along it, metres.

    `e` is the error across, `e1` and `e2` those of the end points along.
    """

    upright: bool
    across: float
    low: float
    high: float
    e: float
    e1: float
    e2: float
    members: list[int]


def main_axis(segments: Sequence[Segment]) -> float:
    """Direction of the walls of an orthogonal building, radians: the mean of four times theirs."""
    pairs = [(segment_length(s), 4 * line_angle(s)) for s in segments]
    sums = [sum(w * f(a) for w, a in pairs) for f in (math.sin, math.cos)]
    rounding = SAME * sum(w for w, _ in pairs)
    sine, cosine = (v if abs(v) > rounding else 0.0 for v in sums)
    return math.atan2(sine, cosine) / 4


def turned(points: Sequence[Point], angle: float) -> list[tuple[float, float]]:
    """Points turned about the origin."""
    return [placed(p, (0.0, 0.0, angle)) for p in points]


def laid(
    i: int, s: Segment, points: Sequence[Point] | None, error: float, angle: float
) -> Rectangle | None:
    """Step 2: a segment near an axis, laid on it; None for one that is slanted."""
    off = axial_difference(line_angle(s), 0.0)
    upright = abs(off) > math.pi / 4 + SAME
    off = abs(axial_difference(line_angle(s), math.pi / 2 if upright else 0.0))
    if off > angle + SAME:
        return None
    a, b = (0, 1) if upright else (1, 0)
    across = (s[0][a] + s[1][a]) / 2
    low, high = sorted((s[0][b], s[1][b]))
    e = error + segment_length(s) / 2 * math.sin(off)
    if points is not None:
        e = max(error, *(abs(p[a] - across) for p in points))
    return Rectangle(upright, across, low, high, e, error, error, [i])


def whole(value: float) -> int:
    """Metres as whole nanometres: what differs by rounding is equal."""
    return math.floor(value * 1e9 + 0.5)


def order(r: Rectangle) -> tuple[int, int, int]:
    """Step 4: the precise ones first."""
    return whole(r.e), whole(r.e1 + r.e2), min(r.members)


def partner(f: Rectangle, others: Sequence[Rectangle], limits: tuple[float, float]) -> int | None:
    """The nearest of those, sorted, that lie within the limits across and along; or None."""
    near = []
    for k, g in enumerate(others):
        dx = abs(f.across - g.across)
        dy = max(0.0, max(f.low, g.low) - min(f.high, g.high))
        if g is not f and g.upright == f.upright and dx < limits[0] and dy < limits[1]:
            near.append((whole((dx + dy) / 2), k))
    return min(near)[1] if near else None


def merged(f: Rectangle, g: Rectangle) -> Rectangle:
    """Step 5: the precise one counts for more; the error covers both and is never the better's."""
    across = (f.across / f.e + g.across / g.e) / (1 / f.e + 1 / g.e)
    e = max(min(f.e, g.e), abs(across - f.across), abs(across - g.across))
    e1 = f.e1 if f.low <= g.low else g.e1
    e2 = f.e2 if f.high >= g.high else g.e2
    low, high = min(f.low, g.low), max(f.high, g.high)
    return Rectangle(f.upright, across, low, high, e, e1, e2, f.members + g.members)


def fuzzy_set(
    segments: Sequence[Segment],
    *,
    points: Sequence[Sequence[Point]] | None = None,
    across: float = 0.20,
    along: float = 0.30,
    error: float = 0.02,
    angle: float = math.radians(10),
    axes: float | None = None,
) -> Found:
    """The most precise rectangle that has a partner merges with it, until none has one."""
    used = [i for i, s in enumerate(segments) if segment_length(s) >= SAME]
    axis = main_axis([segments[i] for i in used]) if axes is None else axes
    found: list[Rectangle] = []
    ends: list[tuple[int, list[int], Segment]] = []
    for i in used:
        own = None if points is None else turned(points[i], -axis)
        rectangle = laid(i, turned(segments[i], -axis), own, error, angle)
        if rectangle is None:
            ends.append((i, [i], segments[i]))
        else:
            found.append(rectangle)
    more = True
    while more:
        found.sort(key=order)
        more = False
        for f in found:
            k = partner(f, found, (across, along))
            if k is not None:
                g = found[k]
                found = [r for r in found if r is not f and r is not g] + [merged(f, g)]
                more = True
                break
    for r in found:
        corners = [(r.across, u) if r.upright else (u, r.across) for u in (r.low, r.high)]
        ends.append((min(r.members), r.members, turned(corners, axis)))
    ends.sort(key=lambda entry: entry[0])
    return [s for _, _, s in ends], parents_of((who for _, who, _ in ends), len(segments))
