"""Key frames: the scans that stand for the map, half a metre apart, and what ties them."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..poses import between, compose, transform
from ._point_map import PointMap
from ._solver import Edges, solve

#: Points farther from the robot than this are left out, metres: no laser for buildings reaches so
#: far, and one absurd range or pose would ask for a map of a million cells a side.
FAR = 100.0


class Tie(NamedTuple):
    """A measured motion between key frames: the pose of `second` in the frame of `first`."""

    first: int
    second: int
    motion: Array
    information: Array
    loop: bool


class Frames:
    """Key frames of a run, with poses that still move when loops close.

    Attributes
    ----------
    scan : list of int
        Index in the log of each key frame.
    points : list of (m, 2) arrays, metres
        Their points, in the frame of the robot.
    poses : (n, 3) array, metres and radians
    way : list of float, metres
        Path length from the start to each.
    looks : list of (16,) arrays
        The appearance of the place of each.
    ties : list of Tie
    """

    def __init__(self, points: Array, pose: Array) -> None:
        self.scan = [0]
        self.points = [points]
        self.poses = np.array([pose])
        self.way = [0.0]
        self.looks = [appearance(points)]
        self.ties: list[Tie] = []

    def __len__(self) -> int:
        return len(self.scan)

    def add(self, scan: int, points: Array, motion: Array, information: Array) -> None:
        """Append a key frame at its motion from the last one, tied to it.

        Its points `(m, 2)`, metres, in the frame of the robot; the motion, (3,) array, metres and
        radians, and its information, (3, 3) array.
        """
        last = len(self) - 1
        self.ties.append(Tie(last, last + 1, motion, information, loop=False))
        self.scan.append(scan)
        self.points.append(points)
        self.poses = np.vstack([self.poses, compose(self.poses[-1], motion)])
        self.way.append(self.way[-1] + float(np.hypot(motion[0], motion[1])))
        self.looks.append(appearance(self.cloud(self.around(last + 1, 3), last + 1)))

    def edges(self) -> Edges:
        """All m ties as arrays: the indices at both ends, the motions and their information.

        `(m,)`, `(m, 3)` in metres and radians, `(m, 3, 3)`.
        """
        first, second, motion, information, _ = zip(*self.ties, strict=True)
        return Edges(np.array(first), np.array(second), np.array(motion), np.array(information))

    def bend(self) -> None:
        """Move the poses, (n, 3) array, metres and radians, to where all ties fit best."""
        if self.ties:
            self.poses = solve(self.poses, self.edges())

    def around(self, frame: int, half: int) -> range:
        """A key frame and up to `half` before and after it, in time."""
        return range(max(frame - half, 0), min(frame + half + 1, len(self)))

    def near(self, frame: int, most: int, within: float) -> Iterable[int]:
        """The key frames nearest to one, itself first: at most so many, within metres."""
        distance = np.hypot(*(self.poses[:, :2] - self.poses[frame, :2]).T)
        order = np.argsort(distance, kind="stable")[:most]
        return [int(k) for k in order if distance[k] <= within]

    def cloud(self, members: Iterable[int], origin: int) -> Array:
        """Points of some key frames, `(m, 2)`, metres, in the frame of the key frame `origin`."""
        return self._seen(members, origin)[:, :2]

    def map_of(self, members: Iterable[int], origin: int) -> PointMap | None:
        """Their points `(m, 2)`, metres, in the frame of `origin`, ready to be matched with.

        None where there are none.
        """
        seen = self._seen(members, origin)
        return PointMap(seen[:, :2], seen[:, 2:]) if len(seen) else None

    def _seen(self, members: Iterable[int], origin: int) -> Array:
        """Points of some key frames and the place of the frame that saw each, `(m, 4)`, metres."""
        parts = []
        for k in members:
            pose = between(self.poses[origin], self.poses[k])
            points = transform(pose, self.points[k])
            parts.append(np.column_stack([points, np.broadcast_to(pose[:2], points.shape)]))
        return not_far(np.concatenate(parts))


def not_far(points: Array) -> Array:
    """The points `(n, 2 or more)`, metres, that a laser can have seen from near the origin."""
    return points[np.abs(points[:, :2]).max(axis=1, initial=0.0) < FAR]


def appearance(cloud: Array) -> Array:
    """What a place looks like from any heading: shares of points by distance, (16,) array.

    In rings of half a metre, to 8 m from the origin of the points `(m, 2)`, metres.
    """
    distance = np.hypot(cloud[:, 0], cloud[:, 1])
    counts = np.histogram(distance, bins=16, range=(0.0, 8.0))[0]
    return np.asarray(counts / max(counts.sum(), 1))
