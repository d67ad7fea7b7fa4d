"""The two greedy matchers of B (4.3): hill climbing, and drawing poses and ranking them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Count, at_least, checked
from ..poses.motions import wrap
from ..quadtree import QuadtreeMap
from ..segments import SegmentMap
from ._field import DistanceField, either_map
from ._scores import scan_and_poses

#: From a map, points and poses to scores, the higher the better; for a SegmentMap `field_score`.
Score = Callable[[Any, ArrayLike, ArrayLike], Array]
#: The six moves of a round, in the order that decides between equals.
MOVES = np.array([(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1)], float)
#: Sizes of the moves, metres and radians: B's literal ones, and those that halve.
MOVE_SIZES = {
    "thesis": [(0.001, np.radians(1.0))],
    "halving": [(0.016 / 2**k, np.radians(1.6) / 2**k) for k in range(5)],
}


def field_score(map: QuadtreeMap | SegmentMap, points: ArrayLike, poses: ArrayLike) -> Array:
    """`distance_score` (B 4.3) looked up in a field, of a SegmentMap too: the matchers' default.

    A matcher transforms the field once, around its start, and asks it for all poses. The field ends
    half a metre around the scan, so a beam that is farther from all walls may score lower than in
    `distance_score`, and one that leaves this window higher. Parameters are those of
    `occupancy_score`; an empty window, or one that is too large, is a ValueError too.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.1)
    >>> tree.insert_scan((0, 0), [(1.05, 0.05)])
    >>> field_score(tree, [(1.05, 0.05)], (0.3, 0, 0)).round(6)
    array([-0.3])
    """
    ends, at = scan_and_poses(points, poses)
    if not ends.size * at.size:
        either_map(map)  # nothing to sum, but an empty map is an error
        return np.zeros(len(at))
    return DistanceField.around(map, ends, at).score(ends, at)


@checked
def hill_climb(
    map: QuadtreeMap | SegmentMap,
    points: ArrayLike,
    start: ArrayLike,
    *,
    score: Score = field_score,
    steps: Literal["thesis", "halving"] = "halving",
    rounds: Annotated[Count, at_least(0)] = 60,
) -> Array:
    """Move by the best of six small moves as long as one improves the score (B 4.3.1).

    Parameters
    ----------
    points : (n, 2) array, metres
        Ends of the beams in the robot's frame.
    start : (3,) array, metres and radians
        The previous pose.
    score : callable
        One of the scores of this package, or any function of map, points and poses.
    steps : "halving" or "thesis"
        16 mm and 1.6 degrees, halved four times when no move improves; or B's 1 mm and 1 degree,
        with which the robot gets lost, since one degree is too coarse.
    rounds : int
        Accepted moves at most.

    Returns
    -------
    (3,) array, metres and radians

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.01)
    >>> walls = [(k / 50 + 0.005, 1.005) for k in range(50)]
    >>> walls += [(1.005, k / 50 + 0.005) for k in range(50)]
    >>> tree.insert_scan((0.2, 0.2), walls)
    >>> hill_climb(tree, walls, (0.03, -0.02, 0.0)).round(2) + 0
    array([0., 0., 0.])
    """
    moves = [MOVES * (length, length, turn) for length, turn in MOVE_SIZES[steps]]
    ends, pose = arrays.points(points), arrays.pose(start, "start")
    values = prepared_score(score, map, ends, pose)
    best = values(pose[None])[0]
    while moves and rounds:
        tried = pose + moves[0]
        scores = values(tried)
        top = int(scores.argmax())
        if scores[top] > best:
            pose, best, rounds = tried[top], scores[top], rounds - 1
        else:
            moves.pop(0)
    return wrap_heading(pose)


@checked
def sample_and_rank(
    map: QuadtreeMap | SegmentMap,
    points: ArrayLike,
    start: ArrayLike,
    *,
    rng: np.random.Generator,
    score: Score = field_score,
    sigma: tuple[float, float] = (0.02, np.radians(2.0)),
) -> Array:
    """Draw poses, keep the best, draw around them ever more closely (B 4.3.2).

    The start and 99 poses drawn around it with twice `sigma`; then three rounds in which the best
    20 stay and 4 are drawn around each with `sigma / round`.

    Parameters
    ----------
    map, points, start, score
        As for `hill_climb`.
    sigma
        Standard deviations of a shift, metres, and of a turn, radians.

    Returns
    -------
    (3,) array, metres and radians
        The best of all, never worse than the start.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.01)
    >>> walls = [(k / 50 + 0.005, 1.005) for k in range(50)]
    >>> walls += [(1.005, k / 50 + 0.005) for k in range(50)]
    >>> tree.insert_scan((0.2, 0.2), walls)
    >>> pose = sample_and_rank(tree, walls, (0.03, -0.02, 0.0), rng=np.random.default_rng(1))
    >>> bool(np.abs(pose).max() < 0.02)
    True
    """
    both = arrays.numbers(sigma, "sigma")
    if both.shape != (2,) or not ((both > 0) & (both <= arrays.LIMIT)).all():
        raise ValueError(f"sigma must be positive, one of metres, one of radians, got {sigma}")
    spread = both[[0, 0, 1]]
    ends, pose = arrays.points(points), arrays.pose(start, "start")
    values = prepared_score(score, map, ends, pose)
    poses = np.concatenate([pose[None], pose + rng.normal(0, 2 * spread, (99, 3))])
    scores = values(poses)
    for step in (1, 2, 3):
        stay = np.argsort(-scores, kind="stable")[:20]
        drawn = np.repeat(poses[stay], 4, axis=0) + rng.normal(0, spread / step, (80, 3))
        poses = np.concatenate([poses[stay], drawn])
        scores = np.concatenate([scores[stay], values(drawn)])
    return wrap_heading(poses[int(np.argmax(scores))])


@dataclass(frozen=True, eq=False)
class Prepared:
    """A score with its `values` of poses for the points `(n, 2)` of one scan."""

    values: Callable[[Array], Array]
    points: Array
    score: Score

    def __call__(self, map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
        """The score at poses `(k, 3)`, metres and radians, of these points or of others."""
        if points is self.points:
            return self.values(scan_and_poses(points, poses)[1])
        return self.score(map, points, poses)


def wrap_heading(pose: Array) -> Array:
    """The pose with its heading in [-pi, pi); one that is there already keeps every bit."""
    turned = pose if -np.pi <= pose[2] < np.pi else (pose[0], pose[1], wrap(pose[2]))
    return np.array(turned)


def prepared_score(
    score: Score, map: QuadtreeMap | SegmentMap, points: Array, start: Array
) -> Callable[[Array], Array]:
    """The score of points `(n, 2)` as a function of poses `(k, 3)` alone, metres and radians.

    A field is transformed once, around where the start `(3,)` puts the points.
    """
    if isinstance(score, Prepared) and points is score.points:
        return score.values
    arrays.function(score, "score", "of map, points and poses, nearest_score say")
    either_map(map, empty=True)
    if score is field_score and len(points):
        return DistanceField.around(map, points, start).scorer(points)

    def call_score(poses: Array) -> Array:
        """What the score says of poses, `(k,)`."""
        scores = arrays.call_given(score, "score", map, points, poses)
        return arrays.row(scores, "score(map, points, poses)", len(poses))

    return call_score
