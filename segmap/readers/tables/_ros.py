"""Messages of ROS as text, a line each: what the names of their columns mean.

    %time,field.header.stamp,field.angle_min,...,field.ranges0,...   rostopic echo -p of a LaserScan
    Time,header.stamp.secs,angle_min,...,ranges_0,...                bagpy
    time,.header.stamp.secs,.angle_min,...,"(1.5, 2.0)",...          rosbag_to_csv
    __time,/scan/angle_min,...,/scan/ranges[0],...                   PlotJuggler
    %time,field.header.stamp,field.pose.pose.position.x,...          of an Odometry, others alike

All are in metres, radians and seconds, rostopic's stamps in nanoseconds.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from ._columns import meaning

#: Single numbers of a LaserScan.
NUMBERS = re.compile(r"(?:.*[./])?(angle_min|range_min|range_max|(?:angle|time)_increment)")
RANGES = re.compile(r"(?:.*[./])?ranges[\[_./]?(\d*)\]?")
#: Columns of a pose; a twist and a covariance have others.
POSE = re.compile(r"(?:.*[./])?pose[./](position|orientation)[./]([xyzw])")
PARTS_OF_POSES = {"positionx": "x_m", "positiony": "y_m"} | {
    f"orientation{axis}": f"q{axis}" for axis in "xyzw"
}
STAMP_PARTS = {"secs": "time_s", "sec": "time_s", "nsecs": "nanosec", "nanosec": "nanosec"}


def names_in_ros(head: Sequence[str]) -> tuple[str, ...]:
    """What the columns of a message with a scan or a pose are; empty of another head.

    Examples
    --------
    >>> names_in_ros(["__time", "/scan/angle_min", "/scan/angle_increment", "/scan/ranges[0]"])
    ('time_s', 'angle_min', 'angle_increment', 'ranges_m')
    """
    names = ["-"] * len(head)
    for place, name in enumerate(head):
        if number := NUMBERS.fullmatch(name):
            names[place] = number[1]
        elif RANGES.fullmatch(name):
            names[place] = "ranges_m"
        elif part := POSE.fullmatch(name):
            names[place] = PARTS_OF_POSES.get(part[1] + part[2], "-")
        elif name.endswith("frame_id"):
            names[place] = "frame_id"
    kinds = {"angle_min", "angle_increment", "ranges_m"}, {"x_m", "y_m"}
    if not any(kind <= {*names} for kind in kinds):
        return ()
    for place, name in _clock(head).items():
        names[place] = name
    return tuple(names)


def _clock(head: Sequence[str]) -> dict[int, str]:
    """The columns of the time of a message: its stamp first, then when it was recorded."""
    stamped = [k for k, name in enumerate(head) if re.search(r"header[./]stamp", name)]
    ends = {k: re.split(r"[./]", head[k])[-1] for k in stamped}
    if parts := {k: STAMP_PARTS[end] for k, end in ends.items() if end in STAMP_PARTS}:
        return parts
    if any(name.startswith("field.") for name in head):  # of rostopic
        return {stamped[0] if stamped else 0: "time_ns"}
    for k, name in enumerate(head):
        of_bagpy = name == "Time" and any(n.startswith("header.") for n in head)
        if name == "__time" or of_bagpy:
            return {k: "time_s"}
        column = meaning(name)
        if column and column.role == "time" and column.unit:
            return {k: name}
    return {}
