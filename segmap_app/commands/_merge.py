"""`segmap merge FIRST SECOND`: one map of two sessions, or why they cannot be merged."""

from __future__ import annotations

import argparse
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from segmap.matching import merge
from segmap.scans import Log

from ..call import Call
from ..pipeline import Pipeline
from . import log_options
from ._map import add_making, map_recipe_of, write_map
from ._output import Report


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "merge",
        help="one map of two sessions in one building, tied by what both have seen",
        epilog=log_options.examples(
            "merge room room -o both.svg           two drives that saw the same rooms",
            "merge room room -o both.segmap        as a session",
            "merge both.segmap room -o all.dxf     to which the next one comes",
        ),
    )
    command.add_argument(
        "first",
        metavar="FIRST",
        help="a log or session, in whose frame the map is; LOG comes to it",
    )
    log_options.add_poses(command, align=False)
    add_making(command)
    check = log_options.check_world
    command.set_defaults(run=partial(log_options.each_log, work=merge_logs, check=check))


def merge_logs(given: argparse.Namespace, log: Log, paths: list[Path], report: Report) -> int:
    """Merge one log with the first, and write what was asked for where both are of one building."""
    if Path(given.first).resolve() in [path.resolve() for path in paths]:
        raise ValueError(f"cannot write {given.first}: it is the first log itself")
    first, options, _ = log_options.log_of([given.first], given)
    log_options.check_world(options)
    logs = []
    for each in (first, log):
        outcome = Pipeline(map_recipe_of(options, each), each)
        log_options.tell_deskewing(outcome, report)
        logs.append(outcome.log)
    alignment = merge(*logs)
    alignment = replace(alignment, causes=(*alignment.causes, *logs[0].causes, *logs[1].causes))
    if not (alignment.used[: len(first)].any() and alignment.used[len(first) :].any()):
        log_options.tell_alignment(alignment, report)
        return log_options.concluded(options, alignment.verdict, report)
    scans = [scan for each in logs for scan in each]
    scans = [replace(s, odometry=pose) for s, pose in zip(scans, alignment.poses, strict=True)]
    assumed = (*first.assumed, *log.assumed)
    both = Log(f"{first.name} and {log.name}", scans, alignment.trusted, assumed=assumed)
    options.align = "ground_truth"  # as one log that is aligned: the next may be merged with it
    own_recipe = replace(map_recipe_of(options, both), prepare=None)
    recipe = replace(own_recipe, align=Call("merge", lambda _: alignment))
    outcome = log_options.tell_poses(Pipeline(recipe, both), report)
    return write_map(options, outcome, own_recipe, paths, report)
