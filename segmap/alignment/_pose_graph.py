"""Pose graph: each scan on a map of the last key frames, loops closed, all poses solved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array
from ..poses import between, compose, transform
from ..scans import Log
from ._graph import Edge, Graph, Rejected, deviations, information, solve, stacked
from ._graph_settings import LoopClosing, Tracking
from ._loop_closing import LoopCloser
from ._point_map import PointMap, in_range
from ._result import Match, Outcome, Trail, alignment_method, no_match

Members = Sequence[int] | NDArray[np.int64]
#: From a map, a scan's points `(m, 2)` and a guess `(3,)` to the match.
Matcher = Callable[[PointMap, Array, Array], Match]


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
    Cauchy weights (Grisetti et al. 2010). Without odometry the last motion is assumed to go on.

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
    arrays.instance(tracking, "tracking", Tracking)
    arrays.instance(closing, "closing", LoopClosing)
    arrays.positive("metres", step=step)
    arrays.number(window, "window", above=0, most=20, unit="metres")
    arrays.positive("radians", turn=turn)
    arrays.number(window_angle, "window_angle", above=0, most=np.pi, unit="radians")
    arrays.positive(drift=drift)
    if len(log) == 0:
        return Trail(log).outcome()

    def matcher(map: PointMap, points: Array, guess: Array) -> Match:
        return search_and_register(map, points, guess, window, window_angle, tracking)

    front = FrontEnd(log, matcher, tracking)
    closer = LoopCloser(front.frames, drift, closing)
    for scan in range(1, len(log)):
        # 1. The scan on the map of the last key frames
        match = front.track(scan)
        if front.needs_frame(scan, step, turn):
            # 2. A new key frame, and the loops that it closes
            front.add_frame(scan, match)
            if closer.close(confirmed=match.matched):
                front.frames.optimize()
    # 3. All poses together, without loops that the others contradict
    front.frames.optimize()
    if closer.settle():
        front.frames.optimize()
    if closer.drop_contradicted():
        front.frames.optimize()
    # 4. Each scan once more, on the map that the loops have straightened
    front.refine()
    return front.outcome(tuple(closer.rejected))


def search_and_register(
    map: PointMap, points: Array, guess: Array, window: float, angle: float, rules: Tracking
) -> Match:
    """Search about a guess and descend from there; in twice the window where little fits.

    Along a direction that no wall faces the match keeps what the guess says.
    """
    best = no_match(guess, "nothing like it near")
    for factor in (1.0, 2.0):
        match = best
        start, _ = map.search(points, guess, reach=factor * window, turn=factor * angle)
        if start is not None:
            match = map.register(points, start, overlap=rules.overlap)
            x, y, heading = between(start, match.pose)
            if np.hypot(x, y) > rules.slide or abs(heading) > rules.slide_angle:
                match = no_match(start, "it slides over the map", match.overlap)
        if match.overlap > (
            0.0 if factor == 1.0 else max(best.overlap + rules.better, rules.least)
        ):
            best = match
        if best.matched and best.overlap > rules.sure:
            break
    if not best.matched:
        return no_match(guess, best.reason, best.overlap)
    if best.free is None or map.has_wall_facing(best.free, points, best.pose):
        return best
    along = best.free @ (guess[:2] - best.pose[:2]) * best.free
    return replace(best, pose=best.pose + (*along, 0.0))


class KeyFrames:
    """The scans that stand for the map, half a metre apart, with poses that loops still move.

    Attributes
    ----------
    scan : list of int
        Index in the log of each key frame.
    points : list of (m, 2) arrays, metres, in the frame of the robot
    poses : (n, 3) array, metres and radians
    path : list of float, metres
        Path length from the start to each.
    edges : list of Edge
    """

    def __init__(self, points: Array, pose: Array) -> None:
        self.scan = [0]
        self.points = [points]
        self.poses = np.array([pose])
        self.path = [0.0]
        self.edges: list[Edge] = []

    def __len__(self) -> int:
        return len(self.scan)

    def add(self, scan: int, points: Array, relative: Array, covariance: Array) -> None:
        """Append a key frame at its motion `(3,)` from the last one, with an edge between them."""
        new = len(self)
        self.edges.append(Edge(new - 1, new, relative, information(covariance)))
        self.scan.append(scan)
        self.points.append(points)
        self.poses = np.vstack([self.poses, compose(self.poses[-1], relative)])
        self.path.append(self.path[-1] + float(np.hypot(relative[0], relative[1])))

    def optimize(self) -> None:
        """Move the poses to where all edges fit best."""
        if self.edges:
            self.poses = solve(self.poses, stacked(self.edges))

    def points_around(self, members: Members, origin: int) -> tuple[Array, Array]:
        """Points of some key frames, and where each was seen from: `(m, 2)` arrays, metres.

        In the frame of the key frame `origin`.
        """
        clouds = [self.points[k] for k in members]
        poses = between(self.poses[origin], self.poses[members])
        poses = np.repeat(poses, [len(cloud) for cloud in clouds], axis=0)
        points = transform(poses, np.concatenate(clouds)[:, None])[:, 0]
        near = in_range(points)
        return points[near], poses[near, :2]

    def map_of(self, members: Members, origin: int) -> PointMap | None:
        """The map of some key frames in the frame of `origin`; None where they have no point."""
        points, viewpoints = self.points_around(members, origin)
        return PointMap(points, viewpoints) if len(points) else None


class FrontEnd:
    """Tracks a robot scan by scan: the matcher lays each on the map of the last key frames."""

    def __init__(self, log: Log, matcher: Matcher, rules: Tracking) -> None:
        self.trail, self.matcher, self.rules = Trail(log), matcher, rules
        self.points = [points[in_range(points)] for points in (scan.points() for scan in log)]
        self.frames = KeyFrames(self.points[0], self.trail.poses[0])
        self.frame = np.zeros(len(log), np.int64)  # the key frame of each scan,
        self.offset = np.zeros((len(log), 3))  # and its pose there
        self.local = self.frames.map_of([0], 0)

    def track(self, scan: int) -> Match:
        """Lay a scan on the local map, or carry it by the expected step: in the last key frame."""
        before = self.offset[scan - 1]
        guess = compose(before, self.trail.step())
        if self.local is None or len(self.points[scan]) < 6:
            match = no_match(guess, "too few points")
        else:
            match = self.matcher(self.local, self.points[scan], guess)
        self.frame[scan], self.offset[scan] = len(self.frames) - 1, match.pose
        self.trail.place(compose(self.trail.poses[-1], between(before, match.pose)), match.reason)
        return match

    def needs_frame(self, scan: int, step: float, turn: float) -> bool:
        """Whether a scan is farther from its key frame than that, or the first to have points."""
        x, y, heading = self.offset[scan]
        moved = np.hypot(x, y) > step or abs(heading) > turn
        return bool(moved or (self.local is None and len(self.points[scan])))

    def add_frame(self, scan: int, match: Match) -> None:
        """Make a scan the newest key frame, at its match."""
        step, turn = self.rules.step_error, self.rules.turn_error
        weak = np.diag([step, step, turn]) ** 2
        covariance = match.covariance if match.matched else weak
        if match.matched and match.free is not None and self.trail.measured(scan):
            along = np.array([*match.free, 0.0]) / self.rules.along_error
            covariance = np.linalg.inv(np.linalg.inv(covariance) + np.outer(along, along))
        self.frames.add(scan, self.points[scan], match.pose, covariance)
        last = len(self.frames) - 1
        self.frame[scan], self.offset[scan] = last, 0.0
        self.local = self.frames.map_of(range(max(last - self.rules.frames + 1, 0), last + 1), last)

    def refine(self) -> None:
        """Lay each scan between key frames on the map of all that are near, whenever those were."""
        keys, places, rules = np.array(self.frames.scan), self.frames.poses[:, :2], self.rules
        others = np.flatnonzero(keys[self.frame] != np.arange(len(self.frame)))
        for frame in np.unique(self.frame[others]):
            far = np.hypot(*(places - places[frame]).T)
            nearest = np.argsort(far, kind="stable")[: rules.around]
            map = self.frames.map_of(nearest[far[nearest] <= rules.near], frame)
            for scan in others[self.frame[others] == frame]:
                if map is not None and len(self.points[scan]) >= 6:
                    start = self.offset[scan]
                    match = map.register(self.points[scan], start, overlap=rules.overlap)
                    self.offset[scan] = match.pose if match.matched else start

    def outcome(self, rejected: tuple[Rejected, ...] = ()) -> Outcome:
        """Poses of all scans, and the graph: edges between key frames, by the scans' indices."""
        frames, graph = self.frames, None
        poses = compose(frames.poses[self.frame], self.offset)
        if frames.edges:
            edges = stacked(frames.edges)
            ends = np.array(frames.scan)[np.stack([edges.first, edges.second], -1)]
            left = deviations(frames.poses, edges)
            graph = Graph(ends, edges.relative, edges.loop, left, rejected, edges.information)
        return Outcome(poses, self.trail.reasons, graph)
