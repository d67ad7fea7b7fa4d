"""Where each rule of a pose graph ends: a little less and a little more than what it allows.

The maps and matches here are scripted: they say what a test needs, and keep what was asked of them.
"""

from dataclasses import replace

import alignment_logs as logs
import numpy as np
import pytest
from alignment_logs import walked

from segmap.alignment import LiveGraph, Tracking, Unmatched
from segmap.alignment._result import Match, no_match
from segmap.alignment.graph import Edge, Solver, information, stacked
from segmap.alignment.pose_graph._front_end import FrontEnd
from segmap.alignment.pose_graph._loop_closing import LoopCloser, Window, descriptor
from segmap.alignment.pose_graph._merge import _append
from segmap.poses import between
from segmap.scans import LaserScan

ZERO, NOTHING = np.zeros(3), no_match(np.zeros(3), Unmatched.NO_PLACE)
SCAN, LOG = logs.office_log()[0], logs.loop_log(step=0.5)
ALONG_X = np.array([1.0, 0.0])


def place(x=0.0, y=0.0, degrees=0.0, overlap=0.9, *, matched=True, free=None) -> Match:
    pose = np.array([x, y, np.radians(degrees)])
    return Match(pose, np.eye(3), matched, "", overlap, free)


class Scripted:
    """A map that answers each search by the next start and score, and then by the match there."""

    def __init__(self, *answers, wall=False):
        self.answers, self.wall, self.asked = iter(answers), wall, []

    def search(self, points, about, **given):
        start, score, self.match = next(self.answers, (None, 0.0, NOTHING))
        self.asked.append({"points": len(points), "about": about, **given})
        return start, score

    def register(self, points, start, **given):
        self.asked.append(given)
        return self.match

    def unfixed(self, points, pose):
        """Along x, where no wall faces it."""
        return np.array([[1.0, 0.0, 0.0]])[int(self.wall) :]

    def nearest(self, points, pose, guess):
        loose = self.unfixed(points, pose)
        return pose + loose.T @ (loose @ (guess - pose))


def loop(first, second, x=None, degrees=0.0, *, along=0.01) -> Edge:
    x = second - first if x is None else x
    known = np.diag(np.array([along, 0.01, 0.01]) ** -2)
    return Edge(first, second, np.array([x, 0, np.radians(degrees)]), known, True)


# ------------------------------------------------------------------ the front end
def front(step=ZERO) -> FrontEnd:
    """A front end whose matcher finds nothing, of a robot that makes such steps."""
    found = FrontEnd(lambda map, points, guess: NOTHING, Tracking())
    found.add_frame(found.track(SCAN))
    found.step = lambda: step
    return found


@pytest.mark.parametrize(
    ("step", "lost", "reach"),
    [(0.5, 0, 1.5), (2.0, 0, 3.0), (2.0, 1, 6.0), (0.0, 1, 3.0), (0, 9, 6)],
)
def test_a_lost_robot_is_sought_farther_the_faster_and_the_longer_lost(step, lost, reach):
    one, map = front(np.array([0, step, 1.0])), Scripted()
    one.lost = lost
    one.rows[-1].pose = np.array([3.0, 4.0, 0.5])
    one.rows.append(one.rows[-1])
    assert one._regained(map, np.zeros((9, 2)), ZERO, NOTHING) is NOTHING
    np.testing.assert_allclose([asked["reach"] for asked in map.asked], [reach] * 4)
    quarters = np.pi / 2 * np.arange(4)[:, None] * (0, 0, 1)
    np.testing.assert_allclose([a["about"] for a in map.asked], (3, 4, 0.5) + quarters)
    assert {(asked["turn"], asked["least"]) for asked in map.asked} == {(np.pi / 4, 0.45)}


