"""Loop closing: places proposed by descriptor, measured, rejected unless several loops agree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Count, Metres, Positive, Settings
from ...poses.motions import between, compose
from ...scans.causes import Unmatched
from .._result import Match, no_match
from ..graph import Edge, Rejected, deviations, information, residuals, stack
from ..points import LEAST_POINTS, PointMap
from ._key_frames import (
    VAGUE_M,
    KeyFrames,
    Undoable,
    edges_but,
    key_frames_in_square,
    path_lengths,
    select_firm,
    ways_of,
)
from ._places import OVERLAP_GAIN, best_of_passes, descriptor

# Where loops are sought:
#: Old places are proposed this much farther off than the window: they can be seen from there.
BEYOND_WINDOW_M = 2.0
#: Half side of the window in heading.
WINDOW_HALF_RAD = np.radians(20)
#: What a place looks like is told by so many key frames before and after it.
DESCRIPTOR_FRAMES = 3
#: After a step that no match confirms the robot may be anywhere. The places that look most alike
#: are then searched in a window of this half side, metres, at every heading.
LOST_WINDOW_M = 2.0
#: A lost robot is sought only while its path since then is at most this long, metres.
LOST_PATH_M = 15.0
#: Half sides of windows that the neighbours of an old key frame cover, metres. In larger ones the
#: old map is made of those along as long a way: else the true place may lie where it has ended.
COVERED_WINDOW_M = 2.5
#: Maps of old places that are kept ready, for memory's sake.
KEPT = 40
# Which loops are believed:
#: Two loops agree where going round both leaves less than this turn, radians.
AGREED_ANGLE = np.radians(4)
#: Loops are compared only where their ends lie within this path of each other, metres: beyond it
#: the error of the path itself would count.
COMPARED_PATH_M = 8.0
#: Accepted loops that a new one is compared with: older ones lie farther back than
#: `COMPARED_PATH_M`.
COMPARED_LOOPS = 30
#: Other loops that must agree where the robot may be anywhere, since many rooms are built alike.
LOST_WITNESSES = 5
#: Other loops that must agree when the log ends. Then loops of one scan to passes farther apart
#: than `COMPARED_PATH_M` count too.
LAST_WITNESSES = 1
#: The graph is solved at once where a new loop turns its ends by more than this, radians.
STRAIN_ANGLE = np.radians(0.5)
#: Loops that the solution leaves open by more standard deviations are taken out at the end.
CONTRADICTED = 15.0
#: Why a loop is not believed that no other, or too few, agree with.
UNSUPPORTED_LOOP = "no other loop agrees with it"
#: Why a loop is not believed that the solved graph contradicts.
CONTRADICTED_LOOP = "the rest of the graph contradicts it"
#: Why a loop is not believed that the caller left out.
VETOED_LOOP = "it was vetoed"


@dataclass(frozen=True)
class LoopClosing(Settings):
    """How loops are sought, and which of them are believed.

    Parameters
    ----------
    min_path
        A loop is sought where the path since the old place is at least this long: before that the
        place is still on the local map.
    reach, max_reach
        Half side of the search window about an old place, to which the share `drift` of the way is
        added up to the maximum: the shortest way through the graph, for what earlier loops have
        fixed cannot be far off. Larger where the map bends more, smaller where rooms look alike.
    old_frames, new_frames
        Key frames before and after the old one, and before the new one, whose points are compared:
        a single scan looks like many places. Fewer with a sensor that looks all around.
    likelihood, overlap
        Mean likelihood, and share of the points with a partner, that a measured loop must reach.
    tolerance
        Two loops agree where going round both leaves less than this.
    witnesses
        Number of other loops that must agree.
    span
        A loop and its witnesses must lie along so long a path, or along one as long as the window's
        half side where that is less: what one door looks like, the next one does too.
    strain
        The graph is solved at once where a new loop moves its ends by more than this: less for a
        live map that is always straight, more to save time.

    Examples
    --------
    >>> LoopClosing(witnesses=0)
    Traceback (most recent call last):
    ValueError: witnesses must be a whole number of at least 1, got 0
    """

    min_path: Metres = 10.0
    reach: Metres = 1.0
    max_reach: Metres = 12.0
    old_frames: Count = 5
    new_frames: Count = 3
    likelihood: Positive = 0.55
    overlap: Positive = 0.6
    tolerance: Metres = 0.25
    witnesses: Count = 2
    span: Metres = 6.0
    strain: Metres = 0.05


class Window(NamedTuple):
    """Where to look for a loop: around a pose `(3,)` in the frame of `old`, metres and radians."""

    old: int
    guess: Array
    reach: float
    turn: float


class LoopCloser(Undoable):
    """Finds loops as key frames come in, and says which it does not believe.

    Accepted loops become edges of the frames. `drift` is the share of the path by which the map may
    have bent.
    """

    def __init__(self, frames: KeyFrames, drift: float, rules: LoopClosing) -> None:
        self.frames, self.drift, self.rules = frames, drift, rules
        self.descriptors: list[Array] = []
        self.lost_since: int | None = None
        self.last_sure: int | None = None  # the key frame before it was lost
        self.pending: list[Edge] = []
        self.accepted: list[Edge] = []
        self.rejected: list[Rejected] = []
        self.maps: dict[tuple[int, int, int], PointMap | None] = {}
        self.ways = ways_of([])

    def close(self, *, confirmed: bool) -> bool:
        """Look for loops of the newest key frame; True where accepted ones strain the map.

        `confirmed` says whether a match tied it to the one before: else the robot may be anywhere.
        """
        new = len(self.frames) - 1
        view, _ = self.frames.points_around(self._neighbours(new, DESCRIPTOR_FRAMES), new)
        self.descriptors.append(descriptor(view))
        return self.seek(new, new, confirmed=confirmed)

    def seek(self, new: int, before: int, *, confirmed: bool) -> bool:
        """Look for loops of a key frame to those before another, as `close` does."""
        if not confirmed:
            self.last_sure = new - 1 if self.lost_since is None else self.last_sure
            self.lost_since = new
        # 1. Old places that may be the new one
        windows = self._by_place(new, before) + self._by_descriptor(new, before)
        windows += (ahead := self._by_last_place(new))
        # 2. How the new place lies on each
        matches = [self.measure(window, self.map_around(window), new) for window in windows]
        fresh: list[tuple[Edge, float]] = []
        if self.lost_since is not None:
            matches = self._one_place(windows, matches)
        for window, match in zip(windows, matches, strict=True):
            if match.matched:
                free = match.free if self.frames.rows[new].measured else None
                weight = information(match.covariance, self.frames.least, free)
                fresh.append((Edge(window.old, new, match.pose, weight, True), window.reach))
            else:
                self._reject(window.old, new, match.reason)
        # 3. Loops that others confirm are believed; those that wait too long are given up
        self.pending += [loop for loop, _ in fresh]
        loops = self._confirm_by_others(fresh)
        if ahead and ahead[0].turn < np.pi:  # odometry over the gap is a witness
            loops += edges_but([e for e, _ in fresh if e.first == ahead[0].old], loops)
        self.believe(loops)
        if loops:
            self.lost_since = self.last_sure = None
        path = self.frames.distance
        self._give_up([e for e in self.pending if path[new] - path[e.second] > COMPARED_PATH_M])
        # 4. Whether the poses leave one open so far that the graph has to be solved at once
        gaps = [residuals(self.frames.poses, loop) for loop in loops]
        return any(
            np.hypot(x, y) > self.rules.strain or abs(turn) > STRAIN_ANGLE for x, y, turn in gaps
        )

    def _by_place(self, new: int, before: int) -> list[Window]:
        """Around the nearest old key frame of each pass, as far as the map may have drifted."""
        poses, along = self.frames.poses, self.frames.distance
        widest = self.rules.max_reach + BEYOND_WINDOW_M
        near = np.empty(before, np.int64)
        near = near[: key_frames_in_square(poses, new, widest, near)]
        path, distance = along[new] - along[near], np.hypot(*(poses[near] - poses[new])[:, :2].T)
        far = (distance >= self._reach(path) + BEYOND_WINDOW_M) | (path <= self.rules.min_path)
        near, path, distance = near[~far], path[~far], distance[~far]
        if not len(near):
            return []
        reach = self._reach(np.minimum(path, self._path_m(new, near)))
        close = distance < reach + BEYOND_WINDOW_M
        reaches = dict(zip(near[close].tolist(), reach[close].tolist(), strict=True))
        best = best_of_passes(near[close], distance[close])
        return [Window(k, between(poses[k], poses[new]), reaches[k], WINDOW_HALF_RAD) for k in best]

    def _reach(self, way: Array) -> Array:
        """How far the map may have bent along ways `(m,)`, metres."""
        return np.minimum(self.rules.reach + self.drift * way, self.rules.max_reach)

    def _path_m(self, new: int, old: NDArray[np.int64]) -> Array:
        """Metres from older key frames to a new one through the graph.

        Infinite where it is so long that the widest window is searched.
        """
        most = max((self.rules.max_reach - self.rules.reach) / self.drift, 0.0)
        metres = np.full(len(self.frames), np.inf)
        path_lengths(self.frames.distance, self.ways, new, old, most, metres)
        return metres[old]

    def _by_descriptor(self, new: int, before: int) -> list[Window]:
        """Where the robot is lost: on what looks most like the place, at any heading."""
        lost, path = self.lost_since, self.frames.distance
        if lost is None or path[new] - path[lost] > LOST_PATH_M:
            return []
        # What lies nearer is seen from the last place: two rooms on a door look alike when turned
        far = int(np.searchsorted(path, path[new] - self.rules.min_path))
        descriptors, old = np.array(self.descriptors), min(lost, before, far)
        unlike = np.abs(descriptors[:old] - descriptors[new]).sum(1)
        best = best_of_passes(np.arange(old), unlike)
        return [Window(k, np.zeros(3), LOST_WINDOW_M, np.pi) for k in best]

    def _by_last_place(self, new: int) -> list[Window]:
        """Where the robot is lost: about the last place that was sure, as its motion goes on."""
        sure, path = self.last_sure, self.frames.distance
        if sure is None or path[new] - path[sure] > LOST_PATH_M:
            return []
        old = max(sure - self.rules.old_frames, 0)  # all around it was seen before the gap
        guess = between(self.frames.poses[old], self.frames.poses[new])
        if all(row.measured for row in self.frames.rows[sure + 1 : new + 1]):
            return [Window(old, guess, self.rules.reach, WINDOW_HALF_RAD)]
        return [Window(old, guess, LOST_WINDOW_M, np.pi)]

    def _one_place(self, windows: list[Window], matches: list[Match]) -> list[Match]:
        """Matches of a robot that may be anywhere: the best, none if another place is as good."""
        most = max((match.overlap for match in matches if match.matched), default=0.0)
        alike = [match.matched and match.overlap > most - OVERLAP_GAIN for match in matches]
        places = [
            compose(self.frames.poses[window.old], match.pose)
            for window, match, best in zip(windows, matches, alike, strict=True)
            if best
        ]
        away = between(places[0], np.array(places)) if places else np.zeros((0, 3))
        apart = (np.hypot(*away[:, :2].T) > LOST_WINDOW_M) | (np.abs(away[:, 2]) > WINDOW_HALF_RAD)
        return [
            match if best and not apart.any() else no_match(match.pose, Unmatched.OTHER_PLACE)
            for match, best in zip(matches, alike, strict=True)
        ]

    def measure(self, window: Window, map: PointMap | None, new: int) -> Match:
        """How a key frame lies on an old one by their surroundings, or why that is not told."""
        frames, rules = self.frames, self.rules
        lost = self.lost_since or 0
        first = max(new - rules.new_frames, lost if lost <= new else 0)
        seen, _ = frames.points_around(range(first, new + 1), new, thin=True)
        if map is None or len(seen) < LEAST_POINTS:
            return no_match(window.guess, Unmatched.TOO_LITTLE_SEEN)
        place = {"reach": window.reach, "turn": window.turn, "least": rules.likelihood}
        start, _ = map.search(seen, window.guess, reach_cost=0.05, **place)
        if start is None:
            return no_match(window.guess, Unmatched.NO_PLACE, "the two places look different")
        if (overlap := map.register(seen, start, reach=0.2).overlap) < rules.overlap:
            words = "too little of the new place is in the old one"
            return no_match(start, Unmatched.LITTLE_OVERLAP, words, overlap)
        return map.register(frames.rows[new].points, start, reach=0.2)

    def map_around(self, window: Window) -> PointMap | None:
        """The surroundings of an old key frame, in its frame, as far as the window; some are kept.

        On a map that ends before the window does, the best place is not the true one.
        """
        path, near = self.frames.distance, self._neighbours(window.old, self.rules.old_frames)
        far = window.reach if window.reach > COVERED_WINDOW_M else 0.0
        place = path[window.old]
        first, end = np.searchsorted(path, [place - far, place + far + 1e-9])
        first, end = int(min(first, near.start)), int(max(end, near.stop))
        if self.lost_since is not None and window.old < self.lost_since:
            end = min(end, self.lost_since)  # what was seen since then lies anywhere
        around = window.old, first, end
        if around not in self.maps:
            if len(self.maps) >= KEPT:
                del self.maps[next(iter(self.maps))]
            self.maps[around] = self.frames.map_of(range(*around[1:]), window.old)
        return self.maps[around]

    def _neighbours(self, frame: int, half: int) -> range:
        """A key frame and up to `half` before and after it, in time."""
        return range(max(frame - half, 0), min(frame + half + 1, len(self.frames)))

    def _confirm_by_others(self, fresh: list[tuple[Edge, float]]) -> list[Edge]:
        """Loops of the newest key frame that enough others agree with, and these others."""
        loops: list[Edge] = []
        lost = self.lost_since is not None
        enough = LOST_WITNESSES if lost else self.rules.witnesses
        candidates = self.pending + self.accepted[-COMPARED_LOOPS:]
        for loop, reach in fresh:
            others = self.partners(loop, candidates)
            agree = self._witnesses([loop, *others])
            way = [self.frames.distance[k] for k in {each.second for each in agree}]
            if len(way) > enough and (lost or max(way) - min(way) >= min(reach, self.rules.span)):
                loops += edges_but([loop, *others], loops + self.accepted[-COMPARED_LOOPS:])
        return loops

    def _witnesses(self, loops: list[Edge]) -> list[Edge]:
        """Those that may confirm others: without odometry what slides along a corridor may not."""
        measured = all(self.frames.rows[loop.second].measured for loop in loops)
        return loops if measured else select_firm(loops)

    def partners(self, loop: Edge, candidates: list[Edge], *, apart: bool = False) -> list[Edge]:
        """Loops for which going round them and this one leads back to where it began.

        Of other scans, near at both ends and by firm steps; or, `apart`, of the same scan to passes
        far apart.
        """
        if not candidates:
            return []
        frames, a, b = self.frames, loop, stack(candidates)
        ends = [(a.first, b.first), (a.second, b.second)]
        old, new = (np.abs(frames.distance[i] - frames.distance[j]) for i, j in ends)
        vague = sum(np.abs(frames.spread[i] - frames.spread[j]) for i, j in ends)
        far, same = old > COMPARED_PATH_M, a.second == b.second
        near = ~far & ~same & (new <= COMPARED_PATH_M) & (vague < VAGUE_M**2)
        one = compose(a.relative, between(frames.poses[a.second], frames.poses[b.second]))
        two = compose(between(frames.poses[a.first], frames.poses[b.first]), b.relative)
        x, y, heading = between(one, two).T
        agree = (np.hypot(x, y) < self.rules.tolerance) & (np.abs(heading) < AGREED_ANGLE)
        return [candidates[i] for i in np.flatnonzero(agree & (far & same if apart else near))]

    def finish_pending(self) -> bool:
        """At the end of the log: believe loops that a few others agree with, reject the rest."""
        candidates, loops = [*self.pending, *self.accepted[-COMPARED_LOOPS:]], []
        for loop in self.pending if self.lost_since is None else []:
            others = self.partners(loop, candidates) + self.partners(loop, candidates, apart=True)
            loops += [loop] if len(self._witnesses(others)) >= LAST_WITNESSES else []
        self._give_up(edges_but(self.pending, loops))
        self.believe(loops)
        return bool(loops)

    def drop_contradicted(self) -> bool:
        """Take out loops that the solution leaves far open; True where there were any."""
        frames = self.frames
        if not self.accepted:
            return False
        residual = deviations(frames.poses, stack(frames.edges))
        open_by = zip(frames.edges, residual, strict=True)
        contradicted = [e for e, d in open_by if e.loop and not e.forced and d > CONTRADICTED]
        frames.exchange(edges_but(frames.edges, contradicted))
        return bool(contradicted)

    def veto(self, loops: list[Edge], reason: str = VETOED_LOOP) -> None:
        """Take loops out; others that were taken out since they contradict the rest come back."""
        self.accepted = edges_but(self.accepted, loops)
        self.ways = ways_of(self.accepted)
        steps = [edge for edge in self.frames.edges if not edge.loop]
        self.frames.exchange(steps + self.accepted)
        for loop in loops:
            self._reject(loop.first, loop.second, reason)

    def believe(self, loops: list[Edge]) -> None:
        """Make loops edges of the graph, and ways through it."""
        self.pending = edges_but(self.pending, loops)
        self.accepted += loops
        self.frames.edges += loops
        self.ways = np.concatenate([self.ways, ways_of(loops)])

    def _give_up(self, loops: list[Edge]) -> None:
        """Reject loops that no other has confirmed in time."""
        for loop in loops:
            self._reject(loop.first, loop.second, UNSUPPORTED_LOOP)
        self.pending = edges_but(self.pending, loops)

    def _reject(self, old: int, new: int, reason: str) -> None:
        """Keep the reason, under the indices of the scans."""
        rows = self.frames.rows
        self.rejected.append(Rejected(rows[old].scan, rows[new].scan, reason))

    def not_believed(self) -> list[Rejected]:
        """All loops that are no edges, also those that the solution left open at the end."""
        rows, dropped = self.frames.rows, edges_but(self.accepted, self.frames.edges)
        ends = [(rows[loop.first].scan, rows[loop.second].scan) for loop in dropped]
        return [*self.rejected, *(Rejected(*pair, CONTRADICTED_LOOP) for pair in ends)]
