"""One log, read as the options say: columns, topics of a bag, files of poses."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from segmap.readers import LogError, load, read, read_csv, with_trajectories
from segmap.scans import Log

from ...files import read_bag
from ._options import Reading

#: A name of poses that ends so is a file, and no topic.
POSE_FILES = (".csv", ".txt", ".tum")


def read_log(files: Sequence[str], given: Reading) -> Log:
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
