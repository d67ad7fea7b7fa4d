"""Robust least squares over poses: against plain loops, scipy and exact graphs."""

import numpy as np
import pytest
from segmap_course import literal

from segmap import load
from segmap.alignment import pose_graph, solve_graph
from segmap.alignment.graph import (
    SCALE,
    Edge,
    Solver,
    deviations,
    information,
    residuals,
    solve,
    stack,
)
from segmap.alignment.graph._graph import REAL
from segmap.alignment.pose_graph._key_frames import KeyFrame, KeyFrames
from segmap.angles import wrap
from segmap.poses import between, compose
from segmap.testing import assert_poses_equal

#: Standard deviations of a measured motion, metres and radians.
SPREAD = np.array([0.02, 0.03, 0.01])


def ring(count: int = 12, chords: int = 6, seed: int = 0) -> tuple[np.ndarray, Edge]:
    """Poses on a circle, and the exact motions between neighbours and along some chords."""
    rng = np.random.default_rng(seed)
    t = 2 * np.pi * np.arange(count) / count
    poses = np.stack([5 * np.cos(t), 5 * np.sin(t), wrap(t + np.pi / 2)], -1)
    first = np.r_[np.arange(count - 1), rng.integers(0, count // 3, chords)]
    second = np.r_[np.arange(1, count), rng.integers(count // 2, count, chords)]
    weights = np.array([np.diag(1 / (SPREAD * rng.uniform(0.5, 2, 3)) ** 2) for _ in first])
    turn = np.array([(0.8, -0.6, 0), (0.6, 0.8, 0), (0, 0, 1)])  # x and y are correlated
    weights = turn @ weights @ turn.T
    return poses, Edge(first, second, between(poses[first], poses[second]), weights)


def noisy(edges: Edge, seed: int = 1, factor: float = 1.0) -> Edge:
    error = np.random.default_rng(seed).normal(0, factor * SPREAD, edges.relative.shape)
    return edges._replace(relative=edges.relative + error)


def chained(edges: Edge, count: int, start: np.ndarray) -> np.ndarray:
    """Poses by the steps alone, as a robot without loops would have them."""
    poses = [start]
    for k in range(count - 1):
        poses.append(compose(poses[-1], edges.relative[k]))
    return np.array(poses)


@pytest.mark.parametrize("scale", [SCALE, np.inf])
def test_each_step_is_that_of_the_plain_loops(scale):
    """A block of the matrix in the wrong place, a weight that is squared: it may still converge."""
    truth, edges = ring(12, 8)
    edges = noisy(edges, factor=4.0)
    poses = chained(edges, len(truth), truth[0])
    assert deviations(poses, edges).max() > 2 * SCALE  # the loss is not just a square
    for _ in range(3):
        plain = literal.gauss_newton(poses, list(zip(*edges[:4], strict=True)), scale)
        before, kept = poses, poses.copy()
        poses = solve(poses, edges, rounds=1, scale=scale).poses
        assert_poses_equal(poses, plain, atol=1e-9)
        np.testing.assert_array_equal(before, kept)
        np.testing.assert_array_equal(poses[0], truth[0])


def test_headings_are_compared_the_short_way_round():
    """A robot that turns on and on: without wrapping an edge across the seam tears the map."""
    motion, first = np.array([0.5, 0.0, 1.0]), np.arange(12)
    edges = Edge(first, first + 1, np.tile(motion, (12, 1)), np.tile(np.eye(3), (12, 1, 1)))
    poses = chained(edges, 13, np.zeros(3))
    full_turns = edges.relative + np.outer(first % 3 - 1, (0, 0, 2 * np.pi))
    np.testing.assert_allclose(residuals(poses, edges._replace(relative=full_turns)), 0, atol=1e-9)
    found = solve(poses + (0, 0, 0.01), edges).poses
    np.testing.assert_allclose(between(found[:-1], found[1:]), edges.relative, atol=1e-6)


def test_information_never_claims_more_than_real_scans_allow():
    """A covariance of zero would make one edge as hard as a rock."""
    found = np.linalg.inv(information(np.zeros((3, 3))))
    np.testing.assert_allclose(np.sqrt(np.diag(found)), (0.02, 0.02, np.radians(0.3)))
    wide = np.diag([1.0, 0.01, 0.04])
    np.testing.assert_allclose(np.linalg.inv(information(wide)), wide + REAL)


# ------------------------------------------------------------------ a graph solved again
#: Once round a square of 2 m: every second scan is a key frame.
TURN = np.array((1.0, 0.0, np.pi / 4))
SQUARE = Edge(None, None, np.tile(TURN, (7, 1)), None)
POSES = chained(SQUARE, 8, np.array((3.0, 1.0, 0.5)))
#: The wheels turn too far at each step; the first pose is right.
DRIFTED = chained(SQUARE._replace(relative=SQUARE.relative + (0, 0, 0.03)), 8, POSES[0])
EDGES = np.array([(0, 2), (2, 4), (4, 6), (6, 0)])
MOTIONS = between(POSES[EDGES[:, 0]], POSES[EDGES[:, 1]])


@pytest.mark.parametrize("scale", [3.0, np.inf])
def test_exact_motions_give_exact_key_frames_and_others_stay_beside_them(scale):
    """Exchanged ends of an edge; scans hung on the key frame that follows, or left behind."""
    found = solve_graph(DRIFTED, EDGES, MOTIONS, scale=scale)
    assert_poses_equal(found[::2], POSES[::2], atol=1e-4)
    assert_poses_equal(between(found[::2], found[1::2]), between(DRIFTED[::2], DRIFTED[1::2]))


def test_a_pose_graph_solved_again_stays():
    """Catches a graph that keeps other ends, motions or weights than it was solved from."""
    found = pose_graph(load("corridor")[:150])
    kept = found.graph
    again = solve_graph(found.poses, kept.edges, kept.relative, information=kept.information)
    assert_poses_equal(again, found.poses, atol=1e-4)
    assert_poses_equal(solve_graph(found.poses, [], []), found.poses)


# ------------------------------------------------------------------ the solver


def world(count: int = 150, seed: int = 4, far: int = 0) -> tuple[np.ndarray, Edge]:
    """Poses by noisy steps three times round a square of 60 m, and loops to the rounds before.

    `far` steps of 10 m lead there.
    """
    rng = np.random.default_rng(seed)
    step = np.tile((1.2, 0.0, 0.0), (count - 1, 1))
    step[far + 12 :: 13, 2] = np.pi / 2
    step[:far, 0] = 10.0
    truth = chained(Edge(None, None, step, None), count, np.zeros(3))
    late = np.arange(far + 52, count, 3)
    first, second = np.r_[np.arange(count - 1), late - 52], np.r_[np.arange(1, count), late]
    relative = between(truth[first], truth[second]) + rng.normal(0, SPREAD / 3, (len(first), 3))
    information = np.tile(np.diag(1 / SPREAD**2), (len(first), 1, 1))
    edges = Edge(first, second, relative, information)
    return chained(edges, count, np.zeros(3)), edges


def part(edges: Edge, chosen: np.ndarray) -> Edge:
    return Edge(*(np.asarray(field)[chosen] for field in edges[:4]))


@pytest.mark.parametrize("lazily", [True, False])
def test_edges_that_come_in_lead_to_the_poses_of_all_at_once(lazily):
    """Catches a column that an added edge changes and that is kept, or a pose without a column.

    Far from the first pose: stale equations that turn the map to and fro about it take 17 rounds.
    """
    start, edges = world(700, far=100)
    last = np.maximum(edges.first, edges.second)
    solver, poses = Solver(SCALE), start[:1]
    for k in range(1, 700):
        poses = np.vstack([poses, compose(poses[-1], edges.relative[k - 1])])
        solver.add(part(edges, last == k))
        if k >= 152 and k % 20 == 0:
            poses, _, rounds = solver.solve(poses, lazily=lazily)
            assert rounds <= 6
    poses = solver.solve(poses).poses
    assert_poses_equal(poses, solve(start, edges).poses, atol=3e-5)


def test_only_what_a_loop_changes_is_computed_again():
    """Catches a solver that begins anew with each loop: a drive then costs n^2."""
    start, edges = world(2000)
    steps = edges.second - edges.first == 1
    held = steps | (edges.second < 1950)
    counts = []
    for lazily in (False, True):
        solver = Solver(SCALE)
        solver.add(part(edges, held))
        poses, _, _ = solver.solve(start)
        before = solver.columns
        solver.add(part(edges, ~held))
        counts.append((solver.solve(poses, lazily=lazily).rounds, solver.columns - before))
    (rounds, columns), (_, lazy) = counts
    assert columns == 2000 * rounds and lazy < columns / 3


def test_it_says_whether_it_converged():
    """Rounds that are used up in silence: the poses look like any others."""
    start, edges = world()
    assert not solve(start, edges, rounds=2).converged
    found = solve(start, edges)
    assert found.converged and 2 < found.rounds < 12
    assert_poses_equal(solve(found.poses, edges).poses, found.poses, atol=1e-5)


def test_edges_that_say_nothing_change_nothing():
    """An edge from a pose to itself, one between poses that are both held, one of no weight."""
    start, edges = world()
    more = np.array([(5, 5), (0, 0), (3, 90)])
    relative, weight = np.ones((3, 3)), np.array([np.eye(3), np.eye(3), np.zeros((3, 3))])
    padded = Edge(
        np.r_[more[:, 0], edges.first],
        np.r_[more[:, 1], edges.second],
        np.vstack([relative, edges.relative]),
        np.concatenate([weight, edges.information]),
    )
    assert_poses_equal(solve(start, padded).poses, solve(start, edges).poses, atol=1e-6)


def test_a_pose_that_may_slide_along_a_wall_is_refused_at_every_angle():
    """Catches a pivot that rounding leaves above nought, which then counts as information."""
    for angle in np.linspace(0.05, 3.1, 40):
        across = np.array([np.cos(angle), np.sin(angle), 0.0])
        weight = 400 * np.outer(across, across) + np.diag([0, 0, 3e3])
        solver, motion = Solver(SCALE), np.array([(1.0, 0.3, 0.2)])
        solver.add(Edge(np.array([0]), np.array([1]), motion, weight[None]))
        with pytest.raises(np.linalg.LinAlgError, match="leaves pose 1 free"):
            solver.solve(np.array([(0, 0, 0), (0.9, 0.2, 0.1)]))


def test_a_pose_that_only_the_bend_of_the_loss_leaves_free_is_solved_for():
    """Two edges that contradict each other, bent, weigh a tenth: beside a sure one, rounding."""
    edges, aside = [(0, 1), (0, 1), (1, 2)], 0.95 * SCALE
    motions, start = [(aside, 0, 0), (-aside, 0, 0), (0, 0, 0)], [(0, 0, 0), (0.01, 0, 0)]
    known = np.array([1.0, 1.0, 2.0**49])[:, None, None] * np.eye(3)
    solved = solve_graph([*start, start[1]], edges, motions, information=known)
    np.testing.assert_allclose(solved, 0.0, atol=0.005)


def test_key_frames_hand_edges_over_that_are_new_and_begin_anew_where_some_were_undone():
    """Catches a solver that still holds a loop that was taken out, or an edge of a scan undone."""
    start, edges = world(120)
    frames = KeyFrames()
    frames.add(KeyFrame(0, np.zeros((3, 2))), np.zeros(3), np.eye(3))
    each = [Edge(*fields) for fields in zip(*edges[:4], strict=True)]
    for edge in each[:119]:
        frames.add(KeyFrame(edge.second, np.zeros((3, 2))), edge.relative, np.eye(3))
    wrong = Edge(0, 80, np.array((9.0, 9.0, 1.0)), 100 * np.eye(3), True)
    for chosen in ([*each[:119], wrong, *each[119:]], each, [*each[:130], wrong], each[:131]):
        frames.edges = chosen
        frames.optimize(lazily=True)
        kept = frames._solver
        frames.optimize()
        assert frames._solver is kept  # nothing was undone
        found, converged, _ = solve(start, stack(chosen))
        assert converged
        assert_poses_equal(frames.poses, found, atol=2e-5)


@pytest.mark.parametrize("more", [2, 7])
def test_what_a_free_pose_left_undone_is_done_once_an_edge_fixes_it(more):
    """Catches a solver that forgets what it still has to compute where its factor grows."""
    start, edges = world(130)
    last, solver = np.maximum(edges.first, edges.second), Solver(SCALE)
    solver.add(part(edges, last < 100))
    poses = solver.solve(start[:100], lazily=True).poses
    poses = np.vstack([poses, compose(poses[-1], between(start[99], start[100:]))])
    solver.add(part(edges, last == 100)._replace(information=np.zeros((1, 3, 3))))
    with pytest.raises(np.linalg.LinAlgError):
        solver.solve(poses[:101], lazily=True)
    solver.add(part(edges, (last >= 100) & (last < 100 + more)))
    found = solver.solve(poses[: 100 + more], lazily=True)
    wanted = solve(start[: 100 + more], part(edges, last < 100 + more)).poses
    assert found.converged
    assert_poses_equal(found.poses, wanted, atol=3e-5)
