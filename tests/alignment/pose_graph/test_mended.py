"""Loops listed, vetoed and tied by hand: the graph is as if they had always, or never, been."""

from copy import deepcopy

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import Alignment, Graph, LiveGraph
from segmap.alignment.graph import Edge
from segmap.poses import between, compose, inverse
from segmap.testing import assert_poses_equal

#: Once round a corridor; every second scan hangs half a step behind its key frame.
LOG = logs.loop_log()
#: A motion that is false between any two places of it.
FALSE = np.array([1.5, 1.0, 0.4])


@pytest.fixture(scope="module")
def driven():
    graph = LiveGraph()
    for scan in LOG:
        graph.add(scan)
    graph.refine()
    return graph


def test_loops_are_listed_with_their_span_and_both_places():
    """Catches ends exchanged, a span that is the distance, steps among the loops."""
    poses = np.array([(0, 0, 0), (3, 4, 1), (3, 0, 2), (0.5, 0, 3)], float)
    ends = np.array([(0, 1), (1, 2), (2, 3), (0, 3), (3, 1)])
    graph = Graph(ends, np.zeros((5, 3)), np.arange(5) > 2, np.arange(5.0))
    found = Alignment(poses, np.ones(4, bool), 0.0, graph=graph).loops()
    assert found.index.name == "loop" and found.index.tolist() == [0, 1]
    columns = "first second residual scans metres x_first y_first x_second y_second"
    assert found.columns.tolist() == columns.split()
    assert found.values.tolist() == [
        [0, 3, 3, 3, 11.5, 0, 0, 0.5, 0],
        [3, 1, 4, 2, 6.5, 0.5, 0, 3, 4],
    ]
    alone = Alignment(poses[:1], np.ones(1, bool), 0.0).loops()
    assert len(alone) == len(LiveGraph().loops()) == 0 and alone.columns.tolist() == columns.split()


def test_without_a_false_loop_the_graph_is_as_if_it_had_never_been(driven):
    """Catches a loop that is left as a witness, a way or an edge, and another one taken out."""
    graph, wanted = deepcopy(driven), deepcopy(driven)
    front, closer = graph.front_end, graph.loop_closer
    false = [Edge(k, k + 60, FALSE, np.eye(3) * 1e4, True, True) for k in (20, 21)]
    known = len(graph.loops())
    closer.believe(false[:1])
    closer.believe([Edge(3, 130, between(*front.frames.poses[[3, 130]]), np.eye(3), True)])
    closer.believe(false[1:])
    front.frames.optimize()
    assert np.hypot(*(graph.poses - driven.poses)[:, :2].T).max() > 0.5
    row = graph.loops().query(f"first == {front.frames.rows[20].scan}").index
    graph.veto([row[-1], known + 2])
    assert {(r.first, r.second) for r in closer.rejected if "veto" in r.reason} == {
        (front.frames.rows[k].scan, front.frames.rows[k + 60].scan) for k in (20, 21)
    }
    its_front, its_closer = wanted.front_end, wanted.loop_closer
    its_closer.believe([Edge(3, 130, between(*its_front.frames.poses[[3, 130]]), np.eye(3), True)])
    its_front.frames.optimize()
    assert_poses_equal(graph.poses, wanted.poses, atol=1e-4)
    assert len(closer.accepted) == len(its_closer.accepted) == known + 1
    assert sorted(closer.ways.tolist()) == sorted(its_closer.ways.tolist())
    assert_poses_equal(graph.refine().poses, wanted.refine().poses, atol=1e-3)


@pytest.mark.parametrize("ends", [(61, 290), (290, 61), (60, 291)])
def test_a_forced_tie_holds_and_the_loops_that_contradict_it_give_way(driven, ends):
    """Half a metre off what many loops say: robust weights would leave it open.

    Scans between key frames: catches an offset that is left out, or turned round.
    """
    graph, (first, second) = deepcopy(driven), ends
    relative = compose(between(*driven.poses[[first, second]]), (0.3, 0.4, 0.1))
    graph.tie(first, second, relative)
    x, y, heading = between(relative, between(*graph.poses[[first, second]]))
    assert np.hypot(x, y) < 0.1 and abs(heading) < 0.01  # 0.3 degrees at 29 m are 0.15 m
    graph.refine()
    tied = graph.loops().iloc[-1]
    assert abs(tied["first"] - 60) < 3 and abs(tied["second"] - 290) < 3
    x, y, _ = between(relative, between(*graph.poses[[first, second]]))
    assert np.hypot(x, y) < 0.2, "the scans between key frames are laid anew"


