"""Records that come with segmap: those of the thesis, and those of its grid on our buildings."""

import csv
from collections.abc import Iterable, Iterator
from math import radians
from pathlib import Path

from ..readers import data_file
from ..reduction import METHODS
from ._records import Record, Records, Threshold, holds_records
from ._sweep import Grid, default_thresholds

#: A 6.2.1: shorter segments are dropped, or not, before all runs; metres.
THESIS_FILTERS = (None, 0.10)
_PAIRS: Grid = {
    "angle": [radians(10), radians(20)],
    "distance": [0.10, 0.20, 0.30, 0.40],
}
#: The thresholds of appendix A: 33 runs, 66 with and without the filter, on each building.
THESIS_GRIDS: dict[str, Grid] = {
    "basic_offline": _PAIRS,
    "basic_online": _PAIRS,
    "hybrid": _PAIRS,
    "mean_shift": {"sigma": [0.10, 0.20, 0.30, 0.40]},
    "fusion": {"tolerance": [0.02, 0.04, 0.06, 0.08, 0.10]},
}
#: The one threshold of a method that A calls "spatial distance".
_ONE = {"mean_shift": "sigma", "fusion": "tolerance"}


def thesis_results() -> Records:
    """The 264 runs of A's appendix: Polimi, Stanford, Bicocca and USC, in metres and radians.

    Returns
    -------
    Records
        Seconds are those of MATLAB on a computer of 2008, to whole seconds.

    Examples
    --------
    >>> thesis_results().select(map="usc", method="fusion", tolerance=0.02, filtered=False)
    map  method  thresholds      filtered  n_before  n_after  reduction  quality  seconds
    usc  fusion  tolerance 0.02  no        3604      784      78.2%      92.6%    246
    """
    with data_file("thesis_results.csv").open(encoding="utf-8", newline="") as lines:
        return Records(_thesis_record(row) for row in csv.DictReader(lines))


def load_records(*names: str) -> Records:
    """Records of the thesis' grid on buildings that it never saw, as `make bench` wrote them.

    Parameters
    ----------
    *names : str
        Of buildings; none: of all that there are.

    Returns
    -------
    Records

    Raises
    ------
    ValueError
        Where there are none of that name; it lists those that there are.
    """
    place = data_file("records")
    chosen = names or sorted(path.stem for path in place.glob("*.csv") if holds_records(path))
    return Records(record for name in chosen for record in Records.read(known(place, name)))


def thesis_grid(records: Iterable[Record]) -> Records:
    """Those runs whose thresholds and filter appendix A has too: 66 on each building.

    A threshold that A does not name must have its default.

    Examples
    --------
    >>> len(thesis_grid(thesis_results()))
    264
    """
    wanted = {_run(record) for record in thesis_results()}
    return Records(record for record in records if _run(record) in wanted)


def _run(record: Record) -> tuple[object, ...]:
    """What identifies a run; a threshold that A keeps as it is does not."""
    method = METHODS.get(record.method)
    defaults = (default_thresholds(method.function) or {}) if method else {}
    named = THESIS_GRIDS.get(record.method, ())
    thresholds = sorted(
        (name, round(value or 0, 9))
        for name, value in record.thresholds.items()
        if name in named or value != defaults.get(name)
    )
    return record.method, record.filtered, *thresholds


def _thesis_record(row: dict[str, str]) -> Record:
    before, after = int(row["n_before"]), int(row["n_after"])
    return Record(
        row["dataset"],
        row["method"],
        dict(_thesis_thresholds(row)),
        0.10 if row["filtered"] == "1" else None,
        before,
        after,
        round((before - after) / before, 9),
        float(row["quality_pct"]) / 100,
        float(row["time_s"]),
    )


def _thesis_thresholds(row: dict[str, str]) -> Iterator[tuple[str, Threshold]]:
    """From degrees and millimetres."""
    if row["angle_deg"]:
        yield "angle", radians(float(row["angle_deg"]))
    yield _ONE.get(row["method"], "distance"), float(row["distance_mm"]) / 1000


def known(place: Path, name: str) -> Path:
    """The file of that name in a folder of CSV files."""
    paths = {path.stem: path for path in place.glob("*.csv")}
    if name not in paths:
        raise ValueError(f"name must be of {', '.join(sorted(paths))}, got {name!r}")
    return paths[name]
