"""The verdict on a map: whole, without odometry and with most scans spoilt, in two parts."""

import json
from dataclasses import asdict, replace

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import Alignment, odometry, pose_graph
from segmap.extraction import build_map
from segmap.scans import LaserScan, Log
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


def test_a_building_in_two_parts_is_doubtful():
    """Carried from one room to another that nothing ties to it: only one of them is in the map."""
    here = load("room")[:40]
    elsewhere = load("corridor")[80:110]
    log = logs.without_odometry(Log("moved", [*here, *elsewhere]))
    found = pose_graph(log)
    assert found.verdict.grade == "doubtful" and 40 <= found.verdict.placed < 63
    assert f"{found.verdict.placed} of 70 scans placed" in found.verdict.words


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
        ([True], None, "good"),
        ([False], None, "not a map"),
        ([True, False], None, "not a map"),
        ([True] * 5 + [False] * 15, None, "doubtful"),
        ([True] * 5 + [False] * 16, None, "not a map"),
        ([True] * 9 + [False], None, "good"),
        ([True] * 8 + [False] * 2, None, "doubtful"),
        ([True] * 4, [0.1, 0.1, 0.3, 0.3], "good"),
        ([True] * 4, [0.1, 0.3, 0.3, 0.3], "doubtful"),
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
