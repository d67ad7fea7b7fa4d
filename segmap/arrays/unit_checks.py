"""Slips of units, one rule each: millimetres where metres are wanted, degrees where radians are.

What can mean nothing else is refused; what a strange but possible log may hold is warned of.
"""

from __future__ import annotations

import inspect
import warnings

import numpy as np

from ._tables import Array, numbers

#: No sensor counts its directions beyond two turns, radians.
MOST_ANGLE = 4 * np.pi
#: No laser for buildings reaches so far, metres.
FARTHEST_RANGE_M = 1000.0
#: Half of a scan is beyond this in no building, metres: by itself it is no proof.
HALF_RANGE_M = 100.0
#: The numbers that sensors send where nothing is met, from the first to the last.
NOTHING_MET_NUMBERS = (65_533.0, 65_535.0)
#: A turn between two scans, radians, that says something about the unit.
LEAST_TELLING_TURN_RAD = 0.1
#: Share of such turns beyond pi: 0 in radians, wound up or not, at least 0.13 in degrees, on all
#: logs that we have (thinned to every tenth scan: at most 0.03 in radians).
BEYOND_PI_SHARE = 0.05
#: And so many of them at least.
LEAST_TURNS_BEYOND_PI = 3
#: No wall is matched over a longer distance, metres.
MOST_MATCH_DISTANCE_M = 10.0
#: No longer gap between neighbours is asked for, metres.
MOST_GAP_M = 100.0
#: Share of the size of a map that is long for a threshold.
LONG_THRESHOLD_SHARE = 0.05
#: Ten times the usual bandwidth of directions, radians a metre.
MOST_BANDWIDTH = 10.0


def check_angles(angles: Array, name: str) -> None:
    """Refuse directions, radians, beyond two turns: they are degrees."""
    most = np.abs(angles).max(initial=0.0)
    if most > MOST_ANGLE:
        raise ValueError(
            f"{name} must be in radians, within 4 pi, got {most:.6g}: "
            "this looks like degrees, np.radians"
        )


def check_ranges(ranges: Array, max_range: float) -> None:
    """Warn of ranges that are not in metres, and of numbers that stand for nothing met.

    Three and more are needed. In another unit is a scan whose median is above a kilometre, or above
    100 m and beyond `max_range`; the largest of all does not count where it is beyond `max_range`:
    a sensor's word for nothing.
    """
    if not (ranges > HALF_RANGE_M).any():
        return
    readings = ranges[np.isfinite(ranges) & (ranges > 0)]
    words = (readings >= NOTHING_MET_NUMBERS[0]) & (readings <= NOTHING_MET_NUMBERS[1])
    if (words & (readings < max_range)).sum() >= LEAST_TURNS_BEYOND_PI:
        least = f"{readings[words].min():.6g}"
        warn(f"ranges of {least} m mean that nothing was met: write np.inf, or a max_range below")
    readings = readings[~words]
    readings = readings[(readings < max_range) | (readings < readings.max(initial=0.0))]
    if len(readings) < LEAST_TURNS_BEYOND_PI:
        return
    half = float(np.median(readings))
    if half > FARTHEST_RANGE_M:
        warn("half of the ranges are above 1000 m: these look like millimetres, ranges / 1000")
    elif half > HALF_RANGE_M and half >= max_range:
        warn(
            "half of the ranges are above 100 m and beyond max_range: these look like millimetres, "
            "ranges / 1000, or centimetres, ranges / 100"
        )


def check_headings(poses: Array, name: str) -> None:
    """Warn of a path `(k, 3)` whose headings are degrees.

    They go beyond two turns, as headings that wind up do; but those turn by less than half a turn
    from scan to scan, and are no multiples of 15 degrees. Where scans lie so far apart that they
    turn by more, a robot that drives where it looks tells. One damaged line is no path in degrees.
    """
    heading = poses[:, 2]
    far = np.abs(heading) > MOST_ANGLE
    if not far.any():
        return
    jumps = np.abs(np.diff(heading))
    turns = jumps[jumps > LEAST_TELLING_TURN_RAD]
    leaps = (turns > np.pi).sum() >= max(BEYOND_PI_SHARE * len(turns), LEAST_TURNS_BEYOND_PI)
    even = (heading[far] % 15 == 0).all() and np.abs(heading[far]).max() <= 720
    as_degrees, as_radians = _agree(poses, np.pi / 180), _agree(poses, 1.0)
    if even or (leaps and as_degrees >= as_radians):
        other = "" if even or as_degrees > 0 else ", unless scans lie more than half a turn apart"
        warn(f"the headings of {name} look like degrees: np.radians turns them{other}")


def _agree(poses: Array, unit: float) -> float:
    """How well the way from pose to pose agrees with the headings in a unit, radians: 0 to 1."""
    step = np.diff(poses[:, :2], axis=0)
    moved = np.hypot(*step.T) > 0
    if moved.sum() < LEAST_TURNS_BEYOND_PI:
        return 0.0
    off = np.arctan2(step[moved, 1], step[moved, 0]) - unit * poses[:-1, 2][moved]
    return float(np.abs(np.mean(np.exp(1j * off))))


def check_lengths(
    data: object = None,
    *,
    most: float = MOST_MATCH_DISTANCE_M,
    share: float = LONG_THRESHOLD_SHARE,
    **thresholds: float,
) -> None:
    """Warn of thresholds, metres, that are longer than any building has a use for.

    Where the map or the points that they are for are given, only of those above a share of their
    size: a map may be of a city, or in another unit by intent.
    """
    for name, value in thresholds.items():
        if most < value < np.inf and value > share * _extent(data):
            warn(f"{name} is {value:.6g} m: this looks like millimetres, {name} / 1000")


def _extent(data: object) -> float:
    """Larger side of the box around a map, segments or points, metres; 0 around nothing."""
    points = getattr(data, "segments", data)
    xy = np.empty((0, 2)) if points is None else numbers(points, "map").reshape(-1, 2)
    return float(np.ptp(xy, axis=0).max()) if len(xy) else 0.0


def check_bandwidth(sigma: float, bandwidth: float) -> None:
    """Warn of a bandwidth, rad/m, that is above any in use and reaches over all directions."""
    if bandwidth > MOST_BANDWIDTH and sigma * bandwidth > np.pi / 2:
        warn(f"bandwidth is {bandwidth:.6g} rad/m: these look like degrees, np.radians(bandwidth)")


def warn(text: str) -> None:
    """A UserWarning that points at the line outside of the library that called it."""
    frame, level = inspect.currentframe(), 1
    while frame and frame.f_globals.get("__name__", "").split(".")[0] == "segmap":
        frame, level = frame.f_back, level + 1
    warnings.warn(text, UserWarning, stacklevel=level)
