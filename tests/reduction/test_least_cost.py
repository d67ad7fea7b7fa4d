"""Least cost: what it promises before anybody looks at the quality, and what it may not do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reduction_maps import MAPS, assert_literal, grid_map, malaga
from segmap_course.literal.metrics import nearness
from segmap_course.literal.reduction import least_cost as plain

from segmap.kernels import describe
from segmap.metrics import quality
from segmap.reduction import least_cost, reduce_to
from segmap.reduction._runner import rows_of
from segmap.reduction.least_cost import _least_cost
from segmap.reduction.least_cost._exchange import exchanged
from segmap.reduction.least_cost._fit_kernels import Limits, _line_cost, charge, empty_room, take
from segmap.reduction.least_cost._least_cost import crosses, merged
from segmap.segments import SegmentMap, length


@given(st.integers(0, 10_000), st.sampled_from([0.01, 0.05, 0.3]))
@settings(max_examples=20)
def test_quality_is_never_below_the_guarantee(seed, penalty):
    """Catches a merge that costs more than the penalty, or a cost that leaves a member out."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-9, 9, (seed % 7, 1, 2)).repeat(2, axis=1)
    map = np.concatenate([MAPS[seed % 4](rng), points])
    found, n = least_cost(map, penalty=penalty), np.count_nonzero(length(map))
    assert quality(map, found) >= np.exp(-penalty * (n - len(found)) / n / 0.05) - 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_a_line_costs_what_the_plain_sum_says(seed):
    """Members that cross it, at its ends and steeply too: what is cheap to reckon must be exact."""
    rng = np.random.default_rng(seed)
    s = rng.uniform((0, -0.15), (1, 0.15), (5, 2, 2))
    room, about = empty_room(5), describe(s)
    for k in range(5):
        take(room, k, k, s, about)
    pose, limits = (0.5, 0.01, rng.normal(0, 0.05)), Limits(0.1, 0.25, 0.4, 0.12, 0.3, 0.2)
    found = _line_cost(s, room, 5, limits, pose, np.inf)
    line = plain.spanning(*pose, s.reshape(-1, 2).tolist())
    expected = plain.cost_of(s.tolist(), line, (0.25, 0.12, 0.3, 0.2), bridged=0.4)
    assert found == pytest.approx(expected, rel=1e-12)


def test_a_segment_costs_what_the_plain_sum_says_where_limits_are_met():
    """What lies off by the whole distance is beside its output, and at twice that not too far."""
    s = grid_map(np.random.default_rng(3), 40)
    about, limits = describe(s), Limits(0.1, 0.25, 0.4, 0.25, 0.3, 0.2)
    for i, j in np.ndindex(40, 40):
        expected = plain.charge(s[i], s[j], (0.25, 0.25, 0.3, 0.2))
        assert charge(s, about, i, s, about, j, limits) == pytest.approx(expected)


@pytest.mark.parametrize("sought", [1e-5, 1.01e-4, 0.05, 3.98])
def test_the_penalty_is_found_to_within_a_third_of_a_percent(sought, monkeypatch):
    """Catches a bisection that ends early or on the wrong side, and penalties out of its range."""
    monkeypatch.setattr(_least_cost, "least_cost", lambda map, penalty: penalty)
    monkeypatch.setattr(_least_cost, "measured", lambda map, penalty: 1 - penalty / 10)
    found = reduce_to([], quality=1 - sought / 10)
    assert found <= sought < 1.003 * found or (found == pytest.approx(1e-4) and sought < found)


@pytest.mark.parametrize("wanted", [0.7, 0.85, 0.95])
def test_segments_without_length_cost_no_quality(wanted):
    """Catches a quality that falls with what every method drops: no penalty would reach it."""
    map = MAPS[1](np.random.default_rng(2))
    points = np.random.default_rng(3).uniform(-20, 20, (5, 1, 2)).repeat(2, axis=1)
    alone, mixed = reduce_to(map, quality=wanted), np.concatenate([map, points])
    found = reduce_to(mixed, quality=wanted)
    assert len(found) == len(alone) < len(map)
    assert quality(mixed, found) == quality(map, alone) >= wanted


@pytest.mark.parametrize("place", [(0, 0), (7, -3)])
def test_segments_cross_where_both_ends_lie_on_other_sides(place):
    """Catches a sign in one of the four sides, which the end points' distances often hide."""
    ends = np.random.default_rng(1).uniform(-1, 1, (300, 2, 2, 2))

    def sides(of, line):
        way = line[:, 1] - line[:, 0]
        away = of - line[:, :1]
        return np.prod(way[:, None, 0] * away[..., 1] - way[:, None, 1] * away[..., 0], axis=1)

    wanted = (sides(ends[:, 0], ends[:, 1]) < 0) & (sides(ends[:, 1], ends[:, 0]) < 0)
    found = [crosses(u, v) for u, v in ends + np.array(place)]
    assert 30 < wanted.sum() < 150
    assert found == wanted.tolist()


