"""Basic (A 4.1, 5.3): pairs with near end points and similar angles become one, again and again."""

from __future__ import annotations

import numpy as np

from .. import arrays
from ..arrays import Segments
from . import _basic_loops as loops
from ._runner import Found, Reduction, Rows, Steps, run, run_online


def basic_offline(map: Segments, *, distance: float = 0.20, angle: float = np.pi / 18) -> Reduction:
    """Merge pairs of segments of the whole map until none matches (A 4.1).

    Two segments match when some pair of their end points is closer than `distance` and their angles
    differ by less than `angle`. They become the span of their four end points on the mean line,
    weighted by length. The order is part of the method: each segment in turn takes in all that
    match it as it grows; passes are repeated until one merges nothing. A long wall and a piece of
    its middle have far end points, and are never merged.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        The scans of a map are ignored.
    distance : float, metres
        0.20 m is A's middle value: wider than noise, narrower than a door.
    angle : float, radians
        Above 0, at most pi/2; 10 degrees is A's smallest.

    Returns
    -------
    Reduction
        In the order of the segments that took the others in.

    Raises
    ------
    ValueError
        For coordinates that are not finite, thresholds out of range.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (1, 0)], [(1.1, 0), (2, 0)], [(0, 0), (0, 1)]])
    >>> found = basic_offline(wall)
    >>> found, found.parents
    (Reduction(basic_offline: 3 -> 2 segments), array([0, 0, 1]))
    """
    check_match(distance, angle)
    return run("basic_offline", map, lambda rows: _offline(rows, distance, angle))


def basic_online(map: Segments, *, distance: float = 0.20, angle: float = np.pi / 18) -> Reduction:
    """Basic after every scan: its segments join the map, which then converges (A 4.1).

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array, metres
        Scans come in ascending order; without scans this is `basic_offline`.
    distance : float, metres
    angle : float, radians
        As in `basic_offline`.

    Returns
    -------
    Reduction
        In the order in which segments joined; with seconds and live segments for each scan.

    Raises
    ------
    ValueError
        As in `basic_offline`.

    Examples
    --------
    >>> from segmap import SegmentMap
    >>> wall = SegmentMap([[(0, 0), (1, 0)], [(1.1, 0), (2, 0)], [(0, 0), (0, 1)]], scan=[0, 1, 1])
    >>> basic_online(wall).scan_live
    array([1, 2])
    """
    check_match(distance, angle)
    return run_online("basic_online", map, lambda rows: _online(rows, distance, angle))


def check_match(distance: float, angle: float) -> None:
    """Refuse a distance that is not positive, metres, or an angle beyond a quarter turn, radians.

    Raises
    ------
    ValueError
        Naming the argument and what was expected.
    """
    arrays.positive("metres", distance=distance)
    arrays.number(angle, "angle", above=0, most=np.pi / 2, unit="radians")


def _offline(rows: Rows, distance: float, angle: float) -> Found:
    state = loops.start(rows.segments)
    loops.converge(state, 0, len(rows.segments), distance, angle)
    return _outputs(state)


def _online(rows: Rows, distance: float, angle: float) -> Steps:
    state, live = loops.start(rows.segments), 0
    for first, stop in rows.scans():
        live += stop - first - loops.converge(state, first, stop, distance, angle)
        yield live
    return _outputs(state)


def _outputs(state: loops.State) -> Found:
    """The live segments, and which of them each segment went into, through however many merges."""
    parents = state.parents
    while not state.alive[parents].all():
        parents = parents[parents]
    return state.s[state.alive], (np.cumsum(state.alive) - 1)[parents]
