"""Headings of all scans at once, then positions of all at once: A 2.2-2.15, mended.

Both are the same problem, A's 2.3: the x that make `sum w |x_i - x_j + c|^2` least. Setting its
derivatives to zero gives `B x = A` with a graph Laplacian B, which leaves one x of each connected
group of scans free: that one is fixed. *Slips:* A's 2.6 lacks a minus before its first sum, the
right sides of 2.11 and 2.15 have the wrong sign, and 2.13-2.14 lack a factor 2 and half of what
stands off the diagonal. Here all of them come from `solve_differences`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...angles import axial_difference
from ...arrays import Array
from ...compiled import compiled
from ...kernels import APART_WEIGHT, describe, distance_below
from ...poses.motions import transform, wrap
from ...segments import angle
from ..graph import groups

Indices = NDArray[np.int64]


#: A round is the last when no scan moves by more, metres and radians.
ROUNDS_CONVERGED = 1e-4
#: Parts of `spread` that the weights go down by when all scans are joined.
SPREAD_PARTS = (1.0, 1 / 4, 1 / 10)
#: Pairs that weigh less are left out: scans joined by such pairs alone count as not joined.
LEAST_WEIGHT = 1e-6


class Rules(NamedTuple):
    """The thresholds of `global_segments` in one piece: metres, radians, metres, a count."""

    similar: float
    angle: float
    spread: float
    rounds: int

    def stages(self) -> list[Rules]:
        """Those of the last stages, with ever less spread."""
        return [self._replace(spread=part * self.spread) for part in SPREAD_PARTS]


class Scans(NamedTuple):
    """Segments of many scans, (n, 2, 2) array, metres, each in the frame of its robot.

    Scan k has those from `first[k]` up to `first[k + 1]`, (k + 1,) int array.
    """

    segments: Array
    first: Indices

    def world(self, poses: Array) -> Array:
        """All segments where the poses `(k, 3)` of the scans put them, `(n, 2, 2)`, metres."""
        of = np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))
        return transform(poses[of], self.segments)

    def subset(self, scans: Indices) -> Scans:
        """Those scans alone, by their indices, (s,) int array; the same segments, metres."""
        return stacked_scans([self.segments[self.first[k] : self.first[k + 1]] for k in scans])


def stacked_scans(segments: list[Array]) -> Scans:
    """Segments of scans, one `(n, 2, 2)` array a scan, metres, in the frame of its robot."""
    first = np.cumsum([0, *(len(part) for part in segments)])
    return Scans(np.concatenate([np.empty((0, 2, 2)), *segments]), first)


class Pairs(NamedTuple):
    """Segments u and v of the scans i and j that correspond, (p,) int arrays of indices.

    They weigh `exp(-D / (2 sigma^2))` (2.7), (p,) array.
    """

    i: Indices
    j: Indices
    u: Indices
    v: Indices
    weight: Array


@compiled
def _distance(s: Array, d: Array, u: int, v: int, most: float) -> float:
    """Segment distance of u and v of s, which d describes; infinity where not below `most`."""
    reach = most / APART_WEIGHT + d[u, 4] + d[v, 4]
    if abs(d[u, 0] - d[v, 0]) >= reach or abs(d[u, 1] - d[v, 1]) >= reach:
        return np.inf
    return distance_below(s[u], s[v], d[u], d[v], most)


@compiled
def similar_pairs(
    s: Array,
    d: Array,
    first: Indices,
    edges: Indices,
    most: float,
    sine: float,
    begin: int,
    edge: Indices,
    pairs: Indices,
    away: Array,
) -> tuple[int, int]:
    """Write the similar segments of the scans that each edge `(m, 2)` joins, from `begin` on.

    Of segments s `(n, 2, 2)`, which d `(n, 5)` describes. Two scans share none where no two of
    their pairs are unlike each other (A 2.5.1). Writes the edge of each pair, the pair, and its
    distance in metres to `edge`, `pairs`, `away`, (r,), (r, 2), (r,) arrays. Returns how many rows
    it wrote, and the first edge for which there may be too little room.
    """
    n = 0
    for k in range(begin, len(edges)):
        i, j, start = edges[k, 0], edges[k, 1], n
        if n + (first[i + 1] - first[i]) * (first[j + 1] - first[j]) > len(away):
            return n, k
        for u in range(first[i], first[i + 1]):
            for v in range(first[j], first[j + 1]):
                if abs(d[u, 2] * d[v, 3] - d[u, 3] * d[v, 2]) < sine:
                    distance = _distance(s, d, u, v, most)
                    if distance < most:
                        edge[n], pairs[n, 0], pairs[n, 1], away[n] = k, u, v, distance
                        n += 1
        unlike = False
        for a in range(start, n):
            for b in range(start, a):
                if _distance(s, d, pairs[a, 0], pairs[b, 0], most) == np.inf:
                    unlike = _distance(s, d, pairs[a, 1], pairs[b, 1], most) == np.inf
                if unlike:
                    break
            if unlike:
                break
        n = n if unlike else start
    return n, len(edges)


def shared_pairs(
    segments: Array, described: Array, first: Indices, edges: Indices, rules: Rules
) -> tuple[Indices, Indices, Array]:
    """Similar segments of the scans that each edge joins: the edge of each, the pair, its distance.

    Segments `(n, 2, 2)`, metres, where the poses put them, and what `describe` says of them; edges,
    (m, 2) int array of scans. Returns (p,) and (p, 2) int arrays and a (p,) array, metres.
    """
    sine, room = np.sin(rules.angle), np.prod(first[edges + 1] - first[edges], axis=1)
    size = max(16 * len(edges), int(room.max(initial=0)))
    blocks, k = [(np.empty(0, np.int64), np.empty((0, 2), np.int64), np.empty(0))], 0
    while k < len(edges):
        edge, pairs, away = np.empty(size, np.int64), np.empty((size, 2), np.int64), np.empty(size)
        n, k = similar_pairs(
            segments, described, first, edges, rules.similar, sine, k, edge, pairs, away
        )
        blocks.append((edge[:n], pairs[:n], away[:n]))
    edge, pairs, away = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    return edge, pairs, away


def weigh_pairs(
    segments: Array, first: Indices, edges: Indices, rules: Rules
) -> tuple[Pairs, Indices]:
    """Similar segments as weighted pairs (2.7), and the edge of each, (p,) int array.

    Segments `(n, 2, 2)`, metres, where the poses put them; edges, (m, 2) int array of scans.
    """
    edge, pairs, away = shared_pairs(segments, describe(segments), first, edges, rules)
    weight = np.exp(-away / (2 * rules.spread))
    some = weight > LEAST_WEIGHT
    (i, j), (u, v) = edges[edge[some]].T, pairs[some].T
    return Pairs(i, j, u, v, weight[some]), edge[some]


def solve_differences(
    i: Indices, j: Indices, weight: Array, gap: Array, fixed: NDArray[np.bool_]
) -> Array:
    """The x, `(n, c)`, with the least `sum w |x_i - x_j + gap|^2`, zero where fixed (2.3-2.6).

    Of p pairs, gaps `(p, c)`. Every group of connected scans must have one that is fixed.

    Examples
    --------
    >>> ends = np.array([0, 1]), np.array([1, 2])
    >>> fixed = np.array([True, False, False])
    >>> solve_differences(*ends, np.ones(2), np.array([[1.0], [2.0]]), fixed).ravel().tolist()
    [0.0, 1.0, 3.0]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    n, free = len(fixed), np.flatnonzero(~fixed)
    solution, right = np.zeros((2, n, gap.shape[1]))
    if not len(free):
        return solution
    entries = np.r_[weight, weight, -weight, -weight]
    laplacian = coo_array((entries, (np.r_[i, j, i, j], np.r_[i, j, j, i])), shape=(n, n)).tocsr()
    np.add.at(right, i, -weight[:, None] * gap)
    np.add.at(right, j, weight[:, None] * gap)
    solution[free] = splu(laplacian[free][:, free].tocsc()).solve(right[free])
    return solution


