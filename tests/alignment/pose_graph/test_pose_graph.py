"""The pose graph on simulated buildings and on logs that go wrong."""

from dataclasses import replace
from functools import cache

import alignment_logs as logs
import numpy as np
import pytest
from scipy.sparse.csgraph import csgraph_from_dense, dijkstra

from segmap import load
from segmap.alignment import Alignment, LiveGraph, LoopClosing, Tracking, pose_graph
from segmap.alignment._result import Match
from segmap.alignment.graph import REAL, Edge, information
from segmap.alignment.points import PointMap
from segmap.alignment.pose_graph import FrontEnd, _loop_closing
from segmap.alignment.pose_graph._key_frames import KeyFrame, KeyFrames, path_lengths
from segmap.alignment.pose_graph._loop_closing import LoopCloser, Window
from segmap.alignment.pose_graph._places import best_of_passes
from segmap.poses import between
from segmap.scans import LaserScan, Log
from segmap.simulation import SICK_LMS200, drive, office, simulate


def walked(
    steps: int,
    points: np.ndarray = np.zeros((0, 2)),
    closer: type[LoopCloser] = LoopCloser,
    along: float | None = None,
) -> LoopCloser:
    """Key frames a metre apart on a line, and what closes loops among them.

    By odometry; or without it, each step known to 1 cm across the line and to `along` along it.
    """
    frames = KeyFrames()
    for scan in range(steps + 1):
        known = np.diag([along or 1.0, 0.01, 0.01]) ** 2
        row = KeyFrame(scan, points, measured=along is None)
        frames.add(row, np.array([float(scan > 0), 0, 0]), known)
    return closer(frames, 0.03, LoopClosing())


@cache
def loop(change: str = "") -> tuple[Log, Alignment]:
    log = CHANGES[change](logs.loop_log())
    return log, pose_graph(log)


CHANGES = {
    "": lambda log: log,
    "no odometry": logs.without_odometry,
    "blind": lambda log: logs.blind(log, *range(100, 104)),
}


# ------------------------------------------------------------------ a building with a loop
def test_a_loop_is_closed():
    """76 m on wheels that end 4.1 m off: a chain of matches alone is 14 cm off (point ICP)."""
    log, found = loop()
    assert logs.errors(log, log.odometry)[0].max() > 4
    far, turned = logs.errors(log, found.poses)
    assert far.max() < 0.06
    assert turned.max() < np.radians(0.4)
    assert found.used.all() and found.doubt == ""
    assert found.graph.loop.sum() >= 3
    assert found.graph.rejected
    for first, second, reason in found.graph.rejected:
        assert 0 <= first < second < len(found) and reason


# ------------------------------------------------------------------ kidnapped
OFFICES = office(rng=np.random.default_rng(3), rooms=4)


def office_drive(corners: list, seed: int) -> Log:
    path = drive(corners, step=0.25, turn=np.radians(15))
    rng = np.random.default_rng(seed)
    return simulate(OFFICES, path, sensor=SICK_LMS200, rng=rng, odometry_noise=logs.BAD_WHEELS)


@cache
def tour() -> Log:
    """Into each of eight offices, and half of the way back."""
    path = [(1, 5)]
    for x in (2, 6, 10, 14):
        path += [(x, 5), (x, 7.5), (x, 5), (x, 2.5), (x, 5)]
    return office_drive([*path, (15, 5), (8, 5)], 1)


@pytest.mark.parametrize(("onwards", "regained"), [([(2, 7.5), (2, 2.5), (2, 5), (9, 5)], True)])
def test_a_kidnapped_robot(onwards, regained):
    """Carried from the corridor into an office while the wheels say that it went straight on.

    The first scan there is not used and says why, and what was mapped before stays right. Where
    the robot then comes through places that look like no other, it finds itself again; an office
    and a corridor that look alike when turned may hold it in the wrong place: no promise there.
    """
    log = logs.joined(tour(), office_drive(onwards, 101))
    found, cut = pose_graph(log), len(tour())
    assert np.isfinite(found.poses).all()
    assert not found.used[cut]
    assert found.reasons[cut] == "too little of it lies on the map"
    assert found.used[:cut].all()
    far, turned = logs.errors(log, found.poses)
    assert far[:cut].max() < 0.10
    if regained:
        assert far[cut:][found.used[cut:]].max() < 0.15
        assert turned[cut:][found.used[cut:]].max() < np.radians(1)


