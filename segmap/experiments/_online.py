"""How the time of an on-line method grows with the scans: measured live, kept in files."""

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..readers import data_file
from ..reduction import Reduction
from ._bundled import known
from ._records import Threshold, thresholds_from, thresholds_text

HEAD = ("method", "thresholds", "scans", "seconds", "live")


@dataclass(frozen=True, eq=False)
class Pace:
    """Time and size of the map of an on-line method as the scans come in.

    Parameters
    ----------
    method : str
    thresholds : mapping
        Metres and radians.
    scans : (k,) int array
        So many scans were taken in, ascending.
    seconds : (k,) array
        Since the first one.
    live : (k,) int array
        Segments in the map.
    """

    method: str
    thresholds: Mapping[str, Threshold]
    scans: NDArray[np.int64]
    seconds: Array
    live: NDArray[np.int64]

    @classmethod
    def of(
        cls, reduction: Reduction, thresholds: Mapping[str, Threshold], *, every: int = 1
    ) -> "Pace":
        """Pace of a reduction by an on-line method, at every so many scans and at the last.

        Of all scans that have segments, `(n,)`, k are kept; seconds add up.

        Raises
        ------
        ValueError
            For a method that is not on-line.

        Examples
        --------
        >>> from segmap import METHODS, SegmentMap
        >>> wall = SegmentMap([[(0, 0), (1, 0)], [(0, 0), (0, 1)], [(1, 0), (2, 0)]], [0, 1, 2])
        >>> pace = Pace.of(METHODS["hybrid"](wall), {}, every=2)
        >>> pace.scans, pace.live
        (array([2, 3]), array([2, 2]))
        """
        if reduction.scan_seconds is None or reduction.scan_live is None:
            raise ValueError(f"reduction must be of an on-line method, got {reduction!r}")
        scans = np.arange(1, len(reduction.scan_seconds) + 1)
        kept = (scans % every == 0) | (scans == len(scans))
        seconds = np.cumsum(reduction.scan_seconds)
        return cls(
            reduction.method, thresholds, scans[kept], seconds[kept], reduction.scan_live[kept]
        )

    def growth(self, after: float = 0.25) -> float:
        """Exponent p of `seconds ~ scans ** p`, both `(k,)`, fitted after a share of the scans.

        It depends on that share where the robot comes into new rooms late: look at several.
        """
        late = self.scans >= self.scans[-1] * after
        return float(np.polyfit(np.log(self.scans[late]), np.log(self.seconds[late]), 1)[0])


def write_pace(paces: Iterable[Pace], path: Path) -> None:
    """Write a CSV file with a line for each of the `(k,)` points, seconds to the microsecond."""
    with path.open("w", encoding="utf-8", newline="") as target:
        lines = csv.writer(target, lineterminator="\n")
        lines.writerow(HEAD)
        for pace in paces:
            what = (pace.method, thresholds_text(pace.thresholds))
            points = zip(pace.scans, pace.seconds.round(6), pace.live, strict=True)
            lines.writerows((*what, *(value.item() for value in point)) for point in points)


def load_pace(name: str) -> list[Pace]:
    """Pace of the on-line methods on a building, as `make bench` wrote it.

    Raises
    ------
    ValueError
        Where there is none of that name; it lists those that there are.
    """
    path = known(data_file("records/online"), name)
    with path.open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines))
    return [
        _pace(method, text, list(part))
        for (method, text), part in groupby(rows, lambda row: (row["method"], row["thresholds"]))
    ]


def _pace(method: str, text: str, rows: list[dict[str, str]]) -> Pace:
    scans, seconds, live = (
        np.array([float(row[name]) for row in rows]) for name in ("scans", "seconds", "live")
    )
    return Pace(method, thresholds_from(text), scans.astype(int), seconds, live.astype(int))
