"""Robust least squares over poses: against scipy, finite differences and exact graphs."""

import numpy as np
import pytest
from segmap.alignment._solver import Edges, deviations, residuals, solve

from segmap.alignment import _solver as solver
from segmap.angles import wrap
from segmap.poses import between, compose

#: Standard deviations of a measured motion, metres and radians.
SPREAD = np.array([0.02, 0.03, 0.01])


def ring(count: int = 12, chords: int = 6, seed: int = 0) -> tuple[np.ndarray, Edges]:
    """Poses on a circle, and the exact motions between neighbours and along some chords."""
    rng = np.random.default_rng(seed)
    t = 2 * np.pi * np.arange(count) / count
    poses = np.stack([5 * np.cos(t), 5 * np.sin(t), wrap(t + np.pi / 2)], -1)
    first = np.r_[np.arange(count - 1), rng.integers(0, count // 3, chords)]
    second = np.r_[np.arange(1, count), rng.integers(count // 2, count, chords)]
    weights = np.array([np.diag(1 / (SPREAD * rng.uniform(0.5, 2, 3)) ** 2) for _ in first])
    turn = np.array([(0.8, -0.6, 0), (0.6, 0.8, 0), (0, 0, 1)])  # x and y are correlated
    weights = turn @ weights @ turn.T
    return poses, Edges(first, second, between(poses[first], poses[second]), weights)


def noisy(edges: Edges, seed: int = 1, factor: float = 1.0) -> Edges:
    error = np.random.default_rng(seed).normal(0, factor * SPREAD, edges.relative.shape)
    return edges._replace(relative=edges.relative + error)


def chained(edges: Edges, count: int, start: np.ndarray) -> np.ndarray:
    """Poses by the steps alone, as a robot without loops would have them."""
    poses = [start]
    for k in range(count - 1):
        poses.append(compose(poses[-1], edges.relative[k]))
    return np.array(poses)


def cost(poses: np.ndarray, edges: Edges) -> float:
    """Half the sum of Cauchy losses of whole edges, each by the length of its residual."""
    total = 0.0
    for i, j, relative, weight in zip(*edges, strict=True):
        left = between(poses[i], poses[j]) - relative
        left[2] = (left[2] + np.pi) % (2 * np.pi) - np.pi
        total += 0.5 * solver.SCALE**2 * np.log1p(left @ weight @ left / solver.SCALE**2)
    return total


def slope(poses: np.ndarray, edges: Edges) -> np.ndarray:
    """Gradient of the cost by every coordinate, by finite differences."""
    found = np.empty(poses.shape)
    for place in np.ndindex(*poses.shape):
        step = np.zeros(poses.shape)
        step[place] = 1e-6
        found[place] = (cost(poses + step, edges) - cost(poses - step, edges)) / 2e-6
    return found


def test_exact_motions_give_the_exact_poses():
    """A composition the wrong way round, a sign of a derivative: the ring would not close."""
    truth, edges = ring()
    start = truth + np.random.default_rng(2).normal(0, 0.3, truth.shape) * (truth != truth[0])
    start[0] = truth[0]
    found = solve(start, edges)
    np.testing.assert_allclose(between(truth, found), 0, atol=1e-5)
    np.testing.assert_allclose(residuals(found, edges), 0, atol=1e-5)


def test_the_gradient_is_zero_at_the_solution():
    """Weights that are squared or left out lead to another place than the least cost."""
    truth, edges = ring()
    edges = noisy(edges, factor=4.0)
    assert deviations(truth, edges).max() > 2 * solver.SCALE  # the loss is not just a square
    found = solve(chained(edges, len(truth), truth[0]), edges, rounds=200)
    assert np.abs(slope(found, edges)).max() < 1e-4 * np.abs(slope(truth, edges)).max()


def test_the_derivatives_are_those_of_the_residuals():
    truth, edges = ring()
    poses = truth + np.random.default_rng(3).normal(0, 0.2, truth.shape)
    by_first, by_second = solver._derivatives(poses, edges)
    for k in range(3):
        for ends, expected in ((edges.first, by_first), (edges.second, by_second)):
            found = np.empty_like(edges.relative)
            for m, end in enumerate(ends):
                step = np.zeros(poses.shape)
                step[end, k] = 1e-6
                one = Edges(*(np.asarray(part)[m : m + 1] for part in edges))
                found[m] = (residuals(poses + step, one) - residuals(poses - step, one))[0] / 2e-6
            np.testing.assert_allclose(expected[:, :, k], found, atol=1e-6)


def test_the_first_pose_stays():
    truth, edges = ring()
    start = chained(noisy(edges), len(truth), np.array([7.0, -3.0, 2.0]))
    found = solve(start, noisy(edges))
    np.testing.assert_array_equal(found[0], start[0])
    assert np.abs(found - start).max() > 0.01
    assert start is not found


def test_the_solution_moves_with_the_first_pose():
    """An angle that is taken in the world's axes."""
    truth, edges = ring()
    edges = noisy(edges)
    world = np.array([-40.0, 25.0, 2.6])
    start = chained(edges, len(truth), truth[0])
    once, moved = solve(start, edges), solve(compose(world, start), edges)
    np.testing.assert_allclose(between(compose(world, once), moved), 0, atol=1e-5)
    np.testing.assert_allclose(deviations(once, edges), deviations(moved, edges), atol=1e-3)


def test_headings_are_compared_the_short_way_round():
    """A robot that turns on and on: without wrapping an edge across the seam tears the map."""
    motion = np.array([0.5, 0.0, 1.0])
    poses = np.array([(0.0, 0.0, 0.0)])
    for _ in range(12):
        poses = np.vstack([poses, compose(poses[-1], motion)])
    first = np.arange(12)
    edges = Edges(first, first + 1, np.tile(motion, (12, 1)), np.tile(np.eye(3), (12, 1, 1)))
    full_turns = edges.relative + np.outer(first % 3 - 1, (0, 0, 2 * np.pi))
    np.testing.assert_allclose(residuals(poses, edges._replace(relative=full_turns)), 0, atol=1e-9)
    found = solve(poses + (0, 0, 0.01), edges)
    np.testing.assert_allclose(between(found[:-1], found[1:]), edges.relative, atol=1e-6)


def test_a_false_loop_hardly_counts():
    """Plain least squares would fold the ring: measured 5 m, with the Cauchy loss 0.4 mm."""
    truth, edges = ring(chords=8)
    false = Edges(
        np.append(edges.first, 1),
        np.append(edges.second, 7),
        np.vstack([edges.relative, (0.1, 0.1, 0.1)]),
        np.concatenate([edges.information, np.diag(1 / SPREAD**2)[None]]),
    )
    found = solve(truth, false)
    assert np.abs(found - truth)[:, :2].max() < 0.02
    assert deviations(found, false)[-1] > 100
    assert deviations(found, false)[:-1].max() < 1


def test_noise_is_averaged():
    """The loops must pull the chain of steps nearer to the truth."""
    truth, edges = ring(count=60, chords=60)
    edges = noisy(edges)
    start = chained(edges, 60, truth[0])
    found = solve(start, edges)
    far = [np.hypot(*(poses - truth)[:, :2].T).max() for poses in (start, found)]
    assert far[1] < 0.5 * far[0]


@pytest.mark.parametrize("seed", range(3))
def test_equal_to_scipy(seed):
    """The same cost, minimised by somebody else: residuals whose squares are the Cauchy loss."""
    from scipy.optimize import least_squares

    truth, edges = ring(count=8, seed=seed)
    edges = noisy(edges, seed, factor=3.0)
    start = chained(edges, 8, truth[0])
    whitened = np.linalg.cholesky(edges.information).transpose(0, 2, 1)

    def lossy(free: np.ndarray) -> np.ndarray:
        poses = np.vstack([start[:1], free.reshape(-1, 3)])
        left = np.einsum("mij,mj->mi", whitened, residuals(poses, edges))
        square = np.maximum((left**2).sum(1), 1e-12) / solver.SCALE**2
        return (left * np.sqrt(np.log1p(square) / square)[:, None]).ravel()

    theirs = least_squares(lossy, start[1:].ravel(), xtol=1e-12, ftol=1e-12, gtol=1e-12)
    ours = solve(start, edges, rounds=200)
    assert cost(ours, edges) == pytest.approx(theirs.cost, rel=1e-6)
    np.testing.assert_allclose(between(ours[1:], theirs.x.reshape(-1, 3)), 0, atol=1e-3)


def test_information_never_claims_more_than_real_scans_allow():
    """A covariance of zero would make one edge as hard as a rock."""
    found = np.linalg.inv(solver.information(np.zeros((3, 3))))
    np.testing.assert_allclose(np.sqrt(np.diag(found)), (0.02, 0.02, np.radians(0.3)))
    wide = np.diag([1.0, 0.01, 0.04])
    np.testing.assert_allclose(np.linalg.inv(solver.information(wide)), wide + solver.REAL)


def test_two_poses_and_one_edge():
    edges = Edges(np.array([0]), np.array([1]), np.array([(1.0, 2.0, 3.0)]), np.eye(3)[None])
    found = solve(np.zeros((2, 3)), edges)
    np.testing.assert_allclose(found, [(0, 0, 0), (1, 2, 3)], atol=1e-5)
