"""Many methods, thresholds and maps, one after the other or side by side."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor, as_completed
from statistics import median
from typing import TYPE_CHECKING

from .. import arrays
from ..arrays import Segments
from ..metrics import invented, missed, quality, reduction_rate
from ..progress import announce
from ..reduction import METHODS
from ._files import Row, as_frame
from ._plan import Function, Grid, Job, runs_of
from ._records import number_text

if TYPE_CHECKING:
    import pandas as pd

#: A run is repeated so often at most, for its time.
MOST_REPEATS = 1000


def sweep(
    maps: Mapping[str, Segments],
    methods: Iterable[str] | Mapping[str, Function] | None = None,
    grids: Mapping[str, Grid] | None = None,
    *,
    filters: Iterable[float | None] = (None,),
    executor: Executor | None = None,
    repeat: int = 1,
) -> pd.DataFrame:
    """Run methods on maps with all thresholds of their grids.

    Parameters
    ----------
    maps
        Name of a building -> segments.
    methods
        Names in `reduction.METHODS`, or a mapping of a name -> method of your own,
        `method(map, *, thresholds) -> Reduction`. None: all of METHODS. One that needs the places
        of the sensor is left out on maps that have none, unless it is asked for by its name.
    grids
        Name of a method -> list of thresholds (dictionaries), or dictionary of lists: all
        combinations, the last name running fastest. A method without a grid runs once. Defaults
        of thresholds that a grid leaves out are filled in.
    filters
        A map runs once for each, without its shorter segments; None: as it is.
    executor
        Of processes, or of a Dask client (`client.get_executor()`). None: here, one by one.
    repeat
        Seconds are the median of so many runs, all else is that of the last one.

    Returns
    -------
    DataFrame
        One row a run, by map, filter, method and thresholds, in the order of the request:

        - map, method, and a column for each threshold, NaN where a method does not have it;
        - filtered: the filter, metres, 0 for None;
        - n_before, n_after: segments after the filter, and after the method;
        - reduction, quality: in [0, 1], against what the filter has left (A 6.2.1);
        - seconds: the method's own, after a first call in each process that loads what is compiled.
          Only runs that have a core to themselves can be compared;
        - invented, missed: metres that quality does not see (`metrics.invented`, `metrics.missed`).

    Raises
    ------
    ValueError
        From a run, with its map, method and thresholds.
    RuntimeError
        For any other error of a run, alike.

    Examples
    --------
    >>> walls = [[(0, 0), (2, 0)], [(1, 0.03), (3, 0.03)], [(5, 0), (5, 0.05)]]
    >>> grids = {"fusion": {"tolerance": [0.01, 0.04]}}
    >>> runs = sweep({"corner": walls}, ["fusion"], grids, filters=(None, 0.10))
    >>> runs[["filtered", "tolerance", "n_before", "n_after"]]
       filtered  tolerance  n_before  n_after
    0       0.0       0.01         3        3
    1       0.0       0.04         3        2
    2       0.1       0.01         2        2
    3       0.1       0.04         2        1
    """
    chosen = METHODS if methods is None else methods
    arrays.instance(maps, "maps", Mapping)
    grids = arrays.instance({} if grids is None else grids, "grids", Mapping)
    if executor is not None:
        arrays.instance(executor, "executor", Executor)
    jobs = runs_of(maps, chosen, grids, filters, arrays.whole(repeat, "repeat", most=MOST_REPEATS))
    done: dict[int, Row] = {}

    def keep(index: int, row: Row) -> None:
        """Remember a run, and say that it is there."""
        done[index] = row
        announce(len(done) / len(jobs), f"sweep: {row['method']} on {row['map']}")

    if executor is None:
        for index, job in enumerate(jobs):
            keep(index, run_job(job))
    else:
        _run_elsewhere(jobs, executor, keep)
    return as_frame(done[index] for index in range(len(jobs)))


def run_job(job: Job) -> Row:
    """One run, in whatever process: what an executor is given."""
    thresholds, map = job.row["thresholds"], job.segments
    try:
        runs = [job.function(map, **thresholds) for _ in range(job.repeat)]
        reduction, seconds = runs[-1], median(each.seconds for each in runs)
        return job.row | {
            "n_before": len(map),
            "n_after": len(reduction),
            "reduction": round(reduction_rate(map, reduction), 9),
            "quality": round(quality(map, reduction), 9) if len(map) else math.nan,
            "seconds": round(seconds, 6),
            "invented": round(invented(map, reduction), 4),
            "missed": round(missed(map, reduction), 4),
        }
    except Exception as error:
        kinds = (kind for kind in (ValueError, TypeError) if isinstance(error, kind))
        kind = next(kinds, RuntimeError)
        raise kind(f"{_job_text(job.row)}: {type(error).__name__}: {error}") from error


def _run_elsewhere(jobs: list[Job], executor: Executor, keep: Callable[[int, Row], None]) -> None:
    """Runs as they finish; on an error what waits is cancelled."""
    waiting = {executor.submit(run_job, job): index for index, job in enumerate(jobs)}
    try:
        for future in as_completed(waiting):
            keep(waiting[future], future.result())
    finally:
        for future in waiting:
            future.cancel()


def _job_text(row: Row) -> str:
    named = (f"{name}={number_text(value)}" for name, value in row["thresholds"].items())
    least = f"{row['filtered']:.2f} m" if row["filtered"] else "no"
    return f"{row['method']}({row['map']}, {', '.join(named)}), filter {least}"
