"""Right answers from another idea, where the solution of an exercise is the course's own."""

import math

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import softmax
from segmap_course import literal
from segmap_course.literal.reduction.one_per_wall import spread

from segmap import segments
from segmap.angles import axial_difference
from segmap.extraction import extract_clusters
from segmap.metrics import segment_distance
from segmap.poses import between, compose, inverse, transform


def split_by_a_list(points, tolerances, first, last):
    ends, parts = [], [(first, last)]
    while parts:
        a, b = parts.pop()
        (dx, dy), (x, y) = points[b] - points[a], (points[a : b + 1] - points[a]).T
        off = abs(dx * y - dy * x) / np.hypot(dx, dy) / tolerances[a : b + 1]
        k = a + int(off.argmax())
        if off.max() <= 1 or k in (a, b):
            ends.append(b)
        else:
            parts += [(a, k), (k, b)]
    return sorted(ends)


def moved_by_pseudo_inverse(points, feet, normals):
    rows = [[nx, ny, x * ny - y * nx] for (x, y), (nx, ny) in zip(points, normals, strict=True)]
    away = ((feet - points) * normals).sum(1)
    usual = max(np.median(np.abs(away)) / 0.6745, 0.01)
    root = 1 / np.hypot(1, away / (2 * usual))
    return np.linalg.pinv(root[:, None] * rows) @ (root * away)


def flatness_by_doubled_angles(normals, weights):
    (steep, flat), askew = weights @ normals**2, weights @ normals.prod(axis=1)
    half, turned = (steep + flat) / 2, np.hypot((steep - flat) / 2, askew)
    return (half - turned) / (half + turned)


def trials_one_by_one(share, sure):
    """Count until none has hit with a small enough probability."""
    count, missed = 0, 1.0
    while missed > 1 - sure:
        count, missed = count + 1, missed * (1 - share * share)
    return count


def nees_by_pseudo_inverse(poses, truths, covariances):
    """Each error, weighed by the inverse of its covariance on both sides."""
    off = np.column_stack([(poses - truths)[:, :2], np.angle(np.exp(1j * (poses - truths)[:, 2]))])
    pairs = zip(covariances, off, strict=True)
    return [error @ np.linalg.pinv(covariance) @ error for covariance, error in pairs]


def by_pseudo_inverse(normals, offsets, weights):
    root = np.sqrt(weights)
    return -np.linalg.pinv(normals * root[:, None], rcond=0.3) @ (offsets * root)


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


def missed_between_ends(seen, kept):
    """Cut at every end: each piece is seen or not, kept or not."""
    cuts = np.unique(np.concatenate([seen.ravel(), kept.ravel()]))
    middle = (cuts[1:] + cuts[:-1]) / 2
    inside = [
        ((spans[:, 0] <= middle[:, None]) & (middle[:, None] <= spans[:, 1])).any(axis=1)
        for spans in (seen, kept)
    ]
    return np.diff(cuts)[inside[0] & ~inside[1]].sum()


def quality_of_both_maps(before, after):
    """As a loop over walls, with the distance of `literal`."""
    worst = 0.0
    for walls, others in ((before, after), (after, before)):
        metres = [np.hypot(*(b - a)) for a, b in walls]
        errors = [min(literal.segment_distance(s, t) for t in others) for s in walls]
        worst = max(worst, np.dot(metres, errors) / sum(metres))
    return np.exp(-worst / 0.050)


def front_row_by_row(runs):
    """From the best quality down: a run stays where none so far is as good in the other two."""
    kept = []
    for q, r, m in sorted({(-q, -r, m) for q, r, m in runs.tolist()}):
        if not any(b <= r and c <= m for _, b, c in kept):
            kept.append((q, r, m))
    return [(-q, -r, m) for q, r, m in kept[::-1]]


def row_by_masked_argmax(points, quality):
    r = np.where(points[:, 0] >= quality, points[:, 1], -np.inf)
    return r.argmax() if np.isfinite(r).any() else -1


