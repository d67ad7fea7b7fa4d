"""One per wall as plain Python: the yardstick of `reduction.one_per_wall`.

Pairs of looks at one stretch of a wall tell the noise of the poses. Each scan moves to where its
looks agree with those of the others. Then the longest look gathers those that lie on its line.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import median

from ..alignment.global_segments import eliminated
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
    left = 0.0
    if len(pairs) >= FEWEST:
        left = noise_of(looks, pairs)
        if several and left > 0:
            looks, sensor, left = agreed(looks, sensor, scan, pairs, left)
    tolerance = 3 * factor * math.hypot(left, BEND)
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


def pairs_of(
    looks: dict[int, Segment], scan: dict[int, int], sensor: dict[int, Point]
) -> list[Pair]:
    """Looks of different scans at one stretch of a wall, from one side."""
    found = []
    long = [i for i in looks if segment_length(looks[i]) >= LEAST]
    for i in long:
        line = line_of(looks[i])
        for j in long:
            if j >= i or scan[i] == scan[j]:
                continue
            _, _, dx, dy = line_of(looks[j])
            if abs(line[2] * dy - line[3] * dx) > SINE:
                continue
            if sensor and seen_from(line, sensor[i])[1] * seen_from(line, sensor[j])[1] < 0:
                continue
            size, other = segment_length(looks[i]), segment_length(looks[j])
            a, b = (i, j) if other <= size + SAME else (j, i)  # along the longer look
            low, high, one, two = shared(looks[a], looks[b])
            if high - low >= OVERLAP * min(size, other) - SAME and abs(one + two) / 2 <= APART:
                found.append((a, b))
    return found


def noise_of(looks: dict[int, Segment], pairs: Sequence[Pair]) -> float:
    """Deviation of one look: of what the looks of each pair are apart, outliers cut at 2.5."""
    apart = [abs(sum(shared(looks[i], looks[j])[2:])) / 2 for i, j in pairs]
    found = 1.4826 * median(apart)
    for _ in range(10):
        kept = [d * d for d in apart if d <= 2.5 * found]
        found = math.sqrt(sum(kept) / len(kept) / 0.9113)
    return found / math.sqrt(2)


def agreed(
    looks: dict[int, Segment],
    sensor: dict[int, Point],
    scan: dict[int, int],
    pairs: Sequence[Pair],
    noise: float,
) -> tuple[dict[int, Segment], dict[int, Point], float]:
    """Looks and sensors where the scans agree best, and the noise that is left."""
    scans: dict[int, list[int]] = {}
    for i in looks:
        scans.setdefault(scan[i], []).append(i)
    centre, first = {}, {}
    for k, members in scans.items():
        middles = [[(a + b) / 2 for a, b in zip(*looks[i], strict=True)] for i in members]
        centre[k] = [sum(column) / len(members) for column in zip(*middles, strict=True)]
        lever = sum(math.dist(m, centre[k]) ** 2 for m in middles) / len(members)
        first[k] = [1 / noise**2, 1 / noise**2, lever / noise**2]
    moved, left = {k: [0.0, 0.0, 0.0] for k in scans}, noise
    for step in range(ROUNDS * STEPS):
        asked = {k: asks(k, looks, scan, pairs, centre[k], max(left, noise / 10)) for k in scans}
        for k, members in scans.items():
            normal, right = asked[k]
            for a in range(3):
                normal[a][a] += first[k][a]
                right[a] -= first[k][a] * moved[k][a]
            normal[2][2] += 1e-9 * first[k][0]
            x, y, turn = (SHARE * value for value in eliminated(normal, right))
            old, centre[k] = centre[k], [centre[k][0] + x, centre[k][1] + y]
            moved[k] = [a + b for a, b in zip(moved[k], (x, y, turn), strict=True)]
            for i in members:
                looks = {**looks, i: [turned(p, turn, old, centre[k]) for p in looks[i]]}
                if sensor:
                    sensor = {**sensor, i: turned(sensor[i], turn, old, centre[k])}
        if step % STEPS == STEPS - 1:
            left = noise_of(looks, pairs)
    return looks, sensor, left


def asks(
    k: int,
    looks: dict[int, Segment],
    scan: dict[int, int],
    pairs: Sequence[Pair],
    centre: Point,
    sigma: float,
) -> tuple[list[list[float]], list[float]]:
    """Normal equations of one scan: both ends of what each of its pairs shares shall meet."""
    normal, right = [[0.0] * 3 for _ in range(3)], [0.0] * 3
    for i, j in pairs:
        if k not in (scan[i], scan[j]):
            continue
        low, high, one, two = shared(looks[i], looks[j])
        if high <= low:
            continue
        x, y, dx, dy = line_of(looks[i])
        weight = (high - low) / (sigma * (1 + (max(abs(one), abs(two)) / sigma / 2) ** 2)) ** 2
        sign = 1.0 if scan[i] == k else -1.0
        for at, off in ((low, one), (high, two)):
            px, py = x + at * dx - centre[0], y + at * dy - centre[1]
            row = -dy, dx, px * dx + py * dy
            for a in range(3):
                right[a] += weight * sign * off * row[a]
                for b in range(3):
                    normal[a][b] += weight * row[a] * row[b]
    return normal, right


def turned(p: Point, angle: float, old: Point, new: Point) -> tuple[float, float]:
    """A point carried along with a scan that turns about its centre, which moves."""
    c, s, x, y = math.cos(angle), math.sin(angle), p[0] - old[0], p[1] - old[1]
    return new[0] + c * x - s * y, new[1] + s * x + c * y


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
    left = {k: (wall, list(members)) for k, (wall, members) in enumerate(walls)}
    metres = {k: sum(size[i] for i in members) for k, (_, members) in left.items()}
    for a in sorted(left, key=lambda k: (round(metres[k], 9), k)):
        best, least = None, WIDE * tolerance
        for b in left:
            if a == b or metres[b] < MORE * metres[a] - SAME:
                continue
            seen = [seen_from(line_of(left[b][0]), p) for p in left[a][0]]
            low, high = sorted(u for u, _ in seen)
            off, whole = max(abs(v) for _, v in seen), segment_length(left[b][0])
            over = min(high, whole) - max(low, 0.0)
            if over >= BESIDE * segment_length(left[a][0]) - SAME and off < least - SAME:
                best, least = b, off
        if best is not None:
            left[best][1].extend(left.pop(a)[1])
            metres[best] += metres.pop(a)
    return list(left.values())
