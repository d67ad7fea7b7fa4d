"""A quadtree of scans whose poses loops still move: made anew, in the background, where they do."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor, wait
from copy import deepcopy
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..alignment import LiveGraph
from ..arrays import Array, checked
from ..compiled import work_time
from ..extraction import extract_polylines
from ..poses.motions import compose, inverse, transform
from ..quadtree import QuadtreeMap, free_ends
from ..reduction import LiveReduction
from ..scans import LaserScan
from ..threads import Locked, locked
from ._scores import nearest_score


class Step(NamedTuple):
    """One scan inserted.

    `pose`, (3,) array, is the robot's in the map, metres and radians; `score` is that of the scan
    there, on the map before it, in the score's unit, NaN for a pose of a graph; `seconds` is what
    the whole step took; `closed` says whether the scan closed loops that moved earlier poses.

    `overlap` is the share of the scan's ends that lie on the map before it. `found` says whether
    that is enough to believe the pose, and whether the walls of the scan fix it: in a corridor that
    shows no end nobody knows how far along, though all of it lies on the map. With a graph, it says
    whether the graph has matched the scan. After one that was lost the map holds it at a wrong
    place, where the next ones fit: overlap is high again, and what follows hangs on nothing.

    `motion`, (6,) array, is the velocity and the acceleration then, in the robot's frame, metres
    and radians, seconds: where the graph has `Tracking(moving=True)`, else 0; None without a graph.

    Examples
    --------
    >>> from segmap.matching import map_scans
    >>> near, far = [LaserScan([size, size, size], [0.0, 0.1, 0.2]) for size in (1.0, 5.0)]
    >>> [step.found for step in map_scans([near, near, far])]
    [True, True, False]
    """

    pose: Array
    score: float
    seconds: float
    closed: bool
    found: bool
    overlap: float
    motion: Array | None = None


#: A scan and its pose (3,) in the map.
Placed = tuple[LaserScan, Array]
#: A map that was made anew, its reduced map, and how many scans they hold.
Anew = tuple[QuadtreeMap, LiveReduction | None, int]
#: An end of a beam so near to an occupied cell lies on the map, metres, and half a cell more: as
#: near as point ICP seeks partners in the end.
ON_MAP_M = 0.12
#: Share of a scan that must lie on the map. Where the poses were right (Malaga, an URG-04LX) all
#: scans have 0.67 and more; where a matcher was lost it had 0.05 to 0.55 at that scan.
FOUND = 0.6


def overlap_of(map: QuadtreeMap, points: Array, pose: Array) -> float:
    """Share of the ends `(n, 2)` of a scan at a pose `(3,)` that lie on a map; 1 where the map is
    empty."""
    if not len(points):
        return 0.0
    ends = np.column_stack([transform(pose, points), np.zeros(len(points))])
    with map.lock:
        if not map.tree.occupied_blocks()[map.tree.block]:
            return 1.0
        away = -nearest_score(map, np.zeros((1, 2)), ends)  # each end as a scan of one point
    return float((away <= ON_MAP_M + map.resolution / 2).mean())


class LiveMap(Locked):
    """The map of a robot that closes loops while it drives.

    A pose graph places each scan, which is then inserted. Where loops move earlier poses, a new map
    of all scans is made in a thread, at their corrected poses; the old one stands, and goes on
    growing, until the new one holds all scans and takes its place.

    Parameters
    ----------
    graph : LiveGraph or None
        Scans that it holds already are not drawn; a new one by default.
    map : QuadtreeMap or None
        Scans are inserted here, beside what it holds; a new map by default.
    start : (3,) array, metres and radians
        Pose of the robot in the map at the first scan.
    free : bool
        As in `map_scans`.
    walls : LiveReduction or None
        Takes in the polylines of each scan, where it is given; after a loop anew.

    Attributes
    ----------
    graph : LiveGraph
    map : QuadtreeMap, and walls : LiveReduction or None
        Always the same objects: a new map takes its place inside.

    Examples
    --------
    >>> from segmap import load
    >>> live = LiveMap()
    >>> for scan in load("room")[:5]:
    ...     step = live.add(scan)
    >>> live.finish()
    >>> live
    LiveMap(LiveGraph(5 scans: 3 key frames, 0 loops))
    """

    @checked
    def __init__(
        self,
        graph: LiveGraph | None = None,
        *,
        map: QuadtreeMap | None = None,
        start: ArrayLike = (0.0, 0.0, 0.0),
        free: bool = False,
        walls: LiveReduction | None = None,
    ) -> None:
        self.walls = walls if walls is None else arrays.instance(walls, "walls", LiveReduction)
        self.graph = LiveGraph() if graph is None else arrays.instance(graph, "graph", LiveGraph)
        self.map = QuadtreeMap() if map is None else arrays.instance(map, "map", QuadtreeMap)
        self._blank = deepcopy((self.map, walls))
        self._start, self._free = arrays.pose(start, "start"), free
        self._map_from_graph: Array | None = None
        self._drawn: list[int] = []  # which scans of the graph
        self._stale = False
        self._anew: Future[Anew] | None = None
        self._placed: list[Placed] = []  # what the new map will hold, while it is made

    @locked
    def add(self, scan: LaserScan) -> Step:
        """Place a scan and insert it; one that reaches beyond the map's `max_size` is not drawn."""
        begun, number = work_time(), len(self.graph)
        self._exchange()
        in_graph, closed = self.graph.add(scan)
        self._stale |= closed
        tracked = self.graph.tracked(number)
        pose, scan = self._in_map(in_graph), tracked.scan
        overlap = overlap_of(self.map, scan.points(), pose)
        insert_placed(self.map, self.walls, scan, pose, free=self._free)
        self._drawn.append(number)
        if self._anew is not None:
            self._placed.append((scan, pose))
        self._begin()
        matched = not any(self.graph.unmatched[-1:])
        seconds = work_time() - begun
        return Step(pose, np.nan, seconds, closed, matched, overlap, tracked.motion)

    def _in_map(self, pose: Array) -> Array:
        """A pose (3,) of the graph in the map, metres and radians; the first one lays the map."""
        if self._map_from_graph is None:
            self._map_from_graph = compose(self._start, inverse(pose))
        return compose(self._map_from_graph, pose)

    def finish(self) -> None:
        """Wait until the map shows all scans at their corrected poses."""
        while (anew := self._pending()) is not None:
            wait([anew])

    @locked
    def _pending(self) -> Future[Anew] | None:
        """The new map that is still to be made, if any."""
        self._exchange()
        self._begin()
        return self._anew

    @property
    @locked
    def poses(self) -> Array:
        """Poses of the scans in the map, `(k, 3)` array, metres and radians, as corrected."""
        if self._map_from_graph is None:
            return np.zeros((0, 3))
        return compose(self._map_from_graph, self.graph.poses[self._drawn])

    def _begin(self) -> None:
        """Begin a new map where poses have moved; one that is being made ends first."""
        if self._stale and self._anew is None:
            scans = [self.graph.tracked(number).scan for number in self._drawn]
            self._placed = list(zip(scans, self.poses, strict=True))
            thread = ThreadPoolExecutor(1, "new map")
            blank = deepcopy(self._blank)
            self._anew = thread.submit(_insert_all, *blank, self._placed, free=self._free)
            thread.shutdown(wait=False)
            self._stale = False

    def _exchange(self) -> None:
        """Let the new map take the place of the old one, if it is ready."""
        if self._anew is None or not self._anew.done():
            return
        anew, self._anew = self._anew, None
        map, walls, count = anew.result()
        for scan, pose in self._placed[count:]:
            insert_placed(map, walls, scan, pose, free=self._free)
        self._placed = []
        self.map.become(map)
        if self.walls is not None and walls is not None:
            self.walls.become(walls)

    def __repr__(self) -> str:
        return f"LiveMap({self.graph!r})"


def _insert_all(
    map: QuadtreeMap, walls: LiveReduction | None, placed: list[Placed], *, free: bool
) -> Anew:
    """The map, and the reduced one, of scans at their poses; more may come in meanwhile."""
    count = 0
    for scan, pose in placed:
        insert_placed(map, walls, scan, pose, free=free)
        count += 1
    return map, walls, count


def insert_placed(
    map: QuadtreeMap, walls: LiveReduction | None, scan: LaserScan, pose: Array, *, free: bool
) -> None:
    """Add a scan to a map, and its polylines to the reduced map, if there is one.

    At the robot's pose (3,), metres and radians; free as in `map_scans`. A map passes over a scan
    without returns.
    """
    points = scan.points()
    if len(points):
        sensor = compose(pose, scan.sensor_pose)
        unseen = free_ends(scan, sensor) if free else None
        map.insert_scan(sensor[:2], transform(pose, points), unseen)
    if walls is not None:
        segments = extract_polylines(points, closed=scan.whole_turn)
        walls.add(transform(pose, segments.reshape(-1, 2)).reshape(-1, 2, 2))
