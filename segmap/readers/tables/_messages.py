"""Records with a name beside each value, over several lines: the rows of a table all the same.

    ranges: [2.0, 2.1, ...]   a key a line, `---` or `- ` between scans    rostopic echo /scan, YAML
    header { stamp {          and so on, names repeated                    gz topic -e of Gazebo
    # name: ranges            before its rows                              matrices of Octave
    90,123.91,122.            degrees and centimetres                      programs for a radar
    {0: 1234, 1: 1250, ...}   angles and ranges, a scan a line             a dict of Python's
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
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain, islice, pairwise
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np

from ...scans import Log
from .._lines import HeadError, Lines, LogError
from ._columns import named
from ._fields import SAMPLE_LINES, labelled, listed, sample
from ._layout import Layout, wanting
from ._numbers import proposed_names
from ._sensors import (
    PACKETS_SAMPLE_BYTES,
    TELEGRAM,
    TOLD_OF_TELEGRAMS,
    TOLD_OF_URG_BENRI,
    Record,
    ld19,
    packets_in,
    telegrams,
    text_of,
    urg_benri,
)
from ._table import CUT, Table
from ._wide import LEAST_BEAMS, SHORTENED, of_records

#: So many lines hold the names of a message.
ECHO_SAMPLE_LINES = 60
#: A text over several lines is not longer, in bytes.
MOST_JSON_BYTES = 1 << 28
#: Ends a message.
END_OF_MESSAGE = "---"
#: Of lists of more numbers each is a scan, and no beam.
MOST_BEAM_FIELDS = 8
#: So many rows are shown where columns are chosen.
SHOWN_ROWS = 6
DECODER = json.JSONDecoder()
#: A key of YAML before its value.
BARE_KEY = re.compile(r"([{,]\s*)([A-Za-z_]\w*):")
#: A key of YAML in a line of its own, perhaps the first of an item of a list, and its value.
KEY = re.compile(r"(?:- +)?([A-Za-z_][\w .()\[\]]*?) *: *(.*)")
#: How Gazebo's text of a message begins.
HEAD_OF_GAZEBO = "header {"
#: Before each matrix that Octave saves.
OCTAVE_NAME = re.compile(r"# name: (\w+)")
#: Pairs of whole degrees and centimetres, without an end of a line.
RADAR_PAIR = re.compile(r"(0|[1-9]\d{0,2}),(0|[1-9]\d{0,3})\.")
RADAR = re.compile(rf"({RADAR_PAIR.pattern}){{6,}}(\d{{1,3}},?)?\d{{0,4}}")
#: Its servo goes on by so many degrees at most, each time by as many, or back to the first.
MOST_RADAR_STEP_DEG = 30
#: An angle and its range as a dictionary of Python's has them, or a line of it.
PAIR = re.compile(r"[\"']?(-?[0-9.]+)[\"']?\s*[:=]\s*(-?[0-9.]+|nan|inf|None|null)")
PAIRS = re.compile(
    rf"((?P<time>[0-9.]+)[\s,;]+)?[{{\[(]?\s*({PAIR.pattern}[\s,;]*){{6,}}[}}\])]?,?"
)
TOLD_OF_RADAR = ("pairs are degrees and centimetres, as programs for a radar have them",)
#: What stands between values of JSON.
BETWEEN_JSON = re.compile(r"[\s,]*")


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
    if any(packets_in(Lines(path, "skip").held(PACKETS_SAMPLE_BYTES))):
        return Records(ld19)
    texts = [text.strip() for _, text in sample(path, ECHO_SAMPLE_LINES)]
    words = {text.split(":")[0].strip() for text in texts}
    matches = [found for text in texts if (found := KEY.fullmatch(text))]
    keys = [found[1] for found in matches if not {*found[2]} & {*":={}"}]
    said = 2 * len(keys) > len(texts) and named(_distinct(keys)).enough
    if said or ("angle_min" in words and words & {"angle_increment", "angle_step"}):
        return Records(_echoed)
    if "ranges" in keys:
        (_, first) = next(_echoed(Lines(path, "skip", "\n", comments="")), (0, {}))
        if len(listed(first.get("ranges", ""))) >= LEAST_BEAMS:
            return Records(_echoed)
    if any(OCTAVE_NAME.match(text) for text in texts):
        return Records(_octave)
    if texts and _is_radar(texts[0]):
        return Records(_pairs(RADAR_PAIR, "angle_deg", "range_cm"), TOLD_OF_RADAR)
    if texts and PAIRS.fullmatch(texts[0]):
        return Records(_pairs(PAIR, "angle", "range"))
    if any(map(TELEGRAM.search, texts)):
        return Records(telegrams, TOLD_OF_TELEGRAMS)
    if {"[timestamp]", "[scan]"} <= words:
        return Records(urg_benri, TOLD_OF_URG_BENRI)
    begins = ("{", "[", "- {", "- [")
    if texts and texts[0].startswith(begins) and next(_json(Lines(path, "skip")), None):
        return Records(_json)
    return None


def read_named_records(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a file of records."""
    return log_of_records(cast(Records, records_of(path)), path, name, on_error)


