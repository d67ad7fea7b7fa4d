"""`segmap occupancy LOG...`: a quadtree of what is free and what is occupied."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from segmap import exports, extraction, quadtree, warm
from segmap.arrays import declared
from segmap.display import plural
from segmap.scans import Log

from .. import files
from ..pipeline import cropped, world_of
from . import log_options
from ._output import Report

#: What is written.
OUTPUT = log_options.output(
    "the map: .yaml for ROS, with its .pgm; .npz to load it again",
    *(".yaml", ".png", ".svg", ".npz", ".geojson"),
)
#: The side of a cell.
SIDE = log_options.quantity(declared(quadtree.QuadtreeMap.__init__)["resolution"], "METRES")


@dataclass(frozen=True, kw_only=True)
class OccupancyOptions(log_options.PlacedOptions):
    """The options of `segmap occupancy`.

    Parameters
    ----------
    resolution
        Of a cell; default: 0.05.
    """

    resolution: Annotated[float, SIDE] = 0.05
    output: Annotated[tuple[str, ...], OUTPUT] = ()


@log_options.command(
    "occupancy",
    "occupancy room -o room.yaml             for ROS, with room.pgm",
    "occupancy room --resolution 0.02 -o room.npz -o room.png",
    "occupancy room --square -o room.svg     walls along x and y",
)
def occupancy(*logs: log_options.Logs, given: OccupancyOptions = OccupancyOptions()) -> int:
    """A quadtree of what is occupied and free, for ROS too."""
    return log_options.each_log(logs, given, draw_tree_of_log)


def draw_tree_of_log(given: OccupancyOptions, log: Log, paths: list[Path], report: Report) -> int:
    """Map one log, and write what was asked for where there is a map."""
    warm.dispatch(["quadtree all"])
    outcome = log_options.placed_outcome(given, log, report)
    alignment, log = outcome.alignment, outcome.log
    map = quadtree.build_map(log, alignment.trusted, resolution=given.resolution)
    verdict = alignment.verdict_on(extraction.build_map(log, alignment.trusted))
    if given.world.crop is not None:
        map = cropped(map, given.world.crop)
        count = int((map.leaves().occ > 0).sum())
        report.line("cropped", f"to {plural(count, 'square')}", squares=count)
    x_min, y_min, x_max, y_max = quadtree.extent(map, margin=0)
    width, height = x_max - x_min, y_max - y_min
    size = f"{width:.1f} m by {height:.1f} m at {given.resolution:g} m"
    leaves = map.leaves()
    full = map.leaf_occupancy() > 0.5
    area = float((leaves.side[full] ** 2).sum())
    words = f"{size}: {area:.2f} m2 occupied, {len(full)} leaves in {map.nbytes / 1024:.0f} KB"
    figures = {"width": width, "height": height, "occupied": area, "leaves": len(full)}
    report.line("mapped", words, **figures, resolution=given.resolution, bytes=map.nbytes)
    world = world_of(given.edits())
    return log_options.finish(
        given.demand, verdict, paths, report, lambda path: _write_tree(path, map, world)
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
