"""What must not break a map: an interrupt anywhere in a scan, and more rays than a count holds."""

import sys
from contextlib import suppress

import numpy as np
import pytest
from conftest import slow

from segmap.matching import distance_score, nearest_score
from segmap.quadtree import QuadtreeMap

#: Of the calls and returns of two scans that grow, split and join.
STEPS = [*range(2, 75, 8), *range(75, 480, 36), *map(slow, range(1, 480, 3))]


def scan(seed):
    """Ends all about, beyond the root of a first map too."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0, 4, 2), rng.uniform(-9, 13, (60, 2)), rng.uniform(0, 4, (9, 2))


@pytest.mark.parametrize("free_resolution", [None, 0.4])  # the thesis joins nothing
@pytest.mark.parametrize("step", STEPS)
def test_an_interrupt_leaves_a_tree(step, free_resolution, tmp_path):
    """Catches blocks that a loop took and its caller never heard of: the next scan took them again,
    the file was refused, and scores read beyond what they knew of the tree before."""
    map = QuadtreeMap(resolution=0.1, size=6.4, free_resolution=free_resolution)
    map.insert_scan(*scan(0))
    nearest_score(map, [(0, 0)], (1, 1, 0))  # it remembers the tree as it is
    left = step

    def count(frame, event, argument):
        nonlocal left
        left -= event in ("call", "return")
        if left == 0:
            sys.setprofile(None)
            raise KeyboardInterrupt

    scans = [[20 * part for part in scan(seed)] for seed in (1, 2)]
    with suppress(KeyboardInterrupt):
        try:
            sys.setprofile(count)
            for each in scans:
                map.insert_scan(*each)
        finally:
            sys.setprofile(None)
    for seed in (None, 3):
        if seed is not None:
            map.insert_scan(*scan(seed))
        map.save(tmp_path / "it.npz")
        again = QuadtreeMap.load(tmp_path / "it.npz")  # checks that the blocks hang together
        assert all(map.leaves()[k].tolist() == again.leaves()[k].tolist() for k in range(5))
        assert map.leaves().side @ map.leaves().side == pytest.approx(map.side**2)
        at = np.random.default_rng(4).uniform(-50, 50, (30, 3))
        expected = distance_score(map, [(0, 0)], at)
        assert nearest_score(map, [(0, 0)], at) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("most", ["vis", "both"])
def test_counts_stop_at_the_largest(most):
    """Catches a count that wraps and is then taken for a place: four days of a robot that stands
    still, and the process died."""
    map = QuadtreeMap(resolution=1, size=8)
    map.insert_scan((0.5, 0.5), [(6.5, 1.5)], [(7.5, 7.5)])
    node = map.tree.leaves()[0]
    map.tree.vis[node] = 2**31 - 2
    if most == "both":
        map.tree.occ[map.tree.occ > 0] = 2**31 - 2
    for _ in range(3):
        map.insert_scan((0.5, 0.5), [(6.5, 1.5)] * 3, [(7.5, 7.5)])
    found = map.leaves()
    assert len(found.vis) == len(node) and found.vis.min() >= 2**31 - 2
    assert (found.occ <= found.vis).all() and found.vis.max() == 2**31 - 1
    assert map.occupancy([(6.5, 1.5)])[0] == (1.0 if most == "both" else pytest.approx(0, abs=1e-8))
    if most == "both":  # twice such a count is no count
        scores = [score(map, [(6.5, 1.5)], (0, 0, 0)) for score in (nearest_score, distance_score)]
        assert scores[0] == scores[1] == 0
