"""The verdict on a map: whole, without odometry and with most scans spoilt, in two parts."""

import json
from dataclasses import asdict, replace

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import Alignment, odometry, pose_graph
from segmap.extraction import build_map
from segmap.scans import LaserScan
from segmap.scans.causes import Cause, Finding
from segmap.segments import SegmentMap


def outcome(used, *, method="pose_graph", spread=None):
    placed = np.asarray(used, bool)
    reasons = tuple("" if one else "too few points" for one in placed)
    return Alignment(np.zeros((len(placed), 3)), placed, 0.1, method, reasons, spread=spread)


def test_a_whole_map_is_good():
    log = load("room")
    found = pose_graph(log)
    verdict = found.verdict_on(build_map(log, found.trusted))
    assert verdict.grade == "good" and str(verdict).startswith("GOOD: 61 of 61 scans placed")
    assert (verdict.placed, verdict.scans, verdict.sure) == (61, 61, 61)
    assert verdict.worst < 0.5 and verdict.doubled < 0.05
    assert found.verdict == replace(verdict, doubled=None, words=found.verdict.words)


@pytest.mark.parametrize(
    ("seeing", "grade"), [(1, "not a map"), (5, "not a map"), (30, "doubtful")]
)
def test_a_log_of_which_few_scans_see_anything_is_no_map(seeing, grade):
    """Catches what is 100 % right of the one scan in sixty that was placed."""
    found = pose_graph(logs.without_odometry(logs.blind(load("room"), *range(seeing, 61))))
    assert found.verdict.grade == grade
    word = "NOT A MAP" if grade == "not a map" else "DOUBTFUL"
    assert found.verdict.words.startswith(f"{word}: {seeing} of 61 scans placed")


def test_wheels_alone_are_doubtful_and_their_walls_are_doubled():
    """Catches a baseline that counts all its scans as placed, whatever it draws."""
    log = load("malaga")
    found = odometry(log)
    verdict = found.verdict_on(build_map(log, found.trusted))
    assert verdict.grade == "doubtful" and verdict.doubled > 0.5
    assert "wheels" in found.verdict.words and "of the walls doubled" in verdict.words


@pytest.mark.parametrize(
    ("used", "spread", "grade"),
    [
        ([], None, "not a map"),
        ([True], None, "not checked"),
        ([True] * 2, None, "good"),
        ([False], None, "not a map"),
        ([True, False], None, "not a map"),
        ([True] * 5 + [False] * 15, None, "doubtful"),
        ([True] * 5 + [False] * 16, None, "not a map"),
        ([True] * 9 + [False], None, "good"),
        ([True] * 8 + [False] * 2, None, "doubtful"),
        ([True] * 10, [0.1] * 9 + [0.3], "good"),
        ([True] * 10, [0.1] * 8 + [0.3] * 2, "doubtful"),
    ],
)
def test_where_the_grades_begin(used, spread, grade):
    """Catches a bound on the wrong side, and a share of no scan."""
    found = outcome(used, spread=None if spread is None else np.array(spread))
    assert found.verdict.grade == grade
    assert json.loads(json.dumps(asdict(found.verdict)))["scans"] == len(used)


def test_what_makes_it_doubtful_comes_first():
    found = outcome([True] * 4, spread=np.array([0.1, 0.3, 0.3, 0.4]))
    assert str(found.verdict) == "DOUBTFUL: 1 scan sure; 4 of 4 scans placed, all within 0.80 m"
    assert found.verdict.worst == pytest.approx(0.8)


def test_scans_without_a_wall_are_no_map():
    scans = [LaserScan([1.0, 1.0, 1.0], [0.0, 2.0, 4.0])] * 3
    found = outcome([True] * 3)
    verdict = found.verdict_on(SegmentMap(np.empty((0, 2, 2))))
    assert len(scans) == verdict.placed and verdict.grade == "not a map"
    assert verdict.words == "NOT A MAP: 3 of 3 scans placed, but no wall found"


