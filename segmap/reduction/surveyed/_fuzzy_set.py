"""Fuzzy set (A 2.7.4): walls along the axes of a building; the precise ones draw the others in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ... import arrays
from ...arrays import Array, Segments
from ...segments import SegmentMap, length, take_points
from ...segments import angle as angle_of
from .._boxes import empty_boxes
from .._runner import Found, Indices, Reduction, Rows, by_lowest, rows_of, run
from ._rectangles import State, merge_all, roots

#: Above this share of length along no axis, the building is not one for this method.
SLANTED = 0.25
#: Angles closer than this, radians, are equal.
SAME = 1e-9


def fuzzy_set(
    map: Segments,
    *,
    across: float = 0.20,
    along: float = 0.30,
    error: float = 0.02,
    angle: float = np.pi / 18,
    axes: float | None = None,
) -> Reduction:
    """Merge rectangles along the axes of a building (A 2.7.4; Lopez-Sanchez et al. 1998).

    Each segment within `angle` of an axis is laid on it, and carries the error with which it may
    lie beside its line. The most precise one that has a partner of its orientation, nearer than
    `across` and `along`, merges with the nearest: the precise one counts for more, and the error
    of both still covers both. This is repeated until none has a partner. Segments along no axis
    stay as they are.

    A gives neither thresholds nor how two segments merge: these are ours. A chain of merges can
    drift by more than `across`.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        With points, the error of a segment is the largest distance of a point from it; without,
        it follows from its length and its angle with the axis.
    across, along : float, metres
        0.20 m across is wider than the errors of cheap robots; 0.30 m along is narrower than a
        door.
    error : float, metres
        Smallest error of a segment.
    angle : float, radians
        Above 0, at most pi/4.
    axes : float or None, radians
        Direction of an axis of the building; None finds it from all segments, weighted by length.
        A takes that of the map.

    Returns
    -------
    Reduction
        By the first segment of each output. `doubt` says so where much of the map is along no
        axis.

    Raises
    ------
    ValueError
        For coordinates that are not finite, thresholds out of range.

    References
    ----------
    Lopez-Sanchez, Esteva, Lopez de Mantaras, Sierra, "Map generation by cooperative low-cost robots
    in structured unknown environments", Autonomous Robots 5, 1998.

    Examples
    --------
    >>> wall = [[(0, 0), (4, 0)], [(3, 0.06), (5, 0.06)], [(0, 1), (0, 3)]]
    >>> found = fuzzy_set(wall)
    >>> found.parents, found.segments[0].round(6)
    (array([0, 0, 1]), array([[0.  , 0.03],
           [5.  , 0.03]]))
    """
    arrays.positive("metres", across=across, along=along, error=error)
    arrays.number(angle, "angle", above=0, most=np.pi / 4, unit="radians")
    if axes is not None:
        axes = arrays.number(axes, "axes", unit="radians, or None")
    limits = np.array([across, along], float)
    found = run(
        "fuzzy_set", map, lambda rows: _reduce(map, rows, limits, float(error), angle, axes)
    )
    return replace(found, doubt=_doubt(rows_of(map)[0].segments, angle, axes))


def _main_axis(s: Array) -> float:
    """Direction of the walls of an orthogonal building, radians."""
    turn, weight = 4 * angle_of(s), length(s)
    return float(np.arctan2((weight * np.sin(turn)).sum(), (weight * np.cos(turn)).sum()) / 4)


def _off(s: Array, axis: float) -> tuple[Array, NDArray[np.bool_]]:
    """Angles of segments `(n, 2, 2)` with the nearer axis, radians; which are upright."""
    off = np.abs((angle_of(s) - axis + np.pi / 2) % np.pi - np.pi / 2)
    upright = off > np.pi / 4
    return np.where(upright, np.pi / 2 - off, off), upright


def _doubt(s: Array, angle: float, axes: float | None) -> str:
    """What speaks against the result; nothing for an orthogonal building."""
    if not len(s):
        return ""
    slanted = _off(s, _main_axis(s) if axes is None else axes)[0] > angle + SAME
    share = float(length(s)[slanted].sum() / length(s).sum())
    return f"not orthogonal: {share:.0%} of the length is along no axis" if share > SLANTED else ""


def _reduce(
    map: Segments, rows: Rows, limits: Array, error: float, angle: float, axes: float | None
) -> Found:
    s, n = rows.segments, len(rows.segments)
    if not n:
        return s, np.empty(0, np.int64)
    axis = _main_axis(s) if axes is None else axes
    off, upright = _off(s, axis)
    kept = np.flatnonzero(off <= angle + SAME)
    state = _state_of(map, rows, kept, off, upright, axis, error, limits)
    last = merge_all(state, len(kept), limits)
    live = np.flatnonzero(state.into[:last] < 0)
    place = np.full(last, -1)
    place[live] = np.arange(len(live))
    into = np.arange(n)  # outputs: those of the rectangles, then each slanted one
    roots(state.into, root := np.empty(last, np.int64))
    into[kept] = place[root[: len(kept)]]
    slanted = np.flatnonzero(off > angle + SAME)
    into[slanted] = len(live) + np.arange(len(slanted))
    out = np.concatenate([_turned(_ends(state, live), axis), s[slanted]])
    order, into = by_lowest(into, rows.row, len(out))
    return out[order], into


def _turned(points: Array, angle: float) -> Array:
    """Points `(..., 2)` turned about the origin."""
    c, s, x, y = np.cos(angle), np.sin(angle), points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], -1)


def _state_of(
    map: Segments,
    rows: Rows,
    kept: Indices,
    off: Array,
    upright: NDArray[np.bool_],
    axis: float,
    error: float,
    limits: Array,
) -> State:
    """Step 2: segments laid on their axis, with their errors."""
    n, up = len(kept), upright[kept].astype(np.int64)
    s = _turned(rows.segments[kept], -axis)
    data, which = np.empty((2 * n, 4)), np.arange(n)
    data[:n, 0] = (s[which, 0, 1 - up] + s[which, 1, 1 - up]) / 2
    data[:n, 1], data[:n, 2] = np.sort(s[which, :, up], axis=1).T
    data[:n, 3] = error + length(rows.segments[kept]) / 2 * np.sin(off[kept])
    if isinstance(map, SegmentMap) and map.points is not None and map.first is not None and n:
        points, first = take_points(map.points, map.first, rows.row[kept])
        owner = np.repeat(which, np.diff(first))
        turned = _turned(points, -axis)
        beside = np.abs(turned[np.arange(len(turned)), 1 - up[owner]] - data[owner, 0])
        data[:n, 3] = np.maximum(np.maximum.reduceat(beside, first[:-1]), error)
    key = np.empty((2 * n, 2), np.int64)
    key[:n, 0], key[:n, 1] = np.floor(data[:n, 3] * 1e9 + 0.5), rows.row[kept]
    unit = max(
        1.0, 4 * float(limits.max()), 2 * float((data[:n, 2] - data[:n, 1]).sum() / max(n, 1))
    )
    flags = np.concatenate([up, np.zeros(n, np.int64)])
    heap, near = np.empty((2, 2 * n), np.int64)
    queued, into = np.zeros(2 * n, np.int64), np.full(2 * n, -1)
    return State(data, key, flags, empty_boxes(2 * n, unit), heap, queued, near, into)


def _ends(state: State, live: Indices) -> Array:
    """End points of rectangles, `(m, 2, 2)`, in the frame of the axes."""
    across, low, high, _ = state.data[live].T
    flat = np.stack([np.stack([low, across], -1), np.stack([high, across], -1)], 1)
    return np.where(state.upright[live][:, None, None] == 1, flat[..., ::-1], flat)
