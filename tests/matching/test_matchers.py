"""The greedy matchers against their literal forms (B 4.3)."""

from functools import partial

import numpy as np
import pytest
from quadtrees import random_map
from segmap_course import literal

from segmap.angles import wrap
from segmap.matching import field_score, hill_climb, nearest_score, occupancy_score, sample_and_rank
from segmap.quadtree import QuadtreeMap
from segmap.segments import SegmentMap

MAP = QuadtreeMap()
SCAN = np.array([(1.0, 0.0)])
THESIS = [(0.001, np.radians(1.0))]
HALVING = [(0.016 / 2**k, np.radians(1.6) / 2**k) for k in range(5)]


class Watched:
    """A score that remembers what it was asked."""

    def __init__(self, value):
        self.value, self.asked = value, []

    def __call__(self, map, points, poses):
        self.asked.append(np.array(poses))
        return np.array([self.value(*pose) for pose in poses], float)


def bowl(x, y, heading):
    """A hill whose sides are steeper in y than in x, about (0.1, -0.04, 0.05)."""
    return -(abs(x - 0.1) + 2 * abs(y + 0.04) + 3 * abs(heading - 0.05))


#: In most some moves are equal, of which the first counts, or no better than none.
VALUES = [
    bowl,
    lambda x, y, h: 3.0,
    lambda x, y, h: abs(x) + abs(y) + abs(h),
    lambda x, y, h: x + y,
    lambda x, y, h: max(y, h > 0),
    lambda x, y, h: (y > 0) + (h < 0),
    lambda x, y, h: round(9 * bowl(x, y, h)),
]


@pytest.mark.parametrize(("steps", "sizes"), [("thesis", THESIS), ("halving", HALVING)])
@pytest.mark.parametrize("start", [(0, 0, 0), (0.1, -0.04, 0.05), (0.2, 0.1, -0.3), (0, 0, 3.13)])
@pytest.mark.parametrize("value", VALUES)
def test_climbs_as_the_literal_loop(steps, sizes, start, value):
    """Catches the wrong of two equals, `>=` on a plain, a halving too few, rounds that are counted
    otherwise, and a heading beyond half a turn."""
    for rounds in (0, 1, 7, 60, 1000):
        path = literal.hill_climb(lambda p: value(*p), start, sizes=sizes, rounds=rounds)
        found = hill_climb(MAP, SCAN, start, score=Watched(value), steps=steps, rounds=rounds)
        np.testing.assert_allclose(found, (*path[-1][:2], wrap(path[-1][2])), atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("score", [nearest_score, occupancy_score])
def test_climbs_as_the_literal_loop_on_maps(seed, score):
    """Plateaus and ridges of real scores: a move that does not improve is never taken."""
    map, rng = random_map(seed)
    points = rng.normal(0, 20 * map.resolution, (25, 2))
    start = rng.normal(0, 0.02, 3)
    path = literal.hill_climb(lambda pose: score(map, points, pose)[0], start, sizes=HALVING)
    np.testing.assert_allclose(hill_climb(map, points, start, score=score), path[-1], atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("value", VALUES)
def test_samples_as_the_literal_rounds(seed, value):
    """1 and 99 poses, then 80 in each of 3 rounds, around the best 20 so far; of equals the first,
    so that nothing is worse than the start."""
    start, sigma = np.array([0.05, 0, 3.12]), (0.03, 0.05)
    rng = np.random.default_rng(seed)
    rounds = literal.sample_and_rank(lambda p: value(*p), start, rng=rng, sigma=sigma)
    watched, rng = Watched(value), np.random.default_rng(seed)
    found = sample_and_rank(MAP, SCAN, start, score=watched, rng=rng, sigma=sigma)
    best = max((pose for drawn in rounds for pose in drawn), key=lambda pose: value(*pose))
    np.testing.assert_allclose(found, (*best[:2], wrap(best[2])), atol=1e-12)
    assert [len(poses) for poses in watched.asked] == [100, 80, 80, 80]
    for asked, expected in zip(watched.asked, rounds, strict=True):
        np.testing.assert_array_equal(asked, expected)


def walls():
    """A corner of two walls, seen from the origin."""
    along = np.arange(-1, 1, 0.02)
    beside = np.full_like(along, 1.005)
    return np.concatenate([np.stack([along, beside], -1), np.stack([beside, along], -1)])


#: The same corner for a map of segments.
CORNER = SegmentMap([[(-1, 1.005), (1, 1.005)], [(1.005, -1), (1.005, 1)]])


@pytest.mark.parametrize("score", [field_score, nearest_score])
@pytest.mark.parametrize("matcher", [hill_climb, sample_and_rank])
def test_both_on_a_map(matcher, score):
    """Catches a pose that is applied the other way round, and one moved by a scan of nothing.

    The field is the bridge to a map of segments.
    """
    given = {"rng": np.random.default_rng(2)} if matcher is sample_and_rank else {}
    match, cells = partial(matcher, score=score, **given), QuadtreeMap()
    cells.insert_scan((0, 0), walls())
    for map in [cells, CORNER][: 1 + (score is field_score)]:
        np.testing.assert_allclose(match(map, walls(), (0.04, -0.03, 0.03)), 0, atol=0.02)
        assert match(map, [], (1, 2, 0.5)).tolist() == [1, 2, 0.5]
