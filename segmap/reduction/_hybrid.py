"""Hybrid (A 4.2, 5.4): near in the map and near in Hough space, scan by scan."""

import time

import numpy as np

from ..segments import Segments
from . import _hybrid_loops as loops
from ._result import Reduction, check_thresholds, runs, scans_of, whole_parents, with_length


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
    check_thresholds(distance, angle)
    least = distance if min_length is None else min_length
    if not least >= 0:
        raise ValueError(f"min_length must not be negative, in metres, got {min_length}")
    begun = time.perf_counter()
    segments, index = with_length(map)
    scan = scans_of(map)
    index = index[(order := np.argsort(scan[index], kind="stable"))]
    segments, parents = segments[order], np.full(len(index), -1, np.int64)
    state, ended, live = loops.start(len(index)), [time.perf_counter()], []
    for first, stop in runs(scan[index]):
        state = loops.with_room(state, segments[first:stop], 1.5 * distance)
        loops.add_scan(state, segments[first:stop], first, distance, angle, least, parents)
        ended.append(time.perf_counter())
        live.append(int(state.used[0]))
    found = state.s[: state.used[0]].copy()
    whole = whole_parents(len(scan), index, parents)
    seconds = time.perf_counter() - begun
    return Reduction(found, whole, seconds, "hybrid", np.diff(ended), np.array(live, np.int64))
