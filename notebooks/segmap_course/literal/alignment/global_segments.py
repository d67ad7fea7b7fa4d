"""Global alignment (A 2.5.1; Elseberg, Creed and Lakaemper 2010): eq. 2.3 to 2.15, mended.

A match is (i, j, u, v, w): segment u of scan i corresponds to segment v of scan j with the weight
w, `exp(-D(u, v) / (2 sigma^2))` (2.7).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from segmap.arrays import Array
from segmap.metrics import segment_distance
from segmap.poses import transform
from segmap.segments import angle as angle_of

from ..lines import Segment, axial_difference, line_angle, line_of, seen_from

Match = tuple[int, int, Segment, Segment, float]
#: Two scans i and j, how far x_i should lie behind x_j, and the weight of that.
Row = tuple[int, int, float, float]


def least_squares(rows: Sequence[Row], count: int) -> list[float]:
    """The x with the least sum of `w (x_i - x_j + c)^2`, the first of them held at 0 (2.3).

    Sets up `B x = A` (2.4 to 2.6; *slip*: 2.6 lacks the minus before its first sum) and solves.
    """
    b, a = np.zeros((count, count)), np.zeros(count)
    for i, j, c, w in rows:
        b[i, i], b[j, j] = b[i, i] + w, b[j, j] + w
        b[i, j], b[j, i] = b[i, j] - w, b[j, i] - w
        a[i], a[j] = a[i] - w * c, a[j] + w * c
    return [0.0, *np.linalg.solve(b[1:, 1:], a[1:]).tolist()]


def similar_segments(
    walls: Sequence[Array],
    poses: Array,
    *,
    similar: float = 0.20,
    angle: float = math.radians(15),
    spread: float = 0.05,
) -> list[Match]:
    """Each two segments of two scans that may be one wall, and their weight (2.7)."""
    at = np.concatenate([transform(x, s) for s, x in zip(walls, poses, strict=True)])
    scan, way = np.repeat(np.arange(len(walls)), [len(s) for s in walls]), angle_of(at)
    away = segment_distance(at[:, None], at)
    alike = (away < similar) & (abs(np.sin(way[:, None] - way)) < math.sin(angle))
    pairs = np.argwhere(alike & (scan[:, None] < scan)).tolist()
    weights = np.exp(-away / (2 * spread))
    return [(scan[u], scan[v], at[u].tolist(), at[v].tolist(), weights[u, v]) for u, v in pairs]


def best_turns(matches: Sequence[Match], count: int) -> list[float]:
    """Turn of each scan, radians, that makes matched segments most parallel (2.8 to 2.11)."""
    rows = [(i, j, axial_difference(line_angle(u), line_angle(v)), w) for i, j, u, v, w in matches]
    return least_squares(rows, count)


def best_shifts(matches: Sequence[Match], count: int) -> list[tuple[float, float]]:
    """Shift of each scan, metres, that brings end points to the lines of their matches (2.12).

    Both ways: the ends of u to the line of v, and those of v to the line of u (2.13 to 2.15).
    """
    rows: tuple[list[Row], list[Row]] = ([], [])
    both = [*matches, *((j, i, v, u, w) for i, j, u, v, w in matches)]
    for i, j, u, v, w in both:
        line = line_of(v)
        for p in u:
            off = seen_from(line, p)[1]
            for axis, n in enumerate((-line[3], line[2])):
                rows[axis].append((i, j, off * n, w))
    return list(zip(*(least_squares(row, count) for row in rows), strict=True))


def all_at_once(walls: Sequence[Array], poses: Array, *, rounds: int = 15) -> Array:
    """Poses when all headings and all places were solved for in turn, with less and less spread.

    Walls are those of each scan, in its own frame; poses are those by the wheels, `(n, 3)`.
    """
    for spread in (0.05, 0.05 / 4, 0.05 / 10):
        for _ in range(rounds):
            matches = similar_segments(walls, poses, spread=spread)
            poses = poses + [(0, 0, turn) for turn in best_turns(matches, len(poses))]
            matches = similar_segments(walls, poses, spread=spread)
            poses = poses + [(x, y, 0) for x, y in best_shifts(matches, len(poses))]
    return poses
