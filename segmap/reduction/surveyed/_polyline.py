"""Polylines (A 2.7.10): scan by scan, a chain of segments that match becomes a line with bends."""

from __future__ import annotations

import numpy as np

from ... import arrays
from ...arrays import Segments
from ...kernels import Rule, describe
from .._runner import Reduction, Rows, Steps, run_online
from ._polyline_map import add, empty_map, with_room


def polyline(
    map: Segments,
    *,
    tolerance: float = 0.05,
    distance: float = 0.05,
    far: float = 0.10,
    long: float = 0.30,
    bridge: float = 0.30,
) -> Reduction:
    """Replace chains of matching segments of the map and a scan by polylines (A 2.7.10).

    A segment of the scan and one of the map match where `alignment.match_values` is above 0;
    segments that match one after another are a chain. Its polyline begins as the line between the
    two end points that are farthest apart. While a segment of the chain is `tolerance` or more
    from its nearest piece (A 2.39), the farthest one is put in the place of that piece, with links
    to both neighbours. Then inner corners are left out, the first that can go each time, while
    every segment stays within the tolerance. Links longer than `bridge` that are the nearest piece
    of no segment are left out too: nobody saw such a wall.

    Segments of one scan are never compared: without scans the map stays as it is. A polyline runs
    through end points, not through the middle of its segments, so noise stays; it is made for
    curved and angled walls, and for maps that are drawn as outlines.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        Scans come in ascending order.
    tolerance : float, metres
        A's error threshold, without a value: 0.05 m is the noise of a wall seen from many poses.
    distance, far, long : float, metres
        As in `alignment.match_values`.
    bridge : float, metres
        May be infinite, which is A's method.

    Returns
    -------
    Reduction
        Chains in the order of their first segments in the map, each from one end to the other.
        Parents name the piece that a segment was nearest to, scan after scan; a link may be the
        parent of none.

    Raises
    ------
    ValueError
        For coordinates that are not finite, thresholds out of range.

    References
    ----------
    Amigoni, Gasparini, Gini, "Building segment-based maps without pose information", Proceedings
    of the IEEE 94, 2006.

    Examples
    --------
    >>> from segmap import SegmentMap
    >>> bend = [[(0, 0), (1, 0)], [(0.9, 0.02), (2, 0.3)], [(1.8, 0.3), (3, 0.3)]]
    >>> found = polyline(SegmentMap(bend, scan=[0, 1, 0]), tolerance=0.10)
    >>> found, found.segments[:, 1].round(6).tolist()
    (Reduction(polyline: 3 -> 3 segments), [[0.9, 0.02], [1.8, 0.3], [3.0, 0.3]])
    """
    lengths = {"tolerance": tolerance, "distance": distance, "far": far, "long": long}
    arrays.positive("metres", **lengths)
    arrays.number(bridge, "bridge", least=0, most=np.inf, unit="metres")
    rule = float(distance), float(far), float(long), False
    return run_online(
        "polyline",
        map,
        lambda rows: _steps(rows, rule, float(tolerance), float(bridge)),
        splits=True,
    )


def _steps(rows: Rows, rule: Rule, tolerance: float, bridge: float) -> Steps:
    new, n = rows.segments, len(rows.segments)
    state, links, pieces = empty_map(new, rule), np.empty((4, n), np.int64), np.empty(n, np.int64)
    about = describe(new)
    for first, stop in rows.scans():
        used, live = state.counts.tolist()
        state = with_room(state, used + 3 * (live + stop - first) + 1)
        add(state, new, about, first, stop, rule, tolerance, bridge, links, pieces)
        yield int(state.counts[1])
    into = state.into[: state.counts[0]]
    while (into[into] != into).any():
        into = into[into]
    order, piece = np.empty(int(state.counts[1]), np.int64), state.after[0]
    for k in range(len(order)):
        order[k], piece = piece, state.after[piece]
    place = np.full(len(into), -1)
    place[order] = np.arange(len(order))
    return state.s[order], place[into[pieces]]
