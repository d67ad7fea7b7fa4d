"""`segmap locate MAP LOG...`: where on a known map the scans of a log were taken."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from .. import _warm, quadtree, readers
from ..matching import localize
from ..progress import each
from ..scans import Log
from ..segments import SegmentMap
from ._words import Report, metres, percent
from .opening import NO_MAP, add_logs, each_log, examples


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "locate",
        help="where on a known map a robot is: found, kept while it drives, or lost",
        epilog=examples(
            "locate room.yaml room                        a map for ROS",
            "locate room.npz later.log                    of `segmap occupancy` or `segmap map`",
        ),
    )
    command.add_argument(
        "map", type=Path, metavar="MAP", help="of `segmap occupancy` or `segmap map`: .npz, .csv"
    )
    add_logs(command)
    command.set_defaults(run=partial(each_log, work=locate_log, check=check))


def check(given: argparse.Namespace) -> None:
    """Read the map."""
    given.known = read_map(given.map)


def read_map(path: Path) -> quadtree.QuadtreeMap | SegmentMap:
    """A map of squares, or one of segments."""
    if path.suffix.lower() == ".npz":
        try:
            return quadtree.QuadtreeMap.load(path)
        except ValueError:
            pass
    return readers.read_segments(path)


def locate_log(given: argparse.Namespace, log: Log, paths: list[Path], report: Report) -> int:
    """Say where the last scan is, since when the robot is found, and how often it was lost."""
    _warm.dispatch(["quadtree all", "matching all"])
    scans = each(log, "placing scan")
    beliefs = list(localize(given.known, scans, rng=np.random.default_rng(0)))
    found = np.array([belief.found for belief in beliefs], bool)
    times = f"{int(found.sum())} of {len(log)} scans"
    first = f", the first is scan {int(found.argmax())}" if found.any() else ""
    lost = sum("lost" in belief.reason for belief in beliefs)
    report.line("found", f"{times}{first}; lost at {lost}", found=int(found.sum()), lost=lost,
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
