"""`segmap map LOG...`: poses, segments, a reduction, how good it is, and whether it is a map."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from .. import exports, extraction, metrics
from .._display import counted
from ..alignment import Alignment
from ..files import write_bytes
from ..quadtree import without_passers
from ..reduction import METHODS, Reduction
from ..scans import Log
from ..segments import SegmentMap
from ._logs import (
    add_align,
    add_deskew,
    add_logs,
    add_output,
    add_strict,
    add_world,
    aligned,
    allowed,
    concluded,
    deskewed,
    each_log,
    squared,
    world_of,
)
from ._thresholds import add_thresholds, chosen_thresholds, refuse_others
from ._words import Report, metres, percent, progress, seconds

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
    add_deskew(command)
    add_strict(command)
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
    command.add_argument(
        "--veto",
        type=Path,
        metavar="FILE",
        help="align by pose_graph without these loops: the rows of --loops that are false",
    )
    add_world(command)
    command.add_argument(
        "--crop",
        nargs=4,
        type=float,
        metavar=("LEFT", "LOW", "RIGHT", "HIGH"),
        help="keep what lies in this rectangle, metres, of the map that is written",
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
    world_of(given)  # before any work is done
    if given.veto is not None and given.align not in (None, "pose_graph"):
        given.refuse(f"--veto is for pose_graph: {given.align} closes no loops")
    if (given.veto or given.loops) and len(given.logs) > 1:
        given.refuse("--loops and --veto are for one log")
    if given.crop is not None:
        try:
            SegmentMap([]).cropped(*given.crop)
        except ValueError as error:
            given.refuse(f"--crop: {error}")
    return each_log(given, map_log)


def map_log(given: argparse.Namespace, log: Log, paths: list[Path], report: Report) -> int:
    """Map one log, and write what was asked for where there is a map."""
    with progress(3, "step", "aligning") as bar:
        log = deskewed(given, log, report)
        closing = given.loops is not None or given.veto is not None
        method = given.align or ("pose_graph" if closing else None)
        poses = aligned(log, method, report, given.veto)
        if given.loops is not None:
            write_bytes(given.loops, poses.loops().to_csv().encode())
            report.line("loops", f"written to {given.loops}", file=str(given.loops))
        poses = squared(given, log, poses, report)
        before = segments_of(given, log, poses, report)
        verdict = poses.verdict_on(before)
        before = filtered(given, cropped(given, before, report), report)
        bar.update()
        bar.set_description("reducing")
        after = before if given.method == "none" else reduced(given, before, report)
        bar.update()
        bar.set_description("writing")
        written = allowed(given, verdict, paths, report)
        for path in written:
            if path.suffix.lower() == ".png":
                from ._pictures import write_map_picture

                write_map_picture(path, before, after)
            else:
                exports.write_segments(path, after, world=world_of(given))
    if written:
        names = [str(path) for path in written]
        report.line("written", ", ".join(names), files=names)
    return concluded(given, verdict, report)


def segments_of(
    given: argparse.Namespace, log: Log, poses: Alignment, report: Report
) -> SegmentMap:
    """Extract the segments of a log at its poses."""
    options = chosen_thresholds(given, extraction.extract_polylines, EXTRACT)
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


def cropped(given: argparse.Namespace, map: SegmentMap, report: Report) -> SegmentMap:
    """Cut off what lies outside a rectangle, where that is asked for."""
    if given.crop is None:
        return map
    found = map.cropped(*given.crop)
    if len(map) and not len(found):
        (left, low), (right, high) = (f(map.segments, (0, 1)) for f in (np.min, np.max))
        reach = f"x {left:.2f} to {right:.2f} m, y {low:.2f} to {high:.2f} m"
        raise ValueError(f"--crop: no segment lies in that rectangle; the map reaches from {reach}")
    report.line("cropped", f"to {counted(len(found), 'segment')}", segments=len(found))
    return found


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
