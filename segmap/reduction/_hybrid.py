"""Hybrid (A 4.2, 5.4): near in the map and near in Hough space, scan by scan."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np

from .. import arrays
from ..arrays import Array, Metres, Segments, checked
from ..compiled import compiled
from ..kernels import length_of, off_segment, place_on_line, span
from ._hough import hough_line_of
from ._index import Index, empty_index, enter, meeting, take_out
from ._runner import Indices, Length, Reduction, Rows, Steps, Turn, run_online

#: Distances closer than this, in metres, are equal: rounding must not choose between two walls.
HYBRID_ROUNDING_M = 1e-9
#: Smallest side of the cells of the index, metres.
LEAST_CELL_M = 0.4
#: Side of the cells in distances: of four sides tried on 43 000 segments of Intel the fastest or
#: close to it at 20, 100 and 400 mm.
CELL_DISTANCES = 4
#: Thresholds: distance, metres, angle, radians, least length, and whether rho is of each pair.
Rule = tuple[float, float, float, bool]


@checked
def hybrid(
    map: Segments,
    *,
    distance: Metres = 0.20,
    angle: Turn = np.pi / 18,
    min_length: Length = 0.10,
    origin: Literal["map", "pair"] = "map",
) -> Reduction:
    """Let each new segment go into the nearest one of the map whose line agrees (A 4.2).

    A line is the distance rho of the origin from it and the angle theta of its normal. A segment of
    the map is near when an end point of the new one is closer than `distance` to one of its end
    points, or to the segment beside it. The nearest whose rho and theta differ by less than
    `distance` and `angle` takes the new one in: its rho and theta become means weighted by the
    number of segments that it stands for. A new segment without such a match joins the map, unless
    it is shorter than `min_length`.

    Rho depends on the origin: moving the map changes the result, turning it about the origin does
    not. A wall twenty metres from the foot of its normal may lean by half a degree and not by
    `angle`, so the farther the origin is, the less merges.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Scans come in ascending order.
    distance
        How far an end, and rho, may be from another's: 0.20 m is A's middle value, wider than
        noise, narrower than a door.
    angle
        Largest difference of two directions that match: 10 degrees is A's smallest.
    min_length
        The filter that A builds in. It is useless after A's own filter of 0.10 m (A 6.3), so A's
        is fixed and no longer than that.
    origin
        A takes rho about the origin of the map. "pair" takes it about the mean of both middles,
        weighted by length: then the result moves with the map, and on four buildings 8 to 51 %
        fewer segments are left at the same quality of .80 to .90.

    Returns
    -------
    Reduction
        In the order in which segments joined; parents -1 for those that were too short; with
        seconds and segments in the map for each scan. `doubt` says so where the origin lies outside
        of the map.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (3, 0)], [(1, 0.02), (2, 0.02)], [(9, 0), (9.05, 0)]])
    >>> reduction = hybrid(wall)
    >>> reduction, reduction.parents
    (Reduction(hybrid: 3 -> 1 segments), array([ 0,  0, -1]))
    >>> hybrid(wall + [50, 20]).doubt[:42]
    'the origin lies 53.9 m outside of the map,'
    """

    rule = distance, angle, min_length, origin == "pair"

    def steps(rows: Rows) -> Steps:
        state = empty_map(len(rows.segments), distance)
        parents = np.empty(len(rows.segments), np.int64)
        for first, stop in rows.scans():
            add_segments(state, rows.segments, first, stop, rule, parents)
            yield int(state.used[0])
        return state.s[: state.used[0]].copy(), parents

    return replace(run_online("hybrid", map, steps), doubt=origin_doubt(map, origin))


def origin_doubt(map: Segments, origin: Literal["map", "pair"]) -> str:
    """Why Hybrid may not suit a map: its origin lies outside of it; nothing where it does not."""
    ends = arrays.segments(map).reshape(-1, 2)
    if origin == "pair" or not len(ends):
        return ""
    outside = np.hypot(*np.maximum(0, np.maximum(ends.min(axis=0), -ends.max(axis=0))))
    if not outside:
        return ""
    return (
        f"the origin lies {outside:.1f} m outside of the map, and rho is taken about it: the "
        'farther it is, the less merges; origin="pair" takes it about each pair of walls'
    )


class State(NamedTuple):
    """The map of Hybrid: walls, their lines, and an index of the walls.

    For maps of 1 000, 3 604, 10 000 and 100 000 segments, each wall seen three times, this takes
    1.6, 5.6, 14 and 131 ms; a look at all walls takes 1.7, 9.7, 50 and 3710 ms.
    """

    s: Array  # (n, 2, 2), metres
    lines: Array  # (n, 3) rho, metres, theta, radians, and how many segments each wall stands for
    used: Indices  # (1,) how many walls there are
    places: Index
    near: Indices  # room for what lies near


def empty_map(count: int, distance: float) -> State:
    """A map with room for so many segments."""
    s, lines, used = np.empty((count, 2, 2)), np.empty((count, 3)), np.zeros(1, np.int64)
    near = np.empty(count + 1, np.int64)
    return State(
        s, lines, used, empty_index(count, max(CELL_DISTANCES * distance, LEAST_CELL_M)), near
    )


@compiled
def _origin(wall: Array, new: Array, pair: bool) -> tuple[float, float]:
    """Where rho is taken: that of the map, or the mean of both middles, weighted by length."""
    if not pair:
        return 0.0, 0.0
    share = length_of(new) / (length_of(wall) + length_of(new)) / 2
    x = (0.5 - share) * (wall[0, 0] + wall[1, 0]) + share * (new[0, 0] + new[1, 0])
    y = (0.5 - share) * (wall[0, 1] + wall[1, 1]) + share * (new[0, 1] + new[1, 1])
    return x, y


@compiled
def _nearest_match(state: State, new: Array, i: int, rho: float, theta: float, rule: Rule) -> int:
    """The nearest wall whose line agrees with that of i; ties: lowest index; -1 for none."""
    distance, angle, _, pair = rule
    lines, best, least = state.lines, -1, distance - HYBRID_ROUNDING_M
    for m in range(meeting(state.places, new[i], distance, state.near)):
        b = state.near[m]
        if pair or abs(abs(lines[b, 0]) - abs(rho)) < distance:
            turns = round((lines[b, 1] - theta) / np.pi)
            sign = 1.0 if turns % 2 == 0 else -1.0
            x, y = _origin(state.s[b], new[i], pair)
            apart = lines[b, 0] - sign * rho
            apart -= x * (np.cos(lines[b, 1]) - sign * np.cos(theta))
            apart -= y * (np.sin(lines[b, 1]) - sign * np.sin(theta))
            turn = abs(lines[b, 1] - theta - turns * np.pi)
            if abs(apart) < distance - HYBRID_ROUNDING_M and turn < angle - HYBRID_ROUNDING_M:
                # A 4.2: four end-point distances, and those of ends of i beside b
                wall, (ax, ay), (bx, by) = state.s[b], new[i, 0], new[i, 1]
                near = min(off_segment(ax, ay, wall), off_segment(bx, by, wall))
                tie = abs(near - least) <= HYBRID_ROUNDING_M and best >= 0
                if b < best if tie else near < least:
                    best, least = b, near
    return best


@compiled
def _absorb_in_wall(
    state: State, b: int, new: Array, i: int, rho: float, theta: float, pair: bool
) -> None:
    """A 4.2: count-weighted means of both lines; the extreme projections on it, metres, remain.

    Wall b takes in segment i, whose line is rho, metres, and theta, radians.
    """
    s, lines, count = state.s, state.lines, state.lines[b, 2]
    turns = round((lines[b, 1] - theta) / np.pi)
    sign = 1.0 if turns % 2 == 0 else -1.0
    mean = (count * lines[b, 1] + theta + turns * np.pi) / (count + 1)
    nx, ny = np.cos(mean), np.sin(mean)
    old, one = count / (count + 1), sign / (count + 1)
    rho = (count * lines[b, 0] + sign * rho) / (count + 1)
    x, y = _origin(s[b], new[i], pair)
    rho += x * (nx - old * np.cos(lines[b, 1]) - one * np.cos(theta))
    rho += y * (ny - old * np.sin(lines[b, 1]) - one * np.sin(theta))
    lines[b, 0], lines[b, 1], lines[b, 2] = rho, mean, count + 1
    line = rho * nx, rho * ny, -ny, nx
    (low, high), (begin, end) = span(s[b], line), span(new[i], line)
    place_on_line(s[b], line, min(low, begin), max(high, end))
    take_out(state.places, b)
    enter(state.places, b, s[b], 0.0)


@compiled
def _append_wall(state: State, new: Array, i: int, count: float) -> None:
    """Segment i, which stands for so many, becomes the next wall; metres."""
    b = state.used[0]
    for k in range(2):
        state.s[b, k, 0], state.s[b, k, 1] = new[i, k, 0], new[i, k, 1]
    state.lines[b, 0], state.lines[b, 1] = hough_line_of(new, i)
    state.lines[b, 2] = count
    state.used[0] += 1
    enter(state.places, b, new[i], 0.0)


@compiled
def add_segments(
    state: State, new: Array, first: int, stop: int, rule: Rule, parents: Indices
) -> None:
    """Match the segments `first` to `stop` of `(n, 2, 2)` with the map; those without may join.

    Writes where each went, -1 where dropped, into `parents`, `(n,)`; metres.
    """
    for i in range(first, stop):
        rho, theta = hough_line_of(new, i)
        b = _nearest_match(state, new, i, rho, theta, rule)
        parents[i] = b
        if b >= 0:
            _absorb_in_wall(state, b, new, i, rho, theta, rule[3])
        elif length_of(new[i]) >= rule[2]:
            parents[i] = state.used[0]
            _append_wall(state, new, i, 1.0)


@compiled
def replace_map(state: State, segments: Array, counts: Array) -> None:
    """Put `(m, 2, 2)` segments, metres, that stand for `(m,)` counts in the place of the map."""
    for b in range(state.used[0]):
        take_out(state.places, b)
    state.used[0] = 0
    for i in range(len(segments)):
        _append_wall(state, segments, i, counts[i])
