"""Segment ICP (A 2.5.1; Amigoni, Fontana and Garigiola 2006): a scan's segments onto the map's.

A compares with the whole map; here the map is the segments of the last key frames, so that the time
for a scan does not grow and old errors are not repeated.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ... import arrays
from ...arrays import (
    Array,
    Count,
    Metres,
    Positive,
    Radians,
    Segments,
    at_most,
    checked,
    upper_bound_excluded,
)
from ...kernels import ACROSS_WEIGHT, APART_WEIGHT, describe
from ...poses.motions import between, compose, transform
from ...scans import Log
from ...scans.causes import Unmatched
from ...segments import MIN_LENGTH, length
from ...segments import angle as angle_of
from .._result import Match, Outcome, Trail, alignment_method, long_segments, no_match
from .._walls import constraints, wall_covariance
from ._search import Indices, turn_and_shift

#: Segment distance (A 2.7.7) of two parallel walls one metre apart: follows from its weights.
SIDEWAYS = ACROSS_WEIGHT / 2 + APART_WEIGHT
#: A wide search finds other walls too: a second one has this part of its turns and steps.
NARROW_SEARCH_PART = 1 / 16
#: Where a smaller share of the walls lies across a direction, it is free.
FREE_ACROSS_SHARE = 0.02
ONE_DIRECTION = "walls in one direction only: along them the guess was kept"

Acute = Annotated[Radians, upper_bound_excluded(np.pi / 2)]
SomeShare = Annotated[Positive, at_most(1)]


@checked
def match_segments(
    reference: Segments,
    current: Segments,
    start: ArrayLike = (0.0, 0.0, 0.0),
    *,
    angle: Acute = np.radians(15.0),
    distance: Metres = 0.30,
    share: SomeShare = 0.40,
) -> Match:
    """Turn, then shift a scan's segments so that their mean distance from the map's is least.

    Two segments correspond where they lie beside each other, at an angle below `angle` and a
    segment distance (A 2.7.7) below `distance`. With `D'` the mean distance of a segment from all
    that it corresponds to, weighted with their lengths, what is minimised is A's 2.1,
    `(sum D' + N_n distance) / (N_m + N_n)` over the N_m segments with and N_n without a match: over
    turns, then over shifts, the correspondences found anew each time, in steps that become finer.
    *Slip:* 2.1 as printed leaves the penalty outside the bracket.

    Parameters
    ----------
    reference, current : SegmentMap, Reduction or (n, 2, 2) array, metres
        Each in its own frame.
    start : (3,) array, metres and radians
        Guess of the pose of `current` in the frame of `reference`.
    angle
        Segments at a larger angle never correspond (T_theta): 15 degrees is more than odometry goes
        wrong between two scans.
    distance
        Farther ones never correspond (T_D); also the penalty of a segment without a partner. 0.30 m
        lets parallel walls correspond up to 1 m apart. A match that
        moves the scan farther than that, or turns it by more than `angle`, is not believed.
    share
        Part of the length of `current` that must find a partner.

    Returns
    -------
    Match
        `free` is set where all partners run in one direction: along it the start is kept. The
        covariance rests on the noise that the matched walls show.

    Examples
    --------
    >>> room = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)]])
    >>> from segmap.poses import transform
    >>> seen = transform((-1, -1, 0), room)
    >>> match_segments(room, seen, (1.1, 0.9, 0.05))
    Match(1 m, 1 m, 0 deg, overlap 1.00)
    >>> match_segments(room, np.empty((0, 2, 2)))
    Match(none: no segments in the scan)
    """
    both = (arrays.segments(current, "current"), arrays.segments(reference, "reference"))
    ours, theirs = (np.ascontiguousarray(s[length(s) >= MIN_LENGTH]) for s in both)
    guess = arrays.pose(start, "start")
    if not len(ours):
        return no_match(guess, Unmatched.TOO_LITTLE_SEEN, "no segments in the scan")
    if not len(theirs):
        return no_match(guess, Unmatched.NO_REFERENCE, "no segments to match with")
    widths = np.outer((NARROW_SEARCH_PART, 1.0), (angle, distance / SIDEWAYS / 4))
    placed = transform(guess, ours)
    searches = [turn_and_shift(theirs, placed, angle, distance, *width) for width in widths]
    _, motion, ended, pairs = min(searches, key=lambda search: search[0])
    has_partner = np.isin(np.arange(len(ours)), pairs[:, 0])
    overlap = float(length(ours)[has_partner].sum() / length(ours).sum())
    pose = compose(motion, guess)
    if overlap < share:
        words = f"too few segments found a partner: less than {share:.0%}"
        return no_match(guess, Unmatched.LITTLE_OVERLAP, words, overlap)
    if np.hypot(*(pose - guess)[:2]) > distance / SIDEWAYS or abs(motion[2]) > angle:
        words = "farther from the start than segments correspond"
        return no_match(guess, Unmatched.SLIDES, words, overlap)
    normal = angle_of(ended[has_partner]) + np.pi / 2
    n = np.stack([np.cos(normal), np.sin(normal)], -1)
    across, ways = np.linalg.eigh(n.T @ n / len(n))
    free = None if across[0] >= FREE_ACROSS_SHARE else ways[:, 0]
    return Match(pose, _segment_covariance(theirs, ended, pairs, pose), True, "", overlap, free)


def _segment_covariance(reference: Array, current: Array, pairs: Indices, pose: Array) -> Array:
    """Covariance `(3, 3)` of the pose (3,) at which pairs of segments lie together.

    Each wall of the scan pulls alike, however long it is (A's 2.1): the short ones err most.
    """
    r, (i, j) = describe(reference), pairs.T
    along = np.einsum("pkx,px->pk", current[i] - r[j, None, :2], r[j, 2:4])
    shared = np.minimum(along.max(1), r[j, 4]) - np.maximum(along.min(1), -r[j, 4])
    metres = np.zeros((len(reference), len(current)))
    metres[j, i] = np.maximum(shared, 0.0)
    partners, scan = (metres > 0).sum(0), np.nonzero(metres)[1]
    rows = np.empty((2 * len(scan), 5))
    constraints(reference, r, current, metres, rows)
    rows[:, 2] -= rows[:, 1] * pose[0] - rows[:, 0] * pose[1]  # a turn is one about the robot
    return wall_covariance(rows, np.ones(len(scan)), 1 / partners[scan])


@alignment_method
def segment_icp(
    log: Log,
    *,
    angle: Acute = np.radians(15.0),
    distance: Metres = 0.30,
    share: SomeShare = 0.40,
    min_length: Metres = 0.30,
    spacing: Metres = 0.50,
    frames: Count = 10,
    patience: Count = 5,
) -> Outcome:
    """Match each scan with the segments of the last key frames, from its odometry step on.

    Needs odometry steps that are right to within `angle` and about 1 m; without odometry the robot
    is assumed to repeat its last motion. Errors of one match pass on to all later scans: nothing
    here closes a loop.

    Parameters
    ----------
    angle, distance, share
        As in `match_segments`.
    min_length
        Shorter segments are left out: noise decides their direction.
    spacing
        A matched scan so far from the last key frame, or turned by more than `angle`, becomes one.
    frames
        Key frames that make the map: ten half a metre apart average their noise, and turning away
        for a moment loses nothing.
    patience
        After so many scans in a row that match nothing, the map is begun anew where odometry is.

    References
    ----------
    Amigoni, Fontana, Garigiola, "A method for building small-size segment-based maps", DARS 2006.

    Examples
    --------
    >>> from segmap import load
    >>> segment_icp(load("room")[:20])
    Alignment(segment_icp: 20 scans, 20 used)
    """
    trail, lost = Trail(log), 0
    map: list[tuple[Array, Array]] = []  # poses of key frames, and their segments in the map
    for k, scan in enumerate(log):
        seen = long_segments(scan, min_length)
        if k:
            # 1. The scan on the segments of the last key frames
            reference = np.concatenate([np.empty((0, 2, 2)), *(segments for _, segments in map)])
            rule = {"angle": angle, "distance": distance, "share": share}
            match = match_segments(reference, seen, trail.guess(), **rule)
            lost = 0 if match.matched else lost + bool(len(seen))
            if match.matched:
                why = Unmatched.NONE if match.free is None else Unmatched.FREE_DIRECTION
                trail.place(match.pose, why, ONE_DIRECTION if why else "")
            else:
                anew = lost >= patience
                trail.carry(match.unmatched, match.reason + "; the map begins anew" * anew)
                map = [] if anew else map
        # 2. A new key frame, where it lies far enough from the last
        pose = trail.pose()
        if len(seen) and (not map or (k and match.matched)):
            x, y, turn = between(map[-1][0], pose) if map else np.full(3, np.inf)
            if np.hypot(x, y) >= spacing or abs(turn) >= angle:
                map = [*map, (pose, transform(pose, seen))][-frames:]
    return Outcome(trail.laid)
