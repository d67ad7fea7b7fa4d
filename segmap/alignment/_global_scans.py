"""Segments of many scans: which scans to keep, which to join, and poses that settle (A 2.5.1)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._metrics_loops import APART, describe
from ..angles import wrap
from ..arrays import Array
from ..poses import transform
from . import _global_segments_loops as loops
from ._global_equations import Indices, Pairs, best_shifts, best_turns, with_one_held

#: A round is the last when no scan moves by more than this, metres and radians.
SETTLED = 1e-4
#: Pairs that weigh less are left out: scans that hang together by them alone count as apart.
LEAST_WEIGHT = 1e-6


class Scans(NamedTuple):
    """Segments of many scans.

    Attributes
    ----------
    segments : (n, 2, 2) array, metres
        Each in the frame of its robot.
    first : (k + 1,) int array
        Scan k has the segments from `first[k]` up to `first[k + 1]`.
    """

    segments: Array
    first: Indices

    def world(self, poses: Array) -> Array:
        """All segments where the poses `(k, 3)` of the scans put them, `(n, 2, 2)`, metres."""
        return transform(poses[self.of], self.segments)

    @property
    def of(self) -> Indices:
        """Scan of each segment, `(n,)`."""
        return np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))

    def only(self, scans: Indices) -> "Scans":
        """Those scans alone, by their indices, (s,) int array; the same segments, metres."""
        return gathered([self.segments[self.first[k] : self.first[k + 1]] for k in scans])


def gathered(segments: list[Array]) -> Scans:
    """Segments of scans, one `(n, 2, 2)` array a scan, metres, in the frame of its robot."""
    first = np.cumsum([0, *(len(found) for found in segments)])
    return Scans(np.concatenate([np.empty((0, 2, 2)), *segments]), first)


class Rules(NamedTuple):
    """What makes segments similar: distance [m], angle [rad]; spread of the weights [m]; rounds."""

    similar: float
    angle: float
    spread: float
    rounds: int


def travelled(poses: Array) -> Array:
    """Way from the first pose to each, `(k,)`, metres."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(poses[:, :2], axis=0).T))])


def kept_scans(segments: Array, first: Indices, way: Array, reach: float, rules: Rules) -> Indices:
    """Indices of the scans that are aligned first (A 2.5.1): chains of neighbours, and the first.

    Segments `(n, 2, 2)`, metres, where the poses put them; the way to each scan, `(k,)`, metres.
    Where a chain breaks, the next one begins with the next scan; arcs between others may join them.
    """
    described, sine = describe(segments), np.sin(rules.angle)
    kept, k = [np.array([0])], 0
    while k < len(way):
        chain = loops.fewest(segments, described, first, way, k, reach, rules.similar, sine)
        kept += [chain] if len(chain) > 1 else []
        k = int(chain[-1]) + 1
    return np.unique(np.concatenate(kept))


def arcs_between(scans: Scans, poses: Array, way: Array, window: float, rules: Rules) -> Indices:
    """Pairs of scans, `(m, 2)`, whose views overlap, at most `window` metres of way apart."""
    segments, gap = scans.world(poses), rules.similar / APART
    boxes = np.full((len(poses), 4), np.nan)
    for k, (begin, end) in enumerate(zip(scans.first[:-1], scans.first[1:], strict=True)):
        if end > begin:
            points = segments[begin:end].reshape(-1, 2)
            boxes[k] = *(points.min(0) - gap), *points.max(0)
    i, j = np.triu_indices(len(poses), 1)
    near = (way[j] - way[i] <= window) | (j == i + 1)
    i, j = i[near], j[near]
    meet = (boxes[i, :2] <= boxes[j, 2:]) & (boxes[j, :2] <= boxes[i, 2:])
    return np.column_stack([i, j])[meet.all(1)]


def corresponding(scans: Scans, poses: Array, arcs: Indices, rules: Rules) -> tuple[Pairs, Indices]:
    """Similar segments of the scans that each arc joins, weighted (2.7), and the arc of each.

    Poses, (k, 3) array, metres and radians; arcs, (m, 2) int array of scans; p pairs and (p,) int
    array.
    """
    world, sine = scans.world(poses), np.sin(rules.angle)
    arc, found, away = loops.similar_pairs(
        world, describe(world), scans.first, arcs, rules.similar, sine
    )
    weight = np.exp(-away / (2 * rules.spread))
    some = weight > LEAST_WEIGHT
    (i, j), (u, v) = arcs[arc[some]].T, found[some].T
    return Pairs(i, j, u, v, weight[some]), arc[some]


def settled(
    scans: Scans, poses: Array, arcs: Indices, held: NDArray[np.bool_], rules: Rules
) -> Array:
    """Poses `(k, 3)` after turning all, then shifting all, until nothing moves; metres, radians."""
    poses = poses.copy()
    for _ in range(rules.rounds):
        pairs, _ = corresponding(scans, poses, arcs, rules)
        fixed = with_one_held(pairs.i, pairs.j, held)
        turns = best_turns(scans.world(poses), pairs, fixed)
        poses[:, 2] = wrap(poses[:, 2] + turns)
        shifts = best_shifts(scans.world(poses), pairs, fixed)
        poses[:, :2] += shifts
        if max(np.abs(turns).max(), np.abs(shifts).max()) < SETTLED:
            break
    return poses
