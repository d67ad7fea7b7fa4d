"""From the points of a scan to line segments: distance clusters (A 3.2, 5.1) and polylines (A 6.2).

Points come in the order of the beams. Both methods first cut that order where two neighbours are
at least `gap` apart; a polyline is then split and merged until it follows the points.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from inspect import unwrap
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Count, Gap, Metres, Poses, at_least, checked
from ..poses.motions import transform
from ..progress import each
from ..scans import LaserScan, Log
from ..scans.motion import repeats_place
from ..scans.noise import USUAL_SIGMA_M, SensorNoise, sensor_noise, warn_if_other_sensor
from ..scans.pose_argument import checked_poses, warn_if_empty_map
from ..segments import MIN_LENGTH, SegmentMap
from ..threads import Rows, in_threads
from . import _kernels as kernels
from ._far import without_far_points
from ._kernels import Beams, Runs
from ._lines import fit_total

#: Scans in one piece of work for a thread.
SCANS_PER_BLOCK = 128
#: So much does the tolerance of a point grow with its standard deviation above the usual one: of
#: hundreds of points on a wall one is off by four, and cuts it.
MORE_TOLERANCE = 4.0
#: A tolerance at which no cluster is split, metres.
UNSPLIT_M = 1e300
#: What a segment is longer than has a length, metres.
LEAST_LENGTH_M = float(np.nextafter(MIN_LENGTH, 1))
#: What a sensor adds that nobody names: to check one takes longer than to extract a scan.
USUAL_NOISE = SensorNoise()


@checked
def extract_clusters(
    points: ArrayLike,
    *,
    gap: Gap = 0.30,
    fit: Literal["total", "algebraic"] = "total",
    closed: bool = False,
) -> Array:
    """One segment for each run of points without a gap (A 3.2, 5.1). Corners are not cut.

    Two walls that meet are one run, and get one diagonal that follows neither: a laser that looks
    into the corner of a closed room draws one line through the room. Where that does not do,
    `extract_polylines` cuts corners. A's loop never advances and loses the last cluster; this
    implements its prose.

    Parameters
    ----------
    points : (n, 2) array, metres
        In the order of the beams, any frame.
    gap
        Two neighbours at least this far apart belong to different clusters. 0.30 m is wider than
        the spacing of 1 degree beams on a wall 5 m away, narrower than a door.
    fit
        "total" minimises the squared distances from the line. "algebraic" is A's eq. 3.1-3.3, least
        squares on `a x + b y = 1`: it depends on the origin, and a cluster whose line passes
        through the origin gives no segment.
    closed
        The last point is next to the first; of a scan `LaserScan.whole_turn` tells.

    Returns
    -------
    (k, 2, 2) array, metres
        The extreme projections of each cluster on its line. Clusters of one point, or of points
        that coincide, give none.

    Examples
    --------
    >>> extract_clusters([(0, 1), (0.1, 1), (0.2, 1), (2, 0), (2, 0.2)]).round(6)
    array([[[0. , 1. ],
            [0.2, 1. ]],
    <BLANKLINE>
           [[2. , 0. ],
            [2. , 0.2]]])

    A corner:

    >>> extract_clusters([(0, 1), (0.2, 1), (0.4, 1), (0.4, 0.8), (0.4, 0.6)]).round(2)
    array([[[0.08, 1.08],
            [0.48, 0.68]]])
    """
    return _clusters(_one_scan(points, closed), gap, fit).segments


@checked
def extract_polylines(
    points: ArrayLike,
    *,
    gap: Gap = 0.30,
    tolerance: Metres = 0.03,
    min_points: Annotated[Count, at_least(0)] = 5,
    min_length: Annotated[Metres, at_least(0)] = 0.10,
    closed: bool = False,
    sensor: SensorNoise | None = None,
) -> Array:
    """Split and merge: segments within `tolerance` (A 6.2; Gonzalez-Banos and Latombe 2002).

    Parameters
    ----------
    points : (n, 2) array, metres
        In the order of the beams, any frame.
    gap, closed
        As in `extract_clusters`.
    tolerance
        Largest distance of a point from the chord of its piece, or from the common line of merged
        pieces; from the line fitted last a few points lie farther. 0.03 m is three standard
        deviations of a SICK or Hokuyo; smaller cuts walls at noise, larger rounds corners off.
    min_points, min_length
        Pieces with less, or with one point, are dropped: two or three noisy points say little about
        a direction.
    sensor
        Where three standard deviations of a range are more than the tolerance, they are the
        tolerance of that point; it counts less by the square of that, and gaps beside it are wider
        by as much. The points are then in the frame of the sensor.

    Returns
    -------
    (k, 2, 2) array, metres
        In the order of the beams. The point at a corner belongs to the nearer of the two walls.

    Examples
    --------
    >>> x = np.linspace(0, 1, 11)
    >>> corner = np.concatenate([np.stack([x, 0 * x], 1), np.stack([0 * x + 1, x], 1)])
    >>> extract_polylines(corner).round(6) + 0.0
    array([[[0. , 0. ],
            [0.9, 0. ]],
    <BLANKLINE>
           [[1. , 0. ],
            [1. , 1. ]]])
    """
    scan = _one_scan(points, closed)
    return _polylines(scan, gap, tolerance, min_points, min_length, sensor).segments


@checked
def build_map(
    log: Log,
    poses: Poses,
    *,
    extract: Callable[..., Array] = extract_polylines,
    keep_points: bool = False,
    **thresholds: Any,
) -> SegmentMap:
    """Segments of every scan, carried into one frame; `.scan` is the index of the scan in the log.

    Parameters
    ----------
    poses : (k, 3) array, metres and radians, or Alignment
        Pose of the robot at each scan, such as `log.truth`; a scan with NaN in it is left out.
        Of scans at which the robot stands, and sees the same, the first 20 are drawn.
    extract
        `extract(points, **thresholds) -> (n, 2, 2)`. Those of this package join a wall across the
        seam of a whole turn.
    thresholds
        Of `extract`. The `sensor` of `extract_polylines` is estimated from the log, unless it or a
        tolerance is given. Where it says that noise grows with range, points from afar draw no wall
        that was seen from near.
    keep_points
        Keep the points behind each segment and the place of the sensor at each scan. Only
        `extract_polylines` and `extract_clusters` tell which points those are.

    Examples
    --------
    >>> from segmap.scans import LaserScan
    >>> wall = LaserScan(1 / np.cos(np.radians(range(-30, 31))), np.radians(range(-30, 31)))
    >>> build_map(Log("wall", [wall, wall]), [(0, 0, 0), (5, 0, np.pi / 2)])
    SegmentMap(2 segments of 2 scans)
    >>> build_map(Log("wall", [wall]), [(5, 0, 0)], keep_points=True).sensors
    array([[5., 0.]])
    """
    arrays.function(extract, "extract", "of points")
    rows = checked_poses(log, poses)
    scan_numbers = np.flatnonzero(np.isfinite(rows).all(1) & ~repeats_place(log, rows))
    if extract is extract_polylines and "tolerance" not in thresholds:
        measured = sensor_noise(log)
        sensor = arrays.instance(thresholds.get("sensor") or measured, "sensor", SensorNoise)
        warn_if_other_sensor(sensor, measured)
        thresholds["sensor"] = sensor
    if isinstance(sensor := thresholds.get("sensor"), SensorNoise):
        log = without_far_points(log, rows, scan_numbers, sensor)
    keep = arrays.switch(keep_points, "keep_points")
    if extract in list(_TELLING):  # one of the caller's own may have no hash
        map = _map_of_runs(log, rows, scan_numbers, extract, thresholds, keep)
    elif keep:
        name = getattr(extract, "__name__", extract)
        raise ValueError(
            "extract must be extract_polylines or extract_clusters where keep_points is asked for, "
            f"got {name!r}: it does not tell its points"
        )
    else:
        progress = each(scan_numbers.tolist(), "extracting segments of scan")
        seen = (log[k].points() for k in progress)
        own = [arrays.call_given(extract, "extract", points, **thresholds) for points in seen]
        own = [arrays.segments(part, "extract(points)") for part in own]
        per_scan = [transform(rows[k], part) for k, part in zip(scan_numbers, own, strict=True)]
        scan = np.repeat(scan_numbers, [len(segments) for segments in per_scan])
        map = SegmentMap(np.concatenate([np.empty((0, 2, 2)), *per_scan]), scan)
    warn_if_empty_map(not len(map), log, rows, "without a segment (too few points, or too short)")
    return map


def fit_line(points: ArrayLike) -> tuple[Array, float]:
    """Centre, metres, and angle in `[0, pi)` of the line nearest to points (total least squares).

    Points `(n, 2)`, at least two. Those spread evenly in all directions have no angle: it is then
    arbitrary.

    Examples
    --------
    >>> centre, angle = fit_line([(1, 0), (1, 1), (1, 5)])
    >>> centre.tolist(), float(np.degrees(angle).round(6))
    ([1.0, 2.0], 90.0)
    """
    p = arrays.points(points)
    if len(p) < 2:
        raise ValueError(f"points must hold at least 2 points, got {len(p)}")
    x, y, dx, dy = fit_total(p, np.ones(len(p)), 0, len(p))
    return np.array([x, y]), float(np.arctan2(dy, dx) % np.pi)


def _one_scan(points: ArrayLike, closed: bool) -> Beams:
    """The points of one scan."""
    p = np.array(arrays.points(points))
    return Beams(p, np.array([0, len(p)]), np.array([closed]), np.zeros((1, 2)))


def _beams_of(scans: Sequence[LaserScan], closed: bool) -> Beams:
    """The points of several scans."""
    points = [scan.points() for scan in scans]
    same_beams = {scan.angles.tobytes(): scan for scan in scans}  # few, and asking takes long
    whole = {angles: scan.whole_turn for angles, scan in same_beams.items()}
    rounds = np.array([closed or whole[scan.angles.tobytes()] for scan in scans])
    places = np.array([scan.sensor_pose[:2] for scan in scans])
    first = np.cumsum([0, *map(len, points)])
    return Beams(arrays.points(np.concatenate(points)), first, rounds, places)


def _runs(
    scans: Beams, noise: kernels.Noise, gap: float, least: int, min_length: float, total: bool
) -> Runs:
    """Segments of the scans, of so many points and metres at least."""
    most, counts = len(scans.points) // least + len(scans.closed), np.empty(len(scans.closed), int)
    runs = Runs(np.empty((most, 2, 2)), np.empty((2, most), np.int64), counts)
    kernels.polylines(scans, noise, gap, least, min_length, total, runs)
    count = counts.sum()
    return Runs(runs.segments[:count], runs.ends[:, :count], counts)


def _clusters(scans: Beams, gap: float, fit: Literal["total", "algebraic"]) -> Runs:
    return _runs(scans, (0.0, 0.0, UNSPLIT_M), gap, 2, LEAST_LENGTH_M, fit == "total")


def _polylines(
    scans: Beams,
    gap: float,
    tolerance: float,
    min_points: int,
    min_length: float,
    sensor: SensorNoise | None,
) -> Runs:
    one = USUAL_NOISE if sensor is None else arrays.instance(sensor, "sensor", SensorNoise)
    more, share = one.range_m - USUAL_SIGMA_M, one.range_share
    noise, least = (MORE_TOLERANCE * more, MORE_TOLERANCE * share, tolerance), max(min_points, 2)
    return _runs(scans, noise, gap, least, min_length, True)


#: The extractions that tell the points of each segment.
_TELLING: dict[Callable[..., Array], Callable[..., Runs]] = {
    extract_polylines: _polylines,
    extract_clusters: _clusters,
}


def _map_of_runs(
    log: Log,
    poses: Array,
    numbers: Rows,
    extract: Callable[..., Array],
    thresholds: dict[str, Any],
    keep: bool,
) -> SegmentMap:
    """Segments `(n, 2, 2)`, metres, of scans of known pose; with points and places where asked."""
    arrays.call_given(extract, "extract", np.empty((0, 2)), **thresholds)  # refuses what is wrong
    options = {**(unwrap(extract).__kwdefaults__ or {}), **thresholds}
    closed = options.pop("closed")

    def placed(block: Rows) -> tuple[Array, Rows, Array, Rows]:
        scans = _beams_of([log.scans[k] for k in block], closed)
        segments, (start, stop), counts = _TELLING[extract](scans, **options)
        at, size = np.repeat(block, counts), stop - start
        points = np.empty((0, 2))
        if keep:
            rows = np.arange(size.sum()) + np.repeat(stop - np.cumsum(size), size)
            points = transform(poses[np.repeat(at, size)], scans.points[rows, None])[:, 0]
        return transform(poses[at], segments), at, points, size

    blocks = [numbers[k : k + SCANS_PER_BLOCK] for k in range(0, len(numbers), SCANS_PER_BLOCK)]
    none = np.empty((0, 2, 2)), np.empty(0, np.int64), np.empty((0, 2)), np.empty(0, np.int64)
    per_block = [none, *in_threads(placed, blocks, "extracting segments of each scan")]
    segments, at, points, size = (np.concatenate(parts) for parts in zip(*per_block, strict=True))
    if not keep:
        return SegmentMap(segments, at)
    places = [transform(pose, scan.sensor_pose[:2]) for pose, scan in zip(poses, log, strict=True)]
    first, sensors = np.cumsum([0, *size]), np.reshape(places, (-1, 2))
    return SegmentMap(segments, at, points=points, first=first, sensors=sensors)
