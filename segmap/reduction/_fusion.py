"""Fusion (A 4.4, 5.6): the longest chain of segments in a strip around the longest segment.

A moves the line greedily and can miss the best strip; the sweep over all shifts is exact.
"""

from __future__ import annotations

from .. import arrays
from ..arrays import Segments
from . import _fusion_loops as loops
from ._runner import Reduction, run


def fusion(map: Segments, *, tolerance: float = 0.04) -> Reduction:
    """Replace chains of segments inside a strip by one segment each (A 4.4, 5.6).

    Until the map is empty: take the longest segment; among the lines parallel to it that keep it
    within `tolerance`, find the one whose strip holds the chain of greatest total length through
    it; emit the span of that chain on that line. A chain is a connected set of overlapping
    projections. There is no test of angles: a short stub across the wall is swallowed.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
    tolerance : float, metres
        Half width of the strip. 0.04 m is about the spread of one wall seen from many poses; A
        finds that quality falls quickly beyond 0.06 m.

    Returns
    -------
    Reduction
        Longest first.

    Raises
    ------
    ValueError
        For coordinates that are not finite, a tolerance that is not positive and finite.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(1.5, 0.03), (3, 0.03)], [(5, 0), (6, 0)]]
    >>> result = fusion(wall)
    >>> result, result.parents
    (Reduction(fusion: 3 -> 2 segments), array([0, 0, 1]))
    >>> result.segments[0].round(6)
    array([[0., 0.],
           [3., 0.]])
    """
    arrays.positive("metres", tolerance=tolerance)
    return run("fusion", map, lambda rows: loops.fuse(rows.segments, tolerance))
