"""Segment ICP (A 2.5.1; Amigoni, Fontana and Garigiola 2006): a scan's segments onto the map's.

A compares with the whole map; here the map is the segments of the last key frames, so that the time
for a scan does not grow and old errors are not repeated.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ... import arrays
from ...arrays import Array, Segments, slips
from ...kernels import ACROSS, APART
from ...poses import between, compose, transform
from ...scans import Log
from ...segments import MIN_LENGTH, length
from ...segments import angle as angle_of
from .._result import Match, Outcome, Trail, alignment_method, long_segments, no_match
from ._search import SegmentSearch, least_cost

#: Segment distance (A 2.7.7) of two parallel walls one metre apart: follows from its weights.
SIDEWAYS = ACROSS / 2 + APART
#: Information that every match is given, so that a free direction has a finite variance, 1e6 m^2.
NO_INFORMATION = 1e-6

ONE_DIRECTION = "walls in one direction only: along them the guess was kept"


def match_segments(
    reference: Segments,
    current: Segments,
    start: ArrayLike = (0.0, 0.0, 0.0),
    *,
    angle: float = np.radians(15.0),
    distance: float = 0.30,
    share: float = 0.40,
    search: SegmentSearch = SegmentSearch(),
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
    angle : float, radians
        T_theta, below pi/2; 15 degrees is more than odometry goes wrong between two scans.
    distance : float, metres
        T_D, also the penalty: 0.30 m lets parallel walls correspond up to 1 m apart. A match that
        moves the scan farther than that, or turns it by more than `angle`, is not believed.
    share : float
        Part of the length of `current` that must find a partner, in (0, 1].
    search : SegmentSearch

    Returns
    -------
    Match
        `pose` of `current` in the frame of `reference`, metres and radians. `free` is set where all
        partners run in one direction: along it the start is kept.

    Raises
    ------
    ValueError
        For segments that are not finite, thresholds out of range.

    Examples
    --------
    >>> room = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)]])
    >>> seen = transform((-1, -1, 0), room)
    >>> match_segments(room, seen, (1.1, 0.9, 0.05))
    Match(1 m, 1 m, 0 deg, overlap 1.00)
    >>> match_segments(room, np.empty((0, 2, 2)))
    Match(none: no segments in the scan)
    """
    _check(angle, distance, share, search)
    ours, theirs = _with_length(current, "current"), _with_length(reference, "reference")
    guess = arrays.pose(start, "start")
    if not len(ours):
        return no_match(guess, "no segments in the scan")
    if not len(theirs):
        return no_match(guess, "no segments to match with")
    for part in (search.near, 1.0):
        widest = (part * angle, part * distance / SIDEWAYS / 4)
        motion, ended, away = least_cost(
            theirs, transform(guess, ours), angle, distance, *widest, search
        )
        found = np.isfinite(away)
        overlap = float(length(ours)[found].sum() / length(ours).sum())
        if overlap >= search.enough:
            break
    pose = compose(motion, guess)
    if overlap < share:
        return no_match(guess, f"too few segments found a partner: less than {share:.0%}", overlap)
    if np.hypot(*(pose - guess)[:2]) > distance / SIDEWAYS or abs(motion[2]) > angle:
        return no_match(guess, "farther from the start than segments correspond", overlap)
    sigma = max(float(away[found].mean()) / SIDEWAYS, search.sigma)
    covariance, free = _covariance(ended[found], pose, sigma, search.across)
    return Match(pose, covariance, True, "", overlap, free)


def _covariance(
    segments: Array, pose: Array, sigma: float, across: float
) -> tuple[Array, Array | None]:
    """Covariance of a pose that rests on these segments, and the direction that they leave free.

    Each end point fixes the pose across its wall to within `sigma`, metres.
    """
    normal = angle_of(segments) + np.pi / 2
    n = np.stack([np.cos(normal), np.sin(normal)], -1)
    arm = segments - pose[:2]
    swing = n[:, None, 1] * arm[..., 0] - n[:, None, 0] * arm[..., 1]
    rows = np.concatenate([np.column_stack([n, swing[:, k]]) for k in (0, 1)])
    covariance = np.linalg.inv(rows.T @ rows / sigma**2 + NO_INFORMATION * np.eye(3))
    share, ways = np.linalg.eigh(n.T @ n / len(n))
    return covariance, None if share[0] >= across else ways[:, 0]


