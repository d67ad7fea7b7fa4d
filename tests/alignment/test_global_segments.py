"""Global alignment: its equations against their literal form, exact recovery, and its limits."""

import itertools

import alignment_logs as logs
import numpy as np
import pytest
from conftest import slow
from segmap_course import literal

from segmap import load
from segmap.alignment import global_segments
from segmap.alignment.global_segments import _equations as equations
from segmap.alignment.global_segments._global_segments import hung_between, kept_scans
from segmap.angles import axial_difference, wrap
from segmap.metrics import segment_distance
from segmap.poses import between, compose, transform
from segmap.scans import Log
from segmap.segments import angle
from segmap.simulation import SICK_LMS200, OdometryNoise, drifting_odometry

RULES = equations.Rules(similar=0.20, angle=np.radians(15), spread=0.02, rounds=15)
ONE_DIRECTION = "walls in one direction only: along them the guess was kept"
ALONE = "shares no two walls with the scans around it: hangs on odometry"


# ------------------------------------------------------------------ the equations
def random_pairs(seed: int) -> tuple[np.ndarray, equations.Pairs, np.ndarray]:
    """Segments of six scans, pairs between them in both orders, and one scan held."""
    rng = np.random.default_rng(seed)
    owner = np.repeat(np.arange(6), 4)
    segments = rng.uniform(-3, 3, (24, 2, 2))
    u, v = rng.integers(0, 24, (2, 80))
    u, v = u[owner[u] != owner[v]], v[owner[u] != owner[v]]
    pairs = equations.Pairs(owner[u], owner[v], u, v, rng.uniform(0.1, 1, len(u)))
    return segments, pairs, np.arange(6) == 0


@pytest.mark.parametrize("name", ["best_turns", "best_shifts"])
@pytest.mark.parametrize("seed", range(5))
def test_the_equations_are_those_of_2_8_and_2_12(name, seed):
    """2.6, 2.11, 2.13-2.15 as printed; plain differences of angles; end points that have an order.

    The literal form sets up the equations scan by scan; at the solution the sum has no slope.
    """
    segments, pairs, held = random_pairs(seed)
    i, j, u, v, w = (column.tolist() for column in pairs)
    matches = list(zip(i, j, segments[u].tolist(), segments[v].tolist(), w, strict=True))
    expected = getattr(literal, name)(matches, 6)
    for given in (segments, segments[:, ::-1]):
        found = getattr(equations, name)(given, pairs, held)
        np.testing.assert_allclose(found, expected, atol=1e-10)


@pytest.mark.parametrize("turns", [True, False])
def test_at_the_literal_solution_the_sum_has_no_slope(turns):
    """A system that is symmetric and solvable, but not that of the sum (2.8, 2.12)."""
    segments, pairs, held = random_pairs(9)
    if turns:
        gap = axial_difference(angle(segments[pairs.u]), angle(segments[pairs.v]))[:, None]
        (i, j, *_, weight), best = pairs, equations.best_turns(segments, pairs, held)[:, None]
    else:
        gap, i, j = equations.feet(segments, pairs)
        weight, best = np.tile(pairs.weight, 4), equations.best_shifts(segments, pairs, held)

    def cost(x: np.ndarray) -> float:
        return float((weight[:, None] * (x[i] - x[j] + gap) ** 2).sum())

    for k, axis in itertools.product(range(1, 6), range(best.shape[1])):
        step = np.zeros_like(best)
        step[k, axis] = 1e-4
        assert abs(cost(best + step) - cost(best - step)) / 2e-4 < 1e-6
        assert cost(best + 10 * step) > cost(best)


def test_feet_lie_on_the_lines_of_both():
    """Feet clamped to the segment, or of one of the two only."""
    segments, pairs, _ = random_pairs(3)
    gap, i, _ = equations.feet(segments, pairs)
    n, ends = len(pairs.u), np.concatenate([segments[pairs.u], segments[pairs.v]])
    onto = np.concatenate([segments[pairs.v], segments[pairs.u]])
    points = np.concatenate([ends[:n, 0], ends[:n, 1], ends[n:, 0], ends[n:, 1]])
    lines = np.concatenate([onto[:n], onto[:n], onto[n:], onto[n:]])
    d, to_foot = lines[:, 1] - lines[:, 0], points - gap - lines[:, 0]
    np.testing.assert_allclose(d[:, 0] * to_foot[:, 1] - d[:, 1] * to_foot[:, 0], 0, atol=1e-9)
    np.testing.assert_allclose((d * gap).sum(1), 0, atol=1e-9)
    assert i[: 2 * n].tolist() == [*pairs.i, *pairs.i]


