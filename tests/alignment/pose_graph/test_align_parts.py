"""Parts of a log, aligned apart and joined: as the whole log, on any executor."""

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import alignment_logs as logs
import numpy as np
import pytest
from conftest import dask, slow

from segmap.alignment import LoopClosing, align_parts, pose_graph
from segmap.alignment.graph import Edge, Rejected
from segmap.alignment.pose_graph._key_frames import KeyFrames
from segmap.alignment.pose_graph._loop_closing import LoopCloser
from segmap.alignment.pose_graph._parts import (
    SharedKeyFrame,
    _append_loops,
    _append_part,
    _part_graph,
    front_end_and_closer,
)
from segmap.testing import assert_poses_equal

LOG = logs.loop_log(step=0.5)
POINTS, START = np.array([(1.0, 0.0)]), np.zeros(3)


def cut(log, *at):
    return [log[a:b] for a, b in zip((0, *at), (*at, len(log)), strict=True)]


@pytest.fixture(scope="module")
def joined():
    told = []
    found = align_parts(cut(LOG, 90), progress=lambda share, words: told.append((share, words)))
    assert all(0 <= share <= 1 for share, _ in told)
    between_parts = [share for share, words in told if words == "looking for loops between parts"]
    assert len(set(between_parts)) > 9 and between_parts == sorted(between_parts)
    assert "solving for all poses" in [words for _, words in told]
    return found


def test_parts_are_joined_by_the_loops_between_them(joined):
    """Wheels alone end metres away; no part closes a loop of its own."""
    whole = pose_graph(LOG)
    assert joined.used.all() and len(joined) == len(LOG) and 0 < joined.seconds < 600
    assert np.hypot(*(joined.poses - whole.poses)[:, :2].T).max() < 0.1
    loops = joined.graph.edges[joined.graph.loop]
    assert len(loops) and (loops[:, 0] < 90).all() and (loops[:, 1] > 90).all()
    steps = joined.graph.edges[~joined.graph.loop]
    assert (steps[1:, 0] == steps[:-1, 1]).all()
    assert logs.errors(LOG, joined.poses)[0].max() < 0.2


def test_a_part_that_comes_back_is_solved_and_light():
    """Catches windows about places that its own loops would move, and maps that travel."""
    front, closer = front_end_and_closer(_part_graph({"closing": LoopClosing(strain=9.0)}, LOG))
    known = front.frames.poses
    front.frames.optimize()
    assert closer.accepted and np.array_equal(front.frames.poses[0], known[0])
    assert_poses_equal(front.frames.poses, known, atol=1e-5)
    assert (front.scans, front.local, closer.maps) == ([], None, {})


def test_what_a_part_knows_of_loops_is_kept_behind_the_joint():
    """Its key frame 10, of scan 20, is key frame 50 of scan 100."""
    closer, part = (LoopCloser(KeyFrames(POINTS, START), 0.03, LoopClosing()) for _ in range(2))
    loops = [Edge(k, k + 30, START, np.eye(3), True) for k in (9, 10, 12)]
    joint = SharedKeyFrame(50, 100, 10, 20)
    part.rejected = [Rejected(19, 90, "before"), Rejected(20, 91, "why")]
    part.ways = np.array([(9, 39), (10, 40)])
    closer.frames.edges = joint.moved(loops)
    _append_loops(closer, part, joint)
    assert [edge[:2] for edge in closer.frames.edges] == [(50, 80), (52, 82)]
    assert [edge[:2] for edge in closer.accepted] == [(50, 80), (52, 82)]
    assert closer.rejected == [(100, 171, "why")] and closer.ways.tolist() == [[50, 80]]


def test_key_frames_behind_the_joint_are_as_if_added_one_by_one():
    motions = np.array([(1, 0, 0.1), (0.5, 0.2, -0.3), (2, 0, 0), (1, 1, 1)])

    def driven(start, scans, first, end):
        frames = KeyFrames(POINTS, np.array(start, float))
        for k in range(first, end):
            frames.add(scans * (k - first + 1), POINTS, motions[k], np.eye(3))
        return frames

    whole, one, later = (
        driven(s, 2, *ends)
        for s, ends in (((0, 0, 0), (0, 4)), ((0, 0, 0), (0, 2)), ((7, 3, 2), (1, 4)))
    )
    one.extend(later, 1, whole.edges[2:])
    for name in ("poses", "distance", "scan"):
        np.testing.assert_allclose(getattr(one, name), getattr(whole, name), err_msg=name)
    assert len(one) == len(one.points) == len(whole) and len(one.edges) == len(whole.edges)
    one.add(10, POINTS, motions[0], np.eye(3))
    assert one.distance[-1] == whole.distance[-1] + 1 and len(one.poses) == 6


