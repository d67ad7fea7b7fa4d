"""What columns of tables are called, and in which units they are: the one place for all tables.

A name says what a column is and its unit, in many spellings; where it says no unit, numbers tell
it, or it is asked for. Columns without names are told by their numbers too.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Array

#: First words of a column's name.
ROLES = {
    "angle": "angle ang theta phi psi th rz bearing azimuth angule heading yaw deg degrees",
    "range": "range distance dist dis depth r rho radius mm cm m meters metres",
    "time": "time timestamp stamp t ts epoch millis micros nanos datetime sec clock elapsed "
    "zeit uhrzeit zeitstempel temps heure tiempo hora tempo ora",
    "nanosec": "nanosec nsec",
    "scan": "scan frame rotation revolution sweep turn",
    "new": "new newscan start startbit sync",
    "error": "error errorcode",
    "x": "x",
    "y": "y",
}
#: Words that may stand beside them and change nothing.
FILLERS = (
    *("id", "no", "nr", "number", "index", "value", "values", "in", "code", "hex", "lidar"),
    *("tick", "ticks", "stamp"),
)
#: What stands before a name in ROS's own text, in PlotJuggler's, and before a part of a pose.
BEFORE_NAME = re.compile(
    r"^((field|msg|message|data|scan)\.|/.*/)*(header[._](stamp\.(?=.)|(?=stamp$))|rosbag(?=[Tt]))?"
    r"((robot|pose|odom|odometry|base)[_. ](?=(x|y|theta|yaw|heading|th)([_ (\[]|$)))?"
)
#: A unit of angles: so many of a turn.
TICKS = re.compile(r"(?i)(?:tick|step)s?[\s_]*([1-9]\d{1,5})")
#: How many they usually are.
USUAL_TICKS = (1024, 1440, 2048, 4096, 8192, 16384, 65536)
#: First words of the heading of a robot, beside the angle of a beam.
HEADINGS = ("theta", "heading", "yaw")
CLOCKWISE = ("cw", "clockwise")
TURN_WORDS = (*CLOCKWISE, "ccw", "counterclockwise")
LENGTHS = {
    "m meter meters metre metres": 1.0,
    "cm centimeter centimeters centimetres": 0.01,
    "mm millimeter millimeters millimetres": 0.001,
    "ft feet foot": 0.3048,
    "in inch inches": 0.0254,
}
#: How each unit is written, and the metres, radians or seconds of it; U+FFFD is what other
#: encodings make of ° and µ.
UNIT_WORDS: dict[str, dict[str, float]] = {
    "angle": {
        "deg degs degree degrees degres ° \ufffd": np.pi / 180,
        "rad rads radian radians": 1.0,
    },
    "range": LENGTHS,
    "x": LENGTHS,
    "y": LENGTHS,
    "time": {
        "s sec secs second seconds": 1.0,
        "min mins minutes": 60.0,
        "days": 86400.0,
        "ms msec millis milliseconds": 1e-3,
        "us µs \ufffds usec micros microseconds": 1e-6,
        "ns nsec nanos nanoseconds": 1e-9,
    },
}
UNIT_WORDS["nanosec"] = {"nanosec nsec nsecs": 1e-9}
UNIT_WORDS["heading"] = UNIT_WORDS["angle"]
COLUMN_UNITS = {
    role: {word: factor for words, factor in units.items() for word in words.split()}
    for role, units in UNIT_WORDS.items()
}
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

    @property
    def enough(self) -> bool:
        """Whether there are an angle and a range, or x and y."""
        return any(pair <= {*self.by_role} for pair in ({"angle", "range"}, {"x", "y"}))


def named(names: Sequence[str]) -> Columns:
    """The columns that names stand for; of two of a kind the one that says its unit is taken.

    Of two angles or ranges that both say one, neither is. Beside x, y, a range and its angle, theta
    is the heading of the robot.
    """
    names = [BEFORE_NAME.sub("", name) for name in names]
    short = tuple(_plain_word(name) for name in names)
    known = KNOWN_TABLES.get(short, ("",) * len(names))
    found: dict[str, Column] = {}
    clockwise, twice, doubtful = None, "", set[str]()
    meanings = [meant or name for name, meant in zip(names, known, strict=True)]
    roles = [_role(meant, _words(meant)) for meant in meanings]
    beside_pose = {"x", "y", "range"} <= {*roles} and roles.count("angle") > 1
    places = [place for place, role in enumerate(roles) if role is not None]
    alone = [
        is_unit(name) and role in ("angle", "range")
        for name, role in zip(meanings, roles, strict=True)
    ]
    for place in sorted(places, key=alone.__getitem__):
        name, meant, role = names[place], meanings[place], roles[place] or ""
        words = _words(meant)
        if alone[place] and role in found:
            continue  # `deg` beside `angle`
        if beside_pose and role == "angle" and words[0] in HEADINGS:
            role = "heading"
        factors = [*_factors(role, name), *_factors(role, meant)]  # its own before a program's
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
    kept = {k: v for k, v in found.items() if k not in doubtful}
    return Columns(kept, clockwise, twice, short in KNOWN_TABLES)


def _factors(role: str, name: str) -> list[float]:
    """What makes metres, radians or seconds of a column, by the units in its name."""
    words, units = _words(name), COLUMN_UNITS.get(role, {})
    said = words if is_unit(name) else words[1:]
    ticks = [2 * np.pi / int(count) for count in TICKS.findall(name)]
    return [*(factor for word, factor in units.items() if word in said), *ticks]


def is_unit(name: str) -> bool:
    """Whether a name is a unit alone: `deg`, `mm`."""
    words = _words(name)
    return len(words) == 1 and words[0] in UNIT_NAMES


def _words(name: str) -> list[str]:
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)  # `AngleInDegrees`, `ErrorCodeHEX`
    plain = re.sub("[\u0300-\u036f]", "", unicodedata.normalize("NFD", apart.lower()))
    return re.findall(r"[a-zµ°\ufffd]+", plain.replace("μ", "µ"))


def _plain_word(name: str) -> str:
    """A name without its unit, for `KNOWN_TABLES`."""
    return re.sub(r"[\[(].*|[^a-z]", "", name.lower())


def _role(name: str, words: Sequence[str]) -> str | None:
    """What a column is; None where another word than a unit stands in its name."""
    if not words or re.search("[0-9:]", TICKS.sub("", name)):
        return None
    for role, names in ROLES.items():
        if {words[0], words[0].removesuffix("s")} & {*names.split()}:
            known = {*COLUMN_UNITS.get(role, ()), *FILLERS, *TURN_WORDS}
            return role if known.issuperset(words[1:]) else None
    return None


# ------------------------------------------------------------------------------- by numbers
def with_units_told(found: Columns, rows: Array) -> tuple[Columns, list[str]]:
    """Columns whose units the numbers of their rows `(m, k)` tell, and what was taken from them.

    Angles that span more than a turn in radians are degrees. Ranges in whole numbers, half of them
    above 100, are millimetres. A time whose unit nothing tells is left out.
    """
    columns, told = dict(found.by_role), list[str]()
    if found.twice:
        told.append(f"{found.twice}: the first that says its unit is read, or the first")
    for role in ("angle", "range", "x", "y", "heading", "time"):
        column = columns.get(role)
        if column is None:
            continue
        if role == "time" and len(rows) and np.isnan(rows[:, column.place]).all():
            told.append(f"the column {columns.pop('time').name!r} holds no times: left out")
            continue
        said = _factors(role, column.name) or "tick" in column.name.lower()
        if said or column.measured:
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


def guessed(rows: Array) -> tuple[str, ...]:
    """Names of columns without names, by their numbers `(m, k)`; none where these do not tell."""
    count, usable = rows.shape[1], [int(k) for k in np.flatnonzero(np.isfinite(rows).all(0))]
    if len(rows) < TELLING_ROWS or not 2 <= len(usable) <= 8:
        return ()
    sweeps = [k for k in usable if _sweeps(rows[:, k])]
    if len(sweeps) > 1:  # an index counts by ones
        sweeps = [k for k in sweeps if not _counts_up(rows[:, k])] or sweeps
    if len(sweeps) > 1:
        sweeps = [k for k in sweeps if (np.diff(rows[:, k]) < 0).any()] or sweeps
        sweeps = [max(sweeps, key=lambda k: float(np.ptp(rows[:, k])))]
    clocks = [k for k in usable if (np.diff(rows[:, k]) >= 0).all() and np.ptp(rows[:, k])]
    if len(sweeps) != 1:
        return ()
    (angle,) = sweeps
    others = [k for k in usable if k != angle and k not in clocks and np.ptp(rows[:, k])]
    others = [k for k in others if (rows[:, k] >= 0).all() and not _counts_up(rows[:, k])]
    if not others:
        return ()
    ranked = sorted(others, key=lambda k: len(np.unique(rows[:, k])))
    distance, names = ranked[-1], ["-"] * count
    if len(ranked) > 1 and len(np.unique(rows[:, ranked[-2]])) == len(np.unique(rows[:, distance])):
        return ()
    names[angle], names[distance] = "angle", "range"
    if clocks and angle not in clocks[:1]:
        counts = _counts_up(rows[:, clocks[0]])
        names[clocks[0]] = "scan" if counts else "time"
        if counts and len(np.unique(rows[:, clocks[0]])) == len(rows):
            names[clocks[0]] = "-"  # an index
    return tuple(names)


def _sweeps(values: Array) -> bool:
    """Whether numbers go one way like the angle of a laser that turns, and at times fall back."""
    steps = np.diff(values)
    ahead = steps if (steps > 0).sum() >= (steps < 0).sum() else -steps
    span, falls = float(np.ptp(values)), -ahead[ahead < 0]
    if not LEAST_VIEW_RAD <= span <= 720 or np.abs(values).max() > 720:
        return False
    mostly = (ahead > 0).sum() >= 0.8 * len(steps)
    return bool(mostly and (falls > span / 2).sum() >= 0.5 * len(falls))


def _counts_up(values: Array) -> bool:
    steps = np.diff(values)
    return bool((steps[steps > 0] == 1).all() and values.min() in (0, 1))


def _turn_like(values: Array) -> tuple[bool, float]:
    """How much numbers are like angles, in an order."""
    return _sweeps(values), float(np.ptp(values[np.isfinite(values)]))


def _measured_like(values: Array) -> tuple[int, float]:
    """How much numbers are like ranges, in an order: many different ones, and large."""
    known = values[np.isfinite(values)]
    return len(np.unique(known)), float(np.median(known))


def proposed_names(names: Sequence[str], rows: Array) -> list[str]:
    """A name with a unit for each column, as good as anybody can tell: it may be wrong."""
    columns, _ = with_units_told(named(names), rows)
    by_place = {column.place: (role, column) for role, column in columns.by_role.items()}
    if not by_place and (guess := guessed(rows)):
        columns, _ = with_units_told(named(guess), rows)
        by_place = {column.place: (role, column) for role, column in columns.by_role.items()}
    free = [k for k in range(len(names)) if k not in by_place and np.isfinite(rows[:, k]).any()]
    for role, likely in (("angle", _turn_like), ("range", _measured_like)):
        if role not in columns.by_role and free and not {"x", "y"} <= {*columns.by_role}:
            place = max(free, key=lambda k, likely=likely: likely(rows[:, k]))  # type: ignore[misc]
            free.remove(place)
            by_place[place] = role, Column(place, None, "")
    usual = {"angle": np.pi / 180, "heading": 1.0, "range": 0.001, "x": 1.0, "y": 1.0, "time": 1.0}
    found = ["-"] * len(names)
    for place, (role, column) in by_place.items():
        if role not in usual:
            found[place] = role
            continue
        most = np.nanmax(np.abs(rows[:, place]), initial=0.0)
        if column.factor not in (None, *COLUMN_UNITS[role].values()):
            found[place] = column.name
            continue
        if "tick" in column.name.lower():
            turn = next((count for count in USUAL_TICKS if most < count), USUAL_TICKS[-1])
            found[place] = f"angle_ticks{turn}"
            continue
        large = most > MOST_METRES
        factor = column.factor or (1.0 if role == "range" and not large else usual[role])
        units: Mapping[str, float] = COLUMN_UNITS[role]
        suffix = "_cw" if role == "angle" and columns.clockwise else ""
        found[place] = f"{role}_{next(word for word, f in units.items() if f == factor)}{suffix}"
    return found
