"""`segmap map LOG...`: poses, segments, a reduction, how good it is, and whether it is a map."""

from __future__ import annotations

import argparse
import csv
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from .. import exports, extraction, metrics
from .._display import counted
from ..alignment import Alignment
from ..files import write_bytes
from ..quadtree import without_passers
from ..readers import Session
from ..reduction import METHODS, Reduction
from ..scans import Log
from ..segments import SegmentMap
from . import opening
from ._words import Report, metres, percent, seconds
from .opening._thresholds import add_thresholds, chosen_thresholds, refuse_others

#: What -o may end in.
SUFFIXES = (".svg", ".csv", ".npz", ".dxf", ".png", ".geojson", ".wkt", ".segmap")
WRITTEN = (
    "the map after the reduction; a .png shows it before and after, a .segmap keeps the log with "
    "these options and figures"
)
#: The thresholds of the extraction begin so.
EXTRACT = "extract_"


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "map", help="a map of segments: align, extract, reduce, and tell how good it is"
    )
    opening.add_poses(command)
    command.add_argument(
        "--veto",
        action="extend",
        type=pairs,
        default=[],
        metavar="FILE",
        help="align by pose_graph without these loops: the rows of --loops that are false, or one "
        "as FIRST-SECOND",
    )
    command.add_argument(
        "--tie",
        action="extend",
        type=pairs,
        default=[],
        metavar="FIRST-SECOND",
        help="align by pose_graph, with a loop between two scans that see one place; or a FILE",
    )
    add_making(command)
    command.set_defaults(run=partial(opening.each_log, work=map_log, check=check))


def add_making(command: argparse.ArgumentParser) -> None:
    """All that leads from poses to a map and its files."""
    names = (*METHODS, "none")
    command.add_argument(
        "--method",
        choices=names,
        default="least_cost",
        metavar="METHOD",
        help=f"{', '.join(names)}; default: least_cost",
    )
    command.add_argument(
        "--extract",
        choices=extraction.METHODS,
        default="extract_polylines",
        metavar="METHOD",
        help=f"{', '.join(extraction.METHODS)}; default: extract_polylines",
    )
    command.add_argument(
        "--filter", type=float, metavar="METRES", help="leave shorter segments out before reducing"
    )
    command.add_argument(
        "--seen-through",
        type=float,
        metavar="SHARE",
        help="leave people out who walked through: beams that end where at most this share of all "
        "beams ended while the others went on, 0.2 say",
    )
    command.add_argument(
        "--loops",
        type=Path,
        metavar="FILE",
        help="align by pose_graph, and write its loops as .csv: scans, residual, span, places",
    )
    opening.add_world(command)
    opening.add_output(command, SUFFIXES, WRITTEN)
    functions = {name: method.function for name, method in METHODS.items()}
    add_thresholds(command, "thresholds of the reduction methods", functions)
    add_thresholds(command, "thresholds of the extraction", extraction.METHODS, EXTRACT)


def check_making(given: argparse.Namespace) -> None:
    """Refuse options that do not go together."""
    refuse_others(given, given.method, METHODS)
    refuse_others(given, given.extract, extraction.METHODS, EXTRACT)
    opening.check_options(given)


def check(given: argparse.Namespace) -> None:
    """Refuse loops that are of no pose graph, or of several."""
    check_making(given)
    if given.veto or given.tie or given.loops:
        if given.align not in (None, "pose_graph"):
            given.refuse(f"--loops, --veto and --tie: {given.align} closes no loops")
        if len(given.logs) > 1:
            given.refuse("--loops, --veto and --tie are for one log")
        given.align = "pose_graph"


def pairs(text: str) -> list[str]:
    """Loops as `FIRST-SECOND`: one, or those of a table as `--loops` writes it."""
    if re.fullmatch(r"\d+-\d+", text):
        return [text]
    rows = csv.DictReader(Path(text).read_text().splitlines())
    try:
        return [f"{int(row['first'])}-{int(row['second'])}" for row in rows]
    except (KeyError, TypeError, ValueError) as error:
        words = f"{text} must be a table with columns first and second"
        raise argparse.ArgumentTypeError(words) from error


