"""Tables with a line a beam, whatever program wrote them: one reader for all.

    angle_deg,range_mm,quality,time_s,scan             a head, anywhere in the first lines
    S  theta: 12.34 Dist: 01234.00 Q: 47               names in each line: RPLidar's `ultra_simple`
    stamp(ns):1234,angle:12.34,distance(mm):1234,...   LD06, LD19
    AngleInDegrees,DistInMM,Intensity,ErrorCodeHEX     Neato and XV-11, a head before each turn
    #RPLIDAR SCAN DATA                                 SLAMTEC's programs
    True    15    12.34    1234.0                      the Python package rplidar
    [(15, 12.34, 1234.0), ...]                         its scans, one a line
    0.35,1.234                                         columns that the numbers tell

Fields lie between commas, semicolons, tabs or white space, or two of these, with decimal points or
commas; a unit may stand behind each number, `90 deg, 1.25 m`. A scan ends where its number, its
head or a time that lasts for a turn says so, or where the angle wraps or turns back; its time is
that of its first beam, and unknown without a column of it. Times are numbers, ISO 8601 or the time
of day. Angles are counter-clockwise unless their name, their program or the caller says otherwise.
A range of 0 and an empty one are no measurement, `inf` is a beam that met nothing. Columns nobody
needs are left out. There is no odometry and no truth.

Assumed: beams are counter-clockwise, a scan ends where the angle wraps, and units, where the file
does not say them; without a head also which column is what.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np

from ...arrays import Array, brief, checked
from ...scans import LaserScan, Log
from .._lines import (
    HeadError,
    Lines,
    LogError,
    OnError,
    direction_field,
    distance,
    is_number,
    number_field,
    stem,
    time,
)
from .._raw_scans import COUNTERCLOCKWISE, known, place_of
from .._text import TextFormat
from ..packed import log_file
from ._columns import Columns, named
from ._fields import (
    LOGGED,
    NESTED,
    TABLE_COMMENTS,
    TUPLE,
    as_numbers,
    decimal,
    labelled,
    moment,
    sample,
    split,
    stamp_in,
)
from ._layout import (
    EXAMPLE,
    Layout,
    as_written,
    begin_of,
    layout_of,
    parted,
    rows_below,
    wanting,
)
from ._numbers import beams_in, by_beam, ends_of_turns, from_first, is_time_of_turns, parts_sensors
from ._wide import scan_in

#: No scan has more beams.
MOST_BEAMS_READ = 100_000
POSE_OF_ROW = "rows without ranges are no scans: the pose of one is that of the scan behind it"
#: A column that says who measured holds no more names.
MOST_SENSORS = 16
#: Nor one of words that may be such a column, and it changes between scans only.
MOST_WORDS = 8
#: A day, of which some clocks tell the time alone, seconds.
DAY_S = 86400.0
#: A line between scans.
NEXT_SCAN = re.compile(
    r"(?i)[a-z ]*\b(scan|frame|sweep|turn|revolution|rotation)\b[^\d]*\d*[^\d]*(\w+\s*=.*)?$"
)
#: A name in a record that does not end.
CUT = "..."
#: What an XV-11 says between its tables.
CHATTER = ("rotation_speed", "getldsscan", "i heard a laser scan", "angle_range")


class Table(TextFormat):
    """Beams in columns that are known, in the order in which they were measured.

    A scan ends where its number changes; without numbers, where a time that lasts for a turn does,
    or where the angle wraps or turns back. Its time is that of its first beam, where the lines have
    any; each beam keeps its own. Scans of a clockwise sensor are turned round.
    """

    expected = "lines of angle and range"

    def __init__(self, lines: Lines, layout: Layout, clockwise: bool) -> None:
        super().__init__(lines)
        self.layout, self.clockwise = layout, clockwise or bool(layout.columns.clockwise)
        counted = not (clockwise or layout.beams) and layout.columns.clockwise is None
        self.assumed = (*layout.told, *(COUNTERCLOCKWISE,) * counted)
        self.columns = layout.columns.by_role
        places = [column.place for column in self.columns.values()]
        beams = layout.beams.ranges if layout.beams else ()
        self.last = max([*places, *(beams[:1] if layout.beams and layout.beams.goes_on else beams)])
        self.turns, self.head, self.clock, self.stamp = 0, [""], np.nan, ""
        self.between: tuple[str, ...] = ()
        self.pose = [np.nan] * 3
        self.places = {*places, *beams, *(layout.beams.directions if layout.beams else ())}
        self.apart: dict[int, list[int]] | None = None
        self.words: dict[int, dict[str, tuple[int, str]]] = {}

    def _take(self, fields: list[str]) -> None:
        (line,) = fields
        layout = self.layout
        if "time" not in self.columns and LOGGED.match(line):
            self.stamp = stamp_in(line)
        if layout.labels:
            beams = [said for said in labelled(line) if {*layout.labels} <= {*said}]
            for said in beams:
                self._row([said[label] for label in layout.labels])
            if not beams and "time" not in self.columns:
                self.stamp = stamp_in(line) or self.stamp
            names = [re.escape(label.split()[0]) for label in layout.labels]
            if not beams and any(re.search(rf"{name}[\"']?\s*[:=]", line) for name in names):
                wanted = ", ".join(f"{label}:" for label in layout.labels)
                raise ValueError(f"expected a beam with {wanted}, got {line[:60]!r}")
        elif layout.nested:
            if NESTED.search(line):
                self.turns += 1
                for each in TUPLE.findall(line):
                    self._row(split(each, ","))
                if line.count("[") + line.count("(") != line.count("]") + line.count(")"):
                    raise ValueError(f"its brackets are not closed: {line[-40:]!r}")
        else:
            found = split(line, layout.separator)
            above = self.lines.number <= layout.line
            if above or found == self.head or NEXT_SCAN.match(" ".join(found)):
                self.head = found if above and not is_number(found[0]) else self.head
                self.turns += bool(self.scans)
                if "time" not in self.columns:
                    self.stamp = stamp_in(line) or self.stamp
                if "=" in line and not (above or self.between):
                    self.between = (f"lines between scans are left out, such as {line[:60]!r}",)
            elif not found or not found[0].lower().startswith(CHATTER):
                self._row(found)

    def take_record(self, said: Mapping[str, str]) -> None:
        """Take in the values of a record by their names."""
        places = [*(column.place for column in self.columns.values())]
        places += self.layout.beams.ranges if self.layout.beams else ()
        wanted = [self.layout.labels[k] for k in places]
        if CUT in said:
            raise ValueError("the file is cut off in it")
        if missing := [name for name in wanted if name not in said]:
            raise ValueError(f"{missing[0]} is not said")
        self._row([said.get(label, "") for label in self.layout.labels])

    def _row(self, fields: list[str]) -> None:
        if len(fields) <= self.last:
            raise ValueError(f"expected {self.last + 1} columns or more, got {len(fields)}")
        thousands = self.layout.thousands
        texts = {role: fields[column.place] for role, column in self.columns.items()}
        said = {role: decimal(text, thousands=thousands) for role, text in texts.items()}
        factors = {role: column.factor or 1.0 for role, column in self.columns.items()}
        for role, column in self.columns.items():
            if column.measured and texts[role][-1:].isdigit() and float(said[role]):
                raise ValueError(f"expected a unit behind {texts[role]!r}, as others have")
        when, pose = self._moment(said, factors), [np.nan] * 3
        apart = "pose_" * ("pose_x" in said)
        roles = ("heading", f"{apart}x", f"{apart}y")
        if self.layout.beams and not any(texts.get(role) for role in roles):
            pose = self.pose
        elif {*roles} <= {*said} and (self.layout.beams or apart or "angle" in said):
            pose = [number_field(said[role], role, factors[role]) for role in roles]
        if self.layout.beams:
            if not any(fields[k] for k in self.layout.beams.ranges):  # of another topic
                self.pose, self.between = pose, (POSE_OF_ROW,)
                return
            heading, x, y = pose
            found = scan_in(fields, self.layout.beams)
            self.scans.append(replace(found, time=when, odometry=known(np.array([x, y, heading]))))
            self._note_words(fields)
            return
        if {"angle", "range"} <= {*said}:
            angle = direction_field(said["angle"], factors["angle"])
            far = distance(said["range"], factors["range"])
        else:
            x, y = (number_field(said[role], role, factors[role]) for role in ("x", "y"))
            angle, far = float(np.arctan2(y, x)), float(np.hypot(x, y)) or np.nan
        if "error" in said and said["error"].strip("0") not in ("", "x", "X", "."):
            far = np.nan
        if "new" in said:
            self.turns += said["new"].lower() in ("true", "1", "1.0", "s")
        turn = float(self.turns)
        number = number_field(said["scan"], "the scan") if "scan" in said else turn
        self.scans.append((angle, far, when, number, *pose))
        self._note_words(fields)

    def _note_words(self, fields: Sequence[str]) -> None:
        """Keep what each other column says of a beam or scan, while it says few things."""
        if self.apart is None:
            self.apart = {k: [] for k in range(len(fields)) if k not in self.places}
            self.words = {k: {} for k in self.apart}
        for k, said in [*self.apart.items()]:
            value = fields[k].strip() if k < len(fields) else ""
            kinds, last = self.words[k], said[-1] if said else 0
            kind = kinds.setdefault(value.casefold(), (len(kinds), value)) if value else (last,)
            said.append(kind[0])
            if len(kinds) > MOST_SENSORS:
                del self.apart[k]

    def _of_several(self, measured: Array) -> tuple[str, ...]:
        """What is told of columns that may say who measured, of beams as `beams_in` has them."""
        found, scan = [], measured[1].astype(int)
        for k, said in (self.apart or {}).items():
            values = [value for _, value in self.words[k].values()]
            if len(values) < 2:
                continue
            names = self.layout.names
            name = names[k] if k < len(names) else f"column {k + 1}"
            what = f"{name!r} holds {', '.join(values[:MOST_WORDS])}"
            alone = "records of each in a file of their own are logs"
            split = alone if self.layout.labels else f"{parted(self.layout, k)} parts them"
            who = np.array(said)
            if parts_sensors(who[scan] if self.layout.beams else who, *measured):
                raise LogError(self.lines.path, f"{what}: expected one sensor a log; {split}")
            words = k == self.layout.columns.sensor or np.isnan(as_numbers(values[:1])).all()
            seldom = len(values) <= MOST_WORDS and np.count_nonzero(np.diff(who)) <= scan.max(
                initial=0
            )
            if words and seldom and not {"true", "false"} & {*map(str.lower, values)}:
                told = f"{what} and is left out: if these are sensors, each has its log; {split}"
                found.append(told)
        return tuple(found)

    def _moment(self, said: Mapping[str, str], factors: Mapping[str, float]) -> float:
        """Seconds of a line; of times of the day those behind midnight go on."""
        if not (text := said.get("time", "") or self.stamp):
            return np.nan
        if not is_number(text):
            when = moment(text)
            when += DAY_S if self.clock - when > DAY_S / 2 else 0.0
        elif "time" not in said:
            when = time(text)
        else:
            parts = [role for role in ("time", "nanosec") if role in said]
            when = sum(time(said[role], unit=factors[role]) for role in parts)
        self.clock = when
        return when

    def _log(self, name: str) -> Log:
        if self.stamp:
            self.assumed += ("times are those that stand before, or between, the beams",)
        if self.layout.beams:
            told = (*self.assumed, *self.between, *self._of_several(by_beam(self.scans)))
            return Log(name, self.scans, None, self.lines.skipped, assumed=told)
        table = np.array(self.scans)
        if self.stamp and np.ptp(table[:, 2]) == 0:  # one for all tells nothing
            table[:, 2], self.assumed = np.nan, self.assumed[:-1]
        if not {"angle", "range"} <= {*self.columns}:  # points: a turn ends where it began
            table[:, 0] = from_first(table[:, 0])
        self.assumed += self.between
        if self.turns or {"scan", "new"} & {*self.columns}:
            ends = np.flatnonzero(np.diff(table[:, 3])).tolist()
        elif is_time_of_turns(table[:, 2], table[:, 0]):
            ends = np.flatnonzero(np.diff(table[:, 2])).tolist()
            self.assumed += ("a scan ends where its time does",)
        else:  # nothing numbers them
            ends, how = ends_of_turns(table[:, 0])
            self.assumed += (f"a scan ends where the angle {how}",) * bool(ends)
        parts = np.split(table, [end + 1 for end in ends])
        self.assumed += self._of_several(beams_in(parts))
        if max(map(len, parts)) > MOST_BEAMS_READ:
            raise self.lines.error(
                f"expected at most {MOST_BEAMS_READ} beams in a scan: where does one end?"
            )
        if np.isfinite(table[0, 4]):
            self.assumed += (place_of(np.zeros(3)),)
        scans = [self._scan(part) for part in parts]
        return Log(name, scans, None, self.lines.skipped, assumed=self.assumed)

    def _scan(self, part: Array) -> LaserScan:
        heading, x, y = part[0, 4:]
        angles, ranges, times = part[:, :3].T
        time, delays = times[0], None
        if self.clockwise:
            angles, ranges, times = -angles[::-1], ranges[::-1], times[::-1]
        if np.ptp(times) > 0:  # neither unknown nor one time for all
            time, delays = times.min(), times - times.min()
        return LaserScan(ranges, angles, time, known(np.array([x, y, heading])), delays=delays)


def reader_of(layout: Callable[[Path], Layout | None]) -> Callable[[Path, str, str], Log]:
    """What reads a file that is written as `layout` tells."""
    return lambda path, name, on_error: _read_table(path, name, on_error, layout(path))


@checked
def read_csv(
    path: str | Path,
    *,
    columns: str | Sequence[str] | None = None,
    clockwise: bool = False,
    on_error: OnError = "raise",
) -> Log:
    """Read a table with a beam a line, whose columns the caller names.

    Fields lie between commas, semicolons, tabs or white space. A scan ends where the column `scan`
    changes or, without one, where a time that lasts for a turn does, or the angle wraps or turns.

    Parameters
    ----------
    columns : list of str, or one str with commas
        Names of the columns from the left, with units: `angle_deg` or `angle_rad`, `range_m`,
        `range_cm`, `range_mm`, `range_ft` or `range_in`; where the file has them `time_s`,
        `time_ms`, `time_us` or `time_ns`, and `scan`; any other name for a column to leave out.
        Instead of the header's, where the file has one. None takes what `read` does.
    clockwise : bool
        Whether angles grow clockwise, seen from above, as those of most cheap sensors do. Scans are
        turned round then.
    on_error : "raise" or "skip"
        As in `read`.

    Raises
    ------
    LogError
        As in `read`, and where nothing says columns or units.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "mine.csv"
    ...     _ = path.write_text("0;1500\\n90;2000\\n180;0\\n0;1510\\n90;2010\\n180;900\\n")
    ...     log = read_csv(path, columns=["angle_deg", "range_mm"])
    >>> log, log[1].ranges
    (Log('mine', 2 scans, no odometry, no truth), array([1.51, 2.01, 0.9 ]))
    """
    names = columns.split(",") if isinstance(columns, str) else columns
    if names is not None:
        if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
            raise ValueError(
                f"columns must be a list of names, such as {EXAMPLE}, got {brief(columns)}"
            )
        if fault := _unsaid(found := named(names)):
            raise ValueError(f"columns must name angle and range with units: {fault}")
    from ._messages import log_of_records, records_of  # which read by this module

    with log_file(path) as place:
        if names and (records := records_of(place)):
            return log_of_records(records, place, stem(place), on_error, names, clockwise)
        if names is None:
            return _read_table(place, stem(place), on_error, stated(place), clockwise)
        separator, line = begin_of(place)
        layout = as_written(Layout(separator, line, tuple(names), found), sample(place))
        log = _read_table(place, stem(place), on_error, layout, clockwise)
        if (left := log.skipped).lines > (rows := sum(map(len, log))):
            count, chosen = left.lines + rows, ",".join(names)
            raise LogError(place, f"{left.lines} of {count} lines are no {chosen}: {left.reason}")
        return log


def _unsaid(found: Columns) -> str:
    """What names of a caller do not say; empty where they say all."""
    if found.twice:
        return found.twice
    for role in ("x", "y") if "x" in found.by_role else ("angle", "range"):
        if role not in found.by_role:
            return f"no column is the {role}, such as {EXAMPLE}"
        if found.by_role[role].factor is None:
            return f"the unit of {found.by_role[role].name!r} is not said, such as {EXAMPLE}"
    return ""


def stated(path: Path) -> Layout:
    """What a file says of its columns: must be enough."""
    found = layout_of(path)
    if found is None:
        raise LogError(path, f"no header names angle and range: name the columns, {EXAMPLE}")
    if fault := wanting(found, rows_below(found, sample(path))):
        raise HeadError(path, fault, found.line)
    return found


def _read_table(
    path: Path, name: str, on_error: str, layout: Layout | None, clockwise: bool = False
) -> Log:
    lines = Lines(path, on_error, "\n", TABLE_COMMENTS)
    return Table(lines, cast(Layout, layout), clockwise).walked()._log(name)
