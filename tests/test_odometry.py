"""The baseline and the truth: what the wheels say, and poses interpolated at each scan's time."""

import alignment_logs as logs
import numpy as np
import pytest

from segmap.alignment import ground_truth, odometry
from segmap.poses import between, compose
from segmap.scans import LaserScan, Log

TIMES = np.array([0.0, 1.0, 2.0, 3.0])


def log_at(*times: float, odometry=None, truth=None) -> Log:
    wheels = [None] * len(times) if odometry is None else odometry
    scans = [LaserScan([1.0], [0.0], t, o) for t, o in zip(times, wheels, strict=True)]
    return Log("four", scans, truth)


# ------------------------------------------------------------------ odometry
def test_odometry_is_what_the_wheels_say():
    log = logs.office_log()
    found = odometry(log)
    np.testing.assert_array_equal(found.poses, log.odometry)
    assert found.used.all()


def test_a_scan_without_odometry_moves_on_as_the_robot_did():
    """The robot would stop, or the motion be taken in the world's axes."""
    motion = np.array([0.5, 0.1, 0.2])
    wheels = [np.array([3.0, 2.0, 1.0])]
    for _ in range(5):
        wheels.append(compose(wheels[-1], motion))
    gaps = [w if k not in (2, 3) else None for k, w in enumerate(wheels)]
    found = odometry(log_at(*range(6), odometry=gaps))
    np.testing.assert_allclose(found.poses, wheels, atol=1e-12)
    assert found.used.tolist() == [True, True, False, False, True, True]
    assert found.reasons == ("", "", "no odometry", "no odometry", "", "")


def test_a_log_without_odometry_stays_where_it_began():
    """A first scan without odometry that counts as used."""
    found = odometry(log_at(0, 1, 2))
    assert found.poses.tolist() == [[0, 0, 0]] * 3
    assert not found.used.any()


# ------------------------------------------------------------------ ground truth
def test_poses_are_interpolated_at_the_times_of_the_scans():
    """A 3.3.3: linear in x and y, by the shorter way round in heading."""
    poses = [(0, 0, 3.0), (1, 2, -3.0), (3, 2, -2.0), (3, 0, 0.0)]
    found = ground_truth(log_at(0, 0.25, 2, 2.5), times=TIMES, poses=poses)
    to_seam = 2 * np.pi - 6.0
    expected = [(0, 0, 3.0), (0.25, 0.5, 3.0 + to_seam / 4), (3, 2, -2.0), (3, 1, -1.0)]
    np.testing.assert_allclose(found.poses, expected, atol=1e-12)
    assert found.used.all()


def test_the_truth_of_the_log_itself():
    log = logs.office_log()
    np.testing.assert_allclose(ground_truth(log).poses, log.truth, atol=1e-12)
    shuffled = np.random.default_rng(1).permutation(len(log)).astype(float)
    found = ground_truth(logs.changed(log, times=shuffled))
    np.testing.assert_allclose(found.poses, log.truth, atol=1e-12)


def test_rows_of_nan_are_bridged():
    """A scan without truth between two with: its pose comes from both."""
    truth = np.array([(0, 0, 0), (np.nan,) * 3, (2, 0, 1.0)])
    found = ground_truth(log_at(0, 0.5, 2, truth=truth))
    np.testing.assert_allclose(found.poses[1], (0.5, 0, 0.25))
    with pytest.raises(ValueError, match=r"scan 1 of log 'four', at 0\.500000 s"):
        ground_truth(log_at(0, 0.5, 2, truth=truth), max_gap=1.0)


@pytest.mark.parametrize(("times", "scan"), [((-0.1, 1), 0), ((0, 3.5, 9), 1), ((0, 1, 1.5), 2)])
def test_a_time_of_which_nothing_is_known_is_an_error_that_names_the_scan(times, scan):
    """Poses made up outside of what is known, or within a gap."""
    known = np.array([0.0, 1.0, 3.0])
    with pytest.raises(ValueError, match=f"scan {scan} of log 'four', at {times[scan]:.6f} s"):
        ground_truth(log_at(*times), times=known, poses=np.zeros((3, 3)), max_gap=1.5)


def test_such_scans_are_dropped_when_asked():
    """The odometry carries on from the last pose that is known, and back from the first."""
    wheels = compose((5, 5, 1.0), [(-1, 0, 0), (0, 0, 0), (1, 0, 0.5), (2, 0, 0.5), (3, 0, 0.5)])
    known = np.array([(0, 0, 0.0), (1, 0, 0.5)])
    log = log_at(-1, 0, 1, 2, 3, odometry=wheels)
    found = ground_truth(log, times=[0, 1], poses=known, missing="drop")
    assert found.used.tolist() == [False, True, True, False, False]
    assert found.reasons[3] == found.reasons[0] == "no ground truth at its time"
    np.testing.assert_allclose(found.poses[1:3], known, atol=1e-12)
    np.testing.assert_allclose(
        between(found.poses[1], found.poses), between(wheels[1], wheels), atol=1e-12
    )
    assert np.isnan(found.trusted[[0, 3, 4]]).all()


def test_without_odometry_a_dropped_first_scan_takes_the_first_known_pose():
    found = ground_truth(log_at(-1, 0), times=[0], poses=[(4, 5, 1)], missing="drop")
    np.testing.assert_allclose(found.poses, [(4, 5, 1), (4, 5, 1)])


def test_nothing_known_at_any_scan():
    """An index into an empty list of poses that are known."""
    log = log_at(7, 8, odometry=[(1, 1, 1), (2, 1, 1)])
    found = ground_truth(log, times=[0], poses=np.zeros((1, 3)), missing="drop")
    np.testing.assert_array_equal(found.poses, log.odometry)
    assert not found.used.any()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "log 'four' holds no ground truth"),
        ({"times": [0, 1]}, "times and poses belong together"),
        ({"poses": np.zeros((2, 3))}, "times and poses belong together"),
        ({"times": [1, 0], "poses": np.zeros((2, 3))}, "not decrease"),
        ({"times": [0], "poses": np.zeros((2, 3))}, r"poses must be \(1, 3\)"),
        ({"missing": "skip"}, "missing must be one of 'raise', 'drop', got 'skip'"),
    ],
)
def test_wrong_arguments_are_named(given, message):
    with pytest.raises(ValueError, match=message):
        ground_truth(log_at(0, 1), **given)
