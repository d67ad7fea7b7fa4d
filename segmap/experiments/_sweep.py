"""Many methods, thresholds and maps, one after the other or side by side."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor, as_completed
from functools import partial
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

from .. import arrays
from ..arrays import Segments
from ..metrics import invented, missed, quality, reduction_rate
from ..reduction import METHODS
from ._files import Row, add_row, as_frame, resumed
from ._plan import Function, Grid, Job, planned
from ._records import number_text

if TYPE_CHECKING:
    import pandas as pd


def sweep(
    maps: Mapping[str, Segments],
    methods: Iterable[str] | Mapping[str, Function] | None = None,
    grids: Mapping[str, Grid] | None = None,
    *,
    filters: Iterable[float | None] = (None,),
    executor: Executor | None = None,
    records: str | Path | None = None,
    progress: bool | Callable[..., Any] = False,
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
    records
        A CSV file to which each run is added as soon as it is finished. Called again, the sweep
        takes from it what it finds. Delete the file when a method has changed.
    progress
        True shows a bar in a notebook or a terminal, and nothing elsewhere; or a bar like
        `tqdm.tqdm`.
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
        - digest: of the map before the filter;
        - invented, missed: metres that quality does not see (`metrics.invented`, `metrics.missed`).

    Raises
    ------
    ValueError
        For a file that holds runs on another map of that name; from a run, with its map, method
        and thresholds.
    RuntimeError
        For any other error of a run, alike. Runs that are finished are in the file.

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
    records = None if records is None else arrays.file(records, "records")
    jobs = planned(maps, chosen, grids, filters, arrays.whole(repeat, "repeat"))
    done = {} if records is None else _stored(jobs, resumed(records), records)
    with _bar_class(progress)(total=len(jobs), initial=len(done)) as bar:

        def keep(index: int, row: Row) -> None:
            """Remember a run, write it down, and show that it is there."""
            done[index] = row
            if records is not None:
                add_row(records, row)
            bar.set_postfix_str(f"{row['method']} on {row['map']}", refresh=False)
            bar.update()

        todo = {index: job for index, job in enumerate(jobs) if index not in done}
        if executor is None:
            for index, job in todo.items():
                keep(index, run_job(job))
        else:
            _run_elsewhere(todo, executor, keep)
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


def _stored(jobs: list[Job], rows: list[Row], path: Path) -> dict[int, Row]:
    """The runs that a file holds already, by their place in the request."""
    digests = {job.row["map"]: job.row["digest"] for job in jobs}
    for row in rows:
        if (now := digests.get(row["map"], row["digest"])) != row["digest"]:
            raise ValueError(
                f"{path} holds records of another map called {row['map']!r} (digest "
                f"{row['digest']}, now {now}): choose another file or name"
            )
    here = {_key(row): row for row in rows}
    return {k: here[_key(job.row)] for k, job in enumerate(jobs) if _key(job.row) in here}


def _key(row: Row) -> tuple[object, ...]:
    return row["map"], row["method"], row["filtered"], frozenset(row["thresholds"].items())


def _run_elsewhere(
    todo: dict[int, Job], executor: Executor, keep: Callable[[int, Row], None]
) -> None:
    """Runs as they finish; on an error what waits is cancelled, and what is done is kept."""
    waiting = {executor.submit(run_job, job): index for index, job in todo.items()}
    try:
        for future in as_completed(list(waiting)):
            keep(waiting.pop(future), future.result())
    finally:
        for future, index in waiting.items():
            if not future.cancel() and future.done() and future.exception() is None:
                keep(index, future.result())


def _bar_class(progress: bool | Callable[..., Any]) -> Callable[..., Any]:
    """The class of the progress bar: tqdm's, which stays silent unless it can be seen."""
    if callable(progress):
        return progress
    arrays.switch(progress, "progress")
    from tqdm.auto import tqdm

    notebook = "tqdm_notebook" in {base.__name__ for base in tqdm.__mro__}
    return partial(tqdm, disable=not (progress and (notebook or sys.stderr.isatty())))


def _job_text(row: Row) -> str:
    named = (f"{name}={number_text(value)}" for name, value in row["thresholds"].items())
    least = f"{row['filtered']:.2f} m" if row["filtered"] else "no"
    return f"{row['method']}({row['map']}, {', '.join(named)}), filter {least}"
