"""Slow, literal forms of the methods, written from the text of the theses: the tests' oracles.

Scalars, lists and double loops, nothing shared with the package and nothing clever.
"""

import itertools
import math

import numpy as np

SAME = 1e-9


# ------------------------------------------------------------------ segments and distance
def line_angle(s):
    return math.atan2(s[1][1] - s[0][1], s[1][0] - s[0][0])


def segment_length(s):
    return math.hypot(s[1][0] - s[0][0], s[1][1] - s[0][1])


def axial(a, b):
    return (a - b + math.pi / 2) % math.pi - math.pi / 2


def to_segment(p, s):
    """Distance of a point from a segment, by cases."""
    length = segment_length(s)
    if length == 0:
        return math.dist(p, s[0])
    along = [(s[1][0] - s[0][0]) / length, (s[1][1] - s[0][1]) / length]
    t = (p[0] - s[0][0]) * along[0] + (p[1] - s[0][1]) * along[1]
    if t < 0:
        return math.dist(p, s[0])
    if t > length:
        return math.dist(p, s[1])
    return abs((p[0] - s[0][0]) * along[1] - (p[1] - s[0][1]) * along[0])


def segment_distance(u, v, wu=1.0, wv=1.0):
    """A 2.7.7: 0.66 D_ang + 0.09 D_uva + 0.25 D_uv."""
    lu, lv = segment_length(u), segment_length(v)
    au = line_angle(u) if lu >= SAME else None
    av = line_angle(v) if lv >= SAME else None
    au = (av if av is not None else 0.0) if au is None else au
    av = au if av is None else av
    share = wv / (wu + wv)
    turn = axial(av, au)
    means = [au + share * turn]
    if abs(abs(turn) - math.pi / 2) <= 1e-9:
        means = [au + share * math.pi / 2, au - share * math.pi / 2]
    middle = [
        (1 - share) * (u[0][k] + u[1][k]) / 2 + share * (v[0][k] + v[1][k]) / 2 for k in (0, 1)
    ]
    values = []
    for mean in means:
        ang_u = lu * math.tan(abs(axial(au, mean)))
        ang_v = lv * math.tan(abs(axial(av, mean)))
        d_ang = (wu * ang_u + wv * ang_v) / (wu + wv)
        n = (-math.sin(mean), math.cos(mean))
        ends = [*u, *v]
        d_uva = max(abs((e[0] - middle[0]) * n[0] + (e[1] - middle[1]) * n[1]) for e in ends)
        d_uv = min(*(to_segment(e, v) for e in u), *(to_segment(e, u) for e in v))
        values.append(0.66 * d_ang + 0.09 * d_uva + 0.25 * d_uv)
    return min(values)


def quality(before, after, scale=0.050):
    if len(before) == 0:
        return 1.0
    if len(after) == 0:
        return 0.0
    mean = sum(min(segment_distance(s, t) for t in after) for s in before) / len(before)
    return math.exp(-mean / scale)


# ------------------------------------------------------------------------------- fusion
def fusion(segments, tolerance):
    """A 4.4, as ALGORITHMS states it: every live segment and every shift, every time.

    Returns the outputs, the parent of each input, and the total length of each chain.
    """
    lengths = [segment_length(s) for s in segments]
    live = [i for i in range(len(segments)) if lengths[i] >= SAME]
    parents = [-1] * len(segments)
    out, totals = [], []
    while live:
        longest = max(lengths[i] for i in live)
        first = min(i for i in live if lengths[i] >= longest - SAME)
        s = segments[first]
        x, y = (s[0][0] + s[1][0]) / 2, (s[0][1] + s[1][1]) / 2
        dx, dy = (s[1][0] - s[0][0]) / lengths[first], (s[1][1] - s[0][1]) / lengths[first]
        u = {i: sorted((e[0] - x) * dx + (e[1] - y) * dy for e in segments[i]) for i in live}
        v = {i: sorted((e[1] - y) * dx - (e[0] - x) * dy for e in segments[i]) for i in live}
        shifts = [0.0]
        for i in live:
            shifts += [t for t in (v[i][1] - tolerance, v[i][0] + tolerance) if abs(t) <= tolerance]
        options = []
        for t in shifts:
            members = _chain(first, t, tolerance, live, u, v)
            options.append((sum(lengths[i] for i in members), t, sorted(members)))
        most = max(total for total, _, _ in options)
        options = [o for o in options if o[0] >= most - SAME]
        least = min(abs(t) for _, t, _ in options)
        options = [o for o in options if abs(o[1]) <= least + SAME]
        total, t, members = min(options, key=lambda o: o[2])
        low, high = min(u[i][0] for i in members), max(u[i][1] for i in members)
        base = (x - t * dy, y + t * dx)
        out.append([[base[0] + w * dx, base[1] + w * dy] for w in (low, high)])
        totals.append(total)
        for i in members:
            parents[i] = len(out) - 1
        live = [i for i in live if i not in set(members)]
    return np.array(out).reshape(-1, 2, 2), np.array(parents, int), totals


