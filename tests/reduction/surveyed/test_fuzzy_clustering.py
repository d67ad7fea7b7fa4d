"""Fuzzy clustering, a reconstruction: its clusters by hand, its cells, and what they cost."""

import numpy as np
import pytest

from segmap import load
from segmap.extraction import build_map
from segmap.poses import transform
from segmap.reduction import fuzzy_clustering
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal

STEPS = np.arange(11) / 10
#: The points of SURVEYED's check a: two walls that meet in a corner, and one far from both.
CORNER = np.array([*((x, 0) for x in STEPS), *((0, y) for y in STEPS[1:]), (0.6, 0.6)])
#: A wall through four cells, and one that ends in its cell.
WALLS = np.array([[(0.2, 1.0), (7.8, 1.1)], [(5.2, 0.2), (5.3, 0.9)]])


def looks(walls, times: int) -> SegmentMap:
    """As many scans that each see all walls."""
    return SegmentMap(np.tile(walls, (times, 1, 1)), np.repeat(np.arange(times), len(walls)))


def test_the_same_corner_as_a_map():
    """Catches noise that joins a wall; the corner's point goes to the first of equals."""
    walls = [[(0, 0), (1, 0)], [(0, 0), (0, 1)]]
    map = SegmentMap(walls, points=CORNER, first=[0, 11, 22])
    found = fuzzy_clustering(map, corner=(-0.5, -0.5))
    assert_segments_equal(found, [walls[0], [(0, 0.1), (0, 1)]], atol=1e-9, ordered=True)
    assert found.parents.tolist() == [0, 1]


def test_walls_end_at_cells_until_they_are_grouped():
    """A grouping too early, too late or never; a last one that is forgotten."""
    once = [[(0.2, 1.0), (7.8, 1.0)]]
    assert fuzzy_clustering(looks(once, 3), every=2).scan_live.tolist() == [4, 1, 1]
    assert fuzzy_clustering(looks(once, 3)).scan_live.tolist() == [4, 4, 1]
    assert_segments_equal(fuzzy_clustering(looks(once, 3)), once, atol=0.03)


@pytest.mark.parametrize("make", [lambda: looks(WALLS, 3), lambda: the_room()])
def test_whole_cells_and_quarter_turns_move_the_result(make):
    """SURVEYED check b: cells that are dealt by rounding, corners left out, rows for columns."""
    map = make()
    found = fuzzy_clustering(map)
    moved = fuzzy_clustering(carried(map, (2.0, -2.0, 0.0)))
    expected = transform((2.0, -2.0, 0.0), found.segments)
    assert_segments_equal(moved, expected, ordered=True, atol=1e-6)
    about = fuzzy_clustering(carried(map, (-7.0, 3.0, 0.3)), corner=(0.5, 0.5))
    there = fuzzy_clustering(carried(map, (-7.5, 2.5, 0.3)))
    assert_segments_equal(about, there.segments + 0.5, ordered=True, atol=1e-6)


def test_a_quarter_turn_about_the_corner_turns_the_result():
    """SURVEYED check b."""
    map, quarter = looks(WALLS, 3), (0, 0, np.pi / 2)
    expected = transform(quarter, fuzzy_clustering(map).segments)
    assert_segments_equal(fuzzy_clustering(carried(map, quarter)), expected, atol=1e-6)


def carried(map: SegmentMap, pose) -> SegmentMap:
    return SegmentMap(transform(pose, map.segments), map.scan)


def the_room() -> SegmentMap:
    log = load("room")
    return build_map(log, log.truth).filtered()


@pytest.mark.parametrize("walls", [WALLS, None])
def test_every_scan_twice_gives_as_many_segments(walls):
    """SURVEYED check c: a second look that does not find the first."""
    map = the_room()[:100] if walls is None else looks(walls, 3)
    twice = SegmentMap(np.concatenate([map.segments] * 2), np.concatenate([map.scan] * 2))
    twice = SegmentMap(twice.segments, np.append(2 * map.scan, 2 * map.scan + 1))
    assert len(fuzzy_clustering(twice, every=1)) == len(fuzzy_clustering(map, every=1))


