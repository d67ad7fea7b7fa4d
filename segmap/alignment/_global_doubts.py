"""What speaks against the poses of global alignment, and the arcs that it rests on."""

import numpy as np

from ..angles import wrap
from ..arrays import Array
from ..poses import between
from ..segments import angle
from ._global_equations import Indices, Pairs, feet
from ._global_scans import Rules, Scans
from ._result import Graph
from ._segment_icp import ACROSS_SHARE, ONE_DIRECTION, SIDEWAYS

#: Standard deviation of a wall's place from one scan to another, in metres.
SIGMA = 0.03
#: Scans so near, in metres and radians, must see the same walls.
SAME_PLACE, SAME_VIEW = 0.50, np.radians(30.0)

NOTHING_SHARED = "shares no two walls with the scans around it: hangs on odometry"
TORN = "torn from its neighbours farther than segments correspond"
BEYOND = "beyond a break: not tied to the largest group of scans"
DOUBLED = "sees other walls than an earlier scan at the same place"


def doubts(scans: Scans, poses: Array, pairs: Pairs) -> list[str]:
    """What speaks against each pose, by the segments that it rests on; empty where nothing does.

    Poses, (k, 3) array, metres and radians, in the frame of the map; one reason for each.
    """
    count, world = len(poses), scans.world(poses)
    both, weight = np.r_[pairs.i, pairs.j], np.tile(pairs.weight, 2)
    whole = np.bincount(both, weight, count)
    ways = weight * np.exp(2j * angle(world[np.r_[pairs.u, pairs.v]]))
    total = np.bincount(both, ways.real, count) + 1j * np.bincount(both, ways.imag, count)
    one_way = (whole - np.abs(total)) / 2 < ACROSS_SHARE * whole
    marks = zip(whole > 0, one_way, strict=True)
    return [NOTHING_SHARED if not some else ONE_DIRECTION if one else "" for some, one in marks]


def torn(poses: Array, group: Indices, guess: Array, rules: Rules) -> Indices:
    """Kept scans that left the odometry step from the one before by more than could be matched.

    Poses and guess, (k, 3) arrays, metres and radians; the group of each, (k,) int array. Indices,
    ascending, (t,) int array.
    """
    step = between(between(guess[:-1], guess[1:]), between(poses[:-1], poses[1:]))
    far = np.hypot(step[:, 0], step[:, 1]) > rules.similar / SIDEWAYS
    far |= np.abs(step[:, 2]) > rules.angle
    return np.flatnonzero(far & (group[:-1] == group[1:])) + 1


def beyond(group: Indices, torn: Indices) -> Indices:
    """Kept scans that neither belong to the largest group nor to the largest part of a torn one.

    The group of each, (k,) int array, and the indices of the torn; indices, (b,) int array.
    """
    part = np.cumsum(np.isin(np.arange(len(group)), torn))
    label = np.unique(np.column_stack([group, part]), axis=0, return_inverse=True)[1].ravel()
    return np.flatnonzero(label != np.bincount(label).argmax())


def doubled(scans: Scans, poses: Array, joined: Indices) -> Indices:
    """Scans at the place of an earlier one, looking the same way, that share nothing with it.

    Poses, (k, 3) array, metres and radians; pairs of scans that do share, (m, 2) int array; indices
    of scans, (d,) int array.
    """
    count = np.diff(scans.first)
    i, j = np.triu_indices(len(poses), 1)
    step = poses[j] - poses[i]
    same = np.hypot(step[:, 0], step[:, 1]) < SAME_PLACE
    same &= (np.abs(wrap(step[:, 2])) < SAME_VIEW) & (np.minimum(count[i], count[j]) > 1)
    known = np.isin(i * len(poses) + j, joined[:, 0] * len(poses) + joined[:, 1])
    return np.unique(j[same & ~known])


def graph(
    scans: Scans, poses: Array, way: Array, pairs: Pairs, arcs: Indices, arc: Indices, far: float
) -> Graph:
    """The arcs that share segments, as edges between scans.

    Poses, (k, 3) array, metres and radians; the way to each, (k,) array, metres; arcs, (m, 2) int
    array, and the arc of each pair, (p,) int array. An arc over more than `far` metres of way is a
    loop.
    """
    joined, owner = np.unique(arc, return_inverse=True)
    square = (feet(scans.world(poses), pairs)[0] ** 2).sum(-1).reshape(4, -1).mean(0)
    total, weight = np.bincount(owner, pairs.weight * square), np.bincount(owner, pairs.weight)
    i, j = ends = arcs[joined].T
    loop = way[j] - way[i] > far
    return Graph(ends.T, between(poses[i], poses[j]), loop, np.sqrt(total / weight) / SIGMA)