def _with_length(segments: Segments, name: str) -> Array:
    found = arrays.segments(segments, name)
    return np.ascontiguousarray(found[length(found) >= MIN_LENGTH])


def _check(angle: float, distance: float, share: float, search: SegmentSearch) -> None:
    arrays.instance(search, "search", SegmentSearch)
    arrays.number(angle, "angle", above=0, below=np.pi / 2, unit="radians")
    arrays.positive("metres", distance=distance)
    slips.check_lengths(distance=distance)
    arrays.number(share, "share", above=0, most=1)


@alignment_method
def segment_icp(
    log: Log,
    *,
    angle: float = np.radians(15.0),
    distance: float = 0.30,
    share: float = 0.40,
    min_length: float = 0.30,
    spacing: float = 0.50,
    frames: int = 10,
    patience: int = 5,
    search: SegmentSearch = SegmentSearch(),
) -> Outcome:
    """Match each scan with the segments of the last key frames, from its odometry step on.

    Needs odometry steps that are right to within `angle` and about 1 m; without odometry the robot
    is assumed to repeat its last motion. Errors of one match pass on to all later scans: nothing
    here closes a loop.

    Parameters
    ----------
    log : Log
    angle, distance, share : float, radians; metres; a part of one
        As in `match_segments`.
    min_length : float, metres
        Shorter segments are left out: noise decides their direction.
    spacing : float, metres
        A matched scan so far from the last key frame, or turned by more than `angle`, becomes one.
    frames : int
        Key frames that make the map: ten half a metre apart average their noise, and turning away
        for a moment loses nothing.
    patience : int
        After so many scans in a row that match nothing, the map is begun anew where odometry is.
    search : SegmentSearch

    Returns
    -------
    Alignment
        Poses, (k, 3) array, metres and radians.

    Raises
    ------
    ValueError
        For thresholds out of range.

    References
    ----------
    Amigoni, Fontana, Garigiola, "A method for building small-size segment-based maps", DARS 2006.

    Examples
    --------
    >>> from segmap import load
    >>> segment_icp(load("room")[:20])
    Alignment(segment_icp: 20 scans, 20 used)
    """
    _check(angle, distance, share, search)
    arrays.positive("metres", min_length=min_length, spacing=spacing)
    slips.check_lengths(min_length=min_length, spacing=spacing)
    count = arrays.whole(frames, "frames")
    arrays.whole(patience, "patience")
    trail, map = Trail(log), _LocalMap(spacing, angle, count)
    lost = 0
    for k, scan in enumerate(log):
        segments = long_segments(scan, min_length)
        if k == 0:
            map.add(trail.poses[0], segments)
            continue
        found = match_segments(
            map.segments,
            segments,
            trail.guess(),
            angle=angle,
            distance=distance,
            share=share,
            search=search,
        )
        lost = 0 if found.matched else lost + bool(len(segments))
        if found.matched:
            trail.place(found.pose, "" if found.free is None else ONE_DIRECTION)
        elif lost < patience:
            trail.carry(found.reason)
        else:
            trail.carry(f"{found.reason}; the map begins anew")
            map.frames = []
        if found.matched or not map.frames:
            map.add(trail.poses[-1], segments)
    return trail.outcome()


class _LocalMap:
    """The last key frames: their poses, and their segments in the frame of the map.

    Parameters
    ----------
    spacing : float, metres, and angle : float, radians
        A key frame lies this far from the one before, or is turned by so much.
    count : int
        Key frames that are kept.
    """

    def __init__(self, spacing: float, angle: float, count: int) -> None:
        self.spacing, self.angle, self.count = spacing, angle, count
        self.frames: list[tuple[Array, Array]] = []

    def add(self, pose: Array, segments: Array) -> None:
        """Take a scan in as a key frame where it has segments and lies far enough from the last.

        Pose, (3,) array, metres and radians; segments `(n, 2, 2)`, metres, in the robot's frame.
        """
        step = between(self.frames[-1][0], pose) if self.frames else np.full(3, np.inf)
        far = np.hypot(step[0], step[1]) >= self.spacing or abs(step[2]) >= self.angle
        if len(segments) and far:
            self.frames = [*self.frames, (pose, transform(pose, segments))][-self.count :]

    @property
    def segments(self) -> Array:
        """Segments of all key frames, `(n, 2, 2)`, metres."""
        return np.concatenate([np.empty((0, 2, 2)), *(segments for _, segments in self.frames)])