@pytest.mark.parametrize(
    ("second", "options", "left"),
    [
        ([(0.3, 0.59), (1.7, 0.59)], {}, 1),
        ([(0.3, 0.61), (1.7, 0.61)], {}, 2),
        ([(0.3, 0.61), (1.7, 0.61)], {"distance": 0.12}, 1),
        ([(0.9, 0.41), (1.1, 0.59)], {"angle": 0.7}, 2),
        ([(0.9, 0.41), (1.1, 0.59)], {"angle": 0.8}, 1),
    ],
)
def test_distance_and_angle(second, options, left):
    """A threshold in the wrong unit; a middle that is compared with its own line."""
    map = SegmentMap([[(0.3, 0.5), (1.7, 0.5)], second], [0, 1])
    assert len(fuzzy_clustering(map, **options)) == left


@pytest.mark.parametrize(("more", "left"), [(-0.01, 2), (0.01, 1)])
def test_a_gap_between_two_pieces(more, left):
    """Centres instead of ends; points begin half a step, 2.3 cm, behind the ends."""
    map = SegmentMap([[(0.2, 0.5), (0.8, 0.5)], [(1.05, 0.5), (1.65, 0.5)]], [0, 1])
    assert len(fuzzy_clustering(map, gap=0.25 + 0.6 / 13 + more)) == left


def test_few_points_and_short_walls_are_dropped():
    short = [[(0.2, 0.5), (0.44, 0.5)]]  # five points over 0.192 m
    assert len(fuzzy_clustering(short)) == 1
    assert len(fuzzy_clustering(short, min_points=6)) == 0
    assert len(fuzzy_clustering(short, min_length=0.193)) == 0


def test_a_later_look_joins_the_wall_that_its_cell_knows():
    """Catches a buffer that forgets its members: a bent end is near its piece, and not the wall."""
    wall, bend = [(0.2, 1.0), (11.2, 1.0)], [(10.2, 1.0), (11.8, 1.05)]
    found = fuzzy_clustering(SegmentMap([wall, bend], [0, 1]), every=1)
    assert len(found) == 1 and found.parents.tolist() == [0, 0]
    assert_segments_equal(found, [[(0.2, 1.0), (11.8, 1.0)]], atol=0.05)


def test_walls_of_the_buffer_that_a_look_joins_are_one_segment():
    """Catches pieces beside each other that stay two in the buffer, or are counted twice."""
    half, other, both = [(0.2, 0.5), (0.8, 0.5)], [(1.2, 0.5), (1.8, 0.5)], [(0.6, 0.5), (1.4, 0.5)]
    found = fuzzy_clustering(SegmentMap([half, other, both], [0, 1, 2]), every=2)
    assert found.scan_live.tolist() == [1, 2, 1]
    found = fuzzy_clustering(SegmentMap([half, other, both, half], [0, 1, 2, 3]), every=2)
    assert found.scan_live.tolist() == [1, 2, 1, 1]
    assert_segments_equal(found, [[(0.2, 0.5), (1.8, 0.5)]], atol=0.05)


def test_walls_that_cross_at_right_angles_are_never_alike():
    """Both middles lie on both lines: the turn alone tells, and it must be less than the angle."""
    cross = SegmentMap([[(0.5, 1), (1.5, 1)], [(1, 0.5), (1, 1.5)]], [0, 1])
    assert len(fuzzy_clustering(cross, angle=np.pi / 2)) == 2


@pytest.mark.filterwarnings("ignore:cell is 10000 m:UserWarning")
@pytest.mark.parametrize(("cell", "what"), [(1e-9, "larger"), (1e4, "smaller")])
def test_cells_that_no_map_can_bear(cell, what):
    """Memory, in bytes and not in metres."""
    many = np.tile([[(0.0, 1.0), (900.0, 1.0)]], (40, 1, 1))
    many[:, :, 1] += np.arange(40)[:, None]
    with pytest.raises(ValueError, match=rf"^cell must be {what}"):
        fuzzy_clustering(many, cell=cell)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("axis", range(2))
def test_a_map_as_far_as_cells_have_numbers(axis):
    """Catches a row of cells that goes on in the next one."""
    wall, cell = np.array([[(0.0, 0.5), (0.75, 0.5)]]), 2.0**-8
    near, far = (np.roll(cell * (wall + (out, 0)), axis, -1) for out in (2**31 - 1, 2**31))
    fuzzy_clustering(near, cell=cell)
    with pytest.raises(ValueError, match=r"^cell must be larger"):
        fuzzy_clustering(far, cell=cell)


@pytest.mark.parametrize("corner", [np.nan, (0.0, np.inf), (1.0, 2.0, 3.0)])
def test_a_corner_is_a_point(corner):
    with pytest.raises(ValueError, match=r"^corner must be"):
        fuzzy_clustering(WALLS, corner=corner)
