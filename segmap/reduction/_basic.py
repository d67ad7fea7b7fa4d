"""Basic (A 4.1, 5.3): pairs with near end points and similar angles become one, again and again."""

import time
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Segments
from . import _basic_loops as loops
from ._result import Reduction, check_thresholds, runs, scans_of, whole_parents, with_length


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
    none = np.zeros(len(arrays.segments(map, "map")), np.int64)
    found = _basic(map, none, distance, angle)
    return replace(found, method="basic_offline", scan_seconds=None, scan_live=None)


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
    return _basic(map, scans_of(map), distance, angle)


def _basic(map: Segments, scan: NDArray[np.int64], distance: float, angle: float) -> Reduction:
    check_thresholds(distance, angle)
    start = time.perf_counter()
    segments, index = with_length(map)
    index = index[(order := np.argsort(scan[index], kind="stable"))]
    state, ended, live = loops.start(segments[order]), [time.perf_counter()], [0]
    for first, stop in runs(scan[index]):
        died = loops.converge(state, first, stop, distance, angle)
        ended.append(time.perf_counter())
        live.append(live[-1] + stop - first - died)
    parents = whole_parents(len(scan), index, _outputs(state))
    found = state.s[state.alive]
    seconds = time.perf_counter() - start
    return Reduction(found, parents, seconds, "basic_online", np.diff(ended), np.array(live[1:]))


def _outputs(state: loops.State) -> NDArray[np.int64]:
    """Output that each segment went into, through however many merges."""
    parents = state.parents
    while not state.alive[parents].all():
        parents = parents[parents]
    return (np.cumsum(state.alive) - 1)[parents]
