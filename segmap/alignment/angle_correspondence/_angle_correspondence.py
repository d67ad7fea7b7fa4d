"""Angle correspondence (A 2.5.1, 3.3.1): how two scans lie, from their walls alone.

An angle between two walls of one scan is laid on a similar angle of the other; every such guess is
scored by the length of wall on which both scans then agree. No odometry is needed (Amigoni,
Gasparini and Gini 2006).
"""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from ... import arrays
from ...arrays import Array, Count, Metres, Positive, Segments, at_least, at_most, checked
from ...extraction import extract_polylines
from ...kernels import Rule, describe
from ...poses.motions import best_distinct, between, compose, transform
from ...reduction import polyline
from ...scans import Log
from ...scans.causes import Unmatched
from ...segments import SegmentMap, length, point_distance
from .._result import Laid, Match, Outcome, Trail, alignment_method, no_match
from .._walls import constraints
from . import _kernels as kernels
from ._scenes import Candidate, Heuristic, Scene, corners, scene

#: Guesses that are scored.
SCORED_GUESSES = 150
#: At most so many of them, the most valuable ones, are refined.
REFINED_GUESSES = 10
#: Of guesses within this distance and turn, metres and radians, the one with the longest walls is
#: scored.
ALIKE_GUESSES = 0.1, np.radians(3)
#: Candidates within this distance and turn, metres and radians, are one.
ONE_CANDIDATE = 0.3, np.radians(10)
#: Share of the walls that is enough to believe a match.
LEAST_MATCHED_SHARE = 0.40
#: Metres of wall across the others that are enough to believe a match.
LEAST_ACROSS_M = 0.25
#: As many matched walls, or more, are all the evidence that can be asked for.
ENOUGH_WALLS = 4


@checked
def angle_candidates(
    reference_segments: Segments,
    current_segments: Segments,
    *,
    rng: np.random.Generator,
    heuristic: Heuristic = "all",
    distance: Metres = 0.05,
    far: Metres = 0.10,
    long: Metres = 0.30,
    whole: bool = False,
    min_length: Annotated[Metres, at_least(0)] = 0.10,
    most_pairs: Count = 50,
    penalty: Annotated[Positive, at_least(0), at_most(arrays.MOST_COUNTED)] = 4.0,
    viewpoints: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
) -> list[Candidate]:
    """Guesses of how one set of segments lies on another, best first (A 3.3.1, steps 1 and 2).

    Each is refined by least squares on the offsets and angles of the segments that it matches.

    Parameters
    ----------
    reference_segments, current_segments : SegmentMap or (n, 2, 2) array, metres
        In the order of the beams, each in its own frame.
    rng
        Draws the pairs of the heuristic "random".
    heuristic
        Which pairs of segments are tried as corners.
    distance, far, long, whole
        As in `match_values`.
    min_length
        Shorter segments are left out: their direction is noise.
    most_pairs
        Pairs drawn by chance, and perpendicular pairs, of each set.
    penalty
        What a metre of wall that one set has seen through a wall of the other counts, against a
        metre that matches. A looks at what matches alone, which is 0.
    viewpoints : pair of (2,) or (k, 2) array, metres, or None
        Where each set was seen from, in its own frame. None: from the origin if its segments follow
        each other about it as those of a scan do; else it is not known, and nothing counts as
        hidden from there.

    Returns
    -------
    list of Candidate
        At most 10, each at least 0.3 m or 10 degrees from all before it.

    Examples
    --------
    >>> corner = np.array([[(0, 0), (3, 0)], [(0, 0), (0, 2)]])
    >>> angle_candidates(corner, corner + [1, 0], rng=np.random.default_rng(1))[0]
    Candidate(-1 m, 0 m, 0 deg: 5.00 m match, 0.00 m hidden)
    """
    several = isinstance(viewpoints, tuple | list | np.ndarray) and arrays.is_iterable(viewpoints)
    if not several or len(viewpoints) != 2:
        raise ValueError(
            f"viewpoints must be two, each a place or None, got {arrays.brief(viewpoints)}"
        )
    rule = float(distance), float(far), float(long), whole
    both = {"reference_segments": reference_segments, "current_segments": current_segments}
    s, t = (
        scene(segments, name, stood, heuristic, most_pairs, min_length, rng)
        for (name, segments), stood in zip(both.items(), viewpoints, strict=True)
    )
    poses = _refined_poses(s, t, rule)
    value, hidden = np.empty(len(poses)), _hidden_lengths(poses, s, t)
    kernels.pose_values(s.segments, t.segments, poses, rule, value)
    score = value - penalty * hidden
    outside = compose(poses, np.array([*-t.middle, 0.0])) + [*s.middle, 0.0]
    best = best_distinct(poses, score, REFINED_GUESSES, ONE_CANDIDATE)
    columns = outside[best], *np.array([value, hidden, score])[:, best].tolist()
    walls = _wall_constraints(poses[best], s, t, rule)
    return [Candidate(*row, *wall) for *row, wall in zip(*columns, walls, strict=True)]