# ------------------------------------------------------------------------ ROS
def _echoed(lines: Lines) -> Iterator[Record]:
    """Values of each message by their names, without the names of what holds them."""
    said: dict[str, list[str]] = {}
    key, first, number = "", "", 0
    for (text,) in lines:
        number, found = lines.number, KEY.fullmatch(text)
        again = found is not None and found[1] == first and first in said
        if text == END_OF_MESSAGE or again or (text == HEAD_OF_GAZEBO and "ranges" in said):
            if said:
                yield number, _message_texts(lines, said)
            said, key = {}, ""
        if text == END_OF_MESSAGE or text.endswith("{") or text == "}":
            continue
        if found:
            key, text = found[1].replace("angle_step", "angle_increment"), found[2]
            first = first or (key if text or key == "ranges" else "")
            said.setdefault(key, [])
        values = text.removeprefix("- ") if not text.startswith("[") else text
        said.setdefault(key, []).extend(
            value.replace(".nan", "nan").replace(".inf", "inf")
            for value in (v.strip(" []'\"") for v in values.split(","))
            if value
        )
    if "ranges" in said or (said and "angle_min" not in said):
        whole = text.startswith("[") and not text.endswith("]")
        yield number, _message_texts(lines, said) | ({CUT: ""} if whole else {})
    elif said and not lines.first:
        raise LogError(lines.path, "is cut off within a message", number)


def _message_texts(lines: Lines, said: Mapping[str, Sequence[str]]) -> dict[str, str]:
    lists = ("ranges", "intensities")
    if any("..." in value or value.startswith("<") for value in said.get("ranges", ())):
        raise LogError(lines.path, SHORTENED, lines.number)
    found: dict[str, str] = {}
    for key, values in said.items():
        if len(values) > 1 or key in lists:
            found[key] = f"[{' '.join(values)}]"
        elif values:  # a number may have its unit behind it
            found |= next(labelled(f"{key}: {values[0]}")) or {key: values[0]}
    return found


def _distinct(keys: Sequence[str]) -> list[str]:
    return list(dict.fromkeys(keys))


# ------------------------------------------------------------------------ JSON
def _json(lines: Lines) -> Iterator[Record]:
    """The scans or beams of all values in a text, as far as it is JSON."""
    text = lines.held(MOST_JSON_BYTES).decode("utf-8-sig", "replace")
    if text.startswith("- "):
        text = re.sub(r"(?m)^- ", "", text)
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
            opened = not scans and text[begin] == "["  # a list that was never closed
            if not scans and not opened:
                return
            number += text.count("\n", at, begin)
            lines.damaged(LogError(lines.path, f"expected JSON ({fault})", number))
            at, end = begin, begin + 1 if opened else text.find("\n", begin) + 1 or len(text)
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
        shared = {k: text_of(v) for k, v in held.items() if k not in lists}
        deep = [v for v in lists.values() if isinstance(v[0], list | dict)]
        parts = [v for v in deep if isinstance(v[0], dict)] or deep * (len(lists) == 1)
        for part in parts[:1]:
            yield from ([shared | beam for beam in scan] for scan in _scans_in(part))
        if not deep and named([*lists]).enough and len({*map(len, lists.values())}) == 1:
            rows = zip(*lists.values(), strict=True)  # a list a column
            yield [shared | dict(zip(lists, map(text_of, row), strict=True)) for row in rows]
        elif not deep:
            yield [{k: text_of(v) for k, v in held.items()}]
        elif not parts:  # an array a name, in which a row is a scan
            count = len(deep[0])
            for k in range(count):
                row = {n: v[k] if len(v) == count else v for n, v in lists.items()}
                yield [shared | {n: text_of(v) for n, v in row.items()}]
    elif isinstance(value, list) and value:
        kinds = {type(part) for part in value}
        inner = {type(part) for each in value if isinstance(each, list) for part in each}
        if kinds == {dict} and not any(isinstance(v, list | dict) for v in value[0].values()):
            yield [{k: text_of(v) for k, v in beam.items()} for beam in value]
        elif kinds == {list} and not inner & {list, dict} and len(value[0]) <= MOST_BEAM_FIELDS:
            yield [{str(k): text_of(v) for k, v in enumerate(beam)} for beam in value]
        elif kinds == {list} and not inner & {list, dict}:
            yield from ([{"ranges": text_of(row)}] for row in value)
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


def _pairs(pair: re.Pattern[str], *names: str) -> Callable[[Lines], Iterator[Record]]:
    """What gives the beams of lines of pairs, of what these names say."""

    def each(lines: Lines) -> Iterator[Record]:
        for (text,) in lines:
            if not (found := pair.findall(text)):
                lines.damaged(lines.error(f"expected pairs of numbers, got {text[:40]!r}"))
            turn = {"scan": str(lines.number)} if pair is PAIR else {}
            if turn and (whole := PAIRS.fullmatch(text)) and whole["time"]:
                turn["time"] = whole["time"]
            for beam in found:
                yield lines.number, turn | dict(zip(names, beam, strict=True))

    return each
