"""Methods at equal quality, never at equal parameter (A 6.2.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array

if TYPE_CHECKING:
    import pandas as pd

#: Only runs of the same map and filter may be compared.
SETTING = ["map", "filtered"]
#: Columns that are compared.
COMPARED_COLUMNS = ["filtered", "quality", "reduction"]


def equal_quality(frame: pd.DataFrame, quality: float) -> pd.DataFrame:
    """The best reduction of each method at one quality, for each map and filter by itself.

    The curve of a method joins those of its runs that no other of its runs beats in both quality
    and reduction, by straight lines. Above its best quality it has no value. Below its lowest
    quality its value is the largest reduction: a map that is better than asked for will do.

    Returns
    -------
    DataFrame
        map, filtered, a column of reductions for each method, NaN where its curve has no value, and
        reason: why it has none. Maps and methods are in the order of the runs. A filtered run is
        measured against another map, and never joins a curve of unfiltered ones (A 6.2.3).

    Examples
    --------
    >>> import pandas as pd
    >>> runs = pd.DataFrame({
    ...     "map": "hall", "filtered": 0.0, "method": ["fusion", "fusion", "hybrid"],
    ...     "quality": [0.9, 0.8, 0.82], "reduction": [0.4, 0.6, 0.5]})
    >>> table = equal_quality(runs, 0.85)
    >>> table["fusion"].item(), table["hybrid"].item(), table["reason"].item()
    (0.5, nan, 'hybrid reaches 0.82 at most')
    """
    import pandas as pd

    arrays.number(quality, "quality", above=0, most=1)
    arrays.frame(frame, ["map", "method"], COMPARED_COLUMNS)
    methods = list(dict.fromkeys(frame["method"]))
    rows = []
    for setting, here in frame.groupby(SETTING, sort=False):
        row: dict[str, object] = dict(zip(SETTING, setting, strict=True))
        reasons = []
        for method, runs in here.groupby("method", sort=False):
            points = _points(runs)
            row[str(method)] = reached = reduction_at(points, quality)
            if np.isnan(points[:, 0]).all():
                reasons.append(f"{method} has no quality, its map is empty")
            elif np.isnan(reached):
                reasons.append(f"{method} reaches {np.nanmax(points[:, 0]):.4g} at most")
        rows.append(row | {"reason": ", ".join(reasons)})
    return pd.DataFrame(rows, columns=[*SETTING, *methods, "reason"])


def pareto(frame: pd.DataFrame, *, each_method: bool = False) -> pd.DataFrame:
    """Runs that no other of the same map and filter beats in both quality and reduction.

    With `each_method` only runs of the same method may beat a run. They stay in their order; equal
    runs beat nobody.

    Examples
    --------
    >>> import pandas as pd
    >>> runs = pd.DataFrame({"quality": [0.9, 0.8, 0.8], "reduction": [0.4, 0.3, 0.6]})
    >>> runs = runs.assign(map="hall", filtered=0.0)
    >>> pareto(runs)
       quality  reduction   map  filtered
    0      0.9        0.4  hall       0.0
    2      0.8        0.6  hall       0.0
    """
    by = [*SETTING, "method"] if arrays.switch(each_method, "each_method") else SETTING
    arrays.frame(frame, by, COMPARED_COLUMNS)
    points, on_front = _points(frame), np.zeros(len(frame), bool)
    groups = frame.groupby(by, sort=False)
    for places in groups.indices.values():
        on_front[places] = ~_dominance(points[places])
    return frame[on_front]


def good_maps(frame: pd.DataFrame) -> pd.DataFrame:
    """In how many maps of `load_walls` all four figures are good, by method, the best first.

    Returns
    -------
    DataFrame
        thresholds: those that are best for all maps; a column for each noise and all: the maps
        that are good with them; each_its_own: those that are good with some thresholds of the
        method; maps: how many were tried. Thresholds that are best here were chosen with these
        maps in sight; those of another table are taken by
        `frame[frame["thresholds"] == frame["method"].map(table["thresholds"])]`.

    Examples
    --------
    >>> import pandas as pd
    >>> runs = pd.DataFrame({"noise": ["0", "drift"] * 2, "all_four": ["110", "000", "001", "011"]})
    >>> runs = runs.assign(group="it", sensor="URG", method="fusion", maps=3)
    >>> runs["thresholds"] = ["tolerance 0.02"] * 2 + ["tolerance 0.04"] * 2
    >>> good_maps(runs).iloc[0].to_dict()
    {'thresholds': 'tolerance 0.04', '0': 1, 'drift': 2, 'all': 3, 'each_its_own': 5, 'maps': 6}
    """
    setting, of = ["method", "group", "sensor", "noise"], ["method", "thresholds"]
    arrays.frame(frame, [*setting, "thresholds", "all_four"], ["maps"])
    good = frame["all_four"].map(lambda flags: str(flags).count("1"))
    table = frame.assign(good=good).pivot_table(
        "good", of, "noise", aggfunc="sum", sort=False, fill_value=0
    )
    table = table.rename_axis(columns=None).assign(all=lambda each: each.sum(axis=1))
    table = table.loc[table["all"].groupby("method").idxmax()].reset_index("thresholds")
    maps = frame.groupby(setting).agg({"all_four": _ever, "maps": "max"}).groupby("method").sum()
    table[["each_its_own", "maps"]] = maps
    return table.sort_values(["all", "each_its_own"], ascending=False, kind="stable")


def _ever(flags: pd.Series) -> int:
    """How many of some maps are good in one run at least."""
    return sum("1" in each for each in zip(*flags, strict=True))


def front(points: ArrayLike) -> Array:
    """The points (quality, reduction) that no other beats in both, by ascending first one.

    Quality ascends and reduction descends, both strictly; none is NaN.

    Examples
    --------
    >>> front([(0.9, 0.4), (0.8, 0.3), (0.8, 0.6)])
    array([[0.8, 0.6],
           [0.9, 0.4]])
    """
    array = arrays.table(points, "points", 2, unit="shares", missing=True)
    return np.unique(array[~_dominance(array)], axis=0)


def reduction_at(points: ArrayLike, quality: float) -> float:
    """Reduction at a quality, on straight lines along the front of points (quality, reduction).

    The largest reduction of all below the front's lowest quality, NaN above its best.

    Examples
    --------
    >>> reduction_at([(0.9, 0.4), (0.8, 0.3), (0.8, 0.6)], 0.85)
    0.5
    """
    ends, quality = front(points), arrays.number(quality, "quality")
    reduction = np.interp(quality, ends[:, 0], ends[:, 1], right=np.nan) if len(ends) else np.nan
    return round(float(reduction), 12)


def _points(frame: pd.DataFrame) -> Array:
    """Quality and reduction of runs, `(n, 2)`."""
    return frame[["quality", "reduction"]].to_numpy(float)


def _dominance(points: Array) -> NDArray[np.bool_]:
    """True for dominated points (Pareto): another is as good in both, and better in one; `(n,)`.

    The quality of an empty map is NaN: every other point dominates it.
    """
    q, r = points[:, 0], points[:, 1]
    better = (q[None] > q[:, None]) | (r[None] > r[:, None])
    beaten = np.any((q[None] >= q[:, None]) & (r[None] >= r[:, None]) & better, axis=1)
    return beaten | np.isnan(q)
