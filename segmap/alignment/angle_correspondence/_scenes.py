"""What angle correspondence looks at: pairs of walls, viewpoints, and values of matches.

The three heuristics of A 3.3.1 choose the pairs. Viewpoints are where the sensor stood.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import arrays
from ...angles import axial_difference
from ...arrays import Array, Metres, Segments, checked
from ...kernels import describe
from ...poses.motions import wrap
from ...segments import MIN_LENGTH, angle, length
from .._walls import wall_covariance
from . import _kernels as kernels

Heuristic = Literal["all", "consecutive", "random", "perpendicular"]


#: Lines that cross at a smaller angle, radians, meet too far away.
LEAST_CROSSING_RAD = np.radians(20)
#: Pairs that are nearer than this to a right angle, radians, are perpendicular.
PERPENDICULAR_RAD = np.radians(8)
#: By noise a segment may begin so much before the one that it follows ends, radians.
OVERTAKEN = np.radians(2)


class Candidate(NamedTuple):
    """A guess of how two sets of segments lie, and what speaks for it.

    Parameters
    ----------
    pose : (3,) array, metres and radians
        Of the current set in the frame of the reference.
    value
        Sum of the match values (A 3.3.1, step 2): the length on which both agree, metres.
    hidden
        Length of wall that one has seen through a wall of the other, metres.
    score
        Value less the penalty for what is hidden; candidates are ranked by it.
    walls
        Segments of one set that found a partner in the other; of both numbers the smaller.
    constraints : (k, 5) array
        For both ends of the common part of each two matched segments: normal, lever of a turn,
        offset left, match value (metres).
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

    def wall_across(self) -> float:
        """Length of matched wall, metres, across the direction that is fixed least."""
        normals, weight = self.constraints[:, :2], self.constraints[:, 4] / 2
        return float(np.linalg.eigvalsh((normals.T * weight) @ normals)[0])

    def covariance(self) -> Array:
        """Covariance `(3, 3)` of the pose from the offsets left."""
        pull = self.constraints[::2, 4]
        return wall_covariance(self.constraints, pull, np.ones(len(pull)))


class Scene(NamedTuple):
    """One set of segments, ready to be matched: about its own middle, `(2,)`, metres."""

    middle: Array
    segments: Array
    pairs: NDArray[np.int64]
    places: Array


def scene(
    value: Segments,
    name: str,
    viewpoint: ArrayLike | None,
    heuristic: Heuristic,
    most: int,
    least: float,
    rng: np.random.Generator,
) -> Scene:
    """Segments of at least `least` metres, the pairs to try and the places that see them.

    Segments `(n, 2, 2)` and places `(k, 2)`, metres, about the middle of the segments. The
    viewpoint, (2,) or (k, 2) array in the frame of the value, is its origin where none is given and
    it looks like one scan seen from there; else it is not known.
    """
    every = arrays.segments(value, name)
    walls = every[length(every) >= max(least, MIN_LENGTH)]
    middle = walls.mean(axis=(0, 1)) if len(walls) else np.zeros(2)
    segments = np.ascontiguousarray(walls - middle)
    pairs = wall_pairs(segments, heuristic, most=most, rng=rng)
    if viewpoint is None:
        viewpoint = np.zeros((int(is_seen_from_origin(walls)), 2))
    stood = f"viewpoints of {name}"
    places = np.atleast_2d(arrays.numbers(viewpoint, stood))
    return Scene(middle, segments, pairs, arrays.points(places, stood) - middle)


