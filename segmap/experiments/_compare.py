"""Methods at equal quality, never at equal parameter (A 6.2.3)."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._display import Table
from ..arrays import Array
from ._records import Record, Records, filter_words

#: Runs of one building that may be compared: its name, and how it was filtered.
Setting = tuple[str, float | None]


class Standing(NamedTuple):
    """What a method reaches on a map: NaN with a reason where its curve does not get there."""

    map: str
    filtered: float | None
    method: str
    quality: float
    reduction: float
    reason: str = ""


class Standings(Sequence[Standing]):
    """Methods side by side at one quality: a table with a row for each map and filter.

    Parameters
    ----------
    standings : iterable of Standing
    """

    def __init__(self, standings: Iterable[Standing] = ()) -> None:
        self._standings = tuple(standings)

    def reduction(self, map: str, method: str, *, filtered: float | None = None) -> float:
        """Reduction that a method reaches on a map; NaN where it does not get there.

        Raises
        ------
        KeyError
            Where there is no such run.
        """
        for found in self:
            if (found.map, found.filtered, found.method) == (map, filtered, method):
                return found.reduction
        raise KeyError(f"no run of {method} on {map}, filtered: {filter_words(filtered)}")

    def ranking(self, map: str, *, filtered: float | None = None) -> list[str]:
        """Methods on a map, the one that reduces most first, without those that get nowhere."""
        here = [s for s in self if (s.map, s.filtered) == (map, filtered)]
        known = [s for s in here if not np.isnan(s.reduction)]
        return [s.method for s in sorted(known, key=lambda s: -s.reduction)]

    def table(self) -> Table:
        """A row for each map and filter, a column for each method; - where it gets nowhere."""
        methods = list(dict.fromkeys(s.method for s in self))
        cells = {(s.map, s.filtered, s.method): s.reduction for s in self}
        settings = dict.fromkeys((s.map, s.filtered) for s in self)
        rows = (
            [name, filter_words(least), *(_percent(cells.get((name, least, m))) for m in methods)]
            for name, least in settings
        )
        return Table(["map", "filtered", *methods], rows)

    @overload
    def __getitem__(self, index: int) -> Standing: ...
    @overload
    def __getitem__(self, index: slice) -> "Standings": ...
    def __getitem__(self, index: int | slice) -> "Standing | Standings":
        if isinstance(index, slice):
            return Standings(self._standings[index])
        return self._standings[index]

    def __len__(self) -> int:
        return len(self._standings)

    def __repr__(self) -> str:
        return repr(self.table())

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


def equal_quality(records: Iterable[Record], quality: float) -> Standings:
    """The best reduction of each method at one quality, for each map and filter by itself.

    The curve of a method joins those of its runs that no other of its runs beats in both quality
    and reduction, by straight lines. Above its best quality it has no value. Below its lowest
    quality its value is the largest reduction: a map that is better than asked for will do.

    Parameters
    ----------
    records : iterable of Record
    quality : float
        Above 0, at most 1.

    Returns
    -------
    Standings
        By map and filter, then by method, in the order of the records. A filtered run is measured
        against another map, and never joins a curve of unfiltered ones (A 6.2.3).

    Raises
    ------
    ValueError
        For another quality.

    Examples
    --------
    >>> runs = [Record("hall", name, {}, None, 100, 0, r, q, 0.0) for name, r, q in
    ...         [("fusion", 0.4, 0.9), ("fusion", 0.6, 0.8), ("hybrid", 0.5, 0.82)]]
    >>> found = equal_quality(runs, 0.85)
    >>> found
    map   filtered  fusion  hybrid
    hall  no        50.0%   -
    >>> found[1].reason
    'no run of hybrid reaches quality 0.85: its best is 0.82'
    """
    if not 0 < quality <= 1:
        raise ValueError(f"quality must be above 0 and at most 1, got {quality}")
    return Standings(
        _standing(setting, method, curve, quality)
        for setting, group in by_setting(records).items()
        for method, curve in by_method(group).items()
    )


def pareto(records: Iterable[Record], *, each_method: bool = False) -> Records:
    """Records that no other of the same map and filter beats in both quality and reduction.

    Parameters
    ----------
    records : iterable of Record
    each_method : bool
        Whether only runs of the same method may beat a run.

    Returns
    -------
    Records
        In their order; equal runs beat nobody.

    Examples
    --------
    >>> runs = [Record("hall", "fusion", {}, None, 100, 0, r, q, 0.0) for r, q in
    ...         [(0.4, 0.9), (0.3, 0.8), (0.6, 0.8)]]
    >>> [record.reduction for record in pareto(runs)]
    [0.4, 0.6]
    """
    chosen = list(records)
    kept: set[int] = set()
    for group in by_setting(chosen).values():
        for part in by_method(group).values() if each_method else [group]:
            points = points_of(part)
            kept.update(id(part[k]) for k in np.flatnonzero(~_beaten(points)))
    return Records(record for record in chosen if id(record) in kept)


def front(points: ArrayLike) -> Array:
    """The points that no other beats in both coordinates, by ascending first one.

    Parameters
    ----------
    points : (n, 2) array
        Quality and reduction of n runs.

    Returns
    -------
    (k, 2) array
        Quality ascends and reduction descends, both strictly.

    Examples
    --------
    >>> front([(0.9, 0.4), (0.8, 0.3), (0.8, 0.6)])
    array([[0.8, 0.6],
           [0.9, 0.4]])
    """
    array = np.asarray(points, float).reshape(-1, 2)
    return np.unique(array[~_beaten(array)], axis=0)


def reduction_at(points: ArrayLike, quality: float) -> float:
    """Reduction at a quality, on straight lines along the front of some runs.

    Parameters
    ----------
    points : (n, 2) array
        Quality and reduction of n runs.
    quality : float

    Returns
    -------
    float
        The largest reduction of all below the front's lowest quality, NaN above its best.

    Examples
    --------
    >>> reduction_at([(0.9, 0.4), (0.8, 0.3), (0.8, 0.6)], 0.85)
    0.5
    """
    ends = front(points)
    found = np.interp(quality, ends[:, 0], ends[:, 1], right=np.nan) if len(ends) else np.nan
    return round(float(found), 12)


def by_setting(records: Iterable[Record]) -> dict[Setting, list[Record]]:
    """Records of each map and filter: only these may be compared."""
    groups: dict[Setting, list[Record]] = {}
    for record in records:
        groups.setdefault((record.map, record.filtered), []).append(record)
    return groups


def by_method(records: Iterable[Record]) -> dict[str, list[Record]]:
    """Records of each method, in the order of their first one."""
    groups: dict[str, list[Record]] = {}
    for record in records:
        groups.setdefault(record.method, []).append(record)
    return groups


def points_of(records: Iterable[Record]) -> Array:
    """Quality and reduction of records, `(n, 2)`."""
    return np.array([(r.quality, r.reduction) for r in records], float).reshape(-1, 2)


def _standing(setting: Setting, method: str, runs: list[Record], quality: float) -> Standing:
    points = points_of(runs)
    found, best = reduction_at(points, quality), points[:, 0].max()
    said = f"no run of {method} reaches quality {quality:g}: its best is {best:.4g}"
    return Standing(*setting, method, quality, found, said if np.isnan(found) else "")


def _beaten(points: Array) -> NDArray[np.bool_]:
    """Which points another one is at least as good as in both, and better in one; `(n,)`."""
    q, r = points[:, 0], points[:, 1]
    better = (q[None] > q[:, None]) | (r[None] > r[:, None])
    return np.any((q[None] >= q[:, None]) & (r[None] >= r[:, None]) & better, axis=1)


def _percent(value: float | None) -> str:
    return "-" if value is None or np.isnan(value) else f"{value:.1%}"
