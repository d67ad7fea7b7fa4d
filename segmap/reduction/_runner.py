"""What every reduction method returns, and the one runner that calls them all."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array, Metres, Radians, Segments, at_least, at_most, unit_checks
from ..compiled import work_time
from ..display import Pictured
from ..methods import Family
from ..progress import announce
from ..segments import MIN_LENGTH, SegmentMap, length

if TYPE_CHECKING:
    import pandas as pd

Indices = NDArray[np.int64]
#: Angle between two lines: at most a quarter turn.
Turn = Annotated[Radians, at_most(np.pi / 2)]
#: A length that may be none.
Length = Annotated[Metres, at_least(0)]
#: What a method returns: outputs `(m, 2, 2)`, metres, and the output of each of its rows, `(k,)`.
Found = tuple[Array, Indices]
#: An on-line method: yields the segments in its map after each scan, and returns what it found.
Steps = Generator[int, None, Found]


@dataclass(frozen=True, eq=False, repr=False)
class Reduction(Pictured):
    """A reduced map, and where each segment of the map before went.

    Parameters
    ----------
    segments : (m, 2, 2) array, metres
    parents : (n,) int array
        Index in `segments` of the output that each input went into, -1 where it was dropped.
    seconds
        Time that the method took; NaN where nobody measured it.
    method
        Its name in `reduction.METHODS`.
    scan_seconds : (k,) array or None
        Time that an on-line method took for each scan that has segments.
    scan_live : (k,) int array or None
        Segments in its map after each of these scans.
    doubt
        Why the method may not suit this map; nothing where it does.
    noise
        Standard deviation of looks at one wall, metres, for a method that estimates it; else NaN.
    """

    segments: Array
    parents: Indices
    seconds: float = np.nan
    method: str = ""
    scan_seconds: Array | None = None
    scan_live: Indices | None = None
    doubt: str = ""
    noise: float = np.nan

    def members(self, index: int) -> Indices:
        """Input segments that went into one output, ascending, `(k,)` int array."""
        arrays.whole(index, "index", least=0, most=len(self) - 1)
        return np.flatnonzero(self.parents == index)

    def __len__(self) -> int:
        return len(self.segments)

    def __repr__(self) -> str:
        doubt = f"; {self.doubt}" if self.doubt else ""
        method = f"{self.method}: " if self.method else ""
        return f"Reduction({method}{len(self.parents)} -> {len(self)} segments{doubt})"


class Methods(Family[Reduction]):
    """Reduction methods by name; a notebook shows them as A's table 2.16 does.

    Examples
    --------
    >>> from segmap.methods import Method
    >>> def nothing(before):
    ...     return Reduction(before.segments, np.arange(len(before)))
    >>> Methods(nothing=Method(nothing, "A 4", merges="2 -> 1", keeps="end points"))
              in  merges      runs     needs       keeps published by
    nothing  A 4  2 -> 1  off-line  segments  end points
    """

    def table(self) -> pd.DataFrame:
        """Class of reduction, process, what each method needs and keeps (A 2.8, table 2.16)."""
        import pandas as pd

        rows = []
        for m in self.values():
            runs, needs = ("off-line", "on-line")[m.online], ("segments", "points")[m.needs_points]
            rows.append([m.source, m.merges, runs, needs, m.keeps, m.paper])
        head = ["in", "merges", "runs", "needs", "keeps", "published by"]
        return pd.DataFrame(rows, list(self), head)

    def __repr__(self) -> str:
        return self.table().to_string()

    def _repr_html_(self) -> str:
        return self.table().to_html()


class Rows(NamedTuple):
    """The segments of a map that a method works on: those that have a length."""

    segments: Array  #: (k, 2, 2), in the order of the map; on-line scan after scan, and so in each
    source_row: Indices  #: (k,) row of the map that each of them is
    cuts: Indices  #: (s + 1,) scan j has the rows `cuts[j]` to `cuts[j + 1]`; off-line one run

    def scans(self) -> Iterator[tuple[int, int]]:
        """First row of each scan that has rows, and the one behind its last."""
        return pairwise(self.cuts.tolist())


def run_offline(
    name: str, map: Segments, method: Callable[[Rows], Found], *, splits: bool = False
) -> Reduction:
    """Call an off-line method: `method(rows) -> (outputs, the output that each row went into)`.

    Where one input can end in several outputs, `splits`: then an output can be the first choice of
    no input, and there can be more outputs than inputs.

    Raises
    ------
    RuntimeError
        Where the method breaks what a `Reduction` promises: a mistake in the method.

    Examples
    --------
    >>> wall = [[(0, 0), (1, 0)], [(2, 2), (2, 2)]]
    >>> run_offline("first", wall, lambda rows: (rows.segments, np.array([0]))).parents
    array([ 0, -1])
    """
    start = work_time()
    rows, count = rows_of(map)
    outputs, into = method(rows)
    parents = _checked_parents(name, count, rows, outputs, into, splits)
    return Reduction(outputs, parents, work_time() - start, name)


def run_online(
    name: str,
    map: Segments,
    method: Callable[[Rows], Steps],
    *,
    splits: bool = False,
    most_segments: int | None = None,
) -> Reduction:
    """Call an on-line method, a generator that takes one scan of the rows at each step.

    It yields how many segments its map holds, scan after scan, and returns what `run_offline` asks
    for. Where the cost grows with the square of the map, one of more than `most_segments`, which
    take some ten seconds, is warned of.

    Examples
    --------
    >>> def keep(rows):
    ...     for first, stop in rows.scans():
    ...         yield stop
    ...     return rows.segments, np.arange(len(rows.segments))
    >>> run_online("keep", [[(0, 0), (1, 0)]], keep).scan_live
    array([1])
    """
    start = work_time()
    rows, count = rows_of(map, by_scan=True)
    slow = ""
    if most_segments is not None and len(rows.segments) > most_segments:
        slow = f": its cost grows with the square of {len(rows.segments)} segments"
        unit_checks.warn(f"{name} is slow{slow}; `fusion` grows as they do")
    steps, live, ended = method(rows), list[int](), [work_time()]
    while True:
        try:
            announce(
                len(live) / len(rows.cuts),
                f"{name}: {len(live)} of {len(rows.cuts) - 1} scans{slow}",
            )
            live.append(next(steps))
        except StopIteration as last:
            outputs, into = last.value
            break
        ended.append(work_time())
    parents = _checked_parents(name, count, rows, outputs, into, splits)
    if len(live) != len(rows.cuts) - 1 or (live and live[-1] != len(outputs)):
        raise RuntimeError(
            f"{name}: {live[-1:]} segments after {len(live)} scans is not its result"
        )
    seconds = work_time() - start
    each, live_counts = np.diff(ended), np.array(live, np.int64)
    return Reduction(outputs, parents, seconds, name, each, live_counts)


def rows_of(map: Segments, *, by_scan: bool = False) -> tuple[Rows, int]:
    """The segments of a map that have a length, scan by scan or as one run; and n of the map."""
    segments = arrays.segments(map, "map")
    index = np.flatnonzero(length(segments) >= MIN_LENGTH)
    scan = np.zeros(len(index), np.int64)
    if by_scan and isinstance(map, SegmentMap):
        order = np.argsort(map.scan[index], kind="stable")
        index = index[order]
        scan = map.scan[index]
    inner = np.flatnonzero(np.diff(scan)) + 1
    cuts = np.concatenate([[0], inner, [len(index)] if len(index) else []]).astype(np.int64)
    return Rows(np.ascontiguousarray(segments[index]), index, cuts), len(segments)


def resolve_merges(into: Indices) -> tuple[NDArray[np.bool_], Indices]:
    """Which went into themselves, and the number among these of the one that each ended in.

    Examples
    --------
    >>> resolve_merges(np.array([1, 3, 2, 3]))
    (array([False, False,  True,  True]), array([1, 1, 0, 1]))
    """
    alive = into == np.arange(len(into))
    while not alive[into].all():
        into = into[into]
    return alive, (np.cumsum(alive) - 1)[into]


def ordered_by_first_input(into: Indices, row: Indices, count: int) -> tuple[Indices, Indices]:
    """Sort outputs by their lowest input: their order `(m,)`, and the parents `(k,)` renumbered.

    Examples
    --------
    >>> ordered_by_first_input(np.array([1, 0, 1]), np.array([4, 7, 9]), 2)
    (array([1, 0]), array([0, 1, 0]))
    """
    lowest = np.full(count, np.iinfo(np.int64).max)
    np.minimum.at(lowest, into[into >= 0], row[into >= 0])
    order = np.argsort(lowest, kind="stable")
    place = np.full(count + 1, -1)  # its last element: what was dropped stays so
    place[order] = np.arange(count)
    return order, place[into]


def _checked_parents(
    name: str, count: int, rows: Rows, outputs: Array, into: Indices, splits: bool
) -> Indices:
    """Parents of all `count` segments of the map, `(n,)`, once the method's result is sound."""
    into, wrong = np.asarray(into), ""
    if outputs.shape != (len(outputs), 2, 2) or not np.isfinite(outputs).all():
        wrong = "outputs are not finite segments (m, 2, 2)"
    elif into.shape != rows.source_row.shape or into.dtype.kind != "i":
        wrong = f"parents are not {len(rows.source_row)} whole numbers"
    elif len(into) and not (into.min() >= -1 and into.max() < len(outputs)):
        wrong = f"parents are not within -1 to {len(outputs) - 1}"
    elif not splits and len(outputs) != len(np.unique(into[into >= 0])):
        wrong = "an output has no input"
    if wrong:
        raise RuntimeError(f"{name}: {wrong}; this is a mistake in the method")
    parents = np.full(count, -1, np.int64)
    parents[rows.source_row] = into
    return parents
