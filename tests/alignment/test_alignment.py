"""What every alignment method promises, whatever it does inside and whatever the log is like."""

import inspect
from dataclasses import replace
from functools import cache

import alignment_logs as logs
import numpy as np
import pytest

from segmap import alignment
from segmap.alignment import METHODS, Alignment
from segmap.alignment._result import Outcome, alignment_method
from segmap.poses import between, compose
from segmap.scans import Log

methods = pytest.mark.parametrize("name", METHODS)

#: What a method needs beside the log.
NEEDS = {"ground_truth": {"missing": "drop"}}


@cache
def log_of(case: str) -> Log:
    return CASES[case]()


@cache
def aligned(name: str, case: str) -> Alignment:
    return METHODS[name](log_of(case), **NEEDS.get(name, {}))


def plain() -> Log:
    return logs.office_log()


def kidnapped() -> Log:
    """The scans go on in another building, and the wheels say that nothing happened."""
    return logs.joined(plain()[:8], logs.loop_log(step=1.0)[8:14])


def jumping() -> Log:
    """The wheels say that the robot has jumped, and the scans that it has not."""
    log = plain()
    jump = np.where(np.arange(len(log))[:, None] < 9, 0.0, (40.0, -30.0, 2.0))
    return logs.changed(log, odometry=compose(jump, log.odometry))


def without_beams() -> Log:
    scans = list(plain())
    scans[5] = replace(scans[5], ranges=[], angles=[])
    return Log("without beams", scans, plain().truth)


def absurd() -> Log:
    """A beam of a thousand kilometres, from a sensor that states no largest range."""
    far = logs.changed(plain(), lambda k, r: np.where(np.arange(len(r)) == 90, 1e6, r))
    return Log("absurd", [replace(s, max_range=np.inf) for s in far], far.truth)


CASES = {
    "plain": plain,
    "equal times": lambda: logs.changed(plain(), times=np.zeros(99)),
    "unsorted times": lambda: logs.changed(plain(), times=np.random.default_rng(1).permutation(99)),
    "kidnapped": kidnapped,
    "odometry jumps": jumping,
    "a person walks through": lambda: logs.person(plain()),
    "30 % of the beams missing": lambda: logs.missing(plain()),
    "a blind scan": lambda: logs.blind(plain(), 5),
    "the first scan is blind": lambda: logs.blind(plain(), 0),
    "all scans are blind": lambda: logs.blind(plain(), *range(99)),
    "a scan without beams": without_beams,
    "an absurd range": absurd,
    "featureless": logs.featureless_log,
    "no odometry": lambda: logs.without_odometry(plain()),
    "odometry for some": lambda: logs.without_odometry(plain(), 3, 4, 5, 9),
    "no odometry at first": lambda: logs.without_odometry(plain(), 0, 1),
    "the robot stands": lambda: Log("stands", [plain()[3]] * 5, np.tile(plain().truth[3], (5, 1))),
    "two scans": lambda: plain()[:2],
    "a single scan": lambda: plain()[:1],
    "no scan": lambda: plain()[:0],
}


@methods
def test_metadata_and_signature(name):
    """A method that is registered under another name, or takes its thresholds by position."""
    method = METHODS[name]
    assert method.function is getattr(alignment, name)
    assert method.works in ("alone", "pairs", "map", "all")
    assert method.source
    first, *others = inspect.signature(method.function).parameters.values()
    assert first.name == "log"
    named = [p for p in others if p.kind is not p.VAR_KEYWORD]
    assert all(p.kind is p.KEYWORD_ONLY and p.default is not p.empty for p in named)


@pytest.mark.parametrize("case", CASES)
@methods
def test_every_log_gets_a_finite_pose_and_a_reason(name, case):
    """A crash, a NaN, or a scan that was skipped silently, on any of the logs that go wrong.

    And a map that wanders: first comes the odometry of the first scan, or the origin.
    """
    log, found = log_of(case), aligned(name, case)
    assert isinstance(found, Alignment) and found.method == name and found.seconds > 0
    assert found.poses.shape == (len(log), 3) and np.isfinite(found.poses).all()
    assert found.used.dtype == bool
    assert [not reason for reason in found.reasons] == found.used.tolist()
    assert len(found.reasons) == len(log)
    if len(log) and name != "ground_truth":
        first = log.odometry[0] if np.isfinite(log.odometry[0]).all() else np.zeros(3)
        np.testing.assert_allclose(between(first, found.poses[0]), 0, atol=1e-12)
    if len(log) == 1:
        assert found.reasons == ("",)


