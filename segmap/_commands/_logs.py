"""Logs one after the other, those named and those in a folder, and a pose for each scan."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ..alignment import METHODS, Alignment
from ..readers import LogError, UnknownFormat, format_of, load, read, read_bag
from ..scans import Log
from ._targets import Targets
from ._words import FAULTS, begin, counted, line, progress, reason, say, seconds, tell

#: Files of these kinds lie beside logs: some quote a line of one.
DOCUMENTS = {".html", ".ipynb", ".md", ".py", ".rst", ".sh"}
#: So many reasons for scans that were not matched are told.
MOST_REASONS = 3
#: What happens without --align, in most commands.
ALIGN = "default: ground_truth where the log has it for each scan, else pose_graph"
#: What a command does with one log, and the files that it writes.
Work = Callable[[argparse.Namespace, Log, list[Path]], None]


def add_logs(command: argparse.ArgumentParser) -> None:
    """The arguments LOG... and --skip."""
    command.add_argument(
        "logs", nargs="+", metavar="LOG", help="a file, a folder, or malaga, corridor, room"
    )
    command.add_argument(
        "--skip", action="store_true", help="leave damaged lines out, and say how many"
    )
    command.add_argument("--scan-topic", metavar="TOPIC", help="of bags; default: the fullest one")
    command.add_argument("--odometry-topic", metavar="TOPIC", help="of bags, likewise")
    command.set_defaults(refuse=command.error)


def each_log(
    given: argparse.Namespace, work: Work, head: Callable[[Log, str], None] = begin
) -> int:
    """Do one log after the other, and name at the end those that failed: then 1, else 0."""
    chosen = [source for text in given.logs for source in sources(text)]
    targets = Targets(getattr(given, "output", []))
    if len(chosen) > 1 and (alike := targets.alike()):
        given.refuse(f"{counted(len(chosen), 'log')} would go to {alike}: write {{name}} in it")
    failed = []
    with progress(len(chosen), "log") as bar:
        for source in chosen:
            bar.set_description(Path(source).name)
            try:
                log = log_of(source, given)
                paths = targets.paths(log.name, source)
                head(log, source)
                work(given, log, paths)
            except BrokenPipeError:  # nobody reads any more
                raise
            except FAULTS as error:
                failed.append(reason(error) if source in str(error) else f"{source}: {error}")
            bar.update()
    for why in failed:
        tell(why)
    if len(chosen) > 1:
        say(f"{len(chosen) - len(failed)} of {counted(len(chosen), 'log')} done")
    return 1 if failed else 0


def sources(text: str) -> Iterator[str]:
    """The logs that an argument names: itself, or those in a folder that is no log itself."""
    folder = Path(text)
    if not folder.is_dir() or is_log(folder):
        yield text
        return
    inside = sorted(path for path in folder.iterdir() if not path.name.startswith("."))
    found = [path for path in inside if is_log(path)]
    if rest := [path.name for path in inside if path not in found]:
        tell(f"{folder}: left out, since no log: {', '.join(rest)}")
    yield from map(str, found or [folder])


def is_log(path: Path) -> bool:
    """Whether a file or folder has the format of a log; one that cannot be read may have been."""
    if path.suffix in DOCUMENTS:
        return False
    try:
        format_of(path)
    except UnknownFormat:
        return False
    except LogError:
        pass
    return True


def log_of(source: str, given: argparse.Namespace) -> Log:
    """The log at a path, or the one of that name that comes with segmap."""
    on_error: Literal["raise", "skip"] = "skip" if given.skip else "raise"
    if given.scan_topic or given.odometry_topic:
        topics = {"scan": given.scan_topic, "odometry": given.odometry_topic}
        return read_bag(source, on_error=on_error, **topics)
    if Path(source).exists() or Path(source).name != source or "." in source:
        return read(source, on_error=on_error)
    try:
        return load(source)
    except LogError:
        raise
    except ValueError as error:
        raise LogError(Path(source), f"is neither a file nor a folder, and {error}") from error


def add_align(command: Any, without: str = ALIGN) -> None:
    """The option --align; `without` says what happens where it is not given."""
    command.add_argument(
        "--align", choices=METHODS, metavar="METHOD", help=f"{', '.join(METHODS)}; {without}"
    )


def aligned(log: Log, method: str | None) -> Alignment:
    """Align a log and say how it went.

    By default: the true poses where the log has one for each scan; else all poses at once, loops
    closed.
    """
    true = log.truth is not None and np.isfinite(log.truth).all()
    name = method or ("ground_truth" if true else "pose_graph")
    options: dict[str, Any] = {}
    if name == "ground_truth":
        options = {"missing": "drop"}
    if name == "angle_correspondence":
        options = {"rng": np.random.default_rng(0)}
    found = METHODS[name](log, **options)
    placed = f"{int(found.used.sum())} of {counted(len(found), 'scan')} matched"
    if found.graph is not None:
        placed += f", {counted(int(found.graph.loop.sum()), 'loop')} closed"
    line("aligned", f"by {name}: {placed}, {seconds(found.seconds)}")
    reasons = Counter(filter(None, found.reasons)).most_common(MOST_REASONS)
    for why, count in reasons:
        line("", f"{counted(count, 'scan')} not: {why}")
    if found.doubt:
        line("", f"doubt: {found.doubt}")
    return found
