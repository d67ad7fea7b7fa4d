"""Simulated logs: a robot drives through a room and measures, with errors of a chosen size.

`simulate` answers with a `Log` that carries the truth, so that every method can be judged. All
random numbers come from one generator: the same seed gives the same log.
"""

from ._city import city
from ._rooms import (
    box,
    circular_room,
    corridor_loop,
    office,
    polyline,
    rectangular_room,
    square_room,
    two_position_square,
)
from ._sensors import (
    CHEAP_WHEELS,
    SICK_LMS200,
    URG_04LX,
    OdometryNoise,
    Sensor,
    drifting_odometry,
    measure,
)
from ._simulate import cast_rays, drive, simulate

__all__ = [
    "CHEAP_WHEELS", "SICK_LMS200", "URG_04LX", "OdometryNoise", "Sensor", "box", "cast_rays",
    "circular_room", "city", "corridor_loop", "drifting_odometry", "drive", "measure", "office",
    "polyline", "rectangular_room", "simulate", "square_room", "two_position_square",
]  # fmt: skip
