"""Global alignment: its equations against dense least squares, exact recovery, and its limits."""

import itertools

import numpy as np
import pytest

from segmap import load
from segmap.alignment import global_segments
from segmap.alignment._global_equations import (
    Pairs,
    best_shifts,
    best_turns,
    feet,
    groups,
    solve,
    with_one_held,
)
from segmap.alignment._global_segments import kept_scans
from segmap.angles import axial_difference, wrap
from segmap.metrics import segment_distance
from segmap.poses import between, compose, transform
from segmap.scans import LaserScan, Log
from segmap.segments import angle
from segmap.simulation import SICK_LMS200, OdometryNoise, drifting_odometry, drive, office, simulate

WALLS = office(rng=np.random.default_rng(1), rooms=2)
RULES = Rules(similar=0.20, angle=np.radians(15), spread=0.02, rounds=15)
ONE_DIRECTION = "walls in one direction only: along them the guess was kept"


# ------------------------------------------------------------------ the equations
def random_pairs(seed: int) -> tuple[np.ndarray, Pairs, np.ndarray]:
    """Segments of six scans, pairs between them in both orders, and one scan held."""
    rng = np.random.default_rng(seed)
    owner = np.repeat(np.arange(6), 4)
    segments = rng.uniform(-3, 3, (24, 2, 2))
    u, v = rng.integers(0, 24, (2, 80))
    u, v = u[owner[u] != owner[v]], v[owner[u] != owner[v]]
    pairs = Pairs(owner[u], owner[v], u, v, rng.uniform(0.1, 1, len(u)))
    return segments, pairs, np.arange(6) == 0


def dense(rows: list[tuple[int, int, float, float]], count: int) -> np.ndarray:
    """Least `sum w (x_i - x_j + c)^2` with x_0 = 0, by lstsq on its rows (i, j, w, c)."""
    a, b = np.zeros((len(rows), count)), np.zeros(len(rows))
    for k, (i, j, w, c) in enumerate(rows):
        a[k, i] += np.sqrt(w)
        a[k, j] -= np.sqrt(w)
        b[k] = -np.sqrt(w) * c
    return np.append(0.0, np.linalg.lstsq(a[:, 1:], b)[0])


@pytest.mark.parametrize("seed", range(5))
def test_turns_are_the_least_squares_of_2_8(seed):
    """The signs of 2.6 and 2.11 as printed; angles subtracted as plain numbers."""
    segments, pairs, held = random_pairs(seed)
    rows = []
    for i, j, u, v, w in zip(*pairs, strict=True):
        d = float(axial_difference(angle(segments[u]), angle(segments[v])))
        rows.append((i, j, w, d))
    np.testing.assert_allclose(best_turns(segments, pairs, held), dense(rows, 6), atol=1e-10)


@pytest.mark.parametrize("seed", range(5))
def test_shifts_are_the_least_squares_of_2_12(seed):
    """2.13-2.15 as printed: a factor 2, half of what stands off the diagonal, the sign of A."""
    segments, pairs, held = random_pairs(seed)
    expected = np.empty((6, 2))
    for axis in (0, 1):
        rows = []
        for i, j, u, v, w in zip(*pairs, strict=True):
            for a, b, s, t in ((i, j, segments[u], segments[v]), (j, i, segments[v], segments[u])):
                along = (t[1] - t[0]) / np.linalg.norm(t[1] - t[0])
                for end in s:
                    foot = t[0] + along * ((end - t[0]) @ along)
                    rows.append((a, b, w, (end - foot)[axis]))
        expected[:, axis] = dense(rows, 6)
    np.testing.assert_allclose(best_shifts(segments, pairs, held), expected, atol=1e-10)


def test_at_the_solution_the_cost_has_no_slope():
    """A system that is symmetric and solvable, but not that of the cost."""
    segments, pairs, held = random_pairs(9)
    gap, i, j = feet(segments, pairs)
    weight = np.tile(pairs.weight, 4)

    def cost(x: np.ndarray) -> float:
        return float((weight[:, None] * (x[i] - x[j] + gap) ** 2).sum())

    best = best_shifts(segments, pairs, held)
    for k in range(1, 6):
        for axis in (0, 1):
            step = np.zeros((6, 2))
            step[k, axis] = 1e-4
            assert abs(cost(best + step) - cost(best - step)) / 2e-4 < 1e-6
            assert cost(best + 10 * step) > cost(best)


