"""Map and place together: a quadtree from a log without odometry, scan by scan (B 4.3, 6)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import lru_cache, partial
from inspect import signature

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..alignment import LiveGraph, LoopClosing, match_points
from ..arrays import Array, Count, checked
from ..compiled import work_time
from ..poses.motions import between
from ..quadtree import QuadtreeMap
from ..scans import LaserScan
from ._field import NothingNear
from ._live_map import FOUND, LiveMap, Step, insert_placed, overlap_of
from ._matchers import Prepared, Score, field_score, hill_climb, prepared_score, sample_and_rank
from ._scores import descent_score, nearest_score, occupancy_score

#: From a map, points and a start, with a score, to a pose.
Matcher = Callable[..., Array]
#: The matchers by name, each made from a generator; those of the thesis as B prints them.
MATCHERS: dict[str, Callable[[np.random.Generator], Matcher]] = {
    "hill climbing": lambda rng: hill_climb,
    "hill climbing, thesis": lambda rng: partial(hill_climb, steps="thesis"),
    "sample and rank": lambda rng: partial(sample_and_rank, rng=rng),
    "sample and rank, thesis": lambda rng: partial(sample_and_rank, rng=rng, sigma=(0.02, 2.0)),
}
#: The scores by name.
SCORES: dict[str, Score] = {
    "field": field_score,
    "nearest": nearest_score,
    "occupancy": occupancy_score,
    "descent": descent_score,
}


@checked
def map_scans(
    log: Iterable[LaserScan],
    *,
    matcher: Matcher = hill_climb,
    score: Score = field_score,
    settle: Count = 1,
    map: QuadtreeMap | None = None,
    start: ArrayLike = (0.0, 0.0, 0.0),
    free: bool = False,
    rng: np.random.Generator | None = None,
    graph: LiveGraph | bool = False,
) -> Iterator[Step]:
    """Match each scan with the map of the scans before it, insert it, and say where it was.

    It uses ranges alone, no odometry and no scan ahead, so that it also serves a live sensor. What
    is compiled is loaded before the first scan is asked for: the laser is still off then.

    With a graph the robot may come back: its poses close loops, and the map is then made anew from
    the corrected poses of all scans, in the background; the old one stands until that is done. When
    the log has ended, the map is that of the corrected poses (see `LiveMap`).

    Parameters
    ----------
    matcher : callable
        `hill_climb`, `sample_and_rank`, or any `matcher(map, points, start, score=score) -> (3,)`.
    settle : int
        So many scans are inserted at the start pose without a match. B inserts five while the
        sensor stands still; with a sensor that moves this ruins every matcher.
    map : QuadtreeMap or None
        Scans are inserted here; a new map by default.
    start : (3,) array, metres and radians
        Pose of the robot at the first scan.
    free : bool
        Whether beams that met nothing count as free up to the sensor's largest range, where the
        scan knows that. A real sensor gives the same answer for a dark or slanted wall: in the
        CoreSLAM log half the beams do, and erase four fifths of the walls.
    rng : numpy.random.Generator or None
        For a matcher that takes one; `sample_and_rank` needs it.
    graph : LiveGraph or bool
        Poses come from this graph, or from a new one where True, and from odometry where scans have
        it; matcher, score and settle are then not used.

    Yields
    ------
    Step
        After each scan. A scan gets the pose of the one before, and NaN for its score, if it is one
        of the first, has no return, or if the map holds nothing near it. `found` says whether it
        lies on the map, where the walls that the scan before saw too fix it, or the robot is lost.
        With a graph, `closed` says that earlier poses have moved: the graph, or `LiveMap`, has
        them.

    Raises
    ------
    ValueError
        At once for wrong arguments. Later it names the scan that is no LaserScan, or reaches beyond
        the map's `max_size`; the map is then as before that scan.

    Examples
    --------
    >>> from segmap import load
    >>> steps = list(map_scans(load("room")[:5]))
    >>> len(steps), steps[0].pose
    (5, array([0., 0., 0.]))
    """
    arrays.function(score, "score", "of map, points and poses, nearest_score say")
    pose = arrays.pose(start, "start")
    tree = QuadtreeMap() if map is None else arrays.instance(map, "map", QuadtreeMap)
    if not arrays.is_iterable(log):
        raise ValueError(f"log must be a Log, or give scans one by one, got {type(log).__name__}")
    if graph is not False:
        live_graph = LiveGraph() if graph is True else arrays.instance(graph, "graph", LiveGraph)
        return _graph_steps(log, LiveMap(live_graph, map=tree, start=pose, free=free))
    arrays.function(matcher, "matcher", "of map, points and start, hill_climb say")
    if matcher is sample_and_rank and rng is None:
        raise ValueError("sample_and_rank draws poses: give rng, numpy.random.default_rng(1) say")
    match = drawing(matcher, rng)

    def steps(pose: Array) -> Iterator[Step]:
        _warm(score if score in SCORES.values() else field_score)
        inserted, before = 0, np.zeros((0, 2))  # the scan before
        for k, scan in enumerate(log):
            begun, value, fixed = work_time(), np.nan, True
            with naming_scan(scan, k):
                points = scan.points()
                if len(points) and inserted >= settle:
                    last = pose
                    pose, value = _match_by_score(match, score, tree, points, last)
                    # Walls that come into view now have fixed nothing
                    shared = match_points(before, points, between(last, pose))
                    fixed = shared.free is None and not shared.turns
                before = points if len(points) else before
                overlap = overlap_of(tree, points, pose)
                insert_placed(tree, None, scan, pose, free=free)
                inserted += len(points) > 0
            on_map = fixed and overlap >= FOUND
            yield Step(pose.copy(), value, work_time() - begun, False, on_map, overlap)

    return steps(pose)


def drawing(matcher: Matcher, rng: np.random.Generator | None) -> Matcher:
    """A matcher that draws, with the generator that it draws from."""
    takes = rng is not None and "rng" in signature(matcher).parameters
    return partial(matcher, rng=rng) if takes else matcher


def _graph_steps(log: Iterable[LaserScan], live: LiveMap) -> Iterator[Step]:
    _warm_graph()
    for k, scan in enumerate(log):
        with naming_scan(scan, k):
            step = live.add(scan)
        yield step
    live.finish()


@contextmanager
def naming_scan(scan: LaserScan, k: int) -> Iterator[None]:
    """An error that is told of a scan says which one, and one that is no scan is an error."""
    if not isinstance(scan, LaserScan):
        got = type(scan).__name__
        raise ValueError(f"scan {k}: wanted a LaserScan, as a Log or sensor gives, got {got}")
    try:
        yield
    except ValueError as error:
        raise ValueError(f"scan {k}: {error}") from error


@lru_cache  # once in each process
def _warm(score: Score) -> None:
    """Load or compile all that a scan needs, before a live sensor is asked for the first one.

    Compiling takes up to a minute, once on a machine, and a robot would go on meanwhile.
    """
    map, points = QuadtreeMap(resolution=0.1, size=1.6, free_resolution=0.2), np.eye(2)
    for _ in range(2):
        overlap_of(map, points, np.zeros(3))
        map.insert_scan((0.05, 0.05), points, -points)
        _match_by_score(hill_climb, score, map, points, np.zeros(3))
    turns = np.arange(0.0, 6.0, 0.5)
    ring = np.stack([np.cos(turns), np.sin(turns)], -1)
    match_points(ring, ring)


@lru_cache  # once in each process
def _warm_graph() -> None:
    """The same for a graph: a robot that drives to and fro in a room and closes loops."""
    near = {"old_frames": 1, "new_frames": 1}  # the places are closer than usual
    rules = LoopClosing(min_path=0.3, witnesses=1, span=0.1, strain=1e-9, **near)
    live = LiveMap(LiveGraph(step=0.1, closing=rules), map=QuadtreeMap(free_resolution=0.16))
    angles = np.radians(np.arange(0.5, 360, 4))
    x, y = np.cos(angles), np.sin(angles)
    for at in 0.15 * np.array([0, 1, 2, 3, 2, 1, 0, 1]):
        ranges = np.minimum((3 * np.sign(x) - at) / x, 2 / np.abs(y))
        live.add(LaserScan(ranges, angles, odometry=(at + 0.01, 0, 0)))
    live.finish()


def _match_by_score(
    matcher: Matcher, score: Score, map: QuadtreeMap, points: Array, start: Array
) -> tuple[Array, float]:
    """Pose of a scan, and its score there."""
    try:
        values = prepared_score(score, map, points, start)
    except NothingNear:
        return start, np.nan
    asked = Prepared(values, points, score)
    answer = arrays.call_given(matcher, "matcher", map, points, start, score=asked)
    pose = arrays.pose(answer, "matcher(map, points, start)")  # it may be the user's own
    return pose, float(values(pose[None])[0])