def test_behind_the_joint_a_robot_may_be_lost_and_loops_may_wait(monkeypatch):
    """Scans that show another place cannot be matched: from them on the robot is sought anywhere.

    Loops between the parts lead to key frames before the joint, and those that wait when the log
    ends are settled.
    """
    asked, settled, since = [], [], {}

    def seek(self, new, before, *, confirmed, measured):
        asked.append((new, before, confirmed))
        since[new] = self.lost_since
        self.lost_since = self.lost_since if confirmed else new
        return False

    def finish_pending(self):
        settled.extend(edge[:2] for edge in self.pending)
        return False

    monkeypatch.setattr(LoopCloser, "seek", seek)
    monkeypatch.setattr(LoopCloser, "finish_pending", finish_pending)
    odd = 36, 45, 46
    near = logs.changed(LOG[:50], lambda k, ranges: 0 * ranges + 0.5 if k in odd else ranges)
    first, second = (_part_graph({}, part) for part in cut(near, 20))
    front_end_and_closer(second)[1].pending = [Edge(12, 14, START, np.eye(3), True)]
    front_end_and_closer(second)[1].rejected = [Rejected(20, 25, "why")]
    frames = front_end_and_closer(second)[0].frames
    frames.edges.append(Edge(11, len(frames) - 1, START, np.eye(3), True))
    front, later = (front_end_and_closer(graph)[0] for graph in (first, second))
    front.scans += near[:20]
    front.free_along_corridor[3] = later.free_along_corridor[36 - 20] = True
    later.lost, later.tied[-2] = 2, False
    later.begins.append(len(frames) - 3)
    asked.clear()
    _append_part(first, second, near[20:])
    joint = asked[-1][1]
    alone = [call for call in asked if call[1] == joint]
    assert [new for new, *_ in alone] == list(range(joint, alone[-1][0] + 1))
    assert np.flatnonzero(front.free_along_corridor).tolist() == [3, 36]
    last = len(front.frames) - 1
    assert [k for k, tied in enumerate(front.tied) if not tied] == [joint + 1, last - 1]
    assert (front.lost, front.begins) == (2, [0, last - 2])
    lost = {47}  # in 36 the robot only does not know how far it has come
    assert [front.frames.scan[new] in lost for new, *_ in alone] == [
        not confirmed for *_, confirmed in alone
    ]
    (gone,) = (new for new, *_ in alone if front.frames.scan[new] in lost)
    assert {since[new] for new, *_ in alone if new > gone} == {gone}
    assert front_end_and_closer(first)[1].lost_since is None, (
        "the loop at the end of the part found it again"
    )
    assert (40, 45, "why") in front_end_and_closer(first)[1].rejected
    first.refine()
    assert settled == [(joint + 2, joint + 4)]


def test_one_part_is_the_whole_log():
    log = LOG[:40]
    found, whole = align_parts([log[:0], log, log[:0]]), pose_graph(log)
    np.testing.assert_allclose(found.poses, whole.poses, atol=1e-9)
    assert found.reasons == whole.reasons
    assert len(align_parts([])) == len(align_parts([log[:0]])) == 0


def test_parts_of_one_scan_and_of_a_few():
    """Catches a joint that lies before or behind the key frames that a short part has."""
    log = LOG[:10]
    found, whole = align_parts(cut(log, 4, 5)), pose_graph(log)
    assert_poses_equal(found.poses, whole.poses, atol=0.02)
    first, second = found.graph.edges[~found.graph.loop].T
    assert (first[1:] == second[:-1]).all() and (first < second).all()


@pytest.mark.parametrize("kind", ["threads", slow("processes"), slow("dask")])
def test_every_executor_gives_the_same(kind, joined, tmp_path):
    """Catches parts in the order of finishing, and what cannot travel to a worker."""
    if kind == "dask":
        pool = dask(tmp_path)
    elif kind == "processes":
        pool = ProcessPoolExecutor(2, mp_context=get_context("spawn"))
    else:
        pool = ThreadPoolExecutor(2)
    with pool as executor:
        found = align_parts(cut(LOG, 90), executor=executor)
    np.testing.assert_array_equal(found.poses, joined.poses)
    assert found.graph.rejected == joined.graph.rejected
    np.testing.assert_array_equal(found.graph.edges, joined.graph.edges)