def test_what_is_held_stays_and_every_group_is_held_once():
    """A singular system where scans share nothing with the first one."""
    i, j = np.array([0, 3, 5]), np.array([1, 4, 3])
    held = np.arange(7) == 1
    assert groups(i, j, 7).tolist() == [0, 0, 1, 2, 2, 2, 3]
    fixed = with_one_held(i, j, held)
    assert np.flatnonzero(fixed).tolist() == [1, 2, 3, 6]
    found = solve(i, j, np.ones(3), np.array([[1.0], [2.0], [4.0]]), fixed).ravel()
    np.testing.assert_allclose(found, [-1, 0, 0, 0, 2, -4, 0])


def test_end_points_may_be_swapped():
    """A direction of travel taken for the angle of a wall."""
    segments, pairs, held = random_pairs(3)
    for solve_ in (best_turns, best_shifts):
        once, swapped = solve_(segments, pairs, held), solve_(segments[:, ::-1], pairs, held)
        np.testing.assert_allclose(once, swapped, atol=1e-10)


def test_the_weight_is_2_7():
    """`D^2` for D, sigma for sigma^2; segments of an angle or distance that is too large."""
    rng = np.random.default_rng(2)
    walls = rng.uniform(-2, 2, (10, 2, 2))
    two = gathered([walls, walls + rng.normal(0, 0.03, walls.shape)])
    pairs, arc = corresponding(two, np.zeros((2, 3)), np.array([[0, 1]]), RULES)
    distance = segment_distance(walls[:, None], two.segments[None, 10:])
    turn = np.abs(axial_difference(angle(walls)[:, None], angle(two.segments[10:])[None]))
    u, v = np.nonzero((distance < 0.20) & (turn < RULES.angle))
    assert (arc == 0).all()
    assert pairs.u.tolist() == u.tolist()
    assert (pairs.v - 10).tolist() == v.tolist()
    np.testing.assert_allclose(pairs.weight, np.exp(-distance[u, v] / 0.04))


