"""Point ICP of a log: each scan on a map of the last key frames, without loops (A 2.5.1)."""

from __future__ import annotations

import numpy as np

from .. import arrays
from ..arrays import Array, Metres, Radians
from ..scans import Log
from ._result import Match, Outcome, alignment_method
from .points import PointMap
from .pose_graph import FrontEnd, Tracking


@alignment_method
def point_icp(
    log: Log,
    *,
    step: Metres = 0.5,
    turn: Radians = np.radians(30),
    reach: Metres = 0.6,
    tracking: Tracking = Tracking(),
) -> Outcome:
    """Lay scan after scan by point-to-line ICP on a map of the last key frames (A 2.5.1).

    It starts where the odometry puts the scan and ends in the nearest minimum: odometry that is
    wrong by more than `reach` at one step leads it into a wrong one, from which it never returns.

    Parameters
    ----------
    log
        In the order of recording; times do not matter.
    step, turn
        A key frame is set where the robot has moved this far from the last one.
    reach
        How far partners are sought at first.
    tracking
        As of `pose_graph`.

    Returns
    -------
    Alignment
        A scan of which too little lies on the map carries the odometry step.

    Examples
    --------
    >>> from segmap import load
    >>> point_icp(load("corridor")[:40])
    Alignment(point_icp: 40 scans, 40 used)
    """
    arrays.instance(tracking, "tracking", Tracking)

    def matcher(map: PointMap, points: Array, guess: Array) -> Match:
        return map.register(points, guess, reach=reach, overlap=tracking.overlap)

    front = FrontEnd(matcher, tracking)
    for scan in log:
        match = front.track(scan)
        if front.needs_frame(step, turn):
            front.add_frame(match)
    return front.outcome()
