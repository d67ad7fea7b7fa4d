"""Points of walls to match scans with: by descent from a start, or by search in a window."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array
from ...poses.motions import wrap
from ...scans.causes import Unmatched
from ...threads import computed
from .._result import Match, no_match
from . import _point_kernels as kernels
from . import correlation

# What follows are properties of lasers and of walls, the same for every building.
#: Side of the cells that points are sorted into, metres: about the reach of the last steps.
PARTNER_CELL_M = 0.15
#: Smallest standard deviation, metres, that offsets from a wall are believed to have: a laser's.
FLOOR_M = 0.01
#: Side of the cells of the search, metres: half the reach of the descent that follows.
SEARCH_CELL_M = 0.05
#: Standard deviation of a wall in the cells of the search, metres: a wall between two cells must
#: not escape.
SEARCH_BAND_M = 0.06
#: Maxima over 1, 2, 4, 8 and 16 cells: wider ones bound nothing in a window of half a metre.
LEVELS = 5
#: Points of a scan that are searched with at most.
SEARCH_POINTS = 500
#: Points at most for the descent far from the answer.
DESCENT_POINTS = 250
#: Of poses that score alike, but for rounding, the search keeps the first, in likelihoods.
LEAST_GAIN = 1e-6
#: Offsets of points from their walls are not independent: on a scan the variance of measured errors
#: is this many times the Hessian's (tests/alignment/test_covariances.py).
SCAN_VARIANCE_INFLATION = 1.7
#: On a map, where the poses of its scans err too, the variance is this many times the Hessian's.
MAP_VARIANCE_INFLATION = 2.0
#: A motion that the walls leave free is one along a direction where its shift is at least this
#: share of it, the turn counted as the length by which it moves the scan's points.
ALONG_FREE_SHARE = 0.7
#: A wall faces a motion that moves points on it across it by more than this share (a cosine):
#: normals of a straight wall err by a tenth of a radian.
FACING_COSINE = 0.3
#: At most so many steps are made: most descents take 10 to 20.
MOST_DESCENT_STEPS = 60
#: How far partners are sought at first, metres: more than the search may be wrong by.
FIRST_REACH_M = 0.3
#: How far partners are sought in the end, metres: ten times the noise of a laser.
LAST = 0.12
#: A scan is placed by no fewer points.
LEAST_POINTS = 6
#: Points farther from the robot than this are left out, metres: no laser for buildings reaches so
#: far, and one absurd range or pose would ask for a map of a million cells a side.
FARTHEST_POINT_M = 100.0


class Descent(NamedTuple):
    """Where point-to-line ICP stands: what `point_to_line` writes and returns."""

    pose: Array  # (3,), metres and radians
    rows: Array  # (m, 6): residuals before the last step
    system: Array  # (3, 4): Hessian and gradient
    sigma: float
    near: float
    reach: float
    stride: int
    converged: bool
    partner: NDArray[np.int64]  # (k,): nearest point of the map to each, -1 for none


class PointMap:
    """A point cloud of walls, `(n, 2)`, metres, at least one, to match scans with.

    `viewpoints` says where each point was seen from: then the far side of a thin wall is not taken
    for its near side.
    """

    def __init__(self, points: Array, viewpoints: Array | None = None) -> None:
        x_min, y_min, x_max, y_max = kernels.bounding_box(points)
        size = max(PARTNER_CELL_M, max(x_max - x_min, y_max - y_min) / 2000)
        columns, rows = int((x_max - x_min) / size) + 1, int((y_max - y_min) / size) + 1
        sided = viewpoints is not None
        seen_from = points if viewpoints is None else viewpoints
        first = np.zeros(columns * rows + 2, np.int32)
        room = (np.empty((len(points), 2)), np.empty((len(points), 2)), np.empty_like(seen_from))
        self._grid = kernels.PointGrid(*room, x_min, y_min, size, columns, rows, first, sided)
        kernels.sort_points(self._grid, points, seen_from)

    @property
    def grid(self) -> kernels.PointGrid:
        """The points in cells, with all normals; a descent fits only those that it asks for."""
        for k in np.flatnonzero(np.isinf(self._grid.normals[:, 0])):
            kernels.fit_normal(self._grid, int(k))
        return self._grid

    def register(
        self,
        current: Array,
        start: ArrayLike,
        *,
        reach: float = FIRST_REACH_M,
        last: float = LAST,
        overlap: float = 0.0,
        inflation: float = MAP_VARIANCE_INFLATION,
    ) -> Match:
        """Point-to-line ICP from a start (Censi 2008; A 2.5.1: Lu and Milios 1997).

        Lays the points `(m, 2)` of a scan, in its own frame. Partners are sought within `reach`
        metres at first and `last` in the end; then a share `overlap` of the points must have one.
        """
        if shows_no_place(current):
            words = f"the scan has only {len(current)} points, or they lie in one place"
            return no_match(start, Unmatched.TOO_LITTLE_SEEN, words)
        descent = self.descend(current, start, reach, last, odd_step(len(current), DESCENT_POINTS))
        if len(descent.rows) < LEAST_POINTS:
            words = f"only {len(descent.rows)} points lie near walls"
            return no_match(start, Unmatched.LITTLE_OVERLAP, words, descent.near)
        # points that miss their walls by a tenth of their own extent fix nothing
        extent = _extent(current[descent.rows[:, 5].astype(np.int64)])
        if descent.near < overlap or descent.sigma**2 > kernels.FREE_EIGENVALUE_RATIO * extent**2:
            return no_match(start, Unmatched.LITTLE_OVERLAP, overlap=descent.near)
        # Along a direction that the walls do not fix, the match says nothing: one metre. In a round
        # room it is the heading that they do not fix: that is no direction
        covariance, scratch = np.empty((3, 3)), np.empty((2, 3, 3))
        variance, span = inflation * descent.sigma**2, _rms_range(current)
        x, y, shift = kernels.uncertainty(
            descent.system, variance, span, scratch[0], scratch[1], covariance
        )
        free = None if shift < ALONG_FREE_SHARE else np.array([x, y])
        turns = 0 <= shift < ALONG_FREE_SHARE
        return Match(descent.pose, covariance, True, "", descent.near, free, turns)

    def descend(
        self,
        current: Array,
        start: ArrayLike,
        reach: float,
        last: float,
        stride: int,
        rounds: int = MOST_DESCENT_STEPS,
    ) -> Descent:
        """Some steps of point-to-line ICP, from a start, with every `stride`-th point at first.

        The stride is odd, see `decimate`.

        Points `(m, 2)`, metres; start, (3,) array, metres and radians; reach and last in metres.
        """
        pose, rows = np.array(start, float), np.empty((len(current), 6))
        system, scratch = np.empty((3, 4)), np.empty((2, 3, 3))
        partner = np.full(len(current), -1)
        points, reaches = np.ascontiguousarray(current), (float(reach), float(last))
        sigma, near, used, reach, stride, converged = kernels.point_to_line(
            self._grid, points, pose, *reaches, FLOOR_M, _rms_range(current), stride, rounds,
            partner, rows, system, scratch,
        )  # fmt: skip
        pose[2] = wrap(pose[2])
        return Descent(pose, rows[:used], system, sigma, near, reach, stride, converged, partner)

    def free_motions(self, current: Array, pose: Array) -> Array:
        """Motions `(n, 3)` of a scan's points `(m, 2)` at a pose `(3,)` that no wall faces.

        Along a corridor, or round the middle of a round room: x, y and the turn, metres, that of a
        point at the root mean square distance; unit vectors. A wall faces a motion that moves the
        points on it across it; walls are sought within the reach of the last steps.
        """
        descent = self.descend(current, pose, LAST, LAST, stride=1, rounds=1)
        scale = np.array([1.0, 1.0, 1.0 / _rms_range(current)])
        values, motions = np.linalg.eigh(descent.system[:, :3] * scale * scale[:, None])
        loose = motions.T[values <= kernels.FREE_EIGENVALUE_RATIO * values[-1]]
        across = np.abs((descent.rows[:, :3] * scale) @ loose.T)
        return loose[~(across > FACING_COSINE).any(0)]

    def slide_to(self, current: Array, pose: Array, guess: Array) -> Array:
        """A pose `(3,)` moved along the motions that no wall fixes, to where a guess says."""
        scale = np.array([1.0, 1.0, _rms_range(current)])
        away = (guess - pose) * scale
        away[2] = wrap(guess[2] - pose[2]) * scale[2]
        loose = self.free_motions(current, pose)
        return pose + (loose.T @ (loose @ away)) / scale

    def is_near(self, current: Array, pose: Array, reach: float) -> NDArray[np.bool_]:
        """Which points `(m, 2)` of a scan at a pose `(3,)` have a point within reach, `(m,)`."""
        return self.descend(current, pose, reach, reach, stride=1, rounds=1).partner >= 0

    @computed
    def levels(self) -> correlation.Levels:
        """Likelihoods of cells of `SEARCH_CELL_M`; their maxima over 2, 4, 8 and 16 cells a side.

        (5, rows, columns) array of bytes.
        """
        r = int(np.ceil(2.5 * SEARCH_BAND_M / SEARCH_CELL_M))
        away = np.arange(-r, r + 1) ** 2 * SEARCH_CELL_M**2
        stamp = (255 * np.exp(-(away[:, None] + away) / (2 * SEARCH_BAND_M**2))).astype(np.uint8)
        points, corner = self._grid.points, self.corner
        last = np.array(kernels.bounding_box(points)[2:])
        columns, rows = ((last - corner) / SEARCH_CELL_M).astype(int) + r + 2
        levels = np.zeros((LEVELS, rows, columns), np.uint8)
        correlation.stamp_points(levels[0], points, corner, SEARCH_CELL_M, stamp)
        correlation.fill_maxima(levels.reshape(LEVELS, -1), columns)
        return levels

    @property
    def corner(self) -> Array:
        """Lower left corner of the levels, (2,) array, metres: nothing lies in the widest there.

        The origin is in the middle of a cell: in a mirror the cells are the same.
        """
        margin = 3 * SEARCH_BAND_M + (1 << (LEVELS - 1)) * SEARCH_CELL_M
        corner = np.array([self._grid.x - margin, self._grid.y - margin])
        return (np.rint(corner / SEARCH_CELL_M) - 0.5) * SEARCH_CELL_M

    def search(
        self,
        current: Array,
        start: ArrayLike,
        *,
        reach: float = 0.5,
        turn: float = np.radians(40),
        step: float = np.radians(1.0),
        reach_cost: float = 0.1,
        least: float = 0.0,
    ) -> tuple[Array | None, float]:
        """Best pose of a window about a start, wherever the descent would end (Olson 2009).

        `reach` and `turn` are half sides of the window, `step` lies between headings; cells are
        5 cm. A pose at the window's edge costs `reach_cost`, so that of equals the nearest is
        taken. Returns a pose `(3,)`, None where no mean likelihood exceeds `least`, and its score:
        mean likelihood of the points, 0 to 1, less what its distance costs.
        """
        begin, half = np.array(start, float), int(np.ceil(turn / step))
        radius = max(int(np.ceil(reach / SEARCH_CELL_M)), 1)
        points, side = decimate(current), 2 * radius + 1
        first = begin - (*(self.corner + radius * SEARCH_CELL_M), 0.0)
        full, away = 255.0 * len(points), np.arange(-half, half + 1) / max(half, 1)
        cost = full * reach_cost * away**2, full * reach_cost / radius**2
        window = correlation.lattice(
            self.levels, points, first, step, SEARCH_CELL_M, side, side, *cost
        )
        rows = correlation.best_poses(window, full * least, -LEAST_GAIN, 1).rows
        if not len(rows):
            return None, least
        score, h, i, j = rows[0]
        shift = (i - radius) * SEARCH_CELL_M, (j - radius) * SEARCH_CELL_M, (h - half) * step
        return begin + shift, score / full


def odd_step(count: int, most: int) -> int:
    """Every which of so many points leaves at most so many: an odd number."""
    return -(-count // most) | 1


def decimate(points: Array, most: int = SEARCH_POINTS) -> Array:
    """At most so many, from two, of the points `(m, 2)` of a scan, metres, evenly chosen.

    They are the same whichever end of the scan comes first: those at odd steps can be.
    """
    step = odd_step(len(points), most)
    return points[kernels.first_of(len(points), step) :: step]


def in_range(points: Array) -> Array:
    """Those points of `(n, 2)`, metres, that a laser can have seen from near the origin."""
    near = np.abs(points) < FARTHEST_POINT_M
    return points if near.all() else points[near.all(1)]


def shows_no_place(points: Array) -> bool:
    """Whether points `(m, 2)`, metres, fix no place: too few, or no farther apart than partners.

    A hand before the laser, say: as a whole it lies near any wall.
    """
    return len(points) < LEAST_POINTS or _extent(points) < FIRST_REACH_M


def _extent(points: Array) -> float:
    """Root mean square distance of points `(m, 2)` from their middle, metres."""
    return math.sqrt(float(np.square(points - points.mean(0)).sum()) / len(points))


def _rms_range(current: Array) -> float:
    """Root mean square distance of points `(m, 2)` from the robot, metres."""
    flat = current.ravel()
    return math.sqrt(float(flat @ flat) / len(current)) + 1e-9
