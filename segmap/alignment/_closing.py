"""Loops: proposed by place and appearance, measured, and believed only where several agree."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..poses import between, compose
from ._frames import Frames, Tie
from ._point_map import PointMap
from ._result import Rejected
from ._solver import deviations, information

#: Key frames before and after the old one, and before the new one, whose points are compared.
OLD, NEW = 5, 3
#: A loop is proposed where the way back is at least this long, metres.
WAY = 10.0
#: The window of the search: this much, metres, and a share of the way since, up to the limit.
BASE, LIMIT = 1.0, 4.0
#: Half side of the window in heading, radians.
TURN = np.radians(20)
#: After a step that no match confirms the robot may be anywhere: what looks most alike is searched
#: in this window at every heading, for at most this way, metres.
LOST, GIVE_UP = 2.0, 15.0
#: Bending the map waits until a loop moves its ends by more than this, metres and radians.
STRAIN = 0.05, np.radians(0.5)
#: Mean likelihood and share of points with a partner that a loop must reach.
LIKELY, OVERLAP = 0.55, 0.6
#: Two loops agree when going round both leaves less than this, metres and radians ...
APART, TURNED = 0.25, np.radians(4)
#: ... and only loops whose ends lie within this way of each other can be compared, metres.
STRETCH = 8.0
#: Each needs so many others that agree; more where the robot may be anywhere, for many rooms are
#: built alike.
WITNESSES, LOST_WITNESSES = 2, 5
#: A loop that the solution leaves open by so many standard deviations is taken out.
CONTRADICTED = 15.0
#: Old places whose map is kept ready.
KEPT = 40


class Loop(NamedTuple):
    """A measured way round.

    The motion, (3,) array, metres and radians, is the pose of key frame `new` in the frame of
    `old`; with its information, (3, 3) array.
    """

    old: int
    new: int
    motion: Array
    information: Array


class Window(NamedTuple):
    """Where to look for a loop: around this pose in the frame of `old`, metres and radians."""

    old: int
    guess: Array
    reach: float
    turn: float


class Closer:
    """Finds loops as key frames come in, and says which it does not believe."""

    def __init__(self, frames: Frames, drift: float) -> None:
        self.frames = frames
        self.drift = drift
        self.lost: int | None = None
        self.pending: list[Loop] = []
        self.closed: list[Loop] = []
        self.rejected: list[Rejected] = []
        self.maps: dict[int, PointMap | None] = {}

    def close(self, *, confirmed: bool) -> bool:
        """Look for loops of the newest key frame; True where those believed strain the map.

        `confirmed` says whether a match tied it to the one before: else the robot may be anywhere.
        """
        new = len(self.frames) - 1
        self.lost = self.lost if confirmed else new
        for window in self._by_place(new) + self._by_appearance(new):
            loop = self._measure(window, new)
            if isinstance(loop, Loop):
                self.pending.append(loop)
            else:
                self._reject(window.old, new, loop)
        believed = self._believed(new)
        for loop in believed:
            self.frames.ties.append(Tie(*loop, loop=True))
        self.closed += believed
        self.lost = None if believed else self.lost
        self._forget(new)
        return any(self._strains(loop) for loop in believed)

    def _by_place(self, new: int) -> list[Window]:
        """Around the nearest old key frame of each pass, as far as the map may have drifted."""
        poses, way = self.frames.poses, self.frames.way[new] - np.array(self.frames.way[:new])
        distance = np.hypot(*(poses[:new, :2] - poses[new, :2]).T)
        reach = np.minimum(BASE + self.drift * way, LIMIT)
        near = np.flatnonzero((distance < reach + 2.0) & (way > WAY))
        return [
            Window(k, between(poses[k], poses[new]), float(reach[k]), TURN)
            for k in _best_of_passes(near, distance)
        ]

    def _by_appearance(self, new: int) -> list[Window]:
        """Where the robot is lost: on what looks most like the place, at any heading."""
        if self.lost is None or self.frames.way[new] - self.frames.way[self.lost] > GIVE_UP:
            return []
        looks = np.array(self.frames.looks)
        unlike = np.abs(looks[: self.lost] - looks[new]).sum(1)
        best = _best_of_passes(np.arange(self.lost), unlike)
        return [Window(k, np.zeros(3), LOST, np.pi) for k in best]

    def _measure(self, window: Window, new: int) -> Loop | str:
        """The motion `(3,)` between two key frames by their surroundings, or why it is none."""
        frames, map = self.frames, self.map_of(window.old)
        seen = frames.cloud(range(max(new - NEW, self.lost or 0), new + 1), new)
        if map is None or len(seen) < 6:
            return "too few points"
        seen = seen[:: 1 + len(seen) // 750]
        start, _ = map.search(
            seen, window.guess, reach=window.reach, turn=window.turn, away=0.05, least=LIKELY
        )
        if start is None:
            return "the two places look different"
        if map.settle(seen, start, reach=0.2).overlap < OVERLAP:
            return "too little of the new place is in the old one"
        match = map.settle(frames.points[new], start, reach=0.2)
        if not match.matched:
            return match.reason
        return Loop(window.old, new, match.pose, information(match.covariance))

    def map_of(self, old: int) -> PointMap | None:
        """The surroundings of an old key frame, in its frame; the last few are kept."""
        if old not in self.maps:
            if len(self.maps) >= KEPT:
                del self.maps[next(iter(self.maps))]
            frames = self.frames
            self.maps[old] = frames.map_of(frames.around(old, OLD), old)
        return self.maps[old]

    def _strains(self, loop: Loop) -> bool:
        """Whether the map has to bend for a loop, by more than `STRAIN`, metres and radians."""
        poses = self.frames.poses
        rest = between(loop.motion, between(poses[loop.old], poses[loop.new]))
        return bool(np.hypot(rest[0], rest[1]) > STRAIN[0] or abs(rest[2]) > STRAIN[1])

    def _believed(self, new: int) -> list[Loop]:
        """Loops of the newest key frame that enough others agree with, and these others."""
        found: list[Loop] = []
        for loop in [each for each in self.pending if each.new == new]:
            others = [o for o in self.pending + self.closed[-30:] if self._agree(loop, o)]
            if len({o.new for o in others}) >= (WITNESSES if self.lost is None else LOST_WITNESSES):
                found += [o for o in [loop, *others] if not _among(o, found + self.closed)]
        self.pending = [loop for loop in self.pending if not _among(loop, found)]
        return found

    def _agree(self, a: Loop, b: Loop) -> bool:
        """Whether going round both loops leads back to where it began."""
        frames = self.frames
        if a.new == b.new or abs(frames.way[a.new] - frames.way[b.new]) > STRETCH:
            return False
        if abs(frames.way[a.old] - frames.way[b.old]) > STRETCH:
            return False
        one = compose(a.motion, between(frames.poses[a.new], frames.poses[b.new]))
        other = compose(between(frames.poses[a.old], frames.poses[b.old]), b.motion)
        rest = between(one, other)
        return bool(np.hypot(rest[0], rest[1]) < APART and abs(rest[2]) < TURNED)

    def _forget(self, new: int) -> None:
        """Give up loops that no other has confirmed in time."""
        way = self.frames.way
        late = [loop for loop in self.pending if way[new] - way[loop.new] > STRETCH]
        for loop in late:
            self._reject(loop.old, loop.new, "no other loop agrees with it")
        self.pending = [loop for loop in self.pending if not _among(loop, late)]

    def drop_contradicted(self) -> bool:
        """Take out loops that the solution leaves far open; True where there were any."""
        frames = self.frames
        if not self.closed:
            return False
        left = deviations(frames.poses, frames.edges())
        out = [tie.loop and d > CONTRADICTED for tie, d in zip(frames.ties, left, strict=True)]
        for tie, gone in zip(frames.ties, out, strict=True):
            if gone:
                self._reject(tie.first, tie.second, "the rest of the graph contradicts it")
        frames.ties = [tie for tie, gone in zip(frames.ties, out, strict=True) if not gone]
        return any(out)

    def _reject(self, old: int, new: int, reason: str) -> None:
        """Keep the reason, under the indices of the scans."""
        self.rejected.append(Rejected(self.frames.scan[old], self.frames.scan[new], reason))


def _best_of_passes(members: NDArray[np.int64], cost: Array) -> list[int]:
    """The cheapest of each run of neighbouring key frames, at most three, cheapest first."""
    passes = np.split(members, np.flatnonzero(np.diff(members) > 3) + 1)
    best = [int(run[np.argmin(cost[run])]) for run in passes if len(run)]
    return sorted(best, key=lambda k: float(cost[k]))[:3]


def _among(loop: Loop, loops: list[Loop]) -> bool:
    return any(loop is other for other in loops)
