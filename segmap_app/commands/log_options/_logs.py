"""Logs of a command, one after the other, and the files that it writes.

Logs are named, lie in a folder or in sessions. Names of files are checked before any work."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path

from segmap.alignment import Verdict
from segmap.display import counted
from segmap.files import members, shown, writable
from segmap.readers import LogError, UnknownFormat, format_of, together
from segmap.scans import Log

from ...files import is_ros_map, read_session
from .._output import (
    FAULTS,
    NO_MAP,
    Report,
    Usage,
    percent,
    print_error,
    print_line,
    progress,
    reason,
    stoppable,
)
from ._command import Command, switch, told
from ._reading import add_reading, read_log
from ._settings import applied
from ._workers import on_workers, write_table

#: Stands for the name of the log.
LOG_NAME = "{name}"
#: Files of these kinds lie beside logs: some quote a line of one.
DOCUMENTS = {".html", ".ipynb", ".md", ".py", ".rst", ".sh"}
#: So many files that are no logs are named.
NAMED = 5
#: What a command does with one log, and the files that it writes: to an exit code.
Work = Callable[[argparse.Namespace, Log, list[Path], Report], int]


def add_logs(command: Command) -> None:
    """The arguments LOG..., and how they are read and told."""
    command.add_argument(
        "logs",
        nargs="+",
        metavar="LOG",
        help="a file, a folder, a session (.segmap) with its options, or malaga, clinic, corridor, "
        "room",
    )
    group = command.add_argument_group("reading and printing")
    switch(group, "--skip", help="leave damaged lines out, and say how many")
    switch(group, "--json", help="print all that is said as JSON, one object a log")
    switch(group, "-q", "--quiet", help="print no result: only what fails or is doubtful")
    group.add_argument(
        "--table",
        type=told(_csv),
        metavar="FILE",
        help="write the figures as .csv too, a row for each log",
    )
    group.add_argument(
        "--workers",
        type=told(_workers),
        metavar="N|ADDRESS",
        help="one log a process, N at a time, or on the Dask cluster at tcp://HOST:PORT; logs that "
        "--table holds already are not done again",
    )
    group.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="a .toml with options by their names, `filter = 0.5`; those given here win",
    )
    add_reading(group)


def _csv(text: str) -> Path:
    return Path(_with_known_suffix([".csv"], text))


def _workers(text: str) -> str:
    if not (text.isdecimal() and int(text)) and "://" not in text:
        raise ValueError(f"{text!r} must be a number, or like tcp://HOST:8786")
    return text


def say_which_log(log: Log, source: str) -> str:
    """Which log comes now."""
    where = "" if source == log.name else f", {source}"
    return f"{log.name}: {counted(len(log), 'scan')}{where}"


def each_log(
    given: argparse.Namespace,
    work: Work,
    head: Callable[[Log, str], str] = say_which_log,
    check: Callable[[argparse.Namespace], None] = lambda given: None,
) -> int:
    """Do one log after the other, and name at the end those that failed.

    `check` refuses options that do not go together. The exit code is 1 where one log failed, else
    the largest of the codes of all.
    """
    each = [source for text in given.logs for source in sources(text)]
    chosen = [[file] for file in each] if given.columns or given.view else together(each)
    for name in filter(is_ros_map, [*each, getattr(given, "first", each[0])]):
        raise Usage(
            f"{shown(name)} is a map for ROS and no log: `segmap locate {shown(name)} LOG` finds a "
            "robot on it"
        )
    patterns = getattr(given, "output", [])
    alike = [pattern for pattern in patterns if LOG_NAME not in pattern]
    if len(chosen) > 1 and alike:
        raise Usage(f"{counted(len(chosen), 'log')} would go to {alike[0]}: write {{name}} in it")
    fixed = [Path(pattern) for pattern in patterns if LOG_NAME not in str(Path(pattern).parent)]
    check_places([given.table, getattr(given, "loops", None), *fixed])
    if not all(map(is_session, each)):
        check(given)
    if given.workers:
        return on_workers(given, chosen)
    failed, codes, reports, taken = [], [0], [], dict[Path, str]()
    with stoppable(), progress(1 if given.quiet else len(chosen), "log") as bar:
        for files in chosen:
            source = files[0]
            bar.set_description(shown(Path(source).name))
            reports.append(report := Report(source, json=given.json, quiet=given.quiet))
            try:
                with warnings.catch_warnings():  # a thousand scans may deserve the same
                    warnings.simplefilter("default", UserWarning)
                    log, own, unknown = log_of(files, given)
                if is_session(source):
                    check(own)
                paths = targets(patterns, log.name, source, taken)
                report.begin(log, head(log, source))
                if head is say_which_log:  # `info` tells it among the rest
                    tell_what_is_left_out(log, unknown, report)
                codes.append(work(own, log, paths, report))
            except BrokenPipeError:  # nobody reads any more
                raise
            except FAULTS as error:
                why, name = reason(error), shown(source)
                failed.append(why if name in why else f"{name}: {why}")
                report.found["failed"] = failed[-1]
            report.end()
            bar.update()
    if given.table:
        write_table(given.table, [report.found for report in reports])
    for why in failed:
        print_error(why)
    if len(reports) > 1 and not (given.json or given.quiet):
        print_line(f"{len(reports) - len(failed)} of {counted(len(reports), 'log')} done")
    return 1 if failed else max(codes)


def tell_what_is_left_out(log: Log, options: Sequence[str], report: Report) -> None:
    """Say which lines of a log are damaged, and which options of its session this command lacks."""
    if log.skipped:
        count, why = log.skipped
        report.line("damaged", f"{counted(count, 'line')} left out; {why}", lines=count)
    if options:
        report.line("session", f"its {', '.join(options)} left out: no option here")


def targets(patterns: Sequence[str], name: str, source: str, taken: dict[Path, str]) -> list[Path]:
    """The files for a log of this name, none of them written before, nor the log itself."""
    paths = [Path(pattern.replace(LOG_NAME, name)) for pattern in patterns]
    for path in paths:
        place = path.resolve()
        writable(path)
        if place == Path(source).resolve():
            raise ValueError(f"cannot write {path}: it is the log itself")
        if other := taken.get(place):
            raise ValueError(f"{path} was written for {other}: this log would replace it")
        taken[place] = source
    return paths


def check_places(paths: Iterable[Path | None]) -> None:
    """End with an error of usage where one of the files cannot be written; nothing is done yet."""
    for path in filter(None, paths):
        try:
            for each in beside(path):
                writable(each)
        except (ValueError, OSError) as error:
            raise Usage(reason(error)) from error


def beside(path: Path) -> list[Path]:
    """A file, and what is written with it: of a map for ROS its picture."""
    return [path, path.with_suffix(".pgm")] if path.suffix == ".yaml" else [path]


def sources(text: str) -> Iterator[str]:
    """The logs that an argument names: itself, or those below a folder that is no log itself."""
    folder = Path(text)
    if not folder.is_dir() or is_log(folder):
        yield text
        return
    inside = list(below(folder))
    logs = [path for path in inside if is_log(path)]
    if others := [str(path.relative_to(folder)) for path in inside if path not in logs]:
        more = f" and {len(others) - NAMED} more" if len(others) > NAMED else ""
        names = f"{', '.join(map(shown, others[:NAMED]))}{more}"
        print_error(f"{shown(folder)}: left out, since no log: {names}")
    yield from map(str, logs or [folder])


def below(folder: Path) -> Iterator[Path]:
    """What lies in a folder, with the files of a folder that is no log in its place."""
    for path in sorted(folder.glob("[!.]*")):
        if path.is_dir() and not (path.is_symlink() or is_log(path)):
            yield from below(path)
        else:
            yield path


def is_session(source: str) -> bool:
    """Whether a log comes with options of its own."""
    return source.lower().endswith(".segmap")


def is_log(path: Path) -> bool:
    """Whether a file or folder has the format of a log; one that cannot be read may have been.

    A map of `segmap map` or `segmap occupancy` is an NPZ too, of other arrays.
    """
    names = members(path)
    if path.suffix in DOCUMENTS or ("format.npy" in names and "ranges.npy" not in names):
        return False
    try:
        format_of(path)
    except UnknownFormat:
        return False
    except LogError:
        pass
    return True


def log_of(
    files: Sequence[str], given: argparse.Namespace
) -> tuple[Log, argparse.Namespace, Sequence[str]]:
    """The log in some files, its options, and those of its session that this command has not."""
    if is_session(files[0]):
        session = read_session(files[0])
        log = replace(session.log, name=Path(files[0]).stem)
        return log, *applied(given, {**session.settings, **session.edits})
    return read_log(files, given), given, ()


def add_strict(command: Command) -> None:
    """The options that say what counts as a map, and what happens where there is none."""
    group = command.add_argument_group("what counts as a map")
    group.add_argument(
        "--strict",
        type=told(_share),
        default=0.0,
        metavar="SHARE",
        help=f"end with {NO_MAP} too where a smaller share of the scans is placed, 0.9 say; alone, "
        "where the map is not good",
    )
    switch(group, "--strict-verdict", help=argparse.SUPPRESS)
    switch(group, "--force", help=f"write the files even where that ends with {NO_MAP}")


def _share(text: str) -> float:
    share = float(text)
    if not 0 <= share <= 1:
        raise ValueError(f"{text} must be from 0 to 1")
    return share


def too_little(given: argparse.Namespace, verdict: Verdict) -> bool:
    """Whether this is no map, or less than --strict asks for."""
    few = verdict.placed < given.strict * verdict.scans
    short_of_good = given.strict_verdict and verdict.grade != "good"
    return verdict.grade == "not a map" or few or short_of_good


def allowed(
    given: argparse.Namespace, verdict: Verdict, paths: list[Path], report: Report
) -> list[Path]:
    """The files that may be written: none where there is too little, unless --force says so."""
    if given.force or not too_little(given, verdict):
        return paths
    if paths:
        names = ", ".join(map(str, paths))
        report.line("written", f"nothing; --force writes {names} all the same", files=[])
    return []


def concluded(given: argparse.Namespace, verdict: Verdict, report: Report) -> int:
    """Say the verdict on the map, as the last line, and give the exit code.

    Beside the output stands once more what makes it less than good.
    """
    report.assumptions()
    few = verdict.grade != "not a map" and verdict.placed < given.strict * verdict.scans
    asked = f" (--strict asks for {percent(given.strict)} of the scans)" if few else ""
    report.line("verdict", f"{verdict}{asked}", **asdict(verdict))
    if verdict.grade in ("doubtful", "not checked"):
        print_error(f"{shown(report.found['source'])}: {verdict}")
    return NO_MAP if too_little(given, verdict) else 0


def finished(
    given: argparse.Namespace,
    verdict: Verdict,
    paths: list[Path],
    report: Report,
    write: Callable[[Path], None],
) -> int:
    """Write each file where there is a map, name what was written, and say the verdict."""
    written = allowed(given, verdict, paths, report)
    for path in written:
        write(path)
    if written:
        names = [str(each) for path in written for each in beside(path)]
        report.line("written", ", ".join(names), files=names)
    return concluded(given, verdict, report)


def add_output(command: Command, suffixes: Sequence[str], what: str) -> None:
    """The option -o, as often as one likes, for names that end in one of the suffixes."""
    command.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FILE",
        type=told(partial(_with_known_suffix, suffixes)),
        help=f"write {what}; the name ends in {', '.join(suffixes)}; may be given more than once; "
        f"{LOG_NAME} in it stands for the name of the log, for several logs: 'maps/{LOG_NAME}.svg'",
    )


def _with_known_suffix(suffixes: Sequence[str], text: str) -> str:
    if not text.lower().endswith(tuple(suffixes)) or text.startswith(tuple(suffixes)):
        raise ValueError(f"{text!r} must end in one of {', '.join(suffixes)}")
    return text