def _chain(first, t, tolerance, live, u, v):
    """Connected set of overlapping projections inside the strip, grown from the first segment."""
    inside = [
        i for i in live if v[i][1] - tolerance <= t + SAME and t - SAME <= v[i][0] + tolerance
    ]
    chain, todo = {first}, [first]
    while todo:
        a = todo.pop()
        for b in inside:
            if b not in chain and u[b][0] <= u[a][1] + SAME and u[a][0] <= u[b][1] + SAME:
                chain.add(b)
                todo.append(b)
    return chain


# -------------------------------------------------------------------------------- basic
def basic(segments, scans, distance, angle):
    """A 4.1, as ALGORITHMS states it: the literal double loop, run again after each scan.

    Returns the survivors in index order and, for each input, the index of the input that it ended
    in (its own where it survived, -1 without length).
    """
    into = [i if segment_length(s) >= SAME else -1 for i, s in enumerate(segments)]
    live = []
    for scan in sorted(set(scans)):
        live += [
            [i, [tuple(p) for p in segments[i]]]
            for i in range(len(segments))
            if scans[i] == scan and into[i] >= 0
        ]
        while _basic_pass(live, into, distance, angle):
            live[:] = [entry for entry in live if entry is not None]
    for i in range(len(into)):
        while into[i] >= 0 and into[into[i]] != into[i]:
            into[i] = into[into[i]]
    return [entry[1] for entry in live], into


def _basic_pass(live, into, distance, angle):
    """One pass of the double loop; the dead become None. Tells whether anything merged."""
    merged = False
    for i in range(len(live)):
        for j in range(len(live)):
            if i == j or live[i] is None or live[j] is None:
                continue
            a, b = live[i][1], live[j][1]
            near = any(math.dist(p, q) < distance for p in a for q in b)
            if near and abs(axial(line_angle(a), line_angle(b))) < angle:
                live[i][1] = basic_merge(a, b)
                into[live[j][0]] = live[i][0]
                live[j], merged = None, True
    return merged


def basic_merge(a, b):
    """Length-weighted mean line of two segments, and the extreme projections on it."""
    la, lb = segment_length(a), segment_length(b)
    mean = line_angle(a) + lb / (la + lb) * axial(line_angle(b), line_angle(a))
    c = [(la * (a[0][k] + a[1][k]) + lb * (b[0][k] + b[1][k])) / (2 * (la + lb)) for k in (0, 1)]
    d = (math.cos(mean), math.sin(mean))
    u = [(p[0] - c[0]) * d[0] + (p[1] - c[1]) * d[1] for p in (*a, *b)]
    return [(c[0] + w * d[0], c[1] + w * d[1]) for w in (min(u), max(u))]


# ------------------------------------------------------------------------------- hybrid
def hough(s):
    """Distance and direction of the normal of a segment's line, the direction in [0, pi)."""
    theta = (line_angle(s) + math.pi / 2) % math.pi
    x, y = (s[0][0] + s[1][0]) / 2, (s[0][1] + s[1][1]) / 2
    return x * math.cos(theta) + y * math.sin(theta), theta


def nearness(a, b):
    """A 4.2: end-point distances, and those of ends of a whose projection falls inside b."""
    found = [math.dist(p, q) for p in a for q in b]
    length = segment_length(b)
    d = [(b[1][k] - b[0][k]) / length for k in (0, 1)]
    for p in a:
        along = (p[0] - b[0][0]) * d[0] + (p[1] - b[0][1]) * d[1]
        if 0 <= along <= length:
            found.append(abs((p[0] - b[0][0]) * d[1] - (p[1] - b[0][1]) * d[0]))
    return min(found)


