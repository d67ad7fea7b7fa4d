"""Mean shift (A 4.3, 5.5): pieces of walls climb to where they are dense, first with their angle.

The second phase stretches its kernel along the direction that the first has found.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from ..arrays import (
    Array,
    Metres,
    Quantity,
    RadiansPerMetre,
    Segments,
    at_least,
    at_most,
    checked,
    unit_checks,
)
from ..segments import angle, cut_evenly, length, midpoint
from ._mean_shift_kernels import climb, join, link
from ._runner import Found, Indices, Reduction, Rows, rows_of, run_offline

#: More pieces than this are refused: a slip in the unit of sigma would fill the memory.
MOST_PIECES = 20_000_000
#: So few segments are a sketch of a case, and no map of a building.
SKETCH = 50
#: Climbing ends when no centre moves by more than this part of sigma, or of (sx, sy) in phase 2.
STOP = 1 / 200


@checked
def mean_shift(
    map: Segments, *, sigma: Metres = 0.20, bandwidth: RadiansPerMetre = np.pi / 18 / 0.20
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

    One input can end in several outputs: of a map in which nothing repeats mean shift returns more
    segments than it got, and warns. The cost grows with the map, and with nearly the square of the
    looks at each wall.

    Parameters
    ----------
    sigma
        Size of the smallest detail that matters, A's only parameter. Above 0.20 m quality falls
        quickly (A 6.3).
    bandwidth
        The angle that counts as much as a metre: A takes 10 degrees for 0.20 m, whatever sigma.

    Returns
    -------
    Reduction
        Ordered by the lowest input index in each, then along that input from its end point 0.
        Parents name the output with the longest share of the input (equal: the first).

    Raises
    ------
    ValueError
        For a sigma or bandwidth so small that rounding would decide, or that the pieces would fill
        the memory.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (2, 0)], [(0, 0.01), (2, 0.01)], [(0, 1), (0, 2)]])
    >>> reduction = mean_shift(wall)
    >>> reduction, reduction.parents
    (Reduction(mean_shift: 3 -> 2 segments), array([0, 0, 1]))
    """

    def reduce(rows: Rows) -> Found:
        directions = _shift_directions(rows.segments, sigma, bandwidth, np.inf)
        if not len(directions.pieces):
            return directions.pieces, directions.owner
        out, into = _shift_lines(directions.pieces, directions.cluster, directions.theta, sigma)
        lowest = np.argsort(np.unique(into, return_index=True)[1])  # outputs by their first piece
        into = np.argsort(lowest)[into]
        return out[lowest], longest_share(len(rows.segments), directions.owner, into)

    reduction = run_offline("mean_shift", map, reduce, splits=True)
    if len(reduction) > len(reduction.parents) > SKETCH:
        text = f"mean_shift makes {len(reduction)} segments of {len(reduction.parents)}"
        unit_checks.warn(f"{text}: nothing repeats in this map, or sigma is too small to see it")
    return reduction


class Directions(NamedTuple):
    """What phase 1 of mean shift makes of a map of n segments, cut into p pieces."""

    pieces: Array  #: (p, 2, 2), metres
    owner: Indices  #: (p,) the segment that each was cut from
    centres: Array  #: (p, 3) where each has climbed to: x, y and angle, in `[0, pi)`
    cluster: Indices  #: (p,) clusters by their first piece, from 0
    theta: Array  #: (k,) direction of each cluster, in `(-pi/2, pi/2]`


@checked
def common_directions(
    map: Segments,
    *,
    sigma: Metres = 0.20,
    bandwidth: RadiansPerMetre = np.pi / 18 / 0.20,
    steps: Annotated[float, Quantity(""), at_least(0), at_most(np.inf)] = np.inf,
) -> Directions:
    """Cluster the pieces of a map by place and direction: phase 1 of `mean_shift` (A 4.3.3).

    Segments without length have no pieces. With `steps`, the climb ends after so many, before the
    centres rest: to look at them on their way.

    Examples
    --------
    >>> corner = np.array([[(0, 0), (0.4, 0)], [(0, 0), (0, 0.4)]])
    >>> directions = common_directions(corner)
    >>> directions.owner, directions.cluster, np.degrees(directions.theta)
    (array([0, 0, 1, 1]), array([0, 0, 1, 1]), array([ 0., 90.]))
    """
    rows, _ = rows_of(map)
    directions = _shift_directions(rows.segments, sigma, bandwidth, steps)
    return directions._replace(owner=rows.source_row[directions.owner])


