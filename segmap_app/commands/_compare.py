"""`segmap compare LOG`: all reduction methods on one map, at equal quality (A 6.2.3)."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np

from segmap import extraction, warm
from segmap.arrays import Declared, Quantity
from segmap.display import plural
from segmap.methods import bracket, halve
from segmap.reduction import METHODS
from segmap.scans import Log
from segmap.segments import SegmentMap

from . import log_options
from ._output import Report, percent, progress, seconds
from .log_options import thresholds

if TYPE_CHECKING:
    import pandas as pd

#: What is written.
OUTPUT = log_options.output("a picture of the curves, or all runs", ".png", ".csv")
#: What --quality may be.
PERCENT = Declared(float, Quantity("per cent", above=0, most=100), (), False)
#: The threshold that a method varies is doubled or halved so often at most, to reach a quality.
MOST_DOUBLINGS = 5
#: Runs that then lie between the two beside that quality.
RUNS_BETWEEN = 2
#: A method whose run takes so long, in seconds, gets no further one.
SLOW_RUN_S = 20.0
#: A longer map is thinned, scan by scan: some methods take time with the square of its segments.
MOST_COMPARED_SEGMENTS = 2000


class _TooSlow(Exception):
    """The last run of a method took so long that there is no further one."""


@dataclass(frozen=True, kw_only=True)
class CompareOptions(log_options.PosedOptions):
    """The options of `segmap compare`.

    Parameters
    ----------
    quality
        At which the methods are compared, per cent; default: 85.
    all
        Every scan; else as many as give 2000 segments.
    """

    quality: Annotated[float, log_options.quantity(PERCENT, "PERCENT")] = 85.0
    all: bool = False
    output: Annotated[tuple[str, ...], OUTPUT] = ()


@log_options.command(
    "compare",
    "compare room",
    "compare malaga --quality 90 -o curves.png -o runs.csv",
    "compare room --all --table methods.csv",
)
def compare(*logs: log_options.Logs, given: CompareOptions = CompareOptions()) -> int:
    """All reduction methods on the map of a log, at equal quality."""
    return log_options.each_log(logs, given, compare_methods)


def compare_methods(given: CompareOptions, log: Log, paths: list[Path], report: Report) -> int:
    """Run all methods on the map of one log, and print what each leaves."""
    warm.dispatch(f"reduction {name}" for name in METHODS)
    outcome = log_options.placed_outcome(given, log, report)
    map = whole = extraction.build_map(outcome.log, outcome.alignment.trusted, keep_points=True)
    verdict = outcome.alignment.verdict_on(map)
    if not len(map):
        raise ValueError("there is nothing to compare: the map holds no segment")
    if not given.all:
        map = decimate(map)
    part = ""
    if len(map) < len(whole):
        used, every = (len(np.unique(m.scan)) for m in (map, whole))
        part = f"; compared on {len(map)} of them, from {used} of {every} scans (--all takes all)"
    report.line("extracted", f"{plural(len(whole), 'segment')}{part}", segments=len(whole))
    quality = given.quality / 100
    runs = runs_of_all(log.name, map, quality)
    taken = float(runs["seconds"].sum())
    report.line("compared", f"{plural(len(runs), 'run')}, {seconds(taken)}", seconds=taken)
    print_table(runs, quality, report)

    def write(path: Path) -> None:
        """All runs, or their picture."""
        if path.suffix == ".csv":
            from segmap.experiments import write_records

            write_records(runs, path)
        else:
            from ._pictures import write_curves

            write_curves(path, runs, quality)

    return log_options.finish(given.demand, verdict, paths, report, write)


def runs_of_all(name: str, map: SegmentMap, quality: float) -> pd.DataFrame:
    """Runs of all methods on a map, more of them near a quality."""
    import pandas as pd

    runs = []
    with progress(len(METHODS), "method") as bar:
        for method in METHODS:
            bar.set_postfix_str(method)
            runs.append(runs_near({name: map}, method, quality))
            bar.update()
    return pd.concat(runs, ignore_index=True)


def runs_near(map: dict[str, SegmentMap], method: str, quality: float) -> pd.DataFrame:
    """Runs of a method from its default on: beyond the wanted quality, and then closer to it."""
    import pandas as pd

    from segmap.experiments import sweep

    varies = METHODS[method].varies
    runs: list[pd.DataFrame] = []

    def good(value: float) -> bool:
        """Run with a threshold, and tell whether its quality is that good."""
        if runs and runs[-1]["seconds"].item() > SLOW_RUN_S:
            raise _TooSlow
        runs.append(sweep(map, [method], {method: {varies: [value]}}))
        return bool(runs[-1]["quality"].item() >= quality)

    with suppress(_TooSlow):
        ends = bracket(
            good,
            thresholds(METHODS[method].function)[varies].default,
            MOST_DOUBLINGS,
            MOST_DOUBLINGS,
        )
        for _ in range(RUNS_BETWEEN if ends else 0):
            ends = halve(good, ends)
    return pd.concat(runs)


def decimate(map: SegmentMap) -> SegmentMap:
    """Every second scan, every third, ...: the first part of a map that is not too long."""
    every, part, step = np.unique(map.scan), map, 1
    while len(part) > MOST_COMPARED_SEGMENTS and step < len(every):
        step += 1
        part = map[np.isin(map.scan, every[::step])]
    return part


def print_table(runs: pd.DataFrame, quality: float, report: Report) -> None:
    """What each method leaves at one quality, the best first, and its run that comes nearest."""
    from segmap.experiments import equal_quality, select

    total, at = int(runs["n_before"].iloc[0]), equal_quality(runs, quality).iloc[0]
    methods = map(str, dict.fromkeys(runs["method"]))
    names = sorted(methods, key=lambda name: -np.nan_to_num(at[name], nan=-np.inf))
    report.say()
    report.say(f"  {f'at quality {percent(quality)}':<22} {'gone':>11} {'left':>6}  nearest run")
    for name in names:
        gone, own = float(at[name]), select(runs, method=name)
        near = own.iloc[int((own["quality"].fillna(0.0) - quality).abs().argmin())]
        remaining = "-" if np.isnan(gone) else f"{(1 - gone) * total:.0f}"
        share, varies = "not reached" if np.isnan(gone) else percent(gone), METHODS[name].varies
        words = f"quality {percent(near['quality'])}, {near['n_after']} left"
        run = f"{name}:{varies}={near[varies]:.3g}: {words}, {seconds(near['seconds'])}"
        report.say(f"  {name:<22} {share:>11} {remaining:>6}  {run}")
        figures = {"gone": None if np.isnan(gone) else gone, "nearest": run}
        report.found.setdefault("methods", {})[name] = figures
    report.say()
