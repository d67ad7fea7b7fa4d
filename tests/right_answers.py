"""Right answers to each exercise, from different ideas; none of them is the library's."""

import math
from fractions import Fraction

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist
from scipy.special import softmax

from segmap import segments
from segmap.angles import axial_difference, axial_mean_of_two, wrap
from segmap.poses import between, compose, inverse, transform


def met_by_solving(wall, pose, turn):
    beam = [np.cos(pose[2] + turn), np.sin(pose[2] + turn)]
    try:
        r, part = np.linalg.solve(np.transpose([beam, wall[0] - wall[1]]), wall[0] - pose[:2])
    except np.linalg.LinAlgError:
        return float("inf")
    return r if r > 0 and 0 <= part <= 1 and r < 1e6 else float("inf")


def farthest_in_a_loop(points):
    (x0, y0), (x1, y1) = points[0], points[-1]
    off = [abs((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) for x, y in points]
    return off.index(max(off))


def quality_row_by_row(distances):
    return np.exp(-sum(min(row) for row in distances.tolist()) / len(distances) / 0.05)


def inside_in_a_loop(offsets, shift, tolerance):
    return [all(abs(x - shift) <= tolerance for x in pair) for pair in offsets]


def shift_in_a_loop(offsets, lengths, tolerance):
    shifts = [0.0, *(max(p) - tolerance for p in offsets), *(min(p) + tolerance for p in offsets)]
    shifts = sorted((t for t in shifts if abs(t) <= tolerance), key=abs)
    return max(shifts, key=lambda t: lengths[inside_in_a_loop(offsets, t, tolerance)].sum())


def hough_by_complex_numbers(segment, near):
    a, b = (complex(*end) for end in segment)
    theta = np.angle((b - a) * 1j)
    theta += np.pi * round((near - theta) / np.pi)
    return [(a * np.exp(-1j * theta)).real, theta]


def reduction_by_hand(points, quality):
    reached = [tuple(p) for p in points if not any((q > p).all() for q in points)]
    above, below = ([p for p in reached if (p[0] >= quality) == up] for up in (True, False))
    if not above or not below:
        return max((r for _, r in above), default=float("nan"))
    (q0, r0), (q1, r1) = max(below), min(above)
    return r0 + (quality - q0) / (q1 - q0) * (r1 - r0)


def moved_by_pseudo_inverse(points, feet, normals):
    rows = [[nx, ny, x * ny - y * nx] for (x, y), (nx, ny) in zip(points, normals, strict=True)]
    return np.linalg.pinv(rows) @ ((feet - points) * normals).sum(1)


def step_in_a_loop(centres, pieces, sigma, bandwidth):
    moved = []
    for c in centres:
        turns = np.array([np.angle(np.exp(2j * (p[2] - c[2]))) / 2 for p in pieces])
        away = [np.hypot(*(p - c)[:2]) for p in pieces]
        w = np.exp(-(np.square(away) + (turns / bandwidth) ** 2) / 2 / sigma**2)
        x, y = np.average(pieces[:, :2], axis=0, weights=w)
        moved.append([x, y, (c[2] + np.average(turns, weights=w)) % np.pi])
    return moved


def grown_by_arrays(root, cell):
    low = np.array(root[:2])
    return np.append(np.where(np.array(cell) < low, low - root[2], low), 2 * root[2])


def cells_by_formula(start, end):
    """After k steps along the longer axis, rounded from the end with the smaller coordinate."""
    start, end = np.array(start), np.array(end)
    axis = int(abs(end - start)[1] > abs(end - start)[0])
    first, last = (end, start) if end[axis] < start[axis] else (start, end)
    length, aside = (last - first)[axis], (last - first)[1 - axis]
    k = np.arange(length + 1)
    across = (k * abs(aside) + (length - 1) // 2) // max(length, 1) if length else k
    cells = np.empty((length + 1, 2), int)
    cells[:, axis], cells[:, 1 - axis] = first[axis] + k, first[1 - axis] + np.sign(aside) * across
    return cells


def matrix(x, y, heading):
    c, s = np.cos(heading), np.sin(heading)
    return np.array([(c, -s, x), (s, c, y), (0, 0, 1)])


def pose_of(m):
    return [m[0, 2], m[1, 2], np.arctan2(m[1, 0], m[0, 0])]


def edge_error_by_matrices(first, second, relative):
    return pose_of(np.linalg.inv(matrix(*first) @ matrix(*relative)) @ matrix(*second))


def carried_by_matrices(before, after, pose):
    """The one motion that takes the key frame along, applied to the scan."""
    return pose_of(matrix(*after) @ np.linalg.inv(matrix(*before)) @ matrix(*pose))


def distances_bit_by_bit(lines):
    text = "".join(f"{c - 48:06b}" for line in lines for c in line[:-1])
    return [int(text[i : i + 18], 2) for i in range(0, len(text), 18)]


def climb_in_a_loop(value, pose, move, turn):
    best, steps = [*pose], (move, move, turn)
    for axis in range(3):
        for sign in (-1, 1):
            tried = [p + sign * steps[axis] * (k == axis) for k, p in enumerate(pose)]
            best = tried if value(np.array(tried)) > value(np.array(best)) else best
    return best


def wall_error_along_and_aside(points, walls):
    total = 0.0
    for p in points:
        off = []
        for a, b in walls:
            length = np.linalg.norm(b - a)
            along = (p - a) @ (b - a) / length
            aside = (b - a)[0] * (p - a)[1] - (b - a)[1] * (p - a)[0]
            off.append(np.hypot(max(-along, along - length, 0.0), aside / length))
        total += min(off)
    return total / len(points)


def pose_covariance_by_moving(centre, alpha, sensor, place, heading):
    """From what the line becomes when x, y and heading of the sensor move by a little."""
    n, columns = np.array([np.cos(alpha), np.sin(alpha)]), []
    for move in (*np.eye(3) * 1e-5, *np.eye(3) * -1e-5):
        ends = [[*(centre - sensor)], [*(centre - sensor + [-n[1], n[0]])]]
        a, b = transform(move, np.array(ends)) + sensor
        turned = np.arctan2(*(b - a)[::-1]) - np.pi / 2
        normal = np.array([np.cos(turned), np.sin(turned)])
        change = axial_difference(turned, alpha)
        offset = (a - centre) @ normal  # of the new line, about the old centre
        columns.append([offset, change])
    jacobian = (np.array(columns[:3]) - columns[3:]).T / 2e-5
    return jacobian @ np.diag([place, place, heading]) ** 2 @ jacobian.T


def verdict_by_complex_numbers(wall, point, sensor, distance):
    a, b, q = (complex(*end) - complex(*sensor) for end in (*wall, point))
    middle = np.angle(b / a) / 2
    turn = np.angle(q / a / np.exp(1j * middle))
    if abs(turn) > abs(middle) + 1e-12:
        return float("nan")
    normal = 1j * (b - a) / abs(b - a)
    before = ((a - q) * normal.conjugate()).real * np.sign((a * normal.conjugate()).real)
    return 0 if abs(before) <= distance else np.sign(before)


def metres_by_small_steps(spans, whole, gap):
    """A segment in pieces of 0.1 mm: those that no member covers, in runs longer than the gap."""
    at = (np.arange(round(float(whole) * 1e4)) + 0.5) / 1e4
    alone = ~((spans[:, :1] < at) & (at < spans[:, 1:])).any(axis=0)
    runs = np.split(alone, np.flatnonzero(np.diff(alone)) + 1)
    metres = [len(run) / 1e4 for run in runs if run[0]]
    return sum(metres) if len(spans) == 0 else sum(m for m in metres if m > gap)


def match_by_complex_numbers(u, v, distance):
    """Spans by complex division; the distances of end points from the other segment."""

    def one(a, b):
        (p, q), ends = (complex(*end) for end in a), [complex(*end) for end in b]
        along = np.sort([((end - p) / (q - p)).real for end in ends])
        feet = [p + (q - p) * min(max(((end - p) / (q - p)).real, 0), 1) for end in ends]
        off = max(abs(end - foot) for end, foot in zip(ends, feet, strict=True))
        return abs(q - p) * max(min(along[1], 1) - max(along[0], 0), 0), off

    (first, far), (second, away) = one(u, v), one(v, u)
    return (first + second) / 2 * 0.95 ** (min(far, away) / distance)


def by_pseudo_inverse(normals, offsets, weights):
    root = np.sqrt(weights)
    return -np.linalg.pinv(normals * root[:, None], rcond=1e-9) @ (offsets * root)


def matches_by_complex_numbers(a, b, distance, angle):
    p, q = ([complex(*end) for end in s] for s in (a, b))
    turn = abs(np.angle(((p[1] - p[0]) / (q[1] - q[0])) ** 2)) / 2
    return min(abs(x - y) for x in p for y in q) < distance and turn < angle


def merged_by_complex_numbers(a, b):
    """Turn the second direction so that it looks along the first, then average what is left."""
    p, q = ([complex(*end) for end in s] for s in (a, b))
    u, v = p[1] - p[0], q[1] - q[0]
    share = abs(v) / (abs(u) + abs(v))
    way = u / abs(u) * np.exp(1j * share * np.angle((v / u) ** 2) / 2)
    middle = sum(p) / 2 * (1 - share) + sum(q) / 2 * share
    along = [((end - middle) / way).real for end in (*p, *q)]
    return [((middle + t * way).real, (middle + t * way).imag) for t in (min(along), max(along))]


def composed_by_complex_numbers(a, b):
    x = complex(*a[:2]) + complex(*b[:2]) * np.exp(1j * a[2])
    return [x.real, x.imag, (a[2] + b[2] + np.pi) % (2 * np.pi) - np.pi]


def met_in_the_frame_of_the_beam(wall, pose, turn):
    """The wall seen along the beam: where it crosses the axis ahead."""
    (x0, y0), (x1, y1) = transform(between((*pose[:2], pose[2] + turn), (0, 0, 0)), wall)
    if y0 * y1 > 0 or abs(y0 - y1) < 1e-12:
        return np.inf
    x = x0 + (x1 - x0) * y0 / (y0 - y1)
    return x if x > 0 else np.inf


def unwrapped_step_by_step(stamps):
    seconds, last = [0.0], int(stamps[0])
    for stamp in stamps.tolist()[1:]:
        seconds.append(seconds[-1] + ((stamp - last) & 0xFFFFFF) / 1000)
        last = stamp
    return seconds


def longest_axis(angles):
    """The direction in which unit vectors, of either sign, reach farthest."""
    u = np.stack([np.cos(angles), np.sin(angles)])
    x, y = np.linalg.eigh(u @ u.T)[1][:, -1]
    return np.arctan2(y, x)


def fitted_by_sums(points):
    n, (mx, my) = len(points), points.mean(0)
    sxx = sum(x * x for x, _ in points) - n * mx * mx
    syy = sum(y * y for _, y in points) - n * my * my
    sxy = sum(x * y for x, y in points) - n * mx * my
    return math.atan2(2 * sxy, sxx - syy) / 2


def match_with_helpers(u, v, distance):
    def covered(a, b):
        along = (b - a[0]) @ (a[1] - a[0]) / segments.length(a)
        return max(0, min(along.max(), segments.length(a)) - max(along.min(), 0))

    apart = min(segments.point_distance(v, u).max(), segments.point_distance(u, v).max())
    return (covered(u, v) + covered(v, u)) / 2 * 0.95 ** (apart / distance)


def shift_by_eigenvectors(normals, offsets, weights):
    matrix, right = (normals.T * weights) @ normals, -(normals.T * weights) @ offsets
    values, ways = np.linalg.eigh(matrix)
    return sum(way * (way @ right) / v for v, way in zip(values, ways.T, strict=True) if v > 1e-9)


def metres_between_ends(spans, whole, gap):
    """Between two neighbouring ends of members all is covered or nothing is."""
    ends = np.unique([0, whole, *spans.ravel()])
    middles = (ends[1:] + ends[:-1]) / 2
    bare = [not any(low < x < high for low, high in spans) for x in middles]
    metres = np.diff(ends)[bare]
    return metres[(metres > gap) | (len(spans) == 0)].sum()


def rate_or_nothing(before, after):
    try:
        return (len(before) - len(after)) / len(before)
    except ZeroDivisionError:
        return 0


def quality_as_a_geometric_mean(distances):
    return np.exp(-distances / 0.05).max(axis=1).prod() ** (1 / len(distances))


def reduction_by_mask(points, quality):
    q, r = points.T
    beaten = ((q[:, None] < q) & (r[:, None] < r)).any(axis=1)
    order = np.argsort(q[~beaten])
    return np.interp(quality, q[~beaten][order], r[~beaten][order], right=np.nan)


def row_by_masked_argmax(points, quality):
    r = np.where(points[:, 0] >= quality, points[:, 1], -np.inf)
    return r.argmax() if np.isfinite(r).any() else -1


def verdict_by_parts(wall, point, sensor, distance):
    """The point as so much of the way to one end and so much of that to the other."""
    ends = (wall - sensor).T
    s, t = np.linalg.solve(ends, point - sensor)
    if min(s, t) < 0:
        return np.nan
    (x, y), (dx, dy) = ends[:, 0], ends[:, 1] - ends[:, 0]
    behind = (s + t - 1) * abs(x * dy - y * dx) / math.hypot(dx, dy)
    return 0 if abs(behind) <= distance + 1e-12 else -np.sign(behind)


def step_along_the_gradient(centres, pieces, sigma, bandwidth):
    """Mean shift climbs the logarithm of the density: its derivatives by a complex step."""
    scale = np.array([1, 1, bandwidth])

    def height(at):
        d = pieces - at
        d[:, 2] -= np.pi * np.round(d[:, 2].real / np.pi)
        return np.log(np.exp(-((d / scale) ** 2).sum(1) / (2 * sigma**2)).sum())

    steep = [[height(c + 1e-20j * way).imag / 1e-20 for way in np.eye(3)] for c in centres]
    return centres + sigma**2 * scale**2 * np.array(steep)


def shift_by_table(offsets, lengths, tolerance):
    low, high = offsets.min(1) + tolerance, offsets.max(1) - tolerance
    shifts = np.concatenate([[0.0], low, high])
    shifts = shifts[np.abs(shifts) <= tolerance]
    totals = ((high <= shifts[:, None]) & (shifts[:, None] <= low)) @ lengths
    return shifts[np.lexsort([np.abs(shifts), -totals])[0]]


def hough_of_the_nearest_name(segment, near):
    theta = segments.angle(segment) + np.pi / 2 + np.pi * np.arange(-6, 7)
    theta = theta[np.abs(theta - near).argmin()]
    return [segments.midpoint(segment) @ [np.cos(theta), np.sin(theta)], theta]


def matches_with_helpers(a, b, distance, angle):
    turn = abs(axial_difference(segments.angle(a), segments.angle(b)))
    return cdist(a, b).min() < distance and turn < angle


def merged_with_helpers(a, b):
    sizes = segments.length(a), segments.length(b)
    way = axial_mean_of_two(segments.angle(a), segments.angle(b), *sizes)
    middle = np.average([segments.midpoint(a), segments.midpoint(b)], axis=0, weights=sizes)
    return segments.extreme_projections(np.vstack([a, b]), middle, way)


def grown_by_cases(root, cell):
    x, y, side = root
    if cell[0] < x:
        x = x - side
    if cell[1] < y:
        y = y - side
    return x, y, side + side


def occupancy_exactly(vis, occ, bias):
    if occ:
        return float(Fraction(occ, vis))
    return float(Fraction(max(bias - vis, 0), 2 * bias))


def cells_by_bresenham(start, end):
    flipped = abs(end[1] - start[1]) > abs(end[0] - start[0])
    ends = [start[::-1], end[::-1]] if flipped else [start, end]
    ((x, y), last), cells = sorted(ends, key=lambda cell: cell[0]), []
    dx, dy = last[0] - x, last[1] - y
    error = -(dx // 2)
    while x <= last[0]:
        cells.append((y, x) if flipped else (x, y))
        x, error = x + 1, error + abs(dy)
        if error > 0:
            y, error = y + (1 if dy > 0 else -1), error - dx
    return cells


def pixel_by_edges(x, y, origin, side, rows):
    """Counts the edges to the left, and those above."""
    columns = origin[0] + side * np.arange(200)
    lines = origin[1] + side * np.arange(rows + 1)
    return (lines > y).sum() - 1, (columns <= x).sum() - 1


def score_in_a_loop(points, pose, centres):
    c, s, total = math.cos(pose[2]), math.sin(pose[2]), 0.0
    for x, y in points:
        at = pose[0] + c * x - s * y, pose[1] + s * x + c * y
        total -= min(math.dist(at, centre) for centre in centres)
    return total


def climb_by_argmax(value, pose, move, turn):
    moves = np.kron(np.diag([move, move, turn]), [[-1], [1]])
    gains = np.array([value(pose + way) - value(pose) for way in moves])
    return pose + moves[gains.argmax()] * (gains.max() > 0)


def pose_covariance_closed(centre, alpha, sensor, place, heading):
    arm = (sensor[1] - centre[1]) * math.cos(alpha) - (sensor[0] - centre[0]) * math.sin(alpha)
    return [
        [place**2 + (arm * heading) ** 2, arm * heading**2],
        [arm * heading**2, heading**2],
    ]


def moved_by_eigenvectors(points, feet, normals):
    """Normal equations; what no wall fixes stays."""
    lever = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
    rows = np.column_stack([normals, lever])
    values, ways = np.linalg.eigh(rows.T @ rows)
    right = rows.T @ ((feet - points) * normals).sum(1)
    return sum(way * (way @ right) / v for v, way in zip(values, ways.T, strict=True) if v > 1e-9)


#: Exercise -> right answers from different ideas.
RIGHT = {
    "compose": (composed_by_complex_numbers, lambda a, b: pose_of(matrix(*a) @ matrix(*b))),
    "heading_between": (
        lambda a, b, t: np.angle(np.exp(1j * (a + t * np.angle(np.exp(1j * b) / np.exp(1j * a))))),
        lambda a, b, t: wrap(a + t * wrap(b - a)),
    ),
    "beam_angles": (
        lambda n: [np.radians(-90 + i * 180 / (n - n % 2)) for i in range(n)],
        lambda n: np.linspace(-np.pi / 2, np.pi / 2, n, endpoint=n % 2 == 1),
    ),
    "cast_ray": (met_by_solving, met_in_the_frame_of_the_beam),
    "distances": (
        distances_bit_by_bit,
        lambda lines: (
            (np.array([c for line in lines for c in line[:-1]], float).reshape(-1, 3) - 48)
            @ (4096, 64, 1)
        ),
    ),
    "unwrapped": (
        unwrapped_step_by_step,
        lambda s: (s - s[0] + np.append(0, np.cumsum(np.diff(s) < 0)) * 2**24) / 1e3,
    ),
    "axial_mean": (lambda angles: np.angle(np.mean(np.exp(2j * angles))) / 2, longest_axis),
    "fit_line": (
        lambda points: np.arctan2(*np.linalg.svd(points - points.mean(0))[2][0][::-1]),
        fitted_by_sums,
    ),
    "farthest_point": (
        farthest_in_a_loop,
        lambda p: np.abs(((p - p[0]) @ [1, 1j] / ((p[-1] - p[0]) @ [1, 1j])).imag).argmax(),
    ),
    "match_value": (match_by_complex_numbers, match_with_helpers),
    "least_translation": (by_pseudo_inverse, shift_by_eigenvectors),
    "move_onto_walls": (moved_by_pseudo_inverse, moved_by_eigenvectors),
    "edge_error": (
        edge_error_by_matrices,
        lambda first, second, relative: between(compose(first, relative), second),
    ),
    "carried": (
        carried_by_matrices,
        lambda before, after, pose: compose(compose(after, inverse(before)), pose),
    ),
    "reduction_rate": (rate_or_nothing, lambda a, b: 1 - len(b) / len(a) if len(a) else 0),
    "quality": (
        quality_row_by_row,
        quality_as_a_geometric_mean,
        lambda distances: np.exp(-np.sort(distances)[:, 0].mean() / 0.05),
    ),
    "reduction_at": (reduction_by_hand, reduction_by_mask),
    "best_run": (
        row_by_masked_argmax,
        lambda points, quality: max(
            (k for k, (q, _) in enumerate(points.tolist()) if q >= quality),
            key=lambda k: points[k][1],
            default=-1,
        ),
    ),
    "mean_wall_error": (
        wall_error_along_and_aside,
        lambda p, w: segments.point_distance(p[:, None], w).min(axis=1).mean(),
    ),
    "hough": (hough_by_complex_numbers, hough_of_the_nearest_name),
    "matches": (matches_by_complex_numbers, matches_with_helpers),
    "merged": (merged_by_complex_numbers, merged_with_helpers),
    "mean_shift_step": (step_in_a_loop, step_along_the_gradient),
    "inside_strip": (
        inside_in_a_loop,
        lambda offsets, shift, tolerance: (abs(offsets - shift) <= tolerance).all(axis=1),
    ),
    "best_shift": (shift_in_a_loop, shift_by_table),
    "cell_of": (
        lambda x, c, r: int((x - c) / r) - ((x - c) / r < int((x - c) / r)),
        lambda x, c, r: -math.ceil((c - x) / r),
        lambda x, c, r: np.floor((x - c) / r),
    ),
    "grown": (grown_by_arrays, grown_by_cases),
    "occupancy": (
        occupancy_exactly,
        lambda vis, occ, b: occ / vis if occ else np.interp(vis, [0, b], [0.5, 0.0]),
    ),
    "ray_cells": (cells_by_formula, cells_by_bresenham),
    "pixel": (
        pixel_by_edges,
        lambda x, y, o, side, n: (int((o[1] + n * side - y) / side), int((x - o[0]) / side)),
    ),
    "scan_score": (
        score_in_a_loop,
        lambda p, pose, c: -cKDTree(c).query(transform(pose, p))[0].sum(),
    ),
    "climb_step": (climb_in_a_loop, climb_by_argmax),
    "pose_covariance": (pose_covariance_by_moving, pose_covariance_closed),
    "verdict": (verdict_by_complex_numbers, verdict_by_parts),
    "invented_metres": (metres_by_small_steps, metres_between_ends),
    "memberships": (
        lambda squares, noise: 1 / (squares[:, None] / np.append(squares, noise**2)).sum(axis=1),
        lambda squares, noise: softmax(-np.log(np.append(squares, noise**2)))[:-1],
    ),
}
