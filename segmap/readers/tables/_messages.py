"""Records with a name beside each value, over several lines: the rows of a table all the same.

    ranges: [2.0, 2.1, ...]   among other keys, `---` after each scan      rostopic echo /scan
    header { stamp {          and so on, names repeated                    gz topic -e of Gazebo
    # name: ranges            before its rows                              matrices of Octave
    90,123.91,122.            degrees and centimetres                      programs for a radar
    {"ranges": [...], ...}    over lines or not, one after the other or in a list; scans, beams,
                              or lists of both                             JSON
    sRA LMDscandata 1 1 ...   numbers in hexadecimal                       CoLa A of SICK
    [timestamp], [scan]       each in a line, with its values in the next  UrgBenri of Hokuyo

What a name means, and its unit, is as in any table; `[[15, 12.3, 1234], ...]` is what the package
rplidar gives. Of a telegram 90 degrees of the sensor are straight ahead and 0 is no measurement.

Assumed: a telegram's time is that since the sensor was started, and those of UrgBenri are in
milliseconds.
"""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain, islice, pairwise
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np

from ...scans import Log
from ...scans.error_codes import as_ranges
from .._lines import HeadError, Lines, LogError
from ._columns import named, proposed_names
from ._fields import SAMPLE_LINES, sample
from ._layout import SHOWN_ROWS, Layout, wanting
from ._table import CUT, Table
from ._wide import SHORTENED, of_records

#: So many lines hold the names of a message.
ECHO_SAMPLE_LINES = 60
#: A text over several lines is not longer, in bytes.
MOST_JSON_BYTES = 1 << 28
#: Ends a message.
END_OF_MESSAGE = "---"
#: What SICK's sensors answer to the wish for a scan, or send by themselves.
TELEGRAM = re.compile(r"s(?:RA|SN) LMDscandata ([^\x02\x03]*)")
#: Which field of a telegram is its time, ...
TELEGRAM_TIME = 7
#: ... and which says how many encoders follow, before the channels.
TELEGRAM_ENCODERS = 16
#: Fields of a channel before its values.
CHANNEL_FIELDS = 6
#: What a telegram counts angles in.
SICK_STEP_RAD = np.radians(1e-4)

#: Larger values of a Hokuyo mean that nothing was met.
MOST_OF_URG_MM = 60_000
#: Of lists of more numbers each is a scan, and no beam.
MOST_BEAM_FIELDS = 8
DECODER = json.JSONDecoder()
#: A key of YAML before its value.
BARE_KEY = re.compile(r"([{,]\s*)([A-Za-z_]\w*):")
#: How Gazebo's text of a message begins.
HEAD_OF_GAZEBO = "header {"
#: Before each matrix that Octave saves.
OCTAVE_NAME = re.compile(r"# name: (\w+)")
#: Pairs of whole degrees and centimetres, without an end of a line.
RADAR_PAIR = re.compile(r"(0|[1-9]\d{0,2}),(0|[1-9]\d{0,3})\.")
RADAR = re.compile(rf"({RADAR_PAIR.pattern}){{6,}}(\d{{1,3}},?)?\d{{0,4}}")
#: Its servo goes on by so many degrees at most, each time by as many, or back to the first.
MOST_RADAR_STEP_DEG = 30
TOLD_OF_RADAR = ("pairs are degrees and centimetres, as programs for a radar have them",)
#: What stands between values of JSON.
BETWEEN_JSON = re.compile(r"[\s,]*")

#: The number of the line where a record ends, and what it says.
Record = tuple[int, Mapping[str, str]]
#: What a telegram of SICK and a log of UrgBenri leave unsaid.
TOLD_OF_TELEGRAMS = (
    "90 degrees of the sensor are straight ahead",
    "times are those since the sensor was started",
)
TOLD_OF_URG_BENRI = ("times are in milliseconds",)


class Records(NamedTuple):
    """What gives the records of a file, each with its line, and what they leave unsaid."""

    each: Callable[[Lines], Iterator[Record]]
    told: tuple[str, ...] = ()