def test_a_tie_may_be_told_from_either_end_and_moves_with_the_world(driven):
    one, two = deepcopy(driven), deepcopy(driven)
    world = np.array([30.0, -8.0, 2.5])
    frames = two.front_end.frames
    frames.poses = compose(world, frames.poses)
    relative = compose(between(*driven.poses[[61, 290]]), (0.3, 0.4, 0.1))
    one.tie(61, 290, relative)
    two.tie(290, 61, inverse(relative))
    assert_poses_equal(two.poses, compose(world, one.poses), atol=1e-4)
    one.veto(len(one.loops()) - 1)
    two.veto(len(two.loops()) - 1)
    assert_poses_equal(two.poses, compose(world, one.poses), atol=1e-4)
    assert_poses_equal(one.poses, driven.poses, atol=1e-4)


def test_loops_that_a_false_tie_drove_out_come_back_with_its_veto(driven):
    """Catches a veto that leaves the graph without them for good, or counts them as rejected."""
    graph, known = deepcopy(driven), driven.loops()[["first", "second"]].values.tolist()
    assert len(known) > 3
    rejected = driven.loop_closer.not_believed()
    for end in (330, 334, 338):  # against one tie alone they stay, and a step gives way
        graph.tie(0, end, FALSE)
    graph.refine()
    listed = graph.loops()[["first", "second"]].values.tolist()
    assert len(listed) < len(known) + 3
    graph.veto(range(len(listed) - 3, len(listed)))
    assert graph.loops()[["first", "second"]].values.tolist() == known
    found, wanted = (each.front_end.frames.poses for each in (graph, driven))
    assert_poses_equal(found, wanted, atol=1e-4)
    assert [r for r in graph.loop_closer.not_believed() if "veto" not in r.reason] == rejected


def test_two_places_are_matched_at_any_heading_or_a_reason_is_given(driven):
    """Catches the pose of a key frame for that of the scan, and ends exchanged."""
    for first, second in ((9, 340), (340, 9)):
        match = driven.match(first, second)
        assert match.matched and match.overlap > 0.8
        x, y, turn = between(between(*LOG.truth[[first, second]]), match.pose)
        assert np.hypot(x, y) < 0.05 and abs(turn) < 0.01
    none = driven.match(0, 60)
    assert not none.matched and "different" in none.reason


def test_a_place_before_one_where_the_robot_was_lost_can_be_matched(driven):
    graph = deepcopy(driven)
    graph.loop_closer.lost_since = 170
    assert graph.match(340, 9).matched


def test_what_is_drawn_is_out_of_date_after_a_tie(driven):
    """A live map is made anew where `closed` says so."""
    graph = deepcopy(driven)
    graph.tie(61, 290, FALSE)
    assert [graph.add(LOG[-1]).closed for _ in range(2)] == [True, False]


def test_what_is_interrupted_changes_nothing(driven, monkeypatch):
    graph = deepcopy(driven)

    def fails(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(graph.front_end.frames, "optimize", fails)
        for work in (lambda: graph.veto(0), lambda: graph.tie(61, 290, FALSE)):
            with pytest.raises(KeyboardInterrupt):
                work()
    assert graph.loops().equals(driven.loops()) and repr(graph) == repr(driven)
    graph.tie(61, 290, FALSE)
    graph.veto(len(graph.loops()) - 1)
    assert_poses_equal(graph.poses, driven.poses, atol=1e-4)


def test_ties_that_contradict_each_other_both_hold():
    """Three metres apart: each is left open by many deviations, and stays.

    Catches a loop by force that is taken out as one that the others contradict.
    """
    graph, log = LiveGraph(), load("room")[:14]
    graph.extend(log)
    there = between(*log.truth[[2, 9]])
    for off in (-1.5, 1.5):
        graph.tie(2, 9, compose(there, (off, 0.0, 0.0)))
    found = graph.refine().loops()
    assert found[["first", "second"]].values.tolist() == [[2, 9]] * 2
    assert (found["residual"] > 20).all()
