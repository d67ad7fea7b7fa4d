"""Hybrid with Fusion (A 7): Hybrid scan by scan, and now and then Fusion of its whole map."""

from dataclasses import replace

import numpy as np

from ..arrays import Segments
from . import _hybrid_loops as loops
from ._fusion import fusion
from ._hybrid import Indices, run_scans
from ._result import Reduction, check_tolerance


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
    check_tolerance(tolerance)
    if not (every >= 1 and every % 1 == 0):
        raise ValueError(f"every must be a whole number of scans, at least 1, got {every}")

    def after_scan(state: loops.State, done: int, scans: int) -> tuple[loops.State, Indices | None]:
        """The state after Fusion, and where its segments went, `(n,)`; unchanged between times."""
        if done % every and done < scans:
            return state, None
        fused = fusion(state.s[: state.used[0]], tolerance=tolerance)
        kept = fused.parents >= 0
        counts = np.bincount(fused.parents[kept], state.lines[: len(kept), 2][kept]).astype(float)
        return loops.replace_map(state, fused.segments, counts, distance), fused.parents

    return replace(run_scans(map, distance, angle, min_length, after_scan), method="hybrid_fusion")
