"""Panels on the quadtree, and the two ways of inserting rays that fail."""

import numpy as np
import pytest
from quadtrees import leaves_of

from segmap import Log, load
from segmap.course import ClassesPanel, RayPanel, insert_variant
from segmap.course._panels_quadtree import touched_cells
from segmap.exports import ros_classes
from segmap.panels import QuadtreePanel
from segmap.quadtree import QuadtreeMap, build_map
from segmap.simulation import square_room


@pytest.mark.parametrize("seed", range(10))
def test_without_a_failure_the_variant_is_the_map(seed):
    """Catches a variant that differs by more than what it is to show."""
    rng = np.random.default_rng(seed)
    maps = [QuadtreeMap(resolution=0.1, size=1.6) for _ in range(2)]
    for _ in range(3):
        sensor, ends = rng.normal(0, 1, 2), rng.normal(0, 3, (12, 2))
        maps[0].insert_scan(sensor, ends)
        insert_variant(maps[1], sensor, ends)
    assert leaves_of(maps[0]) == leaves_of(maps[1])


def test_without_the_mask_a_ray_crosses_the_neighbours_of_its_end():
    """By hand: of five cells in a row the mask spares two, without it only the end is spared."""
    counts = {}
    for mask in (True, False):
        map = QuadtreeMap(resolution=1, size=4)
        insert_variant(map, (0.5, 0.5), [(x + 0.5, 0.5) for x in range(4)])
        insert_variant(map, (0.5, 0.5), [(3.5, 0.5)], mask=mask)
        counts[mask] = np.array([leaves_of(map)[(x, 0, 1)][0] for x in range(4)])
    assert (counts[False] - counts[True]).tolist() == [0, 0, 1, 0]


@pytest.mark.parametrize("seed", range(30))
def test_touched_cells_are_those_whose_square_the_segment_meets(seed):
    """Against every cell of a box, by clipping the segment to its square."""
    rng = np.random.default_rng(seed)
    start, end = rng.integers(-6, 7, (2, 2))
    expected = set()
    for x in range(-9, 9):
        for y in range(-9, 9):
            low, high = 0.0, 1.0
            for a, d, c in ((start[0], end[0] - start[0], x), (start[1], end[1] - start[1], y)):
                if d == 0:
                    low = low if c <= a <= c + 1 else 2.0
                else:
                    t = sorted(((c - a) / d, (c + 1 - a) / d))
                    low, high = max(low, t[0]), min(high, t[1])
            if low <= high + 1e-12:
                expected.add((x, y))
    found = touched_cells(tuple(start.tolist()), tuple(end.tolist()))
    assert {tuple(c) for c in found.tolist()} == expected


def test_both_failures_do_what_the_thesis_shows():
    """B fig. 4.5: walls turn grey, and space outside turns free; the mask alone cures the first."""
    panel = RayPanel()
    share = {}
    for touched in (False, True):
        for mask in (True, False):
            panel.touched.value, panel.mask.value = touched, mask
            share[touched, mask] = panel.walls_kept.value.split()[0], panel.outside.value
    assert share[False, True] == ("100", "0.00 m\u00b2 free outside")
    assert int(share[False, False][0]) < 100
    assert int(share[True, False][0]) < 50 and share[True, False][1] > share[False, False][1]


def test_free_outside_is_measured_beyond_the_walls():
    """Catches an area that counts the room itself, or leaves that the walls cut."""
    panel = RayPanel(square_room(4.0), [(1.5, 1.6, 0.2)])
    assert panel.free_outside() == 0
    panel.map.tree.vis[panel.map.tree.vis == 1] = 50
    leaves = panel.map.leaves()
    assert 0 < panel.free_outside() < (leaves.side**2).sum() - 16


def test_quadtree_panel_shows_the_map_of_the_first_scans():
    """Catches a slider that is one scan late, and scans without a pose that stop it."""
    log = load("room")
    poses = log.truth.copy()
    poses[1] = np.nan
    panel = QuadtreePanel(log, poses)
    panel.scans.value, panel.doublings.value = 3, 1
    expected = build_map(log[:3], poses[:3], resolution=0.1, free=False)
    assert leaves_of(panel.map) == leaves_of(expected) and panel.map.scans == 2
    assert panel.leaves.value == f"{len(expected.leaves().x)} leaves of 0.1 m and more"
    panel.scans.value = 2
    assert panel.map.scans == 1


def test_quadtree_panel_needs_poses():
    with pytest.raises(ValueError, match="log 'room' has no truth: give poses"):
        QuadtreePanel(Log("room", load("room").scans))


def test_classes_panel_shows_what_is_exported():
    """Catches thresholds that are not handed on."""
    log = load("room")
    map = build_map(log, log.truth)
    panel = ClassesPanel(map)
    for occupied, free, k in ((0.5, 0.25, 0), (0.9, 0.25, 0), (0.5, 0.0, 2)):
        panel.occupied.value, panel.free.value, panel.doublings.value = occupied, free, k
        found = ros_classes(map, resolution=0.05 * 2**k, occupied=occupied, free=free)
        assert np.array_equal(panel.classes.greys, found.greys)
        counts = [int(part.split()[0]) for part in panel.counts.value.split(", ")]
        assert counts == [(found.greys == grey).sum() for grey in (254, 205, 0)]
