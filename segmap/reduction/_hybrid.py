"""Hybrid (A 4.2, 5.4): near in the map and near in Hough space, scan by scan."""

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..arrays import Segments
from . import _hybrid_loops as loops
from ._result import Reduction, check_thresholds, runs, scans_of, whole_parents, with_length

Indices = NDArray[np.int64]

#: Called after each scan with the map, the scans so far and all scans. Returns the map, and where
#: each of its segments went, or None where all stayed.
AfterScan = Callable[[loops.State, int, int], tuple[loops.State, Indices | None]]


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
    return run_scans(map, distance, angle, min_length)


def run_scans(
    map: Segments,
    distance: float,
    angle: float,
    min_length: float | None,
    after_scan: AfterScan = lambda state, done, scans: (state, None),
) -> Reduction:
    """Hybrid, with something done to its map after each scan; the rest as in `hybrid`."""
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
    scans, moves = runs(scan[index]), []
    for done, (first, stop) in enumerate(scans, 1):
        new = segments[first:stop]
        state = loops.add_scan(state, new, first, distance, angle, least, parents)
        state, moved = after_scan(state, done, len(scans))
        moves += [] if moved is None else [(stop, moved)]
        ended.append(time.perf_counter())
        live.append(int(state.used[0]))
    found = state.s[: state.used[0]].copy()
    whole = whole_parents(len(scan), index, _followed(parents, moves))
    seconds = time.perf_counter() - begun
    return Reduction(found, whole, seconds, "hybrid", np.diff(ended), np.array(live, np.int64))


def _followed(parents: Indices, moves: list[tuple[int, Indices]]) -> Indices:
    """Parents `(n,)` in the last map, given the moves: (inputs so far, where each segment went).

    From the last move back, so that each costs its own map and its own inputs, not all before.
    """
    out = parents.copy()
    carried = np.append(np.arange(len(parents)), -1)  # its last element: what was dropped stays so
    starts = [0, *(stop for stop, _ in moves[:-1])]
    for first, (stop, moved) in reversed(list(zip(starts, moves, strict=False))):
        carried = np.append(carried[moved], -1)
        out[first:stop] = carried[out[first:stop]]
    return out
