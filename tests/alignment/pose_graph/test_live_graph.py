"""The pose graph while the robot drives: as the whole log gives it, and after an interrupt."""

import inspect
from contextlib import suppress

import alignment_logs as logs
import numpy as np
import pytest

from segmap.alignment import LiveGraph, LoopClosing, pose_graph
from segmap.scans.causes import Cause

#: Once round a corridor: the loop closes two scans before the end.
LOG = logs.loop_log(step=0.5)
#: Loops move the poses even of a log whose odometry is this good.
AT_ONCE = LoopClosing(strain=1e-3)


def test_a_log_fed_scan_by_scan_is_aligned_as_a_whole():
    log = LOG
    whole, graph = pose_graph(log, closing=AT_ONCE), LiveGraph(closing=AT_ONCE)
    placed = [graph.add(scan) for scan in log]
    before = graph.poses
    np.testing.assert_array_equal([p.pose for p in placed][-1], before[-1])
    assert any(p.closed for p in placed) and not placed[0].closed
    found = graph.refine()
    np.testing.assert_array_equal(found.poses, whole.poses)
    assert found.reasons == whole.reasons and found.graph.rejected == whole.graph.rejected
    np.testing.assert_array_equal(found.graph.edges, whole.graph.edges)
    assert not np.array_equal(before, found.poses) and len(graph) == len(log)
    assert 0 < found.seconds < 600
    _, *options, _progress = inspect.signature(pose_graph).parameters.values()
    live = inspect.signature(LiveGraph).parameters
    assert {p.name: p.default for p in options} == {p.name: p.default for p in live.values()}


def test_the_poses_move_where_a_loop_is_said_to_close_and_only_there():
    graph, before = LiveGraph(closing=AT_ONCE), np.zeros((0, 3))
    for scan in LOG:
        _, closed = graph.add(scan)
        assert closed == (not np.array_equal(graph.poses[:-1], before))
        before = graph.poses


def test_a_tie_that_cannot_be_is_no_map_until_it_is_vetoed():
    """Catches an exception of the factorisation, which left poses free but for rounding."""
    graph = LiveGraph()
    graph.extend(LOG[:60])
    before = graph.poses
    graph.tie(5, 50, (1e6, 0.0, 0.0))
    np.testing.assert_array_equal(graph.poses, before)
    torn = graph.refine()
    assert torn.verdict.grade == "not a map" and "leave poses free" in torn.verdict.words
    assert Cause.LEFT_FREE in [finding.cause for finding in torn.causes] and not torn.sure.any()
    graph.veto([0])
    mended = graph.refine()
    assert mended.verdict.grade == "good" and mended.sure.all()


@pytest.mark.parametrize("name", ["track", "add_frame", "close", "optimize"])
def test_an_interrupt_leaves_a_graph_as_it_was(name, monkeypatch):
    """Behind each of its steps; at one of these scans a loop closes."""
    graph, wanted = LiveGraph(closing=AT_ONCE), LiveGraph(closing=AT_ONCE)
    for scan in LOG[:181]:
        graph.add(scan)
        wanted.add(scan)
    front, closer = graph.front_end, graph.loop_closer
    part = {"close": closer, "optimize": front.frames}.get(name, front)
    work = getattr(part, name)

    def interrupted(*given, **options):
        work(*given, **options)
        raise KeyboardInterrupt

    for scan in LOG[181:185]:
        with monkeypatch.context() as patch:
            patch.setattr(part, name, interrupted)
            with suppress(KeyboardInterrupt):
                graph.add(scan)
        if len(graph) == len(wanted):
            graph.add(scan)
        wanted.add(scan)
    np.testing.assert_array_equal(graph.poses, wanted.poses)
    assert repr(graph) == repr(wanted)
