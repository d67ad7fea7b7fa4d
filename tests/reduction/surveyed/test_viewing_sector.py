"""The viewing sector: what a scan says of one wall, by hand; a door that opens; poses that err."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from reduction_maps import malaga
from segmap_course.literal.reduction.viewing_sector import kept_pieces, views, wall_of

from segmap import load
from segmap.extraction import build_map
from segmap.poses import transform
from segmap.reduction import viewing_sector
from segmap.segments import SegmentMap, length
from segmap.testing import assert_segments_equal

WALL = [(-2.0, 3.0), (2.0, 3.0)]
AT = (0.0, 0.0)


def scans_of(*scans, sensor=AT) -> SegmentMap:
    """A map of scans that were all taken from one place."""
    which = np.repeat(np.arange(len(scans)), [len(scan) for scan in scans])
    walls = [wall for scan in scans for wall in scan]
    return SegmentMap(walls, which, sensors=np.tile(sensor, (len(scans), 1)))


LOOK = [[(-1, 3.02), (0.5, 3.02)], [(0.8, 1.5), (1, 1.5)], [(1.2, 4), (2.4, 4)]]


@pytest.mark.parametrize("turn", [0.0, 0.3, np.pi / 2, np.pi - 0.01, np.pi, -2.0])
def test_sectors_all_around(turn):
    """Catches one that is left out: where a turn begins and ends."""
    angles = turn + 2 * np.pi / 40 * np.arange(41)
    corners = np.stack([np.cos(angles), np.sin(angles)], -1)
    walls = np.stack([corners[:-1], corners[1:]], 1)
    found = viewing_sector(scans_of(walls, 1.05 * walls[::-1], sensor=(0.0, 0.0)))
    assert found.parents.tolist() == [*range(40), *range(40)[::-1]]


def test_four_things_that_a_scan_can_say():
    """SURVEYED check a: matched, hidden, gone and not looked at; sums weigh 58 against 30."""
    found = viewing_sector(scans_of([WALL], LOOK))
    first = [(-2.000007, 3.002985), (0.899975, 3.010146)]
    expected = [first, [(1.6, 3), (2, 3)], *LOOK[1:]]
    assert_segments_equal(found, expected, ordered=True, atol=1e-6)
    assert found.parents.tolist() == [0, 0, 2, 3] and found.scan_live.tolist() == [1, 4]


def test_the_stretches_on_the_wall():
    """SURVEYED check a: where the rays carry each stretch; on either side of the sector's end."""
    seen = [view for s in LOOK for view in views(WALL, s, AT, 0.10)]
    assert [view.says for view in seen] == ["matches", "hides", "gone"]
    assert_allclose([(v.u0 - 2, v.u1 - 2) for v in seen[1:]], [(1.6, 2.0), (0.9, 1.8)])
    kept = kept_pieces(4.0, seen, 0.10, True, True)
    assert_allclose(kept, [(0, 2.9), (3.6, 4.0)])


def test_without_forgetting_the_wall_stays_whole():
    """SURVEYED check b."""
    found = viewing_sector(scans_of([WALL], LOOK), forget=False)
    assert len(found) == 3
    assert_allclose(found.segments[0, :, 0], (-2, 2), atol=1e-4)


def test_a_turned_look_removes_a_true_wall():
    """SURVEYED check c, the weakness: an error of 11 degrees erases x 0.484 to 0.9375."""
    found = viewing_sector(scans_of([WALL], [[(-1, 2.8), (1, 3.2)]]))
    assert_allclose(found.segments[1], [(0.9375, 3), (2, 3)])
    assert found.segments[0, :, 0].max() == pytest.approx(0.5, abs=2e-3)
    (match,) = (v for v in views(WALL, [(-1, 2.8), (1, 3.2)], AT, 0.1) if v.says == "matches")
    assert_allclose((match.t0, match.t1), (0.25, 0.75))


def test_a_door_that_opens_is_forgotten_and_one_that_is_hidden_is_not():
    """The only method that forgets: what stands in the way of a look is not gone."""
    beside = [[(-2, 3), (-1, 3)], [(1, 3), (2, 3)]]
    behind = [[(-3.0, 5), (3.0, 5)]]
    opened = viewing_sector(scans_of([WALL], beside + behind))
    assert_segments_equal(opened, [*beside, *behind], atol=1e-6)
    hidden = viewing_sector(scans_of([WALL], [*beside, [(-0.7, 2), (0.7, 2)], *behind]))
    assert_allclose(hidden.segments[0, :, 0], (-2, 2), atol=1e-6)


