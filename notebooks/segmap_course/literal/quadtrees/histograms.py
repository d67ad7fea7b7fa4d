"""Where a scan lies by sums along lines: histograms, and the Hough domain (B 2.2.1)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import cos, dist, floor, pi, sin

from ..lines import Point, line_angle, placed

Pose = tuple[float, float, float]


def angle_histogram(points: Sequence[Point], bins: int = 180, gap: float = 0.3) -> list[float]:
    """Lengths of the steps from point to point by their direction, over half a turn.

    Longer steps than the gap, metres, are no wall.

    Examples
    --------
    >>> angle_histogram([(0.0, 0.0), (0.2, 0.0), (0.2, 0.2), (0.2, 0.4)], bins=4)
    [0.2, 0.0, 0.4, 0.0]
    """
    lengths = [0.0] * bins
    for step in pairwise(points):
        if dist(*step) < gap:
            lengths[round(line_angle(step) % pi / pi * bins) % bins] += dist(*step)
    return lengths


def histogram(values: Sequence[float], size: float, first: float, count: int) -> list[float]:
    """How many values lie in each bin of a size from `first` on; others do not count.

    Examples
    --------
    >>> histogram([0.1, 0.3, 0.35], 0.2, 0.0, 3)
    [1.0, 2.0, 0.0]
    """
    counts = [0.0] * count
    for value in values:
        k = floor((value - first) / size)
        if 0 <= k < count:
            counts[k] += 1
    return counts


def best_shift(a: Sequence[float], b: Sequence[float], around: bool = False) -> tuple[float, int]:
    """How far b must move to lie best on a: the largest cross-correlation, and the shift in bins.

    Examples
    --------
    >>> best_shift([0, 0, 1, 2], [1, 2, 0, 0])
    (5, 2)
    """
    shifts = range(len(a)) if around else range(1 - len(b), len(a))
    sums = []
    for s in shifts:
        pairs = [((k + s) % len(a) if around else k + s, k) for k in range(len(b))]
        sums.append((sum(a[i] * b[k] for i, k in pairs if 0 <= i < len(a)), -abs(s), s))
    total, _, shift = max(sums)
    return total, shift


def match_histograms(map: Sequence[Point], scan: Sequence[Point], size: float = 0.1) -> Pose:
    """Pose of a scan on a map, points in order along the walls, metres: first the turn, then x, y.

    After Weiss et al. (1994). Of the two turns that directions of walls leave, the one with the
    larger sums.

    Examples
    --------
    >>> corner = [(k / 10, 0.0) for k in range(9)] + [(0.8, k / 10) for k in range(1, 5)]
    >>> [round(v, 1) + 0 for v in match_histograms(corner, [(x - 1, y) for x, y in corner])]
    [1.0, 0.0, 0.0]
    """
    _, turn = best_shift(angle_histogram(map), angle_histogram(scan), around=True)
    scored = []
    for heading in (turn * pi / 180, turn * pi / 180 + pi):
        turned = [placed(point, (0.0, 0.0, heading)) for point in scan]
        total, shifts = 1.0, []
        for axis in (0, 1):
            a, b = [p[axis] for p in map], [p[axis] for p in turned]
            count = [floor((max(v) - min(v)) / size) + 1 for v in (a, b)]
            bins = [histogram(v, size, min(v), n) for v, n in zip((a, b), count, strict=True)]
            same, shift = best_shift(bins[0], bins[1])
            total *= same
            shifts.append(shift * size + min(a) - min(b))
        scored.append((total, (shifts[0], shifts[1], heading)))
    return max(scored)[1]


def hough_lines(
    points: Sequence[Point], size: float, reach: float, angles: int
) -> list[list[float]]:
    """How many points lie on each line: for each direction of its normal, by distance.

    Examples
    --------
    >>> hough_lines([(1.0, 0.0), (1.0, 1.0)], 0.5, 2.0, 2)
    [[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0]]
    """
    normals = [(cos(k * pi / angles), sin(k * pi / angles)) for k in range(angles)]
    count = round(2 * reach / size)
    return [histogram([c * x + s * y for x, y in points], size, -reach, count) for c, s in normals]


def match_hough(
    map: Sequence[Point], scan: Sequence[Point], size: float = 0.1, angles: int = 180
) -> Pose:
    """Pose of a scan on a map, points, metres, by the Hough domain (Censi et al. 2005).

    The sum of squares of a direction, its spectrum, does not change where points move: its best
    shift is the turn. Then each direction says how far the scan moves along its normal; the
    strongest one and the one across are taken.

    Examples
    --------
    >>> corner = [(k / 10, 0.0) for k in range(9)] + [(0.8, k / 10) for k in range(1, 5)]
    >>> [round(v, 1) + 0 for v in match_hough(corner, [(x - 1, y) for x, y in corner], angles=36)]
    [1.0, 0.0, 0.0]
    """
    reach = max(dist(point, (0.0, 0.0)) for point in (*map, *scan)) + size
    lines = hough_lines(map, size, reach, angles)
    spectra = [
        [sum(n * n for n in row) for row in each]
        for each in (lines, hough_lines(scan, size, reach, angles))
    ]
    _, turn = best_shift(spectra[0], spectra[1], around=True)
    strong = spectra[0].index(max(spectra[0]))
    c, s = cos(strong * pi / angles), sin(strong * pi / angles)
    scored = []
    for heading in (turn * pi / angles, turn * pi / angles + pi):
        turned = hough_lines(
            [placed(point, (0.0, 0.0, heading)) for point in scan], size, reach, angles
        )
        total, along = 1.0, []
        for k in (strong, (strong + angles // 2) % angles):
            same, shift = best_shift(lines[k], turned[k])
            total *= same
            along.append(shift * size)
        across = -1 if strong >= angles // 2 else 1
        u, v = along[0], across * along[1]
        scored.append((total, (c * u - s * v, s * u + c * v, heading)))
    return max(scored)[1]
