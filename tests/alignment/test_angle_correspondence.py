"""Angle correspondence: match values against a literal form, symmetries, accuracy, honesty."""

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import align_to_truth, angle_correspondence, match_angles, position_errors
from segmap.alignment.angle_correspondence._kernels import refine, superpose
from segmap.alignment.angle_correspondence._scenes import corners, is_seen_from_origin, wall_pairs
from segmap.angles import wrap
from segmap.extraction import extract_polylines
from segmap.poses import between, compose, inverse, transform
from segmap.scans import Log
from segmap.simulation import Sensor, drive, office, polyline, rectangular_room, simulate

UTM = Sensor("UTM-30LX", 1081, np.radians(-135), np.radians(0.25), max_range=30.0, sigma=0.01)
ROOM = logs.L_ROOM
OTHER_ROOM = polyline([(0, 0), (2.2, 0), (2.2, 1.6), (6, 1.6), (6, 7), (0, 7)], closed=True)
NO_CORNER = "no two walls of one stand at an angle that the other has too"


def rng(seed=1):
    return np.random.default_rng(seed)


def scene(pose, seed=1, sensor=UTM):
    """Segments that a sensor sees of the room from a pose, in its own frame."""
    log = simulate(ROOM, [pose], sensor=sensor, rng=rng(seed))
    return extract_polylines(log[0].points())


# -------------------------------------------------------------------------- match values


# ------------------------------------------------------------------------------ symmetries
POSE_A, POSE_B = np.array((1.2, 1.0, 0.4)), np.array((2.1, 1.6, 2.9))
MOVES = [
    ((3.0, -2.0, 0.7), (-1.0, 5.0, -2.5)),
    ((0, 0, np.pi / 2), (0, 0, 0)),
    ((50, 80, 3), (0, 9, 1)),
]


@pytest.mark.parametrize("moves", MOVES)
def test_moving_both_sets_moves_the_pose(moves):
    """Catches compositions in the wrong order: pose' = move_a * pose * inverse(move_b)."""
    a, b = scene(POSE_A, 1), scene(POSE_B, 2)
    one = match_angles(a, b, rng=rng(), viewpoints=[(0, 0), (0, 0)])
    there = [np.asarray(move, float) for move in moves]
    seen_from = [move[:2] for move in there]
    two = match_angles(
        transform(there[0], a), transform(there[1], b), rng=rng(), viewpoints=seen_from
    )
    assert one.matched and two.matched
    moved = compose(there[0], compose(one.pose, inverse(there[1])))
    off = between(moved, two.pose)
    assert np.abs(off).max() < 1e-6
    # the covariance turns with the reference; where the current frame moves, a turn moves x and y
    further = compose(one.pose, inverse(there[1])) - one.pose
    carry = np.array([(1, 0, -further[1]), (0, 1, further[0]), (0, 0, 1)])
    turn = np.eye(3)
    turn[:2, :2] = transform((0, 0, there[0][2]), np.eye(2)).T
    expected = turn @ carry @ one.covariance @ carry.T @ turn.T
    np.testing.assert_allclose(two.covariance, expected, rtol=1e-3, atol=1e-9)


@pytest.mark.parametrize(("sizes", "turn"), [((9.0, 0.5), 0), ((0.5, 9.0), -5)])
def test_of_two_corners_the_longer_walls_decide_the_turn(sizes, turn):
    """Catches weights exchanged, or a turn to the other side (A 3.3.1)."""
    i, lean = np.array([(0, 0), (sizes[0], 0)]), np.radians([90, 95])
    walls = [np.stack([i, [(0, 0), (sizes[1] * np.cos(t), sizes[1] * np.sin(t))]]) for t in lean]
    first, second = (corners(both, np.array([[0, 1]])) for both in walls)
    found = np.empty((4, 4))
    count = superpose(first, second, found)
    headings = np.degrees(found[:count, 2])
    assert np.abs(headings - turn).min() < 0.1


def test_refining_brings_a_guess_home():
    """Catches a step or a turn that goes the wrong way, or about another place."""
    rule, room = (0.05, 0.10, 0.30, False), np.empty((2 * len(ROOM) ** 2, 5))
    for guess in ((0.03, -0.02, 0.0), (0.0, 0.0, 0.012), (-0.02, 0.03, -0.008)):
        pose = np.array(guess)
        refine(ROOM, ROOM, pose, rule, room)
        assert np.abs(pose).max() < 1e-4


def test_refining_leaves_a_guess_that_matches_nothing():
    """Catches a turn by a whole radian where no wall says anything."""
    pose, room = np.array([100.0, 0.0, 0.3]), np.empty((2 * len(ROOM) ** 2, 5))
    refine(ROOM, ROOM, pose, (0.05, 0.10, 0.30, False), room)
    assert pose.tolist() == [100.0, 0.0, 0.3]


def test_the_pose_is_that_of_the_current_scan_in_the_reference():
    """Catches the inverse, and a covariance far from the error that is made."""
    errors, spreads = [], []
    for seed in range(12):
        found = match_angles(scene(POSE_A, 2 * seed), scene(POSE_B, 2 * seed + 1), rng=rng())
        assert found.matched and found.free is None and 0.5 < found.overlap <= 1
        off = found.pose - between(POSE_A, POSE_B)
        errors.append([off[0], off[1], wrap(off[2])])
        spreads.append(np.sqrt(np.diag(found.covariance)))
    assert np.abs(errors).max() < 0.03
    ratio = np.sqrt(np.mean(np.square(errors), 0)) / np.mean(spreads, 0)
    assert (ratio > 0.1).all() and (ratio < 3).all()


