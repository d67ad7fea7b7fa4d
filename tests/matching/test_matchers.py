"""The greedy matchers against their literal forms (B 4.3)."""

from functools import partial

import numpy as np
import pytest
from quadtrees import random_map
from segmap_course import literal

from segmap.matching import field_score, hill_climb, nearest_score, occupancy_score, sample_and_rank
from segmap.quadtree import QuadtreeMap
from segmap.segments import SegmentMap

MAP = QuadtreeMap()
SCAN = np.array([(1.0, 0.0)])
#: Of drawn poses, where nothing is said.
DEFAULT = (0.02, 0.02, np.radians(2))
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


@pytest.mark.parametrize(("steps", "sizes"), [("thesis", THESIS), ("halving", HALVING)])
@pytest.mark.parametrize("rounds", [0, 1, 7, 60, 1000])
@pytest.mark.parametrize("start", [(0, 0, 0), (0.1, -0.04, 0.05), (0.2, 0.1, -0.3)])
def test_climbs_as_the_literal_loop(steps, sizes, rounds, start):
    """Catches the wrong of two equals, a halving too few, and rounds that are counted otherwise."""
    path = literal.hill_climb(lambda p: bowl(*p), start, sizes=sizes, rounds=rounds)
    found = hill_climb(MAP, SCAN, start, score=Watched(bowl), steps=steps, rounds=rounds)
    np.testing.assert_allclose(found, path[-1], atol=1e-12)
    values = [bowl(*pose) for pose in path]
    assert (np.diff(values) > 0).all()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("score", [nearest_score, occupancy_score])
def test_climbs_as_the_literal_loop_on_maps(seed, score):
    """Plateaus and ridges of real scores: a move that does not improve is never taken."""
    map, rng = random_map(seed)
    points = rng.normal(0, 20 * map.resolution, (25, 2))
    start = rng.normal(0, 0.02, 3)
    path = literal.hill_climb(lambda pose: score(map, points, pose)[0], start, sizes=HALVING)
    np.testing.assert_allclose(hill_climb(map, points, start, score=score), path[-1], atol=1e-9)


@pytest.mark.parametrize(("steps", "asked"), [("thesis", 1 + 6), ("halving", 1 + 5 * 6)])
def test_stays_on_a_plain(steps, asked):
    """An equal score is no improvement: catches `>=`, which walks until the rounds end."""
    flat = Watched(lambda *_: 3.0)
    assert hill_climb(MAP, SCAN, (1, 2, 0.5), score=flat, steps=steps).tolist() == [1, 2, 0.5]
    assert sum(len(poses) for poses in flat.asked) == asked


@pytest.mark.parametrize(
    ("value", "moves_to"),
    [
        (lambda x, y, h: abs(x), (-1, 0, 0)),
        (lambda x, y, h: abs(y), (0, -1, 0)),
        (lambda x, y, h: abs(h), (0, 0, -1)),
        (lambda x, y, h: x + y, (1, 0, 0)),
        (lambda x, y, h: max(y, h > 0), (0, 0, 1)),
        (lambda x, y, h: (y > 0) + (h < 0), (0, 1, 0)),
    ],
)
def test_the_first_of_equals_is_taken(value, moves_to):
    """-x, +x, -y, +y, -heading, +heading is the order; the best counts before it."""
    found = hill_climb(MAP, SCAN, (0, 0, 0), score=Watched(value), steps="thesis", rounds=1)
    np.testing.assert_allclose(found, np.array(moves_to) * (0.001, 0.001, np.radians(1)))


@pytest.mark.parametrize("matcher", [hill_climb, sample_and_rank])
def test_the_heading_comes_back_wrapped(matcher):
    rng = {"rng": np.random.default_rng(1)} if matcher is sample_and_rank else {}
    value = Watched(lambda x, y, h: -abs(h - np.pi - 0.1))
    found = matcher(MAP, SCAN, (0, 0, np.pi - 0.02), score=value, **rng)
    assert -np.pi <= found[2] < -np.pi + 0.12


@pytest.mark.parametrize("seed", range(5))
def test_samples_as_the_literal_rounds(seed):
    """1 and 99 poses, then 80 in each of 3 rounds, around the best 20 so far."""
    start, sigma = np.array([0.05, 0, 0.02]), (0.03, 0.05)
    rng = np.random.default_rng(seed)
    rounds = literal.sample_and_rank(lambda p: bowl(*p), start, rng=rng, sigma=sigma)
    watched, rng = Watched(bowl), np.random.default_rng(seed)
    found = sample_and_rank(MAP, SCAN, start, score=watched, rng=rng, sigma=sigma)
    best = max((pose for drawn in rounds for pose in drawn), key=lambda pose: bowl(*pose))
    np.testing.assert_array_equal(found, best)
    assert [len(poses) for poses in watched.asked] == [100, 80, 80, 80]
    for asked, expected in zip(watched.asked, rounds, strict=True):
        np.testing.assert_array_equal(asked, expected)


