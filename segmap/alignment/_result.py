"""What every alignment method returns."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._display import Pictured
from ..arrays import Array
from ._graph import Graph

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class Match:
    """How one scan lies on another, or why that could not be told.

    Parameters
    ----------
    pose : (3,) array, metres and radians
        Pose of the current scan in the frame of the reference; where nothing matched, the start.
    covariance : (3, 3) array
        Of x, y (metres) and heading (radians); infinite on the diagonal where nothing matched.
    matched : bool
    reason : str
        Why nothing matched; empty where it did.
    overlap : float
        Share of the current scan that found its partner, in [0, 1].
    free : (2,) array or None
        Unit vector, in the reference's frame, along which the reference does not fix the motion (a
        corridor's own direction); None where both directions are fixed.
    """

    pose: Array
    covariance: Array
    matched: bool
    reason: str = ""
    overlap: float = 0.0
    free: Array | None = None

    def __repr__(self) -> str:
        x, y, heading = self.pose.round(4) + 0.0
        found = f"{x:.6g} m, {y:.6g} m, {np.degrees(heading):.4g} deg"
        loose = "" if self.free is None else ", free along one direction"
        if not self.matched:
            return f"Match(none: {self.reason})"
        return f"Match({found}, overlap {self.overlap:.2f}{loose})"


def no_match(start: ArrayLike, reason: str, overlap: float = 0.0) -> Match:
    """The honest answer where nothing can be told of the pose, a (3,) array, metres and radians."""
    unknown = np.diag(np.full(3, np.inf))
    return Match(np.array(start, float), unknown, False, reason, overlap)


@dataclass(frozen=True, eq=False, repr=False)
class Alignment(Pictured):
    """One pose for each scan of a log, and which of them rest on a match.

    Parameters
    ----------
    poses : (k, 3) array, metres and radians
        Always finite: a scan that could not be matched carries the odometry on.
    used : (k,) bool array
        Whether the pose rests on the method's own evidence.
    seconds : float
        Time that the method took.
    method : str
        Its name in `alignment.METHODS`.
    reasons : tuple of k str
        Why a scan was not used; empty where it was.
    graph : Graph or None
        Edges, rejected loops and residuals of a pose graph.
    doubt : str
        Which assumption of the method this log does not hold, and by how much; empty where all is
        as assumed.

    Examples
    --------
    >>> Alignment(np.zeros((2, 3)), np.array([True, False]), 0.1, "backbone", ("", "turning"))
    Alignment(backbone: 2 scans, 1 used)
    """

    poses: Array
    used: NDArray[np.bool_]
    seconds: float
    method: str = ""
    reasons: tuple[str, ...] = ()
    graph: Graph | None = field(default=None)
    doubt: str = ""

    @property
    def trusted(self) -> Array:
        """The poses, (k, 3) array, metres and radians, with NaN for scans that were not used.

        `build_map` leaves those out.
        """
        return np.where(self.used[:, None], self.poses, np.nan)

    def why(self) -> pd.DataFrame:
        """How many scans were not used: a row for each reason, a column `scans`."""
        import pandas as pd

        counts = Counter(reason for reason in self.reasons if reason)
        rows = sorted(((n, reason) for reason, n in counts.items()), reverse=True)
        return pd.DataFrame([n for n, _ in rows], [reason for _, reason in rows], ["scans"])

    def __len__(self) -> int:
        return len(self.poses)

    def __repr__(self) -> str:
        doubt = f"; {self.doubt}" if self.doubt else ""
        return f"Alignment({self.method}: {len(self)} scans, {int(self.used.sum())} used{doubt})"


def check_positive(**values: float) -> None:
    """Refuse a threshold that is not positive and finite, naming it.

    Raises
    ------
    ValueError
    """
    for name, value in values.items():
        if not (value > 0 and np.isfinite(value)):
            raise ValueError(f"{name} must be positive and finite, got {value}")
