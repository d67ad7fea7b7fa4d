"""A pose for each scan of a log, and the frame in which its map is written."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

from ..._display import counted
from ...alignment import METHODS, Alignment, LiveGraph, deskew, usual_method
from ...arrays import Array
from ...exports import Frame, placed_at
from ...extraction import build_map
from ...quadtree import QuadtreeMap, extent
from ...scans import Log
from ...scans.moving import is_timed
from ...segments import SegmentMap, main_direction
from .._words import Report, seconds
from ._logs import add_logs, add_strict
from ._thresholds import add_thresholds, chosen_thresholds, refuse_others

#: So many reasons for scans that were not matched are told.
MOST_REASONS = 3
#: What happens without --align, in most commands.
ALIGN = "default: ground_truth where the log has it for each scan, else pose_graph"
Map = TypeVar("Map", SegmentMap, QuadtreeMap)


def add_poses(command: argparse.ArgumentParser, *, align: bool = True) -> None:
    """All that leads from LOG... to a pose for each scan, and when that is a map."""
    add_logs(command)
    if align:
        add_align(command)
    command.add_argument(
        "--no-deskew",
        action="store_true",
        help="take all beams of a scan to be measured at once, even where the log has their times",
    )
    add_strict(command)


def placed(given: argparse.Namespace, log: Log, report: Report) -> tuple[Log, Alignment]:
    """The log with its beams carried to the start of each scan, and a pose for each scan."""
    log = deskewed(given, log, report)
    return log, squared(given, log, aligned(given, log, report), report)


def add_align(command: Any, without: str = ALIGN) -> None:
    """The option --align, and the thresholds of what it names.

    `without` says what happens where it is not given.
    """
    command.add_argument(
        "--align", choices=METHODS, metavar="METHOD", help=f"{', '.join(METHODS)}; {without}"
    )
    functions = {name: method.function for name, method in METHODS.items()}
    add_thresholds(command, "thresholds of the alignment methods", functions, "align_")


def deskewed(given: argparse.Namespace, log: Log, report: Report) -> Log:
    """The log with its beams carried to the start of each scan where it has their times."""
    if given.no_deskew or not is_timed(log):
        return log
    found = deskew(log)
    count = sum(new is not old for new, old in zip(found, log, strict=True))
    words = f"{count} of {counted(len(log), 'scan')}, by how the robot moved meanwhile"
    report.line("de-skewed", words, scans=count)
    return found


def aligned(given: argparse.Namespace, log: Log, report: Report) -> Alignment:
    """Align a log and say how it went.

    By default: the true poses where the log has one for each scan; else all poses at once, loops
    closed.
    """
    name = given.align or usual_method(log)
    refuse_others(given, name, METHODS, "align_")
    options: dict[str, Any] = {"missing": "drop"} if name == "ground_truth" else {}
    if name == "angle_correspondence":
        options = {"rng": np.random.default_rng(0)}
    options |= chosen_thresholds(given, METHODS[name].function, "align_")
    if getattr(given, "veto", []) or getattr(given, "tie", []):
        graph = LiveGraph(**options)
        graph.extend(log)
        graph.refine()
        found = graph.mended(ends(given.veto), ends(given.tie))
    else:
        found = METHODS[name](log, **options)
    tell_alignment(found, report)
    return found


def tell_alignment(found: Alignment, report: Report) -> None:
    """Say how many scans are placed, how many loops that took, and what speaks against it."""
    figures: dict[str, Any] = {"method": found.method, "matched": int(found.used.sum())}
    placed = f"{figures['matched']} of {counted(len(found), 'scan')} matched"
    if found.graph is not None:
        figures["loops"] = int(found.graph.loop.sum())
        placed += f", {counted(figures['loops'], 'loop')} closed"
    words = f"by {found.method}: {placed}, {seconds(found.seconds)}"
    report.line("aligned", words, **figures, scans=len(found), seconds=found.seconds)
    reasons = Counter(filter(None, found.reasons)).most_common(MOST_REASONS)
    for why, count in reasons:
        report.line("", f"{counted(count, 'scan')} not: {why}")
    if found.doubt:
        report.line("", f"doubt: {found.doubt}")


def ends(loops: Sequence[str]) -> list[list[int]]:
    """Both scans of each loop that is given as `FIRST-SECOND`."""
    return [[int(scan) for scan in loop.split("-")] for loop in loops]


def add_world(command: Any) -> None:
    """The options that say how a map is turned and cropped, and where on the earth it lies."""
    group = command.add_argument_group("where the map lies")
    group.add_argument(
        "--crop",
        nargs=4,
        type=float,
        metavar=("LEFT", "LOW", "RIGHT", "HIGH"),
        help="keep what lies in this rectangle, metres, of the map that is written",
    )
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


def check_options(given: argparse.Namespace) -> None:
    """End with an error of usage, before any work, where these options do not go together."""
    if getattr(given, "align", None):
        refuse_others(given, given.align, METHODS, "align_")
    if hasattr(given, "crop"):
        world_of(given)
        try:
            SegmentMap([]).cropped(*given.crop or (0, 0, 1, 1))
        except ValueError as error:
            given.refuse(f"--crop: {error}")


def world_of(given: argparse.Namespace) -> Frame:
    """Where the map lies; ends with an error of usage where the options do not go together."""
    if given.place is None:
        for option in ("north", "crs"):
            if getattr(given, option) is not None:
                given.refuse(f"--{option} needs --place, the place of the map's (0, 0)")
        return Frame()
    useful = any(name.lower().endswith((".geojson", ".segmap")) for name in given.output)
    if not useful and "place" not in given.held:
        given.refuse("--place is for a .geojson, the other files have no place: name one with -o")
    try:
        return placed_at(given.place, given.north, given.crs)
    except ValueError as error:
        given.refuse(f"--place: {error}")
        raise


def squared(given: argparse.Namespace, log: Log, found: Alignment, report: Report) -> Alignment:
    """The poses turned about the origin until most walls run along x and y, where asked for."""
    if not getattr(given, "square", False):
        return found
    turn = -main_direction(build_map(log, found.trusted))
    words = f"by {np.degrees(turn):.2f} degrees about the origin: most walls along x and y"
    report.line("turned", words, degrees=float(np.degrees(turn)))
    return found.turned(turn)


def cropped(given: argparse.Namespace, map: Map, report: Report) -> Map:
    """Cut off what lies outside a rectangle, where that is asked for."""
    if given.crop is None:
        return map
    found = map.cropped(*given.crop)
    if isinstance(map, QuadtreeMap):
        what, count = "square", int((found.leaves().occ > 0).sum())
        left, low, right, high = extent(map, margin=0)
    else:
        what, count = "segment", len(found)
        ends: Array = map.segments.reshape(-1, 2)
        left, low, right, high = (*ends.min(0), *ends.max(0)) if len(map) else (0.0,) * 4
    if not count and (left, low) != (right, high):  # of an empty map nothing was cut off
        reach = f"x {left:.2f} to {right:.2f} m, y {low:.2f} to {high:.2f} m"
        raise ValueError(f"--crop: no {what} lies in that rectangle; the map reaches from {reach}")
    report.line("cropped", f"to {counted(count, what)}", **{f"{what}s": count})
    return found
