"""Logs of a command, one after the other, and the files that it writes.

Logs are named, lie in a folder or in sessions. Names of files are checked before any work."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TypeVar

from segmap.alignment import Verdict
from segmap.display import plural
from segmap.files import check_place, escape, members
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
    progress_bars,
    reason,
    stop_early,
)
from ._options import Demand, LogOptions
from ._program import with_stored
from ._reading import read_log
from ._workers import on_workers, write_table

#: Stands for the name of the log.
LOG_NAME = "{name}"
#: Files of these kinds lie beside logs: some quote a line of one.
DOCUMENTS = {".html", ".ipynb", ".md", ".py", ".rst", ".sh"}
#: Files that are no logs, of which the name is printed.
NAMED = 5
#: Files that say where on Earth the map lies.
OF_A_PLACE = (".geojson", ".segmap")
#: The options of a command.
Options = TypeVar("Options", bound=LogOptions)
#: What a command does with one log, and the files that it writes: to an exit code.
Work = Callable[[Options, Log, list[Path], Report], int]


def say_which_log(log: Log, source: str) -> str:
    """Which log comes now."""
    where = "" if source == log.name else f", {source}"
    return f"{log.name}: {plural(len(log), 'scan')}{where}"


def each_log(
    names: Sequence[str],
    given: Options,
    work: Work[Options],
    head: Callable[[Log, str], str] = say_which_log,
) -> int:
    """Do one log after the other, and name at the end those that failed.

    The exit code is 1 where one log failed, else the largest of the codes of all.
    """
    each = [source for name in names for source in sources(name)]
    refuse_maps(each)
    reading, patterns = given.reading, given.output
    chosen = [[file] for file in each] if reading.columns or reading.view else together(each)
    alike = [pattern for pattern in patterns if LOG_NAME not in pattern]
    if len(chosen) > 1 and alike:
        raise Usage(f"{plural(len(chosen), 'log')} would go to {alike[0]}: write {{name}} in it")
    if given.world.place and not any(name.lower().endswith(OF_A_PLACE) for name in patterns):
        raise Usage("--place is for a .geojson, the other files have none: name one with -o")
    fixed = [pattern for pattern in patterns if LOG_NAME not in str(Path(pattern).parent)]
    check_places([reading.table, given.loops, *fixed])
    if not all(map(is_session, each)):
        given.check()
    if reading.workers:
        return on_workers(names, given, chosen)
    failed, codes, reports, taken = [], [0], [], dict[Path, str]()
    bars = progress_bars(quiet=reading.quiet)
    with bars, stop_early(), progress(1 if reading.quiet else len(chosen), "log") as bar:
        for files in chosen:
            source = files[0]
            bar.set_description(escape(Path(source).name))
            reports.append(report := Report(source, json=reading.json, quiet=reading.quiet))
            try:
                with warnings.catch_warnings():  # a thousand scans may deserve the same
                    warnings.simplefilter("default", UserWarning)
                    log, own, unknown = log_of(files, given)
                if is_session(source):
                    own.check()
                paths = targets(patterns, log.name, source, taken)
                report.begin(log, head(log, source))
                if head is say_which_log:  # `info` tells it among the rest
                    tell_what_is_left_out(log, unknown, report)
                codes.append(work(own, log, paths, report))
            except BrokenPipeError:  # nobody reads any more
                raise
            except FAULTS as error:
                why, name = reason(error), escape(source)
                failed.append(why if name in why else f"{name}: {why}")
                report.found["failed"] = failed[-1]
            report.end()
            bar.update()
    if reading.table:
        write_table(Path(reading.table), [report.found for report in reports])
    for why in failed:
        print_error(why)
    if len(reports) > 1 and not (reading.json or reading.quiet):
        print_line(f"{len(reports) - len(failed)} of {plural(len(reports), 'log')} done")
    return 1 if failed else max(codes)


def tell_what_is_left_out(log: Log, options: Sequence[str], report: Report) -> None:
    """Say which lines of a log are damaged, and which options of its session this command lacks."""
    if log.skipped:
        count, why = log.skipped
        report.line("damaged", f"{plural(count, 'line')} left out; {why}", lines=count)
    if options:
        report.line("session", f"its {', '.join(options)} left out: no option here")


def targets(patterns: Sequence[str], name: str, source: str, taken: dict[Path, str]) -> list[Path]:
    """The files for a log of this name, none of them written before, nor the log itself."""
    paths = [Path(pattern.replace(LOG_NAME, name)) for pattern in patterns]
    for path in paths:
        place = path.resolve()
        check_place(path)
        if place == Path(source).resolve():
            raise ValueError(f"cannot write {path}: it is the log itself")
        if other := taken.get(place):
            raise ValueError(f"{path} was written for {other}: this log would replace it")
        taken[place] = source
    return paths


def refuse_maps(names: Iterable[str]) -> None:
    """End with an error of usage where a map for ROS is taken for a log."""
    for name in map(escape, filter(is_ros_map, names)):
        advice = f"`segmap locate {name} LOG` finds a robot on it"
        raise Usage(f"{name} is a map for ROS and no log: {advice}")


def check_places(names: Iterable[str | None]) -> None:
    """End with an error of usage where one of the files cannot be written; nothing is done yet."""
    for name in filter(None, names):
        try:
            for each in companions(Path(name)):
                check_place(each)
        except (ValueError, OSError) as error:
            raise Usage(reason(error)) from error


def companions(path: Path) -> list[Path]:
    """A file, and what is written with it: of a map for ROS its picture."""
    return [path, path.with_suffix(".pgm")] if path.suffix == ".yaml" else [path]


def sources(text: str) -> Iterator[str]:
    """The logs that an argument names: itself, or those below a folder that is no log itself."""
    folder = Path(text)
    if not folder.is_dir() or is_log(folder):
        yield text
        return
    inside = list(files_in(folder))
    logs = [path for path in inside if is_log(path)]
    if others := [str(path.relative_to(folder)) for path in inside if path not in logs]:
        more = f" and {len(others) - NAMED} more" if len(others) > NAMED else ""
        names = f"{', '.join(map(escape, others[:NAMED]))}{more}"
        print_error(f"{escape(folder)}: left out, since no log: {names}")
    yield from map(str, logs or [folder])


def files_in(folder: Path) -> Iterator[Path]:
    """What lies in a folder, with the files of a folder that is no log in its place."""
    for path in sorted(folder.glob("[!.]*")):
        if path.is_dir() and not (path.is_symlink() or is_log(path)):
            yield from files_in(path)
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


def log_of(files: Sequence[str], given: Options) -> tuple[Log, Options, Sequence[str]]:
    """The log in some files, its options, and those of its session that this command has not."""
    if is_session(files[0]):
        session = read_session(files[0])
        log = replace(session.log, name=Path(files[0]).stem)
        return log, *with_stored(given, {**session.settings, **session.edits})
    return read_log(files, given.reading), given, ()


def too_little(demand: Demand, verdict: Verdict) -> bool:
    """Whether this is no map, or less than --strict asks for."""
    few = verdict.placed < demand.share() * verdict.scans
    short_of_good = demand.strict == "good" and verdict.grade != "good"
    return verdict.grade == "not a map" or few or short_of_good


def outputs(demand: Demand, verdict: Verdict, paths: list[Path], report: Report) -> list[Path]:
    """The files that may be written: none where there is too little, unless --force says so."""
    if demand.force or not too_little(demand, verdict):
        return paths
    if paths:
        names = ", ".join(map(str, paths))
        report.line("written", f"nothing; --force writes {names} all the same", files=[])
    return []


def conclude(demand: Demand, verdict: Verdict, report: Report) -> int:
    """Say the verdict on the map, as the last line, and give the exit code.

    Beside the output stands once more what makes it less than good.
    """
    report.assumptions()
    few = verdict.grade != "not a map" and verdict.placed < demand.share() * verdict.scans
    asked = f" (--strict asks for {percent(demand.share())} of the scans)" if few else ""
    report.line("verdict", f"{verdict}{asked}", **asdict(verdict))
    if verdict.grade in ("doubtful", "not checked"):
        print_error(f"{escape(report.found['source'])}: {verdict}")
    return NO_MAP if too_little(demand, verdict) else 0


def finish(
    demand: Demand,
    verdict: Verdict,
    paths: list[Path],
    report: Report,
    write: Callable[[Path], None],
) -> int:
    """Write each file where there is a map, name what was written, and say the verdict."""
    written = outputs(demand, verdict, paths, report)
    for path in written:
        write(path)
    if written:
        names = [str(each) for path in written for each in companions(path)]
        report.line("written", ", ".join(names), files=names)
    return conclude(demand, verdict, report)