@pytest.mark.parametrize(
    ("heading", "turned", "less", "kept"),
    [
        *((0.5, 0.08, 0.0, True), (0.5, 0.4, 0.16, False), (0.5, 0.4, 0.18, True)),
        *((-0.5, -0.4, 0.16, False), (-0.5, -0.4, 0.18, True)),
        *((0.0, 0.4, 0.04, False), (0.0, 0.4, 0.06, True)),  # it has seen nothing new
        *((3.12, 0.4, 0.16, False), (-3.12, -0.4, 0.16, False)),  # across the seam
        *((3.12, 0.08, 0.05, True), (0.5, -0.08, 0.0, True)),
    ],
)
def test_what_agrees_with_the_odometry_may_fit_less_well(heading, turned, less, kept):
    """By a share of 0.05, and one for half a round of new sight: (0.4 - 0.03) / pi = 0.118."""

    def match(turn, overlap, matched=True):
        pose = np.array([0, 0, (heading + turn + np.pi) % (2 * np.pi) - np.pi])
        return Match(pose, np.eye(3), matched, "", overlap)

    def search(map, points, guess, reach, turn, least):
        assert (reach, turn, least) == (0.5, pytest.approx(np.radians(5)), 0.0)
        return others[-1], 1.0

    graph, guess, best = LiveGraph(), np.array([0, 0, heading]), match(turned, 0.9)
    graph.front_end.search = search
    others = [match(0.03 * np.sign(turned), 0.9 - less)]
    assert (graph._prefer_odometry(None, None, guess, best) is best) == kept
    for other in (match(0.0, 0.9, matched=False), match(0.1, 0.9), match(-0.1, 0.9)):
        others.append(other)
        assert graph._prefer_odometry(None, None, guess, best) is best


# ------------------------------------------------------------------ nothing to go by
@pytest.mark.parametrize(
    ("rule", "reason"),
    [
        ({"witnesses": 1000, "LAST_WITNESSES": 1000}, "no other loop agrees with it"),
        ({"tolerance": 1e-6}, ""),
        ({"COMPARED_PATH_M": 1e-6}, "no other loop agrees with it"),
        ({"likelihood": 1.0}, "the two places look different"),
        ({"overlap": 1.01}, "too little of the new place is in the old one"),
        ({"CONTRADICTED": 1e-6}, "the rest of the graph contradicts it"),
        ({"min_path": 1000.0}, ""),
    ],
)
def test_the_rules_of_loop_closing_count(rule, reason, monkeypatch):
    """A threshold that is not looked at: each of these leaves no loop."""
    for name in filter(str.isupper, rule):
        monkeypatch.setattr(_loop_closing, name, rule[name])
    given = {name: value for name, value in rule.items() if name.islower()}
    graph = pose_graph(load("corridor"), closing=LoopClosing(**given)).graph
    assert not graph.loop.any()
    assert reason in {r.reason for r in graph.rejected} | {""}


def test_loops_that_wait_when_the_log_ends_are_believed_or_rejected(monkeypatch):
    """A return in the last metres: without settling it was dropped without a word."""
    log = load("corridor")[:148]
    found = pose_graph(log).graph
    assert found.loop.sum() == 2
    monkeypatch.setattr(_loop_closing, "LAST_WITNESSES", 1000)
    kept = pose_graph(log).graph
    alone = {(r.first, r.second) for r in kept.rejected if "agrees" in r.reason}
    assert alone == set(map(tuple, found.edges[found.loop]))


