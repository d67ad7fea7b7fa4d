"""Distance of two segments, quality of a reduced map, errors of poses.

Segment distance and quality: A 2.7.7 and 6.2.2; grades: A 6.2.3; relation errors: Kuemmerle et al.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..angles import axial_difference, wrap
from ..arrays import Array, Metres, Seconds, Segments, at_least, checked, unit_checks
from ..compiled import compiled
from ..kernels import (
    ACROSS_WEIGHT,
    ANGULAR_WEIGHT,
    APART_WEIGHT,
    PERPENDICULAR,
    describe,
    distance_below,
)
from ..poses import between
from ..segments import MIN_LENGTH, angle, length, midpoint, point_distance
from ..threads import Rows, in_threads, shares

#: A 6.2.3: grades of a reduction rate and of a quality, in steps of ten per cent.
REDUCTION_GRADES = {
    70: "excellent", 60: "very good", 50: "good", 40: "good", 30: "fair", 20: "poor",
}  # fmt: skip
QUALITY_GRADES = {
    90: "excellent", 80: "very good", 70: "good", 60: "fair", 50: "poor", 40: "very poor",
}  # fmt: skip


def segment_distance(
    u: ArrayLike, v: ArrayLike, weight_u: ArrayLike = 1.0, weight_v: ArrayLike = 1.0
) -> Array:
    """Distance between segments, metres: `0.66 D_ang + 0.09 D_uva + 0.25 D_uv` (A 2.7.7).

    Not a metric: two collinear segments that touch have distance 0, whatever their lengths. The
    weights say how much each pulls the mean line; leading axes broadcast.

    Examples
    --------
    >>> wall = [(0, 0), (2, 0)]
    >>> segment_distance(wall, [wall, [(0, 0.1), (2, 0.1)], [(2, 0), (5, 0)]]).round(6)
    array([0.    , 0.0295, 0.    ])
    """
    angular, across, apart = distance_terms(u, v, weight_u, weight_v)
    return ANGULAR_WEIGHT * angular + ACROSS_WEIGHT * across + APART_WEIGHT * apart


def distance_terms(
    u: ArrayLike, v: ArrayLike, weight_u: ArrayLike = 1.0, weight_v: ArrayLike = 1.0
) -> tuple[Array, Array, Array]:
    """The three terms of `segment_distance`, each in metres: angular, across, apart.

    D_ang is length times tangent of the angle to the mean line, weighted mean of both; D_uva the
    largest distance of an end point from the mean line; D_uv the smallest distance from an end
    point of one to the other segment. The mean line has the weighted axial mean direction and
    passes through the weighted mean of the middles. Perpendicular segments have two mean
    directions: the one with the smaller sum counts.

    Examples
    --------
    >>> terms = distance_terms([(0, 0), (2, 0)], [(0, 0.1), (2, 0.1)])
    >>> [round(float(term), 6) for term in terms]
    [0.0, 0.05, 0.1]
    """
    u, v = arrays.with_axes(u, "u", 2, 2), arrays.with_axes(v, "v", 2, 2)
    share = arrays.share_of_second(weight_u, weight_v, ("weight_u", "weight_v"))
    at_u, at_v = _angles_of_both(u, v)
    turn = axial_difference(at_v, at_u)
    apart = np.minimum(
        point_distance(u, v[..., None, :, :]).min(-1), point_distance(v, u[..., None, :, :]).min(-1)
    )
    angular, across = _mean_line_terms(u, v, at_u, share, turn)
    other = _mean_line_terms(u, v, at_u, share, -turn)
    swap = np.pi / 2 - np.abs(turn) <= PERPENDICULAR
    swap &= (
        ANGULAR_WEIGHT * other[0] + ACROSS_WEIGHT * other[1]
        < ANGULAR_WEIGHT * angular + ACROSS_WEIGHT * across
    )
    return np.where(swap, other[0], angular), np.where(swap, other[1], across), apart


def errors(before: Segments, after: Segments) -> Array:
    """Distance of each segment of a map from the nearest one after its reduction (A 6.2.2).

    `(n,)`, metres; `inf` everywhere where `after` is empty.

    Examples
    --------
    >>> errors([[(0, 0), (2, 0)], [(0, 1), (2, 1)]], [[(0, 0), (2, 0)]]).round(6)
    array([0.   , 0.295])
    """
    a, b = arrays.segments(before, "before"), arrays.segments(after, "after")
    if len(a) == 0 or len(b) == 0:
        return np.full(len(a), np.inf)
    b = b[np.argsort(b[:, 0, 0] + b[:, 1, 0])]
    a = np.array(a, order="C")  # a map's own is read-only: all would be compiled once more for it
    near, far = describe(a), describe(b)
    first = np.searchsorted(far[:, 0], near[:, 0])
    distances, longest = np.empty(len(a)), far[:, 4].max()

    def measure(part: Rows) -> None:
        distances[part] = _nearest_distances(a[part], b, near[part], far, first[part], longest)

    in_threads(measure, shares(np.arange(len(a)), 4000))
    return distances


@checked
def quality(before: Segments, after: Segments, *, scale: Metres = 0.050) -> float:
    """How well a reduced map keeps the walls: `exp(-mean error / scale)`, in `[0, 1]` (A 6.2.2).

    1 for an unchanged map, or where there was nothing to lose; 0 where nothing is left; NaN, with a
    warning, where both are empty. `scale` is the mean error at which it falls to 37 %: 50 mm in A.
    A segment without length is no wall: every reduction drops it, and it does not count here. A
    reduction in the place of `before`, with a larger map after it, is warned of: they are swapped.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (2, 0)]])
    >>> quality(wall, wall), round(quality(wall, wall + 0.1), 3)
    (1.0, 0.554)
    """
    old = arrays.segments(before, "before")
    distances = errors(old[length(old) >= MIN_LENGTH], after)
    if hasattr(before, "parents") and len(arrays.segments(after, "after")) > len(old):
        unit_checks.warn("before is a reduction, and after a larger map: quality(before, after)")
    if len(distances):
        return float(np.exp(-distances.mean() / scale))
    if len(old) or len(arrays.segments(after, "after")):
        return 1.0
    text = "quality is NaN: neither map holds a segment, before or after"
    unit_checks.warn(text)
    return np.nan


def reduction_rate(before: Segments, after: Segments) -> float:
    """Share of the segments that a reduction removed, `(n - n') / n`; 0 for an empty map.

    Examples
    --------
    >>> reduction_rate(np.zeros((4, 2, 2)), np.zeros((1, 2, 2)))
    0.75
    """
    n, n_after = len(arrays.segments(before, "before")), len(arrays.segments(after, "after"))
    return (n - n_after) / n if n else 0.0


def grade_reduction(rate: float) -> str:
    """A's word for a reduction rate in `[0, 1]` (A 6.2.3): the nearest tenth, halves upward.

    Examples
    --------
    >>> grade_reduction(0.66), grade_reduction(0.45)
    ('excellent', 'good')
    """
    return _grade(arrays.number(rate, "rate", least=-arrays.MOST_COUNTED, most=1), REDUCTION_GRADES)


def grade_quality(value: float) -> str:
    """A's word for a quality in `[0, 1]` (A 6.2.3): the nearest tenth, halves upward.

    Examples
    --------
    >>> grade_quality(0.85), grade_quality(0.1)
    ('excellent', 'very poor')
    """
    return _grade(arrays.number(value, "value", least=0, most=1), QUALITY_GRADES)


@checked
def relation_errors(
    times: ArrayLike,
    poses: ArrayLike,
    relations: ArrayLike,
    *,
    tolerance: Annotated[Seconds, at_least(0)] = 0.02,
) -> tuple[Array, Array]:
    """Errors of a trajectory against verified relative poses (Kuemmerle et al. 2009).

    Parameters
    ----------
    times, poses : (k,) array, seconds; (k, 3) array, metres and radians
        In any order; rows of NaN are passed over.
    relations : (m, 8) array
        As in the benchmark's files: t1, t2 [s], x, y, z [m], roll, pitch, yaw [rad] of the pose at
        t2 in the frame of the pose at t1.
    tolerance
        A relation counts only where a pose lies this near in time to both ends; the number of those
        left out is `len(relations) - len(translation)`.

    Returns
    -------
    translation, rotation : (j,) array, metres; radians
        For the j <= m relations that count, in their order.

    Examples
    --------
    >>> relation = [0.0, 1.0, 1.0, 0.1, 0, 0, 0, 0.2]
    >>> far, turned = relation_errors([0, 1], [(0, 0, 0), (1, 0, 0)], [relation])
    >>> far.round(6), turned.round(6)
    (array([0.1]), array([0.2]))
    """
    t = arrays.values(times, "times").ravel()
    p = arrays.poses(poses, count=len(t), missing=True)
    unit, limit = "seconds, metres and radians", arrays.LARGEST_COORDINATE
    wanted = arrays.table(relations, "relations", 8, unit=unit, limit=limit)
    placed = np.isfinite(p).all(1)
    order = np.argsort(t[placed], kind="stable")
    t, p = t[placed][order], p[placed][order]
    if not len(t):
        return np.empty(0), np.empty(0)
    after = np.minimum(np.searchsorted(t, wanted[:, :2]), len(t) - 1)
    before = np.maximum(after - 1, 0)
    ends = np.where(wanted[:, :2] - t[before] <= t[after] - wanted[:, :2], before, after)
    near = (np.abs(t[ends] - wanted[:, :2]) <= tolerance).all(1)
    relative = between(p[ends[near, 0]], p[ends[near, 1]])
    d = between(wanted[near][:, [2, 3, 7]], relative)
    return np.hypot(d[:, 0], d[:, 1]), np.abs(wrap(d[:, 2]))


def _angles_of_both(u: Array, v: Array) -> tuple[Array, Array]:
    """Angles of both; a segment without length takes the direction of the other, or 0."""
    at_u, at_v = np.broadcast_arrays(angle(u), angle(v))
    none_u, none_v = length(u) < MIN_LENGTH, length(v) < MIN_LENGTH
    first = np.where(none_u, np.where(none_v, 0.0, at_v), at_u)
    return first, np.where(none_v, first, at_v)


def _mean_line_terms(
    u: Array, v: Array, at_u: Array, share: Array, turn: Array
) -> tuple[Array, Array]:
    """D_ang and D_uva where v lies at `turn` from u and pulls with its `share_of_second`."""
    direction = at_u + share * turn
    part = share[..., None]
    middle = (1 - part) * midpoint(u) + part * midpoint(v)
    tan_u, tan_v = np.tan(np.abs(share * turn)), np.tan(np.abs((1 - share) * turn))
    angular = (1 - share) * length(u) * tan_u + share * length(v) * tan_v
    normal = np.stack([-np.sin(direction), np.cos(direction)], -1)
    off = [np.abs(((s - middle[..., None, :]) * normal[..., None, :]).sum(-1)) for s in (u, v)]
    return angular, np.maximum(off[0].max(-1), off[1].max(-1))


def _grade(value: float, grades: dict[int, str]) -> str:
    step = int(np.floor(round(100 * value, 9) / 10 + 0.5)) * 10
    return grades[min(max(step, min(grades)), max(grades))]


@compiled
def _nearest_distances(
    before: Array, after: Array, a: Array, b: Array, first: NDArray[np.int64], longest: float
) -> Array:
    """Distance of each segment of `before` to the nearest one of `after`, `(n,)`, metres.

    `after` is sorted by the x of the middle; `first` is where each of `before` would stand among
    them, `longest` their greatest half length. It computes `segment_distance` with equal weights,
    without trigonometry, and passes over every pair whose lower bound exceeds the best pair found
    so far; so the minimum is exact.
    """
    distances = np.empty(len(before))
    for i in range(len(before)):
        best = np.inf
        lower, upper = first[i] - 1, first[i]
        reach = a[i, 4] + longest
        while lower >= 0 or upper < len(b):  # outwards from the middle of segment i
            go_down = upper >= len(b) or (
                lower >= 0 and a[i, 0] - b[lower, 0] < b[upper, 0] - a[i, 0]
            )
            j = lower if go_down else upper
            lower, upper = (lower - 1, upper) if go_down else (lower, upper + 1)
            dx, dy = abs(b[j, 0] - a[i, 0]), b[j, 1] - a[i, 1]
            if APART_WEIGHT * (dx - reach) >= best:
                break
            bound = np.sqrt(dx * dx + dy * dy) - a[i, 4] - b[j, 4]
            if APART_WEIGHT * bound >= best:
                continue
            best = min(best, distance_below(before[i], after[j], a[i], b[j], best))
        distances[i] = best
    return distances
