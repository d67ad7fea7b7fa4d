"""Loop closing: old places proposed, measured, and believed only where several loops agree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Settings
from ..poses import between, compose
from ._graph import Edge, Rejected, deviations, information, residuals, stacked
from ._point_map import PointMap

if TYPE_CHECKING:
    from ._pose_graph import KeyFrames

#: What a place looks like from any heading: shares of the points in rings up to this radius,
#: metres, as three key frames before and after it see them.
RINGS, RADIUS, VIEW = 16, 8.0, 3
#: Key frames that follow each other by less than this are one pass; so many passes are searched.
GAP, PASSES = 3, 3
#: So many points of the new place are registered: more do not make it surer.
SAMPLE = 750
#: Accepted loops that a new one is compared with: older ones lie farther back than `stretch`.
RECENT = 30
#: Maps of old places that are kept ready, for memory's sake.
KEPT = 40


@dataclass(frozen=True)
class LoopClosing(Settings):
    """How loops are sought, and which of them are believed.

    Parameters
    ----------
    min_path : float, metres
        A loop is sought where the path since the old place is at least this long: before that the
        place is still on the local map.
    reach, max_reach : float, metres
        Half side of the search window about an old place, to which the share `drift` of the path
        is added up to the maximum: farther off, other rooms come into the window.
    beside : float, metres
        Old places are proposed this much farther off than the window: they can be seen from there.
    turn : float, radians
        Half side of the window in heading.
    lost_reach : float, metres
        After a step that no match confirms the robot may be anywhere. The places that look most
        alike are then searched in this window at every heading ...
    lost_path : float, metres
        ... over a path of at most this length.
    old_frames, new_frames : int
        Key frames before and after the old one, and before the new one, whose points are compared:
        a single scan looks like many places.
    likelihood, overlap : float
        Mean likelihood, and share of the points with a partner, that a measured loop must reach.
    tolerance, angle : float, metres and radians
        Two loops agree where going round both leaves less than this.
    stretch : float, metres
        Only loops whose ends lie within this path of each other are compared: beyond it the error
        of the path itself would count.
    witnesses, lost_witnesses : int
        Number of other loops that must agree; more where the robot may be anywhere, since many
        rooms are built alike.
    strain, strain_angle : float, metres and radians
        The graph is solved at once where a new loop moves its ends by more than this.
    contradicted : float, standard deviations
        Loops that the solution leaves open by more are taken out at the end.

    Raises
    ------
    ValueError
        For a value that is not positive, or a number that is not whole.

    Examples
    --------
    >>> LoopClosing(witnesses=0)
    Traceback (most recent call last):
    ValueError: witnesses must be a number above 0, got 0
    """

    min_path: float = 10.0
    reach: float = 1.0
    max_reach: float = 4.0
    beside: float = 2.0
    turn: float = np.radians(20)
    lost_reach: float = 2.0
    lost_path: float = 15.0
    old_frames: int = 5
    new_frames: int = 3
    likelihood: float = 0.55
    overlap: float = 0.6
    tolerance: float = 0.25
    angle: float = np.radians(4)
    stretch: float = 8.0
    witnesses: int = 2
    lost_witnesses: int = 5
    strain: float = 0.05
    strain_angle: float = np.radians(0.5)
    contradicted: float = 15.0


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
        self.maps: dict[int, PointMap | None] = {}

    def close(self, *, confirmed: bool) -> bool:
        """Look for loops of the newest key frame; True where accepted ones strain the map.

        `confirmed` says whether a match tied it to the one before: else the robot may be anywhere.
        """
        new = len(self.frames) - 1
        view, _ = self.frames.points_around(self._neighbours(new, VIEW), new)
        self.descriptors.append(descriptor(view))
        self.lost_since = self.lost_since if confirmed else new
        for window in self._by_place(new) + self._by_descriptor(new):
            loop = self._measure(window, new)
            if isinstance(loop, Edge):
                self.pending.append(loop)
            else:
                self._reject(window.old, new, loop)
        found = self._confirmed_by_others(new)
        self.accepted += found
        self.frames.edges += found
        self.lost_since = None if found else self.lost_since
        self._give_up(new)
        return any(self._strains(loop) for loop in found)

    def _by_place(self, new: int) -> list[Window]:
        """Around the nearest old key frame of each pass, as far as the map may have drifted."""
        rules, poses = self.rules, self.frames.poses
        path = self.frames.path[new] - np.array(self.frames.path[:new])
        distance = np.hypot(*(poses[:new, :2] - poses[new, :2]).T)
        reach = np.minimum(rules.reach + self.drift * path, rules.max_reach)
        near = np.flatnonzero((distance < reach + rules.beside) & (path > rules.min_path))
        return [
            Window(k, between(poses[k], poses[new]), float(reach[k]), rules.turn)
            for k in _best_of_passes(near, distance)
        ]

    def _by_descriptor(self, new: int) -> list[Window]:
        """Where the robot is lost: on what looks most like the place, at any heading."""
        lost, path = self.lost_since, self.frames.path
        if lost is None or path[new] - path[lost] > self.rules.lost_path:
            return []
        descriptors = np.array(self.descriptors)
        unlike = np.abs(descriptors[:lost] - descriptors[new]).sum(1)
        best = _best_of_passes(np.arange(lost), unlike)
        return [Window(k, np.zeros(3), self.rules.lost_reach, np.pi) for k in best]

    def _measure(self, window: Window, new: int) -> Edge | str:
        """The loop between two key frames by their surroundings, or why there is none."""
        frames, rules, map = self.frames, self.rules, self._map_around(window.old)
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

    def _map_around(self, old: int) -> PointMap | None:
        """The surroundings of an old key frame, in its frame; the last few are kept."""
        if old not in self.maps:
            if len(self.maps) >= KEPT:
                del self.maps[next(iter(self.maps))]
            around = self._neighbours(old, self.rules.old_frames)
            self.maps[old] = self.frames.map_of(around, old)
        return self.maps[old]

    def _neighbours(self, frame: int, half: int) -> range:
        """A key frame and up to `half` before and after it, in time."""
        return range(max(frame - half, 0), min(frame + half + 1, len(self.frames)))

    def _strains(self, loop: Edge) -> bool:
        """Whether the poses leave a loop open so far that the graph has to be solved at once."""
        x, y, heading = residuals(self.frames.poses, loop)
        far = np.hypot(x, y) > self.rules.strain
        return bool(far or abs(heading) > self.rules.strain_angle)

    def _confirmed_by_others(self, new: int) -> list[Edge]:
        """Loops of the newest key frame that enough others agree with, and these others."""
        found: list[Edge] = []
        lost = self.lost_since is not None
        enough = self.rules.lost_witnesses if lost else self.rules.witnesses
        for loop in [each for each in self.pending if each.second == new]:
            known = self.pending + self.accepted[-RECENT:]
            others = [other for other in known if self._agree(loop, other)]
            if len({other.second for other in others}) >= enough:
                found += _without([loop, *others], found + self.accepted)
        self.pending = _without(self.pending, found)
        return found

    def _agree(self, a: Edge, b: Edge) -> bool:
        """Whether going round both loops leads back to where it began."""
        path, poses, rules = self.frames.path, self.frames.poses, self.rules
        if a.second == b.second or abs(path[a.second] - path[b.second]) > rules.stretch:
            return False
        if abs(path[a.first] - path[b.first]) > rules.stretch:
            return False
        one = compose(a.relative, between(poses[a.second], poses[b.second]))
        other = compose(between(poses[a.first], poses[b.first]), b.relative)
        x, y, heading = between(one, other)
        return bool(np.hypot(x, y) < rules.tolerance and abs(heading) < rules.angle)

    def _give_up(self, new: int) -> None:
        """Reject loops that no other has confirmed in time."""
        path = self.frames.path
        late = [e for e in self.pending if path[new] - path[e.second] > self.rules.stretch]
        for loop in late:
            self._reject(loop.first, loop.second, "no other loop agrees with it")
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
