"""What a sensor tells of its steps, and the scan that a measurement means."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from ..scans import LaserScan
from ..scans.error_codes import as_far_ranges, as_ranges
from ._protocol import Measurement, Reply, SensorError, parse_info

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


def laser_scan(met: Measurement, geometry: Geometry, *, time: float) -> LaserScan:
    """The scan that a measurement of all steps means.

    Examples
    --------
    >>> urg = Geometry(1024, 384, 384, 384, 20, 5600, 0.1)
    >>> laser_scan(Measurement(0, np.array([1500])), urg, time=0.0).points()
    array([[1.5, 0. ]])
    """
    if geometry.is_far:
        ranges, codes = as_far_ranges(met.millimetres, least=geometry.least, most=geometry.most)
    else:
        ranges, codes = as_ranges(met.millimetres)
    steps = geometry.first - geometry.front + np.arange(len(ranges))
    angles = steps * 2 * np.pi / geometry.steps
    # The stamp belongs to the rear of the sensor, from where its mirror turns to the left
    delays = (angles + np.pi) / (2 * np.pi) * geometry.turn
    begin = delays.min(initial=np.inf)
    time = time + begin if len(angles) else time
    most = geometry.most / 1000.0
    return LaserScan(ranges, angles, time, None, most, codes=codes, delays=delays - begin)
