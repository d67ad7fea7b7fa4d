"""`segmap map LOG...`: poses, segments, a reduction, and how good it is."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from .. import exports, extraction, metrics
from ..reduction import METHODS, Reduction
from ..scans import Log
from ..segments import SegmentMap
from ._logs import add_align, add_logs, aligned, each_log
from ._targets import add_output
from ._thresholds import add_thresholds, chosen_thresholds, refuse_others
from ._words import counted, line, metres, percent, progress, seconds

#: What -o may end in.
SUFFIXES = (".svg", ".csv", ".npz", ".dxf", ".png", ".geojson", ".wkt")
#: The thresholds of the extraction begin so.
EXTRACT = "extract_"


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "map", help="a map of segments: align, extract, reduce, and tell how good it is"
    )
    add_logs(command)
    add_align(command)
    names = (*METHODS, "none")
    command.add_argument(
        "--method",
        choices=names,
        default="least_cost",
        metavar="METHOD",
        help=f"{', '.join(names)}; default: least_cost",
    )
    command.add_argument(
        "--filter", type=float, metavar="METRES", help="leave shorter segments out before reducing"
    )
    add_output(command, SUFFIXES, "the map after the reduction; a .png shows it before and after")
    functions = {name: method.function for name, method in METHODS.items()}
    add_thresholds(command, "thresholds of the reduction methods", functions)
    extract = {"extract_polylines": extraction.extract_polylines}
    add_thresholds(command, "thresholds of the extraction", extract, EXTRACT)
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> int:
    """Map each log."""
    refuse_others(given, given.method, METHODS)
    return each_log(given, map_log)


def map_log(given: argparse.Namespace, log: Log, paths: list[Path]) -> None:
    """Map one log, and write what was asked for."""
    with progress(3, "step", "aligning") as bar:
        before = segments_of(given, log)
        bar.update()
        bar.set_description("reducing")
        after = before if given.method == "none" else reduced(given, before)
        bar.update()
        bar.set_description("writing")
        for path in paths:
            if path.suffix.lower() == ".png":
                from ._pictures import write_map_picture

                write_map_picture(path, before, after)
            else:
                exports.write_segments(path, after)
    if paths:
        line("written", ", ".join(map(str, paths)))


def segments_of(given: argparse.Namespace, log: Log) -> SegmentMap:
    """Align a log and extract its segments."""
    poses = aligned(log, given.align)
    options = chosen_thresholds(given, extraction.extract_polylines, EXTRACT)
    method = METHODS.get(given.method)
    needs = method is not None and (method.needs_points or method.needs_sensors)
    map = extraction.build_map(log, poses.trusted, keep_points=needs, **options)
    line("extracted", counted(len(map), "segment"))
    if given.filter is not None:
        map = map.filtered(given.filter)
        line("filtered", f"{counted(len(map), 'segment')} of {given.filter:g} m or more")
    return map


def reduced(given: argparse.Namespace, map: SegmentMap) -> Reduction:
    """Reduce a map and say how good the result is."""
    method = METHODS[given.method]
    options = chosen_thresholds(given, method.function)
    found = method(map, **options)
    rate = metrics.reduction_rate(map, found)
    gone = f"{percent(rate)} gone ({metrics.grade_reduction(rate)})"
    left = counted(len(found), "segment")
    line("reduced", f"by {given.method}: {left} left, {gone}, {seconds(found.seconds)}")
    if found.doubt:
        line("", f"doubt: {found.doubt}")
    if len(map):
        kept, errors = metrics.quality(map, found), metrics.errors(map, found)
        off = f"segments lie {metres(errors.mean())} off on average, {metres(errors.max())} at most"
        line("quality", f"{percent(kept)} ({metrics.grade_quality(kept)}): {off}")
    return found
