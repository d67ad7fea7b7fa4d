"""`segmap occupancy LOG...`: a quadtree of what is free and what is occupied."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import Any

from segmap import exports, extraction, quadtree, warm
from segmap.arrays import declared
from segmap.display import counted
from segmap.scans import Log

from .. import files
from ..pipeline import cropped, world_of
from . import log_options
from ._output import Report

#: What -o may end in.
SUFFIXES = (".yaml", ".png", ".svg", ".npz", ".geojson")


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "occupancy",
        help="a quadtree of what is occupied and free, for ROS too",
        epilog=log_options.examples(
            "occupancy room -o room.yaml                  for ROS: it writes room.pgm too",
            "occupancy room --resolution 0.02 -o room.npz -o room.png",
            "occupancy room --square -o room.svg          walls along x and y",
        ),
    )
    log_options.add_poses(command)
    side = log_options.quantity(declared(quadtree.QuadtreeMap.__init__)["resolution"])
    words = "of a cell; default: 0.05"
    command.add_argument("--resolution", type=side, default=0.05, metavar="METRES", help=words)
    log_options.add_world(command)
    log_options.add_output(
        command, SUFFIXES, "the map: .yaml for ROS, with its .pgm; .npz to load it again"
    )
    check = log_options.check_world
    command.set_defaults(run=partial(log_options.each_log, work=draw_tree_of_log, check=check))


def draw_tree_of_log(given: argparse.Namespace, log: Log, paths: list[Path], report: Report) -> int:
    """Map one log, and write what was asked for where there is a map."""
    warm.dispatch(["quadtree all"])
    outcome = log_options.placed_outcome(given, log, report)
    alignment, log = outcome.alignment, outcome.log
    map = quadtree.build_map(log, alignment.trusted, resolution=given.resolution)
    verdict = alignment.verdict_on(extraction.build_map(log, alignment.trusted))
    if given.crop is not None:
        map = cropped(map, given.crop)
        count = int((map.leaves().occ > 0).sum())
        report.line("cropped", f"to {counted(count, 'square')}", squares=count)
    x_min, y_min, x_max, y_max = quadtree.extent(map, margin=0)
    width, height = x_max - x_min, y_max - y_min
    size = f"{width:.1f} m by {height:.1f} m at {given.resolution:g} m"
    leaves = map.leaves()
    full = map.leaf_occupancy() > 0.5
    area = float((leaves.side[full] ** 2).sum())
    words = f"{size}: {area:.2f} m2 occupied, {len(full)} leaves in {map.nbytes / 1024:.0f} KB"
    figures = {"width": width, "height": height, "occupied": area, "leaves": len(full)}
    report.line("mapped", words, **figures, resolution=given.resolution, bytes=map.nbytes)
    world = world_of(log_options.edits_of(given))
    return log_options.finished(
        given, verdict, paths, report, lambda path: _write_tree(path, map, world)
    )


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
