"""The runs of a sweep, from maps, methods and grids, checked before anything runs."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import product
from typing import Any, NamedTuple, TypeVar

import numpy as np

from .. import arrays
from ..arrays import Segments
from ..methods import Method
from ..reduction import METHODS, Reduction
from ..segments import SegmentMap
from ._files import NO_THRESHOLDS, Row, Threshold

Function = Callable[..., Reduction]
#: How good a map after its reduction is, of the map before and after: in [0, 1].
Measure = Callable[[Segments, Reduction], float]
Thresholds = dict[str, Threshold]
Items = tuple[tuple[str, Threshold], ...]
T = TypeVar("T")
Grid = Mapping[str, Any] | Iterable[Mapping[str, Threshold]]


class Job(NamedTuple):
    """One run to come: `row` says which, `segments` are what the filter has left.

    With `first`, thresholds of the same kinds, the method is called once before.
    """

    row: Row
    segments: SegmentMap
    function: Function
    first: Items
    repeat: int
    measure: Measure


def digest(map: SegmentMap) -> str:
    """Twelve hexadecimal digits that identify a map.

    They change with any of its segments, to the nanometre, and scans; where it keeps points and
    places of the sensor, with these too.

    Examples
    --------
    >>> wall = SegmentMap([[(0, 0), (1, 0)]])
    >>> [digest(SegmentMap(wall.segments + shift)) == digest(wall) for shift in (1e-12, 1e-6)]
    [True, False]
    """
    arrays.instance(map, "map", SegmentMap)
    grid = np.round(map.segments * 1e9).astype("<i8")
    found = hashlib.sha256(grid.tobytes() + map.scan.astype("<i8").tobytes())
    for behind in (map.points, map.first, map.sensors):
        if behind is not None:
            found.update(np.round(np.nan_to_num(behind) * 1e9).astype("<i8").tobytes())
    return found.hexdigest()[:12]


def default_thresholds(function: Function) -> Thresholds | None:
    """Thresholds of a method and their defaults; None where it takes any.

    Examples
    --------
    >>> default_thresholds(METHODS["fusion"].function)
    {'tolerance': 0.04}
    """
    arrays.function(function, "function", "of a map and thresholds")
    parameters = inspect.signature(function).parameters.values()
    if any(p.kind is p.VAR_KEYWORD for p in parameters):
        return None
    found = {p.name: p.default for p in list(parameters)[1:]}
    own = {name: float(value) for name, value in found.items() if isinstance(value, float)}
    return {name: None if v is inspect.Parameter.empty else v for name, v in (found | own).items()}


def planned(
    maps: Mapping[str, Segments],
    methods: Iterable[str] | Mapping[str, Function],
    grids: Mapping[str, Grid],
    filters: Iterable[float | None],
    repeat: int,
    measure: Measure,
) -> list[Job]:
    """All runs of a sweep in the order of the request; arguments and errors as of `sweep`."""
    least = [
        None if f is None else arrays.number(f, "filters", above=0, unit="metres, or None")
        for f in _walked_through(filters, "filters")
    ]
    functions = _functions(methods)
    for name in set(grids) - set(METHODS):
        arrays.one_of(name, "grids", functions)
    # A method that is asked for by its name alone runs wherever the map comes from.
    own = methods if isinstance(methods, Mapping) else {}
    needs = {k for k, m in own.items() if isinstance(m, Method) and m.needs_sensors}
    plans = {name: _combinations(name, f, grids.get(name, [{}])) for name, f in functions.items()}
    return [
        Job(
            {**known, "method": method, "thresholds": row},
            part,
            functions[method],
            first,
            repeat,
            measure,
        )
        for name, map in maps.items()
        for known, part in _filtered(name, map, least)
        for method, plan in plans.items()
        if method not in needs or part.sensors is not None
        for row, first in plan
    ]


def _functions(methods: Iterable[str] | Mapping[str, Function]) -> dict[str, Function]:
    """Methods by name, as functions that say what thresholds they have."""
    if isinstance(methods, Mapping):
        found = {k: m.function if isinstance(m, Method) else m for k, m in methods.items()}
        words = "of a map and thresholds"
        return {k: arrays.function(f, f"methods[{k!r}]", words) for k, f in found.items()}
    names = [methods] if isinstance(methods, str) else _walked_through(methods, "methods")
    return {arrays.one_of(name, "methods", METHODS): METHODS[name].function for name in names}


def _walked_through(values: Iterable[T], name: str) -> list[T]:
    """What can be walked through, as a list."""
    try:
        return list(values)
    except TypeError as error:
        raise ValueError(f"{name} must be a list, got {arrays.brief(values)}") from error


def _filtered(
    name: str, map: Segments, filters: list[float | None]
) -> Iterator[tuple[Row, SegmentMap]]:
    """A map after each filter, and what a row says of it."""
    arrays.instance(name, "maps: a name", str)
    if "\n" in name or "\r" in name:
        raise ValueError(f"maps must have names of one line, got {name!r}")
    arrays.segments(map, f"maps[{name!r}]")
    whole = map if isinstance(map, SegmentMap) else SegmentMap(map)
    mark = digest(whole)
    for least in filters:
        part = whole if least is None else whole.filtered(least)
        yield {"map": name, "filtered": least or 0.0, "digest": mark}, part


def _combinations(name: str, function: Function, grid: Grid) -> list[tuple[Thresholds, Items]]:
    """Thresholds of each run, and those of the first run with numbers of the same kinds.

    Defaults that the grid leaves out are filled in; one that is no number is left to the method.
    """
    if isinstance(grid, Mapping):
        lists = [np.atleast_1d(np.asarray(values, object)) for values in grid.values()]
        grid = [dict(zip(grid, values, strict=True)) for values in product(*lists)]
    defaults, words = default_thresholds(function), f"grids[{name!r}]"
    grid = [arrays.instance(row, words, Mapping) for row in _walked_through(grid, words)]
    numbers = {k: v for k, v in (defaults or {}).items() if v is None or isinstance(v, int | float)}
    kept = {name: _plain(value) for name, value in numbers.items()}
    found = [{**kept, **{k: _plain(v) for k, v in row.items()}} for row in grid]
    for row in found:
        if defaults is not None and (strange := set(row) - set(defaults)):
            known = ", ".join(defaults)
            raise ValueError(f"grids[{name!r}] must be of {known}, got {', '.join(strange)}")
        if taken := NO_THRESHOLDS & set(row):
            raise ValueError(f"{name} must not call a threshold {taken.pop()!r}: a column is")
    found = [{k: v for k, v in row.items() if v is not None or defaults is None} for row in found]
    kinds = [tuple(map(type, row.values())) for row in found]
    first: dict[tuple[type, ...], Items] = {}
    return [
        (row, first.setdefault(kind, tuple(row.items())))
        for row, kind in zip(found, kinds, strict=True)
    ]


def _plain(value: Any) -> Threshold:
    """A number of Python's own, as a file keeps it."""
    plain = value.item() if isinstance(value, np.generic) else value
    if plain is None or isinstance(plain, int | float):
        return plain
    raise ValueError(f"grids must hold numbers or None, got {value!r}")
