"""Text of ROS's own: what `rostopic echo` and `ros2 topic echo` print of a LaserScan."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from ...scans import LaserScan, Log
from .._lines import Lines, LogError, float_fields, time
from .._raw_scans import beams_of_message, place_of
from ._fields import sample

#: Numbers of a message, in the order in which `ros2 topic echo --csv` writes them.
SINGLE_NUMBERS = (
    *("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time"),
    *("range_min", "range_max"),
)
#: What a message says that says nothing.
UNSAID_NUMBERS: dict[str, Any] = {"range_min": 0.0, "range_max": 0.0, "time_increment": 0.0}
#: So many lines hold the names of a message.
ECHO_SAMPLE_LINES = 60
SHORTENED = "its ranges are shortened: `ros2 topic echo --full-length`, no --noarr, shows all"
#: A key of a message that does not end: what names none.
CUT = "..."
#: Ends a message.
END_OFUNSAID_NUMBERS = "---"


def is_echo(path: Path) -> bool:
    """Whether a file is what `rostopic echo` or `ros2 topic echo` prints of a LaserScan."""
    words = {text.split(":")[0].strip() for _, text in sample(path, ECHO_SAMPLE_LINES)}
    return {"angle_min", "angle_increment"} <= words


def read_echo(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read such a text."""
    lines = Lines(path, on_error, "\n")
    scans: list[LaserScan] = []
    for said in _messages(lines):
        try:
            ranges_said = said.get("ranges", [])
            if "..." in ranges_said or any(text.startswith("<") for text in ranges_said):
                raise ValueError(SHORTENED)
            if CUT in said:
                raise ValueError("the file is cut off in it")
            numbers = {w: float_fields(said.get(w, []), w)[0] for w in SINGLE_NUMBERS if w in said}
            ranges = float_fields(said.get("ranges", []), "ranges")
            beams = beams_of_message(SimpleNamespace(**UNSAID_NUMBERS | numbers, ranges=ranges))
            when = [
                time(said[word][0], unit=unit)
                for word, unit in (("secs", 1), ("sec", 1), ("nsecs", 1e-9), ("nanosec", 1e-9))
                if said.get(word)
            ]
            scans.append(replace(beams, time=sum(when) if when else np.nan))
        except (ValueError, LookupError, AttributeError) as fault:
            lines.damaged(lines.error(f"before it a scan is damaged ({fault})"))
    if not scans:
        raise lines.no_scan("messages of a LaserScan with ranges")
    return Log(name, scans, None, lines.skipped, assumed=(place_of(np.zeros(3)),))


def _messages(lines: Lines) -> Iterator[dict[str, list[str]]]:
    """Values of each message by their names, without the names of what holds them."""
    said: dict[str, list[str]] = {}
    key = ""
    for (text,) in lines:
        if text == END_OFUNSAID_NUMBERS:
            if said:
                yield said
            said, key = {}, ""
            continue
        if found := re.match(r"-?\s*([A-Za-z_]\w*):\s*(.*)", text):
            key, text = found[1], found[2]
            said.setdefault(key, [])
        values = text.removeprefix("- ") if not text.startswith("[") else text
        said.setdefault(key, []).extend(
            value.replace(".nan", "nan").replace(".inf", "inf")
            for value in (v.strip(" []'\"") for v in values.split(","))
            if value
        )
    if "ranges" in said:
        whole = {CUT: [""]} if text.startswith("[") and not text.endswith("]") else {}
        yield said | whole
    elif said and not lines.first and "angle_min" in said:
        raise LogError(lines.path, "is cut off within a message", lines.number)