def _refined_poses(s: Scene, t: Scene, rule: Rule) -> Array:
    """The most valuable distinct poses of scene t in scene s, refined, `(k, 3)`."""
    count = len(s.segments)
    both_ways = np.concatenate([t.pairs, t.pairs[:, ::-1]]) + count
    rows = corners(np.concatenate([s.segments, t.segments]), np.concatenate([s.pairs, both_ways]))
    first, second = rows[: len(s.pairs)], rows[len(s.pairs) :]
    tried = np.empty((1024, 4))
    while (count := kernels.superpose(first, second, tried)) > len(tried):
        tried = np.empty((count, 4))
    tried = tried[:count]
    best = best_distinct(tried, tried[:, 3], SCORED_GUESSES, ALIKE_GUESSES)
    poses, worth = tried[best, :3].copy(), np.empty(len(best))
    kernels.pose_values(s.segments, t.segments, poses, rule, worth)
    poses = poses[best_distinct(poses, worth, REFINED_GUESSES, ONE_CANDIDATE)]
    room = np.empty((2 * len(s.segments) * len(t.segments), 5))
    for pose in poses:
        kernels.refine(s.segments, t.segments, pose, rule, room)
    return poses


def _hidden_lengths(poses: Array, s: Scene, t: Scene) -> Array:
    """Length of wall, (k,) array, metres, that one scene has seen through a wall of the other."""
    lengths, stood = np.zeros(len(poses)), transform(poses, t.places)
    for k, pose in enumerate(poses):
        there = transform(pose, t.segments)
        looks = ((s.places, s.segments, there), (stood[k], there, s.segments))
        for places, segments, walls in looks:
            least = np.inf  # from the best of the places
            for x, y in places:
                least = min(least, kernels.hidden_length(x, y, segments, walls, least))
            lengths[k] += least if len(places) else 0.0
    return lengths


def _wall_constraints(poses: Array, s: Scene, t: Scene, rule: Rule) -> list[tuple[int, Array]]:
    """For each pose how many walls match, and the constraints about where the current frame is."""
    per_pose, described = [], describe(s.segments)
    value = np.empty((len(s.segments), len(t.segments)))
    for pose, (x, y) in zip(poses, transform(poses, -t.middle[None])[:, 0], strict=True):
        there = transform(pose, t.segments)
        kernels.fill_values(s.segments, described, there, rule, value)
        some = value > 0
        rows = np.empty((2 * np.count_nonzero(some), 5))
        constraints(s.segments, described, there, value, rows)
        rows[:, 2] -= rows[:, 1] * x - rows[:, 0] * y
        per_pose.append((int(min(some.any(0).sum(), some.any(1).sum())), rows))
    return per_pose


@checked
def match_angles(
    reference_segments: Segments,
    current_segments: Segments,
    *,
    rng: np.random.Generator,
    least_share: Positive = LEAST_MATCHED_SHARE,
    least_across: Positive = LEAST_ACROSS_M,
    rival: Positive = 0.88,
    **options: Any,
) -> Match:
    """How one scan lies on another, from their walls alone and from any start (A 3.3.1).

    Parameters
    ----------
    reference_segments, current_segments : SegmentMap or (n, 2, 2) array, metres
        In the order of the beams, each in its own frame.
    least_share
        The best candidate must score this share of the shorter set's length where three walls
        match; times 3/2 where only two do, for a corner of two walls is found in any building;
        times 3/4 where four or more do. Of two scans that overlap by half, a good half is matched.
    least_across
        Length of matched wall, metres, that must stand across the direction in which most of it
        runs, lest noise decide the place along a corridor.
    rival
        Where another candidate scores more than this share of the best, nothing is claimed.
    rng, **options
        As in `angle_candidates`.

    Returns
    -------
    Match
        "No match" rather than a bad one.

    Examples
    --------
    >>> walls = [[(0, 0), (3, 0)], [(3, 0), (3, 2)], [(1, 2.5), (0, 2)]]
    >>> match_angles(walls, np.array(walls) + [1, 0], rng=np.random.default_rng(1))
    Match(-1 m, 0 m, 0 deg, overlap 1.00)
    >>> square = [[(0, 0), (2, 0)], [(2, 0), (2, 2)], [(2, 2), (0, 2)], [(0, 2), (0, 0)]]
    >>> match_angles(square, square, rng=np.random.default_rng(1))
    Match(none: another place fits nearly as well)
    """
    both = (reference_segments, current_segments)
    candidates = angle_candidates(*both, rng=rng, **options)
    sizes = [float(length(arrays.segments(segments)).sum()) for segments in both]
    if not candidates:
        words = "no two walls of one stand at an angle that the other has too"
        return no_match(np.zeros(3), Unmatched.NO_PLACE, words)
    best, second = candidates[0], candidates[1].score if len(candidates) > 1 else -np.inf
    if best.score < least_share * min(sizes) * 3 / min(max(best.walls, 1), ENOUGH_WALLS):
        words = "too little of the walls matches"
        return no_match(np.zeros(3), Unmatched.LITTLE_OVERLAP, words)
    if second > rival * best.score:
        return no_match(np.zeros(3), Unmatched.OTHER_PLACE)
    if best.wall_across() < least_across:
        words = "too little wall fixes the motion along the others"
        return no_match(np.zeros(3), Unmatched.FREE_DIRECTION, words)
    return Match(best.pose, best.covariance(), True, overlap=min(1.0, best.value / sizes[1]))


