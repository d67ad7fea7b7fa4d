"""Segment distance, quality, grades and relation errors, against literal forms and closed ones."""

import numpy as np
import pytest
from conftest import shared_file
from hypothesis import given
from hypothesis import strategies as st
from segmap_course import literal

from segmap import metrics, readers
from segmap.poses import compose, transform
from segmap.segments import SegmentMap

coordinates = st.floats(-10, 10).map(lambda x: round(x, 3))
segment = st.tuples(*[st.tuples(coordinates, coordinates)] * 2)
weight = st.floats(0.1, 10)


@given(segment, segment, weight, weight)
def test_equals_the_literal_distance(u, v, weight_u, weight_v):
    """A sign, a swapped weight, a line instead of a segment, a plain mean of angles."""
    expected = literal.segment_distance(u, v, weight_u, weight_v)
    found = metrics.segment_distance(u, v, weight_u, weight_v)
    assert found == pytest.approx(expected, rel=1e-7, abs=1e-9)
    assert metrics.segment_distance(v, u[::-1], weight_v, weight_u) == pytest.approx(
        found, abs=1e-7
    )


@pytest.mark.parametrize("turn", np.linspace(0, np.pi, 13))
def test_perpendicular_segments_do_not_change_when_turned(turn):
    """Rounding must not choose between the two mean directions."""
    u, v = np.array([(0, 0), (2, 0)]), np.array([(3, -1), (3, 4)])
    expected = metrics.segment_distance(u, v, 1, 2)
    moved = [transform((5, -3, turn), s) for s in (u, v)]
    assert metrics.segment_distance(*moved, 1, 2) == pytest.approx(expected, abs=1e-9)


def test_segments_without_length():
    """A point takes the direction of the other segment; two points have no angular term."""
    point, wall = [(1, 1), (1, 1)], [(0, 0), (0, 2)]
    np.testing.assert_allclose(metrics.distance_terms(point, wall), (0, 0.5, 1), atol=1e-12)
    np.testing.assert_allclose(
        metrics.distance_terms(point, [(4, 3), (4, 3)]), (0, 1, np.hypot(3, 2)), atol=1e-12
    )


def test_distance_broadcasts():
    u, v = np.random.default_rng(0).uniform(0, 1, (2, 5, 2, 2))
    table = metrics.segment_distance(u[:, None], v[None])
    assert table.shape == (5, 5)
    assert table[3, 1] == pytest.approx(float(metrics.segment_distance(u[3], v[1])))


def random_maps(seed: int, n: int = 50, m: int = 20) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    before, after = rng.uniform(-3, 3, (n, 2, 2)), rng.uniform(-3, 3, (m, 2, 2))
    if seed % 2:  # lattices: perpendicular pairs, points, duplicates
        before, after = np.round(before), np.round(after)
    return before, after


@pytest.mark.parametrize("seed", range(6))
def test_quality_equals_the_literal_one(seed):
    """The fast search passes over most pairs: a bound that is too high misses the nearest."""
    before, after = random_maps(seed)
    expected = [min(literal.segment_distance(s, t) for t in after) for s in before]
    np.testing.assert_allclose(metrics.errors(before, after), expected, atol=1e-9)
    assert metrics.quality(before, after, scale=0.4) == pytest.approx(
        literal.quality(before, after, scale=0.4)
    )


def test_quality_at_its_ends():
    before, _ = random_maps(1)
    empty = np.empty((0, 2, 2))
    assert metrics.quality(before, before) == pytest.approx(1, abs=1e-12)
    assert metrics.quality(before, empty) == 0
    assert metrics.quality(empty, before) == literal.quality(empty, before) == 1
    point = [[(5.0, 5.0), (5.0, 5.0)]]
    assert metrics.quality(point, empty) == literal.quality(point, []) == 1
    assert metrics.quality(SegmentMap(before), before[::-1]) == pytest.approx(1, abs=1e-12)


def test_nothing_reduced_to_nothing_has_no_quality():
    """Catches an empty map, after a slip of units say, that is reported as perfect."""
    empty = np.empty((0, 2, 2))
    with pytest.warns(UserWarning, match="neither map holds a segment"):
        assert np.isnan(metrics.quality(empty, SegmentMap(empty)))
    assert np.isnan(literal.quality([], []))


def test_reduction_rate():
    assert metrics.reduction_rate(np.zeros((10, 2, 2)), np.zeros((3, 2, 2))) == pytest.approx(0.7)
    assert metrics.reduction_rate(np.empty((0, 2, 2)), np.empty((0, 2, 2))) == 0


