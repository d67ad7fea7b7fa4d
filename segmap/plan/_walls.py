"""Walls as a person draws them: one line a face, closed corners, clutter apart."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..angles import axial_difference
from ..arrays import Array
from ..extraction import fit_line
from ..poses import transform
from ..quadtree import FREE
from ..reduction import Reduction
from ..segments import MIN_LENGTH, angle, length, midpoint
from ._cells import BRIDGED_M, SHORTEST_ALONE_M, THICKEST_WALL_M, Grid, Mask
from ._lines import Indices, merged_spans
from ._polygons import shapely_or_hint

#: Parallel looks within this distance, metres, with one free side are one face.
FACE_BAND_M = 0.12
#: And within so many times their median distance from the face, but at least within this, metres.
FACE_SPREAD = 3.0
LEAST_FACE_BAND_M = 0.04
#: Looks that are turned by more than this, radians, are none of one face.
FACE_TURN_RAD = np.radians(12)
#: How far off a segment its free side is looked for, metres.
FREE_SIDE_M = (0.10, 0.15)
#: Looks on one line belong to one face over gaps of so much, metres: the leaves of a door.
FACE_GAP_M = 2.5
#: A face also goes on over gaps of so much, metres, that no ray passed.
HIDDEN_M = 1.0
#: Before a gap in a wall there is free space at this distance, metres; a cross wall reaches on.
BEFORE_M = 0.9
#: Shorter ones are clutter, metres.
SHORTEST_WALL_M = 0.3
#: Other ends that are so near a wall, before it or behind, end there, metres.
T_REACH_M = 0.15
#: Points of a segment by whose squares those of all its points are known (Simpson's rule).
SIMPSON = np.array([(1, 0), *[(0.5, 0.5)] * 4, (0, 1)])
#: Ends so near the crossing of their lines meet there, metres.
CORNER_M = 0.3
#: Free space in the angle of a corner is looked for so far along its sides, metres.
ANGLE_REACH_M = (0.08, 0.11, 0.14, 0.17)
#: Walls that are turned by less than this, radians, have no corner.
CORNER_TURN_RAD = np.radians(20)
#: What is drawn along a wall has a larger cosine of their angle.
ALONG_COSINE = 0.7


class Faces(NamedTuple):
    """Straight runs of wall and of clutter, `(n, 2, 2)`.

    Of each its free side, its length (infinite where a person says that it is a wall), whether it
    is a wall, and its residual; `members` is the face of each segment of the map.
    """

    segments: Array
    side: Indices
    size: Array
    wall: Mask
    residual: Array
    members: Indices


def draw_faces(segments: Array, grid: Grid, labels: Indices) -> Faces:
    """Walls with closed corners, and clutter as it was seen."""
    drawn, side, residual, face = straight_faces(segments, grid)
    away = np.arange(grid.side, THICKEST_WALL_M, grid.side)[:, None, None] * normals(drawn)
    beside = np.stack([grid.at(midpoint(drawn) + k * away, labels) for k in (1, -1)])
    room = np.take_along_axis(beside, (beside >= 0).argmax(1)[:, None], 1)[:, 0]
    alone = (room[0] == room[1]) & (room[0] >= 0)
    wall = length(drawn) >= np.where(alone, SHORTEST_ALONE_M, SHORTEST_WALL_M)
    shut = drawn.copy()
    shut[wall] = closed(drawn[wall], grid)
    wall &= length(shut) >= SHORTEST_WALL_M
    drawn = np.where(wall[:, None, None], shut, drawn)
    return Faces(drawn, side, length(drawn), wall, residual, face)


def with_doorway(faces: Faces, ends: Array) -> Faces:
    """The runs with a gap from jamb to jamb `(2, 2)`: in both faces of the wall."""
    start, width, normal = ends[0], float(length(ends)), normals(ends[None])[0]
    runs = faces.segments
    spans, off = (runs - start) @ (ends[1] - start) / width, (midpoint(runs) - start) @ normal
    is_cut = faces.wall & (abs(normals(runs) @ normal) > ALONG_COSINE)
    is_cut &= (abs(off) <= THICKEST_WALL_M) & (spans.min(1) < width) & (spans.max(1) > 0)
    cut = np.flatnonzero(is_cut)
    first, last = spans[cut].T
    gap = np.where((first < last)[:, None], (0.0, width), (width, 0.0))
    return with_gaps(faces, cut, ((gap - first[:, None]) / (last - first)[:, None]).clip(0, 1))


def with_gaps(faces: Faces, cut: Indices, share: Array) -> Faces:
    """The runs `cut` with a gap in each, from one to the other share `(n, 2)` of its length."""
    runs = faces.segments
    jambs = runs[cut, :1] + share[..., None] * (runs[cut, 1:] - runs[cut, :1])
    pieces = np.concatenate([runs, np.stack([jambs[:, 1], runs[cut, 1]], 1)])
    pieces[cut, 1] = jambs[:, 0]
    every, size = np.append(np.arange(len(runs)), cut), length(pieces)
    wall = faces.wall[every] & (size > MIN_LENGTH)
    return Faces(pieces, faces.side[every], size, wall, faces.residual[every], faces.members)


def walls_and_clutter(faces: Faces) -> tuple[Reduction, Reduction, Array, Indices, Array]:
    """Walls, and clutter; of walls thickness, free side, residual."""

    def made(which: Mask) -> Reduction:
        number = np.append(np.where(which, np.cumsum(which) - 1, -1), -1)
        return Reduction(faces.segments[which], number[faces.members], 0.0, "floor_plan")

    walls, side = made(faces.wall), faces.side[faces.wall]
    thickness = thicknesses(walls.segments, side)
    return walls, made(~faces.wall & (faces.size > 0)), thickness, side, faces.residual[faces.wall]


def normals(segments: Array) -> Array:
    """Unit vectors to the left of segments, `(n, 2)`."""
    way = (segments[:, 1] - segments[:, 0]) / np.maximum(length(segments), MIN_LENGTH)[:, None]
    return np.stack([-way[:, 1], way[:, 0]], -1)


def free_sides(segments: Array, grid: Grid) -> Indices:
    """The free side of segments, 1 left, -1 right, 0 for both or neither, `(n,)`.

    What another segment hides from one, such as the other face of a thin wall, is not beside it.
    """
    shapely, share = shapely_or_hint(), np.linspace(0.1, 0.9, 9)[:, None, None]
    points = segments[:, 0] + share * (segments[:, 1] - segments[:, 0])
    off = np.multiply.outer([LEAST_FACE_BAND_M, *FREE_SIDE_M], normals(segments))[:, None]
    ends = points + np.stack([off, -off])  # (sides, distances, shares, segments, 2)
    starts = np.broadcast_to(ends[:, :1], ends[:, 1:].shape)
    looks = shapely.linestrings(np.stack([starts, ends[:, 1:]], -2).reshape(-1, 2, 2))
    look, other = shapely.STRtree(shapely.linestrings(segments)).query(looks, "intersects")
    is_free = grid.at(ends[:, 1:]).ravel() == FREE
    is_free[look[look % len(segments) != other]] = False
    return np.sign(np.diff(is_free.reshape(2, -1, len(segments)).sum(1)[::-1], axis=0)[0])


def straight_faces(segments: Array, grid: Grid) -> tuple[Array, Indices, Array, Indices]:
    """One straight segment for each face: the longest look gathers those that lie on it.

    Returned are faces, their free sides, residuals, and of each segment its face.
    """
    side, turn, sizes = free_sides(segments, grid), angle(segments), length(segments)
    loose, face = np.argsort(-sizes, kind="stable"), np.full(len(segments), -1)
    drawn, sides, residual = list[Array](), list[int](), list[float]()
    while len(loose):
        mine, close, band = segments[loose], np.arange(1), FACE_BAND_M
        for _ in range(4):
            weight = np.ceil(sizes[loose[close]] / grid.side).astype(int)
            points = np.repeat(SIMPSON @ mine[close], weight, axis=0)
            centre, direction = fit_line(points.reshape(-1, 2))
            (way, normal), to = transform((0, 0, direction), np.eye(2)), mine - centre
            turned = abs(axial_difference(turn[loose], direction))
            facing = side[loose] * np.where((mine[:, 1] - mine[:, 0]) @ way > 0, 1, -1)
            spans = np.sort(to @ way, 1)
            off = abs(to @ normal).max(1)
            near = (off <= FACE_BAND_M) & (turned <= FACE_TURN_RAD) & (facing * facing[0] >= 0)
            low, high = merged_spans(spans[close]).T[..., None]
            some = np.flatnonzero(near & (off > band))
            start, end = spans[some].T
            common = (np.minimum(end, high) - np.maximum(start, low)).clip(0).sum(0)
            near[some] = 2 * common >= end - start  # one behind the other is the same face
            near[0] = True
            blocks = merged_spans(spans[near], FACE_GAP_M)
            low, high = blocks[np.searchsorted(blocks[:, 0], spans[0, 0], "right") - 1]
            chosen = np.flatnonzero(near & (spans[:, 0] >= low) & (spans[:, 1] <= high))
            if len(chosen) == 1:
                break
            away = abs(to[chosen] @ normal).mean(1)
            order = np.argsort(away, kind="stable")
            share = np.cumsum(sizes[loose[chosen]][order])
            half = away[order][np.searchsorted(share, share[-1] / 2)]
            close = chosen[away <= FACE_SPREAD * half + 1e-9]
            band = min(max(FACE_SPREAD * half, LEAST_FACE_BAND_M), FACE_BAND_M)
        front = int(np.sign(facing[chosen] @ sizes[loose[chosen]]))
        for low, high in _bridge(merged_spans(spans[chosen]), centre, way, front * normal, grid):
            own = chosen[(spans[chosen, 0] >= low) & (spans[chosen, 1] <= high)]
            face[loose[own]] = len(drawn)
            drawn.append(centre + np.array([[low], [high]]) * way)
            sides.append(front)
            squares = ((to[own] @ normal) ** 2).mean(1)
            residual.append(float(np.sqrt(np.average(squares, weights=sizes[loose[own]]))))
        loose = np.delete(loose, chosen)
    return np.reshape(drawn, (-1, 2, 2)), np.array(sides, np.int64), np.array(residual), face


def _bridge(spans: Array, centre: Array, way: Array, front: Array, grid: Grid) -> Array:
    """Intervals with those made one that leave a small gap, or one that no ray passed.

    Where free space lies before the gap, it is the same wall: a cross wall reaches farther.
    """
    runs = [spans[0].tolist()]
    for low, high in spans[1:].tolist():
        gap = low - runs[-1][1]
        points = centre + np.linspace(runs[-1][1], low, 3 + int(gap / grid.side))[1:-1, None] * way
        before, passed = ((grid.at(points + k * front) == FREE).mean() for k in (BEFORE_M, 0.0))
        hidden = gap <= BRIDGED_M or (gap <= HIDDEN_M and passed == 0)
        if not (hidden and before > 0.5):
            runs.append([low, high])
        runs[-1][1] = high
    return np.array(runs)


def _crossings(segments: Array) -> tuple[Array, Array, Array]:
    """Where the line of each segment crosses those of all others: inward directions `(2 n, 2)`.

    And metres along these from each end to the crossing, `(2 n, n)`, and from the start of the
    other segment; NaN where both are nearly parallel. End `2 i` is the start of segment i.
    """
    ends, normal = segments.reshape(-1, 2), normals(segments)
    way = np.stack([normal[:, 1], -normal[:, 0]], -1)
    inward = np.stack([way, -way], 1).reshape(-1, 2)
    across = inward @ normal.T
    across[abs(across) < np.sin(CORNER_TURN_RAD)] = np.nan
    to = segments[:, 0] - ends[:, None]
    ahead = np.vecdot(to, normal) / across
    return inward, ahead, ahead * (inward @ way.T) - np.vecdot(to, way)


def closed(segments: Array, grid: Grid) -> Array:
    """Segments whose ends meet: at corners, then on walls, as a T.

    A corner has free space in its angle, or all around; the former come first, then the nearest.
    """
    out, size = segments.copy(), length(segments)
    flat = out.reshape(-1, 2)  # a view
    inward, ahead, at = _crossings(segments)
    open_end = np.ones(len(flat), bool)
    with np.errstate(invalid="ignore"):
        both = np.stack([at, size - at], -1).reshape(len(flat), -1)  # to both ends of the other
        off = np.maximum(abs(np.repeat(ahead, 2, 1)), abs(both))
        half = np.repeat(size, 2) / 2
        room = (np.repeat(ahead, 2, 1) < half[:, None]) & (both < half)
        i, j = np.nonzero(np.triu(room & (off <= CORNER_M)))
    crossing = flat[i] + ahead[i, j // 2, None] * inward[i]
    reach = np.array(ANGLE_REACH_M)[:, None, None] * (inward[i] + inward[j])
    inner, outer = ((grid.at(crossing + k * reach) == FREE).mean(0) for k in (1, -1))
    for k in np.lexsort([off[i, j], inner < 0.5]):
        if open_end[i[k]] and open_end[j[k]] and max(inner[k], outer[k]) >= 0.5:
            flat[[i[k], j[k]]] = crossing[k]
            open_end[[i[k], j[k]]] = False
    inward, ahead, at = _crossings(out)
    with np.errstate(invalid="ignore"):
        hit = (at > 0) & (at < length(out)) & (ahead >= -T_REACH_M) & (ahead <= T_REACH_M)
    hit[~open_end] = False
    for end in np.flatnonzero(hit.any(1)):
        near = ahead[end, hit[end]]
        flat[end] += near[abs(near).argmin()] * inward[end]
    return out


def thicknesses(walls: Array, side: Indices) -> Array:
    """From each wall to its other face, metres: `(n,)`, NaN where that was not seen."""
    back = -side[:, None] * normals(walls)
    behind = back @ midpoint(walls).T - (walls[:, 0] * back).sum(1)[:, None]
    start, end = (back[:, ::-1] * (1, -1) @ walls[:, k].T for k in (0, 1))
    low, high = np.fmin(start, end), np.fmax(start, end)
    common = np.fmin(high, np.diag(high)[:, None]) - np.fmax(low, np.diag(low)[:, None])
    faces = (back @ back.T < -np.cos(FACE_TURN_RAD)) & (common > SHORTEST_WALL_M)
    thickness = np.where(faces & (behind > 0), behind, np.inf).min(1, initial=np.inf)
    return np.where(thickness <= THICKEST_WALL_M, thickness, np.nan)
