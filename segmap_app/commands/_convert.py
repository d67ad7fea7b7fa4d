"""`segmap convert LOG -o FILE`: a log, its path or its pose graph, for other programs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from segmap import exports
from segmap.alignment import METHODS, Alignment
from segmap.display import plural
from segmap.scans import Log

from ..pipeline import Pipeline
from . import log_options
from ._output import Report, Usage

#: What is written.
OUTPUT = log_options.output(
    "the log for CARMEN or as arrays (.npz), its path (.tum), its graph (.g2o)",
    *(".log", ".log.gz", ".npz", ".tum", ".g2o"),
)


#: Which poses are written.
ALIGN = log_options.method(METHODS, "written instead of the true poses that the log has")


@dataclass(frozen=True, kw_only=True)
class ConvertOptions(log_options.PosedOptions):
    """The options of `segmap convert`."""

    align: Annotated[str | None, ALIGN] = None
    laser: log_options.Unasked[log_options.Laser] = log_options.AS_IT_IS
    output: Annotated[tuple[str, ...], OUTPUT] = ()

    def check(self) -> None:
        """Refuse files that nothing would be written to."""
        if not self.output:
            raise Usage("name the file to write: -o FILE")
        wants_graph = any(name.endswith(".g2o") for name in self.output)
        if wants_graph and not (self.align or "").startswith("pose_graph"):
            raise Usage("a .g2o holds a pose graph: add --align pose_graph")


@log_options.command(
    "convert",
    "convert room -o room.log                     for CARMEN",
    "convert room -o room.npz                     as arrays",
    "convert room --align pose_graph -o room.tum -o room.g2o",
)
def convert(*logs: log_options.Logs, given: ConvertOptions = ConvertOptions()) -> int:
    """Write a log, its path or its pose graph, for other programs."""
    return log_options.each_log(logs, given, convert_log)


def convert_log(given: ConvertOptions, log: Log, paths: list[Path], report: Report) -> int:
    """Write one log to all its files; where its poses were sought, only if they make a map."""
    outcome = Pipeline(log_options.recipe_of(given, log), log) if given.align else None
    poses, written = None, paths
    if outcome is not None:
        poses = outcome.alignment_in_log_frame
        log_options.tell_alignment(poses, report)
        written = log_options.outputs(given.demand, outcome.verdict, paths, report)
    if written:
        texts = [_write_log(path, log, poses) for path in written]
        report.line("written", texts[0], files=[str(path) for path in written])
        for text in texts[1:]:
            report.line("", text)
    return 0 if outcome is None else log_options.conclude(given.demand, outcome.verdict, report)


def _write_log(path: Path, log: Log, poses: Alignment | None) -> str:
    if path.suffix == ".tum":
        kind, rows = ("odometry", log.odometry) if poses is None else (poses.method, poses.poses)
        if poses is None and log.truth is not None and np.isfinite(log.truth).all(1).any():
            kind, rows = "ground truth", log.truth
        if not np.isfinite(rows).all(1).any():
            raise ValueError("the log has no poses to write: --align pose_graph finds them")
        exports.write_tum(path, log, rows)
        return f"{path}: {plural(int(np.isfinite(rows).all(1).sum()), 'pose')} by {kind}"
    if path.suffix == ".g2o" and poses is not None:
        exports.write_graph(path, poses)
        assert poses.graph is not None  # it refuses an alignment without
        edges = poses.graph.edges
        words = f"{path}: {plural(len(log), 'pose')}, {plural(len(edges), 'edge')}"
        loose = len(log) - len(np.unique(edges))
        return f"{words}; {loose} without an edge: only key scans have some" if loose else words
    corrected = log.truth if poses is None else poses.poses
    if path.suffix == ".npz":
        exports.write_arrays(path, replace(log, truth=corrected))
    else:
        exports.write_carmen(path, log, poses)
    placed = 0 if corrected is None else int(np.isfinite(corrected).all(1).sum())
    return f"{path}: {plural(len(log), 'scan')}, {placed} with a corrected pose"
