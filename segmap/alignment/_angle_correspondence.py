"""Angle correspondence (A 2.5.1, 3.3.1, after its [30]): how two scans lie, from their walls alone.

An angle between two walls of one scan is laid on a similar angle of the other; every such guess is
judged by the length of wall on which both scans then agree. No odometry is needed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .. import arrays
from ..arrays import Array, Segments
from ..extraction import extract_polylines
from ..poses import compose
from ..scans import Log
from ..segments import length
from ._angle_candidates import Candidate, angle_candidates
from ._result import Match, check_positive, no_match
from ._runner import Outcome, Trail, alignment_method

#: Least standard deviation of an end point, in metres, that a covariance rests on.
SIGMA = 0.01
#: As many matched walls, or more, are all the evidence that can be asked for.
ENOUGH_WALLS = 4


def match_angles(
    reference_segments: Segments,
    current_segments: Segments,
    *,
    rng: np.random.Generator,
    least_share: float = 0.40,
    least_across: float = 0.25,
    rival: float = 0.88,
    **search: Any,
) -> Match:
    """How one scan lies on another, from their walls alone and from any start (A 3.3.1).

    Parameters
    ----------
    reference_segments, current_segments : SegmentMap or (n, 2, 2) array, metres
        In the order of the beams, each in its own frame.
    rng : numpy.random.Generator
    least_share : float
        The best candidate must score this share of the shorter set's length where three walls
        match; times 3/2 where only two do, for a corner of two walls is found in any building;
        times 3/4 where four or more do. Of two scans that overlap by half, a good half is matched.
    least_across : float, metres
        Length of matched wall that must stand across the direction in which most of it runs, lest
        noise decide the place along a corridor.
    rival : float
        Where another candidate scores more than this share of the best, nothing is claimed.
    **search
        Handed to `angle_candidates`.

    Returns
    -------
    Match
        Pose of the current scan in the frame of the reference; "no match" rather than a bad one.

    Raises
    ------
    ValueError
        As in `angle_candidates`, and where a share is not positive.

    Examples
    --------
    >>> walls = [[(0, 0), (3, 0)], [(3, 0), (3, 2)], [(1, 2.5), (0, 2)]]
    >>> match_angles(walls, np.array(walls) + [1, 0], rng=np.random.default_rng(1))
    Match(-1 m, 0 m, 0 deg, overlap 1.00)
    >>> square = [[(0, 0), (2, 0)], [(2, 0), (2, 2)], [(2, 2), (0, 2)], [(0, 2), (0, 0)]]
    >>> match_angles(square, square, rng=np.random.default_rng(1))
    Match(none: another place fits nearly as well)
    """
    check_positive(least_share=least_share, least_across=least_across, rival=rival)
    found = angle_candidates(reference_segments, current_segments, rng=rng, **search)
    of_reference, of_current = (
        float(length(arrays.segments(given)).sum())
        for given in (reference_segments, current_segments)
    )
    doubt = _doubt(found, least_share * min(of_reference, of_current), least_across, rival)
    if doubt:
        return no_match(np.zeros(3), doubt)
    overlap = min(1.0, found[0].value / of_current)
    return Match(found[0].pose, _covariance(found[0]), True, overlap=overlap)


@alignment_method
def angle_correspondence(
    log: Log,
    *,
    rng: np.random.Generator | None = None,
    new_reference: float = 0.60,
    extract: Callable[..., Array] = extract_polylines,
    **thresholds: Any,
) -> Outcome:
    """Poses from angle correspondences between scans, without any odometry (A 2.5.1, 3.3.1).

    Each scan is matched to a reference scan, and where they share too little to the scan just
    before it, which then is the reference. So errors add up from reference to reference and not
    from scan to scan. (A replaces each chain of matched segments by a polyline and matches with
    that map. A single scan has a place from which it was seen, and so can tell what hides what.)
    Where nothing matches the log's odometry carries the pose on.

    Parameters
    ----------
    log : Log
    rng : numpy.random.Generator or None
        Draws pairs of segments; None: a fixed seed, so that equal logs give equal poses.
    new_reference : float
        Where less than this share of a scan is matched another reference is taken.
    extract : function
        `extract(points) -> (n, 2, 2)` segments of one scan, metres, in the frame of the robot.
    **thresholds
        Handed to `match_angles`.

    Returns
    -------
    Alignment

    Raises
    ------
    ValueError
        As in `match_angles`.

    Examples
    --------
    >>> from segmap import load
    >>> angle_correspondence(load("room")[:20])
    Alignment(angle_correspondence: 20 scans, 20 used)
    """
    check_positive(new_reference=new_reference)
    chance, trail = np.random.default_rng(0) if rng is None else rng, Trail(log)
    seen = [(extract(scan.points()), scan.sensor_pose[:2]) for scan in log]
    reference = 0
    for k in range(1, len(log)):
        for known in dict.fromkeys((reference, k - 1)):
            pair = (seen[known][0], seen[k][0])
            from_where = (seen[known][1], seen[k][1])
            match = match_angles(*pair, rng=chance, viewpoints=from_where, **thresholds)
            if match.matched and (known == k - 1 or match.overlap >= new_reference):
                trail.place(compose(trail.poses[known], match.pose))
                reference = known
                break
        else:
            trail.carry(match.reason)
    return trail.outcome()


def _doubt(found: list[Candidate], least: float, across: float, rival: float) -> str:
    """Why the best of the candidates is not to be believed; empty where it is."""
    if not found:
        return "no two walls of one stand at an angle that the other has too"
    best, second = found[0], found[1].score if len(found) > 1 else -np.inf
    if best.score < least * 3 / min(max(best.walls, 1), ENOUGH_WALLS):
        return "too little of the walls matches"
    if second > rival * best.score:
        return "another place fits nearly as well"
    if _wall_across(best) < across:
        return "too little wall fixes the motion along the others"
    return ""


def _wall_across(candidate: Candidate) -> float:
    """Length of matched wall, metres, across the direction that is fixed least."""
    normals, weight = candidate.constraints[:, :2], candidate.constraints[:, 4] / 2
    return float(np.linalg.eigvalsh((normals.T * weight) @ normals)[0])


def _covariance(candidate: Candidate) -> Array:
    """Covariance of a pose from what is left of the offsets, at least 10 mm each."""
    rows = candidate.constraints
    sigma = max(SIGMA, float(np.sqrt(np.mean(rows[:, 3] ** 2))))
    return np.asarray(sigma**2 * np.linalg.inv(rows[:, :3].T @ rows[:, :3]), float)