@alignment_method
def angle_correspondence(
    log: Log,
    *,
    rng: np.random.Generator | None = None,
    new_reference: Positive = 0.60,
    grow: bool = False,
    **thresholds: Any,
) -> Outcome:
    """Poses from angle correspondences between scans, without any odometry (A 2.5.1, 3.3.1).

    Each scan is matched to a reference scan, and where they share too little to the scan just
    before it, the next reference: errors add up from reference to reference, not from scan to
    scan. Where nothing matches the log's odometry carries the pose on. With `grow` a scan that has
    left the reference is also laid on the map of all before it, in which chains of segments that
    match are polylines (A 3.3.1, step 3): of the places that fit, the best near what the scans
    alone say, or near the last motion. Only a scan has a place from which it tells what hides what;
    by the map alone, the wrong side of a symmetric room would fit as well.

    Parameters
    ----------
    rng
        Draws pairs of segments; None: a fixed seed, so that equal logs give equal poses.
    new_reference
        Where less than this share of a scan is matched another reference is taken.
    grow
        Lay scans that have left the reference on a map that grows.
    **thresholds
        Handed to `match_angles`.

    Examples
    --------
    >>> from segmap import load
    >>> angle_correspondence(load("room")[:20])
    Alignment(angle_correspondence: 20 scans, 20 used)
    """
    chance, trail = np.random.default_rng(0) if rng is None else rng, Trail(log)
    seen = [(extract_polylines(s.points(), closed=s.whole_turn), s.sensor_pose[:2]) for s in log]
    map = transform(trail.pose(0), seen[0][0]) if grow and seen else None
    reference = newest = 0  # the newest scan that shows walls
    for k in range(1, len(log)):
        row, stays = Laid(trail.guess()), False
        for earlier in dict.fromkeys((reference, newest)):
            sets, stood = zip(seen[earlier], seen[k], strict=True)
            match = match_angles(*sets, rng=chance, viewpoints=stood, **thresholds)
            if match.matched and (earlier == newest or match.overlap >= new_reference):
                row = Laid(compose(trail.pose(earlier), match.pose))
                stays, reference = earlier == reference, earlier
                break
            if not match.matched:
                row = Laid(row.pose, match.unmatched, match.reason)
        if map is not None:
            walls = seen[k][0]
            if not stays:
                sure = row.unmatched is Unmatched.NONE
                place = _on_map(map, walls, row.pose, chance, thresholds, sure=sure)
                row = row if place is None else Laid(place)
            if row.unmatched is Unmatched.NONE:
                map = _grow_map(map, transform(row.pose, walls), thresholds)
        trail.place(*row)
        newest = k if len(seen[k][0]) else newest
    return Outcome(trail.laid)


def _on_map(
    map: Array,
    walls: Array,
    pose: Array,
    rng: np.random.Generator,
    thresholds: dict[str, Any],
    *,
    sure: bool,
) -> Array | None:
    """The best place of a scan on the map near a pose, (3,) array, metres and radians, or None.

    The pose is `known` by scans alone, or it is the last motion that goes on: then the place may be
    farther from it, and must have as much evidence as a match of scans.
    """
    size = float(length(walls).sum())
    rules = {
        "least_share": LEAST_MATCHED_SHARE,
        "least_across": LEAST_ACROSS_M,
        "penalty": 0.0,
    } | thresholds
    share, across = rules.pop("least_share"), rules.pop("least_across")
    rules.pop("rival", None)
    reach = 1.5 * np.hypot(*walls.reshape(-1, 2).T).max(initial=0.0)  # the scan's, and some
    near = map[point_distance(pose[:2], map) <= reach]
    for candidate in angle_candidates(near, walls, rng=rng, **rules):
        x, y, turn = between(pose, candidate.pose)
        distance, angle = ALIKE_GUESSES if sure else ONE_CANDIDATE
        believed = sure or (candidate.value >= share * size and candidate.wall_across() >= across)
        if np.hypot(x, y) < distance and abs(turn) < angle and believed:
            return candidate.pose
    return None


def _grow_map(map: Array, walls: Array, thresholds: dict[str, Any]) -> Array:
    """The map with the walls of one more scan: chains that match become polylines (A 3.3.1)."""
    rule = {name: thresholds[name] for name in ("distance", "far", "long") if name in thresholds}
    both = np.concatenate([map, walls])
    return polyline(SegmentMap(both, np.arange(len(both)) >= len(map)), **rule).segments
