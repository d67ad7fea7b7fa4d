"""Poses that came with a log are evidence like any other: matches are compared with them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses.motions import between, wrap
from ...scans import Log
from ...scans.causes import Cause, Finding
from .._result import Appraisal
from .._verdict import ONE_LOOK, PLACED
from ..graph import chain_bends, residuals, stack
from ._key_frames import loose_poses
from ._pose_graph import LiveGraph

#: Given poses contradict the matches from so many metres on: corrected poses of real logs (Intel,
#: FR079, Malaga) tear the chain by 0.29 m at most, and leave no revisit 0.31 m open.
MOST_OFF_M = 0.4
#: What is compared, in words.
OWN_PATH = "the log's own path"


def poses_compared(log: Log, poses: Array, used: NDArray[np.bool_]) -> Appraisal:
    """What matches say of poses `(k, 3)` that are given: between neighbours, and at revisits.

    Scans half a metre or 30 degrees apart make a pose graph, with the poses for an odometry; where
    they lead to no match, the scan is sought as if there were none.
    """
    graph = LiveGraph()
    front, closer = graph.front_end, graph.loop_closer
    keys = np.array(list(_key_scans(poses, used, graph.step, graph.turn)), np.int64)
    for k in keys.tolist():
        match = front.track(replace(log[k], odometry=poses[k]))
        if not front.rows[-1].used and len(front.rows) > 1:
            front.rows.pop()
            match = front.track(replace(log[k], odometry=None))
            front.rows[-1].odometry = poses[k]
        if front.needs_frame(graph.step, graph.turn):
            front.add_frame(match)
            if closer.close(confirmed=match.matched):
                front.frames.optimize(lazily=True)
    closer.finish_pending()
    frames = front.frames
    if not frames.edges:
        return Appraisal((Finding(Cause.NOT_CHECKED, len(frames), ONE_LOOK),))
    edges, scans = stack(frames.edges), keys[frames.scans]
    apart = loose_poses([row.tied for row in frames.rows], frames.edges, np.ones(len(frames)))
    bends = chain_bends(edges, poses[scans])
    # Other than solved ones these poses do not contain the chain: both err
    bends = bends._replace(size=bends.size / np.sqrt(2))
    causes = bends.finding(scans, OWN_PATH, MOST_OFF_M)
    off = np.hypot(*residuals(poses[scans], edges)[edges.loop, :2].T)
    if (far := int((off > MOST_OFF_M).sum())) > closer.rules.witnesses:
        k = np.flatnonzero(edges.loop)[np.argmax(off)]
        words = f"at {far} of {len(off)} revisits {OWN_PATH} tears what the matches say, most"
        words += f" between scans {scans[edges.first[k]]} and {scans[edges.second[k]]}"
        causes.append(Finding(Cause.BEND, off.max(), f"{words}: {off.max():.2f} m"))
    if (count := sum(not row.used or apart[row.frame] for row in front.rows)) > (1 - PLACED) * len(
        keys
    ):
        words = f"no match confirms {count} of {len(keys)} places of {OWN_PATH}"
        causes.append(Finding(Cause.NOT_CHECKED, count, words))
    return Appraisal(tuple(causes))


def _key_scans(poses: Array, used: NDArray[np.bool_], step: float, turn: float) -> Iterator[int]:
    """Scans that are used and lie so far, metres or radians, from the one before."""
    last = None
    for k in np.flatnonzero(used).tolist():
        if last is not None:
            x, y, heading = between(poses[last], poses[k])
            if np.hypot(x, y) <= step and abs(wrap(heading)) <= turn:
                continue
        last = k
        yield k
