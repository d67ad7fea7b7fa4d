"""Fuzzy clustering (A 2.7.6; Ip et al. 2002), a reconstruction: A gives its frame, no formula."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ... import arrays
from ...arrays import Array, Count, Metres, Segments, at_least, checked
from .._points import MOST_SPACED_POINTS, points_behind
from .._runner import Indices, Length, Reduction, Rows, Steps, Turn, run_online
from ._prototypes import Prototype, pick_prototypes, settle
from .lines import (
    SAME,
    Point,
    Segment,
    Sums,
    axial_difference,
    gap_along,
    holds_most,
    segment_length,
    spanning,
    sums_of,
)

#: Row and column of a cell.
Cell = tuple[int, int]
#: Angle, radians, distance and gap, metres, within which two clusters are one.
Limits = tuple[float, float, float]
#: Rows and columns of cells have smaller numbers than this.
MOST_CELLS = 1 << 31


@checked
def fuzzy_clustering(
    map: Segments,
    *,
    cell: Metres = 2.0,
    corner: ArrayLike = (0.0, 0.0),
    noise: Metres = 0.10,
    angle: Turn = np.pi / 18,
    distance: Metres = 0.10,
    gap: Length = 0.30,
    every: Count = 10,
    min_points: Annotated[Count, at_least(0)] = 5,
    min_length: Length = 0.10,
    spacing: Metres = 0.05,
) -> Reduction:
    """Cluster the points of each scan in cells, and group what is alike: a reconstruction.

    A 2.7.6 gives the frame of Ip et al. 2002 and no formula of it. Here the clustering is Dave's
    adaptive fuzzy clustering with a noise cluster, and the grouping Krishnapuram and Freg's merging
    of compatible clusters (1990 to 1992): they fit A's words, and more is not known.

    The points of a scan are dealt to square cells. In each, clusters begin at the pieces of the
    scan's segments, and move until no membership changes; noise takes what is far from all. After
    each scan the clusters of a cell that are parallel, on one line and near become one; now and
    then, and at the end, so do those of neighbouring cells, in a global buffer.

    Along its line a cluster knows no distance: a door in one cell of one scan is walled up. Looks
    at one wall share its points, so that more than some 15 of them in one scan vanish. Walls end at
    cells until they are grouped, and what is short there is dropped. Moving the map by whole cells
    moves the result; other moves and turns change which points share a cell.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Scans come in ascending order. Without points they are put along the segments.
    cell
        Side of a cell: 2 m has few walls in each scan.
    corner : (2,) array
        A corner of a cell.
    noise
        Distance of the noise from every point: what is farther from all clusters is noise.
    angle, distance, gap
        Two clusters are one wall where all three differ by no more than this.
    every
        Scans between two groupings across cells.
    min_points, min_length
        Clusters with less are dropped.
    spacing
        As in `weighted_line_fitting`.

    Returns
    -------
    Reduction
        The global buffer, then what is in no group, by rows of cells. The parent of a segment has
        most of its points; -1 where all were noise, or too few; with seconds and segments in the
        map for each scan. The time of a global grouping belongs to the scan before it.

    Raises
    ------
    ValueError
        For cells that suit no map.

    References
    ----------
    Ip, Rad, Chow, Wong, "Segment-based map building using enhanced adaptive fuzzy clustering
    algorithm for mobile robot applications", J. Intelligent and Robotic Systems 35, 2002.

    Examples
    --------
    >>> wall = [[(0, 1), (4, 1)], [(0.5, 1.04), (3.5, 1.04)], [(1, 0), (1, 0.8)]]
    >>> reduction = fuzzy_clustering(wall)
    >>> reduction, reduction.parents
    (Reduction(fuzzy_clustering: 3 -> 2 segments), array([0, 0, 1]))
    """
    origin = arrays.point(corner, "corner")
    least, limits = (max(min_points, 2), max(min_length, 10 * SAME)), (angle, distance, gap)

    def steps(rows: Rows) -> Steps:
        _check_cells(rows.segments, cell, origin)
        points, first, _, _ = points_behind(map, rows, spacing)
        spots = np.floor((points - origin) / cell).astype(np.int64)[:, ::-1]
        s, scans = rows.segments.tolist(), len(rows.cuts) - 1
        owner = np.repeat(np.arange(len(s)), np.diff(first))
        cells: dict[Cell, list[Cluster]] = {}
        buffer, updated = list[Cluster](), set[Cell]()
        for done, (begin, stop) in enumerate(rows.scans(), 1):
            seen = first[begin] + np.lexsort(spots[first[begin] : first[stop]].T[::-1])
            cuts = np.flatnonzero(np.diff(spots[seen], axis=0).any(1)) + 1
            own = {tuple(spots[k[0]].tolist()): k for k in np.split(seen, cuts) if len(k)}
            starts = {at: list[Prototype]() for at in own if len(own[at]) >= least[0]}
            for i in range(begin, stop):
                for place, start in clip_to_cells(s[i], cell, origin.tolist()):
                    starts.get(place, []).append(start)
            for place in (place for place in starts if starts[place]):
                if len(own[place]) * len(starts[place]) > MOST_SPACED_POINTS:
                    raise ValueError(
                        f"cell must be smaller for this map, got {cell} m: one scan has points "
                        f"times segments = {len(own[place]) * len(starts[place]):.3g} in one"
                    )
                mine = own[place]
                clusters = clusters_of(owner[mine], points[mine], starts[place], noise, least)
                if clusters:
                    cells.setdefault(place, []).extend(clusters)
                    group(cells[place], limits)
                    updated.add(place)
            if done % every == 0 or done == scans:
                group_across(cells, updated, buffer, limits)
                updated.clear()
            waiting = sum(c.wall is None for place in updated for c in cells[place])
            yield waiting + sum(wall.wall is None for wall in buffer)
        walls = [wall for wall in buffer if wall.wall is None]
        out = np.array([wall.ends for wall in walls]).reshape(-1, 2, 2)
        return out, holds_most([wall.counts for wall in walls], len(s))

    return run_online("fuzzy_clustering", map, steps, splits=True)


def _check_cells(s: Array, cell: float, origin: Array) -> None:
    """Refuse cells that would be too many, or have no number."""
    low, high = (np.floor((f(s, axis=1) - origin) / cell) for f in (np.min, np.max))
    cuts = (high - low).sum()
    if cuts > MOST_SPACED_POINTS or np.abs([low, high]).max(initial=0) >= MOST_CELLS:
        raise ValueError(
            f"cell must be larger for this map, got {cell} m, "
            f"which makes {cuts:.3g} pieces of its segments: is it in metres?"
        )


@dataclass(eq=False)
class Cluster:
    """Running sums, the known part of their line, points of each input; its wall in the buffer.

    A wall of the buffer is one too, and knows its place in it.
    """

    sums: Sums
    ends: Segment
    counts: Counter[int]
    wall: Cluster | None = None
    place: int = -1

    def absorb(self, other: Cluster) -> None:
        """Sums add; the line of the sums spans what both did."""
        self.sums = self.sums + other.sums
        self.ends = on_line(self.sums, [*self.ends, *other.ends])
        self.counts.update(other.counts)


def clip_to_cells(s: Segment, cell: float, corner: Point) -> list[tuple[Cell, Prototype]]:
    """Step 1: a prototype for each piece of a segment, in the cells that it passes through."""
    (ax, ay), (bx, by) = s
    size, cuts = segment_length(s), {0.0, 1.0}
    for a, b, c in ((ax, bx, corner[0]), (ay, by, corner[1])):
        low, high = math.floor((min(a, b) - c) / cell), math.floor((max(a, b) - c) / cell)
        cuts |= {((c + k * cell) - a) / (b - a) for k in range(low + 1, high + 1)}
    pieces = []
    for t0, t1 in pairwise(sorted(min(max(t, 0.0), 1.0) for t in cuts)):
        if (t1 - t0) * size > SAME:
            x, y = ax + (t0 + t1) / 2 * (bx - ax), ay + (t0 + t1) / 2 * (by - ay)
            place = math.floor((y - corner[1]) / cell), math.floor((x - corner[0]) / cell)
            pieces.append((place, Prototype(x, y, (bx - ax) / size, (by - ay) / size)))
    return pieces


def on_line(sums: Sums, points: Sequence[Point]) -> Segment:
    """The part of the line of running sums that points span."""
    return spanning(sums.x, sums.y, sums.direction(), points)


def clusters_of(
    owner: Indices,
    points: Array,
    starts: Sequence[Prototype],
    noise: float,
    least: tuple[int, float],
) -> list[Cluster]:
    """Steps 2 and 3: what the points of a scan in one cell, each with its segment, become."""
    prototypes, clusters = settle(points, np.array(starts, float), noise), list[Cluster]()
    picks = pick_prototypes(points, prototypes, noise)
    for k in range(len(prototypes)):
        mine = np.flatnonzero(picks == k)
        if len(mine) < least[0]:
            continue
        own = points[mine].tolist()
        sums = sums_of(own)
        ends = on_line(sums, own)
        if segment_length(ends) >= least[1]:
            clusters.append(Cluster(sums, ends, Counter(owner[mine].tolist())))
    return clusters


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


def wall_of_cluster(cluster: Cluster) -> Cluster:
    """What a cluster is in by now: a wall of the buffer, or itself."""
    return cluster if cluster.wall is None else wall_of_cluster(cluster.wall)


def unite(a: Cluster, b: Cluster) -> None:
    """Cluster, or wall, a absorbs b; what a is in then has what b is in."""
    mine, its = wall_of_cluster(a), wall_of_cluster(b)
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
        cluster.wall = replace(cluster, counts=Counter(cluster.counts), place=len(buffer))
        buffer.append(cluster.wall)
    for row, column in sorted(updated):
        around = [(row + r, column + c) for r in (-1, 0, 1) for c in (-1, 0, 1)]
        near = {wall_of_cluster(c).place for place in around for c in cells.get(place, [])}
        group([buffer[k] for k in sorted(near)], limits)
