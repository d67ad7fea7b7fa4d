"""One per wall: what it takes out, what it tells, and its good maps."""

import numpy as np
import pytest
from segmap_course import known_building

from segmap.metrics import against_walls
from segmap.reduction import one_per_wall
from segmap.segments import SegmentMap


@pytest.mark.parametrize(("before", "joined"), [(1.9, True), (2.1, False)])
def test_what_stands_more_than_two_metres_before_a_gap_does_not_hide_it(before, joined):
    looks = [[(0, 2), (2, 2)], [(2.8, 2), (5, 2)], [(1.9, 2 - before), (2.9, 2 - before)]]
    parents = one_per_wall(SegmentMap(looks, sensors=[(2.4, -40)])).parents
    assert (parents[0] == parents[1]) == joined


@pytest.mark.parametrize(("looks", "known"), [(1, False), (4, False), (5, True)])
def test_less_than_eight_pairs_tell_no_noise(looks, known):
    """Four looks have six pairs, five have ten."""
    found = one_per_wall([[(0, 0.001 * k), (2, 0.001 * k)] for k in range(looks)])
    assert np.isfinite(found.noise) == known and len(found) == 1
    assert "which scan" in found.doubt and "sensor" in found.doubt


@pytest.mark.parametrize("seed", range(1))
@pytest.mark.parametrize("noise", ["0.01", "0.02", "0.03"])
def test_a_floor_has_its_walls_once_and_the_noise_is_that_of_its_looks(noise, seed):
    """A record that outlives the method; a noise that counts headings twice, or not."""
    walls, true, map = known_building("floor", noise, seed)
    found = one_per_wall(map)
    judged = against_walls(walls, found, seen=true)
    assert judged.per_wall <= 1.1 and judged.found == 1 and judged.offset <= 0.01
    assert judged.missed <= 0.01 * judged.seen.sum() >= judged.invented / 3
    way, off = np.diff(map.segments, axis=1)[:, 0], (map.segments - true.segments).mean(axis=1)
    size = np.hypot(*way.T)
    across = (off[:, 1] * way[:, 0] - off[:, 0] * way[:, 1]) / size
    assert found.noise == pytest.approx(np.sqrt((across[size >= 0.3] ** 2).mean()), rel=0.1)
    assert found.noise == pytest.approx(float(noise), rel=0.2)
