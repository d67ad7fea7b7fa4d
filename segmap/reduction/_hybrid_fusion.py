"""Hybrid with Fusion (A 7): Hybrid scan by scan, and now and then Fusion of its whole map."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from .. import arrays
from ..arrays import Array, Count, Metres, Segments, checked
from ..threads import Locked, locked
from ._fusion import fuse
from ._hybrid import State, add_segments, empty_map, origin_doubt, replace_map
from ._runner import Indices, Length, Reduction, Rows, Steps, Turn, rows_of, run_online

#: More segments take more than ten seconds: it warns.
MOST_SEGMENTS = 200_000


@checked
def hybrid_fusion(
    map: Segments,
    *,
    distance: Metres = 0.20,
    angle: Turn = np.pi / 18,
    min_length: Length = 0.10,
    origin: Literal["map", "pair"] = "map",
    tolerance: Metres = 0.04,
    every: Count = 50,
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
    map : SegmentMap, Reduction or (n, 2, 2) array
        Scans come in ascending order.
    distance, angle, min_length, origin
        As in `hybrid`.
    tolerance
        As in `fusion`.
    every
        Scans between two Fusions, of those that have segments; more than there are: Fusion at the
        end only. With 50, the map of an office building stays at a third of Hybrid's all the way.
        From 10 to the end only, reduction at equal quality rises by less than 0.02 there, and time
        falls: each Fusion takes as long as the map is large. So the cost grows with the square of
        the segments: 1.3 s for 80 000. Maps with more than 200 000 are warned of.

    Returns
    -------
    Reduction
        Longest first; parents -1 for those that were too short; with seconds and segments in the
        map for each scan. The time of a Fusion belongs to the scan before it.

    Examples
    --------
    >>> from segmap.reduction import hybrid
    >>> wall = np.array([[(0, 0), (2, 0)], [(3, 0), (5, 0)], [(1.9, 0), (3.1, 0)]])
    >>> len(hybrid(wall)), len(hybrid_fusion(wall))
    (2, 1)
    """

    rule = distance, angle, min_length, origin == "pair"

    def steps(rows: Rows) -> Steps:
        state, s = empty_map(len(rows.segments), distance), rows.segments
        parents = np.empty(len(s), np.int64)
        for done, (first, stop) in enumerate(rows.scans(), 1):
            add_segments(state, s, first, stop, rule, parents)
            if done % every == 0 or stop == len(s):
                moved = np.append(_fuse_map(state, tolerance), -1)  # what was dropped stays so
                parents[:stop] = moved[parents[:stop]]
            yield int(state.used[0])
        return state.s[: state.used[0]].copy(), parents

    reduction = run_online("hybrid_fusion", map, steps, most_segments=MOST_SEGMENTS)
    return replace(reduction, doubt=origin_doubt(map, origin))


class LiveReduction(Locked):
    """The reduced map while scans come in: what `hybrid_fusion` makes of those so far.

    With its thresholds; the last Fusion is that of the last full `every` scans.

    Examples
    --------
    >>> live = LiveReduction()
    >>> for x in (0.0, 0.9):
    ...     live.add([[(x, 0), (x + 1, 0)]])
    >>> live
    LiveReduction(2 scans: 1 segments)
    """

    scans = 0

    @checked
    def __init__(
        self,
        *,
        distance: Metres = 0.20,
        angle: Turn = np.pi / 18,
        min_length: Length = 0.10,
        origin: Literal["map", "pair"] = "map",
        tolerance: Metres = 0.04,
        every: Count = 50,
    ) -> None:
        self.distance, self.tolerance, self.every = distance, tolerance, every
        self.rule = distance, angle, min_length, origin == "pair"
        self._state = empty_map(0, distance)

    @locked
    def add(self, segments: Segments) -> None:
        """Take in the segments of one scan, `(n, 2, 2)`, metres; a scan without any is no scan."""
        new = rows_of(arrays.segments(segments))[0].segments
        if not len(new):
            return
        state, used = self._state, int(self._state.used[0])
        if used + len(new) > len(state.s):  # room for more walls; all that is known of them stays
            self._state = empty_map(2 * (used + len(new)), self.distance)
            replace_map(self._state, state.s[:used], state.lines[:used, 2].copy())
        add_segments(self._state, new, 0, len(new), self.rule, np.empty(len(new), np.int64))
        self.scans += 1
        if self.scans % self.every == 0:
            _fuse_map(self._state, self.tolerance)

    @property
    @locked
    def segments(self) -> Array:
        """The map now, `(m, 2, 2)` array, metres."""
        return self._state.s[: self._state.used[0]].copy()

    @locked
    def __repr__(self) -> str:
        return f"LiveReduction({self.scans} scans: {self._state.used[0]} segments)"


def _fuse_map(state: State, tolerance: float) -> Indices:
    """Replace the map by its Fusion; where each wall went, -1 for one without length."""
    live, count = rows_of(state.s[: state.used[0]])
    fused, into = fuse(live.segments, tolerance)
    counts = np.bincount(into, state.lines[live.source_row, 2]).astype(float)
    replace_map(state, fused, counts)
    moved = np.full(count, -1, np.int64)
    moved[live.source_row] = into
    return moved
