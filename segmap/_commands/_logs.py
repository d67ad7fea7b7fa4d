"""Logs one after the other, those named and those in a folder, a pose for each scan, and the files
that a command writes: their names are checked before any work is done."""

from __future__ import annotations

import argparse
import csv
import io
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .._display import counted
from ..alignment import METHODS, Alignment, LiveGraph, Verdict, deskew
from ..exports import Earth, Frame, Grid
from ..extraction import build_map
from ..files import shown, write_bytes
from ..poses import compose
from ..readers import LogError, UnknownFormat, format_of, load, read, read_bag
from ..scans import Log
from ..scans.moving import is_timed
from ..segments import main_direction
from ._words import FAULTS, Report, percent, progress, reason, say, seconds, tell

#: Stands for the name of the log.
NAME = "{name}"
#: Files of these kinds lie beside logs: some quote a line of one.
DOCUMENTS = {".html", ".ipynb", ".md", ".py", ".rst", ".sh"}
#: So many reasons for scans that were not matched are told.
MOST_REASONS = 3
#: What happens without --align, in most commands.
ALIGN = "default: ground_truth where the log has it for each scan, else pose_graph"
#: Exit code where a log gave no map.
NO_MAP = 3
#: What a command does with one log, and the files that it writes: to an exit code.
Work = Callable[[argparse.Namespace, Log, list[Path], Report], int]


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
    command.add_argument(
        "--json", action="store_true", help="print all that is said as JSON, one object a log"
    )
    command.add_argument(
        "--table",
        type=_csv,
        metavar="FILE",
        help="write the figures as .csv too, a row for each log",
    )
    command.set_defaults(refuse=command.error)


def _csv(text: str) -> Path:
    if not text.lower().endswith(".csv"):
        raise argparse.ArgumentTypeError(f"{text!r} must end in .csv")
    return Path(text)


def begin(log: Log, source: str) -> str:
    """Which log comes now."""
    where = "" if source == log.name else f", {source}"
    return f"{log.name}: {counted(len(log), 'scan')}{where}"


def each_log(given: argparse.Namespace, work: Work, head: Callable[[Log, str], str] = begin) -> int:
    """Do one log after the other, and name at the end those that failed.

    The exit code is 1 where one failed, else the largest of the codes of all.
    """
    chosen = [source for text in given.logs for source in sources(text)]
    targets = Targets(getattr(given, "output", []))
    if len(chosen) > 1 and (alike := targets.alike()):
        given.refuse(f"{counted(len(chosen), 'log')} would go to {alike}: write {{name}} in it")
    failed, codes, reports = [], [0], []
    with progress(len(chosen), "log") as bar:
        for source in chosen:
            bar.set_description(shown(Path(source).name))
            reports.append(report := Report(source, json=given.json))
            try:
                log = log_of(source, given)
                paths = targets.paths(log.name, source)
                report.begin(log, head(log, source))
                codes.append(work(given, log, paths, report))
            except BrokenPipeError:  # nobody reads any more
                raise
            except FAULTS as error:
                why, named = reason(error), shown(source)
                failed.append(why if named in why else f"{named}: {why}")
                report.found["failed"] = failed[-1]
            report.end()
            bar.update()
    if given.table:
        write_table(given.table, reports)
    for why in failed:
        tell(why)
    if len(chosen) > 1 and not given.json:
        say(f"{len(chosen) - len(failed)} of {counted(len(chosen), 'log')} done")
    return 1 if failed else max(codes)


def write_table(path: Path, reports: Sequence[Report]) -> None:
    """A row for each log, a column for each figure: `aligned.matched` and so on."""
    rows = [dict(_figures(report.found)) for report in reports]
    text = io.StringIO()
    table = csv.DictWriter(text, list(dict.fromkeys(name for row in rows for name in row)))
    table.writeheader()
    table.writerows(rows)
    write_bytes(path, text.getvalue().encode())


def _figures(said: dict[str, Any], begin: str = "") -> Iterator[tuple[str, Any]]:
    """Each figure with the words that lead to it."""
    for word, value in said.items():
        if isinstance(value, dict):
            yield from _figures(value, f"{begin}{word}.")
        else:
            yield f"{begin}{word}", value