def log_of_records(
    records: Records,
    path: Path,
    name: str,
    on_error: str,
    names: Sequence[str] = (),
    clockwise: bool = False,
) -> Log:
    """A log of records with names beside their values; the caller may name these himself."""
    lines = Lines(path, on_error, "\n", comments="")
    found = records.each(lines)
    first = list(islice(found, SAMPLE_LINES))
    if not first:
        raise lines.no_scan("records of scans or beams")
    if len(names) > len(first[0][1]):
        raise LogError(path, f"its records hold {', '.join(first[0][1])}: a name for each")
    layout, table = of_records(path, [said for _, said in first], names)
    if layout.beams is None and (fault := wanting(layout, table)):
        raise HeadError(path, fault, first[0][0])
    reader = Table(lines, layout._replace(told=(*records.told, *layout.told)), clockwise)
    for lines.number, said in chain(first, found):
        try:
            reader.take_record(said)
        except ValueError as fault:
            lines.damaged(lines.error(f"before it a scan is damaged ({fault})"))
    if not reader.scans:
        raise lines.no_scan("records of scans or beams")
    return reader._log(name)


def shown_records(records: Records, path: Path) -> tuple[list[str], list[list[str]]]:
    """What `first_rows` shows of records: nothing where each is a scan."""
    found = (said for _, said in records.each(Lines(path, "skip", "\n", comments="")))
    held = list(islice(found, SAMPLE_LINES))
    layout, table = of_records(path, held) if held else (Layout(None, 0, ()), np.empty(0))
    if layout.beams or not held:
        return [], []
    return proposed_names(layout.names, table), [[*said.values()] for said in held[:SHOWN_ROWS]]


def records_of(path: Path) -> Records | None:
    """The records of a file; None of a file that has none."""
    texts = [text.strip() for _, text in sample(path, ECHO_SAMPLE_LINES)]
    words = {text.split(":")[0].strip() for text in texts}
    if "angle_min" in words and words & {"angle_increment", "angle_step"}:
        return Records(_echoed)
    if any(OCTAVE_NAME.match(text) for text in texts):
        return Records(_octave)
    if texts and _is_radar(texts[0]):
        return Records(_radar, TOLD_OF_RADAR)
    if any(map(TELEGRAM.search, texts)):
        return Records(_telegrams, TOLD_OF_TELEGRAMS)
    if "[timestamp]" in words and "[totalSteps]" in words:
        return Records(_urg_benri, TOLD_OF_URG_BENRI)
    if texts and texts[0].startswith(("{", "[")) and next(_json(Lines(path, "skip")), None):
        return Records(_json)
    return None


