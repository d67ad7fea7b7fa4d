"""Beams that see what rides with the robot: its own posts, a cable, a person who walks along."""

from __future__ import annotations

import numpy as np

from ...scans import Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import Steps
from ._changed import with_beams
from ._pairs import (
    LEAST_COMPARISONS,
    NEAR_M,
    RIDES_SHARE,
    SEEN_THROUGH_M,
    columns,
    compare,
    directions_of,
)

#: A range that changes by less is the same.
SAME_RANGE_M = 0.05


def without_body(log: Log, steps: Steps) -> Log:
    """A log without the beams that see what rides with the robot: they are NaN, and it is told.

    A beam that rides has the same range while the robot moves or turns, by its odometry where the
    matched `steps` agree with its way, else by these steps. Walls along which the robot drives keep
    their range too; but their points are seen again from the second scan, where one looks through
    the point at which something that rides was. So a direction is left out where at least 0.7 of 30
    comparisons and more say *same range, and looked through* instead of *another range*: 0.95 to
    1.0 of posts, boxes and persons, 0 of walls; a pane of glass along the drive has 0.75. What is
    beside it is left out too, since half of a beam may see it.

    Where neither odometry nor matches say that the robot moved, nothing is left out.
    """
    directions = directions_of(log)
    if not len(directions):
        return log
    pairs = compare(log, steps, directions)
    near = pairs.seen < NEAR_M
    change = np.abs(pairs.same_beam - np.where(near, pairs.seen, np.nan))
    rides = (pairs.through & (change < SAME_RANGE_M)).sum(0)
    differs = (change > SEEN_THROUGH_M).sum(0)
    body = (rides + differs >= LEAST_COMPARISONS) & (rides >= RIDES_SHARE * (rides + differs))
    if not body.any():
        return log
    wide = body | np.roll(body, 1) | np.roll(body, -1)
    measured = ~np.isnan(pairs.same_beam).all(0)
    count = int((body & measured).sum())
    words = f"{count} of {measured.sum()} beams see the robot itself"
    finding = Finding(Cause.BODY, count, words, "--keep-body keeps them")
    return with_beams(log, (wide[columns(s.angles, directions)] for s in log), np.nan, finding)
