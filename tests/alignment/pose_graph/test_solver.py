"""The solver of pose graphs: against dense matrices, as edges come in, and what it says of it."""

import numpy as np
import pytest
from test_graph import SPREAD, chained, noisy, ring

from segmap.alignment import solve_graph
from segmap.alignment.graph._graph import SCALE, Edge, residuals, solve, stacked
from segmap.alignment.graph._solver import Solver
from segmap.alignment.pose_graph._key_frames import KeyFrames
from segmap.angles import wrap
from segmap.poses import between, compose
from segmap.testing import assert_poses_equal


def dense(poses: np.ndarray, edges: Edge, scale: float) -> np.ndarray:
    """One step with a dense matrix, its derivatives by differences of the residuals."""
    m, n, eps = len(edges.first), len(poses), 1e-6
    ends = np.concatenate([poses[edges.first], poses[edges.second]])
    apart = edges._replace(first=np.arange(m), second=m + np.arange(m))
    jacobian = np.zeros((m, 3, n, 3))
    for side, end in enumerate((edges.first, edges.second)):
        for k in range(3):
            ahead, behind = ends.copy(), ends.copy()
            ahead[side * m :, k][:m] += eps
            behind[side * m :, k][:m] -= eps
            found = wrap(residuals(ahead, apart) - residuals(behind, apart))
            jacobian[np.arange(m), :, end, k] += found / (2 * eps)
    r, jacobian = residuals(poses, edges), jacobian.reshape(m, 3, 3 * n)[:, :, 3:]
    square = np.einsum("mi,mij,mj->m", r, edges.information, r)
    weighted = jacobian.transpose(0, 2, 1) @ edges.information
    weighted /= (1 + square / scale**2)[:, None, None]
    move = np.linalg.solve((weighted @ jacobian).sum(0), -np.einsum("maj,mj->a", weighted, r))
    return poses + np.r_[np.zeros(3), move].reshape(-1, 3)


def shuffled(poses: np.ndarray, edges: Edge, seed: int) -> tuple[np.ndarray, Edge, np.ndarray]:
    """The same graph with its poses numbered anew (the first stays), its edges in another order."""
    rng = np.random.default_rng(seed)
    number = np.r_[0, 1 + rng.permutation(len(poses) - 1)]
    order = rng.permutation(len(edges.first))
    moved = poses.copy()
    moved[number] = poses
    first, second, *rest = (np.asarray(field)[order] for field in edges[:4])
    return moved, Edge(number[first], number[second], *rest), number


def world(count: int = 150, seed: int = 4) -> tuple[np.ndarray, Edge]:
    """Poses by noisy steps three times round a square of 60 m, and loops to the rounds before."""
    rng = np.random.default_rng(seed)
    step = np.tile((1.2, 0.0, 0.0), (count - 1, 1))
    step[12::13, 2] = np.pi / 2
    truth = chained(Edge(None, None, step, None), count, np.zeros(3))
    late = np.arange(52, count, 3)
    first, second = np.r_[np.arange(count - 1), late - 52], np.r_[np.arange(1, count), late]
    relative = between(truth[first], truth[second]) + rng.normal(0, SPREAD / 3, (len(first), 3))
    information = np.tile(np.diag(1 / SPREAD**2), (len(first), 1, 1))
    edges = Edge(first, second, relative, information)
    return chained(edges, count, np.zeros(3)), edges


def part(edges: Edge, chosen: np.ndarray) -> Edge:
    return Edge(*(np.asarray(field)[chosen] for field in edges[:4]))


@pytest.mark.parametrize("scale", [SCALE, np.inf])
def test_the_minimum_is_that_of_dense_matrices(scale):
    """A column that is not gathered, a row of the factor that is lost: steps that go elsewhere."""
    truth, edges = ring(12, 8)
    edges = noisy(edges, factor=2.0)
    found = plain = chained(edges, len(truth), truth[0])
    found = solve(found, edges, scale=scale).poses
    for _ in range(30):  # each ends where a step is below 1e-5
        found = solve(found, edges, scale=scale).poses
    for _ in range(60):
        plain = dense(plain, edges, scale)
    assert_poses_equal(found, plain, atol=1e-9)


def test_neither_the_order_of_edges_nor_the_numbers_of_poses_matter():
    """Catches rows that are missing where the order of elimination is another one."""
    start, edges = world()
    found = solve(start, edges).poses
    for seed in range(3):
        other, mixed, number = shuffled(start, edges, seed)
        assert_poses_equal(solve(other, mixed).poses[number], found, atol=1e-5)
    both = Edge(*(np.concatenate([field, field]) for field in edges[:4]))
    plain, twice = (solve(start, e, scale=np.inf).poses for e in (edges, both))
    assert_poses_equal(twice, plain, atol=1e-5)


@pytest.mark.parametrize("lazily", [True, False])
def test_edges_that_come_in_lead_to_the_poses_of_all_at_once(lazily):
    """Catches a column that an added edge changes and that is kept, or a pose without a column."""
    start, edges = world(600)
    last = np.maximum(edges.first, edges.second)
    solver, poses = Solver(SCALE), start[:1]
    for k in range(1, 600):
        poses = np.vstack([poses, compose(poses[-1], edges.relative[k - 1])])
        solver.add(part(edges, last == k))
        if k >= 52 and k % 20 == 0:
            poses, converged, _ = solver.solve(poses, lazily=lazily)
            assert converged
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


@pytest.mark.parametrize("free", [(0, 0, 0), (1, 0, 1), (1, 1, 0)])
def test_a_pose_that_information_leaves_free_is_refused(free):
    """A pivot that is rounding and taken for a number throws the pose far away."""
    edges, motions = [(0, 1), (1, 2)], [(1, 0, 0.3), (1, 0.2, 0.1)]
    weights = np.array([np.eye(3), np.diag(np.array(free, float))])
    with pytest.raises(ValueError, match="leaves some of them free"):
        solve_graph(np.zeros((3, 3)), edges, motions, information=weights)


def test_key_frames_hand_edges_over_that_are_new_and_begin_anew_where_some_were_undone():
    """Catches a solver that still holds a loop that was taken out, or an edge of a scan undone."""
    start, edges = world(120)
    frames = KeyFrames(np.zeros((3, 2)), np.zeros(3))
    each = [Edge(*fields) for fields in zip(*edges[:4], strict=True)]
    for edge in each[:119]:
        frames.add(edge.second, np.zeros((3, 2)), edge.relative, np.eye(3))
    wrong = Edge(0, 80, np.array((9.0, 9.0, 1.0)), 100 * np.eye(3), True)
    for chosen in ([*each[:119], wrong, *each[119:]], each, [*each[:130], wrong], each[:131]):
        frames.edges = chosen
        frames.optimize(lazily=True)
        frames.optimize()
        found = solve(start, stacked(chosen)).poses
        assert frames.converged
        assert_poses_equal(frames.poses, found, atol=2e-5)
