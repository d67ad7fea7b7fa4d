"""Mean shift (A 4.3, 5.5): pieces of walls climb to where they are dense, first with their angle.

The second phase stretches its kernel along the direction that the first has found.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array, Segments
from ..segments import angle, length, midpoint
from . import _mean_shift_loops as loops
from ._climb_loops import climb, link
from ._runner import Found, Reduction, Rows, rows_of, run

#: More pieces than this are refused: a slip in the unit of sigma would fill the memory.
MOST_PIECES = 20_000_000


def mean_shift(
    map: Segments, *, sigma: float = 0.20, bandwidth: float = np.pi / 18 / 0.20
) -> Reduction:
    """Cluster pieces of segments by place and direction, then by line; join each line's (A 4.3).

    Segments longer than `sigma` are cut into equal pieces, as few as are no longer. *Phase 1*:
    centres start at the pieces, as middle and angle, and move together to the mean of the pieces
    around them, weighted by exp(-d^2 / (2 sigma^2)), d^2 = dx^2 + dy^2 + (angle / bandwidth)^2,
    until none moves by more than sigma / 200. Chains of centres less than 2 sigma apart in d are
    clusters; the axial mean of their centres is their direction. *Phase 2*, in each cluster: the
    same with the middles alone, weighted by exp(-(du^2 / sx^2 + dv^2 / sy^2) / 4), with u along the
    direction, sx = 2 sigma, and v across it, sy = sigma / 10; centres stop at moves of 1 / 200 and
    make chains below 1 in sqrt(du^2 / sx^2 + dv^2 / sy^2). *Last*: the pieces of each chain are
    projected on the line through the mean of its centres, and each connected part of their union,
    gaps of 1e-9 m closed, is a segment.

    In both phases a piece farther than three deviations, where the weight has fallen to
    exp(-9 / 2), does not pull (at three it does, to 1e-9 of them). One perpendicular to a centre,
    to 1e-9 of a quarter turn, pulls it to its place and turns it neither way.

    One input can end in several outputs: mean shift can return more segments than it got.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
    sigma : float, metres
        Size of the smallest detail that matters, A's only parameter. Above 0.20 m quality falls
        quickly (A 6.3).
    bandwidth : float, radians a metre
        The angle that counts as much as a metre: A takes 10 degrees for 0.20 m, whatever sigma.

    Returns
    -------
    Reduction
        Ordered by the lowest input index in each, then along that input from its end point 0.
        Parents name the output with the longest share of the input (equal: the first).

    Raises
    ------
    ValueError
        For coordinates that are not finite; a sigma or bandwidth that is not positive and finite,
        or so small that rounding would decide or the pieces would fill the memory.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (2, 0)], [(0, 0.01), (2, 0.01)], [(0, 1), (0, 2)]])
    >>> found = mean_shift(wall)
    >>> found, found.parents
    (Reduction(mean_shift: 3 -> 2 segments), array([0, 0, 1]))
    """
    check_scales(sigma, bandwidth)
    return run("mean_shift", map, lambda rows: _lines(rows, sigma, bandwidth), splits=True)


def _lines(rows: Rows, sigma: float, bandwidth: float) -> Found:
    """Both phases."""
    pieces, owner, _, cluster, theta = _directions(rows.segments, sigma, bandwidth, np.inf)
    origin = pieces.mean(axis=(0, 1)) if len(pieces) else np.zeros(2)
    middle, half = midpoint(pieces) - origin, (pieces[:, 1] - pieces[:, 0]) / 2
    found, into = loops.lines(middle, half, cluster, theta, sigma)
    found, into = _by_lowest(found + origin, into)
    return found, _longest_share(len(rows.segments), owner, into)


class Directions(NamedTuple):
    """What phase 1 of mean shift makes of a map of n segments, cut into p pieces.

    Parameters
    ----------
    pieces : (p, 2, 2) array, metres
    owner : (p,) int array
        Index of the segment that each was cut from.
    centres : (p, 3) array, metres and radians
        Where each has climbed to: x, y and angle, in `[0, pi)`.
    cluster : (p,) int array
        Clusters by their first piece, from 0.
    theta : (k,) array, radians
        Direction of each cluster, in `(-pi/2, pi/2]`.
    """

    pieces: Array
    owner: NDArray[np.int64]
    centres: Array
    cluster: NDArray[np.int64]
    theta: Array


def common_directions(
    map: Segments,
    *,
    sigma: float = 0.20,
    bandwidth: float = np.pi / 18 / 0.20,
    steps: float = np.inf,
) -> Directions:
    """Cluster the pieces of a map by place and direction: phase 1 of `mean_shift` (A 4.3.3).

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
    sigma : float, metres
    bandwidth : float, radians a metre
        As for `mean_shift`.
    steps : int or inf
        Stop after so many, before the centres rest: to look at them on their way.

    Returns
    -------
    Directions
        Segments without length have no pieces.

    Raises
    ------
    ValueError
        As `mean_shift`.

    Examples
    --------
    >>> corner = np.array([[(0, 0), (0.4, 0)], [(0, 0), (0, 0.4)]])
    >>> found = common_directions(corner)
    >>> found.owner, found.cluster, np.degrees(found.theta)
    (array([0, 0, 1, 1]), array([0, 0, 1, 1]), array([ 0., 90.]))
    """
    check_scales(sigma, bandwidth)
    rows, _ = rows_of(map)
    found = _directions(rows.segments, sigma, bandwidth, steps)
    return found._replace(owner=rows.row[found.owner])


def _directions(segments: Array, sigma: float, bandwidth: float, steps: float) -> Directions:
    """Phase 1 of segments `(n, 2, 2)`, metres, that all have a length."""
    _check_fit(segments, sigma)
    if len(segments) == 0:
        none = np.empty(0, np.int64)
        return Directions(segments, none, np.empty((0, 3)), none, np.empty(0))
    pieces, owner = pieces_of(segments, sigma)
    unit = sigma * bandwidth
    middle = midpoint(pieces)
    origin = middle.mean(axis=0)
    points = np.column_stack([(middle - origin) / sigma, angle(pieces) / unit])
    centres, _ = climb(points, np.pi / unit, loops.STOP, float(steps))
    label = link(centres, np.pi / unit, 2.0)
    centres = centres * (sigma, sigma, unit) + (*origin, 0.0)
    cluster = np.unique(label, return_inverse=True)[1]
    sine, cosine = (np.bincount(cluster, f(2 * centres[:, 2])) for f in (np.sin, np.cos))
    return Directions(pieces, owner, centres, cluster, np.arctan2(sine, cosine) / 2)


def _by_lowest(segments: Array, into: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
    """Segments `(m, 2, 2)` in the order of their first piece, and that of each piece, `(p,)`."""
    order = np.argsort(np.unique(into, return_index=True)[1])
    return segments[order], np.argsort(order)[into]


def _longest_share(
    count: int, owner: NDArray[np.int64], into: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Most frequent output of the pieces `(p,)` of each owner, the first of equals: `(count,)`.

    All pieces of an owner are equally long. -1 for one without pieces.
    """
    most = len(into) + 1
    pairs, times = np.unique(owner * most + into, return_counts=True)
    order = np.lexsort((-pairs, times))
    parents = np.full(count, -1, np.int64)
    parents[pairs[order] // most] = pairs[order] % most  # the most frequent of an owner stays
    return parents


def pieces_of(segments: Array, sigma: float) -> tuple[Array, NDArray[np.int64]]:
    """Equal pieces `(p, 2, 2)` of `(n, 2, 2)` segments, at most `sigma` long, and their segments.

    Pieces are as few as can be, in the order of their segments, from end point 0; metres.
    """
    count = piece_counts(segments, sigma).astype(np.int64)
    owner = np.repeat(np.arange(len(count)), count)
    nth = np.arange(len(owner)) - (np.cumsum(count) - count)[owner]
    begin, step = segments[owner, 0], (segments[:, 1] - segments[:, 0])[owner] / count[owner, None]
    return np.stack([begin + nth[:, None] * step, begin + (nth + 1)[:, None] * step], 1), owner


def piece_counts(segments: Array, sigma: float) -> Array:
    """How many pieces of at most `sigma`, metres, each of `(n, 2, 2)` segments is cut into."""
    return np.maximum(np.ceil(length(segments) / sigma - 1e-9), 1.0)


def check_scales(sigma: float, bandwidth: float) -> None:
    """Refuse a sigma, metres, or a bandwidth, radians a metre, that cannot do.

    Raises
    ------
    ValueError
        Naming the argument and what was expected.
    """
    arrays.positive("metres", sigma=sigma)
    arrays.positive("rad/m", bandwidth=bandwidth)
    if sigma * bandwidth < 1e-9:
        raise ValueError(
            f"bandwidth must be at least 1e-9 rad a sigma, below which angles are rounding, "
            f"got {bandwidth} rad/m with sigma {sigma} m"
        )


def _check_fit(segments: Array, sigma: float) -> None:
    """Refuse a sigma, metres, that is too small for these segments."""
    extent = float(np.ptp(segments, axis=(0, 1)).max()) if len(segments) else 0.0
    if sigma < 1e-10 * extent:
        raise ValueError(
            f"sigma must be at least 1e-10 of the extent of the map, {extent:.6g} m, "
            f"below which moves are rounding, got {sigma}"
        )
    pieces = float(piece_counts(segments, sigma).sum())
    if pieces > MOST_PIECES:
        raise ValueError(
            f"sigma must cut the map into at most {MOST_PIECES} pieces, "
            f"got {sigma} m, which makes {pieces:.3g}: is it in metres?"
        )
