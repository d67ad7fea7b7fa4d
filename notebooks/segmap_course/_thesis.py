"""What the theses and others measured: A's 264 runs, and published errors of alignment."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Any

import numpy as np

from segmap.experiments import default_thresholds
from segmap.readers import data_file
from segmap.reduction import METHODS

if TYPE_CHECKING:
    import pandas as pd

#: A 6.2.1: shorter segments are dropped, or not, before all runs; metres.
THESIS_FILTERS = (None, 0.10)
_PAIRS = {"angle": [radians(10), radians(20)], "distance": [0.10, 0.20, 0.30, 0.40]}
#: The thresholds of appendix A: 33 runs, 66 with and without the filter, on each building.
THESIS_GRIDS: dict[str, dict[str, list[float]]] = {
    "basic_offline": _PAIRS,
    "basic_online": _PAIRS,
    "hybrid": _PAIRS,
    "mean_shift": {"sigma": [0.10, 0.20, 0.30, 0.40]},
    "fusion": {"tolerance": [0.02, 0.04, 0.06, 0.08, 0.10]},
}


def thesis_results() -> pd.DataFrame:
    """The 264 runs of A's appendix: Polimi, Stanford, Bicocca and USC, in metres and radians.

    The columns are those of `experiments.sweep`. Seconds are those of MATLAB on a computer of 2008,
    to whole seconds.

    Examples
    --------
    >>> from segmap.experiments import select
    >>> runs = select(thesis_results(), map="usc", method="fusion", filtered=False)
    >>> runs[["tolerance", "n_before", "n_after", "quality"]].head(2)
         tolerance  n_before  n_after  quality
    246       0.02      3604      784   0.9256
    248       0.04      3604      435   0.8742
    """
    import pandas as pd

    printed = pd.read_csv(data_file("thesis_results.csv"))
    method, length = printed["method"], printed["distance_mm"] / 1000
    before, after = printed["n_before"], printed["n_after"]
    columns: dict[str, Any] = {
        "map": printed["dataset"],
        "method": method,
        "angle": np.radians(printed["angle_deg"]),
        "distance": length.where(~method.isin(["mean_shift", "fusion"])),
        "sigma": length.where(method == "mean_shift"),
        "tolerance": length.where(method == "fusion"),
        "filtered": 0.10 * printed["filtered"],
        "n_before": before,
        "n_after": after,
        "reduction": ((before - after) / before).round(9),
        "quality": printed["quality_pct"] / 100,
        "seconds": printed["time_s"].astype(float),
    }
    return pd.DataFrame(columns)


def thesis_grid(frame: pd.DataFrame) -> pd.DataFrame:
    """Those runs whose thresholds and filter appendix A has too: 66 on each building.

    A threshold that A does not name must have its default.

    Examples
    --------
    >>> len(thesis_grid(thesis_results()))
    264
    """
    inside = _near(frame["filtered"], [least or 0.0 for least in THESIS_FILTERS])
    inside &= frame["method"].isin(list(THESIS_GRIDS)).to_numpy()
    for method, grid in THESIS_GRIDS.items():
        here = (frame["method"] == method).to_numpy()
        defaults = default_thresholds(METHODS[method].function) or {}
        for name, default in defaults.items():
            if name in frame:
                inside &= ~here | _near(frame[name], grid.get(name, [default]))
    return frame[inside]


def within_thesis(frame: pd.DataFrame, *, margin: float = 0.05) -> pd.DataFrame:
    """Share of the runs of A's grid that lie within the range of A's own four buildings.

    A row for each of A's methods; for each map a column of quality and one of reduction. A run lies
    within where A has the same method, thresholds and filter, and its value is at most `margin`
    below the smallest or above the largest that A found.

    Examples
    --------
    >>> within_thesis(thesis_results()).loc["hybrid", "usc"].to_dict()
    {'quality': 1.0, 'reduction': 1.0}
    """
    import pandas as pd

    keys = ["method", "filtered", "angle", "distance", "sigma", "tolerance"]
    ours, theirs = (
        runs.assign(**runs[keys[2:]].fillna(-1.0), filtered=runs["filtered"].fillna(0.0)).round(6)
        for runs in (thesis_grid(frame), thesis_results())
    )
    ranges = theirs.groupby(keys)[["quality", "reduction"]].agg(["min", "max"])
    limits = ranges.loc[list(ours[keys].itertuples(index=False, name=None))]
    inside = {
        what: ours[what].between(
            limits[what, "min"].to_numpy() - margin, limits[what, "max"].to_numpy() + margin
        )
        for what in ("quality", "reduction")
    }
    table = pd.DataFrame(index=list(THESIS_GRIDS), columns=pd.MultiIndex.from_product([[], []]))
    for name in dict.fromkeys(ours["map"]):
        here = ours["map"] == name
        for what, within in inside.items():
            table[name, what] = within[here].groupby(ours["method"]).mean()
    return table


def _near(column: pd.Series[Any], values: list[Any]) -> np.ndarray:
    """Which values of a column are one of some; without a threshold: where the default is None."""
    wanted = np.array([np.nan if value is None else value for value in values], float)
    numbers = column.to_numpy(float, na_value=np.nan)
    return np.isclose(numbers[:, None], wanted, rtol=1e-9, atol=0, equal_nan=True).any(1)
