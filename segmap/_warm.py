"""Small calls of everything that compiles, so that the first real call finds its machine code.

Each case belongs to one room and returns the arrays that it found: the tests run the same cases
with and without numba and compare.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache, partial
from importlib.util import find_spec
from typing import Any

import numpy as np

from . import alignment, extraction, matching, metrics, quadtree, readers, reduction, simulation
from .arrays import Array
from .compiled import COMPILING, PLAIN
from .progress import announce, part_of
from .scans import LaserScan, Log
from .segments import SegmentMap

Found = list[Any]

#: Cases that this process has run: what they need is loaded.
_dispatched: set[str] = set()


def cases() -> dict[str, Callable[[], Found]]:
    """Name of each case, `room method`, and its call; the longest to compile come first."""
    families = (
        ("reduction", reduction.METHODS, _reduced),
        ("alignment", alignment.METHODS, _aligned),
    )
    ours: dict[str, Callable[[], Found]] = {
        f"{family} {name}": partial(small, name)
        for family, methods, small in families
        for name, method in methods.items()
        if method.function.__module__.startswith("segmap.")  # one of your own may do anything
    }
    longest = ("alignment pose_graph", "reduction fusion", "alignment angle_correspondence")
    return {name: ours[name] for name in longest if name in ours} | {
        "matching all": _matched,
        "quadtree all": _trees,
        **ours,
        "alignment match_points": _matched_points,
        "extraction all": _extracted,
        "metrics all": _measured,
        "simulation all": _cast,
    }


def run(name: str) -> None:
    """One case by its name, for a process that cannot be handed the call itself."""
    cases()[name]()


def dispatch(names: Iterable[str]) -> None:
    """Load what these cases need, and compile what is missing: before work that is timed.

    Compiling is told as such, and nothing else; what has no case, as a method of one's own, is left
    to its first call.
    """
    if os.environ.get(PLAIN) == "1" or find_spec("numba") is None:
        return
    known = cases()
    new = [name for name in dict.fromkeys(names) if name in known and name not in _dispatched]
    for k, name in enumerate(new):
        announce(k / len(new), "loading compiled loops")
        with part_of(COMPILING, k / len(new), (k + 1) / len(new)):
            known[name]()
        _dispatched.add(name)


def _room() -> Array:
    """(60, 2) points of a noisy rectangular room, metres."""
    t = np.radians(np.arange(0, 360, 6.0))
    ranges = 1 / np.maximum(np.abs(np.cos(t)) / 2, np.abs(np.sin(t)) / 1.5)
    ranges += np.random.default_rng(3).normal(0, 0.01, 60)
    return np.stack([ranges * np.cos(t), ranges * np.sin(t)], -1)


def _walls() -> tuple[Array, Array]:
    """(12, 2, 2) walls and (36, 2, 2) noisy sights of them, metres."""
    rng = np.random.default_rng(3)
    walls = rng.uniform(-3, 3, (12, 2, 2))
    return walls, np.repeat(walls, 3, axis=0) + rng.normal(0, 0.01, (36, 2, 2))


@cache
def _malaga() -> Log:
    return readers.load("malaga")


def _log(every: int = 4) -> Log:
    """Four scans of the bundled log whose true poses are known, with a part of their beams."""
    log = _malaga()
    assert log.truth is not None
    chosen = np.flatnonzero(np.isfinite(log.truth[:, 0]))[:4]
    thin = [replace(s, ranges=s.ranges[::every], angles=s.angles[::every]) for s in log[chosen]]
    return Log("few", thin, log.truth[chosen])


def _reduced(name: str) -> Found:
    walls, seen = _walls()
    map = SegmentMap(
        np.concatenate([seen, walls + 0.02]), np.repeat([0, 1], (36, 12)), sensors=np.zeros((2, 2))
    )
    options: dict[str, float] = {}
    if name == "mean_shift":
        map, options = SegmentMap(seen[:9]), {"sigma": 1.0}
    done = [reduction.METHODS[name](map, **options)]
    if reduction.METHODS[name].needs_points:
        ends, first = map.segments.reshape(-1, 2), 2 * np.arange(len(map) + 1)
        done.append(reduction.METHODS[name](replace(map, points=ends, first=first), **options))
    return [part for each in done for part in (each.segments, each.parents)]


def _aligned(name: str) -> Found:
    method, options = alignment.METHODS[name], dict[str, Any]()
    if name == "angle_correspondence":
        options = {"rng": np.random.default_rng(0)}
    if name == "pose_graph":
        options = {"step": 0.01, "closing": alignment.LoopClosing(min_path=0.01, new_frames=1)}
    return [method(_log(1 if name == "angle_correspondence" else 4), **options).poses]


def _matched_points() -> Found:
    points = _room()
    match = alignment.match_points(points, points[5:] + (0.03, -0.02))
    return [match.pose, match.covariance]


def _extracted() -> Found:
    points = _room()
    return [
        extraction.extract_clusters(points, closed=True),
        extraction.extract_clusters(points, fit="algebraic"),
        extraction.extract_polylines(points, gap=0.5, closed=True),
        extraction.fit_line(points[:9])[0],
        extraction.build_map(_log(), np.zeros((4, 3))).segments,
    ]


def _measured() -> Found:
    walls, seen = _walls()
    found = [metrics.errors(seen, walls), metrics.errors(SegmentMap(seen), SegmentMap(walls))]
    return [*found, metrics.missed(seen, walls)]


def _cast() -> Found:
    angles = np.radians(np.arange(0, 360, 6.0))
    return [simulation.cast_rays(_walls()[0], (0.1, 0.2, 0.3), angles, max_range=4.0)]


def _trees() -> Found:
    points = _room()
    found: Found = []
    for free in (None, 0.2):
        map = quadtree.QuadtreeMap(resolution=0.1, size=1.6, free_resolution=free)
        map.insert_scan((0.1, 0.0), points, points[:5] * 1.5)
        found += [*map.leaves(), map.to_grid(0.2), map.occupancy(points)]
    return found


def _matched() -> Found:
    points, rng = _room(), np.random.default_rng(3)
    map = quadtree.QuadtreeMap(resolution=0.1, size=1.6)
    map.insert_scan((0.1, 0.0), points)
    poses = rng.normal(0, 0.2, (3, 3))
    names = ("occupancy_score", "distance_score", "nearest_score", "descent_score")
    found: Found = [getattr(matching, name)(map, points, poses) for name in names]
    found.append(matching.hill_climb(map, points, poses[0]))
    room = SegmentMap(simulation.box(4, 3))
    scan = LaserScan(np.hypot(*points.T), np.arctan2(*points.T[::-1]))
    for places in (matching.search(each, scan, beams=12) for each in (map, room)):
        found += [places.poses, places.scores, places.covariances]
    return [*found, matching.DistanceField(room).distance]
