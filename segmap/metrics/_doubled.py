"""Walls that a map shows twice, since scans of one place were laid beside each other."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..angles import wrap
from ..arrays import Array, Count, Metres, Radians, at_least, at_most, checked
from ..segments import SegmentMap, cut_evenly, length, midpoint

#: Walls are looked at in pieces of this side, metres: a tenth of a door.
DOUBLED_PIECE_M = 0.10
#: A segment is cut into so many at most, which is a kilometre.
MOST_DOUBLED_PIECES = 10_000


@checked
def doubled_walls(
    map: SegmentMap,
    sensors: ArrayLike | None = None,
    *,
    nearest: Metres = 0.15,
    farthest: Metres = 0.50,
    angle: Annotated[Radians, at_least(np.radians(1)), at_most(np.pi / 4)] = np.radians(10),
    looks: Count = 3,
) -> float:
    """Share of the walls of a map that have another beside them, seen from the same side.

    A laser sees the front of a wall and nothing behind it, so two walls half a metre apart that
    face the same way are one wall, drawn at two wrong poses. The two faces of a thin wall look
    away from each other and do not count. Bundled and real logs show 0 to 15 % with good poses;
    by odometry alone Malaga shows 65 % and Intel 53 %. A wall that lies more than `farthest` beside
    itself is not found, so little doubling alone does not make a good map.

    Parameters
    ----------
    sensors : (k, 2) array, metres, or None
        Where the sensor or the robot was at each scan. None: what the map has kept.
    nearest, farthest
        How far beside. Less may be the noise of far beams, and more a cupboard before a wall.
    angle
        By how much the two may be turned.
    looks
        So many scans must show a piece of wall: people who pass are in one or two.

    Returns
    -------
    float
        0 to 1; NaN where no wall was seen so often.

    Raises
    ------
    ValueError
        Where nobody says where the sensor was.

    Examples
    --------
    >>> once, twice = [[(0, 1), (4, 1)]] * 3, [[(0, 1.3), (4, 1.3)]] * 3
    >>> wall = SegmentMap(once, [0, 1, 2])
    >>> doubled_walls(wall, np.zeros((3, 2)))
    0.0
    >>> both = SegmentMap(once + twice, range(6))
    >>> doubled_walls(both, np.zeros((6, 2)))
    1.0
    >>> doubled_walls(both, [(0, 0)] * 3 + [(0, 2)] * 3)
    0.0
    """
    arrays.instance(map, "map", SegmentMap)
    stood = map.sensors
    if sensors is not None:
        stood = SegmentMap(map.segments, map.scan, sensors=sensors).sensors  # which checks them
    if stood is None:
        raise ValueError("sensors must say where each scan of the map was taken, got None")
    places, facing = _pieces(map, stood[map.scan], angle, looks)
    if not len(places):
        return float("nan")
    from scipy.spatial import cKDTree

    pairs = cKDTree(places).query_pairs(np.hypot(farthest, DOUBLED_PIECE_M), output_type="ndarray")
    i, j = pairs.T
    turn = wrap(facing[j] - facing[i])
    across, away = facing[i] + turn / 2, places[j] - places[i]
    beside = np.abs(away[:, 0] * np.cos(across) + away[:, 1] * np.sin(across))
    along = np.abs(away[:, 1] * np.cos(across) - away[:, 0] * np.sin(across))
    same = (np.abs(turn) <= angle) & (along < DOUBLED_PIECE_M)
    same &= (nearest < beside) & (beside < farthest)
    return len(np.unique(pairs[same])) / len(places)


def _pieces(map: SegmentMap, stood: Array, angle: float, looks: int) -> tuple[Array, Array]:
    """Pieces of wall that so many scans show: places, `(m, 2)`, and the directions they face.

    `stood` says where each segment was seen from, `(n, 2)`, metres. Looks at one piece fall into
    one cell of place and direction.
    """
    sizes, spans = length(map.segments), map.segments[:, 1] - map.segments[:, 0]
    counts = np.clip(np.ceil(sizes / DOUBLED_PIECE_M), 1, MOST_DOUBLED_PIECES).astype(np.int64)
    pieces, row = cut_evenly(map.segments, counts)
    places = midpoint(pieces)
    normals, away = np.stack([-spans[:, 1], spans[:, 0]], -1), stood - midpoint(map.segments)
    behind = (normals * away).sum(-1) < 0
    facing = np.arctan2(normals[:, 1], normals[:, 0]) + np.pi * behind
    turns = np.round(wrap(facing) / angle) % np.round(2 * np.pi / angle)
    cells = np.column_stack([np.floor(places / DOUBLED_PIECE_M), turns[row], map.scan[row]]).astype(
        np.int64
    )
    _, once = np.unique(cells, axis=0, return_index=True)  # a scan that shows it in two segments
    _, first, count = np.unique(cells[once, :3], axis=0, return_index=True, return_counts=True)
    often = once[first[count >= looks]]
    return places[often], facing[row[often]]
