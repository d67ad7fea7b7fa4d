"""Errors of poses: up to one motion of the whole, and only where the truth is known."""

import numpy as np
import pytest

from segmap.alignment import align_to_truth, position_errors
from segmap.angles import wrap
from segmap.poses import between, compose

NOT = (np.nan, np.nan, np.nan)


@pytest.fixture
def truth():
    rng = np.random.default_rng(7)
    return np.column_stack([rng.uniform(-5, 5, (12, 2)), rng.uniform(-np.pi, np.pi, 12)])


@pytest.mark.parametrize("best", [False, True])
def test_one_motion_of_the_whole_is_no_error(best, truth):
    """Catches a motion applied the wrong way round, or on the wrong side."""
    moved = compose((3.0, -2.0, 2.5), truth)
    found = align_to_truth(moved, truth, best=best)
    np.testing.assert_allclose(found[:, :2], truth[:, :2], atol=1e-9)
    np.testing.assert_allclose(wrap(found[:, 2] - truth[:, 2]), 0, atol=1e-9)
    np.testing.assert_allclose(position_errors(moved, truth, best=best), 0, atol=1e-9)


def test_the_first_known_pose_is_laid_on_its_true_one_with_its_heading(truth):
    """Catches the first row taken where its truth is not known, and headings left out."""
    truth[:2] = NOT
    poses = np.random.default_rng(8).normal(size=(12, 3))
    found = align_to_truth(poses, truth)
    np.testing.assert_allclose(found[2, :2], truth[2, :2], atol=1e-12)
    np.testing.assert_allclose(between(found[2], found), between(poses[2], poses), atol=1e-9)
    assert len(position_errors(poses, truth)) == 10 and position_errors(poses, truth)[0] < 1e-12


def test_the_best_motion_leaves_less_than_any_other(truth):
    """Catches a turn of the wrong sign, and means that are not those of the places."""
    poses = compose((1.0, 2.0, -1.0), truth + np.random.default_rng(9).normal(0, 0.2, (12, 3)))
    least = (position_errors(poses, truth, best=True) ** 2).sum()
    assert least < (position_errors(poses, truth) ** 2).sum()
    best = align_to_truth(poses, truth, best=True)
    for small in np.vstack([np.eye(3), -np.eye(3)]) * 0.01:
        assert (np.hypot(*(compose(small, best) - truth)[:, :2].T) ** 2).sum() > least


def test_places_without_a_pose_are_passed_over(truth):
    poses = truth.copy()
    poses[[0, 5]] = NOT
    assert len(position_errors(poses, truth)) == 10


@pytest.mark.parametrize(
    ("poses", "truth", "words"),
    [
        (np.zeros((2, 3)), np.zeros((3, 3)), r"truth must have shape \(2, 3\), got \(3, 3\)"),
        (np.zeros((2, 2)), np.zeros((2, 2)), r"poses must have shape \(n, 3\)"),
        ([NOT], [(0, 0, 0)], "got none"),
    ],
)
def test_what_cannot_be_compared_is_refused(poses, truth, words):
    with pytest.raises(ValueError, match=words):
        align_to_truth(poses, truth)
