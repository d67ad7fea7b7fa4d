"""What every reduction method returns, and what the family knows of its members."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from .._display import Pictured, Table
from ..arrays import Array, Segments
from ..methods import Method
from ..segments import MIN_LENGTH, SegmentMap, length


@dataclass(frozen=True, eq=False, repr=False)
class Reduction(Pictured):
    """A reduced map, and where each segment of the map before went.

    Parameters
    ----------
    segments : (m, 2, 2) array, metres
    parents : (n,) int array
        Index in `segments` of the output that each input went into, -1 where it was dropped.
    seconds : float
        Time that the method took.
    method : str
        Its name in `reduction.METHODS`.
    scan_seconds : (k,) array or None
        Time that an on-line method took for each scan that has segments.
    scan_live : (k,) int array or None
        Segments in its map after each of these scans.
    """

    segments: Array
    parents: NDArray[np.int64]
    seconds: float
    method: str = ""
    scan_seconds: Array | None = None
    scan_live: NDArray[np.int64] | None = None

    def members(self, index: int) -> NDArray[np.int64]:
        """Input segments that went into one output, ascending, `(k,)` int array."""
        return np.flatnonzero(self.parents == index)

    def __len__(self) -> int:
        return len(self.segments)

    def __repr__(self) -> str:
        return f"Reduction({self.method}: {len(self.parents)} -> {len(self)} segments)"


class Methods(dict[str, Method[Reduction]]):
    """Reduction methods by name; a notebook shows them as A's table 2.16 does.

    Examples
    --------
    >>> def nothing(map):
    ...     return Reduction(map.segments, np.arange(len(map)), 0.0)
    >>> Methods(nothing=Method(nothing, "A 4", merges="2 -> 1", keeps="end points"))
    method   in   merges  runs      needs     keeps       published by
    nothing  A 4  2 -> 1  off-line  segments  end points
    """

    def table(self) -> Table:
        """Class of reduction, process, what each method needs and keeps (A 2.8, table 2.16)."""
        head = ("method", "in", "merges", "runs", "needs", "keeps", "published by")
        return Table(head, (_row(name, method) for name, method in self.items()))

    def __repr__(self) -> str:
        return repr(self.table())

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


def _row(name: str, method: Method[Reduction]) -> tuple[str, ...]:
    runs = "on-line" if method.online else "off-line"
    needs = "points" if method.needs_points else "segments"
    return name, method.source, method.merges, runs, needs, method.keeps, method.paper


def with_length(map: Segments) -> tuple[Array, NDArray[np.int64]]:
    """Segments that have an angle, `(k, 2, 2)`, metres, and their indices in the map, `(k,)`."""
    segments = arrays.segments(map, "map")
    index = np.flatnonzero(length(segments) >= MIN_LENGTH)
    return np.ascontiguousarray(segments[index]), index


def check_thresholds(distance: float, angle: float) -> None:
    """Refuse a distance that is not positive, metres, or an angle beyond a quarter turn, radians.

    Raises
    ------
    ValueError
        Naming the argument and what was expected.
    """
    if not (distance > 0 and np.isfinite(distance)):
        raise ValueError(f"distance must be positive and finite, in metres, got {distance}")
    if not 0 < angle <= np.pi / 2:
        raise ValueError(f"angle must be above 0 and at most pi/2, in radians, got {angle}")


def check_tolerance(tolerance: float) -> None:
    """Refuse a tolerance that is not positive and finite, metres.

    Raises
    ------
    ValueError
        Naming the argument and what was expected.
    """
    if not (tolerance > 0 and np.isfinite(tolerance)):
        raise ValueError(f"tolerance must be positive and finite, in metres, got {tolerance}")


def scans_of(map: Segments) -> NDArray[np.int64]:
    """Index of the scan of each segment, `(n,)`; 0 for all where the map has none."""
    if isinstance(map, SegmentMap):
        return map.scan
    return np.zeros(len(arrays.segments(map, "map")), np.int64)


def runs(scan: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Where each scan begins and stops, in sorted indices `(n,)` of scans."""
    cuts = [0, *(np.flatnonzero(np.diff(scan)) + 1).tolist(), len(scan)]
    return list(pairwise(cuts)) if len(scan) else []


def whole_parents(
    count: int, index: NDArray[np.int64], found: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Parents `(n,)` of all `count` segments, given those of the ones at `index`; else -1."""
    parents = np.full(count, -1, np.int64)
    parents[index] = found
    return parents
