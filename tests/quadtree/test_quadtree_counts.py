"""What the quadtree map counts and says of space, what it refuses, and maps of logs."""

from dataclasses import replace

import numpy as np
import pytest
from quadtrees import leaves_of, state

from segmap import load
from segmap.quadtree import QuadtreeMap, build_map, extent, free_ends
from segmap.scans import LaserScan, Log


# ---------------------------------------------------------------------------- counts
@pytest.mark.parametrize(
    ("vis", "occ", "bias", "expected"),
    [
        *((0, 0, 20, 0.5), (5, 0, 20, 0.375), (19, 0, 20, 0.025), (20, 0, 20, 0)),
        *((900, 0, 20, 0), (4, 1, 20, 0.25), (3, 3, 20, 1), (1, 0, 1, 0), (1, 0, 2, 0.25)),
    ],
)
def test_occupancy_by_its_formula(vis, occ, bias, expected):
    map = QuadtreeMap(resolution=1, size=4, bias=bias)
    map.tree.vis[0], map.tree.occ[0] = vis, occ
    assert map.occupancy([(0.5, 0.5)]) == pytest.approx(expected)


def test_what_lies_outside_is_unknown():
    map = QuadtreeMap(resolution=0.1)
    map.insert_scan((1, 1), [(2, 1)])
    found = map.occupancy([(-1e-9, 0), (51.2, 1), (1e300, -1e300)])
    assert found.tolist() == [0.5] * 3 and map.occupancy([]).shape == (0,)


@pytest.fixture(scope="module")
def room() -> QuadtreeMap:
    log = load("room")
    return build_map(log, log.truth, resolution=0.02)


def test_grid_holds_the_occupancy_of_every_cell(room):
    """Catches rows and columns exchanged, row 0 at the top, a coarse grid that loses a wall."""
    grid = room.to_grid()
    left, low, right, high = room.bounds
    x = np.arange(left, right - 0.01, 0.02) + 0.01
    y = np.arange(low, high - 0.01, 0.02) + 0.01
    points = np.stack(np.meshgrid(x, y), -1)
    expected = room.occupancy(points.reshape(-1, 2)).reshape(points.shape[:2])
    assert np.array_equal(grid, expected) and not np.array_equal(grid, grid.T)
    for times in (2, 8, 1024):
        side = len(grid) // times
        largest = grid.reshape(side, times, side, times).max((1, 3))
        assert np.array_equal(room.to_grid(0.02 * times), largest)


def test_the_extent_is_that_of_the_ends_with_a_part_of_the_longer_side_around_it():
    map = QuadtreeMap(resolution=0.5, size=8, corner=(-2, 1))
    assert extent(map) == map.bounds == (-2, 1, 6, 9)
    map.insert_scan((0, 2), [(10, 2), (-3, 7)])
    assert extent(map, margin=0) == (-3, 2, 10.5, 7.5)
    assert extent(map) == pytest.approx((-3 - 1.08, 2 - 1.08, 10.5 + 1.08, 7.5 + 1.08))


def test_bytes_a_leaf(room):
    """At most 12 (two counts of four bytes a node, of which a quarter are no leaves)."""
    tree, leaves = room.tree, room.leaves()
    assert room.nbytes == tree.vis[: 4 * tree.used].nbytes + tree.occ[: 4 * tree.used].nbytes
    assert room.nbytes <= 12 * len(leaves.x)
    assert tree.vis.nbytes + tree.occ.nbytes <= 1.6 * room.nbytes


# ------------------------------------------------------------------------- refused


FAR = 10_000.0
REFUSED = {
    "NaN sensor": (((np.nan, 0), [(1, 1)], []), r"sensor_xy must be finite.* is \[nan, 0.0\]"),
    "endless end": (
        ((0, 0), [(1, 1), (np.inf, 0)], []),
        r"leave out .* points\[1\] is \[inf, 0.0\]",
    ),
    "NaN free": (((0, 0), [(1, 1)], [(0, np.nan)]), r"free_points\[0\] is \[0.0, nan\]"),
    "10 km": (((0, 0), [(99, 99), (FAR, 0)], []), r"max_size, 655.36 m, with cell \[1000000, 0\]"),
    "10 km free": (((0, 0), [(-9, 0)], [(0, -FAR)]), r"beyond max_size.*\[0, -1000000\]"),
    "sensor at 10 km": (((FAR, FAR), [], []), "beyond max_size"),
    "too far to count": (((0, 0), [(-1e300, 0)], []), "beyond max_size"),
    "no pairs": (((0, 0), [1.0, 2.0], []), r"points must have shape \(n, 2\), got \(2,\)"),
    "two sensors": (([(0, 0), (1, 1)], [], []), r"sensor_xy must have shape \(2,\), got \(2, 2\)"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_failed_insertion_leaves_the_map_as_it_was(name):
    """Catches growth or splits before all points are known to be good."""
    map = QuadtreeMap(resolution=0.01)
    map.insert_scan((1, 1), [(2, 1), (-3, 0.5)])
    before = state(map)
    scan, message = REFUSED[name]
    for arrays in (scan, [np.asarray(part, float) for part in scan]):
        with pytest.raises(ValueError, match=message):
            map.insert_scan(*arrays)
        assert state(map) == before
    map.insert_scan((1, 1), [(2, 1)])
    assert map.scans == 2


def test_the_largest_size_is_reached_and_not_passed():
    """Catches a limit that stops one doubling early, as B's does."""
    map = QuadtreeMap(resolution=1, size=4, max_size=16)
    map.insert_scan((0, 0), [(15.9, 15.9)])
    assert map.bounds == (0, 0, 16, 16)
    with pytest.raises(ValueError, match="max_size, 16 m"):
        map.insert_scan((0, 0), [(16, 0)])


# ------------------------------------------------------------------------ of a log
@pytest.mark.parametrize(("name", "scans"), [("malaga", 99), ("corridor", 153), ("room", 61)])
def test_a_map_of_a_bundled_log(name, scans):
    """Catches scans without a pose that are inserted at zero: Malaga knows 99 of 225."""
    log = load(name)
    map = build_map(log, log.truth, resolution=0.1)
    assert map.scans == scans
    known = np.flatnonzero(np.isfinite(log.truth).all(1))
    places = log.truth[known, :2]
    assert (map.occupancy(places) < 0.5).mean() > 0.95  # the robot drove where it is free


@pytest.mark.parametrize(
    ("ranges", "pose", "said"),
    [
        ([1.0], [np.nan] * 3, r"empty: 1 of 1 scans without a pose \(NaN\)$"),
        ([4000.0, 0.0], [0.0] * 3, "0 not finite, 1 not above 0, 1 at max_range or beyond"),
    ],
)
def test_an_empty_map_says_why(ranges, pose, said):
    """Catches ranges in millimetres beyond the largest range in metres, and no word of it."""
    log = Log("blind", [LaserScan(ranges, np.arange(len(ranges)), max_range=8.0)])
    with pytest.warns(UserWarning, match=said):
        assert build_map(log, [pose]).scans == (said[0] == "0")


def test_an_error_of_the_sensor_is_no_free_space():
    """Catches beams with NaN, zero or a negative range that are taken for open space."""
    scan = LaserScan([1.0, np.nan, 0.0, -2.0], np.radians([0, 90, 180, 270]), max_range=3.0)
    maps = [build_map(Log("it", [scan]), [(0, 0, 0)], resolution=0.05, free=f) for f in (0, 1)]
    assert leaves_of(maps[0]) == leaves_of(maps[1])
    assert free_ends(replace(scan, max_range=np.inf), (0, 0, 0)).shape == (0, 2)  # how far?