def sources(text: str) -> Iterator[str]:
    """The logs that an argument names: itself, or those in a folder that is no log itself."""
    folder = Path(text)
    if not folder.is_dir() or is_log(folder):
        yield text
        return
    inside = sorted(path for path in folder.iterdir() if not path.name.startswith("."))
    found = [path for path in inside if is_log(path)]
    if rest := [path.name for path in inside if path not in found]:
        tell(f"{shown(folder)}: left out, since no log: {', '.join(map(shown, rest))}")
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


def add_deskew(command: Any) -> None:
    """The option --no-deskew."""
    command.add_argument(
        "--no-deskew",
        action="store_true",
        help="take all beams of a scan to be measured at once, even where the log has their times",
    )


def add_strict(command: Any) -> None:
    """The options that say what counts as a map, and what happens where there is none."""
    command.add_argument(
        "--strict",
        type=_share,
        default=0.0,
        metavar="SHARE",
        help=f"end with {NO_MAP} too where a smaller share of the scans is placed: 0.9 say",
    )
    command.add_argument(
        "--force", action="store_true", help=f"write the files even where that ends with {NO_MAP}"
    )


def _share(text: str) -> float:
    share = float(text)
    if not 0 <= share <= 1:
        raise argparse.ArgumentTypeError(f"{text} must be from 0 to 1")
    return share


def deskewed(given: argparse.Namespace, log: Log, report: Report) -> Log:
    """The log with its beams carried to the start of each scan where it has their times."""
    if given.no_deskew or not is_timed(log):
        return log
    found = deskew(log)
    count = sum(new is not old for new, old in zip(found, log, strict=True))
    words = f"{count} of {counted(len(log), 'scan')}, by how the robot moved meanwhile"
    report.line("de-skewed", words, scans=count)
    return found


def aligned(log: Log, method: str | None, report: Report, veto: Path | None = None) -> Alignment:
    """Align a log and say how it went.

    By default: the true poses where the log has one for each scan; else all poses at once, loops
    closed, but for those that a file vetoes.
    """
    true = log.truth is not None and np.isfinite(log.truth).all()
    name = method or ("ground_truth" if true else "pose_graph")
    options: dict[str, Any] = {}
    if name == "ground_truth":
        options = {"missing": "drop"}
    if name == "angle_correspondence":
        options = {"rng": np.random.default_rng(0)}
    found = METHODS[name](log, **options) if veto is None else without(log, veto)
    figures: dict[str, Any] = {"method": name, "matched": int(found.used.sum())}
    placed = f"{figures['matched']} of {counted(len(found), 'scan')} matched"
    if found.graph is not None:
        figures["loops"] = int(found.graph.loop.sum())
        placed += f", {counted(figures['loops'], 'loop')} closed"
    words = f"by {name}: {placed}, {seconds(found.seconds)}"
    report.line("aligned", words, **figures, scans=len(found), seconds=found.seconds)
    reasons = Counter(filter(None, found.reasons)).most_common(MOST_REASONS)
    for why, count in reasons:
        report.line("", f"{counted(count, 'scan')} not: {why}")
    if found.doubt:
        report.line("", f"doubt: {found.doubt}")
    return found


def without(log: Log, path: Path) -> Alignment:
    """The pose graph of a log without the loops that a file names, as `--loops` writes it."""
    graph = LiveGraph()
    for scan in log:
        graph.add(scan)
    found = graph.refine().loops()
    known = list(zip(found["first"], found["second"], strict=True))
    with path.open(newline="") as file:
        try:
            gone = {(int(row["first"]), int(row["second"])) for row in csv.DictReader(file)}
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"{path} must be a table with columns first and second") from error
    for first, second in sorted(gone - set(known)):
        raise ValueError(f"{path}: no loop was closed between scans {first} and {second}")
    if gone:
        graph.veto(*[row for row, pair in enumerate(known) if pair in gone])
    return graph.refine()


