"""Two sessions of one building: the second as a robot that comes again and knows not where."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace

import numpy as np

from ... import arrays
from ...arrays import Array
from ...compiled import work_time
from ...poses.motions import between, compose
from ...progress import each
from ...scans import LaserScan
from ...scans.causes import Cause, Finding
from .._result import Alignment, checked_alignment
from ..graph import Edge, Rejected, information
from ._loop_closing import LOST_WITNESSES, WINDOW_HALF_RAD, Window
from ._pose_graph import LiveGraph

#: How little is known of where another session begins: metres, metres, radians.
ANYWHERE = (1e3, 1e3, np.pi)
#: About a place that was found the loop is measured in a window of this half side, metres.
FOUND_PLACE_WINDOW_M = 0.5
#: Key frames of both sessions should be tied where they lie so near, metres.
TIED_FRAMES_M = 1.0
#: Key frames should be tied only where their headings differ by less, radians.
TIED_FRAMES_RAD = np.pi / 4
#: This share of such key frames must be tied. In one building 96 of 100 are (Intel, Freiburg 079).
LEAST_TIED_SHARE = 0.5
#: Why two sessions are not merged, in the words of `Alignment.doubt`.
NOT_MERGED = "the sessions are not merged"


def merge_graphs(
    first: LiveGraph, second: LiveGraph, places: Callable[[LaserScan], Array]
) -> Alignment:
    """One alignment of two sessions in one building, tied by the places that both have seen.

    Key frames of the second are sought in the first, until as many agree as for a robot that is
    lost. From there on loops are sought and believed as within one log, and all poses are solved
    together. It is undone where too few of the places that both passed, facing the same way, look
    alike: other buildings have corridors and doors too. Floors built alike and furnished otherwise
    may pass for one: 6 to 9 % of the beams then end where the other session saw free space, as do
    5 to 7 % between the halves of the log Intel, and 6 to 14 % of Freiburg 079.

    Parameters
    ----------
    first, second
        Graphs of the two, which stay as they are.
    places
        From a scan to where it may have been taken among the poses of the first, `(n, 3)`, metres
        and radians: counted where n is 1. `matching.merge` searches the map of the first.

    Returns
    -------
    Alignment
        Of the scans of both in order, at poses of the first. Where nothing agrees, `doubt` begins
        with the reason, and the scans of one session are not used: it lies anywhere.
    """
    begun = work_time()
    arrays.function(places, "places", "from a scan to poses")
    for session, name in ((first, "first"), (second, "second")):
        if not len(arrays.instance(session, name, LiveGraph)):
            raise ValueError(f"{name} must hold scans")
    graph, later = deepcopy(first), deepcopy(second)  # two, though a session is merged with itself
    front, closer, frames = graph.front_end, graph.loop_closer, graph.front_end.frames
    for own in (closer, later.loop_closer):
        own.finish_pending()
    # 1. The second begins anew behind the first: only loops tie it
    begin, reason, alike = len(frames), "", 0
    _append(graph, later)
    # 2. The place that enough others agree with
    loops, most = _agreeing_loops(graph, begin, places)
    if not loops:
        reason = f"only {most} places of the second are found in the first and agree"
    else:
        # 3. All others from there on, as within one log
        loop, rest = loops[0], slice(begin, None)
        moved = between(frames.poses[loop.second], frames.poses[rest])
        frames.poses[rest] = compose(compose(frames.poses[loop.first], loop.relative), moved)
        closer.believe(loops)
        frames.optimize()
        away = np.abs(frames.distance - frames.distance[loop.second])[rest]
        order = (begin + np.argsort(away, kind="stable")).tolist()
        for new in each(order, "closing loops of place"):
            if closer.seek(new, begin, confirmed=True):
                frames.optimize(lazily=True)
        frames.optimize()
        # 4. Whether the places that both passed are tied
        across = [edge for edge in closer.accepted if edge.first < begin <= edge.second]
        tied = {edge.second for edge in across}
        passed = _places_of_both(frames.poses, begin)
        alike = len(tied & passed)
        if alike < (least := max(LOST_WITNESSES, LEAST_TIED_SHARE * len(passed))):
            reason = f"{alike} of {len(passed)} places that both passed look alike, {least:g} must"
            closer.veto(across, reason)
            closer.pending = []
    outcome, scans = graph.outcome(), [row.scan for row in front.rows]
    merged = checked_alignment("merge", scans, outcome, work_time() - begun)
    words = f"{NOT_MERGED}: {reason}"
    none = [Finding(Cause.NOT_MERGED, alike, words)] if reason else []
    return replace(merged, causes=(*none, *merged.causes))


def _append(graph: LiveGraph, later: LiveGraph) -> None:
    """Append all scans and loops of another session, which may have begun anywhere."""
    front, closer, its = graph.front_end, graph.loop_closer, later.loop_closer
    frame, scan = len(front.frames), len(front.rows)
    rows = [replace(row, frame=frame + row.frame) for row in later.front_end.rows]
    alone = replace(rows[0].scan, odometry=None)  # its odometry begins in a frame of its own
    rows[0] = replace(rows[0], scan=alone, odometry=np.full(3, np.nan))
    front.rows += rows
    front.frames.extend(later.front_end.frames, scan, np.diag(ANYWHERE) ** 2)
    closer.descriptors += its.descriptors
    closer.accepted += [e for e in front.frames.edges if e.loop and e.first >= frame]
    closer.ways = np.concatenate([closer.ways, frame + its.ways])
    gone = its.not_believed()
    closer.rejected += [Rejected(scan + r.first, scan + r.second, r.reason) for r in gone]


def _agreeing_loops(
    graph: LiveGraph, begin: int, places: Callable[[LaserScan], Array]
) -> tuple[list[Edge], int]:
    """Loops from key frames since `begin` to those before that enough agree with, and how many."""
    rows, closer, frames, most = graph.front_end.rows, graph.loop_closer, graph.front_end.frames, 0
    loops: list[Edge] = []
    old = frames.poses[:begin]
    closer.lost_since = begin  # what is compared was seen since then
    for new in each(range(begin, len(frames)), "seeking place"):
        answer = arrays.call_given(places, "places", rows[frames.rows[new].scan].scan)
        place = arrays.poses(answer, "places")
        if len(place) != 1:
            continue
        near = int(np.argmin(np.hypot(*(old - place[0])[:, :2].T)))
        window = Window(near, between(old[near], place[0]), FOUND_PLACE_WINDOW_M, WINDOW_HALF_RAD)
        match = closer.measure(window, closer.map_around(window), new)
        if match.matched:
            weight = information(match.covariance, frames.least)
            loop = Edge(near, new, match.pose, weight, True)
            others = closer.partners(loop, loops)
            loops.append(loop)
            most = max(most, len(others))
            if len(others) >= LOST_WITNESSES:
                closer.lost_since = None
                return [loop, *others], most
    closer.lost_since = None
    return [], most


def _places_of_both(poses: Array, begin: int) -> set[int]:
    """Key frames since `begin` that lie beside one before it, and look the same way."""
    key_frames = set()
    for new in range(begin, len(poses)):
        x, y, turn = between(poses[new], poses[:begin]).T
        if ((np.hypot(x, y) < TIED_FRAMES_M) & (np.abs(turn) < TIED_FRAMES_RAD)).any():
            key_frames.add(new)
    return key_frames