def read_named_records(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a file of records."""
    return log_of_records(cast(Records, records_of(path)), path, name, on_error)


# ------------------------------------------------------------------------ ROS
def _echoed(lines: Lines) -> Iterator[Record]:
    """Values of each message by their names, without the names of what holds them."""
    said: dict[str, list[str]] = {}
    key, number = "", 0
    for (text,) in lines:
        number = lines.number
        if text == END_OF_MESSAGE or (text == HEAD_OF_GAZEBO and "ranges" in said):
            if said:
                yield number, _message_texts(lines, said)
            said, key = {}, ""
            continue
        if text.endswith("{") or text == "}":
            continue
        if found := re.match(r"-?\s*([A-Za-z_]\w*):\s*(.*)", text):
            key, text = found[1].replace("angle_step", "angle_increment"), found[2]
            said.setdefault(key, [])
        values = text.removeprefix("- ") if not text.startswith("[") else text
        said.setdefault(key, []).extend(
            value.replace(".nan", "nan").replace(".inf", "inf")
            for value in (v.strip(" []'\"") for v in values.split(","))
            if value
        )
    if "ranges" in said:
        whole = text.startswith("[") and not text.endswith("]")
        yield number, _message_texts(lines, said) | ({CUT: ""} if whole else {})
    elif said and not lines.first and "angle_min" in said:
        raise LogError(lines.path, "is cut off within a message", number)


def _message_texts(lines: Lines, said: Mapping[str, Sequence[str]]) -> dict[str, str]:
    lists = ("ranges", "intensities")
    if any("..." in value or value.startswith("<") for value in said.get("ranges", ())):
        raise LogError(lines.path, SHORTENED, lines.number)
    said = {k: v for k, v in said.items() if v or k in lists}
    return {k: f"[{' '.join(v)}]" if k in lists else " ".join(v) for k, v in said.items()}


# ------------------------------------------------------------------------ JSON
def _json(lines: Lines) -> Iterator[Record]:
    """The scans or beams of all values in a text, as far as it is JSON."""
    text = lines.text(MOST_JSON_BYTES)
    if BARE_KEY.match(text):  # the flow style of YAML, as `ros2 topic echo --flow-style` has it
        text = BARE_KEY.sub(r'\1"\2":', re.sub(r"(?m)^---$", "", text).replace("'", '"'))
        text = re.sub(r":\s*([A-Za-z_/][\w/]*)(?=\s*[,}])", r': "\1"', text)
        text = text.replace(".nan", "NaN").replace(".inf", "Infinity")
    at, number, scans = 0, 1, list[tuple[int, list[dict[str, str]]]]()
    while at < len(text):
        begin = BETWEEN_JSON.match(text, at).end()  # type: ignore[union-attr]
        try:
            value, end = DECODER.raw_decode(text, begin)
            found = list(_scans_in(value))
        except (ValueError, RecursionError) as fault:
            if not text[begin:]:
                break
            if not scans:
                return
            number += text.count("\n", at, begin)
            lines.damaged(LogError(lines.path, f"expected JSON ({fault})", number))
            at, end = begin, text.find("\n", begin) + 1 or len(text)
            found = []
        number += text.count("\n", at, end)
        at = end
        scans += [(number, scan) for scan in found]
    several = any(len(scan) > 1 for _, scan in scans) and len(scans) > 1
    for turn, (number, scan) in enumerate(scans):
        mark = {"scan": str(turn)} if several else {}
        yield from ((number, mark | said) for said in scan)


def _scans_in(value: Any) -> Iterator[list[dict[str, str]]]:
    """Scans in a value of JSON, each by its beams, or by one record that holds them all."""
    if isinstance(value, dict):
        first = next(iter(value.values()), None)
        if isinstance(first, dict) and "0" in first:  # columns of pandas, by their rows
            value = {k: [*v.values()] if isinstance(v, dict) else v for k, v in value.items()}
        held = _flattened(value)
        lists = {k: v for k, v in held.items() if isinstance(v, list) and v}
        shared = {k: _json_text(v) for k, v in held.items() if k not in lists}
        deep = [v for v in lists.values() if isinstance(v[0], list | dict)]
        parts = [v for v in deep if isinstance(v[0], dict)] or deep * (len(lists) == 1)
        for part in parts[:1]:
            yield from ([shared | beam for beam in scan] for scan in _scans_in(part))
        if not deep and named([*lists]).enough and len({*map(len, lists.values())}) == 1:
            rows = zip(*lists.values(), strict=True)  # a list a column
            yield [shared | dict(zip(lists, map(_json_text, row), strict=True)) for row in rows]
        elif not deep:
            yield [{k: _json_text(v) for k, v in held.items()}]
        elif not parts:  # an array a name, in which a row is a scan
            count = len(deep[0])
            for k in range(count):
                row = {n: v[k] if len(v) == count else v for n, v in lists.items()}
                yield [shared | {n: _json_text(v) for n, v in row.items()}]
    elif isinstance(value, list) and value:
        kinds = {type(part) for part in value}
        inner = {type(part) for each in value if isinstance(each, list) for part in each}
        if kinds == {dict} and not any(isinstance(v, list | dict) for v in value[0].values()):
            yield [{k: _json_text(v) for k, v in beam.items()} for beam in value]
        elif kinds == {list} and not inner & {list, dict} and len(value[0]) <= MOST_BEAM_FIELDS:
            yield [{str(k): _json_text(v) for k, v in enumerate(beam)} for beam in value]
        elif kinds == {list} and not inner & {list, dict}:
            yield from ([{"ranges": _json_text(row)}] for row in value)
        else:
            for part in value:
                yield from _scans_in(part)


def _flattened(value: Mapping[str, Any], begin: str = "") -> dict[str, Any]:
    """Values by names that lead to them, with points between."""
    found: dict[str, Any] = {}
    for name, held in value.items():
        inner = isinstance(held, dict)
        found |= _flattened(held, f"{begin}{name}.") if inner else {begin + name: held}
    return found


def _json_text(value: Any) -> str:
    if isinstance(value, list):
        return f"[{' '.join(map(_json_text, value))}]"
    return "nan" if value is None else str(value)


def _octave(lines: Lines) -> Iterator[Record]:
    """Matrices with names, as Octave saves them: the rows of the largest are scans."""
    held: dict[str, list[list[str]]] = {}
    for (text,) in lines:
        if found := OCTAVE_NAME.match(text):
            rows = held.setdefault(found[1], [])
        elif held and not text.startswith("#"):
            rows.append(text.split())
    matrices = [rows for rows in held.values() if rows]
    if not matrices:
        return
    longest = max(matrices, key=lambda rows: (len(rows), len(rows[0])))
    value = {n: rows if rows is longest else rows[0] for n, rows in held.items() if rows}
    if len(longest) > 1 and len(longest[0]) == 1:
        value = {n: [row[0] for row in rows] for n, rows in held.items() if rows}
    yield from ((lines.number, said) for scan in _scans_in(value) for said in scan)


def _is_radar(text: str) -> bool:
    """Whether it is pairs of a radar, and not numbers with a point: `1,2.500,2.510`."""
    if not RADAR.fullmatch(text):
        return False
    angles = [int(angle) for angle, _ in RADAR_PAIR.findall(text)]
    ways = [abs(b - a) for a, b in pairwise(angles) if b not in (a, angles[0])]
    return len({*ways}) == 1 and ways[0] <= MOST_RADAR_STEP_DEG and max(angles) <= 360


def _radar(lines: Lines) -> Iterator[Record]:
    """What a sonar or laser on a servo sends that is drawn as a radar: `90,123.91,122.`."""
    for (text,) in lines:
        for angle, far in RADAR_PAIR.findall(text):
            yield lines.number, {"angle_deg": angle, "range_cm": far}


# --------------------------------------------------------------------- sensors
def _telegrams(lines: Lines) -> Iterator[Record]:
    """Telegrams of SICK: head, channels of 16 bits, of which DIST1 holds millimetres."""
    for (text,) in lines:
        for telegram in TELEGRAM.findall(text):
            yield from _record_or_damage(
                lines, "telegram of LMDscandata", _telegram, telegram.split()
            )


def _record_or_damage(
    lines: Lines, what: str, parse: Callable[[Any], Mapping[str, str]], given: Any
) -> Iterator[Record]:
    """One record; a damaged one is told or counted."""
    try:
        yield lines.number, parse(given)
    except (ValueError, ArithmeticError, LookupError, TypeError, struct.error) as fault:
        lines.damaged(lines.error(f"expected a whole {what} ({fault})"))


def _telegram(fields: Sequence[str]) -> dict[str, str]:
    at = TELEGRAM_ENCODERS + 1 + 2 * _number(fields[TELEGRAM_ENCODERS])
    for _ in range(_number(fields[at])):
        name, scale, offset, first, step, count, *data = fields[at + 1 :]
        if name == "DIST1":
            break
        at += CHANNEL_FIELDS + _number(count)
    else:
        raise ValueError("no DIST1 in it")
    if not 0 < _number(count) <= len(data):
        raise ValueError(f"announces {_number(count)} ranges, but {len(data)} fields follow")
    values = np.array([_number(field) for field in data[: _number(count)]])
    ranges = np.where(values > 0, values * _real(scale) + _real(offset), 0) / 1000
    begin = (_number(first) + 2**31) % 2**32 - 2**31
    return {
        "time_us": str(_number(fields[TELEGRAM_TIME])),
        "angle_min": str(begin * SICK_STEP_RAD - np.pi / 2),
        "angle_increment": str(_number(step) * SICK_STEP_RAD),
        "ranges": _json_text(np.where(ranges > 0, ranges, np.nan).tolist()),
    }


def _number(field: str) -> int:
    """A number of a telegram: hexadecimal, or decimal with a sign before it."""
    return int(field) if field.startswith(("+", "-")) else int(field, 16)


def _real(field: str) -> float:
    return float(struct.unpack(">f", bytes.fromhex(field.zfill(8)))[0])


def _urg_benri(lines: Lines) -> Iterator[Record]:
    """Scans of UrgBenri, whose steps count from behind to the left."""
    said: dict[str, str] = {}
    key = ""
    for (text,) in lines:
        if found := re.fullmatch(r"\[(\w+)\]", text):
            key = found[1]
        elif key:
            said[key] = text
            if key == "scan":
                yield from _record_or_damage(
                    lines, "scan of UrgBenri", _scan_of_urg_benri, dict(said)
                )
            key = ""


def _scan_of_urg_benri(said: Mapping[str, str]) -> dict[str, str]:
    keys = ("totalSteps", "frontStep", "startStep")
    total, front, first = (float(said.get(key, "nan")) for key in keys)
    parts = said["scan"].strip(";").split(";")
    found = np.array([float(re.split("[&|]", part)[0]) for part in parts])  # the first echo
    ranges = np.where(found > MOST_OF_URG_MM, np.inf, as_ranges(found)[0])
    step = 2 * np.pi / total * float(said.get("grouping", 1) or 1)
    return {
        "time_ms": said.get("timestamp", ""),
        "angle_min": str((first - front) * 2 * np.pi / total),
        "angle_increment": str(step),
        "ranges": _json_text(ranges.tolist()),
    }
