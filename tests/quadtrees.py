"""Quadtree maps for the tests, and every bit of one in a form that compares."""

import numpy as np
import pytest
from segmap_course import literal

from segmap import load
from segmap.quadtree import QuadtreeMap, build_map


@pytest.fixture(scope="module")
def room() -> QuadtreeMap:
    log = load("room")
    return build_map(log, log.truth, resolution=0.05, bias=4)


def corner_map() -> QuadtreeMap:
    """Free below, a hit to the upper right, on a map whose corner is no round number."""
    map = QuadtreeMap(resolution=0.25, size=2, corner=(-3.07, 1.13), bias=1)
    map.insert_scan((-3.0, 1.2), [(-1.2, 2.9)], [(-1.2, 1.2)] * 3)
    return map


def leaves_of(map):
    """Leaves as `literal` keeps them: squares from the first corner -> both counts."""
    found = map.leaves()
    where = np.stack([found.x - map.corner[0], found.y - map.corner[1], found.side], -1)
    squares = np.rint(where / map.resolution).astype(int).tolist()
    assert len({tuple(square) for square in squares}) == len(squares)
    counts = np.stack([found.vis, found.occ], -1).tolist()
    return {tuple(square): tuple(pair) for square, pair in zip(squares, counts, strict=True)}


def literal_of(map):
    """The literal form of a map."""
    tree = literal.Quadtree(map.resolution, corner=tuple(map.corner.tolist()))
    left, low = np.rint((np.array(map.bounds[:2]) - map.corner) / map.resolution).astype(int)
    tree.root = int(left), int(low), round(map.side / map.resolution)
    tree.leaves = leaves_of(map)
    return tree


def state(map):
    """Every bit of a map that later answers depend on."""
    tree = map.tree
    nodes = slice(0, 4 * tree.used)
    counts = tree.vis[nodes].tobytes(), tree.occ[nodes].tobytes(), tree.corner.tobytes()
    return *counts, tree.used, tree.block, tree.level, map.scans


def random_map(seed, *, free_resolution=None):
    """Scans of a wandering sensor: grown roots, and cells that later rays have emptied again."""
    rng = np.random.default_rng(seed)
    side = rng.choice([0.01, 0.05, 0.25])
    fine = free_resolution and side * free_resolution
    map = QuadtreeMap(
        resolution=side, size=4 * side, corner=rng.normal(0, 1, 2), free_resolution=fine
    )
    for _ in range(4):
        sensor = rng.normal(0, 20 * side, 2)
        map.insert_scan(sensor, sensor + rng.normal(0, 25 * side, (40, 2)))
    return map, rng
