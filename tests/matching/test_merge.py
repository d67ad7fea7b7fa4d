"""Two sessions of one building become one; those of two buildings do not."""

import re
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from segmap import alignment
from segmap.alignment import LiveGraph
from segmap.alignment.pose_graph import _merge
from segmap.alignment.pose_graph._merge import _places_of_both
from segmap.matching import merge
from segmap.poses import between, compose
from segmap.scans import Log
from segmap.simulation import SICK_LMS200, OdometryNoise, drive, office, simulate

#: Two ways through an office: the second comes from the other end.
THERE = [(1, 5), (2, 5), (2, 7.5), (2, 5), (6, 5), (6, 7.5), (6, 5), (10, 5), (10, 2.5), (10, 5)]
BACK = [(14.5, 5), (10, 5), (10, 7.5), (10, 5), (6, 5), (6, 2.5), (6, 5), (2, 5), (2, 2.5), (2, 5)]
THERE, BACK = [*THERE, (14, 5)], [*BACK, (10, 5)]
#: Another office.
OTHER = {"width": 5.0, "depth": 4.5, "corridor": 2.4}
ELSEWHERE = [(1, 5.7), (18, 5.7), (2.5, 5.7), (12.5, 5.7)]


def session(plan, way, seed, **sizes):
    walls = office(rng=np.random.default_rng(plan), rooms=4, **sizes)
    path, rng = drive(way, step=0.4, turn=np.radians(20)), np.random.default_rng(seed)
    return simulate(walls, path, sensor=SICK_LMS200, rng=rng, odometry_noise=OdometryNoise())


def across(found, count):
    first, second = found.graph.edges[found.graph.loop].T
    return int(((first < count) & (second >= count)).sum())


@pytest.mark.parametrize("seed", range(2))
def test_two_sessions_of_an_office_are_one_map(seed):
    """Catches a second map that is turned, moved the wrong way, or left where it began."""
    one, two = session(seed, THERE, 100 + seed), session(seed, BACK, 200 + seed)
    world = np.array([30.0, -20.0, 2.0])  # where the second robot believes to begin
    two = Log("two", [replace(s, odometry=compose(world, s.odometry)) for s in two], two.truth)
    found = merge(one, two)
    true = between(one.truth[0], np.vstack([one.truth, two.truth]))
    off = between(found.poses[0], found.poses) - true
    assert np.hypot(*off[:, :2].T).max() < 0.2
    assert found.used.all() and not found.doubt and across(found, len(one)) > 30


@pytest.mark.parametrize("seed", range(1))
def test_another_office_is_refused_though_its_corridor_is_alike(seed):
    one, two = session(seed, THERE, 100 + seed), session(seed + 50, ELSEWHERE, 300 + seed, **OTHER)
    found = merge(one, two)
    assert found.doubt.startswith("the sessions are not merged: only ")
    assert not across(found, len(one))
    assert {found.used[: len(one)].all(), found.used[len(one) :].any()} != {True}
    for poses, log in ((found.poses[: len(one)], one), (found.poses[len(one) :], two)):
        off = between(poses[0], poses) - between(log.truth[0], log.truth)
        assert np.hypot(*off[:, :2].T).max() < 0.3, "each is a map of its own"


def test_too_few_places_that_look_alike_undo_it(monkeypatch):
    """A false place that many agree with: what was tied by it is taken out."""
    one, two = session(0, THERE, 1), session(0, BACK, 2)
    graphs = LiveGraph(), LiveGraph()
    for graph, log in zip(graphs, (one, two), strict=True):
        for scan in log:
            graph.add(scan)
    kept, n = deepcopy(graphs), len(one)
    true = {tuple(scan.ranges): pose for scan, pose in zip(two, two.truth, strict=True)}

    def places(scan):
        place = between(one.truth[0], true[tuple(scan.ranges)])
        return compose(graphs[0].poses[0], place)[None]

    assert across(alignment.merge_graphs(*graphs, places), n) > 30
    monkeypatch.setattr(_merge, "LEAST_TIED_SHARE", 1.1)
    found = alignment.merge_graphs(*graphs, places)
    assert "places that both passed look alike" in found.doubt and not across(found, n)
    assert {r.reason for r in found.graph.rejected} >= {found.doubt.split(": ")[1].split(";")[0]}
    alike, passed, *_ = map(int, re.findall(r"\d+", found.doubt))
    monkeypatch.setattr(_merge, "LEAST_TIED_SHARE", Fraction(alike, passed))
    assert across(alignment.merge_graphs(*graphs, places), n) > 30, "just so many must be alike"
    twice = alignment.merge_graphs(*graphs, lambda scan: np.repeat(places(scan), 2, axis=0))
    assert "only 0 places" in twice.doubt, "two places are none"
    for graph, before in zip(graphs, kept, strict=True):
        np.testing.assert_array_equal(graph.poses, before.poses)
        assert repr(graph) == repr(before)


def test_places_that_both_passed_lie_near_and_are_seen_the_same_way():
    old = [(0, 0, 3.1), (5, 0, 0)]
    new = [(0.9, 0, -3.1), (0.5, 0, 0), (5, 1.1, 0), (5, 0.9, 0), (5, 0.5, 3)]
    poses = np.array([*old, *new])
    assert _places_of_both(poses, 2) == {2, 5}


@pytest.mark.parametrize("shift", [2, 3])
def test_a_corridor_that_repeats_is_not_merged_by_one_of_its_doors(shift):
    """Ten doors alike: from the middle of one corridor nothing tells which door it is."""
    doors = np.arange(-20, 21, 2.0)
    walls = [[(a + 0.5, y), (b - 0.5, y)] for a, b in pairwise(doors) for y in (-1, 1)]

    def drive_from(x, seed):
        path = drive([(x, 0), (x + 8, 0)], step=0.4)
        rng = np.random.default_rng(seed)
        return simulate(np.array(walls), path, sensor=SICK_LMS200, rng=rng)

    found = merge(drive_from(-6, 0), drive_from(-6 + shift, 1))
    assert "not merged" in found.doubt
