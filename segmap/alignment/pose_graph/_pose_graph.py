"""Pose graph: each scan on a map of the last key frames, loops closed, all poses solved."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from ... import arrays
from ...arrays import Array
from ...scans import LaserScan, Log
from .._result import Alignment, Match, Outcome, alignment_method, concluded
from ..graph import Graph
from ..points import PointMap
from ._front_end import FrontEnd, search_and_register
from ._loop_closing import LoopCloser
from ._settings import LoopClosing, Tracking


@alignment_method
def pose_graph(
    log: Log,
    *,
    step: float = 0.5,
    turn: float = np.radians(30),
    window: float = 0.5,
    window_angle: float = np.radians(40),
    drift: float = 0.03,
    tracking: Tracking = Tracking(),
    closing: LoopClosing = LoopClosing(),
) -> Outcome:
    """Match each scan with a local map, close loops, and solve for all poses together.

    Each scan is searched for about where the odometry puts it (Olson 2009), on a map of the last
    ten key frames, and then moved by point-to-line ICP (Censi 2008): the odometry may be wrong by a
    metre and a radian at a step. Key frames that come back to an old place are searched for there;
    a loop counts only where two others agree with it. The poses fit all steps and loops best, with
    Cauchy weights (Grisetti et al. 2010). Without odometry the last motion is assumed to go
    on, and after a scan that did not match the robot is assumed to stand.

    Parameters
    ----------
    log : Log
        In the order of recording; times do not matter.
    step : float, metres, and turn : float, radians
        A key frame is set where the robot has moved this far from the last one: half a metre, since
        doors and desks hide each other from one pose to the next.
    window : float, metres, and window_angle : float, radians
        Half sides of the search about the guess, at most 20 m and pi; twice this where too little
        lies on the map then.
    drift : float
        Share of the way by which the map may have bent since an old place was left: loops are
        sought within 1 m and this share of the shortest way through the graph, at most 12 m.
    tracking : Tracking, and closing : LoopClosing
        All other thresholds.

    Returns
    -------
    Alignment
        Poses, (k, 3) array, metres and radians, and the graph. A scan without a match carries the
        odometry step; loops tie what follows to the rest again.

    Raises
    ------
    ValueError
        For thresholds that are not positive, or too large.

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
    for scan in log:
        graph.add(scan)
    return graph.settled()


class Placed(NamedTuple):
    """Where a scan lies, and whether it moved the ones before it.

    Parameters
    ----------
    pose : (3,) array, metres and radians
    closed : bool
        Whether loops that it closed moved earlier poses: what was drawn from those is out of date.
    """

    pose: Array
    closed: bool


class LiveGraph:
    """A pose graph that grows scan by scan: what `pose_graph` does, while the robot drives.

    A scan that fails, or whose work is interrupted, is left out: the graph is then as before it.

    Parameters
    ----------
    step, turn, window, window_angle, drift, tracking, closing
        As in `pose_graph`.

    Raises
    ------
    ValueError
        For thresholds that are not positive, or too large.

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

    def __init__(
        self,
        *,
        step: float = 0.5,
        turn: float = np.radians(30),
        window: float = 0.5,
        window_angle: float = np.radians(40),
        drift: float = 0.03,
        tracking: Tracking = Tracking(),
        closing: LoopClosing = LoopClosing(),
    ) -> None:
        self.tracking = arrays.instance(tracking, "tracking", Tracking)
        self.closing = arrays.instance(closing, "closing", LoopClosing)
        arrays.positive("metres", step=step)
        self.window = arrays.number(window, "window", above=0, most=20, unit="metres")
        arrays.positive("radians", turn=turn)
        self.window_angle = arrays.number(
            window_angle, "window_angle", above=0, most=np.pi, unit="radians"
        )
        arrays.positive(drift=drift)
        self.step, self.turn, self.drift, self.seconds = step, turn, drift, 0.0
        self._parts: tuple[FrontEnd, LoopCloser] | None = None

    def add(self, scan: LaserScan) -> Placed:
        """Place the next scan, and close the loops that it finds.

        Parameters
        ----------
        scan : LaserScan

        Returns
        -------
        Placed
            Its pose, and whether loops moved earlier poses.

        Raises
        ------
        ValueError
            For what is no LaserScan.
        """
        arrays.instance(scan, "scan", LaserScan)
        begun, closed = time.perf_counter(), False
        if self._parts is None:
            front = FrontEnd(scan, self._matcher, self.tracking)
            self._parts = front, LoopCloser(front.frames, self.drift, self.closing)
        else:
            front, closer = self._parts
            with _all_or_nothing(front, front.trail, front.frames, closer):
                closed = self._added(scan, front, closer)
        self.seconds += time.perf_counter() - begun
        return Placed(self._parts[0].pose(), closed)

    def _added(self, scan: LaserScan, front: FrontEnd, closer: LoopCloser) -> bool:
        """Place a scan; True where loops moved earlier poses."""
        # 1. The scan on the map of the last key frames
        match = front.track(scan)
        if not front.needs_frame(self.step, self.turn):
            return False
        # 2. A new key frame, and the loops that it closes
        front.add_frame(match)
        closed = closer.close(confirmed=match.matched)
        if closed:
            front.frames.optimize(lazily=True)
        return closed

    def settled(self) -> Outcome:
        """What the method hands to its runner, once all scans are there."""
        if self._parts is None:
            return Outcome(np.zeros((0, 3)), ())
        front, closer = self._parts
        # 3. All poses together, without loops that the others contradict
        front.frames.optimize()
        if closer.settle():
            front.frames.optimize()
        if closer.drop_contradicted():
            front.frames.optimize()
        # 4. Each scan once more, on the map that the loops have straightened
        front.refine()
        return front.outcome(closer.rejected)

    def refine(self) -> Alignment:
        """Solve for all poses together, and lay each scan on the map that the loops straightened.

        Loops that still wait for others that agree are believed or rejected. More scans may follow.

        Returns
        -------
        Alignment
            Of a whole log equal to that of `pose_graph`.
        """
        begun = time.perf_counter()
        found = self.settled()
        self.seconds += time.perf_counter() - begun
        return concluded("pose_graph", len(self), found, self.seconds)

    @property
    def poses(self) -> Array:
        """Poses of all scans, `(k, 3)` array, metres and radians, as the loops so far have them."""
        return np.zeros((0, 3)) if self._parts is None else self._parts[0].poses()

    @property
    def graph(self) -> Graph | None:
        """Edges between key frames, by the scans' indices; None before there is one."""
        return None if self._parts is None else self._parts[0].graph(self._parts[1].rejected)

    def _matcher(self, map: PointMap, points: Array, guess: Array) -> Match:
        return search_and_register(
            map, points, guess, self.window, self.window_angle, self.tracking
        )

    def __len__(self) -> int:
        return 0 if self._parts is None else len(self._parts[0].scans)

    def __repr__(self) -> str:
        if self._parts is None:
            return "LiveGraph(0 scans)"
        front, closer = self._parts
        counts = f"{len(front.frames)} key frames, {len(closer.accepted)} loops"
        return f"LiveGraph({len(self)} scans: {counts})"


@contextmanager
def _all_or_nothing(*parts: object) -> Iterator[None]:
    """Undo what is done to objects whose lists only grow, where it ends before its end."""
    kept = [(part, dict(vars(part))) for part in parts]
    lengths = [(v, len(v)) for _, known in kept for v in known.values() if isinstance(v, list)]
    try:
        yield
    except BaseException:
        for part, known in kept:
            vars(part).update(known)
        for grown, length in lengths:
            del grown[length:]
        raise
