"""Clusters of false loops are dropped where a third witness, the wheels, agrees with the chain.

Loops that are gone cannot speak against the rest: without such a witness the map stays as it is,
and its bend makes it doubtful.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ..graph import MOST_BEND, Edge, chain_bends, stack
from ._key_frames import KeyFrames, edges_but
from ._places import PASS_GAP_FRAMES


def drop_torn(frames: KeyFrames, odometry: Array) -> bool:
    """Solve without the clusters of loops that tear the chain; True where that mends the poses.

    `odometry`, `(n, 3)`, is that of the key frames, NaN where the log has none.
    """
    if not any(edge.loop for edge in frames.edges):
        return False
    bends = chain_bends(stack(frames.edges), frames.poses)
    # Steps that no match made are the wheels themselves: there they are no third witness
    driven = np.cumsum([not row.tied for row in frames.rows])
    torn = (bends.size > MOST_BEND) & (driven[bends.first] == driven[bends.last])
    if not torn.any():
        return False
    wheels = chain_bends(stack(frames.edges), odometry).size[torn]
    if not np.median(wheels) <= MOST_BEND:  # nor where they are not known
        return False
    edges, poses, worst = frames.edges, frames.poses, float(bends.size.max())
    clusters = [c for c in _loop_clusters(edges) if _spans(c, bends.first[torn], bends.last[torn])]
    rest = edges
    while clusters and worst > MOST_BEND:
        sizes = [_worst_without(frames, rest, cluster) for cluster in clusters]
        if min(sizes) >= worst:
            break
        worst = min(sizes)
        gone = clusters.pop(int(np.argmin(sizes)))
        rest = edges_but(rest, gone)
    mended = worst <= MOST_BEND
    frames.exchange(rest if mended else edges)
    frames.poses = poses
    frames.optimize()
    return mended


def _loop_clusters(edges: list[Edge]) -> list[list[Edge]]:
    """Loops by runs whose ends follow each other at both sides; one that is forced is in none."""
    runs: list[list[Edge]] = []
    for edge in sorted((e for e in edges if e.loop and not e.forced), key=lambda e: e.second):
        for run in runs:
            ends = np.array([(last.first, last.second) for last in run[-3:]])
            if (abs(ends - edge[:2]) <= PASS_GAP_FRAMES).all(1).any():
                run.append(edge)
                break
        else:
            runs.append([edge])
    return runs


def _spans(cluster: list[Edge], first: NDArray[np.int64], last: NDArray[np.int64]) -> bool:
    """Whether a loop of a cluster goes over a part of one of some windows."""
    return any(((e.first < last) & (e.second > first)).any() for e in cluster)


def _worst_without(frames: KeyFrames, edges: list[Edge], gone: list[Edge]) -> float:
    """The largest bend that is left where the poses are solved without some loops."""
    poses = frames.poses
    frames.exchange(edges_but(edges, gone))
    frames.optimize()
    worst = chain_bends(stack(frames.edges), frames.poses).size.max()
    frames.poses = poses
    return float(worst)
