"""Least cost: what it promises before anybody looks at the quality, and what it may not do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reduction_maps import MAPS, assert_literal, corridor_map, malaga
from segmap_course.literal.reduction.least_cost_merges import merge_all

from segmap import build_map, load
from segmap.compiled import Compiled
from segmap.methods import bracket, halve
from segmap.metrics import quality
from segmap.poses import transform
from segmap.reduction import least_cost
from segmap.segments import SegmentMap, length
from segmap.testing import assert_segments_equal


def test_an_exchange_that_gains_nothing_is_undone():
    """Catches one that is kept: as dear as before, with other outputs."""
    rows = [[-1, 1, 2, 1], [2, 7, 7, 7], [6, 1, 6, -1], [-1, -1, 2, -1]]
    rows += [[-4, -2, -4, 6], [2, -7, 7, -7], [6, -1, 6, 1], [-1, -2, -1, -5]]
    assert_literal("least_cost", SegmentMap(np.reshape(rows, (8, 2, 2)) / 64), penalty=0.1)


def test_an_output_that_lost_a_member_is_drawn_anew():
    """Catches one that stays as it was drawn, since only who won a member is marked as changed.

    Five of 3000 drawn maps of 24 to 88 segments tell the two apart: this is the smallest.
    """
    rng = np.random.default_rng(2600)
    segments = 0.7 * corridor_map(rng, 2 * int(rng.integers(12, 45)))
    assert_literal("least_cost", SegmentMap(segments), penalty=0.1)


@pytest.fixture
def visits(monkeypatch):
    """How many boxes each look into an index finds, once for each call of a loop."""
    counts = []

    def call(kernel, *arguments):
        result = kernel.plain(*arguments)
        counts.append(result if kernel.plain.__name__ == "meeting" else 0)
        return result

    monkeypatch.setattr(Compiled, "__call__", call)
    return counts


def test_only_what_changed_is_looked_at_again(visits):
    """Catches rounds in which each segment looks at all beside it to learn that nothing changed."""
    least_cost(malaga().segments[:200])
    assert 0 < sum(visits) < 14 * 200  # 44 times where each round looks at all


@pytest.mark.parametrize("count", [25, 100])
def test_of_many_looks_at_a_wall_those_are_tried_that_may_stand_for_an_output(visits, count):
    """Catches work for each look that grows with the looks beside it, not with the outputs."""
    rng = np.random.default_rng(0)
    along, across = rng.uniform(0, 1, (count, 1)) + [0, 1.0], rng.normal(0, 0.02, (count, 2))
    outputs = least_cost(np.stack([along, across], -1))
    pairs = count * (count - 1) / 2  # those that lie side by side, once
    assert pairs < sum(visits) < pairs + 4 * count * len(outputs)  # 14 where each look is tried


@given(st.integers(0, 10_000), st.sampled_from([0.01, 0.05, 0.3]))
@settings(max_examples=20)
def test_quality_is_never_below_the_guarantee(seed, penalty):
    """Catches a merge that costs more than the penalty, or a cost that leaves a member out."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-9, 9, (seed % 7, 1, 2)).repeat(2, axis=1)
    map = np.concatenate([MAPS[seed % 4](rng), points])
    found, n = least_cost(map, penalty=penalty), np.count_nonzero(length(map))
    assert quality(map, found) >= np.exp(-penalty * (n - len(found)) / n / 0.05) - 1e-9


def test_of_two_walls_of_one_length_the_first_stands_for_both():
    """Catches a tie that rounding decides: equal lengths differ by 1e-16 where a map is moved."""
    rng = np.random.default_rng(0)
    poses = np.column_stack([rng.uniform(-5, 5, (60, 2)), rng.uniform(-np.pi, np.pi, 60)])
    half = np.array([[np.cos(turn), np.sin(turn)] for turn in (0.3, 0.26)]) / 2
    middle = np.array([(-0.75, -0.04), (-0.75, 0.06)])
    walls = np.stack([middle - half, middle + half], 1)
    for pose in poses:
        there = transform(pose, walls.reshape(-1, 2)).reshape(-1, 2, 2)
        found = least_cost(there, penalty=0.5)
        assert found.segments.round(9).tolist() == there[:1].round(9).tolist()


@pytest.mark.parametrize("sought", [1.01e-4, 0.01, 0.05, 3.98, 25.0])
def test_a_threshold_is_found_to_within_a_third_of_a_percent(sought):
    """Catches a bisection that ends early or on the wrong side, and thresholds out of its range."""
    ends = bracket(lambda value: value <= sought, 0.05, 9, 9)
    assert ends[1] == 2 * ends[0]
    for _ in range(8):
        ends = halve(lambda value: value <= sought, ends)
    assert ends[0] <= sought < ends[1] < 1.003 * ends[0]


@pytest.mark.parametrize("penalty", [0.05, 1.0])
def test_its_core_ends_with_the_same_segments_where_nothing_is_undone(penalty):
    """Catches a core that chapter 21 shows and that is another method."""
    clinic = load("clinic")[::5]
    looks = build_map(clinic, clinic.truth).segments
    near = (abs(looks[..., 0] - 5.45) < 0.09) & (looks[..., 1] > 1.45) & (looks[..., 1] < 4.42)
    looks = looks[near.all(axis=1)]  # of both faces of the wall between rooms 2 and 3
    merged = [line for _, line, _ in merge_all(looks, penalty)]
    assert_segments_equal(merged, least_cost(looks, penalty=penalty))