@pytest.mark.parametrize(("spread", "grade"), [(0.4, "doubtful"), (1.5, "not a map")])
def test_a_large_building_may_be_sure_in_each_of_its_parts(spread, grade):
    """No scan is sure in 300 m of building, and each is relative to those within 20 m."""
    whole = outcome([True] * 10, spread=np.full(10, spread))
    found = replace(whole, local_spread=np.array([0.1] * 9 + [0.4]))
    assert found.verdict.grade == "good"
    assert "0 scans sure (9 relative to those within 20 m)" in str(found.verdict)
    assert whole.verdict.grade == grade and "relative" not in str(whole.verdict)


def test_a_good_map_promises_half_a_metre_at_most():
    """Catches a good map that says 0.6 m, and one that promises what a scan does not hold."""
    used, spread = [True] * 10 + [False], np.array([0.1] * 9 + [0.9, 7.0])  # nobody sees the last
    some = outcome(used, spread=spread).verdict
    assert str(some) == "GOOD: 10 of 11 scans placed, 9 scans sure, all but 1 within 0.5 m"
    assert some.worst == 1.8
    near = replace(outcome([True] * 6, spread=np.full(6, 0.4)), local_spread=np.full(6, 0.1))
    assert near.verdict.grade == "good" and "within 0" not in near.verdict.words


def test_nothing_is_promised_where_something_speaks_against_the_map():
    """Catches "all within 0.16 m" of a map whose second half was carried elsewhere: 15 m off."""
    fine = outcome([True] * 6, spread=np.full(6, 0.08))
    lifted = Finding(Cause.LIFTED, 3, "at scan 3 all that the robot sees changes", doubtful=True)
    told = Finding(Cause.UNIT, 0.01, "the odometry is in centimetres: converted")
    assert "within 0.16 m" in replace(fine, causes=(told,)).verdict.words
    assert "within" not in replace(fine, causes=(told, lifted)).verdict.words


@pytest.mark.parametrize(
    ("spread", "count", "grade"),
    [
        (1.01, 10, "not a map"),
        (0.99, 10, "doubtful"),
        (1.01, 3, "not a map"),
        (np.nan, 10, "not a map"),
    ],
)
def test_scans_that_may_lie_anywhere_are_no_map(spread, count, grade):
    """Catches a deviation for twice of it, and a spread that is not known."""
    found = outcome([True] * count, spread=np.full(count, spread))
    assert found.verdict.grade == grade
    one = replace(found, spread=np.append(np.full(count - 1, spread), 0.1))
    assert one.verdict.grade == "doubtful"


def test_findings_make_a_map_doubtful():
    """Catches one that is told and costs nothing, and one that was put right and costs all."""
    mended = Finding(Cause.UNIT, 0.01, "the odometry is in centimetres: converted")
    wrong = Finding(Cause.SCALE, 0.9, "wheels or ranges are 10 % off", doubtful=True)
    good = replace(outcome([True] * 4), causes=(mended,))
    assert good.verdict.grade == "good" and good.verdict.causes == ()
    assert good.doubt == "the odometry is in centimetres: converted"
    bad = replace(good, causes=(mended, wrong))
    assert str(bad.verdict) == "DOUBTFUL: wheels or ranges are 10 % off; 4 of 4 scans placed"
    assert bad.verdict.causes == ("scale",)
    apart = Finding(Cause.NOT_MERGED, 0, "the sessions are not merged: none agrees", doubtful=True)
    assert replace(good, causes=(mended, apart)).verdict.words == f"NOT A MAP: {apart.words}"


def test_poses_that_a_user_moves_do_not_change_what_the_alignment_says():
    """Catches findings that are worked out late, of poses that somebody has edited meanwhile."""
    log = load("corridor")[:40]
    asked, edited = pose_graph(log), pose_graph(log)
    edited.poses[::2, 2] += 2
    edited.used[:] = False
    assert edited.causes == asked.causes
    np.testing.assert_array_equal(edited.spread, asked.spread)
