"""What a pose graph says of itself: scans that are not sure, and why."""

from dataclasses import replace

import alignment_logs as logs
import numpy as np
import pytest
from numpy.linalg import inv

from segmap.alignment import Alignment, Tracking, Unmatched, point_icp, pose_graph
from segmap.alignment.graph import REAL, SCALE, Edge, place_deviations, residuals, stack
from segmap.poses import between, compose
from segmap.scans import Log

#: Matches between walls that are flat and noise of the beams alone.
FLAT = Tracking(match_error=0.002, match_turn_error=np.radians(0.03))


def chain(count: int, *loops: tuple[int, int]) -> tuple[np.ndarray, list[Edge]]:
    """Poses on a half circle, a step from each to the next, and loops: 2 cm and 0.3 degrees."""
    turn = np.linspace(0, np.pi, count)
    poses = np.stack([5 * np.sin(turn), 5 - 5 * np.cos(turn), turn], -1)
    sure = np.diag(1 / np.array([0.02, 0.02, np.radians(0.3)]) ** 2)
    ends = [(k, k + 1, False) for k in range(count - 1)] + [(*loop, True) for loop in loops]
    return poses, [Edge(i, j, between(poses[i], poses[j]), sure, loop) for i, j, loop in ends]


def literal_spread(poses, edges: Edge, weight: np.ndarray, reach: float = np.inf) -> np.ndarray:
    """By the inverse of the whole matrix, and projections that take rigid motions out."""
    n, tiny = len(poses), 1e-5 * np.eye(3 * len(poses))
    jacobian = np.stack(
        [residuals(poses + one.reshape(n, 3), edges) - residuals(poses, edges) for one in tiny], -1
    )
    jacobian = jacobian / 1e-5
    hessian = np.einsum("mia,mij,mjb->ab", jacobian, edges.information, jacobian, optimize=True)
    covariance = np.zeros_like(hessian)
    covariance[3:, 3:] = np.linalg.inv(hessian[3:, 3:])
    places = np.delete(np.arange(3 * n), np.arange(2, 3 * n, 3))
    covariance = covariance[np.ix_(places, places)]
    across = np.stack([-poses[:, 1], poses[:, 0]], -1).ravel()
    rigid = np.stack([np.tile([1.0, 0], n), np.tile([0, 1.0], n), across], -1)
    found = []
    for k in range(n):
        near = np.hypot(*(poses[:, :2] - poses[k, :2]).T) <= reach
        share = np.repeat(weight * near, 2)
        fit = rigid @ np.linalg.solve(rigid.T * share @ rigid, rigid.T * share)
        left = np.eye(2 * n) - fit
        found.append(np.diag(left @ covariance @ left.T).reshape(n, 2)[k].sum())
    return np.sqrt(found)


@pytest.mark.parametrize("reach", [np.inf, 4.0])
@pytest.mark.parametrize("loops", [[], [(0, 29)], [(0, 20), (5, 29)]])
def test_spread_is_that_of_the_inverse(loops, reach):
    """Rigid motions left in, a covariance for an information, weights of scans forgotten."""
    poses, edges = chain(30, *loops)
    weight = np.r_[np.ones(15), np.full(15, 4.0)]
    near, exact = (
        f(poses, stack(edges), weight, reach=reach) for f in (place_deviations, literal_spread)
    )
    drawn = near[reach < np.inf]  # in the whole, and within reach
    np.testing.assert_allclose(drawn, exact, rtol=0.35)
    assert abs((drawn / exact).mean() - 1) < 0.15
    there = compose(np.array([40.0, -3.0, 2.0]), poses)
    moved = place_deviations(there, stack(edges), weight, reach=reach)[reach < np.inf]
    np.testing.assert_allclose(moved, drawn, rtol=1e-6)


