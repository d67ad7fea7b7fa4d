"""What columns of tables are called, and in which units they are: the one place for all tables.

A name says what a column is and its unit, in many spellings; where it says no unit, numbers tell
it, or it is asked for. Columns without names are told by their numbers too.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Array

#: First words of a column's name.
ROLES = {
    "angle": "angle ang theta phi psi th rz bearing azimuth angule winkel angolo angulo heading "
    "yaw deg degrees tick step",
    "range": "range distance dist dis depth r rho radius mm cm m meters metres entfernung abstand "
    "distanz distanza distancia",
    "time": "time timestamp stamp t ts epoch millis micros nanos datetime sec ms us ns clock "
    "elapsed zeit uhrzeit zeitstempel temps heure tiempo hora tempo ora",
    "nanosec": "nanosec nsec",
    "scan": "scan frame rotation revolution sweep turn",
    "new": "new newscan start startbit sync",
    "error": "error errorcode",
    "sensor": "sensor robot laser lidar device source topic agent vehicle ring",
    "x": "x",
    "y": "y",
}
ROLE_OF_WORD = {word: role for role, words in ROLES.items() for word in words.split()}
#: Words that may stand beside them and change nothing.
FILLERS = (
    *("id", "no", "nr", "number", "index", "value", "values", "in", "code", "hex", "lidar"),
    *("tick", "ticks", "stamp", "name"),
)
#: What stands before a name in ROS's own text, in PlotJuggler's, and before a part of a pose.
BEFORE_NAME = re.compile(
    r"^((field|msg|message|data|scan)\.|/.*/)*(header[._](stamp\.(?=.)|(?=stamp$))|rosbag(?=[Tt]))?"
    r"((?i:lidar|laser|beam|measured)[_. ]+(?=(?i:angle|range|dist|theta|bearing|azimuth)))?"
    r"(?P<pose>(robot|pose|odom|odometry|base)[_. ](?=(x|y|theta|yaw|heading|th)([_ (\[]|$)))?"
)
#: A unit of angles: so many of a turn.
TICKS = re.compile(r"(?i)(?:tick|step)s?[\s_]*([1-9]\d{1,5})")
#: A column of them without a name of its own.
TICK_WORDS = ("tick", "ticks", "step", "steps")
#: What x, y and theta of the robot are beside x and y of a beam.
BESIDE_POINTS = {"x": "pose_x", "y": "pose_y", "angle": "heading"}
#: First words of the heading of a robot, beside the angle of a beam.
HEADINGS = ("theta", "heading", "yaw")
CLOCKWISE = ("cw", "clockwise")
TURN_WORDS = (*CLOCKWISE, "ccw", "counterclockwise")
LENGTHS = {
    "m meter meters metre metres metri metro metros м 米": 1.0,
    "cm centimeter centimeters centimetre centimetres centimetri centimetros см 厘米 センチ": 0.01,
    "mm millimeter millimeters millimetre millimetres millimetri milimetros мм 毫米 ミリ": 0.001,
    "ft feet foot": 0.3048,
    "in inch inches zoll": 0.0254,
}
#: How each unit is written, and the metres, radians or seconds of it; U+FFFD is what other
#: encodings make of ° and µ.
UNIT_WORDS: dict[str, dict[str, float]] = {
    "angle": {
        "deg degs degree degrees degre degres grad gradi grado grados graden grader graus stopnie "
        "stopni derece град градус градусы градуси 度 ° \ufffd": np.pi / 180,
        "rad rads radian radians radianti radianes radiant рад": 1.0,
        "gon gons gradian gradians": np.pi / 200,
        "cdeg centideg centidegree centidegrees": np.pi / 18_000,
        "mdeg millideg millidegree millidegrees": np.pi / 180_000,
        "mrad millirad milliradian milliradians": 0.001,
    },
    "range": LENGTHS,
    "x": LENGTHS,
    "y": LENGTHS,
    "time": {
        "s sec secs second seconds sn сек 秒": 1.0,
        "min mins minutes": 60.0,
        "days": 86400.0,
        "ms msec millis milliseconds мс 毫秒": 1e-3,
        "us µs \ufffds usec micros microseconds": 1e-6,
        "ns nsec nanos nanoseconds": 1e-9,
    },
}
UNIT_WORDS["nanosec"] = {"nanosec nsec nsecs": 1e-9}
UNIT_WORDS |= {"heading": UNIT_WORDS["angle"], "pose_x": LENGTHS, "pose_y": LENGTHS}
COLUMN_UNITS = {
    role: {word: factor for words, factor in units.items() for word in words.split()}
    for role, units in UNIT_WORDS.items()
}
#: Units in other letters than ours, of which other words in these do not count.
OTHER_LETTERS = "|".join(
    rf"(?<!\w){word}(?!\w)" if word < "\u0500" else word
    for word in sorted({word for units in COLUMN_UNITS.values() for word in units}, key=len)[::-1]
    if "\u0400" < word < "\ufffd"
)
UNIT_NAMES = {word for units in COLUMN_UNITS.values() for word in units}
#: What a column is whose numbers have such a unit behind them.
UNIT_ROLES = {word: role for role in ("time", "angle", "range") for word in COLUMN_UNITS[role]}
#: Names of programs that say no unit -> the columns that they mean.
KNOWN_TABLES = {
    ("theta", "dist", "q"): ("angle_deg_cw", "range_mm", "quality"),
    ("angle", "distance", "intensity"): ("angle_deg_cw", "", "quality"),
    ("stamp", "angle", "distance", "intensity"): ("", "angle_deg_cw", "", "quality"),
    ("angule", "distance", "quality"): ("angle_deg_cw", "range_mm", "quality"),
    ("newscan", "quality", "angle", "distance"): ("new", "quality", "angle_deg_cw", "range_mm"),
}
#: What RPLidar's `ultra_simple` prints of a beam.
ULTRA_SIMPLE = ("theta", "dist", "q")
#: Of the record that the Python package `rplidar` makes, which has no head.
RPLIDAR_RECORD = KNOWN_TABLES["newscan", "quality", "angle", "distance"]
#: Whole numbers whose median is above this are millimetres where no unit is said.
LEAST_MILLIMETRES = 100
#: Where the largest is below this, it is said that they may be centimetres: no room is so small.
SMALLEST_ROOM_MM = 1200
#: So are numbers with a fraction whose median is above this: they could be centimetres below.
LEAST_FRACTIONS = 700
#: Numbers with a fraction whose largest is below this are metres.
MOST_METRES = 60.0
#: So many rows tell what is not said; two or three tell nothing.
TELLING_ROWS = 8
#: A column whose angles span so much at least, and no more than a turn, is in radians.
LEAST_VIEW_RAD = 2.0
#: What is called grad and spans more is in gon, and in no degrees as in German.
MOST_DEGREES = 361
#: Seconds from scan to scan.
SCAN_PERIODS_S = (0.02, 2.0)
#: Days of our century as Excel counts them.
EXCEL_DAYS = (36525, 73050)
#: From these on a number is a time since 1970, in the unit beside it.
SINCE_1970 = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3), (1e8, 1.0))


class Column(NamedTuple):
    """One column: its place, what makes metres, radians or seconds of it, and its name."""

    place: int
    factor: float | None
    name: str
    measured: bool = False  #: whether a unit stands behind each number


class Columns(NamedTuple):
    """Columns by what they are; whether angles grow clockwise, None where nothing says it."""

    by_role: dict[str, Column]
    clockwise: bool | None = None
    twice: str = ""  #: two names for one thing, of which the first is taken
    by_program: bool = False  #: whether it is the program that names them so that says the rest
    sensor: int | None = None  #: the place of a column that says who measured

    @property
    def enough(self) -> bool:
        """Whether there are an angle and a range, or x and y."""
        return any(pair <= {*self.by_role} for pair in ({"angle", "range"}, {"x", "y"}))


def named(names: Sequence[str]) -> Columns:
    """The columns that names stand for; of two of a kind the one that says its unit is taken.

    Of two angles or ranges that both say one, neither is. Beside x, y, a range and its angle, theta
    is the heading of the robot.
    """
    posed = [bool((begin := BEFORE_NAME.match(name)) and begin["pose"]) for name in names]
    names = [BEFORE_NAME.sub("", name) for name in names]
    short = tuple(_plain_word(name) for name in names)
    known = [*KNOWN_TABLES.get(short, ("",) * len(names))]
    for k in range(len(short)):  # between what newer programs print, or a logger
        if short[k : k + 3] == ULTRA_SIMPLE:
            known[k : k + 3] = KNOWN_TABLES[ULTRA_SIMPLE]
    found: dict[str, Column] = {}
    clockwise, twice, doubtful = None, "", set[str]()
    meanings = [meant or name for name, meant in zip(names, known, strict=True)]
    roles = [_role(meant, plain_words(meant)) for meant in meanings]
    beside_pose = {"x", "y", "range"} <= {*roles} and roles.count("angle") > 1
    if any(role == "x" and not pose for role, pose in zip(roles, posed, strict=True)):
        both = zip(roles, posed, strict=True)
        roles = [BESIDE_POINTS.get(role or "", role) if pose else role for role, pose in both]
    ticks = [{*plain_words(name)[:1]} <= {*TICK_WORDS} for name in names]
    angles = [tick for role, tick in zip(roles, ticks, strict=True) if role == "angle"]
    if "range" not in roles or not all(angles):
        roles = [None if tick else role for role, tick in zip(roles, ticks, strict=True)]
    places = [place for place, role in enumerate(roles) if role is not None]
    alone = [
        is_unit(name) and role in ("angle", "range")
        for name, role in zip(meanings, roles, strict=True)
    ]
    for place in sorted(places, key=alone.__getitem__):
        name, meant, role = names[place], meanings[place], roles[place] or ""
        words = plain_words(meant)
        if alone[place] and role in found:
            continue  # `deg` beside `angle`
        if beside_pose and role == "angle" and words[0] in HEADINGS:
            role = "heading"
        factors = [*units_said(role, name), *units_said(role, meant)]  # its own before a program's
        column = Column(place, factors[0] if factors else None, name.strip())
        if role in found:
            twice = f"{found[role].name!r} and {name!r} are both columns of the {role}"
            if role in ("angle", "range") and None not in (found[role].factor, column.factor):
                doubtful.add(role)
            if found[role].factor is not None or column.factor is None:
                continue
        found[role] = column
        if role == "angle" and (said := [w in CLOCKWISE for w in words if w in TURN_WORDS]):
            clockwise = any(said)
    if "time" in found and not re.match(r"(?i)secs?\b", found["time"].name):
        found.pop("nanosec", None)  # which are a part of these alone
    who = found.pop("sensor", None)
    kept = {k: v for k, v in found.items() if k not in doubtful}
    return Columns(kept, clockwise, twice, any(known), who.place if who else None)


def units_said(role: str, name: str) -> list[float]:
    """What makes metres, radians or seconds of a column, by the units in its name."""
    words, units = plain_words(name), COLUMN_UNITS.get(role, {})
    said = words if is_unit(name) else words[1:]
    ticks = [2 * np.pi / int(count) for count in TICKS.findall(name)]
    return [*(factor for word, factor in units.items() if word in said), *ticks]


def is_unit(name: str) -> bool:
    """Whether a name is a unit alone: `deg`, `mm`."""
    words = plain_words(name)
    return len(words) == 1 and words[0] in UNIT_NAMES


def plain_words(name: str) -> list[str]:
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)  # `AngleInDegrees`, `ErrorCodeHEX`
    plain = re.sub("[\u0300-\u036f]", "", unicodedata.normalize("NFD", apart.lower()))
    return re.findall(rf"[a-zµ°\ufffd]+|{OTHER_LETTERS}", plain.replace("μ", "µ"))


def _plain_word(name: str) -> str:
    """A name without its unit, for `KNOWN_TABLES`."""
    return re.sub(r"[\[(].*|[^a-z]", "", name.lower())


def _role(name: str, words: Sequence[str]) -> str | None:
    """What a column is; None where another word than a unit stands in its name."""
    if not words or re.search("[0-9:]", TICKS.sub("", name)):
        return None
    first = (words[0], words[0].removesuffix("s"))  # `ms` is no `m`
    role = next((ROLE_OF_WORD[word] for word in first if word in ROLE_OF_WORD), "")
    known = {*COLUMN_UNITS.get(role, ()), *FILLERS, *TURN_WORDS}
    return role if role and known.issuperset(words[1:]) else None


# ------------------------------------------------------------------------------- by numbers
def with_units_told(found: Columns, rows: Array) -> tuple[Columns, list[str]]:
    """Columns whose units the numbers of their rows `(m, k)` tell, and what was taken from them.

    Angles that span more than a turn in radians are degrees. Ranges in whole numbers, half of them
    above 100, are millimetres. A time whose unit nothing tells is left out.
    """
    columns, told = dict(found.by_role), list[str]()
    if found.twice:
        told.append(f"{found.twice}: the first that says its unit is read, or the first")
    if "scan" in columns and np.isnan(rows[:, columns["scan"].place]).all():  # frames of ROS
        found = found._replace(sensor=columns.pop("scan").place)
    if "pose_x" in columns:
        told.append("points are as the laser sees them, beside the pose of the robot")
    for role in ("angle", "range", "x", "y", "pose_x", "pose_y", "heading", "time"):
        column = columns.get(role)
        if column is None:
            continue
        if role == "time" and len(rows) and np.isnan(rows[:, column.place]).all():
            told.append(f"the column {columns.pop('time').name!r} holds no times: left out")
            continue
        words = plain_words(column.name)
        if role == "angle" and "grad" in words and np.ptp(rows[:, column.place]) > MOST_DEGREES:
            columns[role] = column._replace(factor=np.pi / 200)
            told.append(f"{column.name!r} is in gon, since it spans more than 360 of them")
        if units_said(role, column.name) or {*words} & {*TICK_WORDS} or column.measured:
            continue
        factor, why = _unit_of(role, rows[:, column.place])
        if column.factor is not None and factor in (None, column.factor):
            continue  # a program says it, and the numbers say nothing else
        if factor is not None:
            columns[role] = column._replace(factor=factor)
            told.append(f"{column.name!r} is in {why}")
        elif role == "time":
            told.append(f"the column {columns.pop('time').name!r} says no unit: left out")
    return found._replace(by_role=columns), told


def _unit_of(role: str, values: Array) -> tuple[float | None, str]:
    """What makes metres, radians or seconds of numbers without a unit, and why."""
    values = values[np.isfinite(values)]
    if role == "time":
        return _time_unit(values)
    values = values[values != 0]
    if not len(values):
        return None, ""
    span, whole = float(np.ptp(values)), bool((values == np.floor(values)).all())
    if role in ("angle", "heading"):
        if span > 2 * np.pi + 0.1:
            return np.pi / 180, "degrees, since it spans more than 2 pi"
        told = span >= LEAST_VIEW_RAD and len(values) >= TELLING_ROWS and not whole
        if told or role == "heading":
            return 1.0, f"radians, since it spans {span:.3g}"
        return None, ""
    middle = float(np.median(np.abs(values)))
    if middle > (LEAST_MILLIMETRES if whole else LEAST_FRACTIONS):
        most = float(np.abs(values).max())
        doubt = f", to {most:g} alone: they may be centimetres" * (most < SMALLEST_ROOM_MM)
        return 0.001, f"millimetres, since it holds {'whole' if whole else 'large'} numbers{doubt}"
    if not whole and len(values) >= TELLING_ROWS and np.abs(values).max() < MOST_METRES:
        return 1.0, f"metres, since it holds fractions up to {np.abs(values).max():.3g}"
    return None, ""


def _time_unit(values: Array) -> tuple[float | None, str]:
    steps = np.diff(values)
    steps = steps[steps > 0]
    if not len(steps):
        return None, ""
    for least, factor in SINCE_1970:
        if least <= values.min() and values.max() < 1000 * least:
            unit = {1e-9: "nanoseconds", 1e-6: "microseconds", 1e-3: "milliseconds", 1.0: "seconds"}
            return factor, f"{unit[factor]} since 1970"
    step = float(np.median(steps))
    if EXCEL_DAYS[0] < values.min() and values.max() < EXCEL_DAYS[1] and step < SCAN_PERIODS_S[0]:
        return COLUMN_UNITS["time"]["days"], "days, as Excel counts them"
    if (values != np.floor(values)).any() and values.max() < SINCE_1970[-1][0]:
        return 1.0, "seconds, since it holds fractions"
    stands = len(steps) < len(values) / 3  # one time for all beams of a scan
    fits = [
        f for f in (1.0, 1e-3, 1e-6, 1e-9) if SCAN_PERIODS_S[0] <= step * f <= SCAN_PERIODS_S[1]
    ]
    unit = {1.0: "seconds", 1e-3: "milliseconds", 1e-6: "microseconds", 1e-9: "nanoseconds"}
    if stands and len(fits) == 1:
        return fits[0], f"{unit[fits[0]]}, since a scan takes {step:g} of them"
    return None, ""
