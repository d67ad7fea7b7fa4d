"""`segmap info LOG...`: what a log is, and what a session keeps beside it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from segmap.display import facts, plural
from segmap.readers import UnknownFormat, format_of
from segmap.scans import Log, sensor_noise

from ..files import read_session
from ._output import Report
from .log_options import LogOptions, Logs, command, each_log, is_session


@command(
    "info",
    "info malaga",
    "info room corridor --table logs.csv   a row for each log, to be sorted",
    "info malaga --json                    for another program",
)
def info(*logs: Logs, given: LogOptions = LogOptions()) -> int:
    """What a log is: scans, beams, field of view, path, odometry, truth, damage.

    Damaged lines are left out and counted. Of a session also what it keeps is told.
    """
    given = replace(given, reading=replace(given.reading, skip=True))
    return each_log(logs, given, describe_log, which_log_and_format)


def which_log_and_format(log: Log, source: str) -> str:
    """Which log comes now, and its format."""
    if Path(source).name == source and not Path(source).exists():
        return f"{log.name}: comes with segmap"
    try:
        form = "session" if is_session(source) else format_of(source)
    except UnknownFormat:  # its columns were named
        form = "table"
    return f"{log.name}: {form}, {source}"


def describe_log(given: LogOptions, log: Log, paths: list[Path], report: Report) -> int:
    """Print what a log is, a line a thing; of a session also its options, edits and runs."""
    for word, text, numbers in facts(log):
        report.line(word, text, **numbers)
    noise = sensor_noise(log)
    report.line("noise", f"{noise} (standard deviation of a range)", **vars(noise))
    if is_session(source := report.found["source"]):
        session = read_session(source)
        for word in ("settings", "edits"):
            options = getattr(session, word)
            text = ", ".join(f"{name} {value}" for name, value in options.items())
            report.line(word, text or "none", options=options)
        report.line("runs", plural(len(session.runs), "run"), runs=len(session.runs))
    return 0