REDUCTIONS = {"excellent": (0.99, 0.65), "very good": (0.649, 0.55), "good": (0.45, 0.35),
              "fair": (0.349, 0.25), "poor": (0.2, -3)}  # fmt: skip
QUALITIES = {"excellent": (1, 0.85), "very good": (0.8499, 0.75), "good": (0.7,), "fair": (0.6,),
             "poor": (0.5,), "very poor": (0.44, 0)}  # fmt: skip


@pytest.mark.parametrize("kind", ["reduction", "quality"])
def test_grades(kind):
    """Nearest step, halves upward, first and last beyond the list (A 6.2.3)."""
    grade = getattr(metrics, f"grade_{kind}")
    for word, values in (REDUCTIONS if kind == "reduction" else QUALITIES).items():
        assert {grade(value) for value in values} == {word}


# ------------------------------------------------------------------------ relation errors
def test_perfect_poses_have_no_error_anywhere():
    """A swapped composition order gives an error as soon as the robot has turned."""
    rng = np.random.default_rng(2)
    steps = rng.uniform(-1, 1, (20, 3))
    poses = [np.zeros(3)]
    for step in steps:
        poses.append(compose(poses[-1], step))
    relations = [[k, k + 1, s[0], s[1], 0, 0, 0, s[2]] for k, s in enumerate(steps)]
    translation, rotation = metrics.relation_errors(np.arange(21), poses, relations)
    np.testing.assert_allclose(translation, 0, atol=1e-12)
    np.testing.assert_allclose(rotation, 0, atol=1e-12)
    frame = compose((7, -3, 2.5), poses)
    translation, _ = metrics.relation_errors(np.arange(21), frame, relations)
    np.testing.assert_allclose(translation, 0, atol=1e-12)


def test_errors_by_hand():
    """The relation says 1 m ahead and a turn of 179 degrees; the poses say 1 m left and -179."""
    relation = [[0, 1, 1, 0, 0, 0, 0, np.radians(179)]]
    poses = [(0, 0, np.pi / 2), (-1, 0, np.pi / 2 - np.radians(179))]
    translation, rotation = metrics.relation_errors([0, 1], poses, relation)
    np.testing.assert_allclose(translation, np.sqrt(2))
    np.testing.assert_allclose(np.degrees(rotation), 2)


def test_only_relations_near_in_time_count():
    """Left out: an end too far from any pose, or one whose pose is not known."""
    poses = [(0, 0, 0), (1, 0, 0), (np.nan,) * 3, (3, 0, 0)]
    ends = [(0, 1.01), (0, 1.03), (1, 2), (2.99, 0), (0.5, 1)]
    relations = [[a, b, 0, 0, 0, 0, 0, 0] for a, b in ends]
    translation, _ = metrics.relation_errors([0, 1, 2, 3], poses, relations)
    np.testing.assert_allclose(translation, [1, 3])


def test_ties_in_time_go_to_the_earlier_pose_and_order_does_not_matter():
    times, poses = np.array([0.0, 1.0, 2.0]), np.array([(0, 0, 0), (1, 0, 0), (5, 0, 0)])
    relation = [[0, 1.5, 0, 0, 0, 0, 0, 0]]
    translation, _ = metrics.relation_errors(times, poses, relation, tolerance=0.5)
    np.testing.assert_allclose(translation, [1])
    again, _ = metrics.relation_errors(times[::-1], poses[::-1], relation, tolerance=0.5)
    np.testing.assert_allclose(again, [1])


def test_no_poses_no_errors():
    assert len(metrics.relation_errors([], np.empty((0, 3)), np.zeros((2, 8)))[0]) == 0


def test_corrected_intel_poses_score_what_was_published():
    """0.043 m and 1.19 degrees on 566 relations: frame, time base and metric agree."""
    log = readers.read(shared_file("data/intel.log.gz"))
    relations = np.loadtxt(shared_file("data/intel.relations.gz"))
    assert log.truth is not None
    translation, rotation = metrics.relation_errors(log.times, log.truth, relations)
    assert len(translation) == 566
    assert translation.mean() == pytest.approx(0.043, abs=5e-4)
    assert translation.max() == pytest.approx(0.23, abs=5e-3)
    assert np.degrees(rotation.mean()) == pytest.approx(1.19, abs=5e-3)
