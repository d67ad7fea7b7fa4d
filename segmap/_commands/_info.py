"""`segmap info LOG...`: what a log is."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import Any

from .._display import facts
from ..readers import format_of
from ..scans import Log
from ._words import Report
from .opening import add_logs, each_log


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "info", help="what a log is: scans, beams, field of view, path, odometry, truth, damage"
    )
    add_logs(command)
    command.set_defaults(run=partial(each_log, work=tell_of, head=begin, check=check))


def check(given: argparse.Namespace) -> None:
    """Damaged lines are left out and counted."""
    given.skip = True


def begin(log: Log, source: str) -> str:
    """Which log comes now, and its format."""
    known = Path(source).exists()
    return f"{log.name}: {f'{format_of(source)}, {source}' if known else 'comes with segmap'}"


def tell_of(given: argparse.Namespace, log: Log, paths: list[Path], report: Report) -> int:
    """Print what a log is, a line a thing."""
    for word, text in facts(log):
        report.line(word, text)
    return 0
