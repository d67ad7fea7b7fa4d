"""What every reduction method returns, and what the family knows of its members."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._display import Pictured
from ..angles import Array
from ..segments import MIN_LENGTH, SegmentMap, Segments, as_segments, length


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
    """

    segments: Array
    parents: NDArray[np.int64]
    seconds: float
    method: str = ""

    def members(self, index: int) -> NDArray[np.int64]:
        """Input segments that went into one output, ascending, `(k,)` int array."""
        return np.flatnonzero(self.parents == index)

    def __len__(self) -> int:
        return len(self.segments)

    def __repr__(self) -> str:
        return f"Reduction({self.method}: {len(self.parents)} -> {len(self)} segments)"


class Method(NamedTuple):
    """A reduction method and its place in A's table 2.16.

    Parameters
    ----------
    function : callable
        `function(map, *, thresholds) -> Reduction`.
    merges : str
        How many segments one step turns into how many.
    online : bool
        Whether it takes the scans one by one.
    needs_points : bool
        Whether it needs the points behind the segments.
    source : str
    """

    function: Callable[..., Reduction]
    merges: Literal["2 -> 1", "m -> 1", "m -> n"]
    online: bool
    needs_points: bool
    source: str

    def __call__(self, map: SegmentMap, **thresholds: float) -> Reduction:
        """Reduce a map: `METHODS[name](map, ...)` is `reduction.<name>(map, ...)`."""
        return self.function(map, **thresholds)


def with_length(map: Segments) -> tuple[Array, NDArray[np.int64]]:
    """Segments that have an angle, `(k, 2, 2)`, and their indices in the map, `(k,)`."""
    segments = as_segments(map, "map")
    index = np.flatnonzero(length(segments) >= MIN_LENGTH)
    return np.ascontiguousarray(segments[index]), index


def whole_parents(
    count: int, index: NDArray[np.int64], found: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Parents of all `count` segments, given those of the ones at `index`; -1 elsewhere."""
    parents = np.full(count, -1, np.int64)
    parents[index] = found
    return parents
