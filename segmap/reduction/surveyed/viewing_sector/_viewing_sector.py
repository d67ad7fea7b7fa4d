"""The viewing sector (A 2.7.5): each scan confirms, hides or removes what the map has there."""

from __future__ import annotations

import numpy as np

from ....arrays import Array, Metres, Segments, checked
from ....compiled import compiled
from ....segments import length, midpoint
from ..._index import LEVEL, empty_index
from ..._points import points_behind
from ..._runner import Indices, Length, Reduction, Rows, Steps, run_online
from ._look_kernels import SAME, Claims, Room, Walls, look
from ._map import Map, nearby, put_back, tidy
from ._renew_kernels import renew

#: The order of the map is numbered anew where a piece has less of it as its own.
NARROW = 2.0**-24


@checked
def viewing_sector(
    map: Segments,
    *,
    distance: Metres = 0.10,
    min_length: Length = 0.10,
    forget: bool = True,
    rejoin: bool = True,
    spacing: Metres = 0.05,
) -> Reduction:
    """Compare each segment with what a scan has in its sector (A 2.7.5; Gonzalez et al. 1994).

    From its place the sensor sees a segment of the map inside a sector. A stretch of the scan in
    this sector and within `distance` of its line matches: its points join those of the segment,
    whose line is fitted anew. A stretch nearer to the sensor hides it. A stretch behind it saw
    through it: what no other stretch matches or hides is removed. It is the only method here that
    forgets, hence the only one for buildings that change; but an error of the pose erases walls,
    and two segments of the map are never compared with each other.

    A cuts each segment into its matched, hidden and unseen pieces and keeps each, which makes maps
    longer; `rejoin` keeps them as one, and is ours. So are `min_length` and the order of the map.

    Parameters
    ----------
    map : SegmentMap
        With the places of the sensor, and best with points: `build_map(..., keep_points=True)`.
        Scans come in ascending order.
    distance
        A stretch of the scan nearer than this to a line matches it (A's delta): 0.10 m is wider
        than the noise of a pose and narrower than an open door.
    min_length
        Shorter pieces are neither removed nor added.
    forget
        Whether to remove what was seen through.
    rejoin
        False cuts the map at the ends of what was matched, as A does.
    spacing
        As in `weighted_line_fitting`.

    Returns
    -------
    Reduction
        In the order of the map: pieces where their segment was, then what each scan added. A
        segment that ends in several pieces has the one as parent that holds most of it; -1 for one
        that was removed, or is too short; with seconds and segments in the map for each scan.

    Raises
    ------
    ValueError
        For a map without places of the sensor.

    References
    ----------
    Gonzalez, Ollero, Reina, "Map building for a mobile robot equipped with a 2D laser rangefinder",
    ICRA 1994.

    Examples
    --------
    >>> from segmap import SegmentMap
    >>> door = [[(-2, 3), (2, 3)], [(-2, 3), (-1, 3)], [(1, 3), (2, 3)], [(-2, 5), (2, 5)]]
    >>> found = viewing_sector(SegmentMap(door, [0, 1, 1, 1], sensors=[(0, 0), (0, 0)]))
    >>> found.segments[:, :, 0].round(6), found.parents
    (array([[-2., -1.],
           [ 1.,  2.],
           [-2.,  2.]]), array([0, 0, 1, 2]))
    """
    least = max(min_length, 10 * SAME)

    def steps(rows: Rows) -> Steps:
        points, first, sensors, kept = points_behind(map, rows, None)
        if np.isnan(sensors).any():
            raise ValueError(
                "map must tell where its sensor was: build_map(log, poses, keep_points=True) does, "
                "or SegmentMap(segments, scan, sensors=...)"
            )
        a, b = (rows.segments - sensors[:, None]).swapaxes(0, 1)
        turned = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0  # ends as the sensor sees them clockwise
        s = np.where(turned[:, None, None], rows.segments[:, ::-1], rows.segments)
        sums = _sums_of_points(points, first) if kept else _sums_along(s, spacing)
        most = int(np.diff(rows.cuts).max(initial=0))  # segments of a scan
        state = _map_for(64, float(length(s).mean()) if len(s) else 1.0)
        after, nodes, used, own = _walls_for(0), 0, 0, 1.0
        claims, room = _claims_for(64, 64), _room_for(most, 64, 64)
        # where the length of each input went: rows of `family` have the parent of a node, -1 for
        # none, and the share of it that the node is; rows of `given` an input, a node, and metres
        family, given = [np.empty((0, 2))], [np.empty((0, 3))]
        for begin, stop in rows.scans():
            p, scan = sensors[begin], Walls(s[begin:stop], sums[begin:stop], np.arange(begin, stop))
            count = nearby(state, used, scan, p, distance)
            if count >= len(room.first):
                room = _room_for(most, len(room.after), 2 * count)
            walls = _first(state.near, count)
            found = look(walls, scan, p, distance, least, forget, room, claims)
            if found[0] > len(claims.wall) or found[1] > len(claims.gone):
                claims = _claims_for(2 * found[0] + 64, 2 * found[1] + 64)
                room = _room_for(most, 2 * found[0] + 64, len(room.first))
                look(walls, scan, p, distance, least, forget, room, claims)
            n, m = count + found[1] + 4 * found[0] + stop - begin, 2 * found[0] + stop - begin
            if used + n > len(state.places) or own < NARROW:
                order = _in_order(state)
                into = _map_for(2 * (len(order) + n), state.boxes.unit)
                tidy(state, order, into)
                state, used = into, len(order)
                nearby(state, used, scan, p, distance)
            after = after if len(after.s) >= n else _walls_for(2 * n)
            tree, gifts = np.empty((n, 2)), np.empty((m, 3))
            n, more, m = renew(
                walls, scan, p, claims, found, least, rejoin, room, after, nodes, tree, gifts
            )
            used, own = put_back(state, used, count, claims, found, room.first, after, n)
            family.append(tree[:more])
            given.append(gifts[:m])
            nodes += more
            yield int(state.boxes.levels[-1, 0])
        nodes_of, gifts = np.concatenate(family), np.concatenate(given)
        gifts = gifts[np.argsort(gifts[:, 1], kind="stable")]
        starts = np.searchsorted(gifts[:, 1], np.arange(len(nodes_of) + 1))
        held, longest, parents = np.zeros(len(s)), np.zeros(len(s)), np.full(len(s), -1)
        order = _in_order(state)
        _weigh(state.walls.node[order], nodes_of, starts, gifts, held, longest, parents)
        return state.walls.s[order], parents

    return run_online("viewing_sector", map, steps, splits=True)


