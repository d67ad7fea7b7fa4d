"""Segment similarity: nothing cheap is left, and which pair comes first."""

import numpy as np
import pytest
from reduction_maps import MAPS, malaga

from segmap.metrics import segment_distance
from segmap.reduction import segment_similarity

WALL = [(0.0, 0.0), (2.0, 0.0)]


@pytest.mark.parametrize("distance", [0.01, 0.03, 0.1])
@pytest.mark.parametrize("make", [*MAPS, lambda rng: malaga().segments[:600]])
def test_no_two_that_are_left_cost_less(make, distance):
    """Catches a pair that the grid hides, a group that does not look again when it has grown."""
    segments = make(np.random.default_rng(3))
    found = segment_similarity(segments, distance=distance)
    weights = np.bincount(found.parents[found.parents >= 0])
    assert weights.sum() == (np.ptp(segments, axis=1).max(1) > 0).sum()
    s = found.segments
    cost = segment_distance(s[:, None], s[None], weights[:, None], weights[None])
    cost[np.diag_indices(len(s))] = np.inf
    assert cost.min() >= distance - 1e-9


def test_of_equal_costs_the_lowest_indices_come_first():
    """Catches ties that rounding or the order of the cells decides: all these pairs cost 0."""
    x = [0.0, 3.0, 1.0, 2.0]  # pieces of one line, out of order: 0-1, 3-4, 1-2, 2-3
    found = segment_similarity([[(a, 0), (a + 1, 0)] for a in x], distance=1e-6)
    assert found.parents.tolist() == [0, 0, 0, 0]
    two_ways = [WALL, [(0, 0.05), (2, 0.05)], [(0, -0.05), (2, -0.05)]]
    assert segment_similarity(two_ways, distance=0.018).parents.tolist() == [0, 0, 1]
    # 1 and 2 first; then their mean, 1 m off, costs 0 as much as 3 does
    y = 0.03840407735
    rest = [[(3, -0.105), (4, -0.105)], [(3, 0.045), (4, 0.045)], [(-2, y), (-1, y)]]
    assert segment_similarity([WALL, *rest], distance=0.2535).parents.tolist() == [0, 0, 0, 1]
