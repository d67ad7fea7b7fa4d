"""What angle correspondence looks at in one set of segments: pairs of walls, and viewpoints.

The three heuristics of A 3.3.1 choose the pairs. Viewpoints are where the sensor may have stood:
all that it saw must be in sight from there.
"""

from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..angles import axial_difference, wrap
from ..arrays import Array, Segments
from ..segments import angle, length, midpoint
from ._sight_loops import hidden

Heuristic = Literal["all", "consecutive", "random", "perpendicular"]

#: Lines nearer to parallel than this, in radians, meet too far away, or nowhere.
LEAST_TURN = np.radians(20)
#: Pairs nearer to a right angle than this, in radians, are perpendicular.
RIGHT = np.radians(8)
#: By noise a segment may begin so much, in radians, before the one that it follows ends.
OVERTAKEN = np.radians(2)
#: Longest segments that places to see from are looked for among, and places kept.
WALLS, PLACES = 8, 3


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
    margin: float,
    rng: np.random.Generator,
) -> Scene:
    """Segments of at least `least` metres, the pairs to try and the places that see them.

    Segments `(n, 2, 2)` and places `(k, 2)`, metres, about the middle of the segments. The
    viewpoint, (2,) or (k, 2) array in the frame of the value, is its origin where none is given and
    it looks like one scan seen from there; else places from which none of them hides another.
    """
    given = arrays.segments(value, name)
    kept = given[length(given) >= least]
    middle = kept.mean(axis=(0, 1)) if len(kept) else np.zeros(2)
    segments = np.ascontiguousarray(kept - middle)
    pairs = wall_pairs(segments, heuristic, most=most, rng=rng)
    if viewpoint is None and not is_seen_from_origin(kept):
        return Scene(middle, segments, pairs, viewpoints(segments, margin=margin))
    places = np.atleast_2d(np.asarray((0, 0) if viewpoint is None else viewpoint, float))
    if places.ndim != 2 or places.shape[1] != 2 or not np.isfinite(places).all():
        raise ValueError(f"viewpoint of {name} must be (2,) or (k, 2), finite, got {viewpoint!r}")
    return Scene(middle, segments, pairs, places - middle)


def wall_pairs(
    segments: Array, heuristic: Heuristic, *, most: int, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Pairs of segments that are not parallel, as a heuristic of A 3.3.1 chooses them.

    Parameters
    ----------
    segments : (n, 2, 2) array, metres
    heuristic : "all", "consecutive", "random" or "perpendicular"
        Neighbours in the order given; drawn by chance; at right angles, those whose shorter segment
        is longest first; or all that the three choose.
    most : int
        Pairs drawn, and perpendicular ones kept.
    rng : numpy.random.Generator

    Returns
    -------
    (k, 2) int array
        Each pair once, lower index first, ascending.
    """
    if heuristic not in get_args(Heuristic):
        raise ValueError(f"heuristic must be one of {get_args(Heuristic)}, got {heuristic!r}")
    first, second = np.triu_indices(len(segments), 1)
    at, sizes = angle(segments), length(segments)
    turn = np.abs(axial_difference(at[first], at[second]))
    shorter = np.minimum(sizes[first], sizes[second])
    crooked = np.flatnonzero(turn > LEAST_TURN)
    square = crooked[turn[crooked] > np.pi / 2 - RIGHT]
    chosen = {
        "consecutive": crooked[(second - first)[crooked] == 1],
        "random": rng.permutation(crooked)[:most],
        "perpendicular": square[np.argsort(-shorter[square], kind="stable")[:most]],
    }
    one = chosen.get(heuristic)
    keep = np.unique(np.concatenate(list(chosen.values())) if one is None else one)
    return np.stack([first[keep], second[keep]], -1).astype(np.int64)


def is_seen_from_origin(segments: Array) -> bool:
    """Whether segments follow each other counter-clockwise about the origin, none before another.

    So do those of a scan in the frame of its sensor. Of scans moved by 3 m hardly any still does.

    Parameters
    ----------
    segments : (n, 2, 2) array, metres
    """
    bearing = np.arctan2(segments[..., 1], segments[..., 0])
    width = wrap(bearing[:, 1] - bearing[:, 0])
    first = np.where(width > 0, bearing[:, 0], bearing[:, 1])
    start = (first - first[:1]) % (2 * np.pi)
    end = start + np.abs(width)
    follows = np.append(start[1:], 2 * np.pi) > end - OVERTAKEN
    return bool(len(segments)) and bool(follows.all())


def viewpoints(segments: Array, *, margin: float) -> Array:
    """Places from which no segment hides another, as far from each other as can be.

    Whoever sees a wall whole has nothing before it. So where the sensor stood all segments of its
    scan are in sight; and a place from which they all are is nearly as good as where it stood.

    Parameters
    ----------
    segments : (n, 2, 2) array, metres
    margin : float, metres
        What stands so near to a wall does not hide it.

    Returns
    -------
    (k, 2) array, metres, k <= 3
    """
    tried = _possible_places(segments)
    if not len(tried):
        return tried
    slack = 0.02 * float(length(segments).sum())
    lost, least = np.empty(len(tried)), np.inf
    for k, (x, y) in enumerate(tried):
        lost[k] = hidden(x, y, segments, segments, margin, least + slack)
        least = min(least, lost[k])
    return _spread(tried[lost <= least + slack])


def _possible_places(segments: Array) -> Array:
    """Half way between walls, and before and behind each: `(k, 2)`, metres."""
    walls = segments[np.argsort(-length(segments), kind="stable")[:WALLS]]
    middles, along = midpoint(walls), walls[:, 1] - walls[:, 0]
    normals = np.stack([-along[:, 1], along[:, 0]], -1) / length(walls)[:, None]
    first, second = np.triu_indices(len(walls), 1)
    off = [middles + step * normals for step in (-2.0, -1.0, -0.5, 0.5, 1.0, 2.0)]
    return np.concatenate([(middles[first] + middles[second]) / 2, *off])


def _spread(places: Array) -> Array:
    """The place nearest to the mean of all, then always the one farthest from those chosen."""
    nearest = np.hypot(*(places - places.mean(0)).T)
    chosen = [int(np.argmin(nearest))]
    while len(chosen) < min(PLACES, len(places)):
        apart = np.hypot(*(places[:, None] - places[chosen]).T).min(0)
        chosen.append(int(np.argmax(apart)))
    return places[chosen]
