"""A pose for each scan of a log, and the frame in which its map is written."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from segmap.alignment import METHODS, Alignment, usual_method
from segmap.display import plural
from segmap.scans import Log
from segmap.scans.causes import Cause
from segmap.scans.motion import is_timed

from ...pipeline import MapChoices, Pipeline
from .._output import Report, seconds
from ._methods import call_of
from ._options import LogOptions

#: Reasons for scans that were not matched, of which this many are printed.
MOST_REASONS = 3


def recipe_of(given: LogOptions, log: Log) -> MapChoices:
    """What the options say of the way to poses, by default a pose graph, and of edits on a map."""
    align = call_of(given.align or "pose_graph", METHODS)
    if align.name == "ground_truth" != usual_method(log):  # some scans have none
        align = replace(align, thresholds={"missing": "drop", **align.thresholds})
    return MapChoices(align, prepare=given.laser.options(), edits=given.edits())


def placed_outcome(given: LogOptions, log: Log, report: Report) -> Pipeline:
    """The log with its beams carried to the start of each scan, and a pose for each scan."""
    return tell_poses(Pipeline(recipe_of(given, log), log), report)


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
        words = f"{count} of {plural(len(outcome.log), 'scan')}, by how the robot moved meanwhile"
        report.line("de-skewed", words, scans=count)


def tell_alignment(found: Alignment, report: Report) -> None:
    """Say how many scans are placed, how many loops that took, and what speaks against it."""
    figures: dict[str, Any] = {"method": found.method, "matched": int(found.used.sum())}
    placed = f"{figures['matched']} of {plural(len(found), 'scan')} matched"
    if found.graph is not None:
        figures["loops"] = int(found.graph.loop.sum())
        placed += f", {plural(figures['loops'], 'loop')} closed"
    words = f"by {found.method}: {placed}, {seconds(found.seconds)}"
    figures["causes"] = [asdict(finding) for finding in found.causes]
    report.line("aligned", words, **figures, scans=len(found), seconds=found.seconds)
    reasons = Counter(filter(None, found.reasons)).most_common(MOST_REASONS)
    for why, count in reasons:
        report.line("", f"{plural(count, 'scan')} not: {why}")
    if found.doubt:
        report.line("", f"doubt: {found.doubt}")