@pytest.mark.parametrize("heuristic", ["all", "consecutive", "random", "perpendicular"])
def test_end_points_have_no_order(heuristic):
    """Catches a direction taken from the first to the second end point."""
    a, b = scene(POSE_A, 1), scene(POSE_B, 2)
    swapped = np.where(rng().random(len(b))[:, None, None] < 0.5, b[:, ::-1], b)
    for other in (swapped, b[:, ::-1]):
        one = match_angles(a, b, rng=rng(), heuristic=heuristic)
        two = match_angles(a, other, rng=rng(), heuristic=heuristic)
        assert one.matched and two.pose == pytest.approx(one.pose, abs=1e-6)


def test_exchanged_sets_give_the_inverse_and_the_same_generator_the_same_match():
    a, b = scene(POSE_A, 1), scene(POSE_B, 2)
    there, back = match_angles(a, b, rng=rng()).pose, match_angles(b, a, rng=rng()).pose
    assert np.abs(compose(there, back)).max() < 0.01
    found = [match_angles(a, b, rng=rng(7), heuristic="random", most_pairs=6) for _ in range(2)]
    assert np.array_equal(found[0].pose, found[1].pose)


# ------------------------------------------------------------------------------- accuracy


# -------------------------------------------------------------------------------- honesty
def refused(a, b, **options):
    match = match_angles(a, b, rng=rng(), **options)
    assert not match.matched and np.isinf(np.diag(match.covariance)).all()
    assert np.isfinite(match.pose).all()
    return match.reason


def test_a_room_that_could_lie_in_four_ways_and_another_room():
    """A corner of 5 m and 3 m lies in many rooms; that alone is no evidence."""
    square = rectangular_room(4, 4)
    assert refused(square, square) == "another place fits nearly as well"
    assert refused(ROOM, OTHER_ROOM) == "too little of the walls matches"


def test_a_short_stub_does_not_fix_the_way_along_a_corridor():
    corridor = np.array([[(0, 0), (8, 0)], [(0, 2), (8, 2)], [(3, 0), (3, 0.2)]])
    assert refused(corridor[:2], corridor[:2]) == NO_CORNER
    match = match_angles(corridor, corridor, rng=rng(), rival=1.0)
    assert match.reason == "too little wall fixes the motion along the others"


# --------------------------------------------------------------------- pairs and viewpoints
def test_heuristics_choose_the_pairs_of_their_names():
    walls = np.array([[(0, 0), (5, 0)], [(5, 0), (7, 2)], [(7, 2), (7, 6)], [(0, 6), (6.9, 6)]])
    chosen = {
        h: wall_pairs(walls, h, most=2, rng=rng()).tolist()
        for h in ("consecutive", "perpendicular")
    }
    assert chosen["consecutive"] == [[0, 1], [1, 2], [2, 3]]
    assert chosen["perpendicular"] == [[0, 2], [2, 3]]
    assert wall_pairs(walls, "perpendicular", most=1, rng=rng()).tolist() == [[0, 2]]
    drawn = wall_pairs(walls, "random", most=3, rng=rng())
    assert len(drawn) == 3 and [0, 3] not in drawn.tolist()  # parallel
    assert not np.array_equal(drawn, wall_pairs(walls, "random", most=3, rng=rng(4)))


def test_a_scan_is_known_by_the_order_of_its_segments():
    """Catches an origin that is believed wherever the set was moved, which breaks the symmetry."""
    seen = scene(POSE_A)
    assert is_seen_from_origin(seen) and is_seen_from_origin(seen[:, ::-1])
    assert not is_seen_from_origin(seen[::-1])
    assert not is_seen_from_origin(seen - [20, 3])


# ------------------------------------------------------------------------------------ logs
def test_kidnapped_the_scan_before_is_the_reference():
    """After a jump to another room nothing matches the old reference ever again."""
    path = drive([(1, 1), (2, 1.5)], step=0.2)
    here = simulate(ROOM, path, sensor=UTM, rng=rng(1))
    there = simulate(OTHER_ROOM, path + [0, 2, 0], sensor=UTM, rng=rng(2))
    found = angle_correspondence(Log("kidnapped", [*here, *there]))
    jump = len(path)
    assert not found.used[jump] and found.reasons[jump]
    assert found.used[:jump].all() and found.used[jump + 1 :].all()
    steps = between(found.poses[jump:-1], found.poses[jump + 1 :])
    assert steps == pytest.approx(between(path[:-1], path[1:]), abs=0.05)


def test_on_a_growing_map_errors_do_not_add_up_while_the_place_is_known():
    """Catches a map that stays the first scan, and chains laid in the frame of the robot."""
    log = logs.without_odometry(load("malaga")[:60])
    for grow, least, most in ((True, 0.0, 0.3), (False, 0.7, 1.0)):
        found = angle_correspondence(log, grow=grow)
        errors = position_errors(align_to_truth(found.poses, log.truth), log.truth)
        assert found.used.mean() > 0.85 and least < np.nanmax(errors) < most


@pytest.mark.parametrize("seed", range(3))
def test_a_growing_map_of_an_office_is_as_good_as_the_scans(seed):
    """On a building that no threshold was chosen on."""
    chance = rng(seed)
    walls = office(rng=chance, rooms=2)
    path = drive([(1, 5), (2, 5), (2, 7.5), (2, 5), (6, 5)], step=0.3, turn=np.radians(15))
    log = simulate(walls, path, sensor=UTM, rng=chance, odometry_noise=logs.BAD_WHEELS)
    found = angle_correspondence(log, grow=True)
    assert found.used.all() and position_errors(found.poses, log.truth, best=True).max() < 0.05
