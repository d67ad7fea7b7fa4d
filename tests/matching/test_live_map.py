"""A map that loops move: nothing is lost, the old one stands meanwhile, the end is corrected."""

import pickle
from concurrent.futures import wait

import numpy as np
import pytest
from planned_loops import LOG, Planned, held_back
from quadtrees import state

from segmap import LaserScan, extraction
from segmap.alignment import LiveGraph, LoopClosing
from segmap.carried import CarriedMap
from segmap.matching import LiveMap, _live_map, map_scans
from segmap.poses import between, compose
from segmap.quadtree import QuadtreeMap
from segmap.reduction import LiveReduction, hybrid_fusion
from segmap.scans import Log

START = (3.0, 2.0, 0.5)


def blank(resolution=0.05):
    return QuadtreeMap(resolution=resolution, free_resolution=0.4)


def expected(log, poses):
    """The map of all scans at their corrected poses."""
    map = blank()
    for scan, pose in zip(log, poses, strict=True):
        _live_map.insert_placed(map, None, scan, pose, free=False)
    return state(map)


def finished(closes, **options):
    """A live map after the whole log, and the scans at which a loop closed."""
    live = LiveMap(Planned(closes), map=blank(), **options)
    closed = [k for k, scan in enumerate(LOG) if live.add(scan).closed]
    live.finish()
    return live, closed


@pytest.mark.parametrize("closes", [(), (5,), (5, 6, 7, 20), (23,), tuple(range(24))])
def test_the_map_in_the_end_is_that_of_the_corrected_poses(closes):
    """Whenever loops close, while another map is being made too; and at the last scan.

    The reduced map is made anew with it: that of the on-line method, and walls are few again.
    """
    walls = LiveReduction(every=8)
    live, closed = finished(closes, start=START, walls=walls)
    assert closed == list(closes)
    graph = live.graph.poses
    np.testing.assert_allclose(live.poses, compose(START, between(graph[0], graph)), atol=1e-12)
    assert live.map.scans == len(LOG) and state(live.map) == expected(LOG, live.poses)
    whole = hybrid_fusion(extraction.build_map(Log("it", LOG.scans), live.poses), every=8)
    assert walls.scans == len(LOG) and live.walls is walls
    np.testing.assert_allclose(walls.segments, whole.segments, atol=1e-9)


def test_map_scans_with_a_graph():
    """Steps tell of loops, and the map that was given is the corrected one when the log ends."""
    map, graph = blank(), Planned((9, 20))
    steps = list(map_scans(LOG, graph=graph, map=map, start=START))
    assert [k for k, step in enumerate(steps) if step.closed] == [9, 20]
    poses = compose(START, between(graph.poses[0], graph.poses))
    np.testing.assert_allclose(steps[-1].pose, poses[-1])
    assert state(map) == expected(LOG, poses)
    with pytest.raises(ValueError, match="graph must be a LiveGraph"):
        map_scans(LOG, graph="graph")


def test_a_new_graph_closes_loops():
    """The robot drives to and fro; what the graph then holds is what the map shows."""
    near = {"old_frames": 1, "new_frames": 1}  # the places are closer than usual
    rules = LoopClosing(min_path=0.5, witnesses=1, span=0.1, strain=1e-6, **near)
    graph, map = LiveGraph(step=0.2, closing=rules), blank()
    steps = list(map_scans(LOG, graph=graph, map=map, start=LOG.truth[0]))
    assert any(step.closed for step in steps)
    poses = compose(LOG.truth[0], between(graph.poses[0], graph.poses))
    assert np.hypot(*(poses - LOG.truth)[:, :2].T).max() < 0.03
    assert state(map) == expected(LOG, poses)


def test_the_old_map_stands_until_the_new_one_holds_all_scans(monkeypatch):
    """Catches a map that is empty for seconds, and one that misses what came meanwhile."""
    real, go = _live_map.insert_placed, held_back(monkeypatch)
    live, old = LiveMap(Planned((9,)), map=blank()), blank()
    for k, scan in enumerate(LOG):
        real(old, None, scan, live.add(scan).pose, free=False)
        assert live.map.scans == k + 1 and state(live.map) == state(old)
    go.set()
    live.finish()
    assert live.map.scans == len(LOG) and state(live.map) == expected(LOG, live.poses) != state(old)


def test_the_new_map_is_taken_as_soon_as_it_is_ready():
    live = LiveMap(Planned((9,)), map=blank())
    for scan in LOG[:10]:
        live.add(scan)
    wait([live._anew], 60)
    live.add(LOG[10])
    assert live._anew is None and state(live.map) == expected(LOG[:11], live.poses)


def test_what_the_map_held_before_stays():
    given = blank()
    given.insert_scan((0, 0), [(9.0, 9.0)])
    live = LiveMap(Planned((3,)), map=given)
    assert all(0 < live.add(scan).seconds < 60 for scan in LOG[:6])
    live.finish()
    assert live.poses[0].tolist() == [0, 0, 0]
    assert given.scans == 7 and given.occupancy([(9.0, 9.0)])[0] == 1


def test_a_scan_that_the_map_refuses_has_no_pose_in_it():
    """Catches poses and drawn scans that no longer belong together, and half a scan in the map."""
    far = LaserScan([500.0], [0.0])
    live = LiveMap(map=QuadtreeMap(resolution=0.05, max_size=25.6), start=(12, 12, 0))
    live.add(LOG[0])
    before = state(live.map)
    with pytest.raises(ValueError, match="beyond max_size"):
        live.add(far)
    live.finish()
    assert state(live.map) == before
    with pytest.raises(ValueError, match=r"^scan 0: the scan reaches beyond max_size"):
        list(map_scans([far], graph=True, map=live.map))
    live.add(LOG[1])
    live.finish()
    assert live.map.scans == len(live.poses) == 2 and len(live.graph) == 3
    apart = between(*live.graph.poses[[0, 2]])
    np.testing.assert_allclose(between(*live.poses), apart, atol=1e-12)


def test_a_laser_that_stands_fills_no_memory():
    """Catches a carried map that keeps each scan for ever: 300 MB in half an hour."""
    angles = np.linspace(-np.pi, np.pi, 450, endpoint=False)
    ranges = 2.0 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles) * 1.3))
    live, sizes = CarriedMap(), []
    for k in range(90):
        live.add(LaserScan(ranges, angles, 0.1 * k, delays=0.01 * (angles + np.pi)))
        sizes.append(len(pickle.dumps(live.graph)))
    assert len(live.graph) == 90 and len(live.poses) == 90
    assert sizes[89] - sizes[49] < 40 * 2000  # a scan as measured and as carried is 18 000
    assert len(live.graph.tracked(0).scan.points()) == 450  # a key frame
