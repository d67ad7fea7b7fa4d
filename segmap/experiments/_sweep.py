"""Many methods, thresholds and maps, one after the other or side by side."""

import hashlib
import inspect
from collections.abc import Callable, Generator, Iterable, Mapping
from concurrent.futures import Executor, as_completed
from contextlib import closing
from itertools import product
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Segments
from ..metrics import quality, reduction_rate
from ..reduction import METHODS, Method, Reduction
from ..segments import SegmentMap
from ._journal import Journal
from ._progress import Progress, shown
from ._records import Record, Records, Threshold, filter_words, number_words

Function = Callable[..., Reduction]
Thresholds = dict[str, Threshold]
Grid = Mapping[str, Any] | Iterable[Mapping[str, Threshold]]

#: Two walls and a piece of one, in two scans: enough to load what a method has compiled.
TINY = SegmentMap(np.array([(0, 0, 2, 0), (1, 0, 3, 0), (0, 0, 0, 2)]).reshape(3, 2, 2), [0, 1, 1])
#: What this process has already loaded.
_WARM: set[tuple[object, ...]] = set()


class Job(NamedTuple):
    """One run to come; `segments` are those that are left after the filter."""

    map: str
    digest: str
    filtered: float | None
    segments: SegmentMap
    method: str
    function: Function
    thresholds: Thresholds
    repeat: int = 1


def sweep(
    maps: Mapping[str, Segments],
    methods: Iterable[str] | Mapping[str, Function] = METHODS,
    grids: Mapping[str, Grid] | None = None,
    *,
    filters: Iterable[float | None] = (None,),
    executor: Executor | None = None,
    records: str | Path | None = None,
    progress: Progress | bool = False,
    repeat: int = 1,
) -> Records:
    """Run methods on maps with all thresholds of their grids.

    Seconds are the method's own, after a first call in each process that loads what is compiled;
    only runs that have a core to themselves can be compared.

    Parameters
    ----------
    maps : mapping
        Name of a building -> SegmentMap, Reduction or (n, 2, 2) array, metres.
    methods : names in `reduction.METHODS`, or mapping of a name -> method
        A method of your own is `method(map, *, thresholds) -> Reduction`.
    grids : mapping
        Name of a method -> list of thresholds (dictionaries), or dictionary of lists: all
        combinations, the last name running fastest. A method without a grid runs once. Defaults
        of thresholds that a grid leaves out are filled in.
    filters : least lengths, metres, or None
        A map runs once for each, without its shorter segments; None: as it is. Reduction and
        quality are measured against what the filter has left (A 6.2.1).
    executor : concurrent.futures.Executor or None
        Of processes, or of a Dask client (`client.get_executor()`). None: here, one by one.
    records : path or None
        A CSV file to which each record is added as soon as it is there. Called again, the sweep
        takes from it what it finds. Delete the file when a method has changed.
    progress : bool or `progress(done, total, record or None)`
        True shows a bar in a notebook or a terminal, and nothing elsewhere.
    repeat : int
        Seconds are the median of so many runs, all else is that of the last one.

    Returns
    -------
    Records
        By map, filter, method and thresholds, in the order of the request.

    Raises
    ------
    ValueError
        For unknown methods or thresholds, a file that holds records of another map of that name;
        from a run, with its map, method and thresholds.
    RuntimeError
        For any other error of a run, alike. Runs that are finished are in the file.

    Examples
    --------
    >>> walls = np.array([[(0, 0), (2, 0)], [(1, 0.03), (3, 0.03)], [(5, 0), (5, 0.05)]])
    >>> grids = {"fusion": {"tolerance": [0.01, 0.04]}}
    >>> found = sweep({"corner": walls}, ["fusion"], grids, filters=(None, 0.10))
    >>> found.table("filtered", "thresholds", "n_before", "n_after")
    filtered  thresholds      n_before  n_after
    no        tolerance 0.01  3         3
    no        tolerance 0.04  3         2
    0.10 m    tolerance 0.01  2         2
    0.10 m    tolerance 0.04  2         1
    """
    if repeat < 1:
        raise ValueError(f"repeat must be at least 1, got {repeat}")
    plan = _jobs(maps, _functions(methods), grids or {}, tuple(filters))
    jobs = [job._replace(repeat=repeat) for job in plan]
    done: dict[int, Record] = {}
    with Journal(records) as journal, shown(progress) as report:
        done |= journal.known({k: _key(job) for k, job in enumerate(jobs)})
        report(len(done), len(jobs), None)

        def keep(index: int, record: Record) -> None:
            """Remember a record, and write it down, once."""
            if index not in done:
                done[index] = record
                journal.add(record)

        with closing(_finished(jobs, done, executor, keep)) as finished:
            for index, record in finished:
                keep(index, record)
                report(len(done), len(jobs), record)
    return Records(done[index] for index in range(len(jobs)))


def digest(map: SegmentMap) -> str:
    """Twelve hexadecimal digits that differ where segments, to the nanometre, or scans do.

    Segments `(n, 2, 2)`, metres; scans `(n,)`.

    Examples
    --------
    >>> wall = SegmentMap([[(0, 0), (1, 0)]])
    >>> digest(wall) == digest(SegmentMap(wall.segments + 1e-12)), digest(wall) == digest(TINY)
    (True, False)
    """
    grid = np.round(map.segments * 1e9).astype("<i8")
    found = hashlib.sha256(grid.tobytes() + map.scan.astype("<i8").tobytes())
    return found.hexdigest()[:12]