@pytest.mark.parametrize(
    ("best", "other", "before", "found"),
    [
        # it slides from where the search began
        *((place(0.29), None, NOTHING, True), (place(0.25, -0.25), None, NOTHING, False)),
        *((place(-0.31), None, NOTHING, False), (place(degrees=-11), None, NOTHING, True)),
        *((place(degrees=-12), None, NOTHING, False), (place(matched=False), None, NOTHING, False)),
        # another place is as likely, unless it is the same one
        *((place(), (0.85, place(9)), NOTHING, True), (place(), (0.86, place(9)), NOTHING, False)),
        *((place(), (0.86, place(x, y, degrees)), NOTHING, found) for x, y, degrees, found in (
            (0, 0.49, 0, True), (0.36, 0.36, 0, False), (0, 0, -14, True), (0, 0, -16, False))),
        # it must hold more of the scan than what matched before
        *((place(), None, place(overlap=0.79), True), (place(), None, place(overlap=0.81), False)),
        # along a corridor
        *((place(free=ALONG_X), None, NOTHING, True), (place(free=ALONG_X), None, place(), False)),
    ],
)  # fmt: skip
def test_what_is_believed_of_a_lost_robot(best, other, before, found):
    """The other one comes first: of two places it is the likelier one that counts."""
    at = lambda match: np.array([*match.pose[:2].round(), 0.0])  # noqa: E731
    answers = [(at(best), 0.9, best)]
    if other is not None:
        answers.insert(0, (other[1].pose, *other))
    one, map = front(), Scripted(*answers)
    one.rows.append(one.rows[-1])
    chosen = one._regained(map, np.zeros((9, 2)), ZERO, before)
    assert (chosen is not before) == found
    if found:
        np.testing.assert_allclose(chosen.pose, best.pose)


@pytest.mark.parametrize(("degrees", "found"), [(59, True), (-59, True), (61, False), (-61, False)])
def test_along_a_corridor_no_large_turn_is_believed_and_the_guess_says_how_far(degrees, found):
    best = place(1.0, 0.2, degrees, free=ALONG_X)
    one = front()
    one.rows.append(one.rows[-1])
    chosen = one._regained(
        Scripted((best.pose, 0.9, best)), np.zeros((9, 2)), np.array([0.4, 0.7, 0]), NOTHING
    )
    expected = (0.4, 0.2, np.radians(degrees)) if found else ZERO
    np.testing.assert_allclose(chosen.pose, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("offset", "lost", "points", "local", "needed"),
    [
        *(((0.5, 0, 0), 0, 9, True, False), ((0.3, -0.41, 0), 0, 9, True, True)),
        *(((0, 0, -0.5), 0, 9, True, False), ((0, 0, -0.55), 0, 9, True, True)),
        *((ZERO, 2, 6, True, True), (ZERO, 2, 5, True, False), (ZERO, 1, 9, True, False)),
        *((ZERO, 0, 1, False, True), (ZERO, 0, 0, False, False)),
    ],
)
def test_a_key_frame_is_set_where_the_robot_has_moved_or_sees_again(
    offset, lost, points, local, needed
):
    one = front()
    one.rows[-1].pose, one.lost, one.points = np.array(offset), lost, np.zeros((points, 2))
    one.local = one.local if local else None
    assert one.needs_frame(0.5, np.radians(30)) == needed


@pytest.mark.parametrize(
    ("lost", "deviations"), [(1, (0.5, 0.5, np.radians(20))), (2, (1.5, 1.5, np.radians(60)))]
)
def test_a_step_without_a_match_ties_little_and_behind_a_break_next_to_nothing(lost, deviations):
    one = front()
    one.track(SCAN)
    one.lost = lost
    one.add_frame(NOTHING)
    expected = information(np.diag(deviations) ** 2, one.frames.least)
    np.testing.assert_allclose(one.frames.edges[0].information, expected)
    assert one.begins == (1 if lost == 2 else 0)
    assert one.lost == (0 if lost == 2 else 1)
    assert [row.tied for row in one.frames.rows] == [True, False]


def test_another_session_begins_at_a_key_frame_that_next_to_nothing_ties():
    """Catches the second odometry taken for the way between them, and rows of the first one."""
    one, two = LiveGraph(), LiveGraph()
    one.extend(LOG[:4])
    two.extend(LOG[100:103])
    _append(one, two)
    frames, rows = one.front_end.frames, one.front_end.rows
    begin = next(k for k, row in enumerate(frames.rows) if row.scan == 4)
    own = two.front_end
    assert [row.tied for row in frames.rows[begin:]] == [False, *[True] * (len(own.frames) - 1)]
    assert [row.scan - 4 for row in frames.rows[begin:]] == [row.scan for row in own.frames.rows]
    assert [row.frame - begin for row in rows[4:]] == [row.frame for row in own.rows]
    expected = information(np.diag([1.5, 1.5, np.radians(60)]) ** 2, frames.least)
    edge = next(edge for edge in frames.edges if edge.second == begin)
    np.testing.assert_allclose(edge.information, expected)
    assert not one.front_end.measured(4) and rows[4].scan.odometry is None
    its, there = two.poses, one.poses[4:]
    np.testing.assert_allclose(between(there[0], there), between(its[0], its), atol=1e-9)
    np.testing.assert_allclose(there[0], one.poses[3], atol=1e-9)


