"""Map and place together: a quadtree from a log without odometry, scan by scan (B 4.3, 6)."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache, partial
from inspect import signature
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array
from ..poses import compose, transform
from ..quadtree import QuadtreeMap, free_ends
from ..scans import LaserScan
from ._field import NothingNear
from ._matchers import (
    Score,
    field_score,
    hill_climb,
    prepared,
    sample_and_rank,
)
from ._scores import descent_score, nearest_score, occupancy_score, scan_and_poses

#: From a map, points and a start, with a score, to a pose.
Matcher = Callable[..., Array]
#: From a map, points and a start to a pose and its score.
Place = Callable[[QuadtreeMap, Array, Array], tuple[Array, float]]
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


class Step(NamedTuple):
    """One scan inserted.

    `pose`, (3,) array, is the robot's in the map, metres and radians; `score` is that of the scan
    there, on the map before it, in the score's unit; `seconds` is what the whole step took.

    Examples
    --------
    >>> next(map_scans([LaserScan([1.0], [0.0])])).pose
    array([0., 0., 0.])
    """

    pose: Array
    score: float
    seconds: float


def map_scans(
    log: Iterable[LaserScan],
    *,
    matcher: Matcher = hill_climb,
    score: Score = field_score,
    settle: int = 1,
    map: QuadtreeMap | None = None,
    start: ArrayLike = (0.0, 0.0, 0.0),
    free: bool = False,
    rng: np.random.Generator | None = None,
) -> Iterator[Step]:
    """Match each scan with the map of the scans before it, insert it, and say where it was.

    It uses ranges alone, no odometry and no scan ahead, so that it also serves a live sensor. What
    is compiled is loaded before the first scan is asked for: the laser is still off then.

    Parameters
    ----------
    log : Log, or any iterable of LaserScan
    matcher : callable
        `hill_climb`, `sample_and_rank`, or any `matcher(map, points, start, score=score) -> (3,)`.
    score : callable
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

    Yields
    ------
    Step
        After each scan. A scan gets the pose of the one before, and NaN for its score, if it is one
        of the first, has no return, or if the map holds nothing near it.

    Raises
    ------
    ValueError
        At once for a `settle` below 1, a start that is no pose, a matcher or score that is no
        function, `sample_and_rank` without a generator. Later it names the scan that is no
        LaserScan, or reaches beyond the map's `max_size`; the map is then as before that scan.

    Examples
    --------
    >>> from segmap import load
    >>> steps = list(map_scans(load("room")[:5]))
    >>> len(steps), steps[0].pose
    (5, array([0., 0., 0.]))
    """
    arrays.function(score, "score", "of map, points and poses, nearest_score say")
    arrays.switch(free, "free")
    first, pose = arrays.whole(settle, "settle"), arrays.pose(start, "start")
    tree = QuadtreeMap() if map is None else arrays.instance(map, "map", QuadtreeMap)
    if not isinstance(log, Iterable):
        raise ValueError(f"log must be a Log, or give scans one by one, got {type(log).__name__}")
    if rng is not None:
        arrays.generator(rng)
    match = partial(_matched, _ready(matcher, rng), score)
    return _steps(log, tree, pose, first, free, match, score)


def _ready(matcher: Matcher, rng: np.random.Generator | None) -> Matcher:
    """The matcher, with the generator where it takes one."""
    arrays.function(matcher, "matcher", "of map, points and start, hill_climb say")
    if matcher is sample_and_rank and rng is None:
        raise ValueError("sample_and_rank draws poses: give rng, numpy.random.default_rng(1) say")
    takes = rng is not None and "rng" in signature(matcher).parameters
    return partial(matcher, rng=rng) if takes else matcher


def _steps(
    log: Iterable[LaserScan],
    map: QuadtreeMap,
    pose: Array,
    settle: int,
    free: bool,
    match: Place,
    score: Score,
) -> Iterator[Step]:
    _warm(score if score in SCORES.values() else field_score)
    inserted = 0
    for k, scan in enumerate(log):
        if not isinstance(scan, LaserScan):
            got = type(scan).__name__
            raise ValueError(f"scan {k}: wanted a LaserScan, as a Log or sensor gives, got {got}")
        begun, points, value = time.perf_counter(), scan.points(), np.nan
        try:
            if len(points) and inserted >= settle:
                pose, value = match(map, points, pose)
            if len(points):
                sensor = compose(pose, scan.sensor_pose)
                unseen = free_ends(scan, sensor) if free else None
                map.insert_scan(sensor[:2], transform(pose, points), unseen)
                inserted += 1
        except ValueError as error:
            raise ValueError(f"scan {k}: {error}") from error
        yield Step(pose.copy(), value, time.perf_counter() - begun)


@lru_cache  # once in each process
def _warm(score: Score) -> None:
    """Load or compile all that a scan needs, before a live sensor is asked for the first one.

    Compiling takes up to a minute, once on a machine, and a robot would go on meanwhile.
    """
    map, points = QuadtreeMap(resolution=0.1, size=1.6, free_resolution=0.2), np.eye(2)
    for _ in range(2):
        map.insert_scan((0.05, 0.05), points, -points)
        _matched(hill_climb, score, map, points, np.zeros(3))


def _matched(
    matcher: Matcher, score: Score, map: QuadtreeMap, points: Array, start: Array
) -> tuple[Array, float]:
    """Pose of a scan, and its score there."""
    try:
        values = prepared(score, map, points, start)
    except NothingNear:
        return start, np.nan

    def ask(map: QuadtreeMap, ends: ArrayLike, poses: ArrayLike) -> Array:
        """The score at poses `(k, 3)`, metres and radians; the prepared one for the same points."""
        return values(scan_and_poses(ends, poses)[1]) if ends is points else score(map, ends, poses)

    pose = matcher(map, points, start, score=ask)
    return pose, float(values(pose[None])[0])