def _walls_for(count: int) -> Walls:
    return Walls(np.empty((count, 2, 2)), np.empty((count, 6)), np.empty(count, np.int64))


def _first(walls: Walls, count: int) -> Walls:
    return Walls(walls.s[:count], walls.sums[:count], walls.node[:count])


def _map_for(count: int, unit: float) -> Map:
    """An empty map with room for so many walls, about a unit of metres long."""
    lines, places = np.empty((count, 3)), np.empty((count, 2))
    rows, near = np.empty(2 * count + 1, np.int64), _walls_for(count)
    return Map(_walls_for(count), lines, places, empty_index(count, unit), rows, near)


def _in_order(state: Map) -> Indices:
    """The rows of the walls, in the order of the map."""
    rows = np.flatnonzero(state.boxes.link[:, LEVEL] >= 0)
    return rows[np.argsort(state.places[rows, 0])]


def _claims_for(stretches: int, pieces: int) -> Claims:
    """Room for what a scan says."""
    wall, segment = np.empty((2, stretches), np.int64)
    gone_of, gone = np.empty(pieces, np.int64), np.empty((pieces, 2))
    return Claims(wall, segment, np.empty((stretches, 5)), gone_of, gone)


def _room_for(c: int, q: int, walls: int) -> Room:
    """Room to work in, for a scan of c segments, that makes at most q claims on so many walls."""
    return Room(
        marks=np.empty((3 * c, 6)),
        cuts=np.empty(6 * c + 2 * q + 2),
        head=np.empty(c, np.int64),
        after=np.empty(q, np.int64),
        stretch=np.empty((c + 2 * q, 2)),
        owner=np.empty((c + 2 * q, 3), np.int64),
        first=np.empty(walls + 1, np.int64),
        arcs=empty_index(2 * c, 4 / max(c, 1)),
        arc=np.zeros((2, 2)),
        beside=np.empty(2 * c + 1, np.int64),
        seen=np.empty(c, np.int64),
    )


def _sums_of_points(points: Array, first: Indices) -> Array:
    """Running sums of the points of each segment, `(n, 6)`."""
    count = np.diff(first)
    mean = np.add.reduceat(points, first[:-1]) / count[:, None]
    x, y = (points - np.repeat(mean, count, axis=0)).T
    spread = np.add.reduceat(np.column_stack([x * x, x * y, y * y]), first[:-1])
    return np.column_stack([count, mean, spread])


def _sums_along(s: Array, spacing: float) -> Array:
    """Running sums of points evenly along each segment: as many as the spacing, metres, puts."""
    (x, y), n = (s[:, 1] - s[:, 0]).T, length(s) / spacing
    return np.column_stack([n, midpoint(s), x * x * n / 12, x * y * n / 12, y * y * n / 12])


@compiled
def _weigh(
    leaves: Indices,
    family: Array,
    first: Indices,
    given: Array,
    held: Array,
    most: Array,
    parents: Indices,
) -> None:
    """The leaf that holds most metres of each input, -1 for none; ties: the first.

    Walks from each leaf up to its root.
    """
    for k in range(len(leaves)):
        for again in range(2):
            node, part = leaves[k], 1.0
            while node >= 0:
                for i in range(first[node], first[node + 1]):
                    j = int(given[i, 0])
                    if again == 0:
                        held[j] += part * given[i, 2]
                    else:
                        if held[j] > most[j] + SAME or (parents[j] < 0 and held[j] > 0.0):
                            most[j], parents[j] = held[j], k
                        held[j] = 0.0
                part *= family[node, 1]
                node = int(family[node, 0])
