"""Key frames: the scans that stand for the map, the edges between them, and ways along these."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import arrays
from ...arrays import Array
from ...compiled import compiled
from ...poses.motions import between, compose
from ..graph import REAL, Edge, Solver, groups, information, stack
from ..points import FARTHEST_POINT_M, SEARCH_POINTS, PointMap, decimate, place_clouds

Members = Sequence[int] | NDArray[np.int64]

#: A trusted loop counts as this length of a path through the graph, metres.
LOOP_PATH_M = 0.5
#: Loops with a larger standard deviation, metres, are not part of paths through the graph. Without
#: odometry they cannot confirm other loops either, nor can loops over steps with a larger one:
#: along a corridor neither fixes anything.
VAGUE_M = 0.2


class Undoable:
    """A part of a graph that `rollback_on_error` puts back as it was.

    Its lists only grow, but for the last row, and what else its fields hold is exchanged and never
    changed in place. Fields that are undoable themselves are put back too.
    """

    def fields(self) -> list[tuple[Undoable, str, object]]:
        """All that is put back: of which part, under which name, and what it holds now."""
        own = [(self, name, value) for name, value in vars(self).items()]
        parts = [value for *_, value in own if isinstance(value, Undoable)]
        return own + [field for part in parts for field in part.fields()]


class KeyFrame(NamedTuple):
    """A scan that stands for the map."""

    scan: int  # index in the log
    points: Array  # in the frame of the robot
    tied: bool = True  # whether a match fixes the step to it
    measured: bool = True  # whether odometry says how the robot came to it


class KeyFrames(Undoable):
    """The scans that stand for the map, half a metre apart, with poses that loops still move."""

    def __init__(self, least: Array = REAL) -> None:
        self.rows: list[KeyFrame] = []
        self.poses = np.zeros((0, 3))
        self.distance = np.zeros(0)  # metres driven up to each
        # Variance of the steps up to each that no odometry measured, where it is widest, metres^2.
        self.spread = np.zeros(0)
        self.edges: list[Edge] = []
        self.fixed = True  # whether the edges fixed all poses then; else it moved none
        self.least = least  # covariance that every match has at least
        self._solver = Solver()
        self._last: Edge | None = None  # of the edges that the solver has

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def scans(self) -> NDArray[np.int64]:
        """Index in the log of each key frame, `(n,)`."""
        return np.array([row.scan for row in self.rows], np.int64)

    def add(self, row: KeyFrame, motion: Array, covariance: Array) -> None:
        """Append a key frame at its motion `(3,)` from the last one, with an edge between them.

        The first one has its pose for the motion, and no edge.
        """
        new, pose, way, spread = len(self), motion, 0.0, 0.0
        if new:
            self.edges.append(Edge(new - 1, new, motion, information(covariance, self.least)))
            pose = compose(self.poses[-1], motion)
            way = self.distance[-1] + float(np.hypot(motion[0], motion[1]))
            widest = np.linalg.eigvalsh(covariance[:2, :2])[-1]
            spread = self.spread[-1] + (0.0 if row.measured else widest)
        self.poses = np.vstack([self.poses, pose])
        self.distance = np.append(self.distance, way)
        self.spread = np.append(self.spread, spread)
        self.rows.append(row)

    def extend(self, later: KeyFrames, scan: int, covariance: Array) -> None:
        """Append the key frames of another graph, whose first scan has this index here.

        The first lies where the last one of this graph does, as uncertain as the covariance says.
        """
        new = len(self)
        self.add(later.rows[0]._replace(scan=scan, tied=False), np.zeros(3), covariance)
        moved = compose(self.poses[-1], between(later.poses[0], later.poses[1:]))
        self.poses = np.vstack([self.poses, moved])
        self.distance = np.append(self.distance, self.distance[-1] + later.distance[1:])
        self.spread = np.append(self.spread, self.spread[-1] + later.spread[1:])
        self.rows += [row._replace(scan=scan + row.scan) for row in later.rows[1:]]
        self.edges += [e._replace(first=new + e.first, second=new + e.second) for e in later.edges]

    def optimize(self, *, lazily: bool = False) -> None:
        """Move the poses to where all edges fit best.

        `lazily`, while the robot drives: only what new edges change is computed again. Where the
        edges leave a pose free but for rounding, all stay where they are.
        """
        if not self.edges:
            return
        count = len(self._solver)
        if count and (count > len(self.edges) or self.edges[count - 1] is not self._last):
            self._solver, count = Solver(), 0  # some were undone: all anew
        if count < len(self.edges):
            self._solver.add(stack(self.edges[count:]))
            self._last = self.edges[-1]
        try:
            self.poses = self._solver.solve(self.poses, lazily=lazily).poses
            self.fixed = True
        except np.linalg.LinAlgError:
            self.fixed = False

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

    def points_around(
        self, members: Members, origin: int, *, thin: bool = False
    ) -> tuple[Array, Array]:
        """Points of some key frames, and where each was seen from: `(m, 2)` arrays, metres.

        In the frame of the key frame `origin`; `thin`: no more than a search needs.
        """
        clouds = [self.rows[k].points for k in members]
        if thin:
            clouds = [decimate(cloud, max(SEARCH_POINTS // len(clouds), 2)) for cloud in clouds]
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
    pairs = arrays.indices(loops, name)
    if pairs.size and pairs.shape[1:] != (2,):
        raise ValueError(f"{name} must be pairs of scans, (n, 2), got {arrays.brief(loops)}")
    return list(pairs.reshape(-1, 2).tolist())


def edges_but(edges: list[Edge], gone: list[Edge]) -> list[Edge]:
    """The edges but for those gone: the same objects, not equal ones."""
    ids = {id(edge) for edge in gone}
    return [edge for edge in edges if id(edge) not in ids]


def select_firm(loops: list[Edge]) -> list[Edge]:
    """Those loops that fix the place in all directions."""
    covariances = [np.linalg.inv(loop.information)[:2, :2] for loop in loops]
    wide = np.linalg.eigvalsh(np.reshape(covariances, (-1, 2, 2)))[:, -1]
    return [loops[i] for i in np.flatnonzero(np.sqrt(wide) < VAGUE_M)]


def ways_of(loops: list[Edge]) -> NDArray[np.int64]:
    """Both ends, `(w, 2)`, of those loops that fix the place: they are ways through the graph."""
    return np.array([loop[:2] for loop in select_firm(loops)], np.int64).reshape(-1, 2)


def loose_poses(tied: Sequence[bool], edges: Sequence[Edge], weight: Array) -> NDArray[np.bool_]:
    """Which of n poses no edge that a match made ties to the largest group of them.

    `tied` says so of the step to each pose; loops always do. `weight` counts the scans of each
    that matched: a robot that stands blind for long is no map.
    """
    sure = [edge for edge in edges if edge.loop or tied[edge.second]]
    first, second = np.reshape([edge[:2] for edge in sure], (-1, 2)).T.astype(np.int64)
    group = groups(first, second, len(tied))
    return np.asarray(group != np.argmax(np.bincount(group, weight)))


@contextmanager
def rollback_on_error(*parts: Undoable) -> Iterator[None]:
    """Undo what is done to parts of a graph, where it ends before its end."""
    fields = [field for part in parts for field in part.fields()]
    lengths = [(value, len(value)) for *_, value in fields if isinstance(value, list)]
    try:
        yield
    except BaseException:
        for part, name, value in fields:
            setattr(part, name, value)
        for grown, length in lengths:
            del grown[length:]
        raise


@compiled
def key_frames_in_square(poses: Array, new: int, half: float, near: NDArray[np.int64]) -> int:
    """Write which poses lie in a square about the new one, half a side in metres; their number."""
    count = 0
    for k in range(len(near)):
        off = max(abs(poses[k, 0] - poses[new, 0]), abs(poses[k, 1] - poses[new, 1]))
        near[count], count = k, count + (off < half)
    return count


@compiled
def path_lengths(
    along: Array,
    ways: NDArray[np.int64],
    begin: int,
    wanted: NDArray[np.int64],
    most: float,
    metres: Array,
) -> None:
    """Write the metres of the shortest ways, up to `most`, to wanted key frames (Dijkstra 1959).

    Before that they are infinite. `along`, (n,), is the path driven; `ways`, (w, 2), join old key
    frames and new ones. Ends when all that are wanted are reached: most often near.
    """
    head, link, remaining = np.full(len(along), -1), np.empty(2 * len(ways), np.int64), len(wanted)
    asked = np.zeros(len(along), np.bool_)
    for slot in range(2 * len(ways)):
        end = ways[slot // 2, slot % 2]
        if abs(end - ways[slot // 2, 1 - slot % 2]) > 1:
            link[slot], head[end] = head[end], slot
    for k in wanted:
        asked[k] = True
    heap, metres[begin] = [(0.0, begin)], 0.0
    while remaining and len(heap):
        far, k = heapq.heappop(heap)
        if far > metres[k]:
            continue
        remaining -= asked[k]
        slot, side = head[k], -1
        while slot >= 0 or side < 2:
            if side < 2:  # the key frames before and after it, then those at ways
                j = min(max(k + side, 0), len(along) - 1)
                step, side = abs(along[j] - along[k]), side + 2
            else:
                j, step, slot = ways[slot // 2, 1 - slot % 2], LOOP_PATH_M, link[slot]
            if far + step <= most and far + step < metres[j]:
                metres[j] = far + step
                heapq.heappush(heap, (metres[j], j))
