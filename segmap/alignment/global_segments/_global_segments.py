"""Global alignment of segments (A 2.5.1): all scans at once.

Elseberg, Creed, Lakaemper, "A line segment based system for 2D global mapping", ICRA 2010.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ... import arrays
from ...arrays import Array, Count, Metres, Radians, upper_bound_excluded
from ...kernels import APART_WEIGHT, describe
from ...poses import interpolate
from ...poses.motions import between, compose, inverse, wrap
from ...scans import Log
from ...scans.causes import Unmatched
from ...segments import angle as angle_of
from .._result import Laid, Outcome, alignment_method, long_segments
from ..graph import Graph, groups
from ..segment_icp import ONE_DIRECTION, SIDEWAYS
from . import _equations as equations
from ._equations import Indices, Pairs, Rules, Scans

#: Standard deviation of a wall's position from one scan to another, metres, for the residuals.
WALL_POSITION_SIGMA_M = 0.03
#: Where a smaller share of the walls lies across a direction, it is free.
LEAST_ACROSS_SHARE = 0.02
#: Why a scan is not used, where its kind says less.
WHY_WORDS = {
    Unmatched.NO_ODOMETRY: "no odometry to begin from",
    Unmatched.LITTLE_OVERLAP: "shares no two walls with the scans around it: hangs on odometry",
    Unmatched.UNTIED: "beyond a break: not tied to the largest group of scans",
    Unmatched.FREE_DIRECTION: ONE_DIRECTION,
}


@alignment_method
def global_segments(
    log: Log,
    *,
    start: ArrayLike | None = None,
    similar: Metres = 0.20,
    angle: Annotated[Radians, upper_bound_excluded(np.pi / 2)] = np.radians(15.0),
    spread: Metres = 0.05,
    reach: Metres = 1.0,
    rounds: Count = 15,
    min_length: Metres = 0.30,
) -> Outcome:
    """Turn all scans until matched segments are parallel, then shift all; repeat (Elseberg 2010).

    1. Of the scans the fewest are kept of which each shares with the next two pairs of similar
       segments that are not similar to each other. *Slip:* taken literally, a robot that comes back
       would leave its whole loop out; neighbours are at most `reach` of way apart.
    2. Every two kept scans that share so much are joined. Similar segments u, v weigh
       `exp(-D(u, v) / (2 spread))` (2.7; D as in A 2.7.7, so that sigma^2 is a length).
    3. Headings from all weighted axial differences, then positions from all end points and their
       feet, by sparse least squares with the first pose fixed; again with new pairs until nothing
       moves. First scans up to 2 `reach` of way apart are joined, then twice as far, at last all:
       so only the drift round a loop, and not the whole drift, must be small.
    4. The scans between two kept ones hang on these two: the same equations, the kept ones fixed.
       One that shares too little is carried by odometry, its misfit spread along the way.

    Needs small odometry errors: about 15 degrees and 0.7 m from one kept scan to the next, and
    less than the distance between walls where a loop closes. A group of scans that shares nothing
    with the others hangs on odometry; only the largest group counts as used.

    Parameters
    ----------
    start : (k, 3) array, metres and radians, or None
        Poses to begin from; None takes the odometry (of a scan without, between its neighbours).
    similar
        Segments are similar below this distance: 0.20 m are parallel walls 0.7 m apart.
    angle
        Segments at a larger angle are not similar.
    spread
        How far apart similar segments lie at first, sigma^2 of 2.7; at last a tenth of it. 0.05 m
        begins with parallel walls 0.23 m apart at half their weight and ends with walls 0.02 m
        apart.
    reach
        Way between kept scans, so that their views overlap.
    rounds
        Turns and shifts at most so often in each stage.
    min_length
        Shorter segments are left out: noise decides their direction, and 2.8 lets them count as
        much as long ones.

    Returns
    -------
    Alignment
        `graph` holds the edges between kept scans; residuals are the root mean square distances of
        end points from their feet over 3 cm, and a loop is an edge over more way than 2 `reach`.

    Examples
    --------
    >>> from segmap import load
    >>> global_segments(load("room"))
    Alignment(global_segments: 61 scans, 61 used)
    """
    rules = Rules(similar, angle, spread, rounds)
    if start is not None:
        guess = arrays.poses(start, "start", count=len(log))
    elif (rows := np.flatnonzero(np.isfinite(log.odometry).all(1))).size:
        at = np.clip(np.arange(len(log)), rows[0], rows[-1])
        guess = interpolate(rows, log.odometry[rows], at)
        guess = guess if rows[0] == 0 else between(guess[0], guess)  # from the origin on
    else:
        lost = [Unmatched.NONE, *[Unmatched.NO_ODOMETRY] * len(log)][: len(log)]
        return _outcome(np.zeros((len(log), 3)), lost)
    # Views overlap by boxes along the axes of the first scan, in whatever frame the poses are
    frame, guess = guess[0], between(guess[0], guess)
    # 1. The scans that are kept
    scans = equations.stacked_scans([long_segments(scan, min_length) for scan in log])
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(guess[:, :2], axis=0).T))])
    chosen = kept_scans(scans.world(guess), scans.first, way, reach, rules)
    # 2. and 3. These, joined and aligned
    poses, graph, why = _align_kept(scans.subset(chosen), guess[chosen], way[chosen], reach, rules)
    graph = replace(graph, edges=chosen[graph.edges])
    # 4. Those between hang on the two around them
    poses = hang_between(chosen, poses, guess, way)
    fixed = np.isin(np.arange(len(poses)), chosen)
    rest = np.flatnonzero(~fixed)
    place = np.searchsorted(chosen, rest)
    ends = np.column_stack([place - 1, np.minimum(place, len(chosen) - 1)])
    edges = np.unique(np.column_stack([np.repeat(rest, 2), chosen[ends].ravel()]), axis=0)
    for stage in rules.stages():
        poses = equations.settled_poses(scans, poses, edges, fixed, stage)
    pairs, _ = equations.weigh_pairs(scans.world(poses), scans.first, edges, stage)
    whole = _doubts(scans, poses, pairs)
    broken = Unmatched.UNTIED, Unmatched.TORN, Unmatched.LITTLE_OVERLAP
    for k, before in zip(rest, place - 1, strict=True):
        whole[k] = whole[k] or (Unmatched.UNTIED if why[before] in broken else Unmatched.NONE)
    for k, own in zip(chosen, why, strict=True):
        whole[k] = own
    return _outcome(compose(frame, poses), whole, graph)


def _outcome(poses: Array, why: Sequence[Unmatched], graph: Graph | None = None) -> Outcome:
    """Poses `(k, 3)`, metres and radians, with what speaks against each, for the runner."""
    rows = zip(poses, why, strict=True)
    return Outcome([Laid(pose, own, WHY_WORDS.get(own, "")) for pose, own in rows], graph)


def kept_scans(segments: Array, first: Indices, way: Array, reach: float, rules: Rules) -> Indices:
    """Indices of the scans that are aligned first (A 2.5.1): chains of neighbours, and the first.

    A chain is the fewest scans of which each shares two walls with the next, found breadth first;
    neighbours are at most `reach` of way apart. Where it ends, the next one begins with the next
    scan; edges between others may join them. Segments `(n, 2, 2)`, metres, where the poses put
    them; the way to each scan, `(k,)`, metres.
    """
    described, chosen, start = describe(segments), {0}, 0
    while start < len(way):
        before, queue = {start: start}, [start]
        for i in queue:
            near = max(int((way[i + 1 :] - way[i] <= reach).sum()), 1)
            new = [j for j in range(i + 1, min(i + 1 + near, len(way))) if j not in before]
            edges = np.array([(i, j) for j in new], np.int64).reshape(-1, 2)
            for k in np.unique(equations.shared_pairs(segments, described, first, edges, rules)[0]):
                before[new[k]] = i
                queue.append(new[k])
        k = end = max(queue)
        while k != start:
            chosen |= {k, before[k]}
            k = before[k]
        start = end + 1
    return np.array(sorted(chosen))


def hang_between(chosen: Indices, poses: Array, guess: Array, way: Array) -> Array:
    """Poses of all scans `(k, 3)`, given those of the chosen ones; metres and radians.

    Odometry from the kept scan before and from the one after, mixed by the way to each; after the
    last one, from that alone.
    """
    every = np.arange(len(guess))
    before = np.searchsorted(chosen, every, side="right") - 1
    after = np.minimum(before + 1, len(chosen) - 1)
    a, b = chosen[before], chosen[after]
    forth = compose(poses[before], between(guess[a], guess))
    back = compose(poses[after], between(guess[b], guess))
    span, done = way[b] - way[a] + 1e-6 * (b - a), way - way[a] + 1e-6 * (every - a)
    part = np.where(b > a, done / np.where(b > a, span, 1.0), 0.0)
    step = back - forth
    step[:, 2] = wrap(step[:, 2])
    blend = forth + part[:, None] * step
    blend[:, 2] = wrap(blend[:, 2])
    return blend


def _align_kept(
    scans: Scans, guess: Array, way: Array, reach: float, rules: Rules
) -> tuple[Array, Graph, list[Unmatched]]:
    """Poses of the kept scans, the edges between them, and what speaks against each pose."""
    poses, fixed = guess.copy(), np.arange(len(guess)) == 0
    windows = [2 * reach]
    while windows[-1] < way[-1]:
        windows.append(2 * windows[-1])
    stages = [(window, rules) for window in windows[:-1]]
    for window, stage in [*stages, *((np.inf, finer) for finer in rules.stages())]:
        edges = _overlaps(scans, poses, way, window, stage)
        poses = equations.settled_poses(scans, poses, edges, fixed, stage)
        pairs, edge = equations.weigh_pairs(scans.world(poses), scans.first, edges, stage)
        # Each group but the first moves whole: its first scan hangs on the one before it
        group = groups(pairs.i, pairs.j, len(poses))
        begins = np.sort(np.unique(group, return_index=True)[1])[1:]
        for k in begins:
            there = compose(poses[k - 1], between(guess[k - 1], guess[k]))
            whole = group == group[k]
            poses[whole] = compose(compose(there, inverse(poses[k])), poses[whole])
    # Torn: what left the odometry step by more than could be matched; beyond: what belongs neither
    # to the largest group nor to the largest part of a torn one
    step = between(between(guess[:-1], guess[1:]), between(poses[:-1], poses[1:]))
    far = np.hypot(step[:, 0], step[:, 1]) > rules.similar / SIDEWAYS
    far |= np.abs(step[:, 2]) > rules.angle
    torn = np.flatnonzero(far & (group[:-1] == group[1:])) + 1
    part = np.cumsum(np.isin(np.arange(len(group)), torn))
    label = np.unique(np.column_stack([group, part]), axis=0, return_inverse=True)[1].ravel()
    beyond = np.flatnonzero(label != np.bincount(label).argmax())
    why = _doubts(scans, poses, pairs)
    marks = (begins, Unmatched.LITTLE_OVERLAP), (torn, Unmatched.TORN), (beyond, Unmatched.UNTIED)
    for marked, kind in marks:
        for k in marked:
            why[k] = why[k] or kind
    joined, owner = np.unique(edge, return_inverse=True)
    square = (equations.feet(scans.world(poses), pairs)[0] ** 2).sum(-1).reshape(4, -1).mean(0)
    total, weight = np.bincount(owner, pairs.weight * square), np.bincount(owner, pairs.weight)
    i, j = edges[joined].T
    residuals = np.sqrt(total / weight) / WALL_POSITION_SIGMA_M
    loop = way[j] - way[i] > 2 * reach
    graph = Graph(edges[joined], between(poses[i], poses[j]), loop, residuals)
    return poses, graph, [Unmatched.NONE, *why[1:]]


def _overlaps(scans: Scans, poses: Array, way: Array, window: float, rules: Rules) -> Indices:
    """Pairs of scans, `(m, 2)`, whose views overlap, at most `window` metres of way apart."""
    segments, gap = scans.world(poses), rules.similar / APART_WEIGHT
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


def _doubts(scans: Scans, poses: Array, pairs: Pairs) -> list[Unmatched]:
    """What speaks against each pose, by the segments that it rests on."""
    count, world = len(poses), scans.world(poses)
    both, weight = np.r_[pairs.i, pairs.j], np.tile(pairs.weight, 2)
    whole = np.bincount(both, weight, count)
    ways = weight * np.exp(2j * angle_of(world[np.r_[pairs.u, pairs.v]]))
    total = np.bincount(both, ways.real, count) + 1j * np.bincount(both, ways.imag, count)
    one_way = (whole - np.abs(total)) / 2 < LEAST_ACROSS_SHARE * whole
    free, none = Unmatched.FREE_DIRECTION, Unmatched.LITTLE_OVERLAP
    marks = zip(whole > 0, one_way, strict=True)
    return [none if not some else free if one else Unmatched.NONE for some, one in marks]