def _shift_directions(segments: Array, sigma: float, bandwidth: float, steps: float) -> Directions:
    """Phase 1 of segments `(n, 2, 2)` that all have a length (A 4.3.3)."""
    unit_checks.check_bandwidth(sigma, bandwidth)
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
    pieces, owner = pieces_of(segments, sigma)
    if not len(pieces):
        return Directions(pieces, owner, np.empty((0, 3)), owner, np.empty(0))
    unit, middle = sigma * bandwidth, midpoint(pieces)
    origin = middle.mean(axis=0)
    points = np.column_stack([(middle - origin) / sigma, angle(pieces) / unit])
    alike = np.zeros(len(points), np.int64)
    centres, _ = climb(points, alike, np.pi / unit, STOP, float(steps))
    label = link(centres, alike, np.pi / unit, 2.0)
    centres = centres * (sigma, sigma, unit) + (*origin, 0.0)
    cluster = np.unique(label, return_inverse=True)[1]
    sine, cosine = (np.bincount(cluster, f(2 * centres[:, 2])) for f in (np.sin, np.cos))
    return Directions(pieces, owner, centres, cluster, np.arctan2(sine, cosine) / 2)


def pieces_of(segments: Array, sigma: float) -> tuple[Array, Indices]:
    """Equal pieces `(p, 2, 2)` of `(n, 2, 2)` segments, at most `sigma` long, and their segments.

    Pieces are as few as can be, in the order of their segments, from end point 0; metres.
    """
    counts = np.maximum(np.ceil(length(segments) / sigma - 1e-9), 1.0)
    if counts.sum() > MOST_PIECES:
        raise ValueError(
            f"sigma must cut the map into at most {MOST_PIECES} pieces, "
            f"got {sigma} m, which makes {counts.sum():.3g}: is it in metres?"
        )
    return cut_evenly(segments, counts.astype(np.int64))


def _shift_lines(
    pieces: Array, cluster: Indices, theta: Array, sigma: float
) -> tuple[Array, Indices]:
    """Phase 2 (A 4.3.4, 4.3.5): outputs `(m, 2, 2)`, metres, and that of each piece, `(p,)`.

    In units of the kernel's deviations, sqrt(2) sx along and sqrt(2) sy across, phase 2 is phase 1
    without an angle, in each cluster, of direction theta. A has the sign of b reversed in eq. 4.15.
    """
    along, across = np.sqrt(2.0) * 2 * sigma, np.sqrt(2.0) * sigma / 10
    origin = pieces.mean(axis=(0, 1))
    middle, half = midpoint(pieces) - origin, (pieces[:, 1] - pieces[:, 0]) / 2
    dx, dy = np.cos(theta)[cluster], np.sin(theta)[cluster]
    u, v = middle[:, 0] * dx + middle[:, 1] * dy, middle[:, 1] * dx - middle[:, 0] * dy
    points = np.column_stack([u / along, v / across, np.zeros(len(u))])
    centres, _ = climb(points, cluster, np.inf, STOP / np.sqrt(2.0))
    chain = np.unique(link(centres, cluster, np.inf, np.sqrt(0.5)), return_inverse=True)[1]
    offset = np.bincount(chain, centres[:, 1]) / np.bincount(chain) * across
    reach = np.abs(half[:, 0] * dx + half[:, 1] * dy)
    low, high, into, spans = u - reach, u + reach, np.empty(len(u), np.int64), np.empty((len(u), 2))
    count = join(np.lexsort((low, chain)), chain, low, high, into, spans)
    first = np.unique(into, return_index=True)[1]  # a piece of each output
    w, dx, dy, offset = spans[:count], dx[first, None], dy[first, None], offset[chain[first], None]
    return np.stack([w * dx - offset * dy, w * dy + offset * dx], axis=2) + origin, into


def longest_share(count: int, owner: Indices, into: Indices) -> Indices:
    """Most frequent output of the pieces `(p,)` of each owner, the first of equals: `(count,)`.

    All pieces of an owner are equally long. -1 for one without pieces.
    """
    most = len(into) + 1
    pairs, times = np.unique(owner * most + into, return_counts=True)
    order = np.lexsort((-pairs, times))
    parents = np.full(count, -1, np.int64)
    parents[pairs[order] // most] = pairs[order] % most  # the most frequent of an owner stays
    return parents
