"""A log in parts: each aligned alone, side by side, then joined by the loops between them."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ... import arrays
from ...compiled import work_time
from ...poses import between, compose
from ...progress import Progress, announce, each
from ...scans import LaserScan, Log
from .._result import Alignment, checked_alignment
from ..graph import Edge, Rejected
from ._front_end import FrontEnd
from ._loop_closing import LoopCloser
from ._pose_graph import LiveGraph


@arrays.checked
def align_parts(
    parts: Sequence[Log],
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
    **thresholds: Any,
) -> Alignment:
    """Align the parts of a long log side by side, and join them: `pose_graph` on all cores.

    Each part is tracked, and its own loops are closed, in a worker. As the parts come back they are
    joined in order: the first scans of each are laid on the last map of the part before, loops
    between them are sought and believed as within one log, and all poses are solved together.
    Joining and refining remain here. It pays where most loops lie within a part, as in a city
    driven by blocks, and not where all parts pass the same corridors, since the loops between parts
    follow each other.

    Parameters
    ----------
    parts
        In the order of recording; the odometry goes on from one to the next. The first ten key
        frames of a part are laid twice: it should hold hundreds of scans.
    executor
        A process pool, or `client.get_executor()` of `dask.distributed`; None works one part after
        the other. The result is the same.
    progress
        As in `pose_graph`; of parts that an executor aligns when they are joined.
    **thresholds
        As of `pose_graph`.

    Returns
    -------
    Alignment
        Of all scans in order. Not equal to `pose_graph` of the whole log: it differs about as much
        as where the log begins three scans later, and more where either accepts false loops.

    Examples
    --------
    >>> from segmap import load
    >>> log = load("corridor")[:80]
    >>> align_parts([log[:40], log[40:]])
    Alignment(align_parts: 80 scans, 80 used)
    """
    begun, work = work_time(), partial(_part_graph, thresholds)
    arrays.instance(parts, "parts", Sequence)
    logs = [arrays.instance(log, f"parts[{k}]", Log) for k, log in enumerate(parts)]
    logs = [log for log in logs if len(log)]
    if executor is not None:
        arrays.instance(executor, "executor", Executor)
    graph, run = LiveGraph(**thresholds), map if executor is None else executor.map
    # 1. Each part alone; 2. as they come, joined to those before
    for log, part in zip(each(logs, "joining part"), run(work, logs), strict=True):
        if len(graph):
            _append_part(graph, part, log)
        else:
            graph = part
            front_end_and_closer(graph)[0].scans += log
    # 3. All poses together; 4. each scan once more, as in `pose_graph`
    found = graph.outcome()
    scans = [scan for log in logs for scan in log]
    return checked_alignment("align_parts", scans, found, work_time() - begun)


def _part_graph(thresholds: dict[str, Any], log: Log) -> LiveGraph:
    """The graph of one part, without what the caller has or can make again: it may travel far."""
    graph = LiveGraph(**thresholds)
    graph.extend(log)
    front, closer = front_end_and_closer(graph)
    front.frames.optimize()
    front.scans, front.local, closer.maps = [], None, {}
    return graph


def front_end_and_closer(graph: LiveGraph) -> tuple[FrontEnd, LoopCloser]:
    """The two halves of a graph that has scans."""
    assert graph._parts is not None
    return graph._parts


class SharedKeyFrame(NamedTuple):
    """The key frame that two graphs share, and its scan: their indices in one and in the other."""

    frame: int
    scan: int
    its_frame: int
    its_scan: int

    def moved(self, edges: list[Edge]) -> list[Edge]:
        """Edges of the other graph that lie behind the joint, as edges of the first one."""
        n, kept = self.frame - self.its_frame, [e for e in edges if e.first >= self.its_frame]
        return [edge._replace(first=edge.first + n, second=edge.second + n) for edge in kept]


def _append_part(graph: LiveGraph, part: LiveGraph, log: Log) -> None:
    """Make the graph of the next part the end of a graph, with the loops between them."""
    (front, closer), (later, its_closer) = front_end_and_closer(graph), front_end_and_closer(part)
    # 1. Its first scans follow the graph, for alone they had too little of a map to lie on
    front.see_last_frames()
    its_frame = min(graph.tracking.frames, len(later.frames) - 1)
    its_scan = later.frames.scan[its_frame]
    for ahead in log[:its_scan]:
        graph.add(ahead)
    # 2. The next one is a key frame of both, and what comes behind it is known
    front.add_frame(front.track(log[its_scan]))
    joint = SharedKeyFrame(len(front.frames) - 1, len(front.scans) - 1, its_frame, its_scan)
    append(graph, part, log[its_scan + 1 :], joint)
    # 3. Loops that lead to the parts before, as if the robot drove there now
    found = {loop.second for loop in closer.accepted}
    for new in range(joint.frame, len(front.frames)):
        announce(new / len(front.frames), "looking for loops between parts")
        scan = front.frames.scan[new]
        confirmed = front.free_along_corridor[scan] or not front.trail.reasons[scan]
        if closer.seek(new, joint.frame, confirmed=confirmed, measured=front.trail.measured(scan)):
            front.frames.optimize(lazily=True)
        closer.lost_since = None if new in found else closer.lost_since
    closer.pending += joint.moved(its_closer.pending)


def append(
    graph: LiveGraph, part: LiveGraph, scans: Sequence[LaserScan], joint: SharedKeyFrame
) -> None:
    """Append what lies behind the joint in another graph: these scans, and its own loops."""
    (front, closer), (later, its_closer) = front_end_and_closer(graph), front_end_and_closer(part)
    its_frame, its_scan = joint.its_frame, joint.its_scan
    front.frames.extend(later.frames, its_frame, joint.moved(later.frames.edges))
    trail, its, rest = front.trail, later.trail, slice(its_scan + 1, None)
    moved = between(its.poses[its_scan], np.array(its.poses)[rest])
    trail.poses += list(compose(trail.poses[-1], moved))
    trail.odometry += its.odometry[rest]
    trail.reasons += its.reasons[rest]
    front.scans += scans
    front.key_frame_of_scan += [
        joint.frame - its_frame + frame for frame in later.key_frame_of_scan[rest]
    ]
    front.pose_in_key_frame += later.pose_in_key_frame[rest]
    front.free_along_corridor += later.free_along_corridor[rest]
    front.along += later.along[rest]
    front.driven += later.driven[rest]
    front.overlap += later.overlap[rest]
    front.tied += later.tied[its_frame + 1 :]
    front.begins += [joint.frame - its_frame + k for k in later.begins if k > its_frame]
    front.lost = later.lost
    _append_loops(closer, its_closer, joint)


def _append_loops(closer: LoopCloser, later: LoopCloser, at: SharedKeyFrame) -> None:
    """Append the loops behind the joint that are believed, and those that are rejected."""
    n, k = at.frame - at.its_frame, at.scan - at.its_scan
    closer.descriptors += later.descriptors[at.its_frame :]
    closer.accepted += [e for e in closer.frames.edges if e.loop and e.first >= at.frame]
    closer.ways = np.concatenate([closer.ways, later.ways[later.ways[:, 0] >= at.its_frame] + n])
    closer.rejected += [
        Rejected(r.first + k, r.second + k, r.reason)
        for r in later.rejected
        if r.first >= at.its_scan
    ]
