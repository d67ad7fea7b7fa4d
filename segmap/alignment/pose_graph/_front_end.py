"""The front end of a pose graph: each scan laid on a map of the last key frames."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses.motions import between, compose
from ...scans import LaserScan
from ...threads import in_threads
from .._result import Match, Outcome, Trail, no_match
from ..graph import Graph, Rejected, deviations, stacked
from ..points import PointMap, in_range
from ._doubt import LOOSE, judged, sentence, spread, untied
from ._key_frames import KeyFrames
from ._settings import Tracking

#: From a map, a scan's points `(m, 2)` and a guess `(3,)` to the match.
Matcher = Callable[[PointMap, Array, Array], Match]


class FrontEnd:
    """Tracks a robot scan by scan: the matcher lays each on the map of the last key frames."""

    def __init__(self, first: LaserScan, matcher: Matcher, rules: Tracking) -> None:
        self.scans, self.points = [first], _seen(first)  # and the points of the last one
        blind = "" if len(self.points) else "too few points"
        self.trail, self.matcher, self.rules = Trail([first], reason=blind), matcher, rules
        self.frames = KeyFrames(self.points, self.trail.poses[0])
        self.frame = [0]  # the key frame of each scan,
        self.offset = [np.zeros(3)]  # and its pose there
        self.loose = [False]  # whether nothing says how far it went along the walls
        self.tied = [True]  # of each key frame: whether a match fixes the step to it
        self.local = self.frames.map_of([0], 0)

    def track(self, scan: LaserScan) -> Match:
        """Lay a scan on the local map, or carry it by the expected step: in the last key frame."""
        points, before = _seen(scan), self.offset[-1]
        self.trail.add(scan)
        guess = compose(before, self._step())
        if self.local is None or len(points) < 6:
            match = no_match(guess, "too few points")
        else:
            match = self.matcher(self.local, points, guess)
            if not match.matched and not self.trail.measured(len(self.trail.poses)):
                match = self._at_any_heading(match, points, before)
        self.scans.append(scan)
        self.points = points
        self.frame.append(len(self.frames) - 1)
        self.offset.append(match.pose)
        self.loose.append(self._is_loose(match))
        reason = LOOSE if self.loose[-1] else match.reason
        self.trail.place(compose(self.trail.poses[-1], between(before, match.pose)), reason)
        return match

    def _at_any_heading(self, match: Match, points: Array, place: Array) -> Match:
        """Without odometry: a scan that did not match, sought near the last place once more."""
        assert self.local is not None
        start, _ = self.local.search(points, place, reach=0.5, turn=np.pi, least=0.5)
        if start is None:
            return match
        found = self.local.register(points, start, overlap=self.rules.least)
        return found if found.matched and found.free is None else match

    def _step(self) -> Array:
        """Expected motion to the last scan; none after a scan that did not match, without odometry.

        A motion that goes on from match to false match grows until it is many metres a scan.
        """
        lost = self.trail.reasons[-1] not in ("", LOOSE)
        stands = lost and not self.trail.measured(len(self.trail.poses))
        return np.zeros(3) if stands else self.trail.step()

    def _is_loose(self, match: Match) -> bool:
        """Whether the walls leave a direction free and no odometry says how far the robot went."""
        if match.free is None or self.local is None or self.trail.measured(len(self.scans) - 1):
            return False
        return not self.local.has_wall_facing(match.free, self.points, match.pose)

    def needs_frame(self, step: float, turn: float) -> bool:
        """Whether the last scan is farther from its key frame, or the first to have points."""
        x, y, heading = self.offset[-1]
        moved = np.hypot(x, y) > step or abs(heading) > turn
        return bool(moved or (self.local is None and len(self.points)))

    def add_frame(self, match: Match) -> None:
        """Make the last scan the newest key frame, at its match."""
        scan = len(self.scans) - 1
        step, turn = self.rules.step_error, self.rules.turn_error
        weak = np.diag([step, step, turn]) ** 2
        covariance = match.covariance if match.matched else weak
        if match.matched and match.free is not None and self.trail.measured(scan):
            along = np.array([*match.free, 0.0]) / self.rules.along_error
            covariance = np.linalg.inv(np.linalg.inv(covariance) + np.outer(along, along))
        self.frames.add(scan, self.points, match.pose, covariance)
        self.tied.append(match.matched and not self.loose[scan])
        last = len(self.frames) - 1
        self.frame[scan], self.offset[scan] = last, np.zeros(3)
        self.see_last_frames()

    def see_last_frames(self) -> None:
        """Make the local map anew, of the last key frames."""
        last = len(self.frames) - 1
        self.local = self.frames.map_of(range(max(last - self.rules.frames + 1, 0), last + 1), last)

    def refine(self) -> None:
        """Lay each scan between key frames on the map of all that are near, whenever those were."""
        keys, own, rules = np.array(self.frames.scan), np.array(self.frame), self.rules
        others = np.flatnonzero(keys[own] != np.arange(len(own)))
        around = self.frames.neighbourhoods(rules.around, rules.near)
        groups = np.split(others, np.flatnonzero(np.diff(own[others])) + 1)
        refined = in_threads(lambda scans: self._refined(scans, around), groups)
        for scans, found in zip(groups, refined, strict=True):
            for scan, offset in zip(scans, found, strict=True):
                self.offset[scan] = offset

    def _refined(
        self, scans: NDArray[np.int64], around: Callable[[int], NDArray[np.int64]]
    ) -> list[Array]:
        """Poses of scans of one key frame in it, by the map of those around it."""
        frame, found = self.frame[scans[0]] if len(scans) else 0, []
        map = self.frames.map_of(around(frame), frame)
        for scan in scans:
            points, offset = _seen(self.scans[scan]), self.offset[scan]
            if map is not None and len(points) >= 6:
                match = map.register(points, offset, overlap=self.rules.overlap)
                offset = match.pose if match.matched else offset
            found.append(offset)
        return found

    def poses(self) -> Array:
        """Poses of all scans so far, `(k, 3)` array, metres and radians."""
        return compose(self.frames.poses[self.frame], np.array(self.offset))

    def pose(self) -> Array:
        """Pose of the last scan, (3,) array, metres and radians."""
        return compose(self.frames.poses[self.frame[-1]], self.offset[-1])

    def graph(self, rejected: Sequence[Rejected] = ()) -> Graph | None:
        """Edges between key frames, by the scans' indices; None before there is one."""
        frames = self.frames
        if not frames.edges:
            return None
        edges = stacked(frames.edges)
        ends = np.array(frames.scan)[np.stack([edges.first, edges.second], -1)]
        left, motion = deviations(frames.poses, edges), edges.relative
        return Graph(ends, motion, edges.loop, left, tuple(rejected), edges.information)

    def outcome(self, rejected: Sequence[Rejected] = ()) -> Outcome:
        """Poses, reasons and standard deviations of all scans, the graph, and what it doubts."""
        graph, frame = self.graph(rejected), np.array(self.frame)
        if graph is None:
            reasons, far = tuple(self.trail.reasons), np.zeros(len(frame))
            return Outcome(self.poses(), reasons, None, sentence(reasons, far, far[:0]), far)
        weight = np.bincount(frame, minlength=len(self.frames)).astype(float)
        far = spread(self.frames.poses, stacked(self.frames.edges), weight)[frame]
        apart = untied(self.tied, self.frames.edges, weight)[frame]
        reasons = judged(self.trail.reasons, apart)
        left = graph.residuals[graph.loop]
        doubt = sentence(reasons, far, left, converged=self.frames.converged)
        return Outcome(self.poses(), reasons, graph, doubt, far)


def _seen(scan: LaserScan) -> Array:
    """Points of a scan, `(m, 2)`, metres, that a laser can have seen."""
    points = scan.points()
    return points[in_range(points)]


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