@pytest.mark.parametrize(
    ("spacing", "around"), [(0.25, 15), (0.5, 15), (1.0, 9), (1.01, 7), (5, 1)]
)
def test_at_last_scans_lie_on_the_nearest_key_frames_within_four_metres(spacing, around):
    asked, one = [], front()
    for k in range(40):
        one.frames.add(2 * k + 2, np.zeros((6, 2)), np.array([spacing, 0, 0]), np.eye(3))
        one.rows += [replace(one.rows[0], frame=k), replace(one.rows[0], frame=k + 1)]
    one.frames.map_of = lambda members, origin: asked.append((origin, sorted(members)))
    one.register_again()
    members = dict(asked)[20]
    half = around // 2
    assert members == list(range(20 - half, 20 + half + 1)) and len(asked) == 40


def test_the_local_map_is_of_the_last_ten_key_frames_behind_a_break():
    one, asked = front(), []
    for _ in range(14):
        one.frames.add(0, np.zeros((6, 2)), ZERO, np.eye(3))
    one.frames.map_of = lambda members, origin: asked.append((list(members), origin))
    for begins in (0, 6, 7, 9):
        one.begins = begins
        one.add_frame(place())
    assert [members[0] for members, _ in asked] == [6, 7, 8, 9]
    assert [members[-1] for members, _ in asked] == [15, 16, 17, 18]
    assert all(members[-1] == origin for members, origin in asked)


def test_one_scan_is_solved_and_used():
    graph = LiveGraph()
    assert graph.reasons == ()
    graph.add(SCAN)
    assert graph.refine().doubt == "" and graph.reasons == ("",)


# ------------------------------------------------------------------ a scan on the local map
@pytest.mark.parametrize(
    ("near", "far", "taken"),
    [
        *((0.71, 0.9, "near"), (0.7, 0.79, "near"), (0.7, 0.81, "far"), (0.1, 0.59, "near")),
        *((0.1, 0.61, "far"), (0, 0.59, ""), (0, 0.61, "far"), (-0.8, 0.85, ""), (0, 0, "")),
    ],
)
def test_in_twice_the_window_a_place_must_hold_more(near, far, taken):
    """Overlaps; where nothing matched, 0 or negative."""
    asked, both = [], [place(overlap=abs(x), matched=x > 0) for x in (near, far)]

    class Graph(LiveGraph):
        def _search(self, map, points, guess, reach, turn):
            asked.append((reach, turn))
            return both[len(asked) - 1]

    graph = Graph()
    graph.add(logs.without_odometry(LOG[:1])[0])
    found = graph._match_on_map(None, None, ZERO)
    windows = np.outer((1, 2), (0.5, np.radians(40)))
    np.testing.assert_allclose(asked, windows if near < 0.705 else windows[:1])
    assert found is both[taken == "far"] if taken else not found.matched


@pytest.mark.parametrize(("wall", "x"), [(True, 0.1), (False, 0.3)])
def test_along_what_no_wall_faces_the_guess_counts(wall, x):
    map = Scripted((ZERO, 0.9, place(0.1, free=ALONG_X)), wall=wall)
    graph = LiveGraph()
    graph.add(logs.without_odometry(LOG[:1])[0])
    found = graph._match_on_map(map, np.zeros((9, 2)), np.array([0.3, 0.2, 0.1]))
    np.testing.assert_allclose(found.pose, (x, 0, 0), atol=1e-12)
    assert map.asked[-1] == {"overlap": 0.4}


@pytest.mark.parametrize(
    ("x", "degrees", "matched"), [(0.29, 11, True), (0.31, 0, False), (0, -12, False)]
)
def test_a_match_that_slides_from_where_the_search_began_is_none(x, degrees, matched):
    map = Scripted((ZERO, 0.9, place(0, x, degrees)))
    assert LiveGraph()._search(map, np.zeros((9, 2)), ZERO, 0.5, 0.5).matched == matched


# ------------------------------------------------------------------ key frames and parts
def test_lazily_only_what_is_new_is_solved_and_else_everything():
    rng, frames, solver = np.random.default_rng(1), walked(60).frames, Solver()
    frames.edges += [loop(k, 30 + k, 30 + rng.normal(0, 0.3)) for k in range(29)]
    poses, lazy = frames.poses, []
    solver.add(stacked(frames.edges))
    for lazily in (True, False):
        poses, *_ = solver.solve(poses, lazily=lazily)
        frames.optimize(**({"lazily": True} if lazily else {}))
        np.testing.assert_array_equal(frames.poses, poses)
        lazy.append(poses)
    assert not np.array_equal(*lazy)


