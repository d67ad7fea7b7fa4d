"""Fusion: what differs from it when it runs after every scan."""

import numpy as np
import pytest

from segmap.reduction import fusion, fusion_online
from segmap.segments import SegmentMap


def test_a_map_for_which_the_square_is_too_slow_is_warned_of(monkeypatch):
    """Catches a user who waits for minutes and does not know why."""
    monkeypatch.setattr("segmap.reduction._fusion.MOST_ONLINE_SEGMENTS", 400)
    far = np.arange(401.0)[:, None, None] + [[0.1, 0.2], [0.3, 0.2]]
    with pytest.warns(UserWarning, match="fusion_online is slow.* square of 401 segments"):
        assert len(fusion_online(far)) == len(far)
    assert len(fusion_online(far[1:])) == len(far) - 1  # it would be an error


def test_on_line_every_pass_widens_what_a_strip_reaches():
    """The counter-example: looks that drift away are one wall on-line and two off-line.

    A wall that has taken in a look 8 cm beside it stands between both, and reaches the next.
    """
    drift = [[(0, y), (2, y)] for y in (0.0, 0.08, 0.12, 0.14)]
    map = SegmentMap(drift, range(4))
    found = fusion_online(map, tolerance=0.05)
    assert found.scan_live.tolist() == [1, 1, 1, 1]
    assert len(fusion(map, tolerance=0.05)) == 2
