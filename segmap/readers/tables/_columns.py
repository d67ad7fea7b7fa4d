"""What the name of a column declares, in a head or by `--columns`: role, unit, way of angles.

angle_deg, angle_rad            direction of a beam; `angle_deg_cw` where angles grow clockwise
range_m, range_cm, range_mm     how far it went; `range_ft` and `range_in` too
urg_mm                          what a Hokuyo URG-04LX sends: an error code below 20 mm
x_m, y_m                        or where it ended, seen from the laser, in any of these units
time_s, time_ms, time_us, time_ns, time      when; without a unit a date or time of day
scan, new                       the number of its scan, or whether it is the first of one
nanosec                         what is added to a time in whole seconds
error                           nothing was measured where it is not 0
pose_x_m, pose_y_m, pose_theta_rad           the robot's odometry
ranges_m                        a scan a row: this column and all behind it that no name follows
angle_min, angle_increment      where its beams point, radians, as messages of ROS have it
-, -*20                         a column that is left out, or 20 of them

A part of a unit is divided: `angle_deg/10` are tenths of a degree, `range_mm/4` quarters of 1 mm.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from ...arrays import brief

LENGTH_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
ANGLE_UNITS = {"deg": np.pi / 180, "rad": 1.0}
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
QUATERNION = ("qx", "qy", "qz", "qw")
#: Role -> its units, with what makes metres, radians and seconds of them; one without needs none.
UNITS: dict[str, dict[str, float]] = {
    **dict.fromkeys(("range", "ranges", "x", "y", "pose_x", "pose_y"), LENGTH_UNITS),
    **dict.fromkeys(("angle", "pose_theta"), ANGLE_UNITS),
    **{role: {} for role in ("scan", "new", "error", "nanosec", *QUATERNION)},
    "time": TIME_UNITS,
    "urg": {"mm": 1.0},
}
#: A word -> the role that it names.
ROLE_WORDS = {name: name for name in ("new", "error", "nanosec", "x", "y", "urg", *QUATERNION)} | {
    word: role
    for role, words in {
        "angle": "angle angles theta θ bearing azimuth",
        "range": "range distance dist r",
        "ranges": "ranges distances",
        "time": "time timestamp stamp t",
        "scan": "scan rotation turn",
        "pose_theta": "heading yaw",
    }.items()
    for word in words.split()
}
#: A word -> the unit that it names.
UNIT_WORDS = {
    word: unit
    for unit, words in {
        "m": "m meter meters metre metres",
        "cm": "cm centimeter centimeters centimetre centimetres",
        "mm": "mm millimeter millimeters millimetre millimetres",
        "ft": "ft foot feet",
        "in": "in inch inches",
        "deg": "deg degs degree degrees °",
        "rad": "rad rads radian radians",
        "s": "s sec secs second seconds",
        "ms": "ms msec millis millisecond milliseconds",
        "us": "us usec µs μs micros microsecond microseconds",
        "ns": "ns nsec nanos nanosecond nanoseconds",
    }.items()
    for word in words.split()
}
POSE = ("pose_x", "pose_y", "pose_theta")
POSE_WORDS = {"pose", "robot", "odom", "odometry"}
#: What the roles of a point are called where it is the robot's.
OF_POSES = {"x": "pose_x", "y": "pose_y", "angle": "pose_theta"}
NUMBER_WORDS = {"id", "no", "nr", "number", "index", "num"}
CLOCKWISE = {"cw", "clockwise"}
TURNS = CLOCKWISE | {"ccw", "counterclockwise"}
LEFT_OUT_COLUMNS = re.compile(r"-(?:\*(\d{1,5}))?")
#: A name, and into how many parts its unit is divided.
DIVIDED = re.compile(r"(.*[a-z])/(\d{1,6}(?:\.\d+)?)")


#: Numbers of a message with a scan, in metres, radians and seconds.
MESSAGE_NUMBERS = (
    *("angle_min", "angle_max", "angle_increment", "time_increment", "range_min", "range_max"),
)
#: Sets of columns that make a log; the first set that a table has counts.
BEAM_ROLES = (("ranges",), ("angle", "range"), ("angle", "urg"), ("x", "y"))
#: Sets of columns that make a file of poses; the first set that a table has counts.
POSE_ROLES = (("time", *POSE), ("time", *POSE[:2], *QUATERNION))
POSES_ALONE = (
    "it holds poses and no scan: --odometry or --truth reads them beside a log, "
    "readers.read_trajectory in Python"
)


class Column(NamedTuple):
    """What a column is, its unit where the name says one, and whether angles grow clockwise.

    None where the name does not say it.
    """

    role: str
    unit: str = ""
    clockwise: bool | None = None
    parts: float = 1.0  #: of the unit

    @property
    def factor(self) -> float:
        """What makes metres, counter-clockwise radians or seconds of it."""
        unit = 1e-9 if self.role == "nanosec" else UNITS.get(self.role, {}).get(self.unit, 1.0)
        return (-unit if self.clockwise else unit) / self.parts

    @property
    def is_whole(self) -> bool:
        """Whether the name says all: a unit, or a role that needs none."""
        return bool(self.unit) or not UNITS.get(self.role)

    @property
    def name(self) -> str:
        """The name that declares it."""
        parts = f"/{self.parts:g}" if self.parts != 1 else ""
        way = "" if self.clockwise is None else "_cw" if self.clockwise else "_ccw"
        return f"{self.role}{'_' * bool(self.unit)}{self.unit}{way}{parts}"


def words_of(name: str) -> list[str]:
    """The words of a name, in lower case: `AngleInDegrees` has three."""
    split = re.sub("(?<=[a-z])(?=[A-Z])", " ", name)
    return re.findall(r"[^\W_]+|[^\s\w()\[\].,:/-]+", split.lower())


@cache
def meaning(name: str) -> Column | None:
    """What a name declares; None where one of its words is not known.

    Examples
    --------
    >>> meaning("Distance (mm)").name, meaning("AngleInDegrees").name, meaning("quality")
    ('range_mm', 'angle_deg', None)
    """
    if name in MESSAGE_NUMBERS:
        return Column(name)
    divided = DIVIDED.fullmatch(name)
    words = words_of(divided[1] if divided else name)
    is_turned = any(word in TURNS for word in words)
    is_clockwise = any(word in CLOCKWISE for word in words) if is_turned else None
    words = [word for word in words if word not in TURNS]
    unit = UNIT_WORDS.get(words[-1], "") if len(words) > 1 else ""
    words = [word for word in (words[:-1] if unit else words) if word != "in"]
    of_pose = words[:1] != [] and words[0] in POSE_WORDS and len(words) > 1
    roles = {ROLE_WORDS.get(word, "") for word in words[of_pose:] if word not in NUMBER_WORDS}
    if len(roles) != 1 or "" in roles:
        return None
    (role,) = roles
    role = OF_POSES.get(role, role) if of_pose else role
    numbered = any(word in NUMBER_WORDS for word in words)
    if (unit and unit not in UNITS[role]) or (numbered and role != "scan"):
        return None
    if (is_turned and role not in ("angle", "pose_theta")) or (divided and not unit):
        return None
    return Column(role, unit, is_clockwise, float(divided[2]) if divided else 1.0)


def column_names(columns: str | Sequence[str]) -> tuple[str, ...]:
    """Names as a caller gives them, with `-*3` written out; a ValueError where one is unknown."""
    words = columns.split(",") if isinstance(columns, str) else columns
    if not isinstance(words, list | tuple) or not all(isinstance(word, str) for word in words):
        raise ValueError(f"columns must be names such as angle_deg,range_mm, got {brief(columns)}")
    names: list[str] = []
    for name in map(str.strip, words):
        if "|" in name:
            raise ValueError(f"columns must say one thing of each: choose one of {name}")
        if left_out := LEFT_OUT_COLUMNS.fullmatch(name):
            names += ["-"] * int(left_out[1] or 1)
        elif meaning(name):
            names.append(name)
        else:
            raise ValueError(f"columns must be names such as angle_deg or range_mm, got {name!r}")
    return tuple(names)


def places_of(names: Sequence[str], of_poses: bool = False) -> dict[str, tuple[int, Column]]:
    """Columns by their roles, with their places; in a file `of_poses` x, y, angle are the robot's.

    Of two of a kind the one with a unit counts; where both or neither has one, a ValueError. Of
    ranges it is the first one.
    """
    columns: dict[str, tuple[int, Column]] = {}
    for place, name in enumerate(names):
        column = meaning(name)
        if column is None:
            continue
        if of_poses:
            column = column._replace(role=OF_POSES.get(column.role, column.role))
        first = columns.get(column.role)
        if first and column.role == "ranges":
            continue
        if first and first[1].is_whole == column.is_whole:
            raise ValueError(
                f"{names[first[0]]!r} and {name!r} both say that they are the {column.role}"
            )
        if not first or column.is_whole:
            columns[column.role] = place, column
    return columns


def ranges_in(names: Sequence[str]) -> list[int]:
    """The places of the columns of ranges."""
    columns = map(meaning, names)
    return [k for k, column in enumerate(columns) if column and column.role == "ranges"]


def missing_in(names: Sequence[str], of_poses: bool = False) -> str:
    """What names do not say of a log, or of a file of poses; empty where they say all."""
    try:
        columns = places_of(names, of_poses)
    except ValueError as fault:
        return str(fault)
    roles = {*columns}
    if not (of_poses or {"range", "ranges"} & roles) and any(
        {*kind} <= roles for kind in (("x", "y", "angle"), QUATERNION)
    ):
        return POSES_ALONE
    kinds = POSE_ROLES if of_poses else BEAM_ROLES
    needed = max(kinds, key=lambda kind: ({*kind} <= roles, len({*kind} & roles)))
    if lacking := [role for role in needed if role not in roles]:
        which = "angle, and which the range" if needed == ("ranges",) else lacking[0]
        return f"no name says which column is the {which}"
    unsaid = [
        names[columns[role][0]]
        for role in dict.fromkeys((*needed, *POSE))
        if role in roles - {"time"} and not columns[role][1].is_whole
    ]
    return f"the unit of {' and '.join(map(repr, unsaid))} is not said" if unsaid else ""