def run(job: Job) -> Record:
    """One run, in whatever process: what an executor is given."""
    try:
        _warm_up(job)
        runs = [job.function(job.segments, **job.thresholds) for _ in range(job.repeat)]
        found, seconds = runs[-1], median(each.seconds for each in runs)
        kept, rate = quality(job.segments, found), reduction_rate(job.segments, found)
    except Exception as error:
        kind = ValueError if isinstance(error, ValueError) else RuntimeError
        raise kind(f"{_words(job)}: {type(error).__name__}: {error}") from error
    counts = len(job.segments), len(found)
    what = (job.map, job.method, job.thresholds, job.filtered)
    return Record(*what, *counts, round(rate, 9), round(kept, 9), round(seconds, 6), job.digest)


def _warm_up(job: Job) -> None:
    kinds = (job.function, *(type(value) for value in job.thresholds.values()))
    if kinds not in _WARM:
        job.function(TINY, **job.thresholds)
        _WARM.add(kinds)


def _finished(
    jobs: list[Job],
    done: dict[int, Record],
    executor: Executor | None,
    keep: Callable[[int, Record], None],
) -> Generator[tuple[int, Record]]:
    """Records as they come; when the caller stops, what waits is cancelled, what is done kept."""
    todo = [index for index in range(len(jobs)) if index not in done]
    if executor is None:
        yield from ((index, run(jobs[index])) for index in todo)
        return
    futures = {executor.submit(run, jobs[index]): index for index in todo}
    try:
        for future in as_completed(futures):
            yield futures[future], future.result()
    finally:
        for future, index in futures.items():
            if not future.cancel() and future.done() and future.exception() is None:
                keep(index, future.result())


def _functions(methods: Iterable[str] | Mapping[str, Function]) -> dict[str, Function]:
    """Methods by name, as functions that say what thresholds they have."""
    if isinstance(methods, Mapping):
        return {k: m.function if isinstance(m, Method) else m for k, m in methods.items()}
    names = [methods] if isinstance(methods, str) else list(methods)
    for name in names:
        if name not in METHODS:
            raise ValueError(f"methods must be of {', '.join(METHODS)}, got {name!r}")
    return {name: METHODS[name].function for name in names}


def _jobs(
    maps: Mapping[str, Segments],
    functions: dict[str, Function],
    grids: Mapping[str, Grid],
    filters: tuple[float | None, ...],
) -> list[Job]:
    for name in grids:
        if name not in functions and name not in METHODS:
            raise ValueError(f"grids must be for {', '.join(functions)}, got {name!r}")
    runs = [
        (name, function, thresholds)
        for name, function in functions.items()
        for thresholds in _combinations(name, function, grids.get(name, [{}]))
    ]
    return [
        Job(name, digest(whole), least, part, *each)
        for name, whole in ((name, _as_map(name, map)) for name, map in maps.items())
        for least, part in ((least, _filtered(whole, least)) for least in filters)
        for each in runs
    ]


def _as_map(name: str, map: Segments) -> SegmentMap:
    if "\n" in name or "\r" in name:
        raise ValueError(f"maps must have names of one line, got {name!r}")
    return map if isinstance(map, SegmentMap) else SegmentMap(map)


def _filtered(map: SegmentMap, least: float | None) -> SegmentMap:
    if least is None:
        return map
    if not (least > 0 and np.isfinite(least)):
        raise ValueError(f"filters must be None or positive lengths, in metres, got {least}")
    return map.filtered(least)


def _combinations(name: str, function: Function, grid: Grid) -> list[Thresholds]:
    """Thresholds of each run, with the defaults that the grid leaves out."""
    if isinstance(grid, Mapping):
        lists = [np.atleast_1d(np.asarray(values, object)) for values in grid.values()]
        grid = [dict(zip(grid, values, strict=True)) for values in product(*lists)]
    defaults = default_thresholds(function)
    found = [{**(defaults or {}), **{k: _plain(v) for k, v in row.items()}} for row in grid]
    for row in found:
        if defaults is not None and (strange := set(row) - set(defaults)):
            known = ", ".join(defaults)
            raise ValueError(f"grids[{name!r}] must be of {known}, got {', '.join(strange)}")
    return [{k: v for k, v in row.items() if v is not None or defaults is None} for row in found]


def default_thresholds(function: Function) -> Thresholds | None:
    """Thresholds of a method and their defaults; None where it takes any."""
    parameters = inspect.signature(function).parameters.values()
    if any(p.kind is p.VAR_KEYWORD for p in parameters):
        return None
    return {p.name: None if p.default is p.empty else p.default for p in list(parameters)[1:]}


def _plain(value: Any) -> Threshold:
    """A number of Python's own, as a file keeps it."""
    plain = value.item() if isinstance(value, np.generic) else value
    if plain is None or isinstance(plain, int | float):
        return plain
    raise ValueError(f"grids must hold numbers or None, got {value!r}")


def _key(job: Job) -> Record:
    """What identifies a run: its record, without what it found."""
    return Record(job.map, job.method, job.thresholds, job.filtered, 0, 0, 0, 0, 0, job.digest)


def _words(job: Job) -> str:
    named = (f"{name}={number_words(value)}" for name, value in job.thresholds.items())
    return f"{job.method}({job.map}, {', '.join(named)}), filter {filter_words(job.filtered)}"
