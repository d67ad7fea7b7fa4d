"""Pose graph: scans on a local map, loops closed, all poses solved together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..poses import between
from ..scans import Log
from ._closing import Closer
from ._point_map import PointMap
from ._result import Match, check_positive, no_match
from ._runner import Outcome, Trail, alignment_method
from ._walk import Walk, settled

#: Above this share of a scan on the map nobody looks for a better place further away.
SURE = 0.7
#: A place further away has to hold this much more of the scan, and at least this much.
BETTER, FURTHER = 0.1, 0.6
#: After a search the descent moves by less than this, metres and radians; else it slides along.
SLIDE = 0.3, 0.2


@alignment_method
def pose_graph(
    log: Log,
    *,
    step: float = 0.5,
    turn: float = np.radians(30),
    window: float = 0.5,
    wide: float = np.radians(40),
    drift: float = 0.03,
) -> Outcome:
    """Match each scan with a local map, close loops, and solve for all poses together.

    Each scan is searched for about where the odometry puts it (Olson 2009), on a map of the last
    ten key frames, and then moved by point-to-line ICP (Censi 2008): a descent alone would end
    where the odometry, wrong by up to a metre and a radian at a step, leads it. Key frames that
    come back to an old place are searched for there; a loop counts only where two others go round
    the same way. The poses are those that fit all steps and loops best (Grisetti et al. 2010), with
    Cauchy weights. Where the log holds no odometry the robot is thought to move on as it did.

    Parameters
    ----------
    log : Log
        In the order of recording; times do not matter.
    step : float, metres, and turn : float, radians
        A key frame is set where the robot has moved this far from the last one: half a metre, since
        doors and desks hide each other from one pose to the next.
    window : float, metres, and wide : float, radians
        Half sides of the search about the guess; twice this where less than 70 % of a scan lies on
        the map then.
    drift : float
        Share of the way by which the map may have bent since an old place was left: loops are
        sought within 1 m and this share, at most 4 m.

    Returns
    -------
    Alignment
        Poses, (k, 3) array, metres and radians, and the graph: its edges, loops and what it
        rejected. A scan without a match carries the odometry step; what follows is tied to the rest
        again by its loops, wherever it is.

    Raises
    ------
    ValueError
        For thresholds that are not positive.

    Examples
    --------
    >>> from segmap import load
    >>> pose_graph(load("corridor")[:40])
    Alignment(pose_graph: 40 scans, 40 used)
    """
    check_positive(step=step, turn=turn, window=window, wide=wide, drift=drift)
    if len(log) == 0:
        return Trail(log).outcome()
    walk = Walk(log, lambda map, points, guess: searched(map, points, guess, window, wide))
    closer = Closer(walk.frames, drift)
    for scan in range(1, len(log)):
        # 1. The scan on the map of the last key frames
        match = walk.place(scan)
        if walk.far_from_frame(scan, step, turn):
            # 2. A new key frame, and the loops that it closes
            walk.add_frame(scan, match)
            if closer.close(confirmed=match.matched):
                walk.frames.bend()
    # 3. All poses together, without loops that the others contradict
    walk.frames.bend()
    if closer.drop_contradicted():
        walk.frames.bend()
    # 4. Each scan once more, on the map that the loops have straightened
    walk.refine()
    return walk.outcome(tuple(closer.rejected))


def searched(map: PointMap, points: Array, guess: Array, window: float, wide: float) -> Match:
    """Search about a guess and descend from there; in twice the window where little fits.

    Points `(m, 2)`, metres, in the robot's frame; guess, (3,) array, metres and radians, in the
    map's.
    """
    best = no_match(guess, "nothing like it near")
    for factor in (1.0, 2.0):
        start, _ = map.search(points, guess, reach=factor * window, turn=factor * wide)
        match = best if start is None else _steady(start, settled(map, points, start))
        if match.overlap > (0.0 if factor == 1.0 else max(best.overlap + BETTER, FURTHER)):
            best = match
        if best.matched and best.overlap > SURE:
            break
    if not best.matched:
        return no_match(guess, best.reason, best.overlap)
    return best if map.faces(best, points) else _held(best, guess)


def _held(match: Match, guess: Array) -> Match:
    """The match, as far as the guess says along a direction that no wall faces."""
    assert match.free is not None
    along = match.free @ (guess[:2] - match.pose[:2]) * match.free
    return replace(match, pose=match.pose + (*along, 0.0))


def _steady(start: Array, match: Match) -> Match:
    """The match, unless the descent went far from where the search had put the scan."""
    x, y, heading = between(start, match.pose)
    if match.matched and (np.hypot(x, y) > SLIDE[0] or abs(heading) > SLIDE[1]):
        return no_match(start, "it slides over the map", match.overlap)
    return match