def hybrid(segments, scans, distance, angle, min_length):
    """A 4.2, as ALGORITHMS states it. Returns the map, and where each input went."""
    map, into = [], [-1] * len(segments)
    for scan in sorted(set(scans)):
        hybrid_scan(map, into, segments, scans, scan, distance, angle, min_length)
    return [entry[0] for entry in map], into


def hybrid_scan(map, into, segments, scans, scan, distance, angle, min_length):
    """One scan of Hybrid: changes the map, of (segment, rho, theta, count), and `into`."""
    for i in range(len(segments)):
        a = [tuple(p) for p in segments[i]]
        if scans[i] != scan or segment_length(a) < SAME:
            continue
        rho, theta = hough(a)
        found = []
        for k, (segment, r, t, _count) in enumerate(map):
            turns = round((t - theta) / math.pi)
            mine = (rho if turns % 2 == 0 else -rho, theta + turns * math.pi)
            d = nearness(a, segment)
            if d < distance and abs(r - mine[0]) < distance and abs(t - mine[1]) < angle:
                found.append((d, k, mine))
        if found:
            least = min(found)[0]
            _, k, mine = next(f for f in found if f[0] <= least + SAME)
            segment, r, t, count = map[k]
            r = (count * r + mine[0]) / (count + 1)
            t = (count * t + mine[1]) / (count + 1)
            n, along = (math.cos(t), math.sin(t)), (-math.sin(t), math.cos(t))
            u = [p[0] * along[0] + p[1] * along[1] for p in (*segment, *a)]
            ends = [(r * n[0] + w * along[0], r * n[1] + w * along[1]) for w in (min(u), max(u))]
            map[k] = (ends, r, t, count + 1)
            into[i] = k
        elif segment_length(a) >= min_length:
            into[i] = len(map)
            map.append((a, rho, theta, 1))


def hybrid_fusion(segments, scans, distance, angle, min_length, tolerance, every):
    """A 7: Hybrid; Fusion of the whole map after every so many scans and after the last."""
    map, into = [], [-1] * len(segments)
    used = sorted(
        {scan for scan, s in zip(scans, segments, strict=True) if segment_length(s) >= SAME}
    )
    for done, scan in enumerate(used, 1):
        hybrid_scan(map, into, segments, scans, scan, distance, angle, min_length)
        if done % every == 0 or done == len(used):
            fused, parents, _ = fusion([entry[0] for entry in map], tolerance)
            counts = [0] * len(fused)
            for k, entry in enumerate(map):
                counts[parents[k]] += entry[3]
            map = [(s, *hough(s), count) for s, count in zip(fused.tolist(), counts, strict=True)]
            into = [parents[k] if k >= 0 else -1 for k in into]
    return [entry[0] for entry in map], into


# --------------------------------------------------------------------------- extraction
def total_line(points):
    """Centre and direction of the total least squares line, by the eigenvectors of the scatter."""
    p = np.asarray(points, float)
    centre = p.mean(0)
    _, vectors = np.linalg.eigh((p - centre).T @ (p - centre))
    return centre, vectors[:, 1]


def algebraic_line(points):
    """A 3.1-3.3: least squares on a x + b y = 1."""
    p = np.asarray(points, float)
    a, b = np.linalg.lstsq(p, np.ones(len(p)), rcond=None)[0]
    square = a * a + b * b
    return np.array([a, b]) / square, np.array([-b, a]) / math.sqrt(square)


def clusters(points, gap, fit=total_line):
    """A 3.2: runs of points nearer than the gap, one line each, without the seam."""
    runs = [[points[0]]] if len(points) else []
    for before, point in itertools.pairwise(points):
        if math.dist(before, point) >= gap:
            runs.append([])
        runs[-1].append(point)
    out = []
    for run in runs:
        if all(math.dist(p, run[0]) <= SAME for p in run):
            continue
        centre, direction = fit(run)
        u = [float((np.asarray(p) - centre) @ direction) for p in run]
        out.append([centre + min(u) * direction, centre + max(u) * direction])
    return np.array(out).reshape(-1, 2, 2)
