"""Rooms, rays, sensors, odometry and the logs made of them."""

import itertools
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from segmap import simulation
from segmap.angles import wrap
from segmap.poses import between, transform
from segmap.segments import point_distance
from segmap.simulation import (
    SICK_LMS200,
    URG_04LX,
    OdometryNoise,
    Sensor,
    cast_rays,
    drifting_odometry,
    drive,
    measure,
    simulate,
)

ALL_ROUND = np.linspace(-np.pi, np.pi, 360, endpoint=False)
STILL = OdometryNoise().ideal()


def literal_ranges(walls, pose, angles):
    """For each beam and wall solve pose + r * beam = start + share * (end - start)."""
    found = np.full(len(angles), np.inf)
    for i, turn in enumerate(angles + pose[2]):
        beam = np.array([np.cos(turn), np.sin(turn)])
        for start, end in walls:
            matrix = np.stack([beam, start - end], 1)
            if abs(np.linalg.det(matrix)) < 1e-12:
                continue
            r, share = np.linalg.solve(matrix, start - pose[:2])
            if r > 1e-9 and 0 <= share <= 1:
                found[i] = min(found[i], r)
    return found


def scattered_walls(rng, count=30):
    return rng.uniform(-4, 4, (count, 1, 2)) + rng.uniform(-1, 1, (count, 2, 2))


# ------------------------------------------------------------------------- rays
def test_ranges_equal_the_linear_system_solved_pair_by_pair():
    """Catches a wrong determinant, swapped coordinates, a heading left out."""
    rng = np.random.default_rng(1)
    walls, pose = scattered_walls(rng), np.array([0.3, -0.2, 0.7])
    expected = literal_ranges(walls, pose, ALL_ROUND)
    assert np.isinf(expected).any() and np.isfinite(expected).any()
    np.testing.assert_allclose(cast_rays(walls, pose, ALL_ROUND), expected, atol=1e-9)


WALL = [(1.0, -1.0), (1.0, 1.0)]


@pytest.mark.parametrize(
    ("walls", "degrees", "expected"),
    [
        pytest.param([WALL], [0, 180], [1, np.inf], id="behind: the sign of the range is lost"),
        pytest.param([[(1, 1), (5, 1)]], [0], [np.inf], id="parallel: a wall is an endless line"),
        pytest.param([[(1, 0), (2, 0)], [(3, -1), (3, 1)]], [0], [3], id="edge on, one behind"),
        pytest.param([[(1, 0), (1, 1)]], [0], [1], id="its first end point"),
        pytest.param([[(1, -1), (1, 0)]], [0], [1], id="its second end point"),
        pytest.param([], [0, 90], [np.inf, np.inf], id="no walls"),
        pytest.param([[(1, 0), (1, 0)]], [0, 57], [np.inf, np.inf], id="a wall without length"),
    ],
)
def test_what_a_beam_meets(walls, degrees, expected):
    """From the origin; the same with the end points of every wall swapped."""
    for ends in (walls, [wall[::-1] for wall in walls]):
        assert cast_rays(ends, (0, 0, 0), np.radians(degrees)).tolist() == expected


@given(st.integers(0, 10_000), st.integers(3, 40))
def test_no_beam_slips_through_a_shared_corner(seed, sides):
    """Catches an end test with rounding: aimed straight at every corner of a closed room."""
    rng = np.random.default_rng(seed)
    centre, turn = rng.uniform(-50, 50, 2), rng.uniform(0, 7)
    room = transform((*centre, turn), simulation.circular_room(1.0, sides=sides) - 1.0)
    pose = np.array([*centre + rng.uniform(-0.3, 0.3, 2), rng.uniform(-4, 4)])
    to_corner = room[:, 0] - pose[:2]
    aim = np.arctan2(to_corner[:, 1], to_corner[:, 0]) - pose[2]
    np.testing.assert_allclose(
        cast_rays(room, pose, aim), np.hypot(*to_corner.T), rtol=0, atol=1e-9
    )


def test_a_wall_that_is_touched_is_not_met_and_one_at_the_maximum_range_is():
    """Catches a robot that touches a wall and sees nothing but zeros."""
    found = cast_rays(simulation.square_room(4), (2, 0, 0), np.radians([0, 90, 180, -90]))
    np.testing.assert_allclose(found, [2, 4, 2, np.inf], rtol=1e-12)
    assert cast_rays([WALL], (0, 0, 0), [0.0], max_range=1.0).tolist() == [1.0]
    assert cast_rays([WALL], (0, 0, 0), [0.0], max_range=0.999).tolist() == [np.inf]


# ---------------------------------------------------------------------- sensors


def measured(exact, incidence=1.0, seed=1, *, sensor=SICK_LMS200, **changed):
    exact = np.asarray(exact, float)
    incidence = np.broadcast_to(incidence, exact.shape)
    rng = np.random.default_rng(seed)
    return measure(exact, incidence, sensor=replace(sensor, **changed), rng=rng)