def test_believed_loops_shorten_the_way_to_old_places():
    """Three times round ten metres: what a loop has fixed is half a metre away, not ten."""
    frames = KeyFrames()
    for scan in range(31):
        step = (1.0, 0, np.pi / 5) if scan else (0, 0, 0)
        frames.add(KeyFrame(scan, np.zeros((0, 2))), np.array(step), np.eye(3))
    closer = LoopCloser(frames, 0.03, LoopClosing())
    assert closer._path_m(30, np.arange(30)).tolist() == list(range(30, 0, -1))
    assert np.isinf(walked(500)._path_m(500, np.array([100]))[0])  # 367 m fill the widest window
    # 0.3 m across where the heading is not known, and exact where it is
    lever = np.array([(1e-4, 0, 0), (0, 0.09, 0.03), (0, 0.03, 0.01001)])
    sure, vague = information(np.eye(3) * 1e-4), np.linalg.inv(lever)
    closer.believe([Edge(3, 23, np.zeros(3), sure, True), Edge(9, 29, np.zeros(3), vague, True)])
    assert closer._path_m(30, np.array([3, 5, 9, 22])).tolist() == [7.5, 9.5, 13.5, 8.0]
    (window,) = closer._by_place(30, 30)
    assert (
        window.reach
        == 1 + 0.03 * closer._path_m(30, np.array([window.old]))[0]
        < 1 + 0.03 * (30 - window.old)
    )


@pytest.mark.parametrize("seed", range(8))
def test_ways_are_the_shortest_along_the_path_and_through_loops(seed):
    """Steps of no length, loops that come twice, or between neighbours: these are no ways.

    One pair of places can be proposed twice: by place, and by what it looks like.
    """
    rng = np.random.default_rng(seed)
    along = np.r_[0, np.cumsum(rng.choice([0, 0.25, 0.5, 1, 2], 29))]
    loops = rng.integers(0, 30, (rng.integers(0, 7), 2))
    loops = np.concatenate([loops, loops[1:3], [(4, 5), (20, 19)]])
    link, k = np.full((30, 30), np.inf), np.arange(29)
    link[k, k + 1] = np.diff(along)
    for i, j in loops[np.abs(loops[:, 0] - loops[:, 1]) > 1]:
        link[min(i, j), max(i, j)] = 0.5
    begin, most, wanted = rng.integers(30), rng.choice([3, 9, 99]), rng.permutation(30)[:9]
    far = dijkstra(csgraph_from_dense(link, null_value=np.inf), directed=False, indices=begin)
    metres = np.full(30, np.inf)
    path_lengths(along, loops, begin, wanted, most, metres)
    assert metres[wanted].tolist() == np.where(far <= most, far, np.inf)[wanted].tolist()


