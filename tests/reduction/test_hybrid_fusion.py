"""Hybrid with Fusion: when it fuses, and the live map."""

from inspect import signature

import numpy as np
import pytest

from segmap.reduction import LiveReduction, hybrid_fusion
from segmap.segments import SegmentMap


def test_a_live_map_is_that_of_the_method():
    """Catches a fusion that comes too early or too late, and counts lost where room is made."""
    rng, order = np.random.default_rng(5), np.repeat([[0, 2], [1, 3], [0, 2]], 6, 0)
    walls = np.array([[(0, y), (4, y)] for y in order.ravel()])
    map = SegmentMap(walls + rng.normal(0, 0.02, walls.shape), np.arange(18).repeat(2))
    live = LiveReduction(every=5)
    _, *options = signature(hybrid_fusion).parameters.values()
    assert signature(LiveReduction).parameters == {option.name: option for option in options}
    for part in (map.segments[:0], *map.by_scan()):  # one without segments is no scan
        live.add(part)
        if live.scans % 5 == 0 and live.scans:
            found = hybrid_fusion(map[map.scan < live.scans], every=5)
            np.testing.assert_array_equal(live.segments, found.segments)
    assert live.scans == 18


@pytest.mark.parametrize(
    ("every", "live"), [(1, [1, 2, 3, 4]), (2, [2, 2, 4, 4]), (3, [2, 4, 3, 4]), (9, [2, 4, 6, 4])]
)
def test_fusion_runs_after_every_so_many_scans_and_the_last(every, live):
    """Each scan brings a wall that Hybrid keeps in two; scans without segments do not count."""
    walls = [[[(0, y), (2, y)], [(3, y), (5, y)], [(1.9, y), (3.1, y)]] for y in (0, 5, 10, 15)]
    map = SegmentMap(np.concatenate(walls), np.repeat([0, 4, 6, 9], 3))
    found = hybrid_fusion(map, every=every)
    assert len(found.scan_seconds) == 4
    np.testing.assert_array_equal(found.scan_live, live)