def test_rounds_draw_ever_more_closely():
    """Twice sigma at first, then sigma / 1, / 2, / 3: B's integer division makes the third zero.

    The default heading is of degrees: B's is 2 radians, half of its poses look back.
    """
    for options, sigma in (({"sigma": (0.02, 0.1)}, (0.02, 0.02, 0.1)), ({}, DEFAULT)):
        watched = Watched(lambda *_: 0.0)
        for seed in range(30):
            rng = np.random.default_rng(seed)
            sample_and_rank(MAP, SCAN, (0, 0, 0), score=watched, rng=rng, **options)
        asked = np.array(watched.asked, object).reshape(30, 4)
        first = np.concatenate([poses[1:] for poses in asked[:, 0]]).std(0)
        np.testing.assert_allclose(first, np.multiply(sigma, 2), rtol=0.05)
        for k in (1, 2, 3):
            around = (np.repeat(poses[:20], 4, axis=0) for poses in asked[:, 0])
            drawn = np.concatenate([a - b for a, b in zip(asked[:, k], around, strict=True)])
            np.testing.assert_allclose(drawn.std(0), np.divide(sigma, k), rtol=0.06)


@pytest.mark.parametrize("seed", range(10))
def test_never_worse_than_the_start(seed):
    """The start itself is among those ranked, and stays where it is best or no worse."""
    rng, start = np.random.default_rng(seed), (0.3, 0.2, 0.1)
    for value in (lambda *pose: float(pose == start), lambda *_: 0.0):
        found = sample_and_rank(MAP, SCAN, start, score=Watched(value), rng=rng)
        assert found.tolist() == [0.3, 0.2, 0.1]
    map, _ = random_map(seed)
    points = rng.normal(0, 10 * map.resolution, (20, 2))
    found = sample_and_rank(map, points, (0, 0, 0), score=nearest_score, rng=rng)
    before, after = nearest_score(map, points, [(0, 0, 0), found])
    assert after >= before


def walls():
    """A corner of two walls, seen from the origin."""
    along = np.arange(-1, 1, 0.02)
    beside = np.full_like(along, 1.005)
    return np.concatenate([np.stack([along, beside], -1), np.stack([beside, along], -1)])


@pytest.mark.parametrize("score", [field_score, nearest_score])
@pytest.mark.parametrize("matcher", [hill_climb, sample_and_rank])
def test_both_on_a_map(matcher, score):
    """Catches a pose that is applied the other way round, and one found where nothing is."""
    given = {"rng": np.random.default_rng(2)} if matcher is sample_and_rank else {}
    match, map = partial(matcher, score=score, **given), QuadtreeMap()
    with pytest.raises(ValueError, match="insert a scan"):
        match(map, [(1, 0)], (0, 0, 0))
    map.insert_scan((0, 0), walls())
    np.testing.assert_allclose(match(map, walls(), (0.04, -0.03, 0.03)), 0, atol=0.012)
    assert match(map, [], (1, 2, 0.5)).tolist() == [1, 2, 0.5]
    if score is field_score:
        with pytest.raises(ValueError, match="no occupied cell"):
            match(map, [(50, 0)], (40, 40, 0))


def test_sigma_must_be_positive():
    for sigma in ((0, 1), (0.1, -1), (np.nan, 1), (0.1, np.inf), 0.02, (0.02, 0.02, 0.03)):
        with pytest.raises(ValueError, match="sigma must be positive"):
            sample_and_rank(MAP, SCAN, (0, 0, 0), rng=np.random.default_rng(0), sigma=sigma)


@pytest.mark.parametrize("matcher", [hill_climb, sample_and_rank])
def test_both_on_walls(matcher):
    """The field is the bridge to a map of segments; the scores of cells refuse one."""
    given = {"rng": np.random.default_rng(2)} if matcher is sample_and_rank else {}
    map = SegmentMap([[(-1, 1.005), (1, 1.005)], [(1.005, -1), (1.005, 1)]])
    found = matcher(map, walls(), (0.04, -0.03, 0.03), **given)
    np.testing.assert_allclose(found, 0, atol=0.02)
    assert matcher(map, [], (1, 2, 0.5), **given).tolist() == [1, 2, 0.5]
    for bad, score, word in (
        (map, nearest_score, "map must be a QuadtreeMap"),
        (SegmentMap([]), field_score, "holds no wall"),
        (map.segments, field_score, "a QuadtreeMap or a SegmentMap"),
    ):
        with pytest.raises(ValueError, match=word):
            matcher(bad, walls(), (0, 0, 0), score=score, **given)
    with pytest.raises(ValueError, match="holds no wall"):
        field_score(SegmentMap([]), [], (0, 0, 0))
