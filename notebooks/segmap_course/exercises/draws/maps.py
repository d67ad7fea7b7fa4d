"""Hidden cases of the exercises on maps of segments: quality, comparing methods, reductions.

Each function draws the cases of the exercise of its name, as those of `_exercise_draws_scans` do.
What lies right on a border is made of binary fractions and never turned: no rounding decides.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform

from .scans import Drawn, Rng, anywhere


# -------------------------------------------------------------- reduction and quality
def reduction_rate(rng: Rng) -> Drawn:
    """Maps that lose some, all or none of their segments, and one that had none."""
    n = int(rng.integers(5, 30))
    m = int(rng.integers(1, n - 1))
    return {
        f"{a} segments before and {b} after": (np.zeros((a, 2, 2)), np.zeros((b, 2, 2)))
        for a, b in ((n, m), (n, n), (n + 3, 0), (0, 0))
    }


def quality(rng: Rng) -> Drawn:
    """Maps with more, fewer and as many segments after as before; a perfect one."""
    n = int(rng.integers(2, 5))
    wide = rng.uniform(0.005, 0.08, (n, n + 2))
    perfect = rng.uniform(0.1, 1, (n, n)) * (1 - np.eye(n))[rng.permutation(n)]
    return {
        "more segments after": (wide,),
        "fewer segments after": (rng.uniform(0.005, 0.08, (n + 2, n)),),
        "a perfect map": (perfect,),
        "one segment for several": (rng.uniform(0.005, 0.08, (n + 1, 1)),),
    }


def runs(rng: Rng) -> Array:
    """Quality and reduction of eight runs, in no order: every other one is beaten."""
    q = np.cumsum(rng.uniform(0.04, 0.09, 4)) + 0.5
    r = 0.8 - np.cumsum(rng.uniform(0.06, 0.12, 4))
    beaten = np.stack([q - rng.uniform(0.01, 0.03, 4), r - rng.uniform(0.02, 0.05, 4)], 1)
    return rng.permutation(np.concatenate([np.stack([q, r], 1), beaten]))


def _qualities(rng: Rng) -> list[tuple[str, Array, float]]:
    points = runs(rng)
    q = np.sort(points[points[:, 1].argsort()[::-1]][:, 0])
    asked = {
        "eight runs, a quality between two of them": (q[3] + q[4]) / 2 + rng.uniform(0, 0.005),
        "eight runs, the quality of one of them": points[int(rng.integers(8)), 0],
        "eight runs, a quality next to a bad one": q[4] + 0.001,
        "eight runs, a quality better than all": q[-1] + rng.uniform(0.01, 0.1),
        "eight runs, a quality worse than all": q[0] - rng.uniform(0.01, 0.1),
    }
    return [(words, points, float(least)) for words, least in asked.items()]


def reduction_at(rng: Rng) -> Drawn:
    """One set of runs, asked between them, at them, above and below all."""
    return {words: (points, least) for words, points, least in _qualities(rng)}


def best_run(rng: Rng) -> Drawn:
    """The same."""
    return {words: (points, least) for words, points, least in _qualities(rng)}


# ------------------------------------------------------------------- walls and points
def mean_wall_error(rng: Rng) -> Drawn:
    """Points beside walls and beyond their ends; more points than walls, and fewer."""
    walls = rng.uniform(-4, 4, (4, 2, 2))
    points = np.concatenate([walls.mean(1), 1.5 * walls[:, 1] - 0.5 * walls[:, 0]])
    points += rng.uniform(-0.3, 0.3, points.shape)
    return {
        f"{n} points, {m} walls": (rng.permutation(points)[:n], walls[:m])
        for n, m in ((8, 4), (1, 4), (5, 1), (3, 3))
    }


def verdict(rng: Rng) -> Drawn:
    """A wall with points on every side, placed anywhere; what is right on the border stays put."""
    place, away, half = anywhere(rng), rng.uniform(2, 4), rng.uniform(1, 2)
    wall, d = np.array([(-half, away), (half, away)]), np.array(0.125)
    x = half * rng.uniform(0.2, 0.5)

    def case(point: Any, ends: Array = wall) -> tuple[Any, ...]:
        return transform(place, ends), transform(place, np.array([point]))[0], place[:2], d

    border = np.array([(1.0, 3.0), (5.0, 3.0)]) + rng.integers(-8, 9, 2) / 8
    sensor = border[0] - (1, 3)
    return {
        "a point on the wall": case((x, away)),
        "a point before the wall": case((x / 2, away / 2)),
        "a point behind the wall": case((-x, away + 0.5)),
        "a point before the wall, its ends swapped": case((x / 2, away / 2), wall[::-1]),
        "a point behind the wall, its ends swapped": case((x, away + 0.5), wall[::-1]),
        "a point beside the sector": case((half + 1, away)),
        "a point behind the sensor": case((-x, -away)),
        "a glancing look, a little behind": case((0.95 * half, away + 0.11)),
        "a point 0.125 m behind the wall": (border, sensor + (3, 3.125), sensor, d),
        "a point far behind, on a ray that passes the wall": case((1.1 * half, 2 * away)),
    }


def invented_metres(rng: Rng) -> Drawn:
    """Gaps between members, before and behind them; members inside others; no member."""
    gap, a, b = rng.integers(5, 20) / 100, *rng.integers(100, 300, 2) / 100

    def case(whole: float, *spans: tuple[float, float]) -> tuple[Any, ...]:
        return np.array(spans, float).reshape(-1, 2), np.array(whole), np.array(gap)

    return {
        "one member as long as the segment": case(a, (0, a)),
        "two members and a hole, the last one first": case(a + b + 1, (a + 1, a + b + 1), (0, a)),
        "a short member inside a long one": case(a + b, (0, a), (0.3, 0.6), (a + 0.5, a + b)),
        "a gap shorter than the limit": case(a + b, (0, a), (a + 0.6 * gap, a + b)),
        "nothing kept at the start": case(a + b, (a, a + b)),
        "nothing kept at the end": case(a + b, (0, a / 2), (a / 2, a)),
        "no member at all": case(a),
        "no member, a segment shorter than the gap": case(0.7 * gap),
    }


# ------------------------------------------------------------------- Basic and Hybrid
def wall(middle: tuple[float, float], size: float, degrees: float) -> Array:
    """A segment (2, 2) about its middle."""
    half = size / 2 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    return np.array([middle - half, middle + half])


def matches(rng: Rng) -> Drawn:
    """Pairs that match and pairs that fail one of the tests, placed anywhere where that is safe."""
    place, shift = anywhere(rng), rng.integers(-8, 9, 2) / 4
    size, lean = rng.uniform(1.5, 3), rng.uniform(3, 7)
    limits = 0.25, np.radians(rng.uniform(8, 12))
    flat, low, high = (wall((-size / 2, 0), size, d) for d in (0, 1, 179))
    next_to = wall((1.1, 0), 2, lean)

    def placed(a: Array, b: Array, *given: float) -> tuple[Any, ...]:
        return transform(place, a), transform(place, b), *(given or limits)

    corner = wall((0, size / 2), size, 90)
    border = np.array([[(0.0, 0), (2, 0)], [(2.25, 0), (4, 0)]]) + shift
    return {
        "end to end on one wall": placed(flat, next_to),
        "the same, with swapped ends": placed(flat, next_to[::-1]),
        "walls at 1 and 179 degrees": (low + shift, high + (size, 0) + shift, *limits),
        "a corner": placed(flat, corner),
        "a corner, to 1 degree": placed(flat, corner, 0.25, np.radians(1)),
        "a piece beside the middle of a wall": placed(flat, wall((-size / 2, 0.02), size / 3, 0)),
        "two walls that begin together": placed(flat, wall((0, 0.1), 2 * size, 0)),
        "walls turned by 30 degrees": placed(flat, wall((0.75, 0.4), 1.6, 30)),
        "ends exactly 0.25 m apart": (*border, *limits),
        "middles that meet and ends that do not": placed(flat, wall((-size / 2, 0), size + 2, 2)),
    }


def merged(rng: Rng) -> Drawn:
    """Pieces of one wall, end to end and overlapping, in all directions."""
    size, lean, way = rng.uniform(2, 4), rng.uniform(3, 8), rng.uniform(20, 60)
    flat = wall((size / 2, 0), size, 0)
    return {
        "two pieces of one wall": (flat, wall((size + 0.7, 0.1), 1, lean)),
        "a short piece that overlaps a long one": (
            wall((0, 0), size, way),
            wall((0.8, 1), 1, way + lean),
        ),
        "walls at 1 and 179 degrees": (wall((1, 0), size, 1), wall((size, 0), 1, 179)),
        "upright walls": (wall((0, 2), size, 85), wall((0.1, 4), 0.7 * size, 90 + lean)),
        "a piece in the middle of a wall": (flat, wall((size / 2, 0.05), 0.5, lean)),
    }


def hough(rng: Rng) -> Drawn:
    """Walls of all directions, and an angle on this side of the seam or beyond it."""

    def case(ends: Any, turns: int) -> tuple[Any, ...]:
        (x, y) = np.subtract(ends[1], ends[0])
        near = np.arctan2(x, -y) + np.radians(rng.uniform(-50, 50)) + turns * np.pi
        return np.array(ends, float), float(near)

    x, y, size = *rng.uniform(1, 4, 2), rng.uniform(1, 3)
    return {
        f"{words}, near a direction": case(ends, turns)
        for words, ends, turns in (
            ("a slanted wall", [(x, y), (x + size, y + 0.7 * size)], 0),
            ("the same wall, named after half a turn", [(x, y), (x + size, y + 0.7 * size)], 1),
            ("an upright wall", [(x, -y), (x, size)], 0),
            ("an upright wall, named after half a turn", [(x, -y), (x, size)], 1),
            ("a level wall below the origin", [(x, -y), (-size, -y)], -1),
            ("a wall that leans to the left", [(-x, y), (-x - 0.1, y + size)], 2),
            ("a slanted wall, named after three half turns", [(-x, y), (-x - size, -y)], 3),
        )
    }


def memberships(rng: Rng) -> Drawn:
    """Points on a wall, between walls, and far from all."""
    near, far = rng.uniform(1e-5, 1e-3), rng.uniform(0.2, 1, 3)
    noise = np.array(rng.uniform(0.05, 0.3))
    return {
        "on one wall, far from another": (np.array([near, far[0]]), noise),
        "between three walls": (rng.uniform(0.005, 0.02, 3), noise),
        "far from all": (far, noise),
    }


# -------------------------------------------------------------- mean shift and Fusion
def pieces_case(centres: Any, pieces: Any, sigma: float, slack: float) -> tuple[Any, ...]:
    """Angles in degrees; `slack` is the angle, in degrees, that counts as much as sigma."""
    scale = [1, 1, np.pi / 180]
    places = np.array(centres, float) * scale, np.array(pieces, float) * scale
    return (*places, sigma, float(np.radians(slack)) / sigma)


def mean_shift_step(rng: Rng) -> Drawn:
    """Pieces of walls at any angle, so near that none is beyond the three sigma of the thesis."""

    def about(middle: float, count: int) -> Array:
        place = np.array([1, 2, middle]) + rng.uniform(-1, 1, (count, 3)) * (0.08, 0.08, 6)
        return place % (1e6, 1e6, 180)

    sigma, slack, way = rng.uniform(0.15, 0.3), rng.uniform(8, 14), rng.uniform(40, 140)
    return {
        "two pieces": pieces_case(about(way, 1), about(way, 2), sigma, slack),
        "two centres among four pieces": pieces_case(about(way, 2), about(way, 4), sigma, slack),
        "walls on both sides of 0 degrees": pieces_case(
            [(1, 2, 2)], [(1, 2, rng.uniform(1, 5)), (1.1, 2, rng.uniform(174, 179))], sigma, slack
        ),
        "a centre that turned past 180 degrees": pieces_case(
            about(0, 1) % (1e6, 1e6, 5) + (0, 0, 180), about(0, 5), sigma, slack
        ),
    }


def inside_strip(rng: Rng) -> Drawn:
    """Segments inside, outside and half inside a strip; ends right on its border."""
    offsets, width = rng.uniform(-0.08, 0.08, (12, 2)), rng.uniform(0.03, 0.05)
    edge = int(rng.integers(2, 8)) / 64
    return {
        "a line that is not moved": (offsets, 0.0, width),
        "a line moved up": (offsets, rng.uniform(0.01, 0.03), width),
        "a line moved down": (offsets, -rng.uniform(0.01, 0.03), width),
        "ends that lie right on the border": (np.array([(0, edge), (-edge, 0)]), 0.0, edge),
    }


def strip_case(offsets: Any, lengths: Any, tolerance: int = 4) -> tuple[Any, ...]:
    """A segment of 3 m on the line and others; offsets in 64ths of a metre, free of rounding."""
    rows = np.array([(0, 0), *offsets]) / 64
    return rows, np.array([3, *lengths], float), tolerance / 64


def best_shift(rng: Rng) -> Drawn:
    """Segments above and below the line that a shift takes in, and others that none does."""
    e = int(rng.integers(3, 7))
    up, down, long = e + 1, -e - 1, 1.5 + 0.25 * int(rng.integers(0, 4))
    return {
        "a long segment above, a short one below": strip_case(
            [(up, up + 1), (down, 0)], [long, 1], e
        ),
        "a long segment above, three short ones below": strip_case(
            [(up, up), (down, down), (down, down), (down, down)], [long, 0.25, 0.25, 0.25], e
        ),
        "a segment below": strip_case([(down - 1, down)], [long], e),
        "a longer wall far away": strip_case([(20, 20), (20, 21)], [2.75, long], e),
        "nothing to gain": strip_case([(e - 2, e - 1)], [1], e),
        "a slanted segment, one of its ends near": strip_case([(up, up + 2 * e + 2)], [long], e),
    }


def pose_covariance(rng: Rng) -> Drawn:
    """Walls ahead, aside and aslant, seen from anywhere, and a place that is known exactly."""
    place, heading = rng.uniform(0.01, 0.05, 2)
    turn, at = rng.uniform(-np.pi, np.pi, 4), rng.uniform(-5, 5, (8, 2))
    ahead = at[1] + rng.uniform(1, 3) * np.array([np.cos(turn[0]), np.sin(turn[0])])
    aside = at[1] + rng.uniform(1, 3) * np.array([-np.sin(turn[1]), np.cos(turn[1])])
    return {
        "a wall straight ahead": (ahead, float(turn[0]), at[1], place, heading),
        "a wall along which the sensor looks": (aside, float(turn[1]), at[1], place, heading),
        "a slanted wall": (at[2], float(turn[2]), at[3], place, heading),
        "a place known exactly": (at[4], float(turn[3]), at[5], 0.0, heading),
    }
