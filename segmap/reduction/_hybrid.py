"""Hybrid (A 4.2, 5.4): near in the map and near in Hough space, scan by scan."""

from __future__ import annotations

import numpy as np

from .. import arrays
from ..arrays import Segments
from . import _hybrid_loops as loops
from ._basic import check_match
from ._runner import Reduction, Rows, Steps, run_online


def hybrid(
    map: Segments,
    *,
    distance: float = 0.20,
    angle: float = np.pi / 18,
    min_length: float | None = None,
) -> Reduction:
    """Let each new segment go into the nearest one of the map whose line agrees (A 4.2).

    A line is the distance rho of the origin from it and the angle theta of its normal. A segment of
    the map is near when an end point of the new one is closer than `distance` to one of its end
    points, or to the segment beside it. The nearest whose rho and theta differ by less than
    `distance` and `angle` takes the new one in: its rho and theta become means weighted by the
    number of segments that it stands for. A new segment without such a match joins the map, unless
    it is shorter than `min_length`.

    Rho depends on the origin: moving the map can change the result, turning it about the origin
    cannot.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        Scans come in ascending order.
    distance : float, metres
        0.20 m is A's middle value: wider than noise, narrower than a door.
    angle : float, radians
        Above 0, at most pi/2; 10 degrees is A's smallest.
    min_length : float, metres, or None
        None takes `distance`: the filter that A builds in.

    Returns
    -------
    Reduction
        In the order in which segments joined; parents -1 for those that were too short; with
        seconds and segments in the map for each scan.

    Raises
    ------
    ValueError
        For coordinates that are not finite, thresholds out of range.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (3, 0)], [(1, 0.02), (2, 0.02)], [(9, 0), (9.1, 0)]])
    >>> found = hybrid(wall)
    >>> found, found.parents
    (Reduction(hybrid: 3 -> 1 segments), array([ 0,  0, -1]))
    """
    check_match(distance, angle)
    least = least_length(distance, min_length)
    return run_online("hybrid", map, lambda rows: _steps(rows, distance, angle, least))


def least_length(distance: float, min_length: float | None) -> float:
    """Length, metres, below which a segment without a match is dropped.

    Raises
    ------
    ValueError
        Naming the argument and what was expected.
    """
    if min_length is None:
        return distance
    return arrays.number(min_length, "min_length", least=0, unit="metres")


def _steps(rows: Rows, distance: float, angle: float, min_length: float) -> Steps:
    state = loops.start(len(rows.segments))
    parents = np.full(len(rows.segments), -1, np.int64)
    for first, stop in rows.scans():
        new = rows.segments[first:stop]
        state = loops.add_scan(state, new, first, distance, angle, min_length, parents)
        yield int(state.used[0])
    return state.s[: state.used[0]].copy(), parents
