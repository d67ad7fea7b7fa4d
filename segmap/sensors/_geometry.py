"""What a sensor tells of its steps, and the scan that a measurement means."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..scans import LaserScan
from ..scans.error_codes import as_far_ranges, as_ranges
from ._protocol import CHARACTERS, Measurement, Reply, ScanRequest, SensorError, parse_info

#: No number of a sensor's geometry is larger: steps, millimetres, turns a minute.
LARGEST_GEOMETRY = 1 << 20
#: Requests have four digits for a step.
LAST_REQUEST_STEP = 9999

_URG_NAME = re.compile("U[RBH]G")  # table 3 of SCIP 2.0 has their error codes


class Geometry(NamedTuple):
    """What the sensor says of itself: steps of a turn, and the limits of what it measures.

    Attributes
    ----------
    steps : int
        Steps in a whole turn.
    first, last, front : int
        Steps that it measures, and the one straight ahead.
    least, most : int
        Distances that it measures, millimetres.
    turn : float, seconds
    is_far : bool
        Whether its error codes are those of the UTM-30LX and its successors, not the URG-04LX's.
    """

    steps: int
    first: int
    last: int
    front: int
    least: int
    most: int
    turn: float
    is_far: bool = False


def parse_geometry(info: dict[str, str]) -> Geometry:
    """The geometry in the answer to PP."""
    names = ("ARES", "AMIN", "AMAX", "AFRT", "DMIN", "DMAX", "SCAN")
    try:
        numbers = [int(info[name]) for name in names]
    except (KeyError, ValueError) as error:
        raise SensorError(f"PP told no geometry, {error} is wrong in {info}") from None
    steps, first, last, front, least, most, rpm = numbers
    is_arc = (
        0 <= first <= last < steps <= LARGEST_GEOMETRY
        and 0 <= front < steps
        and last <= LAST_REQUEST_STEP
    )
    if not (is_arc and 0 <= least < most <= LARGEST_GEOMETRY and 0 < rpm <= LARGEST_GEOMETRY):
        raise SensorError(f"PP told a geometry that cannot be: {info}")
    is_far = "MODL" in info and not _URG_NAME.search(info["MODL"])
    return Geometry(steps, first, last, front, least, most, 60.0 / rpm, is_far)


def check_limits(reply: Reply) -> None:
    """Check the answer to PP strictly: one wrong bit in it would turn every scan."""
    parse_geometry(parse_info(reply.body, strict=True))


def request_for(
    geometry: Geometry, kind: str, first: int | None, last: int | None, cluster: int, skip: int = 0
) -> ScanRequest:
    """A request for steps that the sensor has; None for the outermost that it measures."""
    begin = geometry.first if first is None else first
    end = geometry.last if last is None else last
    if not begin <= end <= geometry.last:
        raise ValueError(
            f"first and last must lie in order within 0 to {geometry.last}, got {begin} to {end}"
        )
    return ScanRequest(kind, begin, end, cluster, skip)


def laser_scan(
    met: Measurement,
    request: ScanRequest,
    geometry: Geometry,
    *,
    time: float,
    sensor_pose: Array | tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> LaserScan:
    """The scan that a measurement means; the nearest of a cluster lies in the cluster's middle.

    Examples
    --------
    >>> urg, one = Geometry(1024, 44, 725, 384, 20, 5600, 0.1), ScanRequest("GD", 384, 384)
    >>> laser_scan(Measurement(0, np.array([1500])), one, urg, time=0.0).points()
    array([[1.5, 0. ]])
    """
    if geometry.is_far:
        ranges, codes = as_far_ranges(met.millimetres, least=geometry.least, most=geometry.most)
    else:
        ranges, codes = as_ranges(met.millimetres)
    middle = request.first + (request.cluster - 1) / 2 - geometry.front
    steps = middle + request.cluster * np.arange(len(ranges))
    most = min(geometry.most, 64 ** CHARACTERS[request.kind] - 1)
    angles = steps * 2 * np.pi / geometry.steps
    # The stamp belongs to the rear of the sensor, from where its mirror turns to the left
    delays = (angles + np.pi) / (2 * np.pi) * geometry.turn
    begin, limits = delays.min(initial=np.inf), (most / 1000.0, sensor_pose, codes)
    time = time + begin if len(angles) else time
    return LaserScan(ranges, angles, time, None, *limits, delays - begin)