# ------------------------------------------------------------------ which scans are kept
def row_of_views(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Scans along x; each sees two walls of its own neighbourhood and those of the next two."""
    corner = np.array([[(0, 0), (1, 0)], [(0, 0), (0, 1)]])
    views = [
        np.concatenate([corner + (5.0 * (k + more), 0) for more in (0, 1, 2)]) for k in range(count)
    ]
    scans = gathered(views)
    return scans.segments, scans.first


def test_the_fewest_scans_are_kept():
    """A greedy choice of the nearest, or a chain with neighbours that share nothing."""
    segments, first = row_of_views(7)
    way = np.arange(7.0)
    assert kept_scans(segments, first, way, 10.0, RULES).tolist() == [0, 2, 4, 6]
    assert kept_scans(segments, first, way, 1.5, RULES).tolist() == list(range(7))


def test_a_shared_wall_is_not_enough():
    """Two similar pairs that are similar to each other are one feature (A 2.5.1)."""
    wall = np.array([[(0, 0), (2, 0)], [(0.1, 0.01), (1.9, 0.01)]])
    corner = np.concatenate([wall, [[(0, 0), (0, 2)]]])
    for view, kept in ((wall, [0]), (corner, [0, 2])):
        scans = gathered([view] * 3)
        found = kept_scans(scans.segments, scans.first, np.arange(3.0), 5.0, RULES)
        assert found.tolist() == kept


def test_coming_back_does_not_leave_the_loop_out():
    """A's minimal subset taken literally: from the first scan straight to the return."""
    segments, first = row_of_views(5)
    back = gathered([segments[a:b] for a, b in itertools.pairwise(first)] + [segments[:6]])
    found = kept_scans(back.segments, back.first, np.r_[0:5.0, 30.0], 2.0, RULES)
    assert found.tolist() == [0, 2, 4]


# ------------------------------------------------------------------ whole logs
def exact_log(seed: int = 5, wheels: OdometryNoise = OdometryNoise()) -> Log:
    """A robot with a laser without error, and wheels that drift, in an office."""
    path = drive([(1, 5), (2, 5), (2, 7.5)], step=0.25, turn=np.radians(15))
    rng = np.random.default_rng(seed)
    return simulate(WALLS, path, sensor=SICK_LMS200.ideal(), rng=rng, odometry_noise=wheels)


def with_odometry(log: Log, poses: list) -> Log:
    scans = [
        LaserScan(s.ranges, s.angles, s.time, o, s.max_range, s.sensor_pose)
        for s, o in zip(log, poses, strict=True)
    ]
    return Log(log.name, scans, log.truth)


def errors(log: Log, poses: np.ndarray) -> np.ndarray:
    """Distances from the truth, both seen from their first pose."""
    assert log.truth is not None
    step = between(between(log.truth[0], log.truth), between(poses[0], poses))
    return np.hypot(*step[:, :2].T)


@pytest.mark.parametrize("seed", range(3))
def test_a_log_without_noise_comes_out_exact(seed):
    """A correction on the wrong side, headings mixed with places, feet clamped to the segment."""
    log = exact_log(seed, OdometryNoise(turn_bias=0.05, turn_noise=0.05, distance_noise=0.05))
    found = global_segments(log, rounds=60)
    assert errors(log, log.odometry).max() > 0.02
    assert errors(log, found.poses).max() < 0.01
    assert found.used.mean() > 0.9


def test_moving_the_log_moves_the_answer():
    """An axis or the origin that means something."""
    log = exact_log()
    world = np.array([4.0, -3.0, 0.6])
    once = global_segments(log).poses
    moved = global_segments(with_odometry(log, list(compose(world, log.odometry)))).poses
    np.testing.assert_allclose(compose(world, once), moved, atol=5e-4)


def test_the_first_pose_is_fixed_and_the_start_replaces_odometry():
    """Poses that drift away as a whole; a start that is read as steps or not at all."""
    log = exact_log()
    start = compose((10, 20, 1.0), log.truth)
    found = global_segments(with_odometry(log, [None] * len(log)), start=start)
    np.testing.assert_allclose(found.poses[0], start[0])
    assert errors(log, found.poses).max() < 0.01


@pytest.mark.parametrize(("name", "most"), [("room", 0.03), ("corridor", 0.10)])
def test_bundled_logs_come_out_better_than_odometry(name, most):
    """Measured: 18 and 46 mm root mean square after rigid alignment, of 137 and 642 by odometry."""
    log = load(name)
    found = global_segments(log)
    error = np.sqrt((errors(log, found.poses) ** 2).mean())
    assert error < 2 * most
    assert error < 0.25 * np.sqrt((errors(log, log.odometry) ** 2).mean())
    assert found.graph is not None
    assert found.graph.loop.any() and not found.graph.loop.all()


def test_a_loop_is_closed():
    """Scans joined only to their neighbours: what global means is the return to the start."""
    log = load("corridor")
    found = global_segments(log)
    alone = log.truth[-1] - log.truth[0]
    assert np.hypot(*(between(found.poses[0], found.poses[-1]) - alone)[:2]) < 0.15
    assert np.hypot(*(between(log.odometry[0], log.odometry[-1]) - alone)[:2]) > 1.0
    assert (found.graph.edges[:, 1] - found.graph.edges[:, 0]).max() > 100


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("error", [0.05, 0.2, 0.5])
def test_it_is_right_or_says_that_it_is_not(seed, error):
    """Silence: where odometry is far off the answer is wrong, and must say so."""
    log = load("room")
    wild = OdometryNoise(turn_bias=error, turn_noise=error, distance_noise=error)
    odometry = drifting_odometry(log.truth, odometry_noise=wild, rng=np.random.default_rng(seed))
    found = global_segments(with_odometry(log, list(odometry)))
    assert np.isfinite(found.poses).all()
    right = errors(log, found.poses).max() < 0.15
    said = {why for why in found.reasons if why and why != ONE_DIRECTION}
    assert right or said
    assert right or error > 0.05
    assert not right or error < 0.5


def test_a_scan_without_segments_hangs_between_its_neighbours():
    """A blind scan that is thrown to the origin, or that stops the chain."""
    log = exact_log()
    scans = list(log)
    scans[5] = LaserScan([], [], scans[5].time, scans[5].odometry)
    found = global_segments(Log("blind", scans, log.truth))
    assert found.reasons[5] == "shares no two walls with the scans around it: hangs on odometry"
    assert errors(log, found.poses).max() < 0.02


def test_missing_odometry_is_filled_in_between():
    """NaN in the poses where one scan has no odometry."""
    log = exact_log()
    odometry = list(log.odometry)
    odometry[3] = odometry[4] = None
    assert errors(log, global_segments(with_odometry(log, odometry)).poses).max() < 0.02


def test_without_any_odometry_it_says_so():
    """An answer made up from nothing."""
    log = exact_log()
    found = global_segments(with_odometry(log, [None] * len(log)))
    assert (found.poses == 0).all()
    assert found.used.tolist() == [True] + [False] * (len(log) - 1)
    assert set(found.reasons[1:]) == {"no odometry to begin from"}


def test_a_featureless_corridor_is_said_to_be_one():
    """An answer that claims to know where along the corridor the robot is."""
    walls = np.array([[(-50, -1), (50, -1)], [(-50, 1), (50, 1)]])
    path = drive([(-5, 0), (5, 0)], step=0.5)
    rng = np.random.default_rng(2)
    log = simulate(walls, path, sensor=SICK_LMS200.ideal(), rng=rng)
    found = global_segments(log)
    assert set(found.reasons[1:]) == {ONE_DIRECTION}
    along = found.poses[:, 0] - log.odometry[:, 0]
    assert np.abs(along).max() < 0.05
    assert np.abs(found.poses[:, 1]).max() < 0.02


def test_groups_that_share_nothing_hang_on_odometry():
    """A singular system, or a second building laid over the first."""
    log = exact_log()
    far = with_odometry(log, list(compose((50, 30, 2.0), log.odometry)))
    found = global_segments(Log("two", [*log, *far]))
    n = len(log)
    assert np.isfinite(found.poses).all()
    assert found.reasons[n] == "shares no two walls with the scans around it: hangs on odometry"
    assert errors(log, found.poses[n:]).max() < 0.05
    step = between(between(log.odometry[-1], far.odometry[0]), between(*found.poses[n - 1 : n + 1]))
    np.testing.assert_allclose(step, 0, atol=0.02)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_none_one_and_two(count):
    log = exact_log()[:count]
    found = global_segments(log)
    assert found.poses.shape == (count, 3)
    assert np.isfinite(found.poses).all()
    assert len(found.reasons) == count


def test_equal_and_exchanged_times_change_nothing():
    """Times in the place of the order of recording."""
    log = exact_log()
    still = Log("still", [LaserScan(s.ranges, s.angles, 7.0, s.odometry) for s in log])
    np.testing.assert_array_equal(global_segments(log).poses, global_segments(still).poses)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"angle": 2.0}, "angle must be below pi/2"),
        ({"similar": 0.0}, "similar must be positive"),
        ({"spread": np.inf}, "spread must be positive"),
        ({"reach": -1.0}, "reach must be positive"),
        ({"start": np.zeros((3, 3))}, r"start must be \(2, 3\) finite poses"),
        ({"start": np.full((2, 3), np.nan)}, r"start must be \(2, 3\) finite poses"),
    ],
)
def test_arguments_out_of_range(wrong, message):
    with pytest.raises(ValueError, match=message):
        global_segments(exact_log()[:2], **wrong)


def test_scans_between_hang_on_both_neighbours():
    """A misfit that is left to one step, or spread by index where the way is uneven."""
    from segmap.alignment._global_segments import hung_between

    guess = np.array([(0, 0, 0), (1, 0, 0), (3, 0, 0), (4, 0, 0), (5, 0, 0)], float)
    kept = np.array([0, 3])
    poses = np.array([(0, 0, 0), (4, 0.4, 0.1)])
    way = guess[:, 0]
    found = hung_between(kept, poses, guess, way)
    np.testing.assert_allclose(found[kept], poses)
    np.testing.assert_allclose(found[1, 2], 0.025, atol=1e-6)
    np.testing.assert_allclose(found[4], compose(poses[1], (1, 0, 0)))
    turned = transform(poses[1], [(-3.0, 0.0)])[0]
    np.testing.assert_allclose(found[1, :2], 0.75 * guess[1, :2] + 0.25 * turned, atol=1e-5)
    assert abs(wrap(found[2, 2] - 0.075)) < 1e-6
