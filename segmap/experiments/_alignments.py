"""Errors of the alignment methods on real logs: those of our records, and published ones."""

import csv
from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import NamedTuple

from .._display import Table
from ..readers import data_file


@dataclass(frozen=True)
class AlignmentRun:
    """One method on one log: how far its poses are from what is known to be true.

    Parameters
    ----------
    log, method : str
    scans, used : int
        Of the log; with a match of their own.
    compared : int
        Relations, or poses, that the errors are taken from.
    mean, deviation, rms, p95, largest : float, metres
        Of the errors of place.
    above : float
        Share of the errors above 0.2 m.
    heading : float, radians
        Mean error of heading.
    seconds : float
    """

    log: str
    method: str
    scans: int
    used: int
    compared: int
    mean: float
    deviation: float
    rms: float
    p95: float
    largest: float
    above: float
    heading: float
    seconds: float


#: Columns of the file, and what they hold.
HEAD = tuple("above_0.2" if f.name == "above" else f.name for f in fields(AlignmentRun))
KINDS = (str, str, int, int, int, *[float] * 8)


class Published(NamedTuple):
    """Errors of others, metres; None where they do not say how large the largest is."""

    method: str
    mean: float
    deviation: float
    largest: float | None


#: Kuemmerle et al. (2009), "On measuring the accuracy of SLAM algorithms": log -> their results.
PUBLISHED = {
    "intel": (
        Published("scan matching", 0.220, 0.296, 1.168),
        Published("particle filter", 0.070, 0.083, None),
        Published("graph mapping", 0.031, 0.026, None),
    ),
    "fr079": (
        Published("scan matching", 0.258, 0.427, 2.280),
        Published("particle filter", 0.061, 0.044, None),
        Published("graph mapping", 0.056, 0.042, None),
    ),
}


def load_alignments(log: str = "") -> list[AlignmentRun]:
    """Errors of all methods on Malaga, Intel and FR079, as `make bench` wrote them.

    Errors in metres: Intel and FR079 against verified relations (`metrics.relation_errors`), FR079
    with simulated drift; Malaga against its 99 corrected poses after the best rigid motion.

    Parameters
    ----------
    log : str
        Only logs whose name begins like this.

    Returns
    -------
    list of AlignmentRun

    Examples
    --------
    >>> runs = {run.method: run for run in load_alignments("intel")}
    >>> runs["pose_graph"].mean < 0.1 < 3 < runs["odometry"].mean
    True
    """
    runs = read_alignments(data_file("records/alignment.csv"))
    return [run for run in runs if run.log.startswith(log)]


def read_alignments(path: Path) -> list[AlignmentRun]:
    """Read such a file.

    Raises
    ------
    ValueError
        Naming the file, the line and what was expected there.
    """
    with path.open(encoding="utf-8", newline="") as lines:
        rows = csv.reader(lines)
        if (head := tuple(next(rows, ()))) != HEAD:
            raise ValueError(f"{path.name}, line 1: expected the head {','.join(HEAD)}, got {head}")
        return [_run(row, f"{path.name}, line {rows.line_num}") for row in rows]


def _run(row: list[str], where: str) -> AlignmentRun:
    try:
        cells = [kind(cell) for kind, cell in zip(KINDS, row, strict=True)]
    except ValueError as error:
        raise ValueError(f"{where}: expected an alignment, got {row}") from error
    return AlignmentRun(*cells)


def alignment_table(runs: Iterable[AlignmentRun | Published]) -> Table:
    """Runs, and published results beside them, as a table without times.

    Examples
    --------
    >>> alignment_table(PUBLISHED["fr079"][:2])
    method           mean [m]  sd [m]  largest [m]  used
    scan matching    0.258     0.427   2.28         published
    particle filter  0.061     0.044   -            published
    """
    head = ["method", "mean [m]", "sd [m]", "largest [m]", "used"]
    return Table(head, (_cells(run) for run in runs))


def _cells(run: AlignmentRun | Published) -> list[str]:
    largest = "-" if run.largest is None else f"{run.largest:.2f}"
    used = f"{run.used} of {run.scans}" if isinstance(run, AlignmentRun) else "published"
    return [run.method, f"{run.mean:.3f}", f"{run.deviation:.3f}", largest, used]
