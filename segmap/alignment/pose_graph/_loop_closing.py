"""Loop closing: old places proposed, measured, and believed only where several loops agree."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses.motions import between, compose
from ...threads import in_threads
from ..graph import Edge, Rejected, deviations, information, residuals, stacked
from ..points import PointMap
from ._settings import LoopClosing
from ._ways import Ways

if TYPE_CHECKING:
    from ._key_frames import KeyFrames

#: What a place looks like from any heading: shares of the points in rings up to this radius,
#: metres, as three key frames before and after it see them.
RINGS, RADIUS, VIEW = 16, 8.0, 3
#: Key frames that follow each other by less than this are one pass; so many passes are searched.
GAP, PASSES = 3, 3
#: So many points of the new place are registered: more do not make it surer.
SAMPLE = 750
#: Accepted loops that a new one is compared with: older ones lie farther back than `stretch`.
RECENT = 30
#: Why a loop is not believed that no other, or too few, agree with.
ALONE = "no other loop agrees with it"
#: Half sides of windows that the neighbours of an old key frame cover, metres.
COVERED = 2.5
#: Maps of old places that are kept ready, for memory's sake.
KEPT = 40


class Window(NamedTuple):
    """Where to look for a loop: around a pose `(3,)` in the frame of `old`, metres and radians."""

    old: int
    guess: Array
    reach: float
    turn: float


class LoopCloser:
    """Finds loops as key frames come in, and says which it does not believe.

    Parameters
    ----------
    frames : KeyFrames
        Accepted loops become edges of these.
    drift : float
        Share of the path by which the map may have bent.
    rules : LoopClosing
    """

    def __init__(self, frames: KeyFrames, drift: float, rules: LoopClosing) -> None:
        self.frames, self.drift, self.rules = frames, drift, rules
        self.descriptors = [descriptor(frames.points[0])]
        self.lost_since: int | None = None
        self.pending: list[Edge] = []
        self.accepted: list[Edge] = []
        self.rejected: list[Rejected] = []
        self.maps: dict[tuple[int, int, int], PointMap | None] = {}
        self.ways: list[tuple[int, int]] = []
        self.shortest = Ways(rules.loop_path)

    def close(self, *, confirmed: bool) -> bool:
        """Look for loops of the newest key frame; True where accepted ones strain the map.

        `confirmed` says whether a match tied it to the one before: else the robot may be anywhere.
        """
        new = len(self.frames) - 1
        view, _ = self.frames.points_around(self._neighbours(new, VIEW), new)
        self.descriptors.append(descriptor(view))
        return self.seek(new, new, confirmed=confirmed)

    def seek(self, new: int, before: int, *, confirmed: bool) -> bool:
        """Look for loops of a key frame to those before another, as `close` does."""
        self.lost_since = self.lost_since if confirmed else new
        fresh: list[tuple[Edge, float]] = []
        windows = self._by_place(new, before) + self._by_descriptor(new, before)
        tasks = [(window, self._map_around(window), new) for window in windows]
        measured = in_threads(lambda task: self._measure(*task), tasks)
        for window, loop in zip(windows, measured, strict=True):
            if isinstance(loop, Edge):
                fresh.append((loop, window.reach))
            else:
                self._reject(window.old, new, loop)
        self.pending += [loop for loop, _ in fresh]
        found = self._confirmed_by_others(fresh)
        self._believe(found)
        self.lost_since = None if found else self.lost_since
        self._give_up(new)
        return any(self._strains(loop) for loop in found)

    def _by_place(self, new: int, before: int) -> list[Window]:
        """Around the nearest old key frame of each pass, as far as the map may have drifted."""
        rules, poses = self.rules, self.frames.poses
        path = self.frames.along[new] - self.frames.along[:before]
        distance = np.hypot(*(poses[:before, :2] - poses[new, :2]).T)
        reach = self._reach(path)
        near = np.flatnonzero((distance < reach + rules.beside) & (path > rules.min_path))
        reach[near] = np.minimum(reach[near], self._reach(self._way(new, near)))
        near = near[distance[near] < reach[near] + rules.beside]
        return [
            Window(k, between(poses[k], poses[new]), float(reach[k]), rules.turn)
            for k in _best_of_passes(near, distance)
        ]

    def _reach(self, way: Array) -> Array:
        """How far the map may have bent along ways `(m,)`, metres."""
        return np.minimum(self.rules.reach + self.drift * way, self.rules.max_reach)

    def _way(self, new: int, old: NDArray[np.int64]) -> Array:
        """Shortest way through the graph from older key frames to a new one, metres.

        Infinite where it is so long that the widest window is searched.
        """
        most = (self.rules.max_reach - self.rules.reach) / self.drift
        return self.shortest.between(new, old, self.frames.path, self.ways, max(most, 0.0))

    def _by_descriptor(self, new: int, before: int) -> list[Window]:
        """Where the robot is lost: on what looks most like the place, at any heading."""
        lost, path = self.lost_since, self.frames.path
        if lost is None or path[new] - path[lost] > self.rules.lost_path:
            return []
        descriptors, old = np.array(self.descriptors), min(lost, before)
        unlike = np.abs(descriptors[:old] - descriptors[new]).sum(1)
        best = _best_of_passes(np.arange(old), unlike)
        return [Window(k, np.zeros(3), self.rules.lost_reach, np.pi) for k in best]

    def _measure(self, window: Window, map: PointMap | None, new: int) -> Edge | str:
        """The loop between two key frames by their surroundings, or why there is none."""
        frames, rules = self.frames, self.rules
        first = max(new - rules.new_frames, self.lost_since or 0)
        seen, _ = frames.points_around(range(first, new + 1), new)
        if map is None or len(seen) < 6:
            return "too few points"
        seen = seen[:: 1 + len(seen) // SAMPLE]
        start, _ = map.search(
            seen,
            window.guess,
            reach=window.reach,
            turn=window.turn,
            reach_cost=0.05,
            least=rules.likelihood,
        )
        if start is None:
            return "the two places look different"
        if map.register(seen, start, reach=0.2).overlap < rules.overlap:
            return "too little of the new place is in the old one"
        match = map.register(frames.points[new], start, reach=0.2)
        if not match.matched:
            return match.reason
        return Edge(window.old, new, match.pose, information(match.covariance), True)

    def _map_around(self, window: Window) -> PointMap | None:
        """The surroundings of an old key frame, in its frame, as far as the window; some are kept.

        On a map that ends before the window does, the best place is not the true one.
        """
        path, near = self.frames.along, self._neighbours(window.old, self.rules.old_frames)
        far = window.reach if window.reach > COVERED else 0.0
        place = path[window.old]
        first, end = np.searchsorted(path, [place - far, place + far + 1e-9])
        around = window.old, int(min(first, near.start)), int(max(end, near.stop))
        if around not in self.maps:
            if len(self.maps) >= KEPT:
                del self.maps[next(iter(self.maps))]
            self.maps[around] = self.frames.map_of(range(*around[1:]), window.old)
        return self.maps[around]

    def _neighbours(self, frame: int, half: int) -> range:
        """A key frame and up to `half` before and after it, in time."""
        return range(max(frame - half, 0), min(frame + half + 1, len(self.frames)))

    def _strains(self, loop: Edge) -> bool:
        """Whether the poses leave a loop open so far that the graph has to be solved at once."""
        x, y, heading = residuals(self.frames.poses, loop)
        far = np.hypot(x, y) > self.rules.strain
        return bool(far or abs(heading) > self.rules.strain_angle)

    def _confirmed_by_others(self, fresh: list[tuple[Edge, float]]) -> list[Edge]:
        """Loops of the newest key frame that enough others agree with, and these others."""
        found: list[Edge] = []
        lost, rules = self.lost_since is not None, self.rules
        enough = rules.lost_witnesses if lost else rules.witnesses
        known = self.pending + self.accepted[-RECENT:]
        for loop, reach in fresh:
            others = self._agreeing(loop, known)
            way = [self.frames.path[k] for k in {loop.second, *(o.second for o in others)}]
            long = lost or max(way) - min(way) >= min(reach, rules.span)
            if len(way) > enough and long:
                found += _without([loop, *others], found + self.accepted[-RECENT:])
        return found

    def _agreeing(self, loop: Edge, known: list[Edge], *, apart: bool = False) -> list[Edge]:
        """Loops for which going round them and this one leads back to where it began.

        `apart`: those of the same scan, to passes far apart.
        """
        chosen = [other for other in known if self._comparable(loop, other, apart)]
        if not chosen:
            return []
        a, b, poses, rules = loop, stacked(chosen), self.frames.poses, self.rules
        one = compose(a.relative, between(poses[a.second], poses[b.second]))
        other = compose(between(poses[a.first], poses[b.first]), b.relative)
        x, y, heading = between(one, other).T
        same = (np.hypot(x, y) < rules.tolerance) & (np.abs(heading) < rules.angle)
        return [chosen[i] for i in np.flatnonzero(same)]

    def _comparable(self, a: Edge, b: Edge, apart: bool) -> bool:
        """Whether two loops of different scans are near at both ends, or, `apart`, the contrary."""
        path, stretch = self.frames.path, self.rules.stretch
        far = abs(path[a.first] - path[b.first]) > stretch
        if apart or far:
            return apart and far and a.second == b.second
        return a.second != b.second and abs(path[a.second] - path[b.second]) <= stretch

    def settle(self) -> bool:
        """At the end of the log: believe loops that a few others agree with, reject the rest."""
        known, enough = [*self.pending, *self.accepted[-RECENT:]], self.rules.last_witnesses
        found = []
        for loop in self.pending if self.lost_since is None else []:
            others = self._agreeing(loop, known) + self._agreeing(loop, known, apart=True)
            found += [loop] if len(others) >= enough else []
        for loop in _without(self.pending, found):
            self._reject(loop.first, loop.second, ALONE)
        self.pending = []
        self._believe(found)
        return bool(found)

    def _believe(self, loops: list[Edge]) -> None:
        """Make loops edges of the graph, and ways through it where they fix the place."""
        self.pending = _without(self.pending, loops)
        self.accepted += loops
        self.frames.edges += loops
        self.ways += [e[:2] for e in loops if _spread(e) < self.rules.vague]

    def _give_up(self, new: int) -> None:
        """Reject loops that no other has confirmed in time."""
        path = self.frames.path
        late = [e for e in self.pending if path[new] - path[e.second] > self.rules.stretch]
        for loop in late:
            self._reject(loop.first, loop.second, ALONE)
        self.pending = _without(self.pending, late)

    def drop_contradicted(self) -> bool:
        """Take out loops that the solution leaves far open; True where there were any."""
        frames = self.frames
        if not self.accepted:
            return False
        left = deviations(frames.poses, stacked(frames.edges))
        open_by = zip(frames.edges, left, strict=True)
        out = [e for e, d in open_by if e.loop and d > self.rules.contradicted]
        for loop in out:
            self._reject(loop.first, loop.second, "the rest of the graph contradicts it")
        frames.edges = _without(frames.edges, out)
        return bool(out)

    def _reject(self, old: int, new: int, reason: str) -> None:
        """Keep the reason, under the indices of the scans."""
        self.rejected.append(Rejected(self.frames.scan[old], self.frames.scan[new], reason))


def descriptor(points: Array) -> Array:
    """Shares of points `(m, 2)`, metres, by their distance from the origin, (16,) array."""
    distance = np.hypot(points[:, 0], points[:, 1])
    counts = np.histogram(distance, bins=RINGS, range=(0.0, RADIUS))[0]
    return np.asarray(counts / max(counts.sum(), 1))


def _best_of_passes(members: NDArray[np.int64], cost: Array) -> list[int]:
    """The cheapest of each run of neighbouring key frames, at most three, cheapest first."""
    passes = np.split(members, np.flatnonzero(np.diff(members) > GAP) + 1)
    best = [int(run[np.argmin(cost[run])]) for run in passes if len(run)]
    return sorted(best, key=lambda k: float(cost[k]))[:PASSES]


def _without(edges: list[Edge], gone: list[Edge]) -> list[Edge]:
    """The edges but for those gone: the same objects, not equal ones."""
    known = {id(edge) for edge in gone}
    return [edge for edge in edges if id(edge) not in known]


def _spread(loop: Edge) -> float:
    """Largest standard deviation of a loop's shift, metres."""
    covariance = np.linalg.inv(loop.information)[:2, :2]
    return float(np.sqrt(np.linalg.eigvalsh(covariance)[-1]))