def test_errors_have_their_stated_size():
    """Catches a bias, another share of lost beams, and ranges cut where they should be rounded."""
    error = measured(np.full(40_000, 3.0), seed=5, resolution=0.0) - 3
    assert abs(error.std() / 0.010 - 1) < 0.02 and abs(error.mean()) < 2e-4
    far = measured(np.full(40_000, 3.0), seed=5, sigma=0.005, range_share=0.006, resolution=0.0)
    assert abs(far.std() / 0.023 - 1) < 0.02
    lost = np.isinf(measured(np.full(20_000, 2.0), seed=6, sensor=URG_04LX, dropout=0.05))
    assert abs(lost.mean() - 0.05) < 0.005
    np.testing.assert_allclose(measured([1.004, 1.006, 2.0], sigma=0.0), [1.00, 1.01, 2.0])


def test_faults_come_back_as_infinity_or_nan_never_as_a_wall():
    exact, incidence = [0.01, 5.0, np.inf, 2.0, 2.0], [1, 1, np.nan, 0.05, 0.2]
    found = measured(exact, incidence, sensor=URG_04LX.ideal(), min_range=0.02, grazing=0.1)
    np.testing.assert_array_equal(found, [np.nan, np.inf, np.inf, np.inf, 2.0])
    far = measured(np.full(500, 3.999), seed=7, sensor=URG_04LX)  # noise lifts some too far
    assert np.isinf(far).any() and far[np.isfinite(far)].max() < URG_04LX.max_range


def test_an_ideal_sensor_draws_as_much_as_a_real_one():
    """Catches comparisons of two sensors that in truth compare two streams of chance."""
    left = []
    for sensor in (URG_04LX, URG_04LX.ideal()):
        rng = np.random.default_rng(8)
        measure(np.ones(50), np.ones(50), sensor=sensor, rng=rng)
        left.append(rng.random())
    assert left[0] == left[1]


# ----------------------------------------------------------------------- driving
@given(
    st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=2, max_size=6),
    st.floats(0.1, 2),
    st.floats(0.1, 2),
)
def test_a_drive_passes_every_way_point_in_steps_of_bounded_size(points, step, turn):
    points = [p for p, _ in itertools.groupby(points)]
    if len(points) < 2:
        return
    path = drive(points, step=step, turn=turn)
    motion = between(path[:-1], path[1:])
    assert np.hypot(*motion[:, :2].T).max() <= step + 1e-9
    assert np.abs(motion[:, 2]).max() <= turn + 1e-9
    assert np.abs(path[:, 2]).max() <= np.pi
    for point in points:
        assert np.hypot(*(path[:, :2] - point).T).min() < 1e-9
    np.testing.assert_allclose(path[[0, -1], :2], [points[0], points[-1]], atol=1e-9)


def test_a_drive_looks_where_it_goes_and_turns_the_shorter_way():
    """Catches a turn of 270 degrees to the left for one of 90 to the right."""
    path = drive([(0, 0), (-1, 0.01), (-1.01, -1)], step=0.1, turn=0.1)
    motion = between(path[:-1], path[1:])
    moving = np.hypot(*motion[:, :2].T) > 1e-9
    np.testing.assert_allclose(motion[moving, 1], 0, atol=1e-9)
    assert motion[moving, 0].min() > 0
    assert np.abs(motion[:, 2]).sum() < np.radians(100)


# ---------------------------------------------------------------------- odometry
def drifted(path, noise, seed=1):
    return drifting_odometry(path, odometry_noise=noise, rng=np.random.default_rng(seed))


def heading_errors(path, noise, runs=400):
    found = [drifted(path, noise, seed)[-1, 2] for seed in range(runs)]
    return wrap(np.array(found) - path[-1, 2])


def test_odometry_without_noise_returns_the_path():
    """Catches motions composed in the wrong order, and a motion sideways that is mirrored."""
    path = np.random.default_rng(9).uniform(-3, 3, (20, 3))
    found = drifted(path, STILL)
    np.testing.assert_allclose(found[:, :2], path[:, :2], atol=1e-9)
    np.testing.assert_allclose(wrap(found[:, 2] - path[:, 2]), 0, atol=1e-9)


@pytest.mark.parametrize("pieces", [2, 50])
@pytest.mark.parametrize(("column", "noise"), [(2, "turn_noise"), (0, "heading_noise")])
def test_the_size_of_the_drift_does_not_depend_on_how_finely_the_path_is_cut(pieces, column, noise):
    """Catches noise that is added per pose, whatever the way between poses."""
    path = np.zeros((pieces + 1, 3))
    path[:, column] = np.linspace(0, 1, pieces + 1)
    errors = heading_errors(path, replace(STILL, **{noise: 0.03}))
    assert abs(errors.std() / 0.03 - 1) < 0.12


