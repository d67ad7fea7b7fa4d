"""How the time of an on-line method grows with the scans."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .. import arrays

if TYPE_CHECKING:
    import pandas as pd


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
