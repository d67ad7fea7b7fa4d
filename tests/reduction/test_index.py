"""The index of boxes that all methods look around in."""

import numpy as np
import pytest

from segmap.reduction._index import empty_index, enter, meeting, take_out


@pytest.mark.parametrize("unit", [0.02, 0.3, 300.0])
@pytest.mark.parametrize("shift", [0.0, -1e4])
def test_what_meets_is_found_once_and_nothing_else(unit, shift):
    """Catches a level whose cells are too small, a column or row too few, a slot that is shared."""
    rng = np.random.default_rng(7)
    size = 10 ** rng.uniform(-2, 1.5, (400, 1, 1))
    s = rng.uniform(-8, 8, (400, 1, 2)) + shift + size * rng.uniform(-0.5, 0.5, (400, 2, 2))
    reach = np.where(np.arange(400) % 2, 0.0, 0.1)
    index, found = empty_index(400, unit), np.empty(401, np.int64)
    for i in range(400):
        enter(index, i, s[i], reach[i])
    for i in range(0, 400, 3):
        take_out(index, i)
    low, high = s.min(1) - reach[:, None], s.max(1) + reach[:, None]
    expected = (low[:, None] <= high + 0.2).all(-1) & (high[:, None] >= low - 0.2).all(-1)
    expected &= expected.T  # both were grown by 0.2 once
    expected[:, ::3] = False
    for i in range(400):
        here = np.sort(found[: meeting(index, s[i], reach[i] + 0.2, found)])
        np.testing.assert_array_equal(here, np.flatnonzero(expected[i]))


def test_a_touch_is_a_meeting():
    """Catches rounding that hides what just touches, in cells that end there."""
    index, found = empty_index(2, 0.1), np.empty(3, np.int64)
    for place in (0.3, 1e6 + 0.1, -7.7):
        enter(index, 0, np.array([[place, 0.0]]), 0.0)
        assert meeting(index, np.array([[place + 0.1, 0.1]]), 0.1, found) == 1
        assert meeting(index, np.array([[place + 0.1, 0.1]]), 0.099, found) == 0
        take_out(index, 0)


def test_a_box_wider_than_all_levels_is_in_the_last_one():
    """Catches a level that is not there: the count was written beside the array."""
    index, found = empty_index(2, 0.1), np.empty(3, np.int64)
    enter(index, 0, np.zeros((1, 2)), 1e77)
    assert index.levels[-2, 0] == index.levels[-1, 0] == 1
    assert meeting(index, np.full((1, 2), 5.0), 0.1, found) == 1
    take_out(index, 0)
    assert not index.levels[:, 0].any()
