"""`segmap locate MAP LOG...`: where on a known map the scans of a log were taken."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from segmap import alignment, quadtree, readers, warm
from segmap.files import escape
from segmap.matching import Uncertainty, localize
from segmap.progress import each
from segmap.scans import Log
from segmap.segments import SegmentMap

from .. import files
from ._output import NO_MAP, Report, Usage, metres, percent
from .log_options import LogOptions, Logs, command, each_log

#: Pictures that the YAML of a map for ROS names.
PICTURES = (".pgm", ".png", ".bmp")
#: A robot that was found, or has no place, is lost; else it is not found yet.
LOST_KINDS = (Uncertainty.LOST, Uncertainty.NO_PLACE)


@command(
    "locate",
    "occupancy room -o room.yaml   a map for ROS",
    "locate room.yaml room",
    "locate room.yaml room --json",
    "map room -o room.csv          or a map of segments",
    "locate room.csv room",
)
def locate(map: Path, /, *logs: Logs, given: LogOptions = LogOptions()) -> int:
    """Where on a known map a robot is: found, or lost, by how well lines of its scans fit.

    Parameters
    ----------
    map
        Of `segmap occupancy` or `segmap map`, .npz or .csv; or for ROS, .yaml.
    """
    known = map_of(map)

    def locate_log(given: LogOptions, log: Log, paths: list[Path], report: Report) -> int:
        """On this map."""
        if isinstance(known, quadtree.QuadtreeMap) and files.is_ros_map(map):
            report.line("map", states(known))
        return locate_on(known, log, report)

    return each_log(logs, given, locate_log)


def map_of(path: Path) -> quadtree.QuadtreeMap | SegmentMap:
    """The map that is named, or an error of usage."""
    name = escape(path)
    if path.suffix.lower() in PICTURES:
        raise Usage(f"{name} is a picture: name the .yaml that belongs to it")
    try:
        return read_map(path)
    except ValueError as error:
        makes = "`segmap occupancy LOG -o map.npz` makes one, then `segmap locate map.npz LOG`"
        raise Usage(f"{name} is no map, {makes}: {error}") from error


def read_map(path: Path) -> quadtree.QuadtreeMap | SegmentMap:
    """A map of squares, ours or for ROS, or one of segments."""
    if files.is_ros_map(path):
        return files.read_ros_map(path)
    if path.suffix.lower() == ".npz":
        try:
            return quadtree.QuadtreeMap.load(path)
        except ValueError:
            pass
    return readers.read_segments(path)


def states(map: quadtree.QuadtreeMap) -> str:
    """What a map for ROS tells: three states, and no counts."""
    value, side = map.leaf_occupancy(), map.leaves().side
    free, occupied = (float((side[kind] ** 2).sum()) for kind in (value < 0.5, value > 0.5))
    return (
        f"{free:.1f} m2 free, {occupied:.1f} m2 occupied, the rest unknown: how often each cell "
        "was seen is not in a map for ROS"
    )


def locate_on(known: quadtree.QuadtreeMap | SegmentMap, log: Log, report: Report) -> int:
    """Say where the last scan is, since when the robot is found, and how often it was lost."""
    warm.dispatch(["quadtree all", "matching all"])
    log = alignment.prepared(log)
    if log.doubt:
        report.line("prepared", log.doubt)
    scans = each(log, "placing scan")
    beliefs = list(localize(known, scans, rng=np.random.default_rng(0)))
    is_found = np.array([belief.found for belief in beliefs], bool)
    times = f"{int(is_found.sum())} of {len(log)} scans"
    first = f", the first is scan {int(is_found.argmax())}" if is_found.any() else ""
    lost = sum(belief.uncertainty in LOST_KINDS for belief in beliefs)
    report.line("found", f"{times}{first}; lost at {lost}", found=int(is_found.sum()), lost=lost,
                scans=len(log))  # fmt: skip
    if not beliefs:
        return NO_MAP
    last = beliefs[-1]
    x, y, heading = last.pose.tolist()
    off = float(np.sqrt(np.diag(last.covariance)[:2].sum()))
    words = f"{x:.2f} m, {y:.2f} m, {np.degrees(heading):.1f} degrees, within {metres(off)}"
    report.line("place", words if np.isfinite(x) else "unknown", x=x, y=y, heading=heading, off=off)
    sure = f"{percent(last.share)} of the particles are there, scans fit to {last.fit:.2f}"
    verdict = f"{last.reason or 'found'}: {sure}"
    report.assumptions()
    report.line("verdict", verdict, share=last.share, fit=float(last.fit), reason=last.reason)
    return 0 if last.found else NO_MAP
