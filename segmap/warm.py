"""Small calls of everything that compiles, so that the first real call finds its machine code.

Each case belongs to one room and returns the arrays that it found: the tests run the same cases
with and without numba and compare.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache, partial
from types import CodeType, FunctionType
from typing import Any

import numpy as np

from . import alignment, extraction, matching, metrics, quadtree, readers, reduction, simulation
from .arrays import Array
from .compiled import Compiled, missing, runs_plain
from .methods import Method
from .progress import Compiling, announce, compiling_only
from .scans import LaserScan, Log
from .segments import SegmentMap

Found = list[Any]

#: Where what can be called holds what it calls.
HELD = ("plain", "function", "func", "fget", "__func__", "__wrapped__")
#: Cases that compile all that chapter 01 needs: then `make lab` opens it.
FIRST = (
    "alignment match_points",
    "reduction fusion",
    "metrics all",
    "simulation all",
    "alignment pose_graph",
    "extraction extract_polylines",
)
#: Cases that this process has run: what they need is loaded.
_dispatched: set[str] = set()


def cases() -> dict[str, Callable[[], Found]]:
    """Name of each case, `room method`, and its call; the longest to compile come first."""
    families = (
        ("reduction", reduction.METHODS, _reduce),
        ("alignment", alignment.METHODS, _align),
    )
    ours: dict[str, Callable[[], Found]] = {
        f"{family} {name}": partial(small, name, method)
        for family, methods, small in families
        for name, method in methods.items()
        if method.function.__module__.startswith("segmap.")  # one of your own may do anything
    }
    longest = ("alignment pose_graph", "reduction fusion", "alignment angle_correspondence")
    return {name: ours[name] for name in longest if name in ours} | {
        "matching all": _match,
        "quadtree all": _trees,
        **ours,
        "alignment match_points": _matched_points,
        "extraction extract_polylines": _polylines,
        "extraction extract_clusters": _clusters,
        "metrics all": _measure_maps,
        "simulation all": _cast_rays,
    }


def run_case(name: str) -> None:
    """One case by its name, for a process that cannot be handed the call itself."""
    cases()[name]()


def dispatch(names: Iterable[str]) -> None:
    """Load what these cases need, and compile what is missing: before work that is timed.

    Compiling is told as such, and nothing else: which of the loops that may be needed it is.
    What has no case, as a method of one's own, is left to its first call.
    """
    if runs_plain():
        return
    case_of = cases()
    new = [name for name in dict.fromkeys(names) if name in case_of and name not in _dispatched]
    before, needed = len(missing), cache(lambda: loops(case_of[name] for name in new))

    def state() -> tuple[float, str]:
        """Which loop of how many; of one alone nobody knows how far it is."""
        k, n = sum(bool(one._fast or one._inner) for one in needed()), len(needed()) or 1
        return k / n, Compiling(f"compiling loop {k} of {n}")

    for k, name in enumerate(new):
        if len(missing) == before:  # else the share would go back
            announce(k / len(new), "loading compiled loops")
        with compiling_only(state):
            case_of[name]()
        _dispatched.add(name)


def loops(functions: Iterable[Any]) -> set[Any]:
    """The compiled loops that functions may call: those that they name, and what is named there."""
    to_visit, seen = list(functions), dict[int, Any]()
    while to_visit:
        if id(one := to_visit.pop()) in seen:
            continue
        seen[id(one)] = one
        to_visit += [getattr(one, name, None) for name in HELD]
        if isinstance(one, partial):
            to_visit += one.args
        if getattr(one, "__module__", "").startswith("segmap"):
            to_visit += vars(one).values() if isinstance(one, type) else _callees(one)
    return {one for one in seen.values() if isinstance(one, Compiled)}


def _callees(function: Any) -> list[Any]:
    """What of this package a function names: `name`, or `module.name`."""
    if not isinstance(function, FunctionType):
        return []
    codes, names = [function.__code__], set[str]()
    while codes:
        code = codes.pop()
        names |= {*code.co_names}
        codes += [inner for inner in code.co_consts if isinstance(inner, CodeType)]
    scope = function.__globals__
    objects = [scope[name] for name in names & scope.keys()]
    objects += [cell.cell_contents for cell in function.__closure__ or ()]
    packages = [vars(one) for one in objects if getattr(one, "__name__", "").startswith("segmap.")]
    return objects + [each[name] for each in packages for name in names & each.keys()]


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


def _reduce(name: str, method: Method[Any]) -> Found:
    walls, seen = _walls()
    map = SegmentMap(
        np.concatenate([seen, walls + 0.02]), np.repeat([0, 1], (36, 12)), sensors=np.zeros((2, 2))
    )
    options: dict[str, float] = {}
    if name == "mean_shift":
        map, options = SegmentMap(seen[:9]), {"sigma": 1.0}
    done = [method(map, **options)]
    if method.needs_points:
        ends, first = map.segments.reshape(-1, 2), 2 * np.arange(len(map) + 1)
        done.append(method(replace(map, points=ends, first=first), **options))
    return [part for each in done for part in (each.segments, each.parents)]


def _align(name: str, method: Method[Any]) -> Found:
    options = dict[str, Any]()
    if name == "angle_correspondence":
        options = {"rng": np.random.default_rng(0)}
    if name == "pose_graph":
        options = {"step": 0.01, "closing": alignment.LoopClosing(min_path=0.01, new_frames=1)}
    return [method(_log(1 if name == "angle_correspondence" else 4), **options).poses]


def _matched_points() -> Found:
    points = _room()
    match = alignment.match_points(points, points[5:] + (0.03, -0.02))
    return [match.pose, match.covariance]


def _polylines() -> Found:
    return [
        extraction.extract_polylines(_room(), gap=0.5, closed=True),
        extraction.build_map(_log(), np.zeros((4, 3))).segments,
    ]


def _clusters() -> Found:
    points = _room()
    return [
        extraction.extract_clusters(points, closed=True),
        extraction.extract_clusters(points, fit="algebraic"),
        extraction.fit_line(points[:9])[0],
    ]


def _measure_maps() -> Found:
    walls, seen = _walls()
    errors = [metrics.errors(seen, walls), metrics.errors(SegmentMap(seen), SegmentMap(walls))]
    return [*errors, metrics.missed(seen, walls)]


def _cast_rays() -> Found:
    angles = np.radians(np.arange(0, 360, 6.0))
    return [simulation.cast_rays(_walls()[0], (0.1, 0.2, 0.3), angles, max_range=4.0)]


def _trees() -> Found:
    points = _room()
    outcomes: Found = []
    for free in (None, 0.2):
        map = quadtree.QuadtreeMap(resolution=0.1, size=1.6, free_resolution=free)
        map.insert_scan((0.1, 0.0), points, points[:5] * 1.5)
        outcomes += [*map.leaves(), map.to_grid(0.2), map.occupancy(points)]
    return outcomes


def _match() -> Found:
    points, rng = _room(), np.random.default_rng(3)
    map = quadtree.QuadtreeMap(resolution=0.1, size=1.6)
    map.insert_scan((0.1, 0.0), points)
    poses = rng.normal(0, 0.2, (3, 3))
    names = ("occupancy_score", "distance_score", "nearest_score", "descent_score")
    outcomes: Found = [getattr(matching, name)(map, points, poses) for name in names]
    outcomes.append(matching.hill_climb(map, points, poses[0]))
    room = SegmentMap(simulation.box(4, 3))
    scan = LaserScan(np.hypot(*points.T), np.arctan2(*points.T[::-1]))
    for places in (matching.search(each, scan, beams=12) for each in (map, room)):
        outcomes += [places.poses, places.scores, places.covariances]
    beliefs = matching.localize(map, [scan, scan], rng=rng, particles=300, beams=12)
    outcomes += [belief.poses for belief in beliefs]
    return [*outcomes, matching.DistanceField(room).distance]
