"""Mean shift (A 4.3, 5.5): every centre and every piece at every step.

As in the fast version, what lies beyond three deviations does not pull (at three it does), and a
piece perpendicular to a centre turns it neither way.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from ..lines import SAME, Segment, axial_difference, chains, line_angle, segment_length

TIE = 1e-9
Vector = list[float]


class Piece(NamedTuple):
    """A piece of a segment: middle and angle, the segment's number, and its end points."""

    place: Vector
    owner: int
    ends: list[Vector]


def cut(segments: Sequence[Segment], sigma: float) -> list[Piece]:
    """Equal pieces of the segments, as few as are no longer than sigma, metres (A 4.3.2)."""
    pieces = []
    for owner, (p, q) in enumerate(segments):
        size = segment_length((p, q))
        count = max(math.ceil(size / sigma - TIE), 1) if size >= SAME else 0
        for k in range(count):
            ends = [[p[c] + t / count * (q[c] - p[c]) for c in (0, 1)] for t in (k, k + 1)]
            middle = [(ends[0][c] + ends[1][c]) / 2 for c in (0, 1)]
            pieces.append(Piece([*middle, line_angle((p, q))], owner, ends))
    return pieces


def difference(p: Vector, q: Vector) -> Vector:
    """From q to p; of a third coordinate, an angle, the axial difference."""
    turns = [axial_difference(a, b) for a, b in zip(p[2:], q[2:], strict=True)]
    return [p[0] - q[0], p[1] - q[1], *turns]


def climb(points: list[Vector], square: Callable[[Vector], float], stop: float) -> list[Vector]:
    """Where centres that start at the points rest: each moves to the weighted mean of the points.

    `square` is the squared length of a difference, in deviations of the kernel (A 4.8, 4.10).
    """
    centres, largest = points, math.inf
    while largest > stop:
        moves = [mean_difference(points, centre, square) for centre in centres]
        centres = [moved(*pair) for pair in zip(centres, moves, strict=True)]
        largest = max((math.sqrt(square(move)) for move in moves), default=0.0)
    return centres


def moved(p: Vector, d: Vector) -> Vector:
    """A point and a difference, added."""
    return [c + m for c, m in zip(p, d, strict=True)]


def mean_difference(
    points: list[Vector], centre: Vector, square: Callable[[Vector], float]
) -> Vector:
    """Mean of the differences of points from a centre, weighted with the kernel."""
    total, sums = 0.0, [0.0] * len(centre)
    for point in points:
        d = difference(point, centre)
        if (q := square(d)) <= (3 * (1 + TIE)) ** 2:
            d[2:] = [0.0 if abs(turn) >= math.pi / 2 * (1 - TIE) else turn for turn in d[2:]]
            weight = math.exp(-q / 2)
            total, sums = total + weight, moved(sums, [weight * c for c in d])
    return [s / total for s in sums]


def linked(
    points: list[Vector], square: Callable[[Vector], float], bound: float
) -> list[list[int]]:
    """Chains of points closer than a bound, in deviations (A 4.3.3)."""
    return chains(
        len(points), lambda i, j: square(difference(points[i], points[j])) < bound * bound
    )


def mean_shift(
    segments: Sequence[Segment], *, sigma: float = 0.20, bandwidth: float = math.pi / 18 / 0.20
) -> tuple[list[list[Vector]], list[int]]:
    """Outputs by their lowest piece, and the output with the longest share of each input."""

    def square(d: Vector) -> float:
        return (d[0] ** 2 + d[1] ** 2 + (d[2] / bandwidth) ** 2) / sigma**2

    pieces = cut(segments, sigma)
    centres = climb([piece.place for piece in pieces], square, 1 / 200)
    found = []
    for cluster in linked(centres, square, 2.0):
        s = sum(math.sin(2 * centres[i][2]) for i in cluster)
        c = sum(math.cos(2 * centres[i][2]) for i in cluster)
        found += lines_of(pieces, cluster, math.atan2(s, c) / 2, sigma)
    found.sort(key=lambda entry: min(entry[0]))
    parents = []
    for owner in range(len(segments)):
        held = [sum(pieces[i].owner == owner for i in members) for members, _ in found]
        parents.append(held.index(max(held)) if any(held) else -1)
    return [ends for _, ends in found], parents


def lines_of(
    pieces: list[Piece], cluster: list[int], theta: float, sigma: float
) -> list[tuple[list[int], list[Vector]]]:
    """Phase 2 in one cluster of direction theta: the members and the end points of each output."""
    dx, dy = math.cos(theta), math.sin(theta)

    def square(d: Vector) -> float:  # A 4.12; 4.15 has the sign of b reversed
        u, v = d[0] * dx + d[1] * dy, d[1] * dx - d[0] * dy
        return ((u / (2 * sigma)) ** 2 + (v / (sigma / 10)) ** 2) / 2

    centres = climb([pieces[i].place[:2] for i in cluster], square, 1 / 200 / math.sqrt(2))
    found = []
    for chain in linked(centres, square, math.sqrt(1 / 2)):
        x, y = (sum(centres[i][c] for i in chain) / len(chain) for c in (0, 1))
        spans = [
            sorted((e[0] - x) * dx + (e[1] - y) * dy for e in pieces[cluster[i]].ends)
            for i in chain
        ]
        for part in overlapping(spans):
            ends = min(spans[k][0] for k in part), max(spans[k][1] for k in part)
            members = [cluster[chain[k]] for k in part]
            found.append((members, [[x + w * dx, y + w * dy] for w in ends]))
    return found


def overlapping(spans: list[Vector]) -> list[list[int]]:
    """Chains of intervals (low, high) that overlap or lie at most 1e-9 m apart (A 4.3.5)."""

    def touch(i: int, j: int) -> bool:
        return spans[i][0] <= spans[j][1] + SAME and spans[j][0] <= spans[i][1] + SAME

    return chains(len(spans), touch)
