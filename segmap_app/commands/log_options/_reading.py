"""Options of how one log is read, which readers check: columns, topics of a bag, files of poses."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from segmap.readers import LogError, load, read, read_csv, with_trajectories
from segmap.scans import Log

from ...files import read_bag

#: A name of poses that ends so is a file, and no topic.
POSE_FILES = (".csv", ".txt", ".tum")


def add_reading(group: Any) -> None:
    """The options that say how a log is read."""
    group.add_argument(
        "--columns",
        metavar="NAMES",
        help="of a table, its columns from the left: time_ms,angle_deg,range_mm,-; "
        "where a row is a scan: time_s,ranges_m",
    )
    group.add_argument(
        "--view",
        nargs=2,
        type=float,
        metavar=("FIRST", "LAST"),
        help="of a table with a scan a row, where its first and its last range point, in degrees",
    )
    group.add_argument(
        "--scan-topic",
        action="append",
        metavar="TOPIC",
        help="of a bag, its scans; given twice, those of both; default: scan, or the fullest",
    )
    for kind in ("odometry", "truth"):
        group.add_argument(
            f"--{kind}",
            metavar="FILE",
            help=f"the {kind} from a file of poses ({', '.join(POSE_FILES)}), by their times; or a "
            "topic of the bag",
        )


def read_log(files: Sequence[str], given: argparse.Namespace) -> Log:
    """The log in a file, or in several, as the options say."""
    source: str | Sequence[str] = files[0] if len(files) == 1 else files
    on_error: Literal["raise", "skip"] = "skip" if given.skip else "raise"
    named = {kind: getattr(given, kind) for kind in ("odometry", "truth")}
    tracks = {k: name for k, name in named.items() if name and name.lower().endswith(POSE_FILES)}
    topics = {k: name for k, name in named.items() if name and k not in tracks}
    if given.columns or given.view:
        log = read_csv(files[0], columns=given.columns, view=given.view, on_error=on_error)
    elif given.scan_topic or topics:
        log = read_bag(source, on_error=on_error, scan=given.scan_topic, **topics)
    elif len(files) > 1:
        log = read(files, on_error=on_error)
    else:
        log = _named_log(files[0], on_error)
    return with_trajectories(log, **tracks) if tracks else log


def _named_log(source: str, on_error: Literal["raise", "skip"]) -> Log:
    """The log at a path, or the one of that name that comes with segmap."""
    if Path(source).exists() or Path(source).name != source or "." in source:
        return read(source, on_error=on_error)
    try:
        return load(source)
    except LogError:
        raise
    except ValueError as error:
        raise LogError(Path(source), f"is neither a file nor a folder, and {error}") from error
