"""Map and place together: a quadtree from a log without odometry, scan by scan (B 4.3, 6)."""

import time
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..angles import Array
from ..poses import compose, transform
from ..quadtree import QuadtreeMap
from ..quadtree._build import unmet
from ..scans import LaserScan
from ._field import NothingNear
from ._matchers import Score, checked_start, field_score, hill_climb, prepared
from ._scores import checked

#: From a map, points and a start, with a score, to a pose.
Matcher = Callable[..., Array]
#: From a map, points and a start to a pose and its score.
Place = Callable[[QuadtreeMap, Array, Array], tuple[Array, float]]


class Step(NamedTuple):
    """One scan inserted: its pose `(3,)`, metres and radians, its score, the seconds it took."""

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
    free: bool = True,
) -> Iterator[Step]:
    """Match each scan with the map of those before, insert it, and say where it was.

    Nothing is looked at but ranges: no odometry, and no scan ahead, so it serves a live sensor.

    Parameters
    ----------
    log : Log, or any iterable of LaserScan
    matcher : callable
        `hill_climb`, `sample_and_rank` with its generator bound, or any
        `matcher(map, points, start, score=score) -> (3,)`.
    score : callable
    settle : int
        The first scans are inserted unmatched, at the start. B inserts five while the sensor
        stands; while it moves that ruins every matcher.
    map : QuadtreeMap or None
        Where scans go: give one to look at it as it grows.
    start : (3,) array, metres and radians
        Pose of the robot at the first scan.
    free : bool
        Whether beams that met nothing count as free up to the sensor's largest range, where the
        scan knows that.

    Yields
    ------
    Step
        After each scan. A scan stays where the one before was, with NaN for its score, where it is
        one of the first, has no return, or lies so far off that the field about it is empty.

    Raises
    ------
    ValueError
        For a `settle` below 1 or a start that is no pose, at once; naming the scan, where one
        reaches beyond the map's `max_size`.

    Examples
    --------
    >>> from segmap import load
    >>> steps = list(map_scans(load("room")[:5]))
    >>> len(steps), steps[0].pose
    (5, array([0., 0., 0.]))
    """
    if not settle >= 1:
        raise ValueError(f"settle must be at least 1: the first scan has no map, got {settle}")
    pose = checked_start([], start)[1]
    tree = QuadtreeMap() if map is None else map
    return _steps(log, tree, pose, settle, free, partial(_matched, matcher, score))


def _steps(
    log: Iterable[LaserScan], map: QuadtreeMap, pose: Array, settle: int, free: bool, match: Place
) -> Iterator[Step]:
    inserted = 0
    for k, scan in enumerate(log):
        begun, points, value = time.perf_counter(), scan.points(), np.nan
        try:
            if len(points) and inserted >= settle:
                pose, value = match(map, points, pose)
            if len(points):
                sensor = compose(pose, scan.sensor_pose)
                unseen = unmet(scan, sensor) if free else None
                map.insert_scan(sensor[:2], transform(pose, points), unseen)
                inserted += 1
        except ValueError as error:
            raise ValueError(f"scan {k}: {error}") from error
        yield Step(pose.copy(), value, time.perf_counter() - begun)


def _matched(
    matcher: Matcher, score: Score, map: QuadtreeMap, points: Array, start: Array
) -> tuple[Array, float]:
    """Pose of a scan, and its score there."""
    try:
        values = prepared(score, map, points, start)
    except NothingNear:
        return start, np.nan

    def ask(map: QuadtreeMap, ends: ArrayLike, poses: ArrayLike) -> Array:
        return values(checked(ends, poses)[1]) if ends is points else score(map, ends, poses)

    pose = matcher(map, points, start, score=ask)
    return pose, float(values(pose[None])[0])
