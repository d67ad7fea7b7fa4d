"""Segment ICP: A's 2.1 against its literal form, exact recovery, symmetries, honest failure."""

import alignment_logs as logs
import numpy as np
import pytest

from segmap.alignment import match_segments, segment_icp
from segmap.angles import wrap
from segmap.extraction import extract_polylines
from segmap.poses import between, compose, inverse, transform
from segmap.readers import load
from segmap.scans import LaserScan, Log
from segmap.segments import length
from segmap.simulation import (
    SICK_LMS200,
    cast_rays,
    corridor_loop,
    drive,
    rectangular_room,
    simulate,
)

WALLS = logs.OFFICE
ONE_DIRECTION = "walls in one direction only: along them the guess was kept"


def seen(pose) -> np.ndarray:
    """Segments that a laser without error sees of the office, in its frame."""
    scan = LaserScan(cast_rays(WALLS, np.array(pose), SICK_LMS200.angles), SICK_LMS200.angles)
    found = extract_polylines(scan.points())
    return found[length(found) >= 0.30]


@pytest.mark.parametrize("seed", range(5))
def test_recovers_the_motion_between_scans_without_error(seed):
    """A wrong order of composition, a turn about the wrong point, steps that end too early."""
    rng = np.random.default_rng(seed)
    first = np.array([rng.uniform(1.5, 6), rng.uniform(4.8, 5.2), rng.uniform(-3, 3)])
    true = rng.uniform(-0.2, 0.2, 3)
    start = true + rng.uniform(-1, 1, 3) * (0.15, 0.15, np.radians(5))
    found = match_segments(seen(first), seen(compose(first, true)), start)
    assert found.matched, found.reason
    assert np.hypot(*(found.pose - true)[:2]) < 0.002
    assert abs(wrap(found.pose[2] - true[2])) < np.radians(0.01)


@pytest.mark.parametrize("degrees", [-10, -8, 8, 10])
@pytest.mark.parametrize("pair", [(194, 218), (60, 66)])
def test_a_start_that_is_turned_is_turned_back(pair, degrees):
    """Catches a narrow search whose rounds are used up, and which is believed all the same."""
    log = load("clinic")
    first, second = (extract_polylines(log[k].points()) for k in pair)
    true = between(*log.truth[list(pair)])
    match = match_segments(first, second, true + (0.2, 0, np.radians(degrees)))
    x, y, turn = between(true, match.pose)
    assert match.matched and np.hypot(x, y) < 0.01 and abs(turn) < np.radians(0.5)


#: Pairs of scans and starts: without error, with error, and rooms in which much is equal.
NOISE = np.random.default_rng(3)
PAIRS = {
    "office": (seen((2, 5, 0)), seen((2.2, 5.1, 0.1)), (0.25, 0.05, 0.07)),
    "with error": (
        *(seen(p) + NOISE.normal(0, 0.01, seen(p).shape) for p in ((2, 5, 0), (2.2, 5, 0.1))),
        (0.3, -0.05, 0.04),
    ),
    "room": (rectangular_room(4, 3), rectangular_room(4, 3), (0.1, 0.05, 0.03)),
    "corridor": (rectangular_room(20, 2), rectangular_room(20, 2)[::-1], (0.2, 0.1, 0.0)),
}


@pytest.mark.parametrize("turn", [0.7, np.pi / 2, -2.0])
@pytest.mark.parametrize("pair", PAIRS)
def test_frames_and_the_order_of_end_points_mean_nothing(pair, turn):
    """Steps tied to an axis of the world or of the scan; ties that rounding decides."""
    a, b, start = PAIRS[pair]
    plain, world, own = match_segments(a, b, start), (3.0, -2.0, turn), (0.4, 1.0, -turn)
    moved = match_segments(transform(world, a), b, compose(world, start))
    np.testing.assert_allclose(between(compose(world, plain.pose), moved.pose), 0, atol=1e-6)
    turned = np.array(
        [(np.cos(turn), -np.sin(turn), 0), (np.sin(turn), np.cos(turn), 0), (0, 0, 1)]
    )
    covariance = turned @ plain.covariance @ turned.T
    np.testing.assert_allclose(moved.covariance, covariance, rtol=1e-6, atol=1e-9)
    back = inverse(own)
    moved = match_segments(a, transform(own, b), compose(start, back))
    np.testing.assert_allclose(between(compose(plain.pose, back), moved.pose), 0, atol=1e-6)
    swapped = match_segments(a[:, ::-1], b[:, ::-1], start)
    np.testing.assert_allclose(plain.pose, swapped.pose, atol=1e-4)


def test_a_corridor_leaves_its_direction_free():
    """A scan drawn along the corridor by noise, or a corridor taken for a room."""
    walls = np.array([[(0, 0), (20, 0)], [(0, 2), (20, 2)]])
    current = walls + np.random.default_rng(7).normal(0, 0.01, walls.shape)
    found = match_segments(walls, current, (0.7, 0.1, 0.02))
    assert found.matched
    assert found.free is not None
    assert abs(found.free[1]) < 0.01
    assert found.pose[0] == pytest.approx(0.7, abs=0.05)
    assert found.pose[1] == pytest.approx(0.0, abs=0.02)
    assert found.covariance[0, 0] > 1e3 * found.covariance[1, 1]
    room = rectangular_room(20, 2)
    assert match_segments(room, room, (0.1, 0.1, 0.02)).free is None


def test_pieces_of_one_wall_do_not_draw_each_other_along_it():
    """Segments that lie behind each other on one line must not correspond."""
    wall = np.array([[(0, 0), (2, 0)], [(0, 0), (0, 3)]])
    beyond = np.array([[(2.3, 0), (4, 0)], [(0.1, 0), (0.1, 3)]])
    assert match_segments(wall, beyond).overlap == pytest.approx(3 / 4.7)


@pytest.mark.parametrize(
    ("reference", "current", "start", "reason"),
    [
        (WALLS, np.empty((0, 2, 2)), (0, 0, 0), "no segments in the scan"),
        (np.empty((0, 2, 2)), WALLS, (0, 0, 0), "no segments to match with"),
        (WALLS, WALLS, (100, 0, 0), "too few segments found a partner: less than 40%"),
        (WALLS, np.zeros((2, 2, 2)), (0, 0, 0), "no segments in the scan"),
    ],
)
def test_no_match_says_why_and_keeps_the_start(reference, current, start, reason):
    """A NaN, a crash or a pose made up where there is nothing to match."""
    found = match_segments(reference, current, start)
    assert not found.matched
    assert found.reason == reason
    assert found.pose.tolist() == list(start)


# ------------------------------------------------------------------ whole logs
def test_a_kidnapped_robot_begins_a_new_map():
    """A map that is kept for ever: nothing would match again after the robot is carried away."""
    log, rng = logs.exact_log(step=0.2), np.random.default_rng(1)
    path = drive([(1, 1), (4, 1)], step=0.2)
    elsewhere = simulate(corridor_loop(), path, sensor=SICK_LMS200.ideal(), rng=rng)
    far = logs.changed(elsewhere, odometry=compose((30, 0, 0.8), elsewhere.odometry))
    found = segment_icp(Log("two", [*log, *far]), patience=3)
    assert "begins anew" in "".join(found.reasons)
    assert found.used[: len(log)].all()
    assert not found.used[len(log) : len(log) + 3].any()
    assert {*found.reasons[-3:]} <= {"", ONE_DIRECTION}
