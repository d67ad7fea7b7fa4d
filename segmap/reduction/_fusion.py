"""Fusion (A 4.4, 5.6): the longest chain of segments in a strip around the longest segment.

A moves the line greedily and can miss the best strip; the sweep over all shifts is exact.
"""

from __future__ import annotations

import numpy as np

from .. import arrays
from ..arrays import Array, Segments, slips
from ..kernels import slots_of
from ._fusion_kernels import Grid, Room, fuse_all
from ._runner import Indices, Reduction, Rows, Steps, run, run_online


def fusion(map: Segments, *, tolerance: float = 0.04) -> Reduction:
    """Replace chains of segments inside a strip by one segment each (A 4.4, 5.6).

    Until the map is empty: take the longest segment; among the lines parallel to it that keep it
    within `tolerance`, find the one whose strip holds the chain of greatest total length through
    it; emit the span of that chain on that line. A chain is a connected set of overlapping
    projections. There is no test of angles: a short stub across the wall is swallowed.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
    tolerance : float, metres
        Half width of the strip. 0.04 m is about the spread of one wall seen from many poses; A
        finds that quality falls quickly beyond 0.06 m.

    Returns
    -------
    Reduction
        Longest first.

    Raises
    ------
    ValueError
        For coordinates that are not finite, a tolerance that is not positive and finite.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(1.5, 0.03), (3, 0.03)], [(5, 0), (6, 0)]]
    >>> result = fusion(wall)
    >>> result, result.parents
    (Reduction(fusion: 3 -> 2 segments), array([0, 0, 1]))
    >>> result.segments[0].round(6)
    array([[0., 0.],
           [3., 0.]])
    """
    arrays.positive("metres", tolerance=tolerance)
    slips.check_lengths(map, tolerance=tolerance)
    return run("fusion", map, lambda rows: fuse(rows.segments, tolerance))


def fusion_online(map: Segments, *, tolerance: float = 0.04) -> Reduction:
    """Fusion of the map and each new scan, one scan after the other (A 2.7.9, table 2.16).

    A names both ways and builds the off-line one. Each pass fuses the whole map again, and a second
    pass finds more than the first: strips around fused segments reach what those around their
    members did not. So the map has fewer segments than `fusion` gives, and drifts farther from
    what was seen: compare both at equal quality.

    The time of a scan grows with the map: that of all scans with scans times map.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        Scans come in ascending order.
    tolerance : float, metres
        As in `fusion`.

    Returns
    -------
    Reduction
        Longest first; with seconds and segments in the map for each scan.

    Raises
    ------
    ValueError
        As `fusion`.

    Examples
    --------
    >>> from segmap import SegmentMap
    >>> wall = [[(0, 0), (2, 0)], [(1.5, 0.05), (3, 0.05)], [(1, 0.1), (2, 0.1)]]
    >>> found = fusion_online(SegmentMap(wall, [0, 1, 2]), tolerance=0.05)
    >>> found.scan_live, found.parents
    (array([1, 1, 1]), array([0, 0, 0]))
    """
    arrays.positive("metres", tolerance=tolerance)
    return run_online("fusion_online", map, lambda rows: _steps(rows, tolerance))


def _steps(rows: Rows, tolerance: float) -> Steps:
    walls, parents = np.empty((0, 2, 2)), np.empty(len(rows.segments), np.int64)
    for first, stop in rows.scans():
        old = len(walls)
        walls, into = fuse(np.concatenate([walls, rows.segments[first:stop]]), tolerance)
        parents[:first] = into[parents[:first]]
        parents[first:stop] = into[old:]
        yield len(walls)
    return walls, parents


def fuse(s: Array, tolerance: float) -> tuple[Array, Indices]:
    """Fusion of segments that all have a length: outputs `(m, 2, 2)`, metres, parents `(n,)`."""
    if not len(s):
        return np.empty((0, 2, 2)), np.empty(0, np.int64)
    lengths = np.hypot(s[:, 1, 0] - s[:, 0, 0], s[:, 1, 1] - s[:, 0, 1])
    grid = _grid_of(s, lengths, float(max(4 * tolerance, lengths.mean())))
    falling = np.argsort(-lengths, kind="stable")
    out, parents = np.empty((len(s), 2, 2)), np.full(len(s), -1)
    count = fuse_all(s, lengths, falling, tolerance, grid, _room_for(len(s)), out, parents)
    return out[:count], parents


def _grid_of(s: Array, lengths: Array, cell: float) -> Grid:
    """Enter each segment into the cells of samples of it, at most half a cell apart."""
    steps = np.ceil(2 * lengths / cell).astype(np.int64)
    owner = np.repeat(np.arange(len(s)), steps + 1)
    nth = np.arange(len(owner)) - (np.cumsum(steps + 1) - steps - 1)[owner]
    sample = s[owner, 0] + (nth / steps[owner])[:, None] * (s[owner, 1] - s[owner, 0])
    column, row = np.floor(sample / cell).astype(np.int64).T
    slots = 1 << int(np.ceil(np.log2(4 * len(s))))
    slot = slots_of(column, row, slots)
    new = np.append(True, (np.diff(slot) != 0) | (np.diff(owner) != 0))
    slot, owner = slot[new][::-1], owner[new][::-1]
    stop = np.cumsum(np.bincount(slot, minlength=slots))
    held = owner[np.argsort(slot, kind="stable")]
    return Grid(np.append(0, stop[:-1]), stop, held, cell)


def _room_for(n: int) -> Room:
    near, order, seen = np.full((3, n), -1)
    tried, chosen = np.zeros((2, n), np.bool_)
    measured, shifts = np.empty((n + 1, 4)), np.empty((2 * n + 1, 2))
    return Room(near, measured, np.empty(n), order, tried, chosen, shifts, seen)
