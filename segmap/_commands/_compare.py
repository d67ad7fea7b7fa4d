"""`segmap compare LOG`: all reduction methods on one map, at equal quality (A 6.2.3)."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import extraction
from ..reduction import METHODS
from ..scans import Log
from ..segments import SegmentMap
from ._logs import add_logs, each_log
from ._poses import add_align, aligned
from ._targets import Targets, add_output
from ._thresholds import thresholds
from ._words import counted, line, percent, seconds

if TYPE_CHECKING:
    import pandas as pd

#: What -o may end in.
SUFFIXES = (".png", ".csv")
#: The threshold that a method varies takes these parts of its default.
FACTORS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)
#: A longer map is thinned, scan by scan: some methods take time with the square of its segments.
MOST = 3000


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "compare", help="all reduction methods on the map of a log, at equal quality"
    )
    add_logs(command)
    add_align(command, "default: ground_truth where the log has it for each scan, else pose_graph")
    command.add_argument(
        "--quality",
        type=float,
        default=85.0,
        metavar="PERCENT",
        help="at which the methods are compared; default: 85",
    )
    command.add_argument(
        "--all", action="store_true", help=f"every scan; else as many as give {MOST} segments"
    )
    command.add_argument("--filter", type=float, metavar="METRES", help="leave shorter ones out")
    add_output(command, SUFFIXES, "a picture of the curves, or all runs")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> int:
    """Compare on each log."""
    if not 0 < given.quality <= 100:
        given.refuse(f"--quality must be above 0 and at most 100 per cent, got {given.quality:g}")
    return each_log(given, compare)


def compare(given: argparse.Namespace, log: Log, targets: Targets) -> None:
    """Run all methods on the map of one log, and print what each leaves."""
    from .. import experiments

    paths = targets.paths(log.name)
    print(f"{log.name}: {counted(len(log), 'scan')}, {targets.source}")
    map = whole = extraction.build_map(log, aligned(log, given.align), keep_points=True)
    if given.filter is not None:
        map = whole = whole.filtered(given.filter)
    if not len(map):
        raise ValueError("there is nothing to compare: the map holds no segment")
    if not given.all:
        map = thinned(map)
    line("extracted", f"{counted(len(whole), 'segment')}{_part(map, whole)}")
    runs = experiments.sweep({log.name: map}, METHODS, grids(), progress=True)
    line("compared", f"{counted(len(runs), 'run')}, {seconds(float(runs['seconds'].sum()))}")
    print_table(runs, given.quality / 100)
    for path in paths:
        _write(path, runs, given.quality / 100)
    if paths:
        line("written", ", ".join(str(path) for path in paths))


def grids() -> dict[str, dict[str, list[float]]]:
    """For each method some values of the threshold that it varies, around the default."""
    return {
        name: {
            method.varies: [
                factor * thresholds(method.function)[method.varies].default for factor in FACTORS
            ]
        }
        for name, method in METHODS.items()
    }


def thinned(map: SegmentMap) -> SegmentMap:
    """Every second scan, every third, ...: the first part of a map that is not too long."""
    for step in range(1, len(map) + 2):
        scans = np.unique(map.scan)[::step]
        part = map[np.isin(map.scan, scans)]
        if len(part) <= MOST or len(scans) == 1:
            return part
    raise AssertionError("one scan is left at last")


def _part(map: SegmentMap, whole: SegmentMap) -> str:
    if len(map) == len(whole):
        return ""
    kept, every = (len(np.unique(m.scan)) for m in (map, whole))
    return f"; compared on {len(map)} of them, from {kept} of {every} scans (--all takes all)"


def print_table(runs: pd.DataFrame, quality: float) -> None:
    """What each method leaves at one quality, the best first, and its run that comes nearest."""
    from ..experiments import equal_quality, select, thresholds_text

    total = int(runs["n_before"].iloc[0])
    at = equal_quality(runs, quality).iloc[0]
    rows = []
    for name in dict.fromkeys(runs["method"]):
        own, gone = select(runs, method=str(name)), float(at[str(name)])
        near = own.iloc[int((own["quality"].fillna(0.0) - quality).abs().argmin())]
        left = "-" if np.isnan(gone) else f"{(1 - gone) * total:.0f}"
        share = "never reached" if np.isnan(gone) else percent(gone)
        text = f"{thresholds_text(near)}: {percent(near['quality'])}, {near['n_after']} left, "
        rows.append((-gone, name, share, left, text + seconds(near["seconds"])))
    print(f"\n  {f'at quality {percent(quality)}':<22} {'gone':>13} {'left':>6}  nearest run")
    for _, name, share, left, text in sorted(rows, key=lambda row: (np.isnan(row[0]), row[0])):
        print(f"  {name:<22} {share:>13} {left:>6}  {text}")
    print(flush=True)


def _write(path: Path, runs: pd.DataFrame, quality: float) -> None:
    if path.suffix == ".csv":
        from ..experiments import write_records

        write_records(runs, path)
        return
    from ._pictures import write_curves

    write_curves(path, runs, quality)
