"""Open exercises on quadtree maps: coarser cells, a room that fools a matcher, walls that fade."""

from __future__ import annotations

import numpy as np

from segmap.arrays import Array
from segmap.matching import field_score, hill_climb
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap, build_map
from segmap.simulation import cast_rays

from ..._matcher_trials import room_walk
from ._open import Challenge, Prediction, admit

#: A beam each half degree, all round.
_BEAMS = np.radians(np.arange(720) / 2)
_REACH = 5.6  #: metres, of these beams
_PLACES = np.stack([np.arange(-1, 1.01, 0.25), np.zeros(9), np.zeros(9)], -1)
_START = np.array([0.3, 0.0, 0.0])  #: where the matcher begins; the scan was made at (0, 0, 0)


def _coarse_leaves() -> float:
    log = room_walk()[:40]
    assert log.truth is not None
    return float(len(build_map(log, log.truth, resolution=0.02).leaves().x))


predict_coarse_leaves = Prediction(
    "predict_coarse_leaves(guess): leaves of the map of the first 40 scans of `course.room_walk()` "
    "at their true poses with cells of 2 cm; with cells of 1 cm it has 8488; within a factor of "
    "1.15",
    _coarse_leaves,
    "leaves",
    factor=1.15,
    because="The noise of a range is as large as the small cells: each wall fills several of them "
    "side by side, but hardly more than one or two of the large ones",
)


def _ends(walls: Array, pose: Array) -> Array:
    """End points of a scan without noise, in the robot's frame."""
    ranges = cast_rays(walls, pose, _BEAMS, max_range=_REACH)
    far, turn = ranges[np.isfinite(ranges)], _BEAMS[np.isfinite(ranges)]
    return far[:, None] * np.stack([np.cos(turn), np.sin(turn)], -1)


def _mapped(walls: Array, poses: Array, resolution: float) -> QuadtreeMap:
    map = QuadtreeMap(resolution=resolution)
    for pose in poses:
        map.insert_scan(pose[:2], transform(pose, _ends(walls, pose)))
    return map


def _matching_fooled(walls: Array) -> str:
    points = _ends(admit(walls, "walls", 1, 20), np.zeros(3))
    if len(points) < 200:
        return f"only {len(points)} of 720 beams meet a wall, 200 are wanted"
    map = _mapped(walls, _PLACES, 0.02)
    found = hill_climb(map, points, _START)
    off = float(np.hypot(*found[:2]))
    if off < 0.2:
        return f"the matcher ends {100 * off:.0f} cm from the truth, 20 cm are wanted"
    there, truth = field_score(map, points, [found, np.zeros(3)]) / len(points)
    if there < truth - 0.005:
        worse = 1000 * (truth - there)
        return f"the score sees it: {worse:.0f} mm a beam worse than at the truth"
    return ""


break_matching = Challenge(
    "break_matching(walls): 1 to 20 walls, (n, 2, 2) in metres, within 20 m of (0, 0), of which "
    "200 beams or more of a scan at (0, 0, 0) see some (720 beams, no noise, 5.6 m). The map holds "
    "scans from x = -1 to 1 m, y = 0. Hill climbing from (0.3, 0, 0) must end 0.2 m or more from "
    "the truth, with a score that is at most 5 mm a beam worse than there",
    _matching_fooled,
    praise="Where the walls leave a motion free, or repeat along it, other places fit as well "
    "as the truth, and no score of this scan on this map can tell them apart",
)


def _faded(walls: Array, places: Array) -> str:
    poses = np.column_stack([admit(places, "places", 1, 30), np.zeros(len(places))])
    map = _mapped(admit(walls, "walls", 1, 400), poses, 0.05)
    hit = map.leaves().occ > 0
    lost = int((map.leaf_occupancy()[hit] <= 0.5).sum())
    if lost >= 20 and lost >= 0.1 * hit.sum():
        return ""
    told = f"{lost} of {int(hit.sum())} cells that were hit are not occupied"
    return f"{told}, 20 are wanted and a tenth of all"


break_cells = Challenge(
    "break_cells((walls, places)): 1 to 400 walls, (n, 2, 2), and 1 to 30 places of the sensor, "
    "(k, 2), metres, within 20 m of (0, 0). At each place one scan (720 beams, no noise, 5.6 m, "
    "true poses) goes into a map with cells of 5 cm. Of the cells in which beams ended, "
    "20 or more, and a tenth or more, must not be occupied (occupancy 0.5 or less)",
    _faded,
    praise="A cell has one answer for all that is in it: where a part of it stops rays and a part "
    "lets more of them through, the wall in it is gone",
)
