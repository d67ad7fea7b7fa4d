"""The live map of a laser that is carried, and what its bearer has to do."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .alignment import LiveGraph, LoopClosing, Tracking
from .arrays import LIMIT, Array
from .matching import LiveMap, Step
from .poses import between
from .quadtree import QuadtreeMap
from .reduction import LiveReduction
from .scans import LaserScan
from .threads import locked

#: What it calls, by `warm`: what is loaded late costs scans.
CASES = (
    *("alignment pose_graph", "quadtree all", "matching all"),
    *("extraction extract_polylines", "reduction hybrid_fusion"),
)
#: The last scans keep their beams, the others where they are key frames.
RECENT_SCANS = 20
#: A scan that turns by more bends beyond what can be carried back, radians.
FASTEST_TURN_RAD = np.radians(45)
SLOWER = "SLOWER: turn the laser by less than an eighth of a turn a scan"
LOST = "LOST: go back to where the map is, and turn slowly"
ORDER = "ORDER: the beams of a scan were measured in the other order than their times say"
#: What turns tell of the order of the beams fades by this factor a scan.
FADING = 0.98
#: Scans tell it that lie so many turns apart: a hand turns otherwise while scans are left out.
TURN_AFTER_TURN = 1.5
#: So much turning tells it, radians^2: ten scans of 5 degrees.
SURE_TURNS_RAD2 = 10 * np.radians(5) ** 2


class CarriedMap(LiveMap):
    """A `LiveMap` with `loops` or none, of scans bent where `moving`, with its reduced walls.

    Where loops move earlier poses it is made anew of key frames and the last scans: what it holds
    in memory grows with the way, and not with the time. `advice` says what to do with the laser
    now, nothing where all is well.
    """

    def __init__(
        self,
        *,
        moving: bool = True,
        loops: bool = True,
        map: QuadtreeMap | None = None,
        start: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        closing = LoopClosing() if loops else LoopClosing(min_path=LIMIT)  # no way is so long
        graph = LiveGraph(tracking=Tracking(moving=moving), closing=closing)
        super().__init__(graph, map=map, start=start, walls=LiveReduction())
        self.advice, self._turns = "", np.zeros(2)
        self._before: tuple[Array, Array, float] | None = None  # pose, motion and time

    @locked
    def add(self, scan: LaserScan) -> Step:
        """Place a scan and insert it; then `advice` is of this scan."""
        step = super().add(scan)
        assert step.motion is not None
        turn_s = 0.0 if scan.delays is None else float(scan.delays.max(initial=0.0))
        too_fast = abs(step.motion[2]) * turn_s > FASTEST_TURN_RAD
        self.advice = SLOWER if too_fast else "" if step.found else LOST
        if self._before is not None and not self.advice:
            pose, motion, time = self._before
            apart = scan.time - time
            if apart < TURN_AFTER_TURN * turn_s:
                turned = between(pose, step.pose)[2]
                within = (motion[2] + step.motion[2]) / 2 * apart
                self._turns = FADING * self._turns + (turned * turned, turned * within)
            if self._turns[0] > SURE_TURNS_RAD2 and self._turns[1] < 0:
                self.advice = ORDER
        self._before = (step.pose, step.motion, scan.time) if step.found else None
        if (old := len(self.graph) - 1 - RECENT_SCANS) >= 0:
            self._forget(old)
        return step

    def _forget(self, number: int) -> None:
        """Let go of what a scan has measured: of a key frame what is drawn stays."""
        row = self.graph.tracked(number)
        row.as_measured = None
        if self.graph.front_end.frames.rows[row.frame].scan != number:
            row.scan = LaserScan([], [], row.scan.time)