# ------------------------------------------------------------------ loops
def test_a_descriptor_says_how_many_points_lie_in_each_ring():
    """Sixteen rings of half a metre; what lies farther off is not counted."""
    points = np.array([(0.4, 0.0), (0.0, -0.6), (0.5, 0.5), (-7.9, 0.0), (6.0, 6.0), (9.0, 0.0)])
    found = descriptor(points)
    assert found.tolist() == [0.25, 0.5, *[0.0] * 13, 0.25]
    assert descriptor(points[-1:]).tolist() == descriptor(points[:0]).tolist() == [0.0] * 16


def test_a_place_is_described_by_what_four_key_frames_see():
    closer = walked(12, np.zeros((1, 2)))
    closer.descriptors = [descriptor(np.zeros((1, 2)))] * 12
    assert not closer.close(confirmed=True, measured=True)
    assert np.flatnonzero(closer.descriptors[-1]).tolist() == [0, 2, 4, 6]


@pytest.mark.parametrize(
    ("since", "count"), [(None, 0), (26, 0), (25, 0), (24, 0), (45, 3), (44, 0)]
)
def test_a_lost_robot_is_sought_anywhere_for_fifteen_metres(since, count):
    """On the places that look most alike, of those before it was lost and before the joint."""
    closer = walked(60)
    alike = {3: 0.1, 10: 0.0, 21: 0.2, 30: 0.3, 40: 0.0, 50: 0.0}
    closer.descriptors = [np.array([alike.get(k, 1.0)]) for k in range(60)] + [np.zeros(1)]
    closer.lost_since = since
    windows = closer._by_descriptor(60, 40)
    assert len(windows) == (count and 1)
    for window in windows:  # without a gap all are one pass
        assert (window.old, window.reach, window.turn) == (10, 2.0, np.pi)
        assert not window.guess.any()


@pytest.mark.parametrize(("x", "found"), [(-3.59, True), (-3.61, False)])
def test_old_places_are_proposed_two_metres_beside_the_window(x, found):
    """Sixty centimetres for the way of twenty metres."""
    closer = walked(20)
    closer.frames.poses[20] = x, 0, 0
    assert [window.old for window in closer._by_place(20, 20)] == [0] * found


@pytest.mark.parametrize(
    ("overlap", "matched", "reason"),
    [
        *((0.6, True, ""), (0.59, True, "too little of the new place is in the old one")),
        (0.6, False, "it has no partner"),
    ],
)
def test_how_a_loop_is_measured(overlap, matched, reason):
    closer = walked(30, np.ones((9, 2)))
    match = place(0.5, overlap=overlap, matched=matched)
    map = Scripted(
        (ZERO, 0.9, match if matched else no_match(ZERO, Unmatched.NO_PLACE, reason, overlap))
    )
    window = Window(3, np.array([1.0, 2, 3]), 1.5, 0.3)
    found = closer.measure(window, map, 30)
    search, *rest = map.asked
    assert (search["reach"], search["turn"], search["least"]) == (1.5, 0.3, 0.55)
    assert search["about"] is window.guess and {given["reach"] for given in rest} == {0.2}
    assert (found.matched, found.reason) == (not reason, reason)
    assert reason or found is match


@pytest.mark.parametrize(
    ("new", "each", "asked"),
    [(4, 1, None), (2, 2, 6), (4, 187, 748), (4, 188, 376), (4, 375, 500)],
)
def test_of_a_dense_place_some_points_are_searched_for(new, each, asked):
    """Four key frames see it; below six points it says nothing, above 750 only some are laid."""
    map = Scripted()
    found = walked(4, np.ones((each, 2))).measure(Window(0, ZERO, 1.0, 0.3), map, new)
    assert [given["points"] for given in map.asked] == ([] if asked is None else [asked])
    assert found.reason == ("too few points" if asked is None else "the two places look different")


def test_maps_of_old_places_are_of_five_key_frames_before_and_after_and_some_are_kept():
    closer = walked(0, np.zeros((1, 2)))
    for scan in range(1, 61):
        closer.frames.add(scan, np.zeros((1, 2)), np.array([0.1, 0, 0]), np.eye(3))
    for old in range(55):
        closer.map_around(Window(old, ZERO, 2.5, 0.3))
    assert list(closer.maps) == [(old, max(old - 5, 0), old + 6) for old in range(15, 55)]