def test_rejoin_is_ours_and_without_it_maps_grow():
    """A cuts a wall into matched and unseen pieces and keeps each."""
    scans = [WALL], [[(-1, 3), (0.5, 3)]]
    assert_segments_equal(viewing_sector(scans_of(*scans)), [WALL])
    cut = viewing_sector(scans_of(*scans), rejoin=False)
    expected = [[(-2, 3), (-1, 3)], [(-1, 3), (0.5, 3)], [(0.5, 3), (2, 3)]]
    assert_segments_equal(cut, expected, ordered=True)


def test_a_wall_seen_edge_on_says_nothing():
    """Catches a sector without width: division by nothing, a wall that is always matched."""
    found = viewing_sector(scans_of([[(1, 0), (3, 0)]], [[(0.5, -0.01), (0.5, 0.01)]]))
    assert_segments_equal(found, [[(1, 0), (3, 0)]])


def test_two_walls_that_a_look_crosses_claim_it_equally():
    """From +distance to -distance the mean of |h| is distance / 2, whatever the angle: a tie.

    The lower wall gets the stretch that both claim; SURVEYED's rule decides nothing here.
    """
    look = [(-0.2, 3.0), (0.2, 3.0)]
    walls = [[(-0.5, 2.5), (0.5, 3.5)], [(0.5, 2.5), (-0.5, 3.5)]]
    offs = [v.off for wall in walls for v in views(wall, look, AT, 0.1) if v.says == "matches"]
    assert offs == [pytest.approx(0.05)] * 2
    first = viewing_sector(scans_of(walls, [look]), forget=False)
    assert first.parents[2] == 0


def test_duplicates_in_the_map_never_meet():
    """Weak, like Hybrid: only a scan is compared with the map."""
    assert len(viewing_sector(scans_of([WALL, WALL]))) == 2
    assert len(viewing_sector(scans_of([WALL], [WALL]))) == 1


def test_every_scan_twice_gives_as_many_segments():
    """SURVEYED check d, where nothing is gone."""
    log = load("room")
    map = build_map(log[:6], log.truth[:6], keep_points=True).filtered()
    once = viewing_sector(map, forget=False)
    rows = np.repeat(np.arange(len(map)), 2)
    twice = map[rows]
    scan = 2 * twice.scan + np.tile([0, 1], len(map))
    placed = replace(twice, scan=scan, sensors=np.repeat(map.sensors, 2, axis=0))
    assert len(viewing_sector(placed, forget=False)) == len(once)


@pytest.mark.parametrize("pose", [(0, 0, 2.0), (-70, 40, 0), (50, -80, -2.9)])
def test_the_result_moves_with_the_map_and_its_sensors(pose):
    """SURVEYED check d, on real scans with their points."""
    map = malaga()[:250]
    there = replace(
        map,
        segments=transform(pose, map.segments),
        points=transform(pose, map.points),
        sensors=transform(pose, map.sensors),
    )
    found, expected = viewing_sector(there), viewing_sector(map)
    assert_segments_equal(found, transform(pose, expected.segments), ordered=True, atol=1e-6)
    assert found.parents.tolist() == expected.parents.tolist()


def test_points_weigh_and_not_lengths():
    """Catches running sums of stand-ins where the points are known: 3 against 30 of them."""
    walls = np.array([WALL, WALL]) + [[[0, 0]], [[0, 0.08]]]
    counts = (30, 3)
    points = [
        w[0] + np.linspace(0, 1, n)[:, None] * (w[1] - w[0])
        for w, n in zip(walls, counts, strict=True)
    ]
    map = SegmentMap(
        walls, [0, 1], points=np.concatenate(points), first=[0, 30, 33], sensors=[AT, AT]
    )
    found = viewing_sector(map)
    assert_allclose(found.segments[0, :, 1], 3 + 0.08 * 3 / 33, atol=1e-9)
    even = wall_of(0, WALL, None, 0.05).sums
    assert (even.n, even.xx) == (pytest.approx(80), pytest.approx(80 * 16 / 12))
    assert math.isclose(even.yy, 0.0) and length(found.segments)[0] == pytest.approx(4.0)
