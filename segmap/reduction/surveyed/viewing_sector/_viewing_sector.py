"""The viewing sector (A 2.7.5): each scan confirms, hides or removes what the map has there."""

from __future__ import annotations

import numpy as np

from .... import arrays
from ....arrays import Array, Segments
from ....compiled import compiled
from ..._points import check_spacing, points_behind
from ..._runner import Indices, Reduction, Rows, Steps, run_online
from ._map import renew
from ._views import SAME, Claims, Room, Walls, look


def viewing_sector(
    map: Segments,
    *,
    distance: float = 0.10,
    min_length: float = 0.10,
    forget: bool = True,
    rejoin: bool = True,
    spacing: float = 0.05,
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
    distance : float, metres
        A's delta: 0.10 m is wider than the noise of a pose and narrower than an open door.
    min_length : float, metres
        Shorter pieces are neither removed nor added.
    forget : bool
        Whether to remove what was seen through.
    rejoin : bool
        False cuts the map at the ends of what was matched, as A does.
    spacing : float, metres
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
        For a map without places of the sensor, coordinates that are not finite, thresholds out of
        range.

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
    arrays.positive("metres", distance=distance)
    arrays.number(min_length, "min_length", least=0, unit="metres")
    check_spacing(spacing)
    limits = (
        float(distance),
        max(float(min_length), 10 * SAME),
        _flag(forget, "forget"),
        _flag(rejoin, "rejoin"),
    )
    return run_online(
        "viewing_sector", map, lambda rows: _steps(map, rows, limits, spacing), splits=True
    )


def _flag(value: object, name: str) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} must be True or False, got {value!r}")
    return bool(value)


def _steps(
    map: Segments, rows: Rows, limits: tuple[float, float, bool, bool], spacing: float
) -> Steps:
    points, first, sensors, kept = points_behind(map, rows, None)
    if np.isnan(sensors).any():
        raise ValueError(
            "map must tell where its sensor was: build_map(log, poses, keep_points=True) does, or "
            "SegmentMap(segments, scan, sensors=...)"
        )
    distance, min_length, forget, rejoin = limits
    s = _clockwise(rows.segments, sensors)
    inputs = Walls(s, np.empty((len(s), 6)), rows.row)
    if kept:
        _sum_points(points, first, inputs.sums)
    else:
        _sum_evenly(s, spacing, inputs.sums)
    tree, before, after, count = _Tree(), _empty_walls(0), _empty_walls(0), 0
    claims, room = _claims_for(64, 64), _room_for(1, 64, 1)
    for begin, stop in rows.scans():
        scan, p = (
            Walls(s[begin:stop], inputs.sums[begin:stop], rows.row[begin:stop]),
            sensors[begin],
        )
        while True:
            room = _room_for(stop - begin, len(claims.wall), count, room)
            found = look(before, count, scan, p, distance, min_length, forget, room, claims)
            if found[0] <= len(claims.wall) and found[1] <= len(claims.gone):
                break
            claims = _claims_for(2 * found[0], 2 * found[1])
        most = count + found[1] + 4 * found[0] + stop - begin
        if most > len(after.s):
            after = _empty_walls(2 * most)
        tree.reserve(most, 2 * found[0] + stop - begin)
        count, tree.nodes, gifts = renew(
            before,
            count,
            scan,
            p,
            claims,
            found,
            min_length,
            rejoin,
            room,
            after,
            tree.nodes,
            tree.family,
            tree.given[tree.gifts :],
        )
        tree.gifts += gifts
        before, after = after, before
        yield count
    return before.s[:count].copy(), tree.parents(before.node[:count], rows.row)


def _clockwise(s: Array, sensors: Array) -> Array:
    """Segments whose ends their sensor sees clockwise, whichever was given first."""
    a, b = s[:, 0] - sensors, s[:, 1] - sensors
    turned = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0
    return np.where(turned[:, None, None], s[:, ::-1], s)


def _empty_walls(count: int) -> Walls:
    return Walls(np.empty((count, 2, 2)), np.empty((count, 6)), np.empty(count, np.int64))