@pytest.mark.parametrize(
    ("other", "agrees"),
    [
        *((loop(4, 34, 30.24), True), (loop(4, 34, 30.25), False), (loop(4, 34, 29.74), False)),
        *((loop(4, 34, 30, 3.9), True), (loop(4, 34, 30, -4.1), False)),
        *((loop(9, 38), True), (loop(10, 38), False), (loop(8, 39), False)),
    ],
)
def test_loops_agree_within_a_quarter_of_a_metre_four_degrees_and_eight_metres(other, agrees):
    assert bool(walked(40).agreeing(loop(1, 30), [other])) == agrees


@pytest.mark.parametrize(("others", "believed"), [(4, 0), (5, 6)])
def test_where_the_robot_was_lost_five_others_must_agree(others, believed):
    closer = walked(40)
    closer.lost_since = 29
    closer.pending = [loop(k, 30 + k) for k in range(others + 1)]
    assert len(closer._confirmed_by_others([(closer.pending[-1], 2.0)])) == believed


@pytest.mark.parametrize(
    ("motion", "closes"),
    [
        *(((20.04, 0, 0), False), ((20.06, 0, 0), True), ((20.04, 0.04, 0), True)),
        *(((20, 0, 0.0085), False), ((20, 0, -0.009), True), ((20, 0, 0.009), True)),
    ],
)
def test_the_graph_is_solved_at_once_where_a_loop_strains_it(motion, closes):
    """And what no other has confirmed for eight metres is given up."""
    match = Match(np.array(motion), 0.1 * np.eye(3), True)

    class Closer(LoopCloser):
        def _by_place(self, new, before):
            return [Window(0, ZERO, 1.0, 0.3), Window(1, ZERO, 1.0, 0.3)]

        def measure(self, window, map, new):
            return match if window.old == 0 else NOTHING

        def _confirmed_by_others(self, fresh):
            ((found, reach),) = fresh
            assert found[:2] == (0, 20) and found.loop and found.relative is match.pose
            known = information(match.covariance, self.frames.least)
            assert reach == 1.0 and (found.information == known).all()
            return [found]

    closer = walked(20, closer=Closer)
    closer.pending = [loop(2, 11), loop(3, 12)]
    assert closer.seek(20, 20, confirmed=True, measured=True) == closes
    assert [edge[:2] for edge in closer.pending] == [(3, 12)] and len(closer.accepted) == 1
    assert [gone[:2] for gone in closer.rejected] == [(1, 20), (2, 11)]
    assert closer.lost_since is None


@pytest.mark.parametrize("free", [np.array([1.0, 0.0]), None])
def test_a_scan_that_its_match_leaves_free_is_as_vague_as_the_match(free):
    """Catches scans that stand for the laser in a corridor, 50 in a row, sure to the centimetre."""
    match = Match(ZERO, np.diag([0.9, 0.02, 0.01]) ** 2, True, "", 1.0, free)
    scan = LaserScan(np.full(40, 2.0), np.linspace(-1, 1, 40))
    found = FrontEnd(lambda map, points, guess: match, Tracking())
    found.add_frame(found.track(scan))
    for _ in range(3):
        found.track(scan)
    spread = found.outcome().spread
    assert spread[0] < 0.1 and (spread[1:] > 0.85).all() == (free is not None)


@pytest.mark.parametrize(
    ("slides", "measured", "believed"), [(0, False, 3), (1, False, 0), (2, False, 0), (2, True, 3)]
)
def test_loops_that_may_slide_confirm_none_without_odometry(slides, measured, believed):
    """Catches loops along a corridor that agree, and are as wrong as the way between them."""
    closer = walked(40)
    closer.measured = measured
    closer.pending = [loop(k, 30 + k, along=0.21 if k < slides else 0.19) for k in (0, 1, 2)]
    found = closer._confirmed_by_others([(closer.pending[-1], 2.0)])
    assert len(found) == believed
    closer.pending = [loop(k, 30 + k, along=0.21) for k in range(9)]
    assert closer.finish_pending() == measured and len(closer.rejected) == 9 * (not measured)


@pytest.mark.parametrize(("deviation", "counts"), [(0.19, True), (0.21, False)])
def test_a_loop_that_is_vague_shortens_no_way(deviation, counts):
    closer = walked(30)
    weight = np.linalg.inv(np.diag([1e-4, deviation**2, 1e-4]))
    closer.believe([Edge(5, 25, ZERO, weight, True)])
    assert closer.ways.tolist() == [[5, 25]] * counts and len(closer.frames.edges) == 31