def add_world(command: Any) -> None:
    """The options that say how a map is turned, and where on the earth it lies."""
    group = command.add_argument_group("where the map lies")
    group.add_argument(
        "--square",
        action="store_true",
        help="turn the map about its origin, by the smallest angle, until most walls run along x "
        "and y; all files then have this frame",
    )
    group.add_argument(
        "--place",
        nargs=2,
        type=float,
        metavar=("LAT", "LON"),
        help="where (0, 0) of the map lies, degrees of WGS84: a .geojson is then in degrees, the "
        "other files stay in metres",
    )
    group.add_argument(
        "--north",
        type=float,
        metavar="DEGREES",
        help="where north is in the map, and in the squared one with --square: counter-clockwise "
        "from x; default: 90, y points north",
    )
    group.add_argument(
        "--crs",
        metavar="EPSG:CODE",
        help="a grid in metres, as EPSG:25832: --place is then EAST NORTH in it, and a .geojson "
        "names it",
    )


def world_of(given: argparse.Namespace) -> Frame:
    """Where the map lies; ends with an error of usage where the options do not go together."""
    if given.place is None:
        for option in ("north", "crs"):
            if getattr(given, option) is not None:
                given.refuse(f"--{option} needs --place, the place of the map's (0, 0)")
        return Frame()
    if not any(name.lower().endswith(".geojson") for name in given.output):
        given.refuse("--place is for a .geojson, the other files have no place: name one with -o")
    north = np.radians(90.0 if given.north is None else given.north)
    first, second = given.place
    try:
        if given.crs is not None:
            return Grid(given.crs, first, second, north)
        return Earth(first, second, north)
    except ValueError as error:
        swapped = given.crs is None and 90 < abs(first) <= 180 and abs(second) <= 90
        given.refuse(f"--place: {error}" + ("; the latitude comes first" if swapped else ""))
        raise


def squared(given: argparse.Namespace, log: Log, found: Alignment, report: Report) -> Alignment:
    """The poses turned about the origin until most walls run along x and y, where asked for."""
    if not given.square:
        return found
    turn = -main_direction(build_map(log, found.trusted))
    words = f"by {np.degrees(turn):.2f} degrees about the origin: most walls along x and y"
    report.line("turned", words, degrees=float(np.degrees(turn)))
    return replace(found, poses=compose((0, 0, turn), found.poses))


def too_little(given: argparse.Namespace, verdict: Verdict) -> bool:
    """Whether this is no map, or holds fewer scans than --strict asks for."""
    return verdict.grade == "not a map" or verdict.placed < given.strict * verdict.scans


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
    """Say the verdict on the map, as the last line, and give the exit code."""
    few = verdict.grade != "not a map" and too_little(given, verdict)
    asked = f" (--strict asks for {percent(given.strict)} of the scans)" if few else ""
    report.line("verdict", f"{verdict}{asked}", **asdict(verdict))
    return NO_MAP if too_little(given, verdict) else 0


def add_output(command: argparse.ArgumentParser, suffixes: Sequence[str], what: str) -> None:
    """The option -o, as often as one likes, for names that end in one of the suffixes."""
    command.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FILE",
        type=partial(_checked, suffixes),
        help=f"write {what}; the name ends in {', '.join(suffixes)}; may be given more than once; "
        f"{NAME} in it stands for the name of the log, for several logs: 'maps/{NAME}.svg'",
    )


def _checked(suffixes: Sequence[str], text: str) -> str:
    if not text.lower().endswith(tuple(suffixes)) or text.startswith(tuple(suffixes)):
        raise argparse.ArgumentTypeError(f"{text!r} must end in one of {', '.join(suffixes)}")
    return text


class Targets:
    """The names given with -o, with the name of each log in its place."""

    def __init__(self, patterns: Sequence[str]) -> None:
        self._patterns = patterns
        self._taken: dict[Path, str] = {}

    def alike(self) -> str:
        """The first name that is the same for all logs; empty where there is none."""
        return next((pattern for pattern in self._patterns if NAME not in pattern), "")

    def paths(self, name: str, source: str) -> list[Path]:
        """The files for a log of this name, none of them written before, nor the log itself."""
        found = [Path(pattern.replace(NAME, name)) for pattern in self._patterns]
        for path in found:
            place = path.resolve()
            if not place.parent.is_dir():
                raise FileNotFoundError(f"cannot write {path}: make the folder {path.parent} first")
            if place.is_dir():
                raise ValueError(f"cannot write {path}: it is a folder")
            if place == Path(source).resolve():
                raise ValueError(f"cannot write {path}: it is the log itself")
            if other := self._taken.get(place):
                raise ValueError(f"{path} was written for {other}: this log would replace it")
            self._taken[place] = source
        return found
