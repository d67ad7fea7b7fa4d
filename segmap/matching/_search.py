"""Where a scan lies on a whole map: branch and bound over x, y and heading (Hess et al. 2016)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..alignment.points.correlation import best_poses, lattice
from ..arrays import Array, Count, Share, checked
from ..poses.motions import best_distinct, transform, wrap
from ..quadtree import QuadtreeMap
from ..scans import LaserScan
from ..segments import SegmentMap
from ._field import FAR_AWAY, either_map
from ._likelihoods import TOP, Likelihoods

#: A pose that fits worse is not believed (our choice): right ones have .94, those in a wrong
#: building .5 to .77.
SURE_FIT = 0.85
#: A pose farther from each better one, or turned by more, is a place of its own: metres, radians.
OTHER_PEAK = 0.3, 0.3
#: The mean beam is taken to be so many cells long at least: no headings coarser than 3 degrees.
SHORTEST = 20
#: Ends of beams that lie farther apart count as so far, metres, in what the beams are spread over.
OUTLINE_JUMP_M = 0.3
#: Poses within the margin that are kept at most.
MOST_LEAVES = 2**16
#: Shifts in cells and headings over which the covariance of a pose is taken.
SHIFTS = np.stack(np.meshgrid(*[np.arange(-4, 5)] * 3), -1).reshape(-1, 3)


class Uncertainty(StrEnum):
    """Why it is not known where the robot is; empty where it is. Code asks for these, not words."""

    NONE = ""
    NO_PLACE = "no place explains the scan"
    SEVERAL_PLACES = "several places explain it"
    TOO_MANY_PLACES = "more places explain it than are listed"
    POOR_FIT = "the best place does not fit well"
    LOST = "the robot was found and is lost"


@dataclass(frozen=True, eq=False, repr=False)
class Places:
    """Where on a map a scan may have been taken, the best place first.

    Parameters
    ----------
    poses : (n, 3) array, metres and radians
        Of the robot. None is within 0.3 m and 0.3 radians of a better one.
    scores, fits : (n,) array
        0 to 1; see `search`.
    covariances : (n, 3, 3) array
        Of x, y (metres) and heading (radians) within four cells and headings of each pose: the mean
        over the poses there, each as likely as its beams make it (Olson 2009).
    reason
        Why the first place is not the only one, or not believed; empty where it is.
    nodes
        So many blocks of poses were looked into.
    uncertainty
        The kind of the reason.
    """

    poses: Array
    scores: Array
    fits: Array
    covariances: Array
    reason: str
    nodes: int
    uncertainty: Uncertainty = Uncertainty.NONE

    @property
    def found(self) -> bool:
        """Whether the robot is at the first place: no other explains the scan as well."""
        return self.uncertainty is Uncertainty.NONE

    def __len__(self) -> int:
        return len(self.poses)

    def __repr__(self) -> str:
        if not len(self):
            return f"Places(none: {self.reason})"
        x, y, heading = self.poses[0].round(4) + 0.0
        best = f"{x:.6g} m, {y:.6g} m, {np.degrees(heading):.4g} deg, score {self.scores[0]:.2f}"
        return f"Places({best}{self.reason and f'; {self.reason}'})"


@checked
def search(
    map: QuadtreeMap | SegmentMap,
    scan: LaserScan,
    *,
    least: Share = 0.5,
    margin: Share = 0.05,
    most_places: Count = 6,
    beams: Count = 60,
) -> Places:
    """The best pose of a scan anywhere on a map, and all other places that are nearly as good.

    Every pose on cells of 0.05 m is tried, in headings by which the mean beam moves one cell: in
    blocks, by the most that a pose of a block can score, until none is left that could change the
    answer (Hess et al. 2016). A quadtree's cells are joined up to 0.05 m, and are
    its own where these are larger.

    A score is the mean over the beams of `exp(-d^2 / 2 sigma^2)`, in 255 parts, with the distance d
    to the nearest wall and a sigma of 0.1 m. A fit is the geometric mean of nine tenths of this and
    one tenth: it falls with each beam that nothing explains. Where rooms differ in their furniture
    alone and it has moved, one that looks as another did is found there: 11 of 156 that were found
    in offices with one room in six refurnished. Nothing in one scan tells.

    Parameters
    ----------
    map : QuadtreeMap or SegmentMap
        With half a metre around it, where the robot is.
    least
        What scores less is no place.
    margin
        Places count that score so much less than the best, at most.
    most_places
        There may be more: then so many are told, and none is found.
    beams
        So many of the scan's ends are used, spread evenly along the walls.

    Returns
    -------
    Places
        `found` where one place is left and its fit is 0.85 or more.

    Examples
    --------
    >>> from segmap import load
    >>> from segmap.quadtree import build_map
    >>> log = load("room")
    >>> places = search(build_map(log, log.truth), log[20])
    >>> places.found, bool(np.hypot(*(places.poses[0] - log.truth[20])[:2]) < 0.05)
    (True, True)
    """
    either_map(map)
    points = arrays.instance(scan, "scan", LaserScan).points()
    return distinct_places(Likelihoods(map), points, least, margin, most_places, beams)


def distinct_places(
    map: Likelihoods,
    points: Array,
    least: float = 0.5,
    margin: float = 0.05,
    most_places: int = 6,
    beams: int = 60,
) -> Places:
    """The places of points `(n, 2)`, metres: see `search`."""
    if not len(points):
        none = np.zeros((0, 3)), np.zeros(0), np.zeros(0), np.zeros((0, 3, 3))
        return Places(*none, "no beam of the scan has an end", 0, Uncertainty.NO_PLACE)
    used = sample_beams(np.clip(points, -FAR_AWAY, FAR_AWAY), beams)
    size, step = map.size, _heading_step(map, used)
    headings = np.zeros(round(2 * np.pi / step))
    first = np.array([0.0, 0.0, len(headings) // 2 * step])  # heading 0 is the first of all
    first[:2] = ((1 << TOP) + 0.5) * size
    rows, columns = map.shape
    tried = lattice(map.levels, used, first, step, size, columns, rows, headings)
    full = 255 * len(used)
    asked = int(np.ceil(least * full - 1e-9)), int(margin * full + 1e-9)
    matches = best_poses(tried, *asked, MOST_LEAVES)
    leaves = matches.rows[np.lexsort((*matches.rows.T[:0:-1], -matches.rows[:, 0]))]
    poses = np.empty((len(leaves), 3))
    poses[:, :2] = map.corner + (leaves[:, 2:] + 0.5) * map.size
    poses[:, 2] = wrap(step * leaves[:, 1])
    chosen = best_distinct(poses, leaves[:, 0], most_places + 1, OTHER_PEAK)
    many, chosen = len(chosen), chosen[:most_places]
    fits = map.fits(used, poses[chosen])
    kind, reason = Uncertainty.NONE, ""
    if matches.overflow:
        kind, reason = Uncertainty.TOO_MANY_PLACES, f"it fits at more than {MOST_LEAVES} poses"
    elif not many:
        kind, reason = Uncertainty.NO_PLACE, f"no pose scores {least:.6g}"
    elif many > most_places:
        kind, reason = Uncertainty.TOO_MANY_PLACES, f"more than {most_places} places explain it"
    elif many > 1:
        kind, reason = Uncertainty.SEVERAL_PLACES, f"{many} places explain it"
    elif fits[0] < SURE_FIT:
        kind, reason = Uncertainty.POOR_FIT, f"the best place fits it to {fits[0]:.2f} only"
    spreads = [_leaf_covariance(map, used, poses[k], step) for k in chosen]
    scores, covariances = leaves[chosen, 0] / full, np.reshape(spreads, (-1, 3, 3))
    return Places(poses[chosen], scores, fits, covariances, reason, matches.looked, kind)


def _heading_step(map: Likelihoods, points: Array) -> float:
    """Turn that moves the end of the mean beam by one cell, radians: a whole part of a full one."""
    lengths = np.minimum(np.hypot(*points.T) / map.size, np.hypot(*map.shape))
    return float(2 * np.pi / np.ceil(2 * np.pi * max(lengths.mean(), SHORTEST)))


def _leaf_covariance(map: Likelihoods, points: Array, pose: Array, step: float) -> Array:
    """Covariance `(3, 3)` of the pose of a leaf, metres and radians."""
    away = SHIFTS * np.array([map.size, map.size, step])
    worth = map.likelihood(transform(pose + away, points)).sum(1)
    weight = np.exp(worth - worth.max())
    weight /= weight.sum()
    cell = np.diag([map.size, map.size, step]) ** 2 / 12
    return np.asarray((away.T * weight) @ away + cell)


def sample_beams(points: Array, beams: int) -> Array:
    """At most so many of a scan's ends `(n, 2)`, metres: at equal steps along what they outline.

    Every k-th beam would show the near walls alone. They come in an order in which the first few
    lie all over the scan.
    """
    count = min(len(points), beams)
    way = np.minimum(np.hypot(*np.diff(points, axis=0).T), OUTLINE_JUMP_M)
    along = np.r_[0.0, np.cumsum(way)]
    if count < len(points):
        points = points[np.searchsorted(along, np.linspace(0, along[-1], count))]
    return points[np.argsort(np.arange(count) * 0.618034 % 1)]


def at_one_place(poses: Array, pose: Array, metres: float, turn: float) -> NDArray[np.bool_]:
    """Which poses `(n, 3)` lie no farther than that from one, and turned by no more radians."""
    away = poses - pose
    return (np.hypot(*away.T[:2]) <= metres) & (np.abs(wrap(away[:, 2])) <= turn)
