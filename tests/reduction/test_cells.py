"""The grid of segments that similarity, uncertain parameters and polylines look around in."""

import numpy as np
import pytest

from segmap.reduction._cells import empty_cells, enter, leave, near
from segmap.segments import point_distance


def nearness(s: np.ndarray) -> np.ndarray:
    """D_uv of every pair, metres."""
    there = point_distance(s[:, None], s[None, :, None]).min(-1)
    return np.minimum(there, there.T)


@pytest.mark.parametrize("reach", [0.02, 0.3, 3.0])
@pytest.mark.parametrize("shift", [0.0, -1e4])
def test_what_is_near_is_found_once_and_nothing_else(reach, shift):
    """Catches a level whose cells are too small, a column or row too few, a slot that is shared."""
    rng = np.random.default_rng(7)
    middle, turn = rng.uniform(-8, 8, (400, 1, 2)), rng.uniform(0, 2 * np.pi, 400)
    half = (10 ** rng.uniform(-2, 0.8, 400) * np.stack([np.cos(turn), np.sin(turn)]) / 2).T
    s = np.ascontiguousarray(middle + shift + np.stack([-half, half], 1))
    cells, found = empty_cells(s, reach, len(s)), np.empty(len(s), np.int64)
    for i in range(len(s)):
        enter(cells, s, i)
    for i in range(0, len(s), 3):
        leave(cells, i)
    expected = nearness(s) < reach
    expected[:, ::3] = False
    for i in range(len(s)):
        here = np.sort(found[: near(cells, s, s[i], found)])
        np.testing.assert_array_equal(here, np.flatnonzero(expected[i]))
