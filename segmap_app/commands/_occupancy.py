"""`segmap occupancy LOG...`: a quadtree of what is free and what is occupied."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from segmap import alignment, exports, extraction, quadtree, warm
from segmap.alignment import Alignment
from segmap.arrays import declared
from segmap.display import counted
from segmap.matching import MATCHERS, SCORES, map_scans
from segmap.progress import each
from segmap.scans import Log
from segmap.scans.causes import Cause, Finding

from .. import files
from ..call import preparing
from ..pipeline import cropped, world_of
from . import log_options
from ._output import Report

#: What -o may end in.
SUFFIXES = (".yaml", ".png", ".svg", ".npz", ".geojson")
#: The matchers as words of a command: "hill-climbing" and so on.
NAMES = {name.replace(",", "").replace(" ", "-"): name for name in MATCHERS}


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "occupancy",
        help="a quadtree of what is occupied and free, for ROS too",
        epilog=log_options.examples(
            "occupancy room -o room.yaml                  for ROS: it writes room.pgm too",
            "occupancy room --resolution 0.02 -o room.npz -o room.png",
            "occupancy room --matcher hill-climbing       by ranges alone",
        ),
    )
    log_options.add_poses(command)
    command.add_argument(
        "--matcher",
        choices=NAMES,
        metavar="MATCHER",
        help=f"instead: place each scan on the map of those before, by ranges alone, for a sensor "
        f"that moves little from scan to scan: {', '.join(NAMES)}",
    )
    command.add_argument(
        "--score", choices=SCORES, metavar="SCORE", help=f"of --matcher: {', '.join(SCORES)}"
    )
    command.add_argument(
        "--resolution", type=float, default=0.05, metavar="METRES", help="of a cell; default: 0.05"
    )
    log_options.add_world(command)
    log_options.add_output(
        command, SUFFIXES, "the map: .yaml for ROS, with its .pgm; .npz to load it again"
    )
    command.set_defaults(run=partial(log_options.each_log, work=draw_tree_of_log, check=check))


def check(given: argparse.Namespace) -> None:
    """Refuse options that do not go together."""
    if given.score and not given.matcher:
        given.refuse(f"--score {given.score} is for --matcher: name one of {', '.join(NAMES)}")
    if given.square and given.matcher:
        given.refuse("--square turns poses that --align finds, and --matcher finds them on the way")
    if given.align and given.matcher:
        given.refuse("--align finds poses before there is a map, --matcher on the way: name one")
    resolution = declared(quadtree.QuadtreeMap.__init__)["resolution"]
    log_options.refuse_wrong(given, "resolution", resolution)
    log_options.check_options(given)


def draw_tree_of_log(given: argparse.Namespace, log: Log, paths: list[Path], report: Report) -> int:
    """Map one log, and write what was asked for where there is a map."""
    warm.dispatch(["quadtree all"] + ["matching all"] * bool(given.matcher))
    if given.matcher:
        map, found, log = _matched(given, log, report)
    else:
        made = log_options.placed_outcome(given, log, report)
        found, log = made.alignment, made.log
        map = quadtree.build_map(log, found.trusted, resolution=given.resolution)
    verdict = found.verdict_on(extraction.build_map(log, found.trusted), map)
    if given.crop is not None:
        map = cropped(map, given.crop)
        count = int((map.leaves().occ > 0).sum())
        report.line("cropped", f"to {counted(count, 'square')}", squares=count)
    left, low, right, high = quadtree.extent(map, margin=0)
    size = f"{right - left:.1f} m by {high - low:.1f} m at {given.resolution:g} m"
    leaves = map.leaves()
    full = map.leaf_occupancy() > 0.5
    area = float((leaves.side[full] ** 2).sum())
    words = f"{size}: {area:.2f} m2 occupied, {len(full)} leaves in {map.nbytes / 1024:.0f} KB"
    figures = {"width": right - left, "height": high - low, "occupied": area, "leaves": len(full)}
    report.line("mapped", words, **figures, resolution=given.resolution, bytes=map.nbytes)
    world = world_of(log_options.edits_of(given))
    return log_options.finished(
        given, verdict, paths, report, lambda path: _write_tree(path, map, world)
    )


def _matched(
    given: argparse.Namespace, log: Log, report: Report
) -> tuple[quadtree.QuadtreeMap, Alignment, Log]:
    """The map that grows scan by scan, its poses and the log; the first scan is its origin."""
    log = alignment.prepared(
        log, **preparing(log_options.preparing_of(given) | {"no_deskew": True})
    )
    map, score = quadtree.QuadtreeMap(resolution=given.resolution), given.score or "field"
    rng = np.random.default_rng(0)
    matcher = MATCHERS[NAMES[given.matcher]](rng)
    steps = list(
        map_scans(each(log, "placing scan"), map=map, matcher=matcher, score=SCORES[score], rng=rng)
    )
    placed = int(np.isfinite([step.score for step in steps]).sum())
    words = f"{placed} of {counted(len(log), 'scan')} (the first begins the map)"
    figures = {
        "method": given.matcher,
        "score": score,
        "matched": placed,
        "scans": len(log),
    }
    report.line("matched", f"by {given.matcher}, score {score}: {words}", **figures)
    found = np.array([step.found for step in steps], bool)
    poses = np.reshape([step.pose for step in steps], (-1, 3))
    causes = log.causes
    if not found.all():
        scan = int(np.argmin(found))
        words = f"lost at scan {scan}, and what follows hangs on it"
        causes = (*causes, Finding(Cause.LOST, scan, words))
    took = sum(step.seconds for step in steps)
    return map, Alignment(poses, found, took, "map_scans", causes=causes), log


def _write_tree(path: Path, map: quadtree.QuadtreeMap, world: exports.Frame) -> None:
    if path.suffix == ".png":
        from ._pictures import write_quadtree_picture

        write_quadtree_picture(path, map)
    elif path.suffix == ".npz":
        map.save(path)
    elif path.suffix == ".geojson":
        exports.write_geojson(path, map, world=world)
    else:
        write = files.write_ros_map if path.suffix == ".yaml" else exports.write_svg
        write(path, map)
