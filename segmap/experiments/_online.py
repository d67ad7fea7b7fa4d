"""How the time of an on-line method grows with the scans."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from .. import arrays
from ..reduction import Reduction
from ._files import Threshold

if TYPE_CHECKING:
    import pandas as pd


def online_times(
    reduction: Reduction, thresholds: Mapping[str, Threshold], *, every: int = 1
) -> pd.DataFrame:
    """Time and size of the map of an on-line method as the scans come in.

    `thresholds` is what the method was given. There is a row for `every` so many scans, and one for
    the last.

    Returns
    -------
    DataFrame
        method, a column for each threshold, scans: how many were taken in, seconds: since the first
        one, live: segments in the map.

    Examples
    --------
    >>> from segmap import METHODS, SegmentMap
    >>> wall = SegmentMap([[(0, 0), (1, 0)], [(0, 0), (0, 1)], [(1, 0), (2, 0)]], [0, 1, 2])
    >>> online_times(METHODS["hybrid"](wall), {}, every=2)[["scans", "live"]]
       scans  live
    0      2     2
    1      3     2
    """
    import pandas as pd

    arrays.instance(reduction, "reduction", Reduction)
    arrays.instance(thresholds, "thresholds", Mapping)
    if reduction.scan_seconds is None or reduction.scan_live is None:
        raise ValueError(f"reduction must be of an on-line method, got {reduction!r}")
    count, every = len(reduction.scan_seconds), arrays.whole(every, "every")
    chosen = {name: arrays.number(value, "thresholds") for name, value in thresholds.items()}
    scans = np.arange(1, count + 1)
    rows = {
        "scans": scans,
        "seconds": np.cumsum(reduction.scan_seconds),
        "live": reduction.scan_live,
    }
    frame = pd.DataFrame({"method": reduction.method, **chosen, **rows})
    return frame[(scans % every == 0) | (scans == count)].reset_index(drop=True)


def growth(frame: pd.DataFrame, *, after: float = 0.25) -> float:
    """Exponent p of `seconds ~ scans ** p`, fitted to one run after a share of the scans.

    It depends on that share where the robot comes into new rooms late: look at several.

    Examples
    --------
    >>> import pandas as pd
    >>> times = pd.DataFrame({"scans": [1, 2, 4, 8], "seconds": [1.0, 4.0, 16.0, 64.0]})
    >>> round(growth(times), 9)
    2.0
    """
    arrays.frame(frame, numbers=["scans", "seconds"])
    share = arrays.number(after, "after", least=0, most=1)
    late = frame[frame["scans"] >= frame["scans"].max() * share]
    if late["scans"].nunique() < 2 or not (late[["scans", "seconds"]] > 0).all(axis=None):
        raise ValueError(
            f"frame must hold two rows or more after {share:g} of the scans, above 0 s"
        )
    return float(np.polyfit(np.log(late["scans"]), np.log(late["seconds"]), 1)[0])
