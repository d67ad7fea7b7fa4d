"""Pose graph: each scan on a map of the last key frames, loops closed, all poses solved.

The whole method stands here; its parts are the front end, which tracks the robot from key frame to
key frame, the key frames with the edges between them, and the closing of loops.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ... import arrays
from ...arrays import Array, Metres, Positive, Radians, at_most
from ...compiled import work_time
from ...poses.motions import between, compose, inverse, wrap
from ...progress import Progress, announce, each
from ...scans import LaserScan, Log
from ...scans.causes import Unmatched
from ...threads import Locked, locked
from .._result import Alignment, Match, Outcome, alignment_method, checked_alignment, no_match
from ..graph import REAL, Edge, Graph, loops_of
from ..points import PointMap
from ._front_end import SURE_OVERLAP, FrontEnd, TrackedScan, Tracking
from ._key_frames import loop_pairs, rollback_on_error
from ._loop_closing import LOST_WINDOW_M, LoopCloser, LoopClosing, Window
from ._mending import drop_torn
from ._places import OVERLAP_GAIN

if TYPE_CHECKING:
    import pandas as pd

#: A place in twice the window holds `OVERLAP_GAIN` more, and at least this share of the scan.
LEAST_OVERLAP = 0.6
#: A match within this turn of the odometry agrees with it: ordinary wheels err by 3 degrees a step.
ODOMETRY_AGREES_RAD = np.radians(5)
#: A match that does not agree with the odometry has to hold this much more of the scan.
AGAINST_ODOMETRY_GAIN = 0.05
#: To turn back by this, radians, costs the whole scan, and less in proportion. Intel's wheels err
#: by up to 25 degrees: what agrees with them and is false holds 0.17 less, and more.
HALF_ROUND_RAD = np.pi

HalfSide = Annotated[Metres, at_most(20)]
HalfTurn = Annotated[Radians, at_most(np.pi)]


@alignment_method
def pose_graph(
    log: Log,
    *,
    step: Metres = 0.5,
    turn: Radians = np.radians(30),
    window: HalfSide = 0.5,
    window_angle: HalfTurn = np.radians(40),
    drift: Positive = 0.03,
    tracking: Tracking = Tracking(),
    closing: LoopClosing = LoopClosing(),
    progress: Progress | None = None,
) -> Outcome:
    """Match each scan with a local map, close loops, and solve for all poses together.

    Each scan is searched for about where the odometry puts it (Olson 2009), on a map of the last
    ten key frames, and then moved by point-to-line ICP (Censi 2008): the odometry may be wrong by a
    metre and a radian at a step. Key frames that come back to an old place are searched for there;
    a loop counts only where two others agree with it. The poses fit all steps and loops best, with
    Cauchy weights (Grisetti et al. 2010). Without odometry the last motion is assumed to go
    on in time, after a scan that did not match the robot to stand; what fits badly is sought at
    any heading, and after two lost scans a map begins anew, which only loops tie to the rest.

    Parameters
    ----------
    log
        In the order of recording, from `alignment.prepared`; times matter without odometry alone.
    step, turn
        A key frame is set where the robot has moved this far from the last one: half a metre, since
        doors and desks hide each other from one pose to the next.
    window, window_angle
        Half sides of the search about the guess; twice this where too little lies on the map then.
    drift
        Share of the way by which the map may have bent since an old place was left: loops are
        sought within 1 m and this share of the shortest way through the graph, at most 12 m.
    tracking, closing
        What else can be turned.
    progress
        Is called with the share of the scans that are placed and words, and may raise to stop.

    Returns
    -------
    Alignment
        With the graph. A scan without a match carries the odometry step; loops tie the rest again.

    Examples
    --------
    >>> from segmap import load
    >>> pose_graph(load("corridor")[:40])
    Alignment(pose_graph: 40 scans, 40 used)
    """
    graph = LiveGraph(
        step=step,
        turn=turn,
        window=window,
        window_angle=window_angle,
        drift=drift,
        tracking=tracking,
        closing=closing,
    )
    graph.extend(log)
    return graph.outcome()


class Placed(NamedTuple):
    """Where a scan lies, `(3,)`, metres and radians, and whether it moved the ones before it.

    `closed` says whether loops that it closed moved earlier poses: drawings of those are old.
    """

    pose: Array
    closed: bool


class LiveGraph(Locked):
    """A pose graph that grows scan by scan: what `pose_graph` does, while the robot drives.

    A scan that fails, or whose work is interrupted, is left out: the graph is then as before it.

    Parameters
    ----------
    step, turn, window, window_angle, drift, tracking, closing
        As in `pose_graph`.

    Examples
    --------
    >>> from segmap import load
    >>> graph = LiveGraph()
    >>> for scan in load("corridor")[:40]:
    ...     pose, closed = graph.add(scan)
    >>> graph
    LiveGraph(40 scans: 40 key frames, 0 loops)
    >>> graph.refine()
    Alignment(pose_graph: 40 scans, 40 used)
    """

    @arrays.checked
    def __init__(
        self,
        *,
        step: Metres = 0.5,
        turn: Radians = np.radians(30),
        window: HalfSide = 0.5,
        window_angle: HalfTurn = np.radians(40),
        drift: Positive = 0.03,
        tracking: Tracking = Tracking(),
        closing: LoopClosing = LoopClosing(),
    ) -> None:
        self.tracking = arrays.instance(tracking, "tracking", Tracking)
        self.closing = arrays.instance(closing, "closing", LoopClosing)
        self.step, self.turn = step, turn
        self.window, self.window_angle, self.seconds = window, window_angle, 0.0
        self.front_end = FrontEnd(self._match_on_map, self.tracking)
        self.loop_closer = LoopCloser(self.front_end.frames, drift, self.closing)
        self._moved_since_scan = False  # whether poses have moved since the last scan

    @locked
    def add(self, scan: LaserScan) -> Placed:
        """Place the next scan, and close the loops that it finds."""
        arrays.instance(scan, "scan", LaserScan)
        begun, closed, front = work_time(), False, self.front_end
        with rollback_on_error(front, self.loop_closer):
            # 1. The scan on the map of the last key frames
            match = front.track(scan)
            if front.needs_frame(self.step, self.turn):
                # 2. A new key frame, and the loops that it closes
                sees = any(len(row.points) for row in front.frames.rows)  # before, none is lost
                front.add_frame(match)
                closed = self.loop_closer.close(confirmed=match.matched or not sees)
                # 3. All key frames anew where loops have moved them
                if closed:
                    front.frames.optimize(lazily=True)
        self.seconds += work_time() - begun
        closed, self._moved_since_scan = closed or front.redrawn or self._moved_since_scan, False
        return Placed(front.pose(), closed)

    def extend(self, log: Log) -> None:
        """Place all scans of a log, one after the other."""
        for scan in each(arrays.instance(log, "log", Log), "placing scan"):
            self.add(scan)

    def _match_on_map(self, map: PointMap, points: Array, guess: Array) -> Match:
        """A scan's points `(m, 2)` searched for about a guess, then moved by a descent.

        In twice the window where little fits, or where the match leads out of it. Where odometry
        gave the guess, a match that turns the robot far from it gives way to one that agrees and
        fits nearly as well: a scan that turns fits best where it sees nothing new. Along a
        direction that no wall faces the guess holds.
        """
        best, _ = self.front_end.search(map, points, guess, self.window, self.window_angle, 0.0)
        x, y, turn = np.abs(best.pose - guess)
        within = max(x, y) < self.window and abs(wrap(turn)) < self.window_angle
        if not (best.matched and best.overlap > SURE_OVERLAP and within):
            twice = 2 * self.window, 2 * self.window_angle
            match, _ = self.front_end.search(map, points, guess, *twice, 0.0)
            least = max(best.overlap + OVERLAP_GAIN, LEAST_OVERLAP)
            best = match if match.overlap > least else best
        if self.front_end.has_odometry():
            best = self._prefer_odometry(map, points, guess, best)
        if not best.matched:
            return no_match(guess, best.unmatched, best.reason, best.overlap)
        if best.free is None and not best.turns:
            return best
        return replace(best, pose=map.slide_to(points, best.pose, guess))

    def _prefer_odometry(self, map: PointMap, points: Array, guess: Array, match: Match) -> Match:
        """The match, or one that agrees with the odometry's guess where it fits nearly as well."""
        if not match.matched or abs(wrap(match.pose[2] - guess[2])) <= ODOMETRY_AGREES_RAD:
            return match
        other, _ = self.front_end.search(map, points, guess, self.window, ODOMETRY_AGREES_RAD, 0.0)
        if not other.matched or abs(wrap(other.pose[2] - guess[2])) > ODOMETRY_AGREES_RAD:
            return match
        # By the guess it has turned so much since the last key frame, which is what it sees newly
        back = min(abs(wrap(match.pose[2] - other.pose[2])), abs(guess[2]))
        more = AGAINST_ODOMETRY_GAIN + back / HALF_ROUND_RAD
        return match if match.overlap > other.overlap + more else other

    @locked
    def outcome(self) -> Outcome:
        """What the method hands to its runner, once all scans are there."""
        front, closer = self.front_end, self.loop_closer
        if not front.rows:
            return Outcome(())
        announce(0.0, "solving for all poses")
        # 4. All poses together, without loops that the others, or chain and wheels, contradict
        front.frames.optimize()
        if closer.finish_pending():
            front.frames.optimize()
        if closer.drop_contradicted():
            front.frames.optimize()
        drop_torn(front.frames, front.key_odometry())
        # 5. Each scan once more, on the map that the loops have straightened
        front.register_again()
        return front.outcome(closer.not_believed())

    @locked
    def refine(self) -> Alignment:
        """Solve for all poses together, and lay each scan on the map that the loops straightened.

        Loops that still wait for others that agree are believed or rejected. More scans may follow.
        Of a whole log the result is equal to that of `pose_graph`.
        """
        begun = work_time()
        outcome = self.outcome()
        self.seconds += work_time() - begun
        scans = [row.scan for row in self.front_end.rows]
        return checked_alignment("pose_graph", scans, outcome, self.seconds)

    @locked
    def loops(self) -> pd.DataFrame:
        """The loops closed so far, a row for each, as `Alignment.loops` has them."""
        return loops_of(self.graph, self.poses)

    @locked
    def veto(self, loops: ArrayLike) -> None:
        """Take one or several of `loops()` out, by their rows, and solve for all poses without.

        Loops that had been given up because the rest contradicted them come back.
        """
        edges = [edge for edge in self.front_end.frames.edges if edge.loop]
        rows = np.unique(arrays.indices(loops, "loops"))
        if not len(rows) or rows[0] < 0 or rows[-1] >= len(edges):
            wrong = rows.tolist()
            raise ValueError(f"loops must be rows of the {len(edges)} closed so far, got {wrong}")
        with self._optimize_after():
            self.loop_closer.veto([edges[row] for row in rows])

    @locked
    def with_loops(self, veto: ArrayLike = (), tie: ArrayLike = ()) -> Alignment:
        """`refine` without some loops and with others, each two scans; ties are as `match` says.

        Examples
        --------
        >>> from segmap import load
        >>> graph = LiveGraph()
        >>> graph.extend(load("corridor"))
        >>> graph.refine().loops()[["first", "second"]].values.tolist()
        [[0, 145], [1, 147], [3, 149], [4, 151]]
        >>> graph.with_loops(veto=[(3, 149)], tie=[(5, 152)]).loops()["first"].tolist()
        [0, 1, 4, 5]
        """
        out, more = loop_pairs(veto, "veto"), loop_pairs(tie, "tie")
        for first, second in out:
            pairs = self.loops()[["first", "second"]].values.tolist()
            if [first, second] not in pairs:
                raise ValueError(f"veto: no loop was closed between scans {first}-{second}")
            self.veto(pairs.index([first, second]))
        for first, second in more:
            match = self.match(first, second)
            if not match.matched:
                raise ValueError(f"tie: scan {second} is not placed by {first}: {match.reason}")
            self.tie(first, second, match.pose)
        return self.refine()

    @locked
    def match(self, first: int, second: int) -> Match:
        """How the place of one scan lies on the map around another, for `tie`.

        The pose is that of the second in the frame of the first. It is sought within 2 m at any
        heading, and must hold as much as a loop's.

        Examples
        --------
        >>> from segmap import load
        >>> graph, log = LiveGraph(), load("room")
        >>> graph.extend(log)
        >>> graph.tie(2, 9, graph.match(2, 9).pose)
        >>> graph.loops()[["first", "second", "scans"]].values.tolist()
        [[2, 9, 7]]
        """
        (old, at), (new, there) = self._frame_of(first, "first"), self._frame_of(second, "second")
        closer = self.loop_closer
        window = Window(old, np.zeros(3), LOST_WINDOW_M, np.pi)
        match = closer.measure(window, closer.map_around(window), new)
        return replace(match, pose=between(at, compose(match.pose, there)))

    @locked
    def tie(self, first: int, second: int, pose: ArrayLike) -> None:
        """Close a loop by force, and solve for all poses: it holds, whatever else gives way.

        The pose is that of one scan in the frame of the other: `match` measures it. Such a loop is
        as sure as a match in a real building. It is one of `loops`, and can be vetoed.
        """
        relative = arrays.pose(pose, "pose")
        (old, at), (new, there) = self._frame_of(first, "first"), self._frame_of(second, "second")
        if old == new:
            raise ValueError(f"second must hang on another key frame than {first}, got {second}")
        motion = compose(compose(at, relative), inverse(there))
        if old > new:
            old, new, motion = new, old, inverse(motion)
        with self._optimize_after():
            self.loop_closer.believe([Edge(old, new, motion, np.linalg.inv(REAL), True, True)])

    def _frame_of(self, scan: int, name: str) -> tuple[int, Array]:
        """The key frame that a scan hangs on, and its pose there."""
        scan = arrays.whole(scan, name, least=0)
        if scan >= len(self):
            raise ValueError(f"{name} must be one of the {len(self)} scans so far, got {scan}")
        return self.front_end.rows[scan].frame, self.front_end.rows[scan].pose

    @contextmanager
    def _optimize_after(self) -> Iterator[None]:
        """Solve for all poses behind a change of the loops."""
        begun = work_time()
        with rollback_on_error(self.loop_closer):
            yield
            self.front_end.frames.optimize()
        self._moved_since_scan = True
        self.seconds += work_time() - begun

    @property
    @locked
    def poses(self) -> Array:
        """Poses of all scans, `(k, 3)` array, metres and radians, as the loops so far have them."""
        return self.front_end.poses()

    @locked
    def tracked(self, number: int) -> TrackedScan:
        """How a scan was laid; with `Tracking(moving=True)` its `scan` is carried to mid-turn."""
        return self.front_end.rows[arrays.whole(number, "number", least=0, most=len(self) - 1)]

    @property
    @locked
    def unmatched(self) -> tuple[Unmatched, ...]:
        """Why each scan so far was not matched, as it came; empty where it was."""
        return tuple(row.unmatched for row in self.front_end.rows)

    @property
    @locked
    def graph(self) -> Graph | None:
        """Edges between key frames, by the scans' indices; None before there is one."""
        return self.front_end.graph(self.loop_closer.not_believed())

    def __len__(self) -> int:
        return len(self.front_end.rows)

    def __repr__(self) -> str:
        frames, loops = len(self.front_end.frames), len(self.loop_closer.accepted)
        counts = f"{frames} key frames, {loops} loops"
        return f"LiveGraph({len(self)} scans: {counts})"
