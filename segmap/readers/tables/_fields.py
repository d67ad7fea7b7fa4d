"""The fields of a line of any table: what separates them, numbers, names beside them, and times."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path

import numpy as np

from ...arrays import Array
from .._lines import Lines, LogError, is_number
from ._columns import COLUMN_UNITS, UNIT_ROLES, Columns, named

#: So many lines tell what a file is.
SAMPLE_LINES = 2000
#: A first line of Excel that names the separator.
SEPARATOR_LINE = re.compile(r"(?i)sep=(.)")
#: Units that stand behind a number -> what makes metres, radians or seconds of it.
FACTORS = {**COLUMN_UNITS["time"], **COLUMN_UNITS["angle"], **COLUMN_UNITS["x"]}
#: The same, the longer ones first.
UNIT = "|".join(map(re.escape, sorted(FACTORS)[::-1]))
#: A name, its number and perhaps a unit, in a line where each field has its name.
LABEL = re.compile(
    r"([A-Za-z_]+(?:[(\[]\w+[)\]])?)[\"']?\s*[:=]\s*[\"']?([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)"
    rf"(?:\s*[(\[]?({UNIT})[)\]]?(?!\s*[:=]))?(?![\w.])"
)
#: A whole number in thousands, or one with three decimals.
THOUSANDS = re.compile(r"[0-9]{1,3}(,[0-9]{3})+")
#: Numbers with a mark of thousands, and another one before their decimals.
BOTH_MARKS = re.compile(r"[-+]?[0-9]{1,3}(?:(,[0-9]{3})+\.|(\.[0-9]{3})+,)[0-9]*")
#: What may be a number.
NUMERAL = re.compile(r"[-+0-9.,eE]+")
#: A number with its unit behind it.
MEASURE = re.compile(rf"([-+]?[0-9.,]+(?:[eE][-+]?[0-9]+)?)\s*[(\[]?({UNIT})[)\]]?")
#: Between a number and its unit, where white space separates fields.
BEFORE_UNIT = re.compile(rf"(?<=[0-9.])\s+(?=({UNIT})(\s|$))")
#: A number before all others of a line: `1.5: 2.0, 2.1`.
LEADING = re.compile(r"^([-+]?[0-9.]+)\s*:\s+")
#: Numbers with decimal commas between white space.
DECIMAL_COMMAS = re.compile(r"[-+]?[0-9]+(,[0-9]+)?(\s+[-+]?[0-9]+(,[0-9]+)?)+")
#: Beams of one scan in brackets, ...
TUPLE = re.compile(r"[(\[]([^()\[\]]+)[)\]]")
#: ... and how the first of them begins.
NESTED = re.compile(r"[(\[]\s*[(\[]")
#: What a program prints about a list of numbers, and Python about bytes.
LIST = re.compile(
    r"^(\d*: *)?(array\()?('\w', ?)?[\[(]+|[\])]+$|^b['\"]|(\\r)?(\\n)?(?<=\\n)['\"]$"
)
#: What RPLidar's programs print before the first beam of a turn.
FIRST_BEAM = re.compile(r"^S\s+(?=[-+.0-9])")
#: What stands before a line that a program prints, with its time: of ROS, a serial monitor,
#: Python's logging, glog.
LOGGED = re.compile(
    r"^(?:\[ *[A-Z]+\] \[([0-9.]+)\](?: \[[\w./]+\])?: |(\d\d:\d\d:\d\d\.\d+) -> ?"
    r"|(\d{4}-\d\d-\d\d[ T]\d\d:\d\d:\d\d(?:[.,]\d+)?)\W+(?:DEBUG|INFO|WARN\w*|ERROR)\W+"
    r"|[IWEF]\d{4} (\d\d:\d\d:\d\d\.\d+) +\d+ \S+\] ?)"
)
#: A time since 1970, in seconds or parts of them, in a line of words.
SECONDS_SINCE_1970 = re.compile(r"(?<![\d.])1\d{9}(?:\.\d+|\d{3}|\d{6}|\d{9})?(?!\d)")
#: A list that Python prints as an array.
ARRAY = re.compile(r"^array\('\w', *(?=\[)")
#: Separators of fields; the first that most lines hold is theirs.
SEPARATORS = ";\t|,"
#: How lines begin that are no rows.
TABLE_COMMENTS = ("#", "%", "//", "---", "!", "; ", '"#')
#: The time of the day, ...
TIME_OF_DAY = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}(?:\.\d+)?)(?: ?([AP])M)?", re.IGNORECASE)
#: ... and a day before it that is no ISO 8601.
NUMBERED_DAY = re.compile(r"(\d{1,2})([.-])(\d{1,2})\2(\d{4})\.? +")


def split(line: str, separator: str | None) -> list[str]:
    """The fields of a line; white space separates them where nothing else does."""
    if separator is None:
        line = FIRST_BEAM.sub("", BEFORE_UNIT.sub("", re.sub(r"\s+(?=[\[(])", "", line)))
    line = LIST.sub("", LOGGED.sub("", line))
    line = LEADING.sub(rf"\1{(separator or ' ')[0]}", line)
    if separator is not None and len(separator) > 1:
        white = r"|\s+" * (" " in separator)
        fields = re.split(rf"\s*[{re.escape(separator.strip(' '))}]\s*{white}", line.strip())
    else:
        fields = line.split(separator)
    if separator is not None and len(separator) == 1 and '"' in line:
        with suppress(csv.Error):
            fields = next(csv.reader([line], delimiter=separator, skipinitialspace=True), fields)
    return [ARRAY.sub("", field.strip().strip("\"'")) for field in fields]


def listed(field: str) -> list[str]:
    """The numbers of a field that is a list in brackets; another field alone."""
    return re.findall(r"[^\s,;()\[\]]+", field) if field.startswith(("(", "[")) else [field]


def labelled(line: str) -> Iterator[dict[str, str]]:
    """The numbers of each beam in a line by their names, each with the unit behind its number."""
    said: dict[str, str] = {}
    for name, number, unit in LABEL.findall(line):
        label = f"{name} {unit}".strip()
        if label in said:
            yield said
            said = {}
        said[label] = number
    yield said


def separator_of(lines: Sequence[str]) -> str | None:
    """What separates the fields of most lines; two marks where fields are lists of numbers."""
    for mark in SEPARATORS:
        if 2 * sum(mark in line for line in lines) > len(lines):
            commas = mark == "," and sum(bool(DECIMAL_COMMAS.fullmatch(line)) for line in lines)
            if 2 * commas > len(lines):
                return None
            rows = [split(line, mark) for line in lines if any(map(is_number, split(line, mark)))]
            for inner in ", ":
                lists = sum(any(_is_list(field, inner) for field in row) for row in rows)
                if inner != mark and 2 * lists > len(rows):
                    return mark + inner
            return mark
    return None


def _is_list(field: str, mark: str) -> bool:
    """Whether a field is numbers with a mark between them, and none itself."""
    if mark not in field or is_number(decimal(field)):
        return False
    return all(is_number(part) for part in field.split(mark) if part)


def decimal(field: str, *, thousands: bool = False) -> str:
    """A number with a point for its decimals, and no mark of thousands, as a comma alone may be.

    With a unit behind it: in metres, radians or seconds.

    Examples
    --------
    >>> decimal("2000,5"), decimal("2.000,5"), decimal("2,000.5"), decimal("0x10")
    ('2000.5', '2000.5', '2000.5', '16')
    >>> decimal("1,25 m"), decimal("850mm"), decimal("90 deg")
    ('1.25', '0.85', '1.5707963267948966')
    """
    if field and not field[-1].isdigit() and (found := MEASURE.fullmatch(field)):
        number = decimal(found[1], thousands=thousands)
        return str(float(number) * FACTORS[found[2]]) if is_number(number) else field
    if field.startswith("0x"):
        with suppress(ValueError):
            return str(int(field, 16))
    if field.isascii() and "," not in field and "'" not in field:
        return field
    bare = re.sub("[\u00a0\u202f']", "", field)  # thousands in France and Switzerland
    if not NUMERAL.fullmatch(bare):
        return field
    bare = bare.replace(",", "") if thousands else bare
    if "," in bare and "." in bare:
        if not BOTH_MARKS.fullmatch(bare):
            return field
        bare = bare.replace(min(",.", key=bare.rfind), "")
    return bare.replace(",", ".", 1)


def as_numbers(row: Sequence[str], *, thousands: bool = False) -> list[float]:
    """Numbers of fields; NaN of others, seconds of a time of the wall."""
    texts = (decimal(field, thousands=thousands) for field in row)
    return [float(text) if is_number(text) else moment(text) for text in texts]


def is_row(fields: Sequence[str]) -> bool:
    """Whether a line holds numbers, and but one no names."""
    others = [field for field in fields if not is_number(field)]
    count = len(fields) - len(others)
    return count > 1 or (count == 1 and not named(others).by_role)


def number_rows(fields: Sequence[Sequence[str]]) -> Array:
    """The rows that are numbers, as many as most rows have; `(m, k)`, NaN in columns of texts."""
    if not fields:
        return np.empty((0, 0))
    lengths = [len(row) for row in fields]
    count = max(max(set(lengths), key=lengths.count), 1)
    table = np.array([as_numbers(row) for row in fields if len(row) == count])
    table = table.reshape(-1, count)
    texts = np.isnan(table).all(0)
    return table[np.isfinite(table[:, ~texts]).all(1)]


def moment(field: str) -> float:
    """Seconds of a time of the wall: ISO 8601, since 1970, or the time of day; else NaN.

    A day whose month may be either number is none, unless points or AM and PM tell.

    Examples
    --------
    >>> moment("1970-01-02T00:00:00.5Z"), moment("01:00:02,25"), moment("1/13/1970 1:00:00 PM")
    (86400.5, 3602.25, 1083600.0)
    """
    text = field.replace(",", ".").replace("/", "-")
    day = NUMBERED_DAY.match(text)
    clock = TIME_OF_DAY.fullmatch(text, day.end() if day else 0)
    with suppress(ValueError, OverflowError):
        if clock is None:
            found = datetime.fromisoformat(text)
            return (found if found.tzinfo else found.replace(tzinfo=UTC)).timestamp()
        hour, half = int(clock[1]), (clock[4] or "").upper()
        hour = hour % 12 + 12 * (half == "P") if half else hour
        since = _midnight(int(day[1]), int(day[3]), int(day[4]), day[2], half) if day else 0.0
        return since + 3600 * hour + 60 * int(clock[2]) + float(clock[3])
    return np.nan


def _midnight(first: int, second: int, year: int, mark: str, half: str) -> float:
    """Seconds from 1970 to a day; NaN where nothing tells which number is the month."""
    is_american = mark == "-" and (bool(half) or second > 12)
    if mark == "-" and not half and max(first, second) <= 12 and first != second:
        return np.nan
    day, month = (second, first) if is_american else (first, second)
    return datetime(year, month, day, tzinfo=UTC).timestamp()


def stamp_in(line: str) -> str:
    """The time that stands before a line, or in one that is no beam, as text; empty without.

    Examples
    --------
    >>> stamp_in("10:23:45.120 -> 12,1803"), stamp_in("Speed: 10 RPM, Timestamp: 28000 ms")
    ('10:23:45.120', '28.0')
    """
    if found := LOGGED.match(line):
        return next(filter(None, found.groups()))
    for label, number in next(labelled(line)).items():
        clock = named([label]).by_role.get("time")
        if clock and clock.factor:
            return str(float(number) * clock.factor)
    return epoch_in(line)


def epoch_in(text: str) -> str:
    """The seconds since 1970 that stand among words; empty without."""
    if found := SECONDS_SINCE_1970.search(text):
        return str(float(found[0]) / 10.0 ** (len(found[0].partition(".")[0]) - 10))
    return ""


def sample(path: Path, count: int = SAMPLE_LINES) -> list[tuple[int, str]]:
    """The first lines of a file that are not empty, comments too, with their numbers."""
    lines = Lines(path, "skip", "\n", comments="")
    with suppress(LogError):
        return [(lines.number, fields[0]) for fields in islice(lines, count)]
    return []


def names_by_units(rows: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """Names of columns whose numbers have units behind them; none where these do not tell."""
    units = [found[2] if (found := MEASURE.fullmatch(field)) else "" for field in rows[0]]
    roles = [UNIT_ROLES.get(unit, "-") for unit in units]
    return tuple(roles) if {"angle", "range"} <= {*roles} else ()


def with_units_behind(columns: Columns, rows: Sequence[Sequence[str]]) -> Columns:
    """Columns, of which those with a unit behind each number need none of their name."""
    found = dict(columns.by_role)
    for role, column in found.items():
        fields = [row[column.place] for row in rows if len(row) > column.place]
        if any(map(MEASURE.fullmatch, fields)):
            found[role] = column._replace(factor=1.0, measured=True)
    return columns._replace(by_role=found)
