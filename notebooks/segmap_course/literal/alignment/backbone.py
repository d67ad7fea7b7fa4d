"""Backbone (A 3.3.2, steps 5 to 7): which line a segment lies on, then the turn, then the shift."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from segmap.angles import axial_difference
from segmap.arrays import Array
from segmap.poses import transform
from segmap.segments import length

from ..lines import SAME, Line, Segment, line_angle, seen_from


def line_partner(s: Segment, lines: Sequence[Line] | Array, distance: float, angle: float) -> int:
    """Number of the nearest line with both ends within `distance`, at an angle below `angle`.

    -1 where there is none.
    """
    candidates = []
    for k, line in enumerate(lines):
        off = max(abs(seen_from(line, p)[1]) for p in s)
        turn = axial_difference(math.atan2(line[3], line[2]), line_angle(s))
        if off < distance and abs(turn) < angle:
            candidates.append((off, k))
    return min(candidates)[1] if candidates else -1


def mean_rotation(differences: Sequence[float] | Array, weights: Sequence[float] | Array) -> float:
    """Weighted mean of axial differences, radians (step 6)."""
    pairs = list(zip(differences, weights, strict=True))
    y, x = (sum(w * f(2 * d) for d, w in pairs) for f in (math.sin, math.cos))
    return math.atan2(y, x) / 2


def least_translation(
    normals: Sequence[Sequence[float]], offsets: Sequence[float], weights: Sequence[float]
) -> tuple[float, float]:
    """Shift, metres, with the least sum of `w (n . shift + offset)^2` (step 7).

    Where all normals are parallel the equations leave the motion along the lines free: of all best
    shifts the shortest.
    """
    rows = list(zip(normals, offsets, weights, strict=True))
    xx, xy, yy = (sum(w * n[i] * n[j] for n, _, w in rows) for i, j in ((0, 0), (0, 1), (1, 1)))
    bx, by = (-sum(w * d * n[k] for n, d, w in rows) for k in (0, 1))
    det, size = xx * yy - xy * xy, xx + yy
    if det > SAME * size * size:
        return (yy * bx - xy * by) / det, (xx * by - xy * bx) / det
    return bx / size, by / size


def translation_of(normals: Array, offsets: Array, weights: Array) -> Array:
    """Shift, (2,) metres, with the least sum of w (n . shift + offset)^2, where lines cross."""
    weighted = normals * weights[:, None]
    return np.asarray(-np.linalg.solve(weighted.T @ normals, weighted.T @ offsets))


def laid_on_lines(
    guess: Array, segments: Array, lines: Array, distance: float = 0.20, angle: float = np.pi / 18
) -> Array:
    """The guess turned, then shifted onto the lines on which its segments lie (steps 5 to 7)."""
    there = transform(guess, segments)
    partner = np.array([line_partner(s, lines, distance, angle) for s in there])
    seen, on = segments[partner >= 0], lines[partner[partner >= 0]]
    ways = np.array([line_angle(s) for s in there[partner >= 0]])
    asked = axial_difference(np.arctan2(on[:, 3], on[:, 2]), ways)
    turn = mean_rotation(asked, length(seen) ** 3)
    pose = guess + np.array([0, 0, turn])
    normals = np.repeat(np.column_stack([-on[:, 3], on[:, 2]]), 2, axis=0)
    ends = (transform(pose, seen) - on[:, None, :2]).reshape(-1, 2)
    offsets, weights = (ends * normals).sum(axis=1), np.repeat(length(seen), 2)
    return pose + np.append(translation_of(normals, offsets, weights), 0)
