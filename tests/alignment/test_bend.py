"""Whether solved poses keep what the matches said as they came."""

import re
from dataclasses import replace

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import ground_truth, pose_graph
from segmap.alignment.graph import REAL, bends
from segmap.poses import between, compose
from segmap.scans.causes import Cause


def chain(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Motions of a drive that turns, their covariances, and the poses that they lead to."""
    rng = np.random.default_rng(seed)
    motions = np.stack(
        [np.full(count, 0.5), 0.1 * rng.normal(size=count), rng.normal(size=count)], -1
    )
    poses = [np.array([3.0, -2.0, 3.1])]
    for motion in motions:
        poses.append(compose(poses[-1], motion))
    return motions, np.broadcast_to(REAL, (count, 3, 3)), np.array(poses)


def literal_size(motions, covariances, poses, first: int, last: int) -> float:
    """Of one window, its covariance by derivatives that are differences."""

    def end(errors: np.ndarray) -> np.ndarray:
        pose = np.zeros(3)
        for motion, error in zip(motions[first:last], errors, strict=True):
            pose = compose(pose, motion + error)
        return between(composed, pose) if composed is not None else pose

    composed, none = None, np.zeros((last - first, 3))
    composed = end(none)
    covariance = np.zeros((3, 3))
    for k in range(last - first):
        columns = []
        for axis in range(3):
            error = none.copy()
            error[k, axis] = 1e-6
            columns.append(end(error) / 1e-6)
        jacobian = np.array(columns).T
        covariance += jacobian @ covariances[first + k] @ jacobian.T
    off = between(composed, between(poses[first], poses[last]))
    return float(np.sqrt(off @ np.linalg.solve(covariance, off)))


def test_the_covariance_of_a_window_is_carried_along_it():
    """Catches a step that is not turned, an arm on the wrong side, a window that is one short."""
    motions, covariances, poses = chain(20)
    solved = poses + 0.01 * np.random.default_rng(1).normal(size=poses.shape)
    found = bends(motions, covariances, solved)
    assert set((found.last - found.first).tolist()) == {4, 8, 16}
    for k in (0, 5, -1):
        first, last = int(found.first[k]), int(found.last[k])
        expected = literal_size(motions, covariances, solved, first, last)
        assert found.size[k] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_where_the_map_is_torn_is_named(seed):
    """Catches a tear that is told of the half behind it, and its metres seen from the origin."""
    motions, covariances, poses = chain(40, seed)
    scans = 3 * np.arange(41)
    assert not bends(motions, covariances, poses).finding(scans, "the map")
    poses[21:] = compose(np.array([0.6, 0.8, 0.0]), poses[21:])
    (finding,) = bends(motions, covariances, poses).finding(scans, "the map")
    first, last = map(int, finding.words.split("scans ")[1].split(" the")[0].split(" and "))
    assert first <= 60 < 63 <= last <= first + 12 and finding.value == pytest.approx(1.0)
    assert (
        finding.cause is Cause.BEND and finding.doubtful and "1.00 m and 0.0 deg" in finding.words
    )


@pytest.mark.parametrize("name", ["room", "malaga"])
def test_right_maps_keep_what_the_matches_say(name):
    """Catches a covariance for an information, and a heading that is not wrapped."""
    log = load(name)
    for each in (log, logs.without_odometry(log)):
        assert Cause.BEND not in {finding.cause for finding in pose_graph(each).causes}


# ------------------------------------------------------------------ poses that came with a log
@pytest.mark.parametrize("metres", [0.0, 0.6, 3.0])
def test_poses_of_a_log_are_compared_with_matches(metres):
    """Catches half of a path that lies 3 m elsewhere, and GOOD since nobody asked."""
    log = load("malaga")
    truth = log.truth.copy()
    truth[112:, :2] += metres * np.array([0.6, 0.8])
    verdict = ground_truth(replace(log, truth=truth), missing="drop").verdict
    assert verdict.grade == ("doubtful" if metres else "good")
    assert verdict.causes == (("bend",) * len(verdict.causes)) and bool(verdict.causes) == (
        metres > 0
    )
    if metres:
        said = re.findall(r"([\d.]+) m\b", verdict.words)
        assert any(abs(float(each) - metres) < 0.2 for each in said)


@pytest.mark.parametrize("metres", [0.5, 3.0])
def test_poses_that_are_moved_along_a_corridor_leave_its_revisits_open(metres):
    """Catches loops that wait for others when the log ends, and are never asked."""
    log = load("corridor")
    truth = log.truth.copy()
    truth[len(truth) // 2 :, 0] += metres
    assert "revisits" in ground_truth(replace(log, truth=truth)).verdict.words


def test_poses_that_no_match_confirms_are_not_checked():
    """Catches poses of scans that see nothing, and of one place, that are called good."""
    log = load("room")
    verdict = ground_truth(logs.blind(log, *range(15, 61))).verdict
    assert verdict.grade == "not checked" and "no match confirms" in verdict.words
    rest = replace(log[:3], truth=np.zeros((3, 3)))
    assert ground_truth(rest).verdict.words.startswith("NOT CHECKED: one look; nothing confirms it")