def _claims_for(stretches: int, pieces: int) -> Claims:
    """Room for what a scan says."""
    q, g = max(stretches, 64), max(pieces, 64)
    wall, segment = np.empty((2, q), np.int64)
    return Claims(wall, segment, np.empty((q, 5)), np.empty(g, np.int64), np.empty((g, 2)))


def _room_for(segments: int, claims: int, walls: int, room: Room | None = None) -> Room:
    """Room for a scan of so many segments; the one that is there where it is large enough."""
    if room is not None and _fits(room, segments, claims, walls):
        return room
    c, q, m = 2 * segments, claims, 2 * walls + 1
    bins = 2 << c.bit_length()
    return Room(
        np.empty((3 * c, 6)),
        np.empty(6 * c + 2 * q + 2),
        np.empty(c, np.int64),
        np.empty(q, np.int64),
        np.empty((c + 2 * q, 2)),
        np.empty((c + 2 * q, 3), np.int64),
        np.empty(m + 1, np.int64),
        np.empty(bins, np.int64),
        np.empty(c, np.int64),
        np.empty(c, np.int64),
    )


def _fits(room: Room, segments: int, claims: int, walls: int) -> bool:
    enough = len(room.head) >= segments and len(room.after) >= claims
    return enough and len(room.first) > walls


class _Tree:
    """Where the length of each input went: pieces are the children of the wall they were cut from.

    `family` has the parent of each node, -1 for none, and the share of it that the node is; a row
    of `given` says which input gave how many metres to which node.
    """

    def __init__(self) -> None:
        self.family, self.given = np.empty((64, 2)), np.empty((64, 3))
        self.nodes = self.gifts = 0

    def reserve(self, nodes: int, gifts: int) -> None:
        """Room for so many more."""
        if self.nodes + nodes > len(self.family):
            self.family = np.resize(self.family, (2 * (self.nodes + nodes), 2))
        if self.gifts + gifts > len(self.given):
            self.given = np.resize(self.given, (2 * (self.gifts + gifts), 3))

    def parents(self, leaves: Indices, row: Indices) -> Indices:
        """Which leaf holds most of each input `(k,)`, -1 for none; ties: the first."""
        given = self.given[: self.gifts]
        order = np.argsort(given[:, 1], kind="stable")
        first = np.searchsorted(given[order, 1], np.arange(self.nodes + 1))
        place = np.full(int(row.max(initial=-1)) + 1, -1)
        place[row] = np.arange(len(row))
        given = np.column_stack([place[given[order, 0].astype(np.int64)], given[order, 2]])
        most, parents = np.zeros(len(row)), np.full(len(row), -1)
        held = np.zeros(len(row))
        _weigh(leaves, self.family, first, given, held, most, parents)
        return parents


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
    """The leaf that holds most metres of each input: walks from each leaf up to its root."""
    for k in range(len(leaves)):
        for again in range(2):
            node, part = leaves[k], 1.0
            while node >= 0:
                for i in range(first[node], first[node + 1]):
                    j = int(given[i, 0])
                    if again == 0:
                        held[j] += part * given[i, 1]
                    else:
                        if held[j] > most[j] + SAME or (parents[j] < 0 and held[j] > 0.0):
                            most[j], parents[j] = held[j], k
                        held[j] = 0.0
                part *= family[node, 1]
                node = int(family[node, 0])


def _sum_points(points: Array, first: Indices, out: Array) -> None:
    """Running sums of the points of each segment, `(n, 6)`."""
    count = np.diff(first)
    mean = np.add.reduceat(points, first[:-1]) / count[:, None]
    x, y = (points - np.repeat(mean, count, axis=0)).T
    out[:, 0], out[:, 1:3] = count, mean
    out[:, 3:] = np.add.reduceat(np.column_stack([x * x, x * y, y * y]), first[:-1])


def _sum_evenly(s: Array, spacing: float, out: Array) -> None:
    """Running sums of points evenly along each segment: as many as the spacing, metres, puts."""
    d = s[:, 1] - s[:, 0]
    out[:, 0] = n = np.hypot(d[:, 0], d[:, 1]) / spacing
    out[:, 1:3] = (s[:, 0] + s[:, 1]) / 2
    out[:, 3:] = np.column_stack([d[:, 0] ** 2, d[:, 0] * d[:, 1], d[:, 1] ** 2]) * n[:, None] / 12
