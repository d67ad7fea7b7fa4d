"""A pose for each scan of a log, and the frame in which its map is written."""

from __future__ import annotations

import argparse
from collections import Counter
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from segmap.alignment import METHODS, Alignment, usual_method
from segmap.display import counted
from segmap.scans import Log
from segmap.scans.causes import Cause
from segmap.scans.motion import is_timed
from segmap.segments import SegmentMap

from ...call import directions
from ...pipeline import MapChoices, Pipeline, world_of
from .._output import Report, Usage, seconds
from ._command import Command, checked, switch
from ._logs import add_logs, add_strict
from ._methods import call_of, word_of
from ._settings import EDITS, PREPARE

#: So many reasons for scans that were not matched are told.
MOST_REASONS = 3
#: What happens without --align, in most commands.
ALIGN = "default: pose_graph"


def add_poses(command: Command, *, align: bool = True) -> None:
    """All that leads from LOG... to a pose for each scan, and when that is a map."""
    add_logs(command)
    if align:
        add_align(command)
    add_preparing(command)
    add_strict(command)


def add_preparing(command: Command) -> None:
    """The options for `alignment.prepared`."""
    group = command.add_argument_group("the laser and its log")
    words = "take all beams of a scan to be measured at once, even where the log has their times"
    switch(group, "--no-deskew", help=words)
    switch(group, "--keep-body", help="keep beams that see the robot itself")
    group.add_argument(
        "--mask",
        action="append",
        type=checked(lambda text: directions([text])),
        metavar="FROM:TO",
        help="leave out what the laser sees from one direction to another, degrees "
        "counter-clockwise from where it looks: the robot's own posts; -170:-150,150:170 are two",
    )
    words = "the laser counts its beams clockwise, or hangs upside down, and the log does not say"
    switch(group, "--clockwise", help=words)
    group.add_argument(
        "--mount",
        nargs=3,
        type=float,
        metavar=("X", "Y", "DEGREES"),
        help="where the laser sits on the robot, metres ahead and to the left, and where it looks, "
        "counter-clockwise from ahead; `--mount auto` takes what turns and ways tell",
    )
    switch(group, "--mount-auto", help=argparse.SUPPRESS)


def recipe_of(given: argparse.Namespace, log: Log) -> MapChoices:
    """What the options say of the way to poses, by default a pose graph, and of edits on a map."""
    align = call_of(getattr(given, "align", None) or "pose_graph", METHODS)
    if align.name == "ground_truth" != usual_method(log):  # some scans have none
        align = replace(align, thresholds={"missing": "drop", **align.thresholds})
    unprepared = {} if hasattr(given, "no_deskew") else {"no_deskew": True}
    prepare = unprepared | {name: v for name in PREPARE if (v := getattr(given, name, None))}
    return MapChoices(align, prepare=prepare, edits=edits_of(given))


def edits_of(given: argparse.Namespace) -> dict[str, Any]:
    """What the options change in the map, and not in the way to it."""
    return {name: value for name in EDITS if (value := getattr(given, name, None))}


def placed_outcome(given: argparse.Namespace, log: Log, report: Report) -> Pipeline:
    """The log with its beams carried to the start of each scan, and a pose for each scan."""
    return tell_poses(Pipeline(recipe_of(given, log), log), report)


def add_align(command: Command, without: str = ALIGN) -> None:
    """The option --align.

    `without` says what happens where it is not given.
    """
    words = f"{', '.join(METHODS)}; {without}"
    command.add_argument("--align", type=word_of(METHODS), metavar="METHOD", help=words)


def tell_poses(outcome: Pipeline, report: Report) -> Pipeline:
    """Say how a log was de-skewed, aligned and turned, each as soon as it is."""
    tell_deskewing(outcome, report)
    tell_alignment(outcome.alignment_in_log_frame, report)
    if outcome.recipe.edits.get("square"):
        degrees = float(np.degrees(outcome.turn))
        words = f"by {degrees:.2f} degrees about the origin: most walls along x and y"
        report.line("turned", words, degrees=degrees)
    return outcome


def tell_deskewing(outcome: Pipeline, report: Report) -> None:
    """Say of how many scans the beams were carried to their start, where they have their times."""
    if any(finding.cause is Cause.SKEW for finding in outcome.log.causes):
        return  # no beam is carried, and the doubt of the alignment says why
    if is_timed(outcome.given) and not is_timed(outcome.log):
        count = sum(new is not old for new, old in zip(outcome.log, outcome.given, strict=True))
        words = f"{count} of {counted(len(outcome.log), 'scan')}, by how the robot moved meanwhile"
        report.line("de-skewed", words, scans=count)


def tell_alignment(found: Alignment, report: Report) -> None:
    """Say how many scans are placed, how many loops that took, and what speaks against it."""
    figures: dict[str, Any] = {"method": found.method, "matched": int(found.used.sum())}
    placed = f"{figures['matched']} of {counted(len(found), 'scan')} matched"
    if found.graph is not None:
        figures["loops"] = int(found.graph.loop.sum())
        placed += f", {counted(figures['loops'], 'loop')} closed"
    words = f"by {found.method}: {placed}, {seconds(found.seconds)}"
    figures["causes"] = [asdict(finding) for finding in found.causes]
    report.line("aligned", words, **figures, scans=len(found), seconds=found.seconds)
    reasons = Counter(filter(None, found.reasons)).most_common(MOST_REASONS)
    for why, count in reasons:
        report.line("", f"{counted(count, 'scan')} not: {why}")
    if found.doubt:
        report.line("", f"doubt: {found.doubt}")


def add_world(command: Command) -> None:
    """The options that say how a map is turned and cropped, and where on the earth it lies."""
    group = command.add_argument_group("where the map lies")
    group.add_argument(
        "--crop",
        nargs=4,
        type=float,
        metavar=("LEFT", "LOW", "RIGHT", "HIGH"),
        help="keep what lies in this rectangle, metres, of the map that is written",
    )
    switch(
        group,
        "--square",
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
        nargs=1,
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


def check_world(given: argparse.Namespace) -> None:
    """End with an error of usage, before any work, where these options do not go together."""
    option = "--place"
    try:
        world_of(edits_of(given))
        option = "--crop"
        SegmentMap([]).cropped(*given.crop or (0, 0, 1, 1))
    except ValueError as error:
        raise Usage(f"{option}: {error}") from error
