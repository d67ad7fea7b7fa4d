"""Motions between scans of a log, matched without any help of the odometry.

Each of some scans spread over the log is a map; the scans 1, 2, 4, 8 and 16 after it are searched
for around where it was taken, as if the robot stood, until the robot has moved enough to tell.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ...scans import Log
from ...scans.odometry import Steps
from .._result import Match
from ..points import LEAST_POINTS, PointMap, in_range

#: Scans from which steps are sought, spread evenly over the log.
STARTS = 100
#: Scans from the start to the end of a step, tried one after the other.
STRIDES = (1, 2, 4, 8, 16)
#: Half side of the search, metres.
STEP_SEARCH_M = 0.8
#: Half of the headings that are searched, radians.
STEP_SEARCH_RAD = np.radians(45)
#: A step ends where the robot has moved so far, metres.
STEP_END_M = 0.2
#: A step also ends where the robot has turned by so much, radians.
STEP_END_RAD = np.radians(8)
#: A step counts only where at least this share of the scan lies on the other.
LEAST_STEP_OVERLAP = 0.7


def blind_steps(log: Log) -> Steps:
    """Steps of a log that its scans alone tell; none where no walls fix the motion."""
    starts = np.linspace(0, max(len(log) - 2, 0), STARTS)
    ends, motions = [], []
    for start in np.unique(starts.astype(int))[: len(log) - 1].tolist():
        if (step := _step_from(log, start)) is not None:
            ends.append((start, step[0]))
            motions.append(step[1])
    first, second = np.reshape(ends, (-1, 2)).T.astype(np.int64)
    return Steps(first, second, np.reshape(motions, (-1, 3)))


def _step_from(log: Log, first: int) -> tuple[int, Array] | None:
    """The scan up to which the robot has moved enough, and how; None where no match tells."""
    points, step = in_range(log[first].points()), None
    if len(points) < LEAST_POINTS:
        return None
    map = PointMap(points)
    for second in (first + ahead for ahead in STRIDES if first + ahead < len(log)):
        ends = in_range(log[second].points())
        has_points = len(ends) >= LEAST_POINTS
        match = register_near(map, ends, np.zeros(3)) if has_points else None
        if match is None or match.free is not None or match.turns:
            break
        step = second, match.pose
        if np.hypot(*match.pose[:2]) > STEP_END_M or abs(match.pose[2]) > STEP_END_RAD:
            break
    return step


def register_near(map: PointMap, current: Array, guess: Array) -> Match | None:
    """Where points `(m, 2)` lie on the map, sought around a pose `(3,)`; None where few do."""
    start, _ = map.search(current, guess, reach=STEP_SEARCH_M, turn=STEP_SEARCH_RAD)
    match = None if start is None else map.register(current, start)
    return match if match and match.matched and match.overlap > LEAST_STEP_OVERLAP else None