def wall_pairs(
    segments: Array, heuristic: Heuristic, *, most: int, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Pairs `(k, 2)` of segments that are not parallel, as a heuristic of A 3.3.1 chooses them.

    Neighbours in the order given ("consecutive"); at most so many drawn by chance ("random") or at
    right angles, those whose shorter segment is longest first ("perpendicular"); or "all" that the
    three choose. Each pair once, lower index first, ascending. Segments `(n, 2, 2)`, metres.
    """
    arrays.one_of(heuristic, "heuristic", get_args(Heuristic))
    first, second = np.triu_indices(len(segments), 1)
    at, sizes = angle(segments), length(segments)
    turn = np.abs(axial_difference(at[first], at[second]))
    shorter = np.minimum(sizes[first], sizes[second])
    crooked = np.flatnonzero(turn > LEAST_CROSSING_RAD)
    square = crooked[turn[crooked] > np.pi / 2 - PERPENDICULAR_RAD]
    chosen = {
        "consecutive": crooked[(second - first)[crooked] == 1],
        "random": rng.permutation(crooked)[:most],
        "perpendicular": square[np.argsort(-shorter[square], kind="stable")[:most]],
    }
    one = chosen.get(heuristic)
    keep = np.unique(np.concatenate(list(chosen.values())) if one is None else one)
    return np.stack([first[keep], second[keep]], -1).astype(np.int64)


def corners(segments: Array, pairs: NDArray[np.int64]) -> Array:
    """Corners `(k, 10)` of pairs `(k, 2)` of segments `(n, 2, 2)`, metres and radians.

    What a row holds is told in `_kernels`.
    """
    p, q = segments[pairs[:, 0]], segments[pairs[:, 1]]
    u, v = p[:, 1] - p[:, 0], q[:, 1] - q[:, 0]
    at = np.arctan2(u[:, 1], u[:, 0])
    turn = (np.arctan2(v[:, 1], v[:, 0]) - at) % np.pi
    first, second = (np.stack([np.cos(a), np.sin(a)], -1) for a in (at, at + turn))
    from_p = q[:, 0] - p[:, 0]
    far = from_p[:, 0] * second[:, 1] - from_p[:, 1] * second[:, 0]
    far = far / (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    meet = p[:, 0] + far[:, None] * first
    ends = [
        np.sort(((s - meet[:, None]) * d[:, None]).sum(-1)) for s, d in ((p, first), (q, second))
    ]
    return np.column_stack([meet, at, turn, *ends, length(p), length(q)])


def is_seen_from_origin(segments: Array) -> bool:
    """Whether segments `(n, 2, 2)`, metres, follow each other counter-clockwise about the origin.

    So do those of a scan in the frame of its sensor. Of scans moved by 3 m hardly any still does.
    """
    bearing = np.arctan2(segments[..., 1], segments[..., 0])
    width = wrap(bearing[:, 1] - bearing[:, 0])
    first = np.where(width > 0, bearing[:, 0], bearing[:, 1])
    start = (first - first[:1]) % (2 * np.pi)
    end = start + np.abs(width)
    follows = np.append(start[1:], 2 * np.pi) > end - OVERTAKEN
    return bool(len(segments)) and bool(follows.all())


@checked
def match_values(
    first: Segments,
    second: Segments,
    *,
    distance: Metres = 0.05,
    far: Metres = 0.10,
    long: Metres = 0.30,
    whole: bool = False,
) -> Array:
    """Length on which each segment of one set agrees with each of another (A 2.7.10, 3.3.1).

    The mean of the length of u that v covers when projected on it, and the reverse; times
    `0.95 ** (D / distance)` where they do not meet; 0 where D exceeds `far`, or where they cross at
    more than 45 degrees and both are longer than `long` (A has no such angle). Both sets lie in one
    frame.

    Parameters
    ----------
    distance
        T_p of A: how near points coincide. 0.05 m is the noise of two sensors and a wall.
    far
        Segments farther apart never match.
    long
        Two segments longer than this never match where they cross at more than 45 degrees.
    whole
        A's D is the smaller directed Hausdorff distance (A 2.39): two looks at one wall are then as
        far apart as the part that only one has seen. The default measures the common part alone.

    Returns
    -------
    (n, m) array, metres

    Examples
    --------
    >>> wall, longer = [[(0, 0), (2, 0)]], [[(1, 0.05), (4, 0.05)]]
    >>> match_values(wall, longer).round(3), match_values(wall, longer, whole=True)
    (array([[0.95]]), array([[0.]]))
    """
    rule = float(distance), float(far), float(long), whole
    s, t = arrays.segments(first, "first"), arrays.segments(second, "second")
    s, t, values = np.array(s, order="C"), np.array(t, order="C"), np.zeros((len(s), len(t)))
    kernels.fill_values(s, describe(s), t, rule, values)
    return values