def test_a_loop_left_open_by_six_deviations_ties_a_fifth():
    """Catches a Cauchy weight by the deviation over its scale, and not by the square of that."""
    poses, edges = chain(30, (0, 29))
    *steps, loop = edges
    bent = loop._replace(relative=loop.relative + (6 * 0.02, 0, 0))
    less = loop._replace(information=loop.information / (1 + (6 / SCALE) ** 2))
    found, expected = (
        place_deviations(poses, stack([*steps, e]), np.ones(30))[0] for e in (bent, less)
    )
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_sure_is_what_is_used_and_within_half_a_metre():
    """Catches one standard deviation in the place of two, and scans that are sure and not used."""
    far = np.array([0.1, 0.3, 1.2, 0.1, 0.1])
    found = Alignment(np.zeros((5, 3)), np.array([1, 1, 0, 0, 1], bool), 0.0, spread=far)
    assert found.sure.tolist() == [True, False, False, False, True]
    assert found.locally_sure.tolist() == found.used.tolist()


def test_rooms_are_known_in_a_building_that_is_not():
    """Catches one bit against the whole map: of 300 m no scan was sure, but rooms are right."""
    steps = [Edge(k, k + 1, np.array([0.5, 0.0, 0.0]), inv(REAL)) for k in range(600)]
    poses = np.arange(601)[:, None] * (0.5, 0.0, 0.0)
    far, near = place_deviations(poses, stack(steps), np.ones(601), reach=20.0)
    found = Alignment(poses, np.ones(601, bool), 0.0, spread=far, local_spread=near)
    assert found.sure.mean() < 0.5 and found.locally_sure.all()


@pytest.mark.parametrize("method", [pose_graph, point_icp])
def test_the_spread_is_that_of_flat_walls_where_they_are_supposed(method):
    """Catches a floor of the errors of real buildings that nobody can lower: 84 mm for 3.8."""
    log = logs.exact_log()
    told = [method(log, tracking=tracking) for tracking in (Tracking(), FLAT)]
    off = [np.sqrt(np.mean(logs.errors(log, each.poses)[0] ** 2)) for each in told]
    real, flat = (np.sqrt(np.mean(each.spread**2)) for each in told)
    assert real > 5 * off[0] and off[1] < 2 * flat < real / 2
    assert told[0].local_spread == pytest.approx(told[0].spread)  # all lie within 20 m


@pytest.mark.parametrize("method", [pose_graph, point_icp])
def test_between_endless_walls_without_odometry_no_scan_is_used(method):
    """6 m short and sure of itself: the walls hold whatever is assumed along them."""
    log = logs.without_odometry(logs.featureless_log())
    found = method(log)
    assert logs.errors(log, found.poses)[0].max() > 1
    assert found.used.tolist() == [True] + [False] * (len(log) - 1)
    assert set(found.unmatched[1:]) == {Unmatched.FREE_DIRECTION}
    assert found.reasons[1] in found.doubt


def test_between_endless_walls_the_wheels_alone_are_not_sure():
    found = pose_graph(logs.featureless_log())
    assert found.used.all() and not found.sure.all()
    far, worst = found.spread, int(found.spread.argmax())
    words = f"{(2 * far > 0.5).sum()} of {len(far)} scans may be more than 0.5 m off"
    assert f"{words}, scan {worst} by {2 * far[worst]:.1f} m" in found.doubt


def test_without_odometry_a_scan_that_did_not_match_starts_no_motion():
    """The last motion went on from false match to false match, 13 m a scan in the Intel log."""
    log = logs.without_odometry(logs.office_log()[:13])
    crowd = [replace(scan, ranges=np.full(len(scan.ranges), 1.0)) for scan in log[10:13]]
    there = pose_graph(Log("crowd", [*log[:10], *crowd])).poses
    np.testing.assert_allclose(there[[11, 12]], there[[10, 10]], atol=1e-9)


def test_without_odometry_a_turn_larger_than_the_window_is_found():
    """Half a turn between two scans: 40 and 80 degrees about the last motion do not hold it."""
    scan = logs.without_odometry(logs.office_log()[8:9])[0]
    turned = replace(scan, angles=scan.angles - 2.6)
    found = pose_graph(Log("turned", [scan, turned]))
    assert found.used.all()
    np.testing.assert_allclose(found.poses[1], (0, 0, 2.6), atol=0.02)
    still = [replace(each, odometry=np.zeros(3)) for each in (scan, turned)]
    assert not pose_graph(Log("wheels", still)).used.all()