def test_the_bias_stretches_all_turns_of_a_run_alike():
    path = np.zeros((5, 3))
    path[:, 2] = (0, 0.5, 1.0, 0.5, 1.5)
    found = drifted(path, replace(STILL, turn_bias=0.03), 3)
    ratio = found[1:, 2] / path[1:, 2]
    assert abs(ratio[0] - 1) > 1e-4
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)


def test_distance_noise_has_its_stated_size():
    path = np.zeros((21, 3))
    path[:, 0] = np.linspace(0, 4, 21)
    ends = [drifted(path, replace(STILL, distance_noise=0.01), seed)[-1, 0] for seed in range(400)]
    assert abs(np.std(ends) / (0.01 * np.sqrt(4)) - 1) < 0.12


# ------------------------------------------------------------------------- logs
def simulated(walls, path, sensor=URG_04LX, seed=1, **settings):
    return simulate(walls, path, sensor=sensor, rng=np.random.default_rng(seed), **settings)


def test_points_of_an_ideal_log_lie_on_the_walls():
    """Catches a sensor pose that is left out, applied twice or composed the wrong way round."""
    walls, path = simulation.rectangular_room(4, 3), drive([(1, 1), (2, 1.5), (3, 1)], step=0.4)
    log = simulated(walls, path, URG_04LX.ideal(), sensor_pose=(0.145, 0.03, 0.2))
    for scan, pose in zip(log, log.truth, strict=True):
        seen = transform(pose, scan.points())
        assert point_distance(seen[:, None], walls).min(axis=1).max() < 1e-9


def test_a_log_carries_times_truth_and_odometry():
    path = drive([(1, 1), (3, 1), (3, 2)])
    log = simulated(simulation.rectangular_room(), path, SICK_LMS200)
    np.testing.assert_allclose(log.times, 0.2 * np.arange(len(path)))
    np.testing.assert_array_equal(log.truth, path)
    assert np.abs(log.odometry - path)[1:].max() > 1e-4
    assert log[0].max_range == SICK_LMS200.max_range and len(log[0]) == 181


def test_the_same_seed_gives_the_same_log_and_another_seed_another():
    path = drive([(1, 1), (3, 1)], step=0.5)
    first, again, other = (simulated(simulation.square_room(), path, seed=k) for k in (1, 1, 2))
    for a, b, c in zip(first, again, other, strict=True):
        np.testing.assert_array_equal(a.ranges, b.ranges)
        assert not np.array_equal(a.ranges, c.ranges)
    np.testing.assert_array_equal(first.odometry, again.odometry)


def test_grazing_beams_of_a_log_are_lost_and_steep_ones_kept():
    """Catches an angle taken to the wall's normal, or forgetting the robot's heading."""
    sensor = Sensor("fan", 37, -np.pi / 2, np.pi / 36, max_range=100, grazing=np.radians(7))
    for heading in (np.pi / 2, 0.0):
        log = simulated([[(-50, 1), (50, 1)]], [(0, 0, heading)], sensor, odometry_noise=STILL)
        towards = wrap(sensor.angles + heading)
        steep = (towards > np.radians(7)) & (towards < np.radians(173))
        np.testing.assert_array_equal(log[0].valid, steep)


def test_a_laser_that_turns_while_the_robot_moves():
    """Catches beams that wait for the next pose, a turn the wrong way; a last scan that stands."""
    moving = partial(simulate, moving=True, rng=np.random.default_rng(1))
    sensor = Sensor("half", 90, 0.0, np.radians(2), max_range=9.0, period=0.5)
    headings, steps = (0.0, 0.2, 0.6), (0.2, 0.4, 0.4)
    path = [(1, 2, heading) for heading in headings]
    log = moving(simulation.square_room(4), path, sensor=sensor)
    turned = np.arange(90) / 180  # shares of a period, of which half a turn takes the half
    for scan, heading, step in zip(log, headings, steps, strict=True):
        np.testing.assert_allclose(scan.delays, 0.5 * turned)
        aim = sensor.angles + heading + step * turned
        expected = cast_rays(simulation.square_room(4), (1, 2, 0), aim)
        np.testing.assert_allclose(scan.ranges, expected, atol=1e-12)
    ahead = moving(simulation.square_room(4), [(1, 2, 0), (2, 2, 0)],
                     sensor=replace(sensor, beams=2, step=2 * np.pi / 3), sensor_pose=(0.5, 0, 0),
                     odometry_noise=OdometryNoise().ideal())  # fmt: skip
    assert ahead[0].ranges[0] == pytest.approx(2.5)
    aim = np.radians(120)
    assert ahead[1].ranges[1] == pytest.approx(2 / np.sin(aim)) and ahead[1].time == 0.5
    assert moving(simulation.square_room(4), path[:1], sensor=sensor)[0].delays is None
