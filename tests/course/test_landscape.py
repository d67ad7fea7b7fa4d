"""Landscapes of scores: the right pose in the middle, axes the right way round, peaks counted."""

import numpy as np
import pytest
from segmap_course import heading_profile, landscape, peaks, profile_peaks, room_walk

from segmap.matching import distance_score, nearest_score, occupancy_score
from segmap.poses import transform
from segmap.quadtree import build_map


def walked(scans=40):
    """The map of the first scans of the walk, the next scan and its pose."""
    log = room_walk()
    map = build_map(log[:scans], log.truth[:scans], resolution=0.01)
    return map, log[scans].points(), log.truth[scans]


@pytest.mark.parametrize("score", [nearest_score, occupancy_score])
def test_each_value_is_the_score_of_its_pose(score):
    """Catches x and y exchanged, and offsets that turn with the robot."""
    map, points, pose = walked(10)
    offsets, values = landscape(map, points[::9], pose, score=score, reach=0.1, step=0.05)
    np.testing.assert_allclose(offsets, [-0.1, -0.05, 0, 0.05, 0.1])
    for row, column in [(0, 4), (2, 2), (3, 1)]:
        moved = transform(pose, points[::9]) + (offsets[column], offsets[row])
        expected = score(map, moved, (0, 0, 0))[0]
        assert values[row, column] == pytest.approx(expected)


def test_the_profile_turns_the_robot():
    map, points, pose = walked(10)
    turn, values = heading_profile(map, points[::9], pose, score=distance_score, step=np.pi / 2)
    assert turn.tolist() == pytest.approx([-np.pi, -np.pi / 2, 0, np.pi / 2, np.pi])
    assert values[0] == pytest.approx(values[4]) and values.argmax() == 2
    expected = distance_score(map, points[::9], pose + (0, 0, np.pi / 2))[0]
    assert values[3] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([1, 1, 1], [[0]]),
        ([0, 1, 1, 2, 0], [[3]]),
        ([2, 1, 1, 1, 3], [[4], [0]]),
        ([0, 2, 2, 0, 2, 2, 3], [[6], [1]]),
        ([[0, 0, 0], [0, 0, 1], [0, 0, 0]], [[1, 2]]),
        ([[2, 0, 0], [0, 0, 0], [0, 0, 1]], [[0, 0], [2, 2]]),
        ([[5, 5, 0], [0, 0, 5], [0, 0, 6]], [[2, 2]]),
    ],
)
def test_peaks(values, expected):
    """A plateau counts once, and not at all where anything beside it is higher."""
    assert peaks(values).tolist() == expected


@pytest.mark.parametrize("shift", range(8))
def test_the_ends_of_a_whole_turn_are_one_place(shift):
    """Catches a peak at -180 degrees that is lower than its neighbour at 179."""
    heights = np.roll([0, 2, 1, 0, 3, 3, 1, 0], shift)
    turn = np.linspace(-np.pi, np.pi, 9)
    found = profile_peaks(turn, np.append(heights, heights[0]))
    assert [int(heights[k]) for k in found] == [3, 2] and found.max() < 8
    assert profile_peaks(turn, np.ones(9)).tolist() == [0]
    part = profile_peaks(turn / 2, np.arange(9.0))  # half a turn has two borders
    assert part.tolist() == [8]