def surely_kept_by_millimetres(size, seen, min_length, forget):
    """Every tenth of a millimetre asked by itself; then each border to the nearest end."""
    ends = np.array(sorted({0.0, size, *(u for _, *two in seen for u in two)}))
    at = np.arange(0.00005, size, 0.0001)
    words = [{"gone": 1, "matches": -9, "hides": -9}[word] for word, _, _ in seen]
    counts = sum(
        w * ((low < at) & (at < high)) for w, (_, low, high) in zip(words, seen, strict=True)
    )
    away = np.concatenate([[False], counts >= 2, [False]])
    borders = np.flatnonzero(away[1:] != away[:-1]) * 0.0001
    borders = ends[abs(borders[:, None] - ends).argmin(axis=1)].reshape(-1, 2)
    borders = [two for two in borders if forget and two[1] - two[0] >= min_length]
    pieces = np.reshape([0.0, *np.ravel(borders), size], (-1, 2))
    return [two for two in pieces if not borders or two[1] - two[0] >= min_length]


def matches_with_helpers(a, b, distance, angle):
    turn = abs(axial_difference(segments.angle(a), segments.angle(b)))
    gaps = segments.point_distance(a, b), segments.point_distance(b, a)
    return np.min(gaps) < distance and turn < angle


def climb_by_argmax(value, pose, move, turn):
    moves = (np.indices((3, 3, 3)).reshape(3, -1).T - 1) * (move, move, turn)
    gains = np.array([value(pose + way) - value(pose) for way in moves])
    return pose + moves[gains.argmax()] * (gains.max() > 0)


def steady_fit_by_weights(points, s, range_, bearing):
    """One loop: what lies far off gets no weight, whether or not the angle rests yet."""
    weights, beams = np.ones(len(points)), points - s
    for _ in range(80):
        middle = np.average(points, axis=0, weights=weights)
        scatter = np.cov(points.T, aweights=weights)
        normal = np.linalg.eigh(scatter)[1][:, 0]
        along = beams @ normal / np.hypot(*beams.T)
        across = beams @ (-normal[1], normal[0])
        variances = (range_ * along) ** 2 + (bearing * across) ** 2
        weights = (((points - middle) @ normal) ** 2 <= 9 * variances) / variances
    return *middle, np.arctan2(normal[1], normal[0]), 0, 0, 0


def beam_about_a_centre(distance, angle, delay, ahead, rate):
    """Round a point that stands still, in complex numbers."""
    turned = np.exp(1j * rate * delay)
    way = (turned - 1) * ahead / (1j * rate) if rate else ahead * delay
    end = way + turned * distance * np.exp(1j * angle)
    return end.real, end.imag


def frontier_by_shifts(grid):
    found = np.zeros(grid.shape, bool)
    for i, j in np.argwhere(grid < 0.5):
        cross = grid[max(i - 1, 0) : i + 2, j], grid[i, max(j - 1, 0) : j + 2]
        found[i, j] = any((line == 0.5).any() for line in cross)
    return found.astype(int).tolist()


def cost_by_masked_average(reference, current, near, penalty):
    costs = []
    for s, some in zip(current, near, strict=True):
        sizes = segments.length(reference[some])
        away = [segment_distance(s, t) for t in reference[some]]
        costs.append(np.average(away, weights=sizes) if away else penalty)
    return np.average(costs, weights=segments.length(current))


def mean_of_complex_numbers(u, v, weight_u, weight_v):
    (a, b), (c, d) = (s @ [1, 1j] for s in (u, v))
    first, second = b - a, d - c
    second = second if (second / first).real > 0 else -second
    one, other = weight_u * abs(first), weight_v * abs(second)
    middle = (one * (a + b) + other * (c + d)) / 2 / (one + other)
    share = other * abs(second) ** 2 / (one * abs(first) ** 2 + other * abs(second) ** 2)
    way = first / abs(first) * np.exp(1j * share * np.angle(second / first))
    reach = [((end - middle) / way).real for end in (a, b, c, d)]
    return [((middle + t * way).real, (middle + t * way).imag) for t in (max(reach), min(reach))]


def scan_noise_by_a_loop(apart, scans, k, noise):
    own = [d for d, pair in zip(apart, scans, strict=True) if k in pair]
    square = spread(own) ** 2 - noise * noise
    return 0 if square < 0 else math.sqrt(square)