def map_log(given: argparse.Namespace, log: Log, paths: list[Path], report: Report) -> int:
    """Map one log, and write what was asked for where there is a map."""
    carried, poses = opening.placed(given, log, report)
    return made(given, carried, poses, paths, report, partial(opening.session_of, given, log))


def made(
    given: argparse.Namespace,
    log: Log,
    poses: Alignment,
    paths: list[Path],
    report: Report,
    session: Callable[[dict[str, Any]], Session],
) -> int:
    """Make the map of a log at its poses, and write it; `session` keeps the figures of this run."""
    before = segments_of(given, log, poses, report)
    if given.loops is not None:
        write_bytes(given.loops, poses.loops().to_csv().encode())
        report.line("loops", f"written to {given.loops}", file=str(given.loops))
    verdict = poses.verdict_on(before)
    before = filtered(given, opening.cropped(given, before, report), report)
    after = before if given.method == "none" else reduced(given, before, report)

    def write(path: Path) -> None:
        """In the format that the name asks for."""
        if path.suffix.lower() == ".png":
            from ._pictures import write_map_picture

            write_map_picture(path, before, after)
        elif path.suffix.lower() == ".segmap":
            exports.write_session(path, session(report.found))
        else:
            exports.write_segments(path, after, world=opening.world_of(given))

    return opening.finished(given, verdict, paths, report, write)


def segments_of(
    given: argparse.Namespace, log: Log, poses: Alignment, report: Report
) -> SegmentMap:
    """Extract the segments of a log at its poses."""
    extract = extraction.METHODS[given.extract]
    options = chosen_thresholds(given, extract, EXTRACT) | {"extract": extract}
    if given.seen_through is not None:
        left = without_passers(log, poses.trusted, seen_through=given.seen_through)
        gone = sum(int(a.valid.sum() - b.valid.sum()) for a, b in zip(log, left, strict=True))
        words = f"{counted(gone, 'beam')} left out that others saw through"
        report.line("passers", words, beams=gone)
        log = left
    method = METHODS.get(given.method)
    needs = method is not None and (method.needs_points or method.needs_sensors)
    map = extraction.build_map(log, poses.trusted, keep_points=needs, **options)
    report.line("extracted", counted(len(map), "segment"), segments=len(map))
    return map


def filtered(given: argparse.Namespace, map: SegmentMap, report: Report) -> SegmentMap:
    """Leave short segments out, where that is asked for."""
    if given.filter is None:
        return map
    map = map.filtered(given.filter)
    words = f"{counted(len(map), 'segment')} of {given.filter:g} m or more"
    report.line("filtered", words, segments=len(map), least=given.filter)
    return map


def reduced(given: argparse.Namespace, map: SegmentMap, report: Report) -> Reduction:
    """Reduce a map and say how good the reduction is."""
    method = METHODS[given.method]
    options = chosen_thresholds(given, method.function)
    found = method(map, **options)
    rate = metrics.reduction_rate(map, found)
    gone = f"{percent(rate)} gone ({metrics.grade_reduction(rate)})"
    left = counted(len(found), "segment")
    report.line(
        "reduced",
        f"by {given.method}: {left} left, {gone}, {seconds(found.seconds)}",
        method=given.method,
        segments=len(found),
        rate=rate,
        grade=metrics.grade_reduction(rate),
        seconds=found.seconds,
    )
    if found.doubt:
        report.line("", f"doubt: {found.doubt}")
    if len(map):
        kept, errors = metrics.quality(map, found), metrics.errors(map, found)
        off = f"segments lie {metres(errors.mean())} off on average, {metres(errors.max())} at most"
        report.line(
            "quality",
            f"{percent(kept)} ({metrics.grade_quality(kept)} reduction): {off}",
            quality=kept,
            grade=metrics.grade_quality(kept),
            mean_error=float(errors.mean()),
            largest_error=float(errors.max()),
        )
    return found
