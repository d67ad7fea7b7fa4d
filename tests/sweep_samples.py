"""Maps, grids and methods that the tests of experiments share; other processes import them too."""

import time

import numpy as np

from segmap import SegmentMap
from segmap.reduction import Reduction


def redundant_map(seed, n=60):
    """Pieces of four walls, seen again and again, and some short stubs; ten scans."""
    rng = np.random.default_rng(seed)
    walls = rng.uniform(0, 6, (4, 2, 2))
    part = np.sort(rng.uniform(0, 1, (n, 2)), axis=1)[..., None]
    wall = walls[rng.integers(0, len(walls), n)]
    ends = wall[:, :1] + part * (wall[:, 1:] - wall[:, :1]) + rng.normal(0, 0.01, (n, 2, 2))
    stubs = rng.uniform(0, 6, (10, 1, 2)) + [[(0, 0), (0.05, 0)]]
    return SegmentMap(np.concatenate([ends, stubs]), rng.integers(0, 10, n + 10))


HALL, ROOM = redundant_map(1), redundant_map(2, 40)
MAPS = {"hall": HALL, "room": ROOM}
GRIDS = {
    "fusion": {"tolerance": [0.02, 0.06]},
    "hybrid": [{"distance": 0.1, "angle": 0.2}, {"distance": 0.3}],
}
NAMES = ["hybrid", "fusion"]


def without_seconds(frame):
    return frame.drop(columns="seconds")


def keep_all(map, *, share: float = 1.0):
    kept = map.segments[: int(share * len(map))]
    return Reduction(kept, np.arange(len(map)), 1.25, "keep_all")


def slow_start(map, *, wait: float = 0.0):
    time.sleep(wait)
    return keep_all(map)
