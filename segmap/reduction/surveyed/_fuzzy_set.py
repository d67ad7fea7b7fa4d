"""Fuzzy set (A 2.7.4): walls along the axes of a building; the precise ones draw the others in."""

from __future__ import annotations

import heapq
from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Metres, Quantity, Radians, Segments, at_most, checked
from ...compiled import compiled
from ...kernels import SAME
from ...poses.motions import transform
from ...segments import angle as angle_of
from ...segments import length
from .._index import Index, empty_index, enter, meeting, take_out
from .._points import points_behind
from .._runner import (
    Found,
    Indices,
    Reduction,
    Rows,
    ordered_by_first_input,
    resolve_merges,
    run_offline,
)

#: Above this share of length along no axis, the building is not one for this method.
SLANTED = 0.25


@checked
def fuzzy_set(
    map: Segments,
    *,
    across: Metres = 0.20,
    along: Metres = 0.30,
    error: Metres = 0.02,
    angle: Annotated[Radians, at_most(np.pi / 4)] = np.pi / 18,
    axes: Annotated[float, Quantity("radians")] | None = None,
) -> Reduction:
    """Merge rectangles along the axes of a building (A 2.7.4; Lopez-Sanchez et al. 1998).

    Each segment within `angle` of an axis is laid on it, and carries the error with which it may
    lie beside its line. The most precise one that has a partner of its orientation, nearer than
    `across` and `along`, merges with the nearest: the precise one counts for more, and the error
    of both still covers both. This is repeated until none has a partner. Segments along no axis
    stay as they are.

    A gives neither thresholds nor how two segments merge: these are ours. A chain of merges can
    drift by more than `across`. The cost grows with the map, and with nearly the square of the
    looks at each wall.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        With points, the error of a segment is the largest distance of a point from it; without,
        it follows from its length and its angle with the axis.
    across, along
        Rectangles farther apart across, or along, their axis never merge. 0.20 m across is wider
        than the errors of cheap robots; 0.30 m along is narrower than a door.
    error
        Smallest error of a segment.
    angle
        Segments that differ more from both axes in direction are left as they are.
    axes
        Direction of an axis of the building; None finds it from all segments, weighted by length.
        A takes that of the map.

    Returns
    -------
    Reduction
        By the first segment of each output. `doubt` says so where much of the map is along no
        axis.

    References
    ----------
    Lopez-Sanchez, Esteva, Lopez de Mantaras, Sierra, "Map generation by cooperative low-cost robots
    in structured unknown environments", Autonomous Robots 5, 1998.

    Examples
    --------
    >>> wall = [[(0, 0), (4, 0)], [(3, 0.06), (5, 0.06)], [(0, 1), (0, 3)]]
    >>> reduction = fuzzy_set(wall)
    >>> reduction.parents, reduction.segments[0].round(6)
    (array([0, 0, 1]), array([[0.  , 0.03],
           [5.  , 0.03]]))
    """
    doubt, limits = "", np.array([across, along])

    def reduce(rows: Rows) -> Found:
        nonlocal doubt
        s, n, sizes = rows.segments, len(rows.segments), length(rows.segments)
        turn, axis = 4 * angle_of(s), axes
        if axis is None:
            sums = (sizes * [np.sin(turn), np.cos(turn)]).sum(axis=1)
            axis = np.arctan2(*np.where(abs(sums) > SAME * sizes.sum(), sums, 0.0)) / 4
        off = np.abs((angle_of(s) - axis + np.pi / 2) % np.pi - np.pi / 2)
        upright = off > np.pi / 4 + SAME
        off = np.where(upright, np.pi / 2 - off, off)
        laid = off <= angle + SAME
        share = float(sizes[~laid].sum() / sizes.sum()) if n else 0.0
        if share > SLANTED:
            doubt = f"not orthogonal: {share:.0%} of the length is along no axis"
        straight, slanted = np.flatnonzero(laid), np.flatnonzero(~laid)
        errors = error + sizes[straight] / 2 * np.sin(off[straight])
        walls, first = np.empty((2 * len(straight), 5)), np.tile(rows.source_row[straight], 2)
        laid_rows = Rows(s[straight], rows.source_row[straight], rows.cuts)
        walls[: len(straight)] = _on_axis(map, laid_rows, upright[straight], axis, errors, error)
        step = max(float(limits.max()), float(sizes.mean()) if n else 0.0)
        places = empty_index(len(walls), step)
        members = merge_all(walls, first, len(straight), limits, places)
        alive, ends = resolve_merges(members)
        across, low, high, _, up = walls[: len(members)][alive].T
        flat = np.stack([np.stack([low, across], -1), np.stack([high, across], -1)], 1)
        standing = up[:, None, None] == 1
        out = transform(np.array([0.0, 0.0, axis]), np.where(standing, flat[..., ::-1], flat))
        into = np.empty(n, np.int64)  # outputs: those of the rectangles, then each slanted one
        into[straight], into[slanted] = ends[: len(straight)], len(out) + np.arange(len(slanted))
        out = np.concatenate([out, s[slanted]])
        order, into = ordered_by_first_input(into, rows.source_row, len(out))
        return out[order], into

    return replace(run_offline("fuzzy_set", map, reduce), doubt=doubt)


