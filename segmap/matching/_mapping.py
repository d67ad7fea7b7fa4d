"""Map and place together: a quadtree from a log without odometry, scan by scan (B 4.3, 6)."""

import time
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..angles import Array
from ..poses import compose, transform
from ..quadtree import QuadtreeMap
from ..scans import LaserScan
from ._matchers import Score, field_score, hill_climb, prepared

#: From a map, points and a start, with a score, to a pose.
Matcher = Callable[..., Array]


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

    Yields
    ------
    Step
        After each scan. The score of a scan inserted unmatched is NaN, as is that of a scan without
        any return, which stays where the one before was.

    Raises
    ------
    ValueError
        Where `settle` is below 1, or a scan reaches beyond the map's `max_size`.

    Examples
    --------
    >>> from segmap import load
    >>> steps = list(map_scans(load("room")[:5]))
    >>> len(steps), steps[0].pose
    (5, array([0., 0., 0.]))
    """
    if not settle >= 1:
        raise ValueError(f"settle must be at least 1: the first scan has no map, got {settle}")
    tree = QuadtreeMap() if map is None else map
    pose, placed = np.array(start, float), 0
    for scan in log:
        begun, points, value = time.perf_counter(), scan.points(), np.nan
        if placed >= settle and len(points):
            values = prepared(score, tree, points, pose)
            pose = matcher(tree, points, pose, score=lambda _, __, poses, ask=values: ask(poses))
            value = float(values(pose[None])[0])
        if len(points):
            sensor = compose(pose, scan.sensor_pose)[:2]
            tree.insert_scan(sensor, transform(pose, points))
            placed += 1
        yield Step(pose, value, time.perf_counter() - begun)
