"""Every alignment says where the odometry that it was given contradicts the map that it makes."""

from dataclasses import replace

import numpy as np
import pytest
from alignment_logs import AROUND

from segmap import alignment, load, matching
from segmap.poses.motions import between
from segmap.scans.causes import Cause
from segmap.scans.odometry import contradictions
from segmap.simulation import corridor_loop, drive, simulate

LOG = load("corridor")


def with_odometry(change):
    """The log with `change(rows)` of its odometry."""
    rows = change(LOG.odometry.copy())
    scans = [replace(scan, odometry=row) for scan, row in zip(LOG, rows, strict=True)]
    return replace(LOG, scans=tuple(scans))


def started_again(rows):
    half = len(rows) // 2
    return np.r_[rows[:half], between(rows[half], rows[half:])]


def longer(rows):
    return rows * (2, 2, 1)


def counted_the_other_way(rows):
    return rows * (1, -1, -1)


WRONG = [
    (started_again, Cause.JUMP),
    (longer, Cause.SCALE),
    (counted_the_other_way, Cause.MIRRORED),
]


@pytest.mark.parametrize("method", ["point_icp", "pose_graph", "odometry"])
def test_right_odometry_contradicts_nothing(method):
    """Catches an alarm where all is well."""
    causes = {each.cause for each in alignment.METHODS[method](LOG).causes}
    assert not causes & {Cause.JUMP, Cause.SCALE, Cause.MIRRORED, Cause.NO_ODOMETRY}


@pytest.mark.parametrize(("change", "cause"), WRONG)
def test_wrong_odometry_is_told_and_makes_a_map_doubtful(change, cause):
    """Catches a map by an odometry that it contradicts, called good, of who skips `prepared`."""
    found = alignment.METHODS["ground_truth"](with_odometry(change))
    (told,) = [each for each in found.causes if each.doubtful]
    assert told.cause == cause and "alignment.prepared" in str(told)
    assert found.verdict.grade == "doubtful"


def test_odometry_that_is_late_now_and_then_contradicts_nothing():
    """Catches turns compared over one step: of rows up to two scans late they are half of true."""
    corners = [(1, 1), (29, 1), (29, 13), (1, 13), (1, 1), (10, 1)]
    path = drive(corners, step=0.2, turn=np.radians(12))
    log = simulate(corridor_loop(30, 14), path, sensor=AROUND, rng=np.random.default_rng(1))
    late = np.random.default_rng(9).integers(0, 3, len(log))
    rows = log.odometry[np.clip(np.arange(len(log)) - late, 0, None)]
    scans = [replace(scan, odometry=row) for scan, row in zip(log, rows, strict=True)]
    assert not contradictions(scans, path, np.full(len(log), True))


def test_what_prepared_told_is_not_told_again():
    """Catches the same doubt twice in one verdict."""
    log = alignment.prepared(with_odometry(started_again))
    assert [each.cause for each in log.causes] == [Cause.JUMP]
    assert alignment.METHODS["ground_truth"](log).causes == log.causes


def test_straight_steps_that_contradict_each_other_are_told():
    """Catches headings that count clockwise: each step is turned by another angle."""
    found = alignment.METHODS["ground_truth"](with_odometry(lambda rows: rows * (1, 1, -1)))
    assert {Cause.MIRRORED, Cause.NO_ODOMETRY} <= {each.cause for each in found.causes}
    assert found.verdict.grade == "doubtful"


def test_scans_that_are_not_used_contradict_nothing():
    """Catches poses that only carry the odometry on, or that nobody believes."""
    used = np.arange(len(LOG)) % 2 == 0
    poses = np.where(used[:, None], LOG.truth, LOG.truth * (3, 3, 1))
    assert contradictions(LOG, poses, used) == []
    assert contradictions(LOG, poses, ~used | used) != []


def test_the_step_between_two_merged_sessions_is_no_jump():
    """Catches two odometries, each with its own origin, taken for one."""
    half = len(LOG) // 2
    found = matching.merge(LOG[: half + 20], LOG[half - 20 :])
    assert not {each.cause for each in found.causes} & {Cause.JUMP, Cause.SCALE, Cause.MIRRORED}


@pytest.mark.parametrize("factor", [0.0, 0.5, 2.0])
def test_an_odometry_that_turns_otherwise_is_told(factor):
    """Catches wheels whose headings are in another unit, or stand still."""
    found = alignment.METHODS["ground_truth"](with_odometry(lambda rows: rows * (1, 1, factor)))
    assert any("the map turns by" in each.words and each.doubtful for each in found.causes)
