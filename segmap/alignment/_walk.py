"""A run scan by scan: each on the map of the last key frames, and tied to one of them."""

from collections.abc import Callable

import numpy as np

from ..arrays import Array
from ..poses import between, compose
from ..scans import Log
from ._frames import Frames, not_far
from ._point_map import PointMap
from ._result import Graph, Match, Rejected, no_match
from ._runner import Outcome, Trail
from ._solver import deviations, information

#: Key frames of the local map: one holds too little of what the next scan sees.
LOCAL = 10
#: Share of a scan's points that must lie on the map.
OVERLAP = 0.4
#: Without a match the odometry may be off by so much at each step, metres and radians.
WEAK = np.diag([0.5, 0.5, np.radians(20)]) ** 2
#: Around a scan on the finished map: at most so many key frames, within metres.
AROUND, NEAR = 15, 4.0

#: From a map, a scan's points and a guess to the match.
Matcher = Callable[[PointMap, Array, Array], Match]


class Walk:
    """Key frames, and every scan by its pose in the frame of one of them.

    Parameters
    ----------
    log : Log
        At least one scan.
    matcher : callable
        Lays a scan's points `(m, 2)` on a map, near a guess `(3,)`.
    """

    def __init__(self, log: Log, matcher: Matcher) -> None:
        self.trail = Trail(log)
        self.matcher = matcher
        self.points = [not_far(scan.points()) for scan in log]
        self.frames = Frames(self.points[0], self.trail.poses[0])
        self.frame = np.zeros(len(log), np.int64)
        self.offset = np.zeros((len(log), 3))
        self.local = self._local_map()

    def _local_map(self) -> PointMap | None:
        """Points `(m, 2)`, metres, of the last key frames in the frame of the last.

        None where there are none.
        """
        last = len(self.frames) - 1
        return self.frames.map_of(range(max(last - LOCAL + 1, 0), last + 1), last)

    def place(self, scan: int) -> Match:
        """Lay a scan on the local map, or carry it by the expected step.

        The match's pose, (3,) array, metres and radians, is in the frame of the last key frame.
        """
        before = self.offset[scan - 1]
        guess = compose(before, self.trail.step())
        match = self._match(scan, guess)
        self.frame[scan], self.offset[scan] = len(self.frames) - 1, match.pose
        step = between(before, match.pose)
        self.trail.place(compose(self.trail.poses[-1], step), match.reason)
        return match

    def _match(self, scan: int, guess: Array) -> Match:
        """The match of a scan with the local map, from a guess `(3,)`, metres and radians."""
        if self.local is None or len(self.points[scan]) < 6:
            return no_match(guess, "too few points")
        return self.matcher(self.local, self.points[scan], guess)

    def far_from_frame(self, scan: int, step: float, turn: float) -> bool:
        """Whether a scan is far enough from its key frame to become one, or the first has none.

        By more than `step` metres or `turn` radians.
        """
        x, y, heading = self.offset[scan]
        moved = np.hypot(x, y) > step or abs(heading) > turn
        return bool(moved or (self.local is None and len(self.points[scan])))

    def add_frame(self, scan: int, match: Match) -> None:
        """Make a scan the newest key frame, at its match."""
        covariance = match.covariance if match.matched else WEAK
        self.frames.add(scan, self.points[scan], match.pose, information(covariance))
        self.frame[scan], self.offset[scan] = len(self.frames) - 1, 0.0
        self.local = self._local_map()

    def refine(self) -> None:
        """Match each scan between key frames with all that are near, whenever those were."""
        keys = np.array(self.frames.scan)
        between_keys = np.flatnonzero(keys[self.frame] != np.arange(len(self.frame)))
        for frame in np.unique(self.frame[between_keys]):
            map = self.frames.map_of(self.frames.near(frame, AROUND, NEAR), frame)
            for scan in between_keys[self.frame[between_keys] == frame]:
                if map is not None and len(self.points[scan]) >= 6:
                    match = settled(map, self.points[scan], self.offset[scan])
                    self.offset[scan] = match.pose if match.matched else self.offset[scan]

    def outcome(self, rejected: tuple[Rejected, ...] = ()) -> Outcome:
        """Poses of all scans, (k, 3) array, metres and radians, and the graph behind them."""
        poses = compose(self.frames.poses[self.frame], self.offset)
        return Outcome(poses, self.trail.reasons, self._graph(rejected))

    def _graph(self, rejected: tuple[Rejected, ...]) -> Graph | None:
        """Edges between key frames, by the indices of their scans; None where there are none."""
        if not self.frames.ties:
            return None
        edges, scan = self.frames.edges(), np.array(self.frames.scan)
        ends = scan[np.stack([edges.first, edges.second], -1)]
        loop = np.array([tie.loop for tie in self.frames.ties])
        left = deviations(self.frames.poses, edges)
        return Graph(ends, edges.relative, loop, left, rejected, edges.information)


def settled(map: PointMap, points: Array, start: Array, reach: float = 0.3) -> Match:
    """Descend from a start, and say so where too little of the scan lies on the map then.

    Points `(m, 2)`, metres, in the robot's frame; start, (3,) array, metres and radians, in the
    map's; partners are sought within `reach`, metres.
    """
    match = map.settle(points, start, reach=reach)
    if match.matched and match.overlap < OVERLAP:
        return no_match(start, "too little of it lies on the map", match.overlap)
    return match
