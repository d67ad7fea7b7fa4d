"""Hybrid with Fusion (A 7): Hybrid scan by scan, and now and then Fusion of its whole map."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from .. import arrays
from ..arrays import Array, Segments, slips
from ._basic import check_match
from ._fusion import fuse
from ._hybrid import State, add, empty_map, least_length, replace_map
from ._runner import Indices, Reduction, Rows, Steps, rows_of, run_online


def hybrid_fusion(
    map: Segments,
    *,
    distance: float = 0.20,
    angle: float = np.pi / 18,
    min_length: float | None = None,
    tolerance: float = 0.04,
    every: int = 50,
) -> Reduction:
    """Let Fusion join what Hybrid has kept apart, every so many scans and at the end (A 7).

    Hybrid compares a new segment with those of the map, but never these with each other: once two
    pieces of a wall stand in the map, they stay two, however far they grow. Fusion replaces its
    map by chains. The thesis names the idea and leaves its details open: here a segment from Fusion
    stands for as many segments as all that went into it (their counts add up), so that it is as
    hard to turn; its rho and theta are its own, no mean of theirs; the map is listed as Fusion
    lists it, longest first.

    The errors of both add up: the quality of Hybrid alone asks for smaller thresholds than its.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        Scans come in ascending order.
    distance : float, metres
    angle : float, radians
    min_length : float, metres, or None
        As in `hybrid`.
    tolerance : float, metres
        As in `fusion`.
    every : int
        Scans between two Fusions, of those that have segments; more than there are: Fusion at the
        end only. With 50, the map of an office building stays at a third of Hybrid's all the way.
        From 10 to the end only, reduction at equal quality rises by less than 0.02 there, and time
        falls: each Fusion takes as long as the map is large.

    Returns
    -------
    Reduction
        Longest first; parents -1 for those that were too short; with seconds and segments in the
        map for each scan. The time of a Fusion belongs to the scan before it.

    Raises
    ------
    ValueError
        For coordinates that are not finite, thresholds out of range.

    Examples
    --------
    >>> from segmap.reduction import hybrid
    >>> wall = np.array([[(0, 0), (2, 0)], [(3, 0), (5, 0)], [(1.9, 0), (3.1, 0)]])
    >>> len(hybrid(wall)), len(hybrid_fusion(wall))
    (2, 1)
    """
    check_match(map, distance, angle)
    arrays.positive("metres", tolerance=tolerance)
    slips.check_lengths(map, tolerance=tolerance)
    every, least = arrays.whole(every, "every"), least_length(distance, min_length)
    return run_online(
        "hybrid_fusion", map, lambda rows: _steps(rows, distance, angle, least, tolerance, every)
    )


class LiveReduction:
    """The reduced map while scans come in: what `hybrid_fusion` makes of those so far.

    Parameters
    ----------
    distance, angle, min_length, tolerance, every
        As in `hybrid_fusion`; the last Fusion is that of the last full `every` scans.

    Raises
    ------
    ValueError
        For thresholds out of range.

    Examples
    --------
    >>> live = LiveReduction()
    >>> for x in (0.0, 0.9):
    ...     live.add([[(x, 0), (x + 1, 0)]])
    >>> live
    LiveReduction(2 scans: 1 segments)
    """

    def __init__(
        self,
        *,
        distance: float = 0.20,
        angle: float = np.pi / 18,
        min_length: float | None = None,
        tolerance: float = 0.04,
        every: int = 50,
    ) -> None:
        check_match(np.empty((0, 2, 2)), distance, angle)
        arrays.positive("metres", tolerance=tolerance)
        self.distance, self.angle, self.tolerance = distance, angle, tolerance
        self.min_length, self.every = (
            least_length(distance, min_length),
            arrays.whole(every, "every"),
        )
        self.scans, self._state = 0, empty_map(0, distance)

    def add(self, segments: Segments) -> None:
        """Take in the segments of one scan, `(n, 2, 2)`, metres; a scan without any is no scan.

        Raises
        ------
        ValueError
            For what are no segments.
        """
        new = rows_of(arrays.segments(segments))[0].segments
        if not len(new):
            return
        self._make_room(len(new))
        parents = np.empty(len(new), np.int64)
        add(self._state, new, 0, len(new), self.distance, self.angle, self.min_length, parents)
        self.scans += 1
        if self.scans % self.every == 0:
            _fuse_map(self._state, self.tolerance)

    @property
    def segments(self) -> Array:
        """The map now, `(m, 2, 2)` array, metres."""
        return self._state.s[: self._state.used[0]].copy()

    def _make_room(self, more: int) -> None:
        """Room for so many walls more; all that is known of the walls stays."""
        old, used = self._state, int(self._state.used[0])
        if used + more > len(old.s):
            state = empty_map(2 * (used + more), self.distance)
            replace_map(state, old.s[:used], old.lines[:used, 2].copy())
            self._state = state

    def __repr__(self) -> str:
        return f"LiveReduction({self.scans} scans: {self._state.used[0]} segments)"


def _steps(
    rows: Rows, distance: float, angle: float, min_length: float, tolerance: float, every: int
) -> Steps:
    state = empty_map(len(rows.segments), distance)
    parents = np.full(len(rows.segments), -1, np.int64)
    moves: list[tuple[int, Indices]] = []  # inputs so far, where each segment of the map went
    for done, (first, stop) in enumerate(rows.scans(), 1):
        add(state, rows.segments, first, stop, distance, angle, min_length, parents)
        if done % every == 0 or stop == len(rows.segments):
            moves.append((stop, _fuse_map(state, tolerance)))
        yield int(state.used[0])
    return state.s[: state.used[0]].copy(), _followed(parents, moves)


def _fuse_map(state: State, tolerance: float) -> Indices:
    """Replace the map by its Fusion; where each wall went, -1 for one without length."""
    live, count = rows_of(state.s[: state.used[0]])
    fused, into = fuse(live.segments, tolerance)
    counts = np.bincount(into, state.lines[live.row, 2]).astype(float)
    replace_map(state, fused, counts)
    moved = np.full(count, -1, np.int64)
    moved[live.row] = into
    return moved


def _followed(parents: Indices, moves: list[tuple[int, Indices]]) -> Indices:
    """Parents `(n,)` in the last map, given the moves: (inputs so far, where each segment went).

    From the last move back, so that each costs its own map and its own inputs, not all before.
    """
    carried = np.append(np.arange(len(parents)), -1)  # its last element: what was dropped stays so
    borders = [0, *(stop for stop, _ in moves)]
    for (first, stop), (_, moved) in reversed(list(zip(pairwise(borders), moves, strict=True))):
        carried = np.append(carried[moved], -1)
        parents[first:stop] = carried[parents[first:stop]]
    return parents
