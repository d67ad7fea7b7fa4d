"""Key frames: the scans that stand for the map, and the edges between them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import arrays
from ...arrays import Array
from ...poses.motions import between, compose
from ..graph import REAL, Edge, Solver, information, stacked
from ..points import FARTHEST_POINT_M, PointMap, place_clouds

Members = Sequence[int] | NDArray[np.int64]


class KeyFrames:
    """The scans that stand for the map, half a metre apart, with poses that loops still move."""

    def __init__(self, points: Array, pose: Array, least: Array = REAL) -> None:
        self.scan = [0]  # index in the log of each key frame
        self.points = [points]  # of each, in the frame of the robot
        self.distance = np.zeros(1)  # metres driven up to each
        self.poses = np.array([pose])
        self.edges: list[Edge] = []
        self.converged = True  # whether the last `optimize` came to an end: the poses fit best
        self.least = least  # covariance that every match has at least
        self._solver = Solver()
        self._last: Edge | None = None  # of the edges that the solver has

    def __len__(self) -> int:
        return len(self.scan)

    def add(self, scan: int, points: Array, relative: Array, covariance: Array) -> None:
        """Append a key frame at its motion `(3,)` from the last one, with an edge between them."""
        new = len(self)
        self.edges.append(Edge(new - 1, new, relative, information(covariance, self.least)))
        driven = self.distance[-1] + float(np.hypot(relative[0], relative[1]))
        self.poses = np.vstack([self.poses, compose(self.poses[-1], relative)])
        self.distance = np.append(self.distance, driven)
        self.scan.append(scan)
        self.points.append(points)

    def extend(self, later: KeyFrames, joint: int, edges: list[Edge]) -> None:
        """Append the key frames behind one of another graph, which is the last one of this."""
        last, rest = len(self) - 1, slice(joint + 1, None)
        moved = compose(self.poses[last], between(later.poses[joint], later.poses[rest]))
        way, scans = (
            self.distance[last] - later.distance[joint],
            self.scan[last] - later.scan[joint],
        )
        self.poses = np.vstack([self.poses, moved])
        self.distance = np.append(self.distance, way + later.distance[rest])
        self.scan += [scans + scan for scan in later.scan[rest]]
        self.points += later.points[rest]
        self.edges += edges

    def optimize(self, *, lazily: bool = False) -> None:
        """Move the poses to where all edges fit best.

        `lazily`, while the robot drives: only what new edges change is computed again.
        """
        if not self.edges:
            return
        known = len(self._solver)
        if known and (known > len(self.edges) or self.edges[known - 1] is not self._last):
            self._solver, known = Solver(), 0  # some were undone: all anew
        if known < len(self.edges):
            self._solver.add(stacked(self.edges[known:]))
            self._last = self.edges[-1]
        self.poses, self.converged, _ = self._solver.solve(self.poses, lazily=lazily)

    def exchange(self, edges: list[Edge]) -> None:
        """Put other edges in the place of all: the next `optimize` begins anew."""
        self.edges, self._solver, self._last = edges, Solver(), None

    def neighbourhoods(self, most: int, reach: float) -> Callable[[int], NDArray[np.int64]]:
        """From a key frame to those that are nearest, at most so many, within a reach in metres."""
        from scipy.spatial import cKDTree

        places = self.poses[:, :2]
        tree = cKDTree(places)

        def around(frame: int) -> NDArray[np.int64]:
            """The nearest of one key frame, itself among them."""
            near = np.sort(tree.query_ball_point(places[frame], 1.001 * reach))
            far = np.hypot(*(places[near] - places[frame]).T)
            nearest = np.argsort(far, kind="stable")[:most]
            return near[nearest[far[nearest] <= reach]]

        return around

    def points_around(self, members: Members, origin: int) -> tuple[Array, Array]:
        """Points of some key frames, and where each was seen from: `(m, 2)` arrays, metres.

        In the frame of the key frame `origin`.
        """
        clouds = [self.points[k] for k in members]
        counts = np.array([len(cloud) for cloud in clouds], np.int64)
        placed, seen_from = np.empty((2, counts.sum(), 2))
        poses = between(self.poses[origin], self.poses[members])
        used = place_clouds(
            np.concatenate(clouds), counts, poses, FARTHEST_POINT_M, placed, seen_from
        )
        return placed[:used], seen_from[:used]

    def map_of(self, members: Members, origin: int) -> PointMap | None:
        """The map of some key frames in the frame of `origin`; None where they have no point."""
        points, viewpoints = self.points_around(members, origin)
        return PointMap(points, viewpoints) if len(points) else None


def loop_pairs(loops: ArrayLike, name: str) -> list[list[int]]:
    """Both scans of each loop."""
    found = arrays.indices(loops, name)
    if found.size and found.shape[1:] != (2,):
        raise ValueError(f"{name} must be pairs of scans, (n, 2), got {arrays.brief(loops)}")
    return list(found.reshape(-1, 2).tolist())


@contextmanager
def rollback_on_error(*parts: object) -> Iterator[None]:
    """Undo what is done to objects whose lists only grow, where it ends before its end."""
    kept = [(part, dict(vars(part))) for part in parts]
    lengths = [(v, len(v)) for _, known in kept for v in known.values() if isinstance(v, list)]
    try:
        yield
    except BaseException:
        for part, known in kept:
            vars(part).update(known)
        for grown, length in lengths:
            del grown[length:]
        raise
