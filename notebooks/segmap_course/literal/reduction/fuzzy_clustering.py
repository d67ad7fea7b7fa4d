"""Fuzzy clustering (A 2.7.6; Ip et al. 2002), a reconstruction: A gives its frame, no formula.

The clustering is Dave's adaptive fuzzy clustering with a noise cluster, the grouping Krishnapuram
and Freg's merging of compatible clusters (1990-1992), which fit A's words.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from ..lines import (
    SAME,
    Found,
    Point,
    Segment,
    axial_difference,
    by_scan,
    gap_along,
    segment_length,
    spanning,
)
from ..points import Sums, points_behind, sums_of

#: Row and column of a cell.
Cell = tuple[int, int]
#: Angle, radians, distance and gap, metres, within which two clusters are one.
Limits = tuple[float, float, float]


class Prototype(NamedTuple):
    """A cluster while it forms: centre, unit direction, and mixing: 1 for a line, 0 for a point."""

    x: float
    y: float
    dx: float
    dy: float
    mixing: float = 1.0

    def square(self, p: Point) -> float:
        """Squared distance of a point, across the direction more than along it."""
        u, v = p[0] - self.x, p[1] - self.y
        along = u * self.dx + v * self.dy
        return max(u * u + v * v - self.mixing * along * along, 1e-12)


@dataclass(eq=False)
class Cluster:
    """Running sums, the known part of their line, points of each input; its wall in the buffer."""

    sums: Sums
    ends: Segment
    counts: dict[int, int]
    wall: Cluster | None = None

    def absorb(self, other: Cluster) -> None:
        """Sums add; the line of the sums spans what both did."""
        self.sums = self.sums + other.sums
        self.ends = on_line(self.sums, [*self.ends, *other.ends])
        for i, count in other.counts.items():
            self.counts[i] = self.counts.get(i, 0) + count


def cell_of(p: Point, cell: float, corner: Point) -> Cell:
    """Row and column of the cell of a point."""
    return math.floor((p[1] - corner[1]) / cell), math.floor((p[0] - corner[0]) / cell)


def clipped(s: Segment, cell: float, corner: Point) -> list[tuple[Cell, Prototype]]:
    """Step 1: a prototype for each piece of a segment, in the cells that it passes through."""
    (ax, ay), (bx, by) = s
    size, cuts = segment_length(s), {0.0, 1.0}
    for a, b, c in ((ax, bx, corner[0]), (ay, by, corner[1])):
        low, high = math.floor((min(a, b) - c) / cell), math.floor((max(a, b) - c) / cell)
        cuts |= {((c + k * cell) - a) / (b - a) for k in range(low + 1, high + 1)}
    found = []
    for t0, t1 in pairwise(sorted(min(max(t, 0.0), 1.0) for t in cuts)):
        if (t1 - t0) * size > SAME:
            x, y = ax + (t0 + t1) / 2 * (bx - ax), ay + (t0 + t1) / 2 * (by - ay)
            start = Prototype(x, y, (bx - ax) / size, (by - ay) / size)
            found.append((cell_of((x, y), cell, corner), start))
    return found


def moved(old: Prototype, points: Sequence[Point], u: Sequence[float]) -> Prototype:
    """The prototype of points with memberships u."""
    sums = sums_of(points, [w * w for w in u])
    both, spread = sums.xx + sums.yy, math.hypot(sums.xx - sums.yy, 2 * sums.xy)
    if both + spread <= 0:
        return Prototype(sums.x, sums.y, *old[2:])
    theta = sums.direction()
    mixing = 1 - max(both - spread, 0.0) / (both + spread)
    return Prototype(sums.x, sums.y, math.cos(theta), math.sin(theta), mixing)


def memberships(p: Point, prototypes: Sequence[Prototype], noise: float) -> list[float]:
    """Step 2: what share of a point belongs to each prototype; noise has the rest."""
    weights = [1 / q.square(p) for q in prototypes]
    total = sum(weights) + 1 / (noise * noise)
    return [w / total for w in weights]


def clustered(
    points: Sequence[Point], starts: Sequence[Prototype], noise: float
) -> list[Prototype]:
    """Step 2: move prototypes until no membership changes; drop those that are left with little."""
    found, before = list(starts), list[list[float]]()
    for _ in range(100):
        u = [memberships(p, found, noise) for p in points]
        kept = [i for i in range(len(found)) if sum(row[i] * row[i] for row in u) >= 2]
        if len(kept) < len(found):
            found, before = [found[i] for i in kept], []
            continue
        pairs = zip(u, before, strict=True) if before else ()
        changes = [abs(a - b) for row, old in pairs for a, b in zip(row, old, strict=True)]
        if not found or (before and max(changes) < 1e-6):
            break
        found = [moved(q, points, [row[i] for row in u]) for i, q in enumerate(found)]
        before = u
    return found


def chosen(p: Point, prototypes: Sequence[Prototype], noise: float) -> int:
    """Step 3: the prototype of the largest membership, the first of equals; -1 for noise."""
    u = memberships(p, prototypes, noise)
    most = max(u, default=0.0)
    if 1 - sum(u) > most + SAME:
        return -1
    return next(i for i, share in enumerate(u) if share >= most - SAME)


def on_line(sums: Sums, points: Sequence[Point]) -> Segment:
    """The part of the line of running sums that points span."""
    return spanning(sums.x, sums.y, sums.direction(), points)


def clusters_of(
    own: Sequence[tuple[int, Point]],
    starts: Sequence[Prototype],
    noise: float,
    least: tuple[int, float],
) -> list[Cluster]:
    """Steps 2 and 3: what the points of a scan in one cell, each with its segment, become."""
    found, made = clustered([p for _, p in own], starts, noise), list[Cluster]()
    picks = [chosen(p, found, noise) for _, p in own]
    for k in range(len(found)):
        mine = [entry for entry, pick in zip(own, picks, strict=True) if pick == k]
        if len(mine) < least[0]:
            continue
        sums = sums_of([p for _, p in mine])
        ends = on_line(sums, [p for _, p in mine])
        if segment_length(ends) >= least[1]:
            made.append(Cluster(sums, ends, {i: sum(j == i for j, _ in mine) for i, _ in mine}))
    return made


def alike(a: Cluster, b: Cluster, limits: Limits) -> bool:
    """Step 4: parallel, on one line, and near each other."""
    angle, distance, gap = limits
    ta, tb = a.sums.direction(), b.sums.direction()
    turn = axial_difference(ta, tb)
    if abs(turn) >= angle:
        return False
    for one, other, theta in ((a, b, tb), (b, a, ta)):
        x = (one.ends[0][0] + one.ends[1][0]) / 2 - other.sums.x
        y = (one.ends[0][1] + one.ends[1][1]) / 2 - other.sums.y
        if abs(y * math.cos(theta) - x * math.sin(theta)) >= distance:
            return False
    return gap_along(a.ends, b.ends, tb + turn / 2) <= gap + SAME


def wall_of(cluster: Cluster) -> Cluster:
    """What a cluster is in by now: a wall of the buffer, or itself."""
    return cluster if cluster.wall is None else wall_of(cluster.wall)


def unite(a: Cluster, b: Cluster) -> None:
    """Cluster, or wall, a absorbs b; what a is in then has what b is in."""
    mine, its = wall_of(a), wall_of(b)
    a.absorb(b)
    b.wall = a
    if mine is not a and mine is not its:
        mine.absorb(its)
        its.wall = mine


def group(items: list[Cluster], limits: Limits) -> None:
    """Step 4: each item absorbs those after it that are alike, until none is."""
    more = True
    while more:
        more = False
        for i, a in enumerate(items):
            for b in items[i + 1 :]:
                if alike(a, b, limits):
                    unite(a, b)
                    items.remove(b)
                    more = True


def group_across(
    cells: dict[Cell, list[Cluster]], updated: set[Cell], buffer: list[Cluster], limits: Limits
) -> None:
    """Step 5: clusters become walls of the buffer; those of a cell and its neighbours are grouped.

    The buffer remembers its members: a wall absorbs what they absorb.
    """
    for cluster in (c for place in sorted(updated) for c in cells[place] if c.wall is None):
        cluster.wall = Cluster(cluster.sums, cluster.ends, dict(cluster.counts))
        buffer.append(cluster.wall)
    for row, column in sorted(updated):
        around = [(row + r, column + c) for r in (-1, 0, 1) for c in (-1, 0, 1)]
        near = {id(wall_of(c)) for place in around for c in cells.get(place, [])}
        group([wall for wall in buffer if id(wall) in near], limits)


def fuzzy_clustering(
    segments: Sequence[Segment],
    scans: Sequence[int],
    *,
    points: Sequence[Sequence[Point]] | None = None,
    cell: float = 2.0,
    corner: Point = (0.0, 0.0),
    noise: float = 0.10,
    angle: float = math.radians(10),
    distance: float = 0.10,
    gap: float = 0.30,
    every: int = 10,
    min_points: int = 5,
    min_length: float = 0.10,
    spacing: float = 0.05,
) -> Found:
    """Cluster each scan cell by cell, group in its cells, and now and then across them."""
    behind, limits = points_behind(segments, points, spacing), (angle, distance, gap)
    least = max(min_points, 2), max(min_length, 10 * SAME)
    cells: dict[Cell, list[Cluster]] = {}
    buffer, updated, used = list[Cluster](), set[Cell](), by_scan(segments, scans)
    for done, new in enumerate(used, 1):
        pieces = [piece for i in new for piece in clipped(segments[i], cell, corner)]
        dealt = [(cell_of(p, cell, corner), (i, p)) for i in new for p in behind[i]]
        for place in sorted({place for place, _ in pieces}):
            own = [entry for spot, entry in dealt if spot == place]
            starts = [start for spot, start in pieces if spot == place]
            found = clusters_of(own, starts, noise, least)
            if found:
                cells.setdefault(place, []).extend(found)
                group(cells[place], limits)
                updated.add(place)
        if done % every == 0 or done == len(used):
            group_across(cells, updated, buffer, limits)
            updated.clear()
    walls = [wall for wall in buffer if wall.wall is None]
    held = [[wall.counts.get(i, 0) for wall in walls] for i in range(len(segments))]
    return [w.ends for w in walls], [h.index(max(h)) if any(h) else -1 for h in held]
