"""Guesses of how two sets of segments lie, ranked (A 3.3.1, steps 1 and 2).

An angle between two walls of one set is laid on a similar angle of the other; every such guess is
judged by the length of wall on which both sets then agree.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Segments
from ..poses import compose
from ..segments import MIN_LENGTH, length
from . import _angle_loops as loops
from ._angle_pairs import Heuristic, Scene, scene
from ._result import check_positive

#: Two transforms this near are one and the same guess: metres, radians.
SAME_PLACE, SAME_HEADING = 0.3, np.radians(10)
#: Corners whose angles differ by less, in radians, are similar: a wall of 0.3 m seen with 10 mm of
#: noise leans by 3 degrees. Their walls must cover each other by this share of the shorter.
SIMILAR, COVERED = np.radians(8), 0.3
#: Guesses this near, metres and radians, are judged by the one with the longest walls.
NEAR_PLACE, NEAR_HEADING = 0.1, np.radians(3)
#: Guesses that are judged, and refined, and how often.
TRIED, REFINED, ROUNDS = 150, 10, 4
#: What stands so near to a wall, in metres, does not hide it: noise, and the far end of a corner.
MARGIN = 0.10


class Candidate(NamedTuple):
    """A guess of how two sets of segments lie, and what speaks for it.

    Parameters
    ----------
    pose : (3,) array, metres and radians
        Of the current set in the frame of the reference.
    value : float, metres
        Sum of the match values (A 3.3.1, step 2): the length on which both agree.
    hidden : float, metres
        Length of wall that one has seen through a wall of the other.
    score : float, metres
        The value less the penalty for what is hidden: what candidates are ranked by.
    walls : int
        Segments of one set that found a partner in the other; of both numbers the smaller.
    constraints : (k, 5) array
        What both ends of the common part of two matched segments say of the pose: the normal, the
        lever of a turn, the offset left, the match value (metres).
    """

    pose: Array
    value: float
    hidden: float
    score: float
    walls: int
    constraints: Array

    def __repr__(self) -> str:
        x, y, heading = self.pose.round(3) + 0.0
        turn = float(np.degrees(heading).round(1))
        where = f"{x:g} m, {y:g} m, {turn:g} deg"
        return f"Candidate({where}: {self.value:.2f} m match, {self.hidden:.2f} m hidden)"


def match_values(
    first: Segments,
    second: Segments,
    *,
    distance: float = 0.05,
    far: float = 0.10,
    long: float = 0.30,
    whole: bool = False,
) -> Array:
    """Length that each segment of one set says together with each of another (A 2.7.10, 3.3.1).

    The mean of the length of u that v covers when projected on it, and the reverse; times
    `0.95 ** (D / distance)` where they do not meet; zero where D exceeds `far`, or where they cross
    at more than 45 degrees and both are longer than `long`. (A has no such angle; but two looks at
    one long wall nearly always cross, at next to none.)

    Parameters
    ----------
    first, second : SegmentMap or (n, 2, 2), (m, 2, 2) array, metres, in one frame
    distance : float, metres
        T_p of A: how near points coincide. 0.05 m is the noise of two sensors and a wall.
    far : float, metres
        Segments farther apart never match.
    long : float, metres
    whole : bool
        A's D is the smaller of the two directed Hausdorff distances (A 2.39). Two looks at one wall
        of which each sees another end are then as far apart as the part that only one has seen. The
        default measures the common part alone.

    Returns
    -------
    (n, m) array, metres

    Raises
    ------
    ValueError
        For coordinates or thresholds that are not finite, or thresholds that are not positive.

    Examples
    --------
    >>> wall, longer = [[(0, 0), (2, 0)]], [[(1, 0.05), (4, 0.05)]]
    >>> match_values(wall, longer).round(3), match_values(wall, longer, whole=True)
    (array([[0.95]]), array([[0.]]))
    """
    check_positive(distance=distance, far=far, long=long)
    s, t = arrays.segments(first, "first"), arrays.segments(second, "second")
    has = [np.flatnonzero(length(v) >= MIN_LENGTH) for v in (s, t)]
    found = np.zeros((len(s), len(t)))
    found[np.ix_(*has)] = loops.match_values(s[has[0]], t[has[1]], (distance, far, long, whole))
    return found


def angle_candidates(
    reference_segments: Segments,
    current_segments: Segments,
    *,
    rng: np.random.Generator,
    heuristic: Heuristic = "all",
    distance: float = 0.05,
    far: float = 0.10,
    long: float = 0.30,
    whole: bool = False,
    min_length: float = 0.10,
    most_pairs: int = 50,
    penalty: float = 4.0,
    viewpoints: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
) -> list[Candidate]:
    """Guesses of how one set of segments lies on another, best first (A 3.3.1, steps 1 and 2).

    Each is refined by least squares on the offsets and angles of the segments that it matches.

    Parameters
    ----------
    reference_segments, current_segments : SegmentMap or (n, 2, 2) array, metres
        In the order of the beams, each in its own frame.
    rng : numpy.random.Generator
        Draws the pairs of the heuristic "random".
    heuristic : "all", "consecutive", "random" or "perpendicular"
        Which pairs of segments are tried as corners.
    distance, far, long, whole
        As in `match_values`.
    min_length : float, metres
        Shorter segments are left out: their direction is noise.
    most_pairs : int
        Pairs drawn by chance, and perpendicular pairs, of each set.
    penalty : float
        What a metre of wall that one set has seen through a wall of the other counts, against a
        metre that matches. A looks at what matches alone, which is 0.
    viewpoints : pair of (2,) or (k, 2) array, metres, or None
        Where each set was seen from, in its own frame. None: from the origin, where its segments
        follow each other about it as those of a scan do; else from places with all of them in
        sight.

    Returns
    -------
    list of Candidate
        At most 10, each at least 0.3 m or 10 degrees from all before it.

    Raises
    ------
    ValueError
        For coordinates or thresholds that are not finite, thresholds that are not positive, an
        unknown heuristic.

    Examples
    --------
    >>> corner = np.array([[(0, 0), (3, 0)], [(0, 0), (0, 2)]])
    >>> angle_candidates(corner, corner + [1, 0], rng=np.random.default_rng(1))[0]
    Candidate(-1 m, 0 m, 0 deg: 5.00 m match, 0.00 m hidden)
    """
    check_positive(distance=distance, far=far, long=long, most_pairs=most_pairs)
    if not (min_length >= 0 and penalty >= 0):
        raise ValueError(
            f"min_length and penalty must not be negative, got {min_length} and {penalty}"
        )
    names, sets = ("reference_segments", "current_segments"), (reference_segments, current_segments)
    least = max(float(min_length), MIN_LENGTH)
    s, t = (
        scene(segments, name, seen_from, heuristic, int(most_pairs), least, MARGIN, rng)
        for segments, name, seen_from in zip(sets, names, viewpoints, strict=True)
    )
    rule = (float(distance), float(far), float(long), bool(whole))
    poses = _refined_poses(s, t, rule)
    length_of = loops.weighed(s.segments, s.places, t.segments, t.places, poses, MARGIN, rule)
    score = length_of[:, 0] - penalty * length_of[:, 1]
    best = loops.distinct(poses, score, REFINED, SAME_PLACE, SAME_HEADING)
    outside = compose(poses, (*-t.middle, 0.0)) + [*s.middle, 0.0]
    said = [_said(poses[k], s, t, rule) for k in best]
    rows = zip(outside[best], *length_of[best].T.tolist(), score[best].tolist(), said, strict=True)
    return [Candidate(*row[:-1], *row[-1]) for row in rows]


def _refined_poses(s: Scene, t: Scene, rule: loops.Rule) -> Array:
    """The most valuable distinct poses of scene t in scene s, refined, `(k, 3)`."""
    both_ways = np.concatenate([t.pairs, t.pairs[:, ::-1]])
    first, second = loops.corners(s.segments, s.pairs), loops.corners(t.segments, both_ways)
    tried = loops.superpose(first, second, SIMILAR, COVERED)
    tried = tried[loops.distinct(tried, tried[:, 3], TRIED, NEAR_PLACE, NEAR_HEADING)][:, :3].copy()
    worth = loops.values(s.segments, t.segments, tried, rule)
    best = loops.distinct(tried, worth, REFINED, SAME_PLACE, SAME_HEADING)
    found = [loops.refined(s.segments, t.segments, pose, ROUNDS, rule) for pose in tried[best]]
    return np.array(found).reshape(-1, 3)


def _said(pose: Array, s: Scene, t: Scene, rule: loops.Rule) -> tuple[int, Array]:
    """How many walls match, and what they say, levers taken about where the current frame is."""
    there = loops.moved(t.segments, pose)
    value = loops.match_values(s.segments, there, rule)
    rows = loops.constraints(s.segments, there, value)
    x, y = loops.moved(np.full((1, 2, 2), -t.middle), pose)[0, 0]
    rows[:, 2] -= rows[:, 1] * x - rows[:, 0] * y
    return int(min((value > 0).any(axis).sum() for axis in (0, 1))), rows
