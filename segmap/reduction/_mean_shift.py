"""Mean shift (A 4.3, 5.5): pieces of walls climb to where they are dense, first with their angle.

The second phase stretches its kernel along the direction that the first has found.
"""

import time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..angles import Array
from ..segments import Segments, as_segments, length
from . import _mean_shift_loops as loops
from ._result import Reduction, whole_parents, with_length

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
    start = time.perf_counter()
    segments, index = with_length(map)
    check_scales(segments, sigma, bandwidth)
    parents = np.empty(0, np.int64)
    if len(segments):
        origin = segments.mean(axis=(0, 1))
        middle, half, first = cut(segments - origin, sigma)
        _, label, theta = loops.directions(middle, half, sigma, bandwidth)
        found, into = loops.lines(middle, half, label, theta, sigma)
        segments, parents = found + origin, loops.longest_share(into, first)
    parents = whole_parents(len(as_segments(map)), index, parents)
    return Reduction(segments, parents, time.perf_counter() - start, "mean_shift")


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
    map: Segments, *, sigma: float = 0.20, bandwidth: float = np.pi / 18 / 0.20
) -> Directions:
    """Cluster the pieces of a map by place and direction: phase 1 of `mean_shift` (A 4.3.3).

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
    sigma : float, metres
    bandwidth : float, radians a metre
        As for `mean_shift`.

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
    segments, index = with_length(map)
    check_scales(segments, sigma, bandwidth)
    if len(segments) == 0:
        return Directions(segments, index, np.empty((0, 3)), index, np.empty(0))
    origin = segments.mean(axis=(0, 1))
    middle, half, first = cut(segments - origin, sigma)
    centres, label, theta = loops.directions(middle, half, sigma, bandwidth)
    centres[:, :2] += origin
    pieces = np.stack([middle - half, middle + half], axis=1) + origin
    names, cluster = np.unique(label, return_inverse=True)
    return Directions(pieces, np.repeat(index, np.diff(first)), centres, cluster, theta[names])


def cut(segments: Array, sigma: float) -> tuple[Array, Array, NDArray[np.int64]]:
    """Equal pieces of at most `sigma`, metres: middles `(p, 2)`, halves `(p, 2)` from there.

    Also where the pieces of each segment `(n, 2, 2)` begin, `(n + 1,)`.
    """
    count = piece_counts(segments, sigma).astype(np.int64)
    first = np.concatenate([[0], np.cumsum(count)])
    own = np.repeat(np.arange(len(count)), count)
    half = (segments[:, 1] - segments[:, 0]) / (2 * count[:, None])
    nth = np.arange(len(own)) - first[own]
    return segments[own, 0] + (2 * nth + 1)[:, None] * half[own], half[own], first


def piece_counts(segments: Array, sigma: float) -> Array:
    """How many pieces of at most `sigma`, metres, each of `(n, 2, 2)` segments is cut into."""
    return np.maximum(np.ceil(length(segments) / sigma - 1e-9), 1.0)


def check_scales(segments: Array, sigma: float, bandwidth: float) -> None:
    """Refuse a sigma, metres, or a bandwidth, radians a metre, that cannot do for the segments.

    Raises
    ------
    ValueError
        Naming the argument and what was expected.
    """
    for name, value, unit in (("sigma", sigma, "metres"), ("bandwidth", bandwidth, "rad/m")):
        if not (value > 0 and np.isfinite(value)):
            raise ValueError(f"{name} must be positive and finite, in {unit}, got {value}")
    if sigma * bandwidth < 1e-9:
        raise ValueError(
            f"bandwidth must be at least 1e-9 rad a sigma, below which angles are rounding, "
            f"got {bandwidth} rad/m with sigma {sigma} m"
        )
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