def far_ends_by_pairs(members):
    points = [tuple(p) for s in members for p in s]
    return max(((p, q) for p in points for q in points), key=lambda pair: math.dist(*pair))


def places_by_lstsq(rows, known):
    """What is known moves to the right side of each row; a solver does the rest."""
    held = ~np.isnan(known)
    matrix, right = np.zeros((len(rows), len(known))), np.zeros(len(rows))
    for k, (i, j, c, w) in enumerate(rows):
        matrix[k, i], matrix[k, j], right[k] = w**0.5, -(w**0.5), -c * w**0.5
    right -= matrix[:, held] @ known[held]
    places = known.copy()
    places[~held] = np.linalg.lstsq(matrix[:, ~held], right, rcond=None)[0]
    return places


def axes_one_wall_at_a_time(walls):
    """Votes in a list of quarters of a degree, by directions as complex numbers to the fourth."""
    way = [complex(*(end - start)) for start, end in np.asarray(walls, float)]
    axes = []
    for _ in walls:  # each axis takes one at least; a bug that takes none ends, too
        if sum(map(abs, way)) < 2:
            break
        votes = []
        for step in range(360):
            unit = np.exp(-4j * np.radians(step / 4))
            off = [abs(np.degrees(np.angle((w / abs(w)) ** 4 * unit))) / 4 for w in way]
            votes.append(sum(abs(w) * max(0, 1 - d / 6) for w, d in zip(way, off, strict=True)))
        axes.append(votes.index(max(votes)) / 4)
        unit = np.exp(-4j * np.radians(axes[-1]))
        way = [w for w in way if abs(np.degrees(np.angle((w / abs(w)) ** 4 * unit))) / 4 > 8]
    return axes


#: Exercise -> its answer. Some use helpers of the library, some lists or whole numbers.
RIGHT = {
    "ransac_trials": trials_one_by_one,
    "nees": nees_by_pseudo_inverse,
    "compose": composed_by_complex_numbers,
    "cast_ray": met_in_the_frame_of_the_beam,
    "axial_mean": lambda angles: np.angle(np.mean(np.exp(2j * angles))) / 2,
    "segments_all_round": lambda p, gap: extract_clusters(p, gap=gap, closed=True),
    "split": split_by_a_list,
    "least_translation": by_pseudo_inverse,
    "move_onto_walls": moved_by_pseudo_inverse,
    "flatness": flatness_by_doubled_angles,
    "edge_error": lambda first, second, relative: between(compose(first, relative), second),
    "carried_beam": beam_about_a_centre,
    "carried": lambda before, after, pose: compose(compose(after, inverse(before)), pose),
    "quality": quality_of_both_maps,
    "front": front_row_by_row,
    "best_run": row_by_masked_argmax,
    "missed_metres": missed_between_ends,
    "mean_wall_error": lambda p, w: segments.point_distance(p[:, None], w).min(axis=1).mean(),
    "pair_origin": lambda *both: np.average(
        segments.midpoint(both), axis=0, weights=segments.length(both)
    ),
    "matches": matches_with_helpers,
    "cell_of": lambda x, c, r: np.floor((x - c) / r),
    "frontier_cells": frontier_by_shifts,
    "pixel": lambda x, y, o, side, n: (int((o[1] + n * side - y) / side), int((x - o[0]) / side)),
    "capped_score": lambda p, pose, c: -np.fmin(cKDTree(c).query(transform(pose, p))[0], 0.2).sum(),
    "climb_diagonally": climb_by_argmax,
    "steady_fit": steady_fit_by_weights,
    "surely_kept": surely_kept_by_millimetres,
    "pose_cost": cost_by_masked_average,
    "mean_by_length": mean_of_complex_numbers,
    "scan_noise": scan_noise_by_a_loop,
    "building_axis": lambda a, w: np.angle((w * np.exp(4j * a)).sum()) / 4 % (np.pi / 2),
    "far_ends": far_ends_by_pairs,
    "places_between": places_by_lstsq,
    "axes_of": axes_one_wall_at_a_time,
    "memberships": lambda squares, noise: softmax(-np.log(np.append(squares, noise**2)))[:-1],
}