def _on_axis(
    map: Segments, rows: Rows, upright: NDArray[np.bool_], axis: float, errors: Array, least: float
) -> Array:
    """Step 2: rows laid on their axis, with their errors, or those that points tell.

    A row `(5,)` is: across, low and high along the axis, error, all in metres; 1 where it stands
    upright, else 0.
    """
    up, which, turn = upright.astype(np.int64), np.arange(len(upright)), np.array([0.0, 0.0, -axis])
    s = transform(turn, rows.segments)
    across, along = s[which, :, 1 - up].mean(axis=1), np.sort(s[which, :, up], axis=1)
    points, first, _, has_points = points_behind(map, rows, None)
    if has_points and len(s):
        owner, turned = np.repeat(which, np.diff(first)), transform(turn, points)
        beside = np.abs(turned[np.arange(len(turned)), 1 - up[owner]] - across[owner])
        errors = np.maximum(np.maximum.reduceat(beside, first[:-1]), least)
    return np.column_stack([across, along, errors, up])


@compiled
def nanometres(value: float) -> int:
    """Metres as whole nanometres: what differs by rounding is equal."""
    return int(np.floor(value * 1e9 + 0.5))


@compiled
def rectangles_apart(walls: Array, f: int, g: int, limits: Array) -> float:
    """How far two rectangles are apart, metres; infinite beyond a limit or for another axis."""
    across = abs(walls[f, 0] - walls[g, 0])
    along = max(0.0, max(walls[f, 1], walls[g, 1]) - min(walls[f, 2], walls[g, 2]))
    near = walls[f, 4] == walls[g, 4] and across < limits[0] and along < limits[1]
    return (across + along) / 2 if near and f != g else np.inf


@compiled
def partner(walls: Array, first: Indices, near: Indices, f: int, limits: Array) -> int:
    """The nearest of those near, to a nanometre; ties: the precise one, the first; -1: none."""
    best, least = -1, (0, 0, 0)
    for g in near:
        far = rectangles_apart(walls, f, g, limits)
        if far < np.inf:
            rank = nanometres(far), nanometres(walls[g, 3]), first[g]
            if best < 0 or rank < least:
                best, least = g, rank
    return best


@compiled
def write_corners(wall: Array, out: Array) -> None:
    """Two corners, `(2, 2)`, of a rectangle, along the axes."""
    up = int(wall[4])
    out[0, up], out[1, up] = wall[1], wall[2]
    out[0, 1 - up] = out[1, 1 - up] = wall[0]


@compiled
def merge_rectangles(f: Array, g: Array, out: Array) -> None:
    """Step 5: the precise one counts for more; the error covers both and is never the better's."""
    out[0] = (f[0] / f[3] + g[0] / g[3]) / (1 / f[3] + 1 / g[3])
    out[1], out[2] = min(f[1], g[1]), max(f[2], g[2])
    out[3] = max(min(f[3], g[3]), abs(out[0] - f[0]), abs(out[0] - g[0]))
    out[4] = f[4]


@compiled
def merge_all(walls: Array, first: Indices, count: int, limits: Array, places: Index) -> Indices:
    """Steps 4 and 5: the most precise that has a partner merges, until none has one.

    Merges are written behind the first `count` rectangles, and the first input of each. Returns,
    for each rectangle (also the merged ones), the row that absorbed it; its own row if it is left.
    A rectangle without a partner is tried again when a merge brings another near to it. `places` is
    an empty index.
    """
    into, waits, reach = np.arange(len(walls)), np.full(len(walls), True), limits.max()
    box, near = np.empty((2, 2)), np.empty(len(walls) + 1, np.int64)
    waiting = [(nanometres(walls[f, 3]), first[f], f) for f in range(count)]
    heapq.heapify(waiting)
    for f in range(count):
        write_corners(walls[f], box)
        enter(places, f, box, 0.0)
    while len(waiting):
        f = heapq.heappop(waiting)[2]
        if into[f] != f:
            continue
        write_corners(walls[f], box)
        g = partner(walls, first, near[: meeting(places, box, reach, near)], f, limits)
        if g < 0:
            waits[f] = False
            continue
        merge_rectangles(walls[f], walls[g], walls[count])
        first[count] = min(first[f], first[g])
        into[f] = into[g] = count
        take_out(places, f)
        take_out(places, g)
        write_corners(walls[count], box)
        enter(places, count, box, 0.0)
        waits[count] = False
        for h in near[: meeting(places, box, reach, near)]:
            if not waits[h] and (h == count or rectangles_apart(walls, count, h, limits) < np.inf):
                waits[h] = True
                heapq.heappush(waiting, (nanometres(walls[h, 3]), first[h], h))
        count += 1
    return into[:count]
