"""Poses form a group, carry points, and can be interpolated."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from segmap.poses import compose, interpolate, inverse, transform

NUMBER = st.floats(-20, 20)
POSE = st.tuples(NUMBER, NUMBER, NUMBER)
POINTS = st.lists(st.tuples(NUMBER, NUMBER), min_size=1, max_size=5)


def matrix(pose):
    """The pose as a homogeneous matrix: the literal form."""
    x, y, turn = pose
    c, s = np.cos(turn), np.sin(turn)
    return np.array([(c, -s, x), (s, c, y), (0, 0, 1)])


def assert_same(a, b, atol=1e-9):
    np.testing.assert_allclose(matrix(np.asarray(a)), matrix(np.asarray(b)), rtol=0, atol=atol)


# ------------------------------------------------------------------------ group
@given(POSE, POSE)
def test_compose_is_the_product_of_the_matrices_in_the_same_order(a, b):
    """Catches an order swapped, a heading subtracted, a reflection."""
    found = compose(a, b)
    np.testing.assert_allclose(matrix(found), matrix(a) @ matrix(b), atol=1e-9)
    assert -np.pi - 1e-12 <= found[2] <= np.pi + 1e-12


@given(POSE)
def test_inverse_is_the_inverse_matrix(a):
    """Catches a translation that is only negated."""
    np.testing.assert_allclose(matrix(inverse(a)), np.linalg.inv(matrix(a)), atol=1e-9)
    assert -np.pi - 1e-12 <= inverse(a)[2] <= np.pi + 1e-12


def test_compose_and_inverse_work_row_by_row_and_broadcast():
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, 6, 3))
    np.testing.assert_allclose(compose(a, b), [compose(p, q) for p, q in zip(a, b, strict=True)])
    np.testing.assert_allclose(compose(a[0], b), [compose(a[0], q) for q in b])
    np.testing.assert_allclose(
        inverse(a.reshape(2, 3, 3)), [[inverse(p) for p in q] for q in a.reshape(2, 3, 3)]
    )


# -------------------------------------------------------------------- transform
@given(POSE, POINTS)
def test_transform_is_the_matrix_times_the_points(pose, points):
    """Catches a transform of world points into the robot instead of the reverse."""
    lifted = np.column_stack([points, np.ones(len(points))])
    expected = (matrix(pose) @ lifted.T).T[:, :2]
    np.testing.assert_allclose(transform(pose, points), expected, atol=1e-9)
    pairs = transform(pose, np.stack([points, points], 1))  # segments are points too
    np.testing.assert_allclose(pairs, np.stack([expected, expected], 1), atol=1e-9)


def test_many_poses_move_a_group_each_or_copy_one_group():
    """Catches poses that broadcast against the points instead of the groups."""
    rng = np.random.default_rng(2)
    poses, groups = rng.normal(size=(4, 3)), rng.normal(size=(4, 4, 2))
    each = [transform(p, g) for p, g in zip(poses, groups, strict=True)]
    np.testing.assert_allclose(transform(poses, groups), each)
    np.testing.assert_allclose(
        transform(poses, groups[0]), [transform(p, groups[0]) for p in poses]
    )


# ------------------------------------------------------------------ interpolate
def literal_interpolation(times, poses, at):
    """Search for the two poses one by one."""
    for k, time in enumerate(times):
        if time == at:
            return np.asarray(poses[k], float)
        if k and times[k - 1] < at < time:
            part = (at - times[k - 1]) / (time - times[k - 1])
            start, step = np.asarray(poses[k - 1], float), np.subtract(poses[k], poses[k - 1])
            step[2] = np.arctan2(np.sin(step[2]), np.cos(step[2]))
            return start + part * step
    return np.full(3, np.nan)


@given(
    st.lists(st.tuples(st.integers(0, 12), POSE), min_size=1, max_size=6),
    st.lists(st.integers(-4, 52), min_size=1, max_size=6),
)
def test_interpolation_equals_the_literal_search(rows, quarters):
    """Catches neighbours taken one too far, ends left out, the first of two equal times lost."""
    rows.sort(key=lambda row: row[0])
    times, poses = [float(t) for t, _ in rows], [p for _, p in rows]
    found = interpolate(times, poses, np.array(quarters) / 4)
    for row, at in zip(found, np.array(quarters) / 4, strict=True):
        expected = literal_interpolation(times, poses, at)
        if np.isnan(expected).any():
            assert np.isnan(row).all()
        elif not np.isclose(abs(row[2] - expected[2]) % (2 * np.pi), np.pi, atol=1e-6):
            assert_same(row, expected)


def test_outside_the_times_and_inside_a_long_gap_nothing_is_claimed():
    """Catches extrapolation, ends that are repeated, and a gap test that loses its own edges."""
    rows = [(0, 0, 0), (1, 0, 0), (5, 0, 0)]
    found = interpolate([0, 1, 5], rows, [-0.001, 0, 0.5, 1, 3, 5, 5.001], max_gap=1)
    assert np.isnan(found[:, 0]).tolist() == [True, False, False, False, True, False, True]
    assert interpolate([0, 2], rows[:2], [1], max_gap=2)[0, 0] == 0.5
