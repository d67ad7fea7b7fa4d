"""The runs of a sweep, from maps, methods and grids, checked before anything runs."""

from __future__ import annotations

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
Thresholds = dict[str, Threshold]
T = TypeVar("T")
Grid = Mapping[str, Any] | Iterable[Mapping[str, Threshold]]


class Job(NamedTuple):
    """One run to come: `row` says which, `segments` are what the filter has left."""

    row: Row
    segments: SegmentMap
    function: Function
    repeat: int


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
    return {p.name: None if p.default is p.empty else p.default for p in list(parameters)[1:]}


def runs_of(
    maps: Mapping[str, Segments],
    methods: Iterable[str] | Mapping[str, Function],
    grids: Mapping[str, Grid],
    filters: Iterable[float | None],
    repeat: int,
) -> list[Job]:
    """All runs of a sweep in the order of the request; arguments and errors as of `sweep`."""
    # A method that is asked for by its name alone runs wherever the map comes from.
    own: dict[str, Any] = dict(methods) if isinstance(methods, Mapping) else {}
    needs = {name for name, m in own.items() if isinstance(m, Method) and m.needs_sensors}
    for name in () if own else _as_list(methods, "methods"):
        own |= {arrays.one_of(name, "methods", METHODS): METHODS[name]}
    functions: dict[str, Function] = {
        name: arrays.function(getattr(m, "function", m), "methods", "of a map and thresholds")
        for name, m in own.items()
    }
    for name in set(grids) - set(METHODS):
        arrays.one_of(name, "grids", functions)
    plans = {name: _combinations(name, f, grids.get(name, [{}])) for name, f in functions.items()}
    return [
        Job(row | {"method": method, "thresholds": thresholds}, part, functions[method], repeat)
        for name, map in maps.items()
        for row, part in _filter(name, map, _as_list(filters, "filters"))
        for method, plan in plans.items()
        if method not in needs or part.sensors is not None
        for thresholds in plan
    ]


def _as_list(values: Iterable[T], name: str) -> list[T]:
    if isinstance(values, str) or not arrays.is_iterable(values):
        raise ValueError(f"{name} must be a list, got {arrays.brief(values)}")
    return list(values)


def _filter(
    name: str, map: Segments, filters: list[float | None]
) -> Iterator[tuple[Row, SegmentMap]]:
    """A map after each filter, and what a row says of it."""
    segments = arrays.segments(map, f"maps[{name!r}]")
    whole = map if isinstance(map, SegmentMap) else SegmentMap(segments)
    row = {"map": arrays.instance(name, "maps: a name", str)}
    for least in filters:
        if least is None:
            yield row | {"filtered": 0.0}, whole
        else:
            arrays.number(least, "filters", above=0, unit="metres, or None")
            yield row | {"filtered": least}, whole.filtered(least)


def _combinations(name: str, function: Function, grid: Grid) -> list[Thresholds]:
    """Thresholds of each run.

    Defaults that the grid leaves out are filled in; one that is no number is left to the method.
    """
    if isinstance(grid, Mapping):
        lists = [np.atleast_1d(np.asarray(values, object)) for values in grid.values()]
        grid = [dict(zip(grid, values, strict=True)) for values in product(*lists)]
    defaults, words = default_thresholds(function), f"grids[{name!r}]"
    numbers = {k: v for k, v in (defaults or {}).items() if isinstance(v, int | float)}
    combinations = []
    for row in _as_list(grid, words):
        arrays.instance(row, words, Mapping)
        if defaults is not None and (strange := set(row) - set(defaults)):
            names = ", ".join(defaults)
            raise ValueError(f"{words} must be of {names}, got {', '.join(map(str, strange))}")
        if taken := NO_THRESHOLDS & set(row):
            raise ValueError(f"{name} must not call a threshold {taken.pop()!r}: a column is")
        plain = {k: _number(v) for k, v in (numbers | dict(row)).items()}
        combinations.append({k: v for k, v in plain.items() if v is not None or defaults is None})
    return combinations


def _number(value: Any) -> Threshold:
    """A number of Python's own, as a file keeps it."""
    plain = value.item() if isinstance(value, np.generic) else value
    if plain is None or isinstance(plain, int | float):
        return float(plain) if isinstance(plain, float) else plain  # not `10 degrees`
    raise ValueError(f"grids must hold numbers or None, got {value!r}")
