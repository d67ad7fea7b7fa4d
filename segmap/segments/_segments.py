"""Line segments: arrays `(n, 2, 2)` in metres, `segments[i, k]` is end point k of segment i.

A segment has no direction: swapping its end points gives the same segment.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..angles import axial_mean
from ..arrays import Array, Segments
from ..display import Pictured
from ..files import escape, read_npz, write_npz
from ._points import checked_places, clip, copy_points, cut_evenly, take_points

__all__ = [
    "MIN_LENGTH", "SegmentMap", "angle", "cut_evenly", "extreme_projections", "length",
    "main_direction", "midpoint", "point_distance", "take_points",
]  # fmt: skip

#: Below this length, in metres, a segment has no angle.
MIN_LENGTH = 1e-9
#: What a file of a map calls itself, with the version of its layout.
STORED = "segmap map 1"


def length(segments: ArrayLike) -> Array:
    """Lengths of segments `(..., 2, 2)`, metres.

    Examples
    --------
    >>> length([[(0, 0), (3, 4)]])
    array([5.])
    """
    d = _vector(segments)
    return np.hypot(d[..., 0], d[..., 1])


def angle(segments: ArrayLike) -> Array:
    """Angles of the lines through segments, radians in `[0, pi)`; 0 for one without length.

    Examples
    --------
    >>> np.degrees(angle([[(0, 0), (1, 1)], [(0, 0), (1, -1)], [(1, 0), (0, 0)]]))
    array([ 45., 135.,   0.])
    """
    d = _vector(segments)
    angles = np.arctan2(d[..., 1], d[..., 0]) % np.pi
    return np.where(angles == np.pi, 0.0, angles)  # -1e-20 % pi rounds up to pi


def midpoint(segments: ArrayLike) -> Array:
    """Middles of segments `(..., 2, 2)`: points `(..., 2)`, metres.

    Examples
    --------
    >>> midpoint([[(0, 0), (3, 4)]])
    array([[1.5, 2. ]])
    """
    return arrays.with_axes(segments, "segments", 2, 2).mean(axis=-2)


def main_direction(segments: Segments) -> float:
    """Direction along or across which most walls run, radians in `[-pi/4, pi/4)`; 0 for no walls.

    Poses composed with its opposite in front, `compose((0, 0, -direction), poses)`, make a map with
    these walls along x and y. It is the mean of the walls within 5 degrees of the best 5 of a
    quarter turn, so that oblique ones do not turn it, weighted by the cube of their length: so much
    better a long wall with more points tells its direction.

    Examples
    --------
    >>> walls = [[(0, 0), (4, 3)], [(0, 0), (-3, 4)], [(0, 0), (1, 0)]]
    >>> float(np.degrees(main_direction(walls)).round(6))
    36.869898
    """
    walls = arrays.segments(segments, "segments")
    weight, turn = length(walls), angle(walls) % (np.pi / 2)
    degree = np.degrees(turn).astype(np.int64) % 90
    counts = np.bincount(degree, weight, minlength=90)
    best = np.argmax(sum(np.roll(counts, k) for k in range(-2, 3)))
    near = np.abs((np.degrees(turn) - best - 0.5 + 45) % 90 - 45) <= 5
    mean = float(axial_mean(2 * turn[near], weight[near] ** 3)) / 2
    return mean - np.pi / 2 if mean >= np.pi / 4 else mean


def extreme_projections(points: ArrayLike, through: ArrayLike, angle: ArrayLike) -> Array:
    """Segment `(2, 2)` on a line, through a point at an angle, that just spans points `(m, 2)`.

    Examples
    --------
    >>> extreme_projections([(0, 1), (3, -1), (2, 0)], (0, 0), 0.0)
    array([[0., 0.],
           [3., 0.]])
    """
    xy, origin = arrays.points(points), arrays.point(through, "through")
    turn = arrays.number(angle, "angle", unit="radians")
    if not len(xy):
        raise ValueError("points must hold at least one point, got none")
    d = np.array([np.cos(turn), np.sin(turn)])
    u = (xy - origin) @ d
    return origin + np.array([u.min(), u.max()])[:, None] * d


def point_distance(points: ArrayLike, segments: ArrayLike) -> Array:
    """Distances, metres, from points to segments (not to their lines); leading axes broadcast.

    Examples
    --------
    >>> point_distance([(1, 2), (5, 0)], [(0, 0), (2, 0)])
    array([2., 3.])
    """
    p, s = arrays.with_axes(points, "points", 2), arrays.with_axes(segments, "segments", 2, 2)
    x, y = p[..., 0] - s[..., 0, 0], p[..., 1] - s[..., 0, 1]
    dx, dy = s[..., 1, 0] - s[..., 0, 0], s[..., 1, 1] - s[..., 0, 1]
    square = dx * dx + dy * dy
    t = np.clip((x * dx + y * dy) / np.where(square > 0, square, 1.0), 0, 1)
    return np.hypot(x - t * dx, y - t * dy)


@dataclass(frozen=True, eq=False, repr=False)
class SegmentMap(Pictured):
    """Segments of a map, the scan from which each came, and what lies behind them if it was kept.

    Parameters
    ----------
    segments : (n, 2, 2) array, metres
        In the frame of the map.
    scan : (n,) int array or None
        Index of the scan of each segment; None puts all into scan 0.
    points : (p, 2) array, metres, or None
        Points behind the segments, those of segment i are `points[first[i] : first[i + 1]]`.
    first : (n + 1,) int array or None
        Given with `points`: at least two points a segment.
    sensors : (k, 2) array, metres, or None
        Where the sensor was at each scan; NaN for a scan without segments.

    Examples
    --------
    >>> walls = SegmentMap([[(0, 0), (1, 0)], [(0, 1), (0.05, 1)]], scan=[0, 3])
    >>> walls, walls.filtered(), walls[1:]
    (SegmentMap(2 segments of 2 scans), SegmentMap(1 segment of 1 scan), \
SegmentMap(1 segment of 1 scan))
    """

    segments: Array
    scan: NDArray[np.int64]
    points: Array | None
    first: NDArray[np.int64] | None
    sensors: Array | None

    def __init__(
        self,
        segments: Segments,
        scan: ArrayLike | None = None,
        *,
        points: ArrayLike | None = None,
        first: ArrayLike | None = None,
        sensors: ArrayLike | None = None,
    ) -> None:
        array = np.array(arrays.segments(segments))
        index = np.zeros(len(array), np.int64) if scan is None else arrays.indices(scan, "scan")
        if index.shape != (len(array),):
            raise ValueError(
                f"scan must have shape ({len(array)},), one index a segment, got {index.shape}"
            )
        places = None if sensors is None else checked_places(sensors, index)
        values = (array, index, *copy_points(points, first, len(array)), places)
        for field, value in zip(fields(self), values, strict=True):
            if value is not None:
                value.flags.writeable = False
            object.__setattr__(self, field.name, value)

    def filtered(self, min_length: float = 0.10) -> SegmentMap:
        """Keep only the segments `(m, 2, 2)` of at least `min_length` metres (A 6.2.1: 0.10 m)."""
        least = arrays.number(min_length, "min_length", least=0, unit="metres")
        return self[length(self.segments) >= least]

    def cropped(self, left: float, low: float, right: float, high: float) -> SegmentMap:
        """What lies in a rectangle, metres: segments that cross its border are cut there.

        Of points behind them those within are kept, and no segment of fewer than two.

        Examples
        --------
        >>> SegmentMap([[(0, 1), (4, 1)], [(0, 5), (4, 5)]]).cropped(1, 0, 9, 2).segments.tolist()
        [[[1.0, 1.0], [4.0, 1.0]]]
        """
        corner, end = arrays.rectangle(left, low, right, high)
        segments, inside = clip(self.segments, corner, end)
        points, first = self.points, self.first
        if points is not None and first is not None:
            within = ((points >= corner) & (points <= end)).all(1)
            starts = np.append(0, np.cumsum(within))[first]
            inside &= np.diff(starts) >= 2
            points, first = take_points(points[within], starts, np.flatnonzero(inside))
        cut, scan = segments[inside], self.scan[inside]
        return SegmentMap(cut, scan, points=points, first=first, sensors=self.sensors)

    def __getitem__(self, rows: slice | ArrayLike) -> SegmentMap:
        """Some of the segments, by a slice, a mask or indices, with all that lies behind them."""
        arrays.refuse_masked(rows, "the index")
        index = np.arange(len(self))[rows if isinstance(rows, slice) else np.asarray(rows)]
        if index.ndim != 1:
            raise TypeError(f"take a slice, a mask or indices of segments, got {rows!r}")
        points, first = self.points, self.first
        if points is not None and first is not None:
            points, first = take_points(points, first, index)
        segments, scan = self.segments[index], self.scan[index]
        return SegmentMap(segments, scan, points=points, first=first, sensors=self.sensors)

    def by_scan(self) -> Iterator[Array]:
        """Segments `(m, 2, 2)`, metres, of each scan that has some, ascending, input order kept."""
        order = np.argsort(self.scan, kind="stable")
        cuts = np.flatnonzero(np.diff(self.scan[order])) + 1
        return iter(np.split(self.segments[order], cuts) if len(order) else [])

    def save(self, path: str | Path) -> None:
        """Write the map with all that lies behind it as NPZ: whole or not at all.

        Examples
        --------
        >>> import tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     SegmentMap([[(0, 0), (1, 0)]], scan=[3]).save(f"{folder}/it.npz")
        ...     SegmentMap.load(f"{folder}/it.npz").scan
        array([3])
        """
        contents = {field.name: getattr(self, field.name) for field in fields(self)}
        contents = {name: value for name, value in contents.items() if value is not None}
        write_npz(arrays.file(path), STORED, contents)

    @classmethod
    def load(cls, path: str | Path) -> SegmentMap:
        """Read what `save` wrote, bit for bit.

        A file that is damaged, foreign, or unpacks to more than 1 MB and 50 times its size is a
        ValueError.
        """
        contents = read_npz(arrays.file(path), STORED)
        if not {"segments", "scan"} <= set(contents) <= {field.name for field in fields(cls)}:
            raise ValueError(f"{escape(path)}: damaged, it holds {sorted(contents)}")
        try:
            return cls(**contents)
        except ValueError as fault:
            raise ValueError(f"{escape(path)}: damaged, {fault}") from None

    def __len__(self) -> int:
        return len(self.segments)

    def __repr__(self) -> str:
        n, k = len(self), len(np.unique(self.scan))
        behind = "" if self.points is None else f", {len(self.points)} points"
        return f"SegmentMap({n} segment{'s' * (n != 1)} of {k} scan{'s' * (k != 1)}{behind})"


def _vector(segments: ArrayLike) -> Array:
    s = arrays.with_axes(segments, "segments", 2, 2)
    return s[..., 1, :] - s[..., 0, :]
