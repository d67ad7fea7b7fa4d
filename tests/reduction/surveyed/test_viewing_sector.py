"""The viewing sector: what a scan says of one wall, by hand; room and order for many pieces."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from segmap.reduction import viewing_sector
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal


def scans_of(*scans) -> SegmentMap:
    """A map of scans that were all taken from the origin."""
    which = np.repeat(np.arange(len(scans)), [len(scan) for scan in scans])
    walls = [wall for scan in scans for wall in scan]
    return SegmentMap(walls, which, sensors=np.zeros((len(scans), 2)))


@pytest.mark.parametrize("turn", [0.0, 0.3, np.pi / 2, np.pi - 0.01, np.pi, -2.0])
def test_sectors_all_around(turn):
    """Catches one that is left out: where a turn begins and ends."""
    angles = turn + 2 * np.pi / 40 * np.arange(41)
    corners = np.stack([np.cos(angles), np.sin(angles)], -1)
    walls = np.stack([corners[:-1], corners[1:]], 1)
    found = viewing_sector(scans_of(walls, 1.05 * walls[::-1]))
    assert found.parents.tolist() == [*range(40), *range(40)[::-1]]


def test_a_hundred_doors_that_are_seen_and_then_open():
    """More claims, and more pieces that are gone, than there was room for at first."""
    x = np.arange(100) / 5 - 10
    doors = [[(a, 3), (a + 0.15, 3)] for a in x]
    found = viewing_sector(scans_of(doors, doors, [[(-90, 20), (90, 20)]]))
    assert found.scan_live.tolist() == [100, 100, 1]
    assert found.parents.tolist() == [-1] * 200 + [0]


def test_a_wall_cut_300_times_keeps_its_order():
    """Catches pieces out of order where the numbers of the order are all used up."""
    x = np.arange(-299, 301, 2) / 6
    doors = [[[(4 / 3 * a, 4), (4 / 3 * a + 0.2, 4)]] for a in x]
    found = viewing_sector(scans_of([[(-51, 3), (51, 3)]], *doors))
    starts, count = found.segments[:, 0, 0], len(x) + 1
    assert (np.diff(starts[:count]) > 0).all() and (found.segments[:count, :, 1] == 3).all()
    assert_allclose(starts[count:], 4 / 3 * x)
    assert found.parents[1:].tolist() == list(range(count, 2 * count - 1))


def test_four_things_that_a_scan_can_say():
    """SURVEYED check a: matched, hidden, gone and not looked at; sums weigh 58 against 30."""
    look = [[(-1, 3.02), (0.5, 3.02)], [(0.8, 1.5), (1, 1.5)], [(1.2, 4), (2.4, 4)]]
    found = viewing_sector(scans_of([[(-2, 3), (2, 3)]], look))
    first = [(-2.000007, 3.002985), (0.899975, 3.010146)]
    expected = [first, [(1.6, 3), (2, 3)], *look[1:]]
    assert_segments_equal(found, expected, ordered=True, atol=1e-6)
    assert found.parents.tolist() == [0, 0, 2, 3] and found.scan_live.tolist() == [1, 4]


def test_a_wall_and_a_look_seen_edge_on_say_nothing():
    """Catches a sector without width: division by nothing, a wall that is always matched."""
    wall, look = [[(1, 0), (3, 0)]], [[(0, 2), (0, 4)]]
    across = [[(0.5, -0.01), (0.5, 0.01)], [(-1, 3), (1, 3)]]
    assert_segments_equal(viewing_sector(scans_of(wall, across[:1])), wall)
    found = viewing_sector(scans_of(across[1:], look))
    assert_segments_equal(found, across[1:] + look, ordered=True)


def test_a_stretch_on_a_wall_whose_points_spread_across_it():
    """Catches a wall without length, which ended in a division by nothing: it keeps its place."""
    looks = [[[(0, 1), (0.5, 1)]], [[(0, 1.5), (0.5, 1.5)]], [[(0.25, 1), (0.25, 1.25)]]]
    sensors = [(0.25, 0), (0.25, 0), (1, 1.25)]
    map = replace(scans_of(*looks), sensors=np.array(sensors))
    found = viewing_sector(map, distance=0.5, min_length=0.25, rejoin=False)
    expected = [[(0.25, 1), (0.25, 1.25)], [(0.25, 1.25), (0.25, 1.5)]]
    assert_segments_equal(found, expected, ordered=True)