def with_one_fixed(i: Indices, j: Indices, fixed: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Fixed scans, and the first of each group that has none: (n,) bool array, as `fixed` is."""
    group = groups(i, j, len(fixed))
    first = np.unique(group, return_index=True)[1]
    anchors = fixed.copy()
    anchors[first[~np.isin(group[first], group[fixed])]] = True
    return anchors


def best_turns(segments: Array, pairs: Pairs, fixed: NDArray[np.bool_]) -> Array:
    """Turns of all scans, `(n,)` radians, that make corresponding segments most parallel (2.8)."""
    gap = axial_difference(angle(segments[pairs.u]), angle(segments[pairs.v]))
    return solve_differences(pairs.i, pairs.j, pairs.weight, gap[:, None], fixed)[:, 0]


def best_shifts(segments: Array, pairs: Pairs, fixed: NDArray[np.bool_]) -> Array:
    """Shifts of all scans, `(n, 2)` metres, that bring end points to their feet (2.12)."""
    gap, i, j = feet(segments, pairs)
    return solve_differences(i, j, np.tile(pairs.weight, 4), gap, fixed)


def feet(segments: Array, pairs: Pairs) -> tuple[Array, Indices, Indices]:
    """S and E of 2.12 for both directions, (4 p, 2) array, metres, and the scans at both ends.

    From the foot of an end point on the line of its partner to the end point; end points of u go to
    v and those of v to u. On the line: a wall seen in part would be drawn to the other end of what
    the partner has seen.
    """
    gaps = []
    for a, b in ((pairs.u, pairs.v), (pairs.v, pairs.u)):
        start, d = segments[b, 0], segments[b, 1] - segments[b, 0]
        for end in (0, 1):
            along = ((segments[a, end] - start) * d).sum(-1) / (d * d).sum(-1)
            gaps.append(segments[a, end] - (start + along[:, None] * d))
    i, j = np.r_[pairs.i, pairs.i, pairs.j, pairs.j], np.r_[pairs.j, pairs.j, pairs.i, pairs.i]
    return np.concatenate(gaps), i, j


def settled_poses(
    scans: Scans, poses: Array, edges: Indices, fixed: NDArray[np.bool_], rules: Rules
) -> Array:
    """Poses `(k, 3)` after turning all, then shifting all, until nothing moves; metres, radians."""
    poses = poses.copy()
    for _ in range(rules.rounds):
        world = scans.world(poses)
        pairs, _ = weigh_pairs(world, scans.first, edges, rules)
        anchors = with_one_fixed(pairs.i, pairs.j, fixed)
        turns = best_turns(world, pairs, anchors)
        poses[:, 2] = wrap(poses[:, 2] + turns)
        shifts = best_shifts(scans.world(poses), pairs, anchors)
        poses[:, :2] += shifts
        if max(np.abs(turns).max(), np.abs(shifts).max()) < ROUNDS_CONVERGED:
            break
    return poses
