"""Global alignment: its equations against their literal form, exact recovery, and its limits."""

import itertools

import alignment_logs as logs
import numpy as np
import pytest
from conftest import slow

from segmap import load
from segmap.alignment import global_segments
from segmap.alignment.global_segments import _equations as equations
from segmap.alignment.global_segments._global_segments import hang_between, kept_scans
from segmap.alignment.graph import groups
from segmap.angles import axial_difference, wrap
from segmap.metrics import segment_distance
from segmap.poses import between, compose, transform
from segmap.scans import Log
from segmap.segments import angle
from segmap.simulation import OdometryNoise, drifting_odometry

RULES = equations.Rules(similar=0.20, angle=np.radians(15), spread=0.02, rounds=15)
ONE_DIRECTION = "walls in one direction only: along them the guess was kept"
ALONE = "shares no two walls with the scans around it: hangs on odometry"


# ------------------------------------------------------------------ the equations


def test_what_is_held_stays_and_every_group_is_held_once():
    """A singular system where scans share nothing with the first one."""
    i, j = np.array([0, 3, 5]), np.array([1, 4, 3])
    assert groups(i, j, 7).tolist() == [0, 0, 1, 2, 2, 2, 3]
    fixed = equations.with_one_fixed(i, j, np.arange(7) == 1)
    assert np.flatnonzero(fixed).tolist() == [1, 2, 3, 6]
    found = equations.solve_differences(
        i, j, np.ones(3), np.array([[1.0], [2.0], [4.0]]), fixed
    ).ravel()
    np.testing.assert_allclose(found, [-1, 0, 0, 0, 2, -4, 0])


def test_the_weight_is_2_7():
    """`D^2` for D, sigma for sigma^2; segments of an angle or distance that is too large."""
    rng = np.random.default_rng(2)
    walls = rng.uniform(-2, 2, (10, 2, 2))
    two = equations.stacked_scans([walls, walls + rng.normal(0, 0.03, walls.shape)])
    pairs, edge = equations.weigh_pairs(two.segments, two.first, np.array([[0, 1]]), RULES)
    distance = segment_distance(walls[:, None], two.segments[None, 10:])
    turn = np.abs(axial_difference(angle(walls)[:, None], angle(two.segments[10:])[None]))
    u, v = np.nonzero((distance < 0.20) & (turn < RULES.angle))
    assert (edge == 0).all()
    assert (pairs.u.tolist(), (pairs.v - 10).tolist()) == (u.tolist(), v.tolist())
    np.testing.assert_allclose(pairs.weight, np.exp(-distance[u, v] / 0.04))


def test_pairs_are_the_same_in_one_piece_and_in_many():
    """An edge that is lost or counted twice where the memory for the pairs runs out."""
    view = np.concatenate([np.random.default_rng(k).uniform(0, 3, (12, 2, 2)) for k in (1, 1, 1)])
    scans = equations.stacked_scans([view] * 3)
    edges = np.array([(0, 1), (0, 2), (1, 2)])
    whole = equations.weigh_pairs(scans.segments, scans.first, edges, RULES)
    parts = [
        equations.weigh_pairs(scans.segments, scans.first, edges[k : k + 1], RULES)[0]
        for k in range(3)
    ]
    assert len(whole[1]) > 48 * 3
    np.testing.assert_array_equal(whole[0], np.concatenate(parts, axis=1))


# ------------------------------------------------------------------ which scans are kept
def row_of_views(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Scans along x; each sees two walls of its own neighbourhood and those of the next two."""
    corner = np.array([[(0, 0), (1, 0)], [(0, 0), (0, 1)]])
    return equations.stacked_scans(
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
        scans = equations.stacked_scans([view] * 3)
        assert kept_scans(*scans, np.arange(3.0), 5.0, RULES).tolist() == kept


def test_coming_back_does_not_leave_the_loop_out():
    """A's minimal subset taken literally: from the first scan straight to the return."""
    segments, first = row_of_views(5)
    views = [segments[a:b] for a, b in itertools.pairwise(first)]
    back = equations.stacked_scans([*views, segments[:6]])
    assert kept_scans(*back, np.r_[0:5.0, 30.0], 2.0, RULES).tolist() == [0, 2, 4]


def test_scans_between_hang_on_both_neighbours():
    """A misfit that is left to one step, or spread by index where the way is uneven."""
    guess = np.array([(0, 0, 0), (1, 0, 0), (3, 0, 0), (4, 0, 0), (5, 0, 0)], float)
    kept, poses = np.array([0, 3]), np.array([(0, 0, 0), (4, 0.4, 0.1)])
    found = hang_between(kept, poses, guess, guess[:, 0])
    np.testing.assert_allclose(found[kept], poses)
    np.testing.assert_allclose(found[1, 2], 0.025, atol=1e-6)
    np.testing.assert_allclose(found[4], compose(poses[1], (1, 0, 0)))
    turned = transform(poses[1], [(-3.0, 0.0)])[0]
    np.testing.assert_allclose(found[1, :2], 0.75 * guess[1, :2] + 0.25 * turned, atol=1e-5)
    assert abs(wrap(found[2, 2] - 0.075)) < 1e-6


# ------------------------------------------------------------------ whole logs
def errors(log: Log, poses: np.ndarray) -> np.ndarray:
    return logs.errors(log, poses)[0]


def test_the_first_pose_is_fixed_and_the_start_replaces_odometry():
    """Poses that drift away as a whole; a start that is read as steps or not at all."""
    log = logs.exact_log()
    start = compose((10, 20, 1.0), log.truth)
    found = global_segments(logs.without_odometry(log), start=start)
    np.testing.assert_allclose(found.poses[0], start[0])
    assert errors(log, found.poses).max() < 0.01


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


def test_groups_that_share_nothing_hang_on_odometry():
    """A singular system, or a second building laid over the first."""
    log = logs.exact_log()
    far = logs.changed(log, odometry=compose((50, 30, 2.0), log.odometry))
    found, n = global_segments(Log("two", [*log, *far])), len(log)
    assert found.reasons[n] == ALONE
    assert errors(log, found.poses[n:]).max() < 0.05
    step = between(between(log.odometry[-1], far.odometry[0]), between(*found.poses[n - 1 : n + 1]))
    np.testing.assert_allclose(step, 0, atol=0.02)