def test_what_is_held_stays_and_every_group_is_held_once():
    """A singular system where scans share nothing with the first one."""
    i, j = np.array([0, 3, 5]), np.array([1, 4, 3])
    assert equations.groups(i, j, 7).tolist() == [0, 0, 1, 2, 2, 2, 3]
    fixed = equations.with_one_held(i, j, np.arange(7) == 1)
    assert np.flatnonzero(fixed).tolist() == [1, 2, 3, 6]
    found = equations.solve(i, j, np.ones(3), np.array([[1.0], [2.0], [4.0]]), fixed).ravel()
    np.testing.assert_allclose(found, [-1, 0, 0, 0, 2, -4, 0])


def test_the_weight_is_2_7():
    """`D^2` for D, sigma for sigma^2; segments of an angle or distance that is too large."""
    rng = np.random.default_rng(2)
    walls = rng.uniform(-2, 2, (10, 2, 2))
    two = equations.stacked([walls, walls + rng.normal(0, 0.03, walls.shape)])
    pairs, edge = equations.corresponding(two.segments, two.first, np.array([[0, 1]]), RULES)
    distance = segment_distance(walls[:, None], two.segments[None, 10:])
    turn = np.abs(axial_difference(angle(walls)[:, None], angle(two.segments[10:])[None]))
    u, v = np.nonzero((distance < 0.20) & (turn < RULES.angle))
    assert (edge == 0).all()
    assert (pairs.u.tolist(), (pairs.v - 10).tolist()) == (u.tolist(), v.tolist())
    np.testing.assert_allclose(pairs.weight, np.exp(-distance[u, v] / 0.04))


def test_pairs_are_the_same_in_one_piece_and_in_many():
    """An edge that is lost or counted twice where the memory for the pairs runs out."""
    view = np.concatenate([np.random.default_rng(k).uniform(0, 3, (12, 2, 2)) for k in (1, 1, 1)])
    scans = equations.stacked([view] * 3)
    edges = np.array([(0, 1), (0, 2), (1, 2)])
    whole = equations.corresponding(scans.segments, scans.first, edges, RULES)
    parts = [
        equations.corresponding(scans.segments, scans.first, edges[k : k + 1], RULES)[0]
        for k in range(3)
    ]
    assert len(whole[1]) > 48 * 3
    np.testing.assert_array_equal(whole[0], np.concatenate(parts, axis=1))


