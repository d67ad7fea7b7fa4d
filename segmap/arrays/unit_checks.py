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
#: Ranges that tell of a slip.
LEAST_TELLING_RANGES = 3
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
    if (words & (readings < max_range)).sum() >= LEAST_TELLING_RANGES:
        least = f"{readings[words].min():.6g}"
        warn(f"ranges of {least} m mean that nothing was met: write np.inf, or a max_range below")
    readings = readings[~words]
    readings = readings[(readings < max_range) | (readings < readings.max(initial=0.0))]
    if len(readings) < LEAST_TELLING_RANGES:
        return
    half = float(np.median(readings))
    if half > FARTHEST_RANGE_M:
        warn("half of the ranges are above 1000 m: these look like millimetres, ranges / 1000")
    elif half > HALF_RANGE_M and half >= max_range:
        warn(
            "half of the ranges are above 100 m and beyond max_range: these look like millimetres, "
            "ranges / 1000, or centimetres, ranges / 100"
        )


def check_length(
    value: float, name: str, data: object = None, *, share: float | None = None
) -> None:
    """Warn of a threshold, metres, that is longer than any building has a use for.

    Where the map or the points that it is for are given, only above a share of their size: a map
    may be of a city, or in another unit by intent.
    """
    points = getattr(data, "segments", data)
    is_map = isinstance(points, np.ndarray | list | tuple)  # else a log, or self
    xy = numbers(points, "map").reshape(-1, 2) if is_map else np.empty((0, 2))
    extent = float(np.ptp(xy, axis=0).max()) if len(xy) else 0.0
    if value > (share or LONG_THRESHOLD_SHARE) * extent:
        warn(f"{name} is {value:.6g} m: this looks like millimetres, {name} / 1000")


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
