"""Random maps on which the reduction methods meet their plain versions and their symmetries."""

from functools import cache

import numpy as np
from segmap_course import literal

from segmap import load
from segmap.compiled import Compiled
from segmap.extraction import build_map
from segmap.reduction import METHODS
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal


def random_map(rng: np.random.Generator, n: int = 48) -> np.ndarray:
    """No order at all."""
    return rng.uniform(-1, 1, (n, 2, 2))


def redundant_map(rng: np.random.Generator, n: int = 60) -> np.ndarray:
    """Pieces of five walls around the origin, each seen several times with noise."""
    walls = rng.uniform(-3, 3, (5, 2, 2))
    part = rng.uniform(0, 1, (n, 2))[..., None]
    wall = walls[rng.integers(0, 5, n)]
    return wall[:, :1] + part * (wall[:, 1:] - wall[:, :1]) + rng.normal(0, 0.015, (n, 2, 2))


def lattice_map(rng: np.random.Generator, n: int = 48) -> np.ndarray:
    """Everything ties: duplicates, crossings, lines through the origin, some without length."""
    return np.repeat(rng.integers(-3, 4, (n // 2, 2, 2)) * 0.15, 2, axis=0)


def corridor_map(rng: np.random.Generator, n: int = 60) -> np.ndarray:
    """Many segments along one line: long chains and many shifts."""
    return rng.normal(0, 1, (n, 2, 2)) * (2.0, 0.03)


def grid_map(rng: np.random.Generator, n: int = 48, ways: int = 2) -> np.ndarray:
    """From corner to corner of a grid of 1/4 m, along its axes: every limit is met exactly."""
    at, along = rng.integers(-6, 7, (n, 2)) / 4, np.array([(1, 0), (0, 1), (1, 1), (1, -1)])
    steps = rng.choice([-1, 1], (n, 1)) * rng.integers(1, 9, (n, 1)) / 4
    return np.stack([at, at + along[rng.integers(0, ways, n)] * steps], 1)


def diagonal_map(rng: np.random.Generator, n: int = 48) -> np.ndarray:
    """Along the diagonals of the grid, too."""
    return grid_map(rng, n, 4)


MAPS = [random_map, redundant_map, lattice_map, corridor_map]


@cache
def malaga() -> SegmentMap:
    """The real map that the chapters use."""
    log = load("malaga")
    return build_map(log, log.truth, keep_points=True)


#: Methods that stand twice: fast, and as plain loops in `literal`.
TWINS = [n for n, m in METHODS.items() if getattr(literal, n, m.function) is not m.function]


def assert_plain(monkeypatch, name: str, map: SegmentMap, **thresholds) -> None:
    """Machine code finds the same as the loops that it was made of, to the last bits."""
    found = METHODS[name](map, **thresholds)
    with monkeypatch.context() as patch:
        patch.setattr(Compiled, "__call__", lambda kernel, *given: kernel.plain(*given))
        plain = METHODS[name](map, **thresholds)
    assert_segments_equal(found.segments, plain.segments, ordered=True)
    np.testing.assert_array_equal(found.parents, plain.parents)


def assert_literal(name: str, map: SegmentMap, **thresholds) -> None:
    """The same segments in the same order, and the same parents."""
    scans = [map.scan.tolist()] if METHODS[name].online else []
    plain = getattr(literal, name)
    behind = {k: v for k, v in plain_behind(map).items() if k in plain.__kwdefaults__}
    out, parents = plain(map.segments.tolist(), *scans, **behind, **thresholds)
    found = METHODS[name](map, **thresholds)
    assert_segments_equal(found.segments, np.reshape(out, (-1, 2, 2)), ordered=True)
    np.testing.assert_array_equal(found.parents, parents)


def plain_behind(map: SegmentMap) -> dict[str, list]:
    """What a map keeps beside its segments, as plain lists."""
    points = [] if map.points is None else np.split(map.points, map.first[1:-1])
    found = {"points": [run.tolist() for run in points]} if points else {}
    found["scans"] = map.scan.tolist()
    return found if map.sensors is None else {**found, "sensors": map.sensors.tolist()}