# ------------------------------------------------------------------ which scans are kept
def row_of_views(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Scans along x; each sees two walls of its own neighbourhood and those of the next two."""
    corner = np.array([[(0, 0), (1, 0)], [(0, 0), (0, 1)]])
    return equations.stacked(
        [np.concatenate([corner + (5.0 * (k + m), 0) for m in (0, 1, 2)]) for k in range(count)]
    )


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
        scans = equations.stacked([view] * 3)
        assert kept_scans(*scans, np.arange(3.0), 5.0, RULES).tolist() == kept


def test_coming_back_does_not_leave_the_loop_out():
    """A's minimal subset taken literally: from the first scan straight to the return."""
    segments, first = row_of_views(5)
    views = [segments[a:b] for a, b in itertools.pairwise(first)]
    back = equations.stacked([*views, segments[:6]])
    assert kept_scans(*back, np.r_[0:5.0, 30.0], 2.0, RULES).tolist() == [0, 2, 4]


def test_scans_between_hang_on_both_neighbours():
    """A misfit that is left to one step, or spread by index where the way is uneven."""
    guess = np.array([(0, 0, 0), (1, 0, 0), (3, 0, 0), (4, 0, 0), (5, 0, 0)], float)
    kept, poses = np.array([0, 3]), np.array([(0, 0, 0), (4, 0.4, 0.1)])
    found = hung_between(kept, poses, guess, guess[:, 0])
    np.testing.assert_allclose(found[kept], poses)
    np.testing.assert_allclose(found[1, 2], 0.025, atol=1e-6)
    np.testing.assert_allclose(found[4], compose(poses[1], (1, 0, 0)))
    turned = transform(poses[1], [(-3.0, 0.0)])[0]
    np.testing.assert_allclose(found[1, :2], 0.75 * guess[1, :2] + 0.25 * turned, atol=1e-5)
    assert abs(wrap(found[2, 2] - 0.075)) < 1e-6


# ------------------------------------------------------------------ whole logs
def errors(log: Log, poses: np.ndarray) -> np.ndarray:
    return logs.errors(log, poses)[0]


@pytest.mark.parametrize("seed", range(3))
def test_a_log_without_noise_comes_out_exact(seed):
    """A correction on the wrong side, headings mixed with positions, clamped feet."""
    noise = OdometryNoise(turn_bias=0.05, turn_noise=0.05, distance_noise=0.05)
    log = logs.exact_log(noise, seed=seed)
    found = global_segments(log, rounds=60)
    assert errors(log, log.odometry).max() > 0.02
    assert errors(log, found.poses).max() < 0.01
    assert found.used.mean() > 0.9


def test_moving_the_log_moves_the_answer():
    """An axis or the origin that means something."""
    log, world = logs.exact_log(), np.array([4.0, -3.0, 0.6])
    moved = global_segments(logs.changed(log, odometry=compose(world, log.odometry))).poses
    np.testing.assert_allclose(compose(world, global_segments(log).poses), moved, atol=5e-4)


def test_the_first_pose_is_fixed_and_the_start_replaces_odometry():
    """Poses that drift away as a whole; a start that is read as steps or not at all."""
    log = logs.exact_log()
    start = compose((10, 20, 1.0), log.truth)
    found = global_segments(logs.without_odometry(log), start=start)
    np.testing.assert_allclose(found.poses[0], start[0])
    assert errors(log, found.poses).max() < 0.01


@pytest.mark.parametrize(("name", "most"), [("room", 0.03), ("corridor", 0.10)])
def test_bundled_logs_come_out_better_than_odometry_and_loops_are_closed(name, most):
    """Measured: 18 and 46 mm root mean square after rigid alignment, of 137 and 642 by odometry.

    Scans joined only to their neighbours: what global means is the return to the start.
    """
    log = load(name)
    found = global_segments(log)
    error = np.sqrt((errors(log, found.poses) ** 2).mean())
    assert error < 2 * most
    assert error < 0.25 * np.sqrt((errors(log, log.odometry) ** 2).mean())
    assert found.graph.loop.any() and not found.graph.loop.all()
    if name == "corridor":
        assert errors(log, found.poses)[-1] < 0.15 and errors(log, log.odometry)[-1] > 1.0
        assert (found.graph.edges[:, 1] - found.graph.edges[:, 0]).max() > 100


@pytest.mark.parametrize("seed", [0, *map(slow, range(1, 4))])
@pytest.mark.parametrize("error", [0.05, 0.2, 0.5])
def test_it_is_right_or_says_that_it_is_not(seed, error):
    """Silence: where odometry is far off the answer is wrong, and must say so."""
    log = load("room")
    wild = OdometryNoise(turn_bias=error, turn_noise=error, distance_noise=error)
    rng = np.random.default_rng(seed)
    found = global_segments(log, start=drifting_odometry(log.truth, odometry_noise=wild, rng=rng))
    right = errors(log, found.poses).max() < 0.15
    said = {why for why in found.reasons if why and why != ONE_DIRECTION}
    assert right or said
    assert right or error > 0.05
    assert not right or error < 0.5


def test_a_scan_without_segments_hangs_between_its_neighbours():
    """A blind scan that is thrown to the origin, or that stops the chain."""
    log = logs.blind(logs.exact_log(), 5)
    found = global_segments(log)
    assert found.reasons[5] == ALONE
    assert errors(log, found.poses).max() < 0.02


def test_missing_odometry_is_filled_in_between():
    """NaN in the poses where one scan has no odometry."""
    log = logs.without_odometry(logs.exact_log(), 3, 4)
    assert errors(log, global_segments(log).poses).max() < 0.02


def test_without_any_odometry_it_says_so():
    """An answer made up from nothing."""
    found = global_segments(logs.without_odometry(logs.exact_log()))
    assert (found.poses == 0).all()
    assert found.used[0] and set(found.reasons[1:]) == {"no odometry to begin from"}


def test_a_featureless_corridor_is_said_to_be_one():
    """An answer that claims to know where along the corridor the robot is."""
    log = logs.featureless_log(step=0.5, sensor=SICK_LMS200.ideal())
    found = global_segments(log)
    assert set(found.reasons[1:]) == {ONE_DIRECTION}
    assert np.abs(found.poses[:, 0] - log.odometry[:, 0]).max() < 0.05
    assert np.abs(found.poses[:, 1]).max() < 0.02


def test_groups_that_share_nothing_hang_on_odometry():
    """A singular system, or a second building laid over the first."""
    log = logs.exact_log()
    far = logs.changed(log, odometry=compose((50, 30, 2.0), log.odometry))
    found, n = global_segments(Log("two", [*log, *far])), len(log)
    assert found.reasons[n] == ALONE
    assert errors(log, found.poses[n:]).max() < 0.05
    step = between(between(log.odometry[-1], far.odometry[0]), between(*found.poses[n - 1 : n + 1]))
    np.testing.assert_allclose(step, 0, atol=0.02)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"angle": 2.0}, "angle must be a number above 0 and below 1.5708"),
        ({"similar": 0.0}, "similar must be a number above 0"),
        ({"spread": np.inf}, "spread must be a number above 0"),
        ({"reach": -1.0}, "reach must be a number above 0"),
        ({"rounds": 0.5}, "rounds must be a whole number"),
        ({"start": np.zeros((3, 3))}, r"start must have shape \(2, 3\)"),
        ({"start": np.full((2, 3), np.nan)}, "start must be finite"),
    ],
)
def test_arguments_out_of_range(wrong, message):
    with pytest.raises(ValueError, match=message):
        global_segments(logs.exact_log()[:2], **wrong)
