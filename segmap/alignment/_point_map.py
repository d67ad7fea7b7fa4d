"""Points of walls, ready to be matched with: by descent from a start, or by search in a window."""

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..angles import wrap
from ..arrays import Array
from . import _points_loops as loops
from . import _search_loops as searching
from ._result import Match, no_match

#: Side of the cells that points are sorted into, metres: about the reach of the last steps.
CELL = 0.15
#: Radius within which a wall's direction is fitted, metres: from ten times the noise of a laser to
#: what holds five beams of half a degree at 25 m.
RADII = 0.12, 1.0
#: Smallest standard deviation, metres, that offsets from a wall are believed to have.
FLOOR = 0.01
#: Cells and stamp of the search, metres: a wall is a band of this standard deviation.
FINE, BAND = 0.05, 0.06
#: Maxima over 1, 2, 4 and 8 cells.
LEVELS = 4
#: Points of a scan and map errors are not independent: measured errors are this many times the
#: Hessian's (simulated rooms and offices, tests/test_match_points.py).
INFLATION = 2.0

#: A motion that the walls leave free is one along a direction where its shift is at least this
#: share of it, the turn counted as the length by which it moves the scan's points.
SHIFT = 0.7

#: A wall faces a direction where its normal leans to it by more than this (cosine): normals of a
#: straight wall err by a tenth of a radian.
FACING = 0.3


class PointMap:
    """A point cloud of walls to match scans with.

    Parameters
    ----------
    points : (n, 2) array, metres
        At least one; order does not matter.
    eyes : (n, 2) array, metres, or None
        Where each was seen from: then the far side of a thin wall is not taken for its near side.
    """

    def __init__(self, points: Array, eyes: Array | None = None) -> None:
        extent = float(np.ptp(points, axis=0).max())
        self.cells = loops.in_cells(np.ascontiguousarray(points), max(CELL, extent / 2000))
        self.normals = loops.normals(self.cells, *RADII, 5)
        if eyes is not None:
            to_eye = eyes[self.cells.order] - self.cells.points
            behind = (self.normals * to_eye).sum(1, keepdims=True) < 0
            self.normals = np.where(behind, -self.normals, self.normals)
            self.cells = self.cells._replace(sided=True)

    def settle(
        self, current: Array, start: ArrayLike, *, reach: float = 0.3, last: float = 0.12
    ) -> Match:
        """Point-to-line ICP from a start (Censi 2008; A 2.5.1, [41]).

        Parameters
        ----------
        current : (m, 2) array, metres
            A scan's points in its own frame.
        start : (3,) array, metres and radians
            Its supposed pose in the map's frame.
        reach, last : float, metres
            How far partners are sought at first and in the end.

        Returns
        -------
        Match
        """
        begin = np.array(start, float)
        if len(current) < 6:
            return no_match(begin, f"the scan has only {len(current)} points")
        span = float(np.sqrt((current**2).sum(1).mean())) + 1e-9
        stride = 1 + len(current) // 250
        pose, hessian, sigma, near, used = loops.point_to_line(
            self.cells, self.normals, current, begin, reach, last, FLOOR, span, stride
        )
        if used < 6:
            return no_match(begin, f"only {used} points lie near walls", near)
        pose[2] = wrap(pose[2])
        covariance, free = _uncertainty(hessian, INFLATION * sigma**2, span)
        return Match(pose, covariance, True, "", near, free)

    def faces(self, match: Match, current: Array, *, reach: float = 0.12) -> bool:
        """Whether a wall under a scan's points `(m, 2)` faces the direction that it leaves free.

        Points in the robot's frame, metres; walls are sought within `reach`, metres.
        """
        if match.free is None:
            return True
        rows, _ = loops.residuals(self.cells, self.normals, current, match.pose, reach, 1)
        return bool((np.abs(rows[:, :2] @ match.free) > FACING).any())

    @cached_property
    def levels(self) -> tuple[searching.Level, ...]:
        """Likelihoods of cells of `FINE` metres, (columns, rows) array of bytes, and their maxima.

        Over 2, 4 and 8 cells a side, arrays of the same shape.
        """
        r = int(np.ceil(2.5 * BAND / FINE))
        away = np.arange(-r, r + 1) ** 2 * FINE**2
        stamp = (255 * np.exp(-(away[:, None] + away) / (2 * BAND**2))).astype(np.uint8)
        columns, rows = ((self.cells.points.max(0) - self._corner) / FINE).astype(int) + r + 1
        levels = [searching.likelihood(self.cells.points, self._corner, columns, rows, FINE, stamp)]
        for k in range(LEVELS - 1):
            levels.append(searching.widened(levels[-1], 1 << k))
        return tuple(levels)

    @property
    def _corner(self) -> Array:
        return np.asarray(self.cells.corner - 3 * BAND - 8 * FINE, np.float64)

    def search(
        self,
        current: Array,
        start: ArrayLike,
        *,
        reach: float = 0.5,
        turn: float = np.radians(40),
        step: float = np.radians(1.0),
        away: float = 0.1,
        least: float = 0.0,
    ) -> tuple[Array | None, float]:
        """Best pose of a window about a start, wherever the descent would end (Olson 2009).

        Parameters
        ----------
        current : (m, 2) array, metres
        start : (3,) array, metres and radians
        reach : float, metres, and turn : float, radians
            Half sides of the window.
        step : float, radians
            Between headings; cells are 5 cm.
        away : float
            What a pose at the window's edge costs, so that of equals the nearest is taken.
        least : float
            A mean likelihood that the best has to exceed.

        Returns
        -------
        pose : (3,) array or None
        score : float
            Mean likelihood of the points, 0 to 1, less what its distance costs.
        """
        begin, k = np.array(start, float), int(np.ceil(turn / step))
        current = current[:: 1 + len(current) // 250]
        headings = np.linspace(-k * step, k * step, 2 * k + 1)
        radius = int(np.ceil(reach / FINE))
        score, h, i, j = searching.search(
            self.levels, self._corner, FINE, current, begin, headings, radius, away, least
        )
        if h < 0:
            return None, score
        return begin + (i * FINE, j * FINE, headings[h]), score


def _uncertainty(hessian: Array, variance: float, span: float) -> tuple[Array, Array | None]:
    """Covariance `(3, 3)`, and the direction `(2,)` that the walls do not fix, if there is one.

    Along such a direction the standard deviation is one metre: the match says nothing of it. In a
    round room it is the heading that they do not fix: that is no direction.
    """
    scale = np.array([1.0, 1.0, 1.0 / span])
    value, vector = np.linalg.eigh(hessian * scale[:, None] * scale)
    fixed = value > loops.FREE * value[2]
    spread = np.where(fixed, variance / np.where(fixed, value, 1.0), 1.0)
    covariance = (vector * spread) @ vector.T * scale[:, None] * scale
    along = vector[:2, ~fixed]
    shift = np.hypot(*along)
    if shift.max(initial=0.0) < SHIFT:
        return covariance, None
    return covariance, along[:, np.argmax(shift)] / shift.max()
