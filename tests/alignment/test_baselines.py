"""The two ends of the scale, odometry and ground truth, and errors against the truth."""

import alignment_logs as logs
import numpy as np
import pytest

from segmap.alignment import align_to_truth, ground_truth, odometry, position_errors
from segmap.angles import wrap
from segmap.poses import between, compose
from segmap.scans import LaserScan, Log

NOT = (np.nan, np.nan, np.nan)
TIMES = np.array([0.0, 1.0, 2.0, 3.0])


def log_at(*times: float, odometry=None, truth=None) -> Log:
    poses = [None] * len(times) if odometry is None else odometry
    scans = [LaserScan([1.0], [0.0], t, o) for t, o in zip(times, poses, strict=True)]
    return Log("four", scans, truth)


# ------------------------------------------------------------------ odometry
@pytest.mark.parametrize("times", [(1.0, 0.5, 0.0), (0.0, 5.0, 1.0)])
def test_a_time_that_is_not_between_those_of_its_neighbours_bridges_nothing(times):
    """Catches a pose of the truth that is made from times that run backwards."""
    log = log_at(*times, truth=[(0.0, 0, 0), NOT, (1.0, 0, 0)])
    assert ground_truth(log, missing="drop").used.tolist() == [True, False, True]


def test_a_scan_without_odometry_moves_on_as_the_robot_did():
    """The robot would stop, or the motion be taken in the world's axes."""
    poses = [np.array([3.0, 2.0, 1.0])]
    for _ in range(5):
        poses.append(compose(poses[-1], (0.5, 0.1, 0.2)))
    gaps = [pose if k not in (2, 3) else None for k, pose in enumerate(poses)]
    found = odometry(log_at(*range(6), odometry=gaps))
    np.testing.assert_allclose(found.poses, poses, atol=1e-12)
    assert found.reasons == ("", "", "no odometry", "no odometry", "", "")


# ------------------------------------------------------------------ ground truth
def test_poses_are_interpolated_at_the_times_of_the_scans():
    """A 3.3.3: linear in x and y, by the shorter way round in heading."""
    poses = [(0, 0, 3.0), (1, 2, -3.0), (3, 2, -2.0), (3, 0, 0.0)]
    found = ground_truth(log_at(0, 0.25, 2, 2.5), times=TIMES, poses=poses)
    to_seam = 2 * np.pi - 6.0
    expected = [(0, 0, 3.0), (0.25, 0.5, 3.0 + to_seam / 4), (3, 2, -2.0), (3, 1, -1.0)]
    np.testing.assert_allclose(found.poses, expected, atol=1e-12)
    assert found.used.all()


@pytest.mark.parametrize("damage", ["shuffled", "equal", "far away", "nan"])
def test_a_scan_with_a_true_pose_has_that_one_whatever_its_time(damage):
    """Catches the truth looked up by time: damaged times put scans 50 m away, all of them used."""
    log = logs.office_log()
    times = np.random.default_rng(1).permutation(len(log)).astype(float)
    times[::3] = {"shuffled": times[::3], "equal": 7.0, "far away": 1e9, "nan": np.nan}[damage]
    found = ground_truth(logs.changed(log, times=times))
    np.testing.assert_array_equal(found.poses, log.truth)
    assert found.used.all()


def test_a_scan_without_true_pose_lies_between_its_neighbours_in_the_log():
    """Catches a bridge between scans that are neighbours by a damaged time only."""
    truth = [(0, 0, 0), NOT, (2, 0, 1.0), (9, 9, 2.0)]
    gap = log_at(0, 0.5, 2, 0.6, truth=truth)
    np.testing.assert_allclose(ground_truth(gap).poses[1:3], [(0.5, 0, 0.25), truth[2]])
    with pytest.raises(ValueError, match=r"scan 1 of log 'four', at 0\.500000 s.*at most 1 s"):
        ground_truth(gap, max_gap=1.0)
    for time in (-0.1, 2.1, np.nan):
        found = ground_truth(log_at(0, time, 2, 3, truth=truth), missing="drop")
        assert found.used.tolist() == [True, False, True, True]


def test_scans_before_the_first_and_behind_the_last_true_pose_are_not_known():
    """Catches poses made up outside of the truth."""
    log = log_at(0, 1, 2, 3, truth=[NOT, (1, 1, 1), (2, 1, 1), NOT])
    found = ground_truth(log, missing="drop")
    assert found.used.tolist() == [False, True, True, False]


def test_such_scans_are_dropped_when_asked():
    """The odometry carries on from the last pose that is known, and back from the first."""
    moved = compose((5, 5, 1.0), [(-1, 0, 0), (0, 0, 0), (1, 0, 0.5), (2, 0, 0.5), (3, 0, 0.5)])
    known = np.array([(0, 0, 0.0), (1, 0, 0.5)])
    log = log_at(-1, 0, 1, 2, 3, odometry=moved)
    found = ground_truth(log, times=[0, 1], poses=known, missing="drop")
    assert found.used.tolist() == [False, True, True, False, False]
    assert found.reasons[3] == found.reasons[0] == "no ground truth at its time"
    np.testing.assert_allclose(found.poses[1:3], known, atol=1e-12)
    left = between(between(moved[1], moved), between(found.poses[1], found.poses))
    np.testing.assert_allclose(left, 0, atol=1e-12)
    bare = ground_truth(log_at(-1, 0), times=[0], poses=[(4, 5, 1)], missing="drop")
    np.testing.assert_allclose(bare.poses, [(4, 5, 1), (4, 5, 1)])


def test_nothing_known_at_any_scan():
    """An index into an empty list of poses that are known."""
    log = log_at(7, 8, odometry=[(1, 1, 1), (2, 1, 1)])
    found = ground_truth(log, times=[0], poses=np.zeros((1, 3)), missing="drop")
    np.testing.assert_array_equal(found.poses, log.odometry)
    assert not found.used.any()


# ------------------------------------------------------------------ errors against the truth
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
    poses = np.random.default_rng(8).normal(size=(12, 3))
    poses[5], truth[:2] = NOT, NOT
    found, away = align_to_truth(poses, truth), position_errors(poses, truth)
    np.testing.assert_allclose(found[2, :2], truth[2, :2], atol=1e-12)
    np.testing.assert_allclose(between(found[2], found), between(poses[2], poses), atol=1e-9)
    assert len(away) == 9 and away[0] < 1e-12


def test_the_best_motion_leaves_less_than_any_other(truth):
    """Catches a turn of the wrong sign, and means that are not those of the positions."""
    poses = compose((1.0, 2.0, -1.0), truth + np.random.default_rng(9).normal(0, 0.2, (12, 3)))
    least = (position_errors(poses, truth, best=True) ** 2).sum()
    assert least < (position_errors(poses, truth) ** 2).sum()
    best = align_to_truth(poses, truth, best=True)
    for small in np.vstack([np.eye(3), -np.eye(3)]) * 0.01:
        assert (np.hypot(*(compose(small, best) - truth)[:, :2].T) ** 2).sum() > least
