"""Runs as DataFrames: read, written, selected, and those that come with segmap."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import arrays
from ..readers import data_file
from ._files import (
    NO_THRESHOLDS,
    NUMBER_COLUMNS,
    Threshold,
    as_frame,
    read_rows,
    thresholds_in,
    write_rows,
)

if TYPE_CHECKING:
    import pandas as pd

#: Buildings whose runs come with segmap.
BUILDINGS = ("fr079", "intel", "intel_default", "malaga", "malaga_default", "office")


def read_records(path: str | Path) -> pd.DataFrame:
    """Read runs that `write_records` has written, with the columns of `sweep`."""
    return as_frame(read_rows(arrays.file(path)))


def write_records(frame: pd.DataFrame, path: str | Path) -> None:
    """Write runs of `sweep` to a CSV file, whole or not at all."""
    arrays.frame(frame, ["map", "method"], set(NUMBER_COLUMNS) - {"invented", "missed"})
    rows = [{str(name): value for name, value in row.items()} for row in frame.to_dict("records")]
    write_rows(arrays.file(path), [row | {"thresholds": thresholds_of(row)} for row in rows])


def load_records(*names: str) -> pd.DataFrame:
    """Runs of all methods on buildings that the thesis never saw, as `make bench` wrote them.

    The buildings of some names, or all that there are; with the columns of `sweep`.

    Examples
    --------
    >>> runs = select(load_records("malaga"), method="fusion", tolerance=0.04)
    >>> runs[["filtered", "n_before", "n_after"]]
         filtered  n_before  n_after
    104       0.0      4104     1062
    340       0.1      3714     1013
    """
    chosen = [arrays.one_of(name, "names", BUILDINGS) for name in names or BUILDINGS]
    paths = [data_file(f"records/{name}.csv") for name in chosen]
    return as_frame(row for path in paths for row in read_rows(path))


def load_online(name: str) -> pd.DataFrame:
    """Times of the on-line methods on a building, as `make bench` wrote them.

    Columns: method, its thresholds, scans: how many were taken in, seconds: since the first one,
    live: segments in the map.
    """
    return _stored_table(f"online/{arrays.one_of(name, 'name', ('intel',))}")


def load_alignments(log: str = "") -> pd.DataFrame:
    """Errors of all alignment methods on Malaga, Intel and FR079, as `make bench` wrote them.

    Intel and FR079 are measured against verified relations (`metrics.relation_errors`), FR079 with
    simulated drift; Malaga against its 99 corrected poses after the best rigid motion. Only logs
    whose name begins with `log`.

    Returns
    -------
    DataFrame
        log, method; scans, used: of the log, and with a match of their own; compared: errors that
        were taken; mean, deviation, rms, p95, largest: of the errors of position, metres;
        above_0.2: share of them above 0.2 m; heading: mean error, radians; seconds.

    Examples
    --------
    >>> load_alignments("intel")[["method", "mean"]].round(2).head(2)
             method  mean
    0      odometry  3.53
    1  ground_truth  0.04
    """
    return _beginning(_stored_table("alignment"), "log", log)


def load_walls(group: str = "") -> pd.DataFrame:
    """Reduction methods against the true walls of simulated buildings, as `make bench` judged them.

    Only groups of maps whose name begins with `group`. The buildings, and what is good, are told in
    `data/records/README.md`.

    Returns
    -------
    DataFrame
        group, sensor, noise (of the poses: metres, or "drift"), method, thresholds (to read); means
        over the maps as `metrics.against_walls` has them: per_wall and its largest, found, missed,
        invented, doubled (shares of what could be known), offset (root mean square, metres);
        all_four: 1 for each map that is good, 0 for others; maps: how many.

    Examples
    --------
    >>> load_walls("tuned")[["noise", "method", "thresholds", "all_four"]].head(2)
      noise         method     thresholds      all_four
    0     0  basic_offline  distance 0.02  000000000000
    1     0  basic_offline  distance 0.05  000000000000
    """
    runs = _beginning(_stored_table("walls"), "group", group)
    words = [thresholds_text(thresholds_in(text)) for text in runs["thresholds"]]
    return runs.assign(thresholds=words, maps=runs["all_four"].str.len())


def _stored_table(name: str) -> pd.DataFrame:
    """A table that comes with segmap."""
    import pandas as pd

    texts: Any = dict.fromkeys(("noise", "thresholds", "all_four"), str)
    return pd.read_csv(data_file(f"records/{name}.csv"), converters=texts)


def _beginning(frame: pd.DataFrame, column: str, start: str) -> pd.DataFrame:
    """Rows in which the text of a column begins with some letters."""
    rows = frame[frame[column].str.startswith(arrays.instance(start, column, str))]
    if rows.empty:
        names = ", ".join(dict.fromkeys(frame[column]))
        raise ValueError(f"{column} must be the beginning of one of {names}, got {start!r}")
    return rows.reset_index(drop=True)


def select(
    frame: pd.DataFrame,
    *,
    map: str | None = None,
    method: str | None = None,
    filtered: float | bool | None = None,
    **thresholds: float,
) -> pd.DataFrame:
    """Runs of one map, of one method, with or without a filter, with some thresholds.

    `filtered` is one filter in metres, True for any, False for none. Thresholds are compared to
    within a part in 10^9.

    Examples
    --------
    >>> import pandas as pd
    >>> runs = pd.DataFrame({"method": ["fusion", "fusion"], "tolerance": [0.02, 0.1 + 0.2]})
    >>> select(runs, tolerance=0.3)
       method  tolerance
    1  fusion        0.3
    """
    is_match = np.ones(len(arrays.frame(frame)), bool)
    for name, word in (("map", map), ("method", method)):
        if word is not None:
            is_match &= arrays.frame(frame, [name])[name] == arrays.instance(word, name, str)
    if isinstance(filtered, bool):
        is_match &= (arrays.frame(frame, numbers=["filtered"])["filtered"] > 0) == filtered
    elif filtered is not None:
        thresholds["filtered"] = filtered
    for name, value in thresholds.items():
        column = arrays.frame(frame, numbers=[name])[name].astype(float)
        is_match &= np.isclose(column, arrays.number(value, name), rtol=1e-9, atol=0)
    return frame[is_match]


def thresholds_of(run: Mapping[str, Any] | pd.Series) -> dict[str, Threshold]:
    """The thresholds of a row of a frame, without those that the method does not have.

    Examples
    --------
    >>> thresholds_of({"map": "hall", "method": "fusion", "tolerance": 0.04, "sigma": np.nan})
    {'tolerance': 0.04}
    """
    import pandas as pd

    if not isinstance(run, pd.Series):
        arrays.instance(run, "run", Mapping)
    if not all(map(pd.api.types.is_scalar, dict(run).values())):
        raise ValueError(f"run must hold one value a column, got {arrays.brief(run)}")
    plain = {k: v.item() if isinstance(v, np.generic) else v for k, v in run.items()}
    return {str(k): v for k, v in plain.items() if k not in NO_THRESHOLDS and not pd.isna(v)}


def thresholds_text(run: Mapping[str, Any] | pd.Series) -> str:
    """The thresholds of one run to read, with three digits.

    Examples
    --------
    >>> thresholds_text({"distance": 0.2, "angle": 0.17453})
    'distance 0.2, angle 0.175'
    """
    return ", ".join(f"{name} {number_text(value)}" for name, value in thresholds_of(run).items())


def number_text(value: Threshold) -> str:
    """A threshold with three digits."""
    return f"{value:.3g}" if isinstance(value, float) else str(value)
