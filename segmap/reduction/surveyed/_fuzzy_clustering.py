"""Fuzzy clustering (A 2.7.6): points cluster in cells, clusters group across them."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ... import arrays
from ...arrays import Array, Count, Metres, Segments, at_least, checked
from ...segments import length
from .._mean_shift import longest_share
from .._points import MOST_POINTS, points_behind
from .._runner import Indices, Length, Reduction, Rows, Steps, Turn, run_online
from ._fuzzy_kernels import SAME, State, add_scan, cluster, group_across

#: Keys of neighbouring rows of cells differ by this; columns and rows must be less than half of it.
ROW = 1 << 32


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
    >>> found = fuzzy_clustering(wall)
    >>> found, found.parents
    (Reduction(fuzzy_clustering: 3 -> 2 segments), array([0, 0, 1]))
    """
    origin = arrays.point(corner, "corner")
    least = np.array([max(min_points, 2), max(min_length, 10 * SAME)], float)
    limits = np.array([angle, distance, gap])

    def steps(rows: Rows) -> Steps:
        points, owner, pieces, first, begin, place, scan, nine = _deal(
            map, rows, cell, origin, spacing
        )
        n, label = int(begin[-1]), np.empty(len(points), np.int64)
        cells = np.bincount(np.repeat(place, np.diff(begin)), minlength=len(nine))
        held, updated = np.zeros((2, len(nine)), np.int64)
        state = State(
            sums=np.zeros((2 * n, 6)),
            ends=np.empty((2 * n, 2, 2)),
            theta=np.empty(2 * n),
            into=np.full(2 * n, -1),
            first=np.append(0, np.cumsum(cells)),
            held=held,
            slot=np.empty(n, np.int64),
            near=np.empty(n, np.int64),
            nine=nine,
            updated=updated,
            used=np.zeros(2, np.int64),
        )
        room = np.zeros([1 + np.diff(runs).max(initial=0) for runs in (first, begin)])
        cluster(points, first, pieces, begin, noise, room, label, state)
        scans = len(rows.cuts) - 1
        cuts = np.searchsorted(scan, np.arange(scans + 1))
        for k in range(scans):
            add_scan(state, place, begin, cuts[k], cuts[k + 1], least, limits)
            if (k + 1) % every == 0 or k + 1 == scans:
                group_across(state, limits)
            yield int(state.used[0])
        # step 6: at the end every cluster that is left is in a wall of the buffer
        walls = n + np.flatnonzero(state.into[n : n + state.used[1]] < 0)
        number = np.full(2 * n, -1)
        number[walls] = np.arange(len(walls))
        root = np.where(state.into < 0, np.arange(2 * n), state.into)
        while (root[root] != root).any():
            root = root[root]
        wall = np.where(label >= 0, number[root[label]], -1) if n else label
        some = wall >= 0
        return state.ends[walls], longest_share(len(rows.segments), owner[some], wall[some])

    return run_online("fuzzy_clustering", map, steps, splits=True)


class Dealt(NamedTuple):
    """Points and pieces of segments by batches: what one scan has in one cell."""

    points: Array  # (p, 2) those in a cell where their scan has a piece
    owner: Indices  # (p,) segment of each
    pieces: Array  # (c, 6) prototypes: centre, unit direction, mixing, and room for a sum
    first: Indices  # (b + 1,) where the points of each batch begin
    begin: Indices  # (b + 1,) and its pieces
    place: Indices  # (b,) cell of each
    scan: Indices
    nine: Indices  # (k, 9) each cell and its neighbours, -1 for none


def _deal(map: Segments, rows: Rows, cell: float, origin: Array, spacing: float) -> Dealt:
    """Step 1: points and prototypes by scan, then by row and column of cells."""
    points, first, _, _ = points_behind(map, rows, spacing)
    every = np.arange(len(rows.segments))
    scan, owner = np.searchsorted(rows.cuts, every, "right") - 1, np.repeat(every, np.diff(first))
    pieces, of = _clipped(rows.segments, cell, origin)
    cells, place = np.unique(_keys(pieces[:, :2], cell, origin), return_inverse=True)
    batches, batch = np.unique(scan[of] * len(cells) + place, return_inverse=True)
    order = np.argsort(batch, kind="stable")
    begin = np.searchsorted(batch[order], np.arange(len(batches) + 1))
    at = _find(cells, _keys(points, cell, origin))
    own = np.where(at >= 0, _find(batches, scan[owner] * len(cells) + at), -1)
    kept = np.argsort(own, kind="stable")[np.count_nonzero(own < 0) :]
    first = np.searchsorted(own[kept], np.arange(len(batches) + 1))
    most = int(np.diff(first).max(initial=0)) * int(np.diff(begin).max(initial=0))
    if most > MOST_POINTS:
        raise ValueError(
            f"cell must be smaller for this map, got {cell} m: one scan has points times segments "
            f"= {most:.3g} in one of them"
        )
    around = np.add.outer([-ROW, 0, ROW], [-1, 0, 1]).ravel()
    nine = _find(cells, cells[:, None] + around)
    scan, place = np.divmod(batches, max(len(cells), 1))
    return Dealt(points[kept], owner[kept], pieces[order], first, begin, place, scan, nine)


def _find(keys: Indices, wanted: Indices) -> Indices:
    """Where each wanted key stands among sorted keys; -1 for none."""
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where(keys[at] == wanted, at, -1) if len(keys) else np.full(wanted.shape, -1)


def _keys(points: Array, cell: float, origin: Array) -> Indices:
    """A number for the cell of each point, by row, then column."""
    spots = np.floor((points - origin) / cell).astype(np.int64)
    return spots[:, 1] * ROW + spots[:, 0]


def _clipped(s: Array, cell: float, origin: Array) -> tuple[Array, Indices]:
    """Step 1: prototypes `(c, 6)` of segments, `(n, 2, 2)`, in the cells that they pass; whose."""
    low, high = (np.floor((f(s, axis=1) - origin) / cell) for f in (np.min, np.max))
    cuts = high - low
    if cuts.sum() > MOST_POINTS or np.abs([low, high]).max(initial=0) >= ROW / 2:
        raise ValueError(
            f"cell must be larger for this map, got {cell} m, "
            f"which makes {cuts.sum():.3g} pieces of its segments: is it in metres?"
        )
    every = np.arange(len(s))
    t, owner = [np.zeros(len(s)), np.ones(len(s))], [every, every]
    for axis in range(2):
        which = np.repeat(every, cuts[:, axis].astype(np.int64))
        line = np.arange(len(which)) - np.searchsorted(which, which) + low[which, axis] + 1
        a, b = s[which, 0, axis], s[which, 1, axis]
        t.append(np.clip((origin[axis] + line * cell - a) / (b - a), 0.0, 1.0))
        owner.append(which)
    share, of = np.concatenate(t), np.concatenate(owner)
    order = np.lexsort((share, of))
    share, of = share[order], of[order]
    size, step = length(s), s[:, 1] - s[:, 0]
    kept = np.flatnonzero((of[1:] == of[:-1]) & (np.diff(share) * size[of[1:]] > SAME))
    middle, of = (share[kept] + share[kept + 1]) / 2, of[kept]
    centre = s[of, 0] + middle[:, None] * step[of]
    mixing_and_room = np.ones((len(of), 2))
    return np.column_stack([centre, step[of] / size[of, None], mixing_and_room]), of
