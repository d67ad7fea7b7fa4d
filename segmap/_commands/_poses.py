"""A pose for each scan: the option --align, what is chosen without it, and what is said of it."""

from __future__ import annotations

import argparse
from collections import Counter
from typing import Any

import numpy as np

from ..alignment import METHODS, Alignment
from ..scans import Log
from ._words import counted, line, seconds

#: So many reasons for scans that were not matched are told.
MOST_REASONS = 3


def add_align(command: argparse.ArgumentParser, without: str) -> None:
    """The option --align; `without` says what happens where it is not given."""
    command.add_argument(
        "--align", choices=METHODS, metavar="METHOD", help=f"{', '.join(METHODS)}; {without}"
    )


def default_method(log: Log) -> str:
    """The true poses where the log has one for each scan; else all poses at once, loops closed."""
    true = log.truth is not None and np.isfinite(log.truth).all()
    return "ground_truth" if true else "pose_graph"


def aligned(log: Log, method: str | None) -> Alignment:
    """Align a log and say how it went."""
    name = method or default_method(log)
    options: dict[str, Any] = {}
    if name == "ground_truth":
        options = {"missing": "drop"}
    if name == "angle_correspondence":
        options = {"rng": np.random.default_rng(0)}
    found = METHODS[name](log, **options)
    line("aligned", f"by {name}: {_placed(found)}, {seconds(found.seconds)}")
    reasons = Counter(filter(None, found.reasons)).most_common(MOST_REASONS)
    for reason, count in reasons:
        line("", f"{counted(count, 'scan')} not: {reason}")
    if found.doubt:
        line("", f"doubt: {found.doubt}")
    return found


def _placed(found: Alignment) -> str:
    loops = (
        "" if found.graph is None else f", {counted(int(found.graph.loop.sum()), 'loop')} closed"
    )
    return f"{int(found.used.sum())} of {counted(len(found), 'scan')} matched{loops}"
