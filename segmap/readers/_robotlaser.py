"""CARMEN's newer laser lines, which state their beams: ROBOTLASERn and RAWLASERn.

    ROBOTLASER1 type start_angle field_of_view resolution maximum_range accuracy remission_mode
        n [n ranges] m [m remissions] laser_x laser_y laser_theta robot_x robot_y robot_theta
        tv rv forward_safety side_safety turn_axis timestamp host logger_timestamp

RAWLASERn has no poses: after the remissions come only the three fields of time. Metres, radians,
seconds. Beam i points to `start_angle + i resolution`; where the resolution is stated as 0 the
beams are spread evenly over the field of view, both ends included.
"""

import numpy as np

from ..arrays import Array
from ._fields import counted, numbers, pose, time
from ._shots import NOWHERE, Shot

HEAD = 7


def parse(fields: list[str]) -> Shot:
    """One ROBOTLASERn or RAWLASERn line; the keyword names the laser.

    Ranges `(n,)`, metres, and directions `(n,)`, radians; poses in metres and radians, the time in
    seconds.
    """
    head = numbers(fields[1 : HEAD + 1], "the sensor's settings")
    if len(head) < HEAD or not np.isfinite(head[1:5]).all():
        raise ValueError(f"expected {HEAD} finite settings of the sensor after {fields[0]}")
    ranges, rest = counted(fields[HEAD + 1 :], "ranges")
    _, rest = counted(rest, "remissions", least=0)
    posed = fields[0].startswith("ROBOT")
    wanted = 14 if posed else 3
    if len(rest) != wanted:
        raise ValueError(f"expected {wanted} fields after the remissions, got {len(rest)}")
    laser = pose(rest[:3], "the laser") if posed else NOWHERE
    odometry = pose(rest[3:6], "the robot") if posed else NOWHERE
    limit = head[4] if head[4] > 0 else np.inf
    found = numbers(ranges, "ranges")
    return Shot(fields[0], found, _angles(head, len(found)), time(rest[-3]), odometry, laser, limit)


def _angles(head: Array, beams: int) -> Array:
    start, field_of_view, resolution = head[1:4]
    if not (abs(start) < 10 and 0 <= field_of_view < 10 and 0 <= resolution < 10):
        raise ValueError(f"expected the beams' angles in radians, got {head[1:4].tolist()}")
    step = resolution or field_of_view / max(beams - 1, 1)
    return start + step * np.arange(beams)