@given(st.integers(0, 10_000), st.sampled_from([0.02, 0.05]))
@settings(max_examples=20)
def test_every_segment_meets_its_output_and_no_other_costs_it_less(seed, distance):
    """Catches parents of the first phase, an output that moved after its members were counted."""
    map = MAPS[seed % 4](np.random.default_rng(seed))
    found = least_cost(map, penalty=0.2, distance=distance)
    limits = (max(0.075, 0.2 / distance / 40), distance, np.sin(np.radians(5)), 0.0)
    for s, parent in zip(map, found.parents, strict=True):
        if parent >= 0:
            costs = [plain.charge(s, line, limits) for line in found.segments]
            assert nearness(s, found.segments[parent]) <= 2 * distance * (1 + 2e-9)
            assert costs[parent] <= min(costs) + 1e-9


@given(st.integers(0, 10_000), st.sampled_from([0.01, 0.05, 0.3]))
@settings(max_examples=20)
def test_the_second_phase_only_lowers_the_sum(seed, penalty):
    """Catches an exchange that is kept although it costs more, and a sum that is not undone."""
    map = MAPS[seed % 4](np.random.default_rng(seed))
    rows, sine = rows_of(map)[0], float(np.sin(np.radians(5)))
    limits = Limits(penalty, 0.25, 0.25, 0.05, sine, 0.05)

    def summed(outputs):
        plain_limits = (max(0.075, penalty / 2), 0.05, sine, 0.05)
        costs = [[plain.charge(s, line, plain_limits) for line in outputs] for s in rows.segments]
        return np.min(costs, axis=1).sum() + penalty * len(outputs)

    first = merged(rows, limits)[0]
    assert summed(exchanged(rows, first, limits)[0]) <= summed(first) + 1e-9


@pytest.mark.parametrize(
    "walls",
    [
        [[(0, 0), (2, 0)], [(0, 0.3), (2, 0.3)]],
        [[(0, 0), (2, 0)], [(2.06, 0), (4, 0)]],
        [[(0, 0), (2, 0)], [(2, 0), (2, 3)]],
        [[(0, 0), (4, 0)], [(1, -0.2), (1.4, 0.2)]],
    ],
    ids=["parallel", "a gap", "a corner", "a crossing"],
)
def test_what_does_not_merge(walls):
    """A door that is closed, two walls of a thin partition, a stub that is swallowed."""
    assert least_cost(walls).parents.tolist() == [0, 1]


def test_what_stands_across_a_wall_is_beside_none_of_it():
    """At an angle of a quarter turn it may go there, and covers no metre: a division by nothing."""
    cross = [[(0, 0), (2, 0)], [(1, -0.02), (1, 0.02)]]
    assert least_cost(cross, angle=np.pi / 2).parents.tolist() == [0, 1]
    assert_literal("least_cost", SegmentMap(cross), angle=np.pi / 2, penalty=0.5)


def test_a_gap_is_bridged_up_to_its_limit():
    walls = [[(0, 0), (2, 0)], [(2.06, 0), (4, 0)]]
    (joined,) = least_cost(walls, gap=0.07).segments
    np.testing.assert_allclose(np.sort(joined[:, 0]), (0, 4), atol=1e-12)


def test_a_higher_penalty_leaves_fewer_segments():
    """Catches a penalty that is compared with something else than a merge costs."""
    map = malaga()[np.arange(600)]
    left = [len(least_cost(map, penalty=p)) for p in (0.0001, 0.01, 0.05, 0.2, 1.0)]
    assert left == sorted(left, reverse=True) and left[0] > 2 * left[-1]


def test_a_quality_that_is_asked_for_is_met_by_about_as_few_segments_as_any_penalty_leaves():
    """Catches a map that jumps with the penalty: bisection would end far from what was asked."""
    map = malaga()[np.arange(600)]
    penalties = np.geomspace(0.003, 1.0, 25)
    runs = [
        (quality(map, found), len(found))
        for found in (least_cost(map, penalty=p) for p in penalties)
    ]
    kept, left = np.array(runs).T
    assert np.diff(kept).max() < 1e-3 and np.diff(left).max() <= 1
    for wanted in (0.95, 0.9, 0.85, 0.8, 0.75):
        found = reduce_to(map, quality=wanted)
        assert wanted <= quality(map, found) < wanted + 0.01
        assert len(found) <= left[kept >= wanted].min() * 1.02


def test_the_order_of_the_segments_changes_ties_only():
    map = malaga().segments[:800]
    order = np.random.default_rng(1).permutation(len(map))
    found, other = least_cost(map), least_cost(map[order])
    assert abs(len(found) - len(other)) <= 1
    assert quality(map, found) == pytest.approx(quality(map, other), abs=1e-3)


def test_no_penalty_reaches_a_quality_that_one_merge_breaks():
    """Two copies 1 mm apart: quality 1 cannot be had, so the least penalty answers."""
    walls = np.array([[(0, 0), (2, 0)], [(0, 0.001), (2, 0.001)]])
    assert len(reduce_to(walls, quality=1 - 1e-9)) == 2
    assert len(reduce_to(walls, quality=0.5)) == 1
