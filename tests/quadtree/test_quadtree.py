"""The quadtree map against its literal form, leaf for leaf."""

import numpy as np
import pytest
from conftest import slow
from hypothesis import given
from hypothesis import strategies as st
from quadtrees import leaves_of
from segmap_course import literal

from segmap.quadtree import QuadtreeMap


def both(scans, *, cells=8, resolution=0.25, corner=(0.0, 0.0), free_resolution=None):
    """Insert scans `(sensor, ends, free)` into the map and its literal form; whether they agree."""
    map = QuadtreeMap(
        resolution=resolution,
        size=cells * resolution,
        corner=corner,
        free_resolution=free_resolution,
    )
    finest = None if free_resolution is None else round(free_resolution / resolution)
    tree = literal.Quadtree(resolution, cells, corner=tuple(corner), finest=finest)
    for sensor, *ends in scans:
        map.insert_scan(sensor, *ends)
        tree.insert(tuple(sensor), *(np.reshape(points, (-1, 2)).tolist() for points in ends))
        if leaves_of(map) != tree.leaves:
            return map, False
    return map, True


def random_scans(rng, resolution, corner, spread):
    """Three scans of a wandering sensor, with points twice, at the sensor, and free ones."""
    for _ in range(3):
        sensor = rng.normal(0, spread / 2, 2)
        ends, free = (rng.normal(0, spread, (rng.integers(0, n), 2)) for n in (14, 4))
        if rng.random() < 0.3:  # exactly on edges and corners
            ends = corner + np.round((ends - corner) / resolution) * resolution
        ends[1:2], ends[2:3], free[:1] = ends[:1], sensor, sensor
        yield sensor, ends, free


@pytest.mark.parametrize("free_resolution", [None, 1, 2, 8])
@pytest.mark.parametrize("seed", [*range(9), *map(slow, range(9, 50))])
def test_equals_the_literal_map(seed, free_resolution):
    """Catches a wrong cell, split, count, mask, order of growth, or a leaf counted twice a ray."""
    rng = np.random.default_rng(seed)
    resolution = rng.choice([0.01, 0.05, 0.1, 0.25])
    corner = rng.uniform(-1, 1, 2).round(2)
    scans = list(random_scans(rng, resolution, corner, resolution * rng.choice([2, 10, 60])))
    settings = {"cells": 2 ** int(rng.integers(2, 6)), "resolution": resolution, "corner": corner}
    settings["free_resolution"] = free_resolution and free_resolution * resolution
    assert both(scans, **settings)[1]


LATTICE = st.tuples(*[st.integers(-70, 70)] * 2)


@given(
    st.lists(
        st.tuples(LATTICE, st.lists(LATTICE, max_size=6), st.lists(LATTICE, max_size=2)), max_size=3
    ),
    st.sampled_from([None, 0.5, 2.0]),
)
def test_equals_the_literal_map_on_edges(scans, free_resolution):
    """All points on corners of cells: a rounding the other way puts them in the next."""
    quarter = [tuple(np.multiply(part, 0.25).tolist() for part in scan) for scan in scans]
    _, equal = both(quarter, free_resolution=free_resolution)
    assert equal


NEAR = (0.5, 0.5)
GROWN = [((-0.1, 0.5), (-1, 0, 1, 2)), ((0.5, -0.1), (0, -1, 2, 1)), ((1.1, 0.5), (0, 0, 2, 2))]
GROWN += [((0.5, 1.1), (0, 0, 2, 2)), ((-0.1, -0.1), (-1, -1, 1, 1)), ((2.5, -1.5), (0, -3, 4, 1))]


@pytest.mark.parametrize(
    ("scan", "bounds"),
    [
        *(((point, [NEAR], []), bounds) for point, bounds in GROWN),
        *(((NEAR, [point], []), bounds) for point, bounds in GROWN),
        *(((NEAR, [], [point]), bounds) for point, bounds in GROWN),
        # on the top edge, neither above nor below, B grows downwards until its largest size
        ((NEAR, [(0.5, 1.0)], []), (0, 0, 2, 2)),
        # the sensor grows it before the ends: on which side the room lies
        (((-0.1, 0.5), [(1.1, 0.5)], []), (-1, 0, 3, 4)),
    ],
)
def test_grows_towards_the_point(scan, bounds):
    """Catches a root that grows the wrong way, and points that are forgotten in growing."""
    map, equal = both([scan], cells=4)
    assert equal and map.bounds == bounds


def test_the_literal_walk_is_that_of_the_thesis():
    """By hand: the loop starts at the smaller x, so a ray and its mirror image differ."""
    there = [(0, 0), (1, 0), (2, 0), (3, 1), (4, 1)]
    assert literal.ray_cells((0, 0), (4, 1)) == there == literal.ray_cells((4, 1), (0, 0))
    back = [(-4, 1), (-3, 1), (-2, 1), (-1, 0), (0, 0)]
    assert literal.ray_cells((0, 0), (-4, 1)) == back
    assert literal.ray_cells((0, 0), (1, 4)) == [(y, x) for x, y in there]
