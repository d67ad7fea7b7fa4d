"""`segmap merge FIRST SECOND`: one map of two sessions, or why they cannot be merged."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from segmap import matching
from segmap.scans import Log

from ..call import Call
from ..pipeline import Pipeline
from . import log_options
from ._map import MakingOptions, map_recipe_of, write_map
from ._output import Report


@dataclass(frozen=True, kw_only=True)
class MergeOptions(MakingOptions):
    """The options of `segmap merge`, which aligns by itself."""

    align: log_options.Unasked[str | None] = None


@log_options.command(
    "merge",
    "merge room room -o both.svg         two drives that saw the same rooms",
    "merge room room -o both.segmap      as a session",
    "merge both.segmap room -o all.dxf   to which the next one comes",
)
def merge(first: str, /, *logs: log_options.Logs, given: MergeOptions = MergeOptions()) -> int:
    """One map of two sessions in one building, tied by what both have seen.

    Parameters
    ----------
    first
        A log or session, in whose frame the map is; LOG comes to it.
    """
    log_options.refuse_maps([first])
    return log_options.each_log(logs, given, partial(merge_logs, first))


def merge_logs(
    first_name: str, given: MergeOptions, log: Log, paths: list[Path], report: Report
) -> int:
    """Merge one log with the first, and write what was asked for where both are of one building."""
    if Path(first_name).resolve() in [path.resolve() for path in paths]:
        raise ValueError(f"cannot write {first_name}: it is the first log itself")
    first, options, _ = log_options.log_of([first_name], given)
    options.check()
    logs = []
    for each in (first, log):
        outcome = Pipeline(map_recipe_of(options, each), each)
        log_options.tell_deskewing(outcome, report)
        logs.append(outcome.log)
    alignment = matching.merge(*logs)
    alignment = replace(alignment, causes=(*alignment.causes, *logs[0].causes, *logs[1].causes))
    if not (alignment.used[: len(first)].any() and alignment.used[len(first) :].any()):
        log_options.tell_alignment(alignment, report)
        return log_options.conclude(options.demand, alignment.verdict, report)
    scans = [scan for each in logs for scan in each]
    scans = [replace(s, odometry=pose) for s, pose in zip(scans, alignment.poses, strict=True)]
    assumed = (*first.assumed, *log.assumed)
    both = Log(f"{first.name} and {log.name}", scans, alignment.trusted, assumed=assumed)
    # As one log that is aligned: the next may be merged with it.
    options = replace(options, align="ground_truth")
    own_recipe = replace(map_recipe_of(options, both), prepare=None)
    recipe = replace(own_recipe, align=Call("merge", lambda _: alignment))
    outcome = log_options.tell_poses(Pipeline(recipe, both), report)
    return write_map(options, outcome, own_recipe, paths, report)
