"""The live map of a laser that is carried, and what its bearer has to do."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .alignment import LiveGraph, Tracking
from .matching import LiveMap, Step
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


class CarriedMap(LiveMap):
    """A `LiveMap` with loops, of scans that are bent where `moving`, with its reduced walls.

    Where loops move earlier poses it is made anew of key frames and the last scans: what it holds
    in memory grows with the way, and not with the time. `advice` says what to do with the laser
    now, nothing where all is well.
    """

    def __init__(
        self,
        *,
        moving: bool = True,
        map: QuadtreeMap | None = None,
        start: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        graph = LiveGraph(tracking=Tracking(moving=moving))
        super().__init__(graph, map=map, start=start, walls=LiveReduction())
        self.advice = ""

    @locked
    def add(self, scan: LaserScan) -> Step:
        """Place a scan and insert it; then `advice` is of this scan."""
        step, turn = super().add(scan), 0.0
        if scan.delays is not None and step.motion is not None:
            turn = abs(float(step.motion[2])) * float(scan.delays.max(initial=0.0))
        self.advice = SLOWER if turn > FASTEST_TURN_RAD else "" if step.found else LOST
        if (old := len(self.graph) - 1 - RECENT_SCANS) >= 0:
            self._forget(old)
        return step

    def _forget(self, number: int) -> None:
        """Let go of what a scan has measured: of a key frame what is drawn stays."""
        row = self.graph.tracked(number)
        row.as_measured = None
        if self.graph.front_end.frames.rows[row.frame].scan != number:
            row.scan = LaserScan([], [], row.scan.time)