@pytest.mark.parametrize(
    "outcome",
    [
        Outcome(np.zeros((1, 3)), ["", ""]),
        Outcome(np.zeros((2, 3)), [""]),
        Outcome([(0, 0, 0), (np.nan, 0, 0)], ["", ""]),
    ],
)
def test_the_runner_refuses_a_broken_result(outcome):
    """A pose too few, a scan without a reason, a NaN: the method is at fault and is named."""

    @alignment_method
    def broken(log: Log) -> Outcome:
        return outcome

    with pytest.raises(RuntimeError, match="broken must give a finite pose and a reason"):
        broken(plain()[:2])


@methods
def test_what_is_no_log_is_refused(name):
    with pytest.raises(ValueError, match="log must be a Log, got list"):
        METHODS[name]([])


@methods
def test_the_same_log_gives_the_same_poses(name):
    """Chance from a generator of its own."""
    again = METHODS[name](CASES["plain"](), **NEEDS.get(name, {}))
    np.testing.assert_array_equal(again.poses, aligned(name, "plain").poses)
    assert again.reasons == aligned(name, "plain").reasons


@pytest.mark.parametrize("case", ["equal times", "unsorted times"])
@pytest.mark.parametrize("name", [n for n in METHODS if n != "ground_truth"])
def test_order_counts_and_times_do_not(name, case):
    """A method that sorts by time, or divides by a time that did not pass."""
    np.testing.assert_array_equal(aligned(name, case).poses, aligned(name, "plain").poses)


@pytest.mark.parametrize("name", [n for n in METHODS if n != "ground_truth"])
def test_moving_the_odometry_moves_the_poses(name):
    """Two frames mixed up: nothing but the first pose decides where the map lies.

    Cells and lattices lie along the axes, hence not exactly.
    """
    world = np.array([14.0, -9.0, 0.6])
    moved = logs.changed(plain(), odometry=compose(world, plain().odometry))
    found = METHODS[name](moved).poses
    left = between(compose(world, aligned(name, "plain").poses), found)
    assert np.hypot(left[:, 0], left[:, 1]).max() < 0.03
    assert np.abs(left[:, 2]).max() < np.radians(0.5)


@methods
def test_a_good_log_stays_good(name):
    """A method that does harm where the wheels already are right: they end 0.176 m off."""
    far, turned = logs.errors(plain(), aligned(name, "plain").poses)
    assert far.max() < 0.18
    assert turned.max() < np.radians(5)


@pytest.mark.parametrize("name", [n for n, m in METHODS.items() if m.works != "alone"])
def test_blind_scans_are_carried_by_the_odometry(name):
    """A scan without a point that counts as matched, loses the trail, or gets a pose made up."""
    found, log = aligned(name, "a blind scan"), plain()
    assert not found.used[5]
    step = between(log.odometry[4], log.odometry[5])
    np.testing.assert_allclose(between(found.poses[4], found.poses[5]), step, atol=0.01)
    assert logs.errors(log, found.poses)[0].max() < 0.15
    found = aligned(name, "all scans are blind")
    assert not found.used[1:].any()
    np.testing.assert_allclose(between(log.odometry, found.poses), 0, atol=1e-9)


def test_why_counts_the_reasons():
    """Scans that were used must not be counted, nor two reasons be mixed."""
    reasons = ("", "turning", "", "turning", "too few points")
    used = np.array([not r for r in reasons])
    found = Alignment(np.zeros((5, 3)), used, 0.1, "backbone", reasons)
    assert list(found.why()["scans"].items()) == [("turning", 2), ("too few points", 1)]
    assert np.isnan(found.trusted).all(1).tolist() == (~used).tolist()
    assert repr(found) == "Alignment(backbone: 5 scans, 2 used)"