@pytest.mark.parametrize(("steps", "believed"), [(2, 0), (4, 0), (6, 3)])
def test_loops_side_by_side_are_no_witnesses(steps, believed):
    """One door looks like the next: in a wide window they must lie along six metres."""
    closer = walked(40)
    sure = information(np.eye(3) * 1e-4)
    for k in (0, steps // 2, steps):
        closer.pending.append(Edge(k, 20 + k, np.zeros(3), sure, True))
    for reach in (6.0, 12.0):
        assert len(closer._confirm_by_others([(closer.pending[-1], reach)])) == believed
    assert len(closer._confirm_by_others([(closer.pending[-1], 1.0)])) == 3
    *older, newest = closer.pending
    elsewhere = [Edge(20, 21, np.zeros(3), sure, True)] * 29
    for accepted, found in (([*older, *elsewhere[1:]], [newest]), ([*older, *elsewhere], [])):
        closer.pending, closer.accepted = [newest], accepted  # only the last thirty are asked
        assert closer._confirm_by_others([(newest, 1.0)]) == found


@pytest.mark.parametrize(
    ("first", "motion", "believed"),
    [
        *((2, (28.0, 0, 0), 2), (14, (16.0, 0, 0), 2), (14, (16.3, 0, 0), 0), (24, (6.0, 0, 0), 0)),
        *((14, (16.0, 0, turn), 0) for turn in (-0.1, 0.1)),
    ],
)
def test_at_the_end_loops_to_passes_far_apart_are_witnesses(first, motion, believed):
    """Two loops of one scan count where they say the same of old places more than 8 m apart."""
    closer = walked(30)
    sure = information(np.eye(3) * 1e-4)
    old = 24 if first == 14 else 20
    there = Edge(old, 30, np.array([30.0 - old, 0, 0]), sure, True)
    closer.pending = [there, Edge(first, 30, np.array(motion), sure, True)]
    assert closer.finish_pending() == bool(believed)
    assert len(closer.accepted) == believed and len(closer.rejected) == 2 - believed
    assert not closer.pending


@pytest.mark.parametrize(
    ("one", "other", "apart", "compared"),
    [
        ((1, 31), (4, 34), False, True),
        ((1, 31), (20, 34), False, False),
        ((1, 24), (4, 34), False, False),
        ((1, 31), (4, 31), False, False),
        ((1, 31), (20, 31), True, True),
        ((1, 31), (4, 31), True, False),
        ((1, 31), (20, 34), True, False),
    ],
)
def test_which_loops_are_compared(one, other, apart, compared):
    """Whichever of them is the older one, at each end."""
    closer = walked(40)
    a, b = (Edge(i, j, np.array([j - i, 0.0, 0]), np.eye(3), True) for i, j in (one, other))
    for loop, known in ((a, b), (b, a)):
        assert bool(closer.partners(loop, [known], apart=apart)) == compared


@pytest.mark.parametrize(("change", "measured"), [("", True), ("no odometry", False)])
def test_a_key_frame_knows_whether_odometry_led_to_it(change, measured):
    """Catches a rule for drives without odometry that is never asked, or that holds for all."""
    graph = LiveGraph()
    graph.extend(CHANGES[change](logs.loop_log()[:30]))
    frames = graph.front_end.frames
    assert len(frames) > 2 and {row.measured for row in frames.rows} == {measured}
    assert (frames.spread[-1] == 0) == measured


@pytest.mark.parametrize(("along", "agreed"), [(0.07, True), (0.09, False)])
def test_loops_do_not_agree_over_steps_that_slide(along, agreed):
    """Three steps at each end, in all known to 17 or 22 cm: what agrees there may slide too."""
    closer = walked(40, along=along)
    a, b = (Edge(i, i + 30, np.array([30.0, 0, 0]), np.eye(3), True) for i in (1, 4))
    assert bool(closer.partners(a, [b])) == bool(closer.partners(b, [a])) == agreed


@pytest.mark.parametrize(
    ("new", "lost_since", "seen"), [(30, None, 4), (30, 0, 4), (30, 29, 2), (2, None, 3)]
)
def test_a_lost_robot_is_sought_by_what_it_has_seen_since(new, lost_since, seen):
    """Catches a view that reaches back to where the robot was before it was carried away."""

    class Map:
        def search(self, points, guess, **place):
            assert len(points) == 10 * seen
            return None, 0.0

    closer = walked(30, points=np.ones((10, 2)))
    closer.lost_since = lost_since
    window = Window(3, np.zeros(3), 1.0, 0.3)
    assert closer.measure(window, Map(), new).reason == "the two places look different"


@pytest.mark.parametrize(("reach", "covered"), [(1.0, 5), (2.5, 5), (9.0, 9), (12.0, 12)])
def test_the_map_of_an_old_place_reaches_as_far_as_the_window(reach, covered):
    """Killian Court: a door 3.8 m off fitted better than the true place, where no map was."""
    closer = walked(40, points=np.zeros((1, 2)))
    x = closer.map_around(Window(20, np.zeros(3), reach, 0.3)).grid.points[:, 0]
    assert (x.min(), x.max()) == (-covered, covered)


@pytest.mark.parametrize(("metres", "out"), [(None, False), (1.4, False), (1.6, True)])
def test_a_loop_that_stays_far_open_is_taken_out(metres, out):
    """By more than 15 standard deviations of 0.1 m; the steps are never loops."""
    closer = walked(20)
    frames = closer.frames
    if metres is not None:
        weight = np.eye(3) / 0.1**2
        closer.believe([Edge(2, 18, np.array([16.0 + metres, 0, 0]), weight, True)])
    assert closer.drop_contradicted() == out
    assert [loop[:2] for loop in closer.not_believed()] == [(2, 18)] * out
    assert len(frames.edges) == 20 + (metres is not None and not out)


def test_a_loop_is_sought_where_the_way_since_the_old_place_is_over_ten_metres():
    """Five metres out and back: after ten the robot is where it was, and on the local map."""
    closer = walked(5)
    frames = closer.frames
    for scan, step in enumerate([(0, 0, np.pi)] + [(1, 0, 0)] * 6, start=6):
        frames.add(KeyFrame(scan, np.zeros((0, 2))), np.array(step, float), np.eye(3))
    found = [[window.old for window in closer._by_place(new, new)] for new in (11, 12)]
    assert frames.distance[11:].tolist() == [10, 11] and found == [[], [0]]
    (window,) = closer._by_place(12, 12)
    assert (window.reach, window.turn) == (1 + 0.03 * 11, np.radians(20))
    np.testing.assert_allclose(window.guess, between(frames.poses[0], frames.poses[12]))


def test_each_pass_is_searched_once_where_it_looks_most_alike():
    """Catches a pass that begins one key frame too late, or a fourth one."""
    frames, cost = np.array([0, 3, 10, 11, 30, 31, 50]), np.array([5, 4, 1, 2, 3, 9, 0.5])
    assert best_of_passes(frames, cost) == [50, 10, 30]
    assert best_of_passes(frames[:3], cost[:3]) == [10, 3]


@pytest.mark.parametrize("wheels", [True, False])
def test_a_step_along_a_wall_is_known_as_well_as_the_odometry(wheels):
    """Catches a place along a wall that the search chose, and wheels of which nothing is known yet
    that are believed like good ones: then they err ten times as much."""
    log = load("corridor")[:2]
    log = log if wheels else logs.without_odometry(log)
    loose, free = np.diag([0.25, 1e-4, 1e-4]), np.array([1.0, 0])
    step = between(log.odometry[0], log.odometry[1]) if wheels else np.zeros(3)
    match = Match(step + (0.1, 0, 0), loose, True, "", 1.0, free)
    front = FrontEnd(lambda *_: match, Tracking())
    front.add_frame(front.track(log[0]))
    front.add_frame(front.track(log[1]))
    edge = front.frames.edges[0]
    known = np.diag(np.linalg.inv(edge.information) - REAL)
    far, turn = np.hypot(*step[:2]), abs(step[2])
    told = (10 * (0.01 + 0.03 * far + 0.05 * turn)) ** 2
    share = 0.25 / (0.25 + told) if wheels else 0
    np.testing.assert_allclose(known, [0.25 * (1 - share), 1e-4, 1e-4], rtol=1e-6)
    np.testing.assert_allclose(edge.relative - step, [0.1 * (1 - share), 0, 0], atol=1e-9)


@pytest.mark.parametrize("count", [5, 6])
def test_a_scan_of_six_points_is_laid_and_refined(count, monkeypatch):
    """Catches a scan that says nothing and is matched, or is matched at first only."""
    first, second = logs.office_log()[:2]
    seen = np.isin(np.cumsum(second.valid), 1 + 20 * np.arange(count))
    few = replace(second, ranges=np.where(seen, second.ranges, np.nan))
    laid, refined = (Match(np.array([x, 0, 0]), REAL, True, "", 1.0) for x in (0.1, 0.2))
    front = FrontEnd(lambda *given: laid, Tracking())
    front.add_frame(front.track(first))
    assert front.track(few).reason == ("" if count == 6 else "too few points")
    before = front.rows[1].pose
    monkeypatch.setattr(PointMap, "register", lambda *given, **rules: refined)
    front.register_again()
    assert front.rows[1].pose is (refined.pose if count == 6 else before)


@pytest.mark.parametrize("wheels", [True, False])
@pytest.mark.parametrize("side", [1, -1])
def test_a_dense_scan_may_begin_at_either_end(wheels, side):
    """Catches every k-th beam counted from one end, and search cells that a mirror shifts.

    Beams in the other order, `side` 1, or the building in a mirror, -1. Steps and loops alike.
    """
    log = load("room")
    flip = np.array([1, side, side])

    def turned(scan):
        odometry = scan.odometry * flip if wheels else None
        return LaserScan(
            scan.ranges[::-1], side * scan.angles[::-1], scan.time, odometry, scan.max_range
        )

    as_it_is = Log("room", [s if wheels else replace(s, odometry=None) for s in log])
    one, two = pose_graph(as_it_is), pose_graph(Log("other", [turned(scan) for scan in log]))
    assert two.used.tolist() == one.used.tolist()
    np.testing.assert_allclose(two.poses * flip, one.poses, atol=1e-6)
