"""One per wall as plain Python: the yardstick of `reduction.one_per_wall`.

Pairs of looks at one stretch of a wall tell the noise of the poses. Each scan moves to where its
looks agree with those of the others. Then the longest look gathers those that lie on its line.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations
from statistics import median
from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform

from ..lines import (
    SAME,
    Found,
    Line,
    Point,
    Segment,
    extreme_projections,
    line_of,
    parents_of,
    seen_from,
    segment_length,
)

#: Constants of `reduction.one_per_wall`, metres where they are lengths.
BEND, FEWEST, ROUNDS, STEPS, SHARE = 0.0115, 8, 10, 6, 0.8
LEAST, APART, SINE, OVERLAP = 0.3, 0.25, 0.174, 0.5
GAP, HIDDEN, THROUGH, SHADE, SLANT = 0.3, 1.0, 0.1, 0.5, 0.5
NICHE, SHADOW = 0.3, 2.0
CHANGES, WEIGHT, MORE, WIDE, BESIDE = 12, 0.01, 1.5, 1.5, 0.8

Pair = tuple[int, int]


def one_per_wall(
    segments: Sequence[Segment],
    *,
    scans: Sequence[int] | None = None,
    sensors: Sequence[Point] | None = None,
    factor: float = 1.0,
) -> Found:
    """Walls, and the index of the wall that each of the segments went into."""
    looks = {i: s for i, s in enumerate(segments) if segment_length(s) >= SAME}
    size = {i: segment_length(s) for i, s in looks.items()}
    several = scans is not None and len(set(scans)) > 1
    scan = {i: scans[i] if several and scans else i for i in looks}
    sensor = {i: sensors[scans[i]] for i in looks} if sensors and scans else {}
    pairs = pairs_of(looks, scan, sensor)
    sigma = 0.0
    if len(pairs) >= FEWEST:
        sigma = noise_of(looks, pairs)
        if several and sigma > 0:
            looks, sensor, sigma = agreed(looks, sensor, scan, pairs, sigma)
    tolerance = 3 * factor * math.hypot(sigma, BEND)
    free, walls = sorted(looks, key=lambda i: (-round(size[i], 9), i)), []
    while free:
        wall, members = grown({i: looks[i] for i in free}, looks, sensor, tolerance)
        walls.append((wall, members))
        free = [i for i in free if i not in members]
    walls = sorted(taken_in(walls, size, tolerance), key=lambda wall: min(wall[1]))
    return [wall for wall, _ in walls], parents_of((who for _, who in walls), len(segments))


def shared(u: Segment, v: Segment) -> tuple[float, float, float, float]:
    """Where v lies beside u: from and to along u, and its offset there."""
    (a, p), (b, q) = (seen_from(line_of(u), point) for point in v)
    low, high = max(0.0, min(a, b)), min(segment_length(u), max(a, b))
    slope = (q - p) / (b - a)
    return low, high, p + slope * (low - a), p + slope * (high - a)


def same_face(u: Segment, v: Segment, from_u: Point | None, from_v: Point | None) -> bool:
    """Whether two looks are nearly parallel, and were seen from one side."""
    (_, _, ux, uy), (_, _, vx, vy) = line_of(u), line_of(v)
    sides = [seen_from(line_of(u), p)[1] for p in (from_u, from_v) if p is not None]
    return abs(ux * vy - uy * vx) <= SINE and math.prod(sides) >= 0


def pairs_of(
    looks: dict[int, Segment], scan: dict[int, int], sensor: dict[int, Point]
) -> list[Pair]:
    """Looks of different scans at one stretch of a wall, from one side; the longer one first."""
    size, pairs = {i: segment_length(s) for i, s in looks.items()}, []
    for j, i in combinations([i for i in looks if size[i] >= LEAST], 2):
        a, b = (i, j) if size[j] <= size[i] + SAME else (j, i)
        if scan[i] != scan[j] and same_face(looks[i], looks[j], sensor.get(i), sensor.get(j)):
            low, high, one, two = shared(looks[a], looks[b])
            if high - low >= OVERLAP * size[b] - SAME and abs(one + two) / 2 <= APART:
                pairs.append((a, b))
    return pairs


def spread(apart: Sequence[float]) -> float:
    """Deviation of offsets from 0, of which those beyond 2.5 deviations are cut."""
    sigma = 1.4826 * median(abs(d) for d in apart)
    for _ in range(10):
        squares = [d * d for d in apart if abs(d) <= 2.5 * sigma]
        sigma = math.sqrt(sum(squares) / len(squares) / 0.9113)
    return sigma


def noise_of(looks: dict[int, Segment], pairs: Sequence[Pair]) -> float:
    """Deviation of one look, where both looks of a pair err alike."""
    return spread([sum(shared(looks[i], looks[j])[2:]) / 2 for i, j in pairs]) / math.sqrt(2)


def asks(
    k: int,
    looks: dict[int, Segment],
    scan: dict[int, int],
    pairs: Sequence[Pair],
    centre: Array,
    sigma: float,
) -> Array:
    """Rows (x, y, turn, off): how a scan must move so that what its pairs share meets."""
    rows = []
    for i, j in (pair for pair in pairs if k in (scan[pair[0]], scan[pair[1]])):
        low, high, one, two = shared(looks[i], looks[j])
        x, y, dx, dy = line_of(looks[i])
        doubt = 1 + (max(abs(one), abs(two)) / sigma / 2) ** 2
        weight, sign = math.sqrt(max(high - low, 0)) / sigma / doubt, 1 if scan[i] == k else -1
        for at, off in ((low, one), (high, two)):
            lever = (x + at * dx - centre[0]) * dx + (y + at * dy - centre[1]) * dy
            rows.append(weight * np.array([-dy, dx, lever, sign * off]))
    return np.reshape(rows, (-1, 4))


def step_of(
    k: int,
    looks: dict[int, Segment],
    scan: dict[int, int],
    pairs: Sequence[Pair],
    moved: Array,
    noise: float,
    left: float,
) -> tuple[Array, Array]:
    """The centre of a scan, and its step: a share of what its pairs and its first place ask for."""
    middles = np.array([np.mean(s, axis=0) for i, s in looks.items() if scan[i] == k])
    centre, arm = middles.mean(axis=0), math.sqrt(middles.var(axis=0).sum())
    stay = np.diag([1, 1, arm]) / noise
    own = np.vstack([np.column_stack([stay, -stay @ moved]), (0, 0, 1e-9**0.5 / noise, 0)])
    rows = np.vstack([asks(k, looks, scan, pairs, centre, max(left, noise / 10)), own])
    return centre, SHARE * np.linalg.lstsq(rows[:, :3], rows[:, 3])[0]


def turned(points: Any, centre: Array, step: Array) -> Any:
    """Points carried along with a scan that turns about its centre, which moves."""
    return transform((*(centre + step[:2]), step[2]), np.asarray(points) - centre)


def agreed(
    looks: dict[int, Segment],
    sensor: dict[int, Point],
    scan: dict[int, int],
    pairs: Sequence[Pair],
    noise: float,
) -> tuple[dict[int, Segment], dict[int, Point], float]:
    """Looks and sensors where the scans agree best, and the noise that is left."""
    moved, sigma = {k: np.zeros(3) for k in scan.values()}, noise
    for count in range(1, ROUNDS * STEPS + 1):
        steps = {k: step_of(k, looks, scan, pairs, moved[k], noise, sigma) for k in moved}
        moved = {k: moved[k] + step for k, (_, step) in steps.items()}
        looks = {i: turned(s, *steps[scan[i]]) for i, s in looks.items()}
        sensor = {i: turned(p, *steps[scan[i]]) for i, p in sensor.items()}
        if count % STEPS == 0:
            sigma = noise_of(looks, pairs)
    return looks, sensor, sigma


def grown(
    free: dict[int, Segment],
    looks: dict[int, Segment],
    sensor: dict[int, Point],
    tolerance: float,
) -> tuple[Segment, list[int]]:
    """The wall that the first of the free looks gathers, and its members."""
    seed = next(iter(free))
    line, wall = line_of(free[seed]), free[seed]
    members: list[int] = []
    for _ in range(CHANGES):
        before, members = members, together(free, seed, line, wall, looks, sensor, tolerance)
        if sorted(before) == sorted(members):
            break
        line = fitted([free[i] for i in members], line, tolerance)
        wall = extreme_projections([p for i in members for p in free[i]], line)
    return extreme_projections([p for i in members for p in free[i]], line), members


def together(
    free: dict[int, Segment],
    seed: int,
    line: Line,
    wall: Segment,
    looks: dict[int, Segment],
    sensor: dict[int, Point],
    tolerance: float,
) -> list[int]:
    """The looks that lie on a line and hang together with the seed."""
    low, high = sorted(seen_from(line, p)[0] for p in wall)
    spans = []
    for i, s in free.items():
        (a, p), (b, q) = (seen_from(line, point) for point in s)
        begin, end = min(a, b), max(a, b)
        fits = max(abs(p), abs(q)) <= tolerance and abs(p - q) <= SLANT * segment_length(s)
        if i == seed or (fits and begin <= high + HIDDEN and end >= low - HIDDEN):
            spans.append((begin, end, i))
    run: list[int] = []
    reached = -math.inf
    for begin, end, i in sorted(spans):
        gap = begin - reached
        if gap > GAP + SAME and not (
            gap <= HIDDEN + SAME and bridged(line, reached, begin, looks, sensor, tolerance)
        ):
            if seed in run:
                break
            run, reached = [], begin
        run.append(i)
        reached = max(reached, end)
    return run


def bridged(
    line: Line,
    low: float,
    high: float,
    looks: dict[int, Segment],
    sensor: dict[int, Point],
    tolerance: float,
) -> bool:
    """Whether a look stood before a gap, and no beam passed through it."""
    hidden = False
    for i in sensor:
        from_u, from_v = seen_from(line, sensor[i])
        side = -1.0 if from_v < 0 else 1.0
        ends = [(u, side * v) for u, v in (seen_from(line, p) for p in looks[i])]
        behind = all(v < -tolerance for _, v in ends)
        if not behind and not all(NICHE < v < abs(from_v) for _, v in ends):
            continue
        on = [from_u + (u - from_u) * abs(from_v) / (abs(from_v) - v) for u, v in ends]
        metres = min(high, max(on)) - max(low, min(on))
        if behind and abs(from_v) > tolerance and metres > THROUGH:
            return False
        near = all(math.hypot(o - u, v) <= SHADOW for o, (u, v) in zip(on, ends, strict=True))
        hidden = hidden or (not behind and near and metres >= SHADE * (high - low))
    return hidden


def fitted(members: Sequence[Segment], line: Line, tolerance: float) -> Line:
    """The line of total least squares; members that lie far off the last one count less."""
    rows = []
    for s in members:
        off = max(abs(seen_from(line, p)[1]) for p in s)
        share = max(1 - (off / tolerance) ** 2, 0.0)
        rows.append((segment_length(s) * max(share * share, WEIGHT), s))
    total = sum(w for w, _ in rows)
    x, y = (sum(w * (s[0][k] + s[1][k]) / 2 for w, s in rows) / total for k in (0, 1))
    xx = xy = yy = 0.0
    for w, s in rows:
        ex, ey = (s[1][0] - s[0][0]) / 2, (s[1][1] - s[0][1]) / 2
        mx, my = s[0][0] + ex - x, s[0][1] + ey - y
        xx += w * (mx * mx + ex * ex / 3)
        xy += w * (mx * my + ex * ey / 3)
        yy += w * (my * my + ey * ey / 3)
    theta = math.atan2(2 * xy, xx - yy) / 2
    return x, y, math.cos(theta), math.sin(theta)


def taken_in(
    walls: Sequence[tuple[Segment, list[int]]], size: dict[int, float], tolerance: float
) -> list[tuple[Segment, list[int]]]:
    """The walls that are left when weak ones, the weakest first, went into stronger ones beside."""
    remaining = {k: (wall, list(members)) for k, (wall, members) in enumerate(walls)}
    metres = {k: sum(size[i] for i in members) for k, (_, members) in remaining.items()}
    for a in sorted(remaining, key=lambda k: (round(metres[k], 9), k)):
        best, least = None, WIDE * tolerance
        for b in remaining:
            if a == b or metres[b] < MORE * metres[a] - SAME:
                continue
            seen = [seen_from(line_of(remaining[b][0]), p) for p in remaining[a][0]]
            low, high = sorted(u for u, _ in seen)
            off, whole = max(abs(v) for _, v in seen), segment_length(remaining[b][0])
            over = min(high, whole) - max(low, 0.0)
            if over >= BESIDE * segment_length(remaining[a][0]) - SAME and off < least - SAME:
                best, least = b, off
        if best is not None:
            remaining[best][1].extend(remaining.pop(a)[1])
            metres[best] += metres.pop(a)
    return list(remaining.values())
