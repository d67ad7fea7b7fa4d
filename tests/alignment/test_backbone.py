"""Backbone: headings from the lines of an orthogonal building, and where it has none."""

import alignment_logs as logs
import numpy as np
import pytest
from conftest import slow

from segmap.alignment import backbone, backbone_steps
from segmap.alignment.backbone._backbone import Thresholds, _Backbone
from segmap.alignment.backbone._lines import (
    NO_WALLS,
    Lines,
    Walls,
    least_translation,
    merged_into_walls,
    parallels,
    support_lines,
    turn_pose,
)
from segmap.angles import axial_difference, wrap
from segmap.poses import between, compose, transform
from segmap.segments import angle, length
from segmap.simulation import (
    SICK_LMS200,
    URG_04LX,
    OdometryNoise,
    circular_room,
    drive,
    polyline,
    rectangular_room,
    simulate,
)

#: A room that looks different along x and y, and a way through it without a symmetry.
ROOM = rectangular_room(9.0, 7.0)
WAY = drive([(2.0, 1.5), (4.5, 1.5)], step=0.5)
SICK = SICK_LMS200.ideal()


def straight(walls=ROOM, path=WAY, sensor=SICK):
    """A log without any error."""
    rng = np.random.default_rng(1)
    return simulate(walls, path, sensor=sensor, rng=rng, odometry_noise=OdometryNoise().ideal())


def misled(log, k, error):
    """The log with one wrong odometry step, into scan k."""
    odometry = log.odometry.copy()
    wrong = compose(odometry[k], error)
    odometry[k:] = compose(wrong, between(odometry[k], odometry[k:]))
    return logs.changed(log, odometry=odometry)


def ring(radius, width=2.0, share=0.8):
    turn = np.linspace(0, 2 * np.pi * share, int(720 * share))
    circle = np.stack([np.cos(turn), np.sin(turn)], -1)
    way = np.arange(0.02, turn[-1] - 0.05, 0.2 / (radius - width / 2))
    r = radius - width / 2
    path = np.stack([r * np.cos(way), r * np.sin(way), wrap(way + np.pi / 2)], -1)
    return np.concatenate([polyline(radius * circle), polyline((radius - width) * circle)]), path


def corridor_about(corners, radius=12.0, width=2.0):
    turn = 2 * np.pi * np.arange(corners) / corners
    circle = np.stack([np.cos(turn), np.sin(turn)], -1)
    walls = [polyline(r * circle, closed=True) for r in (radius, radius - width)]
    return np.concatenate(walls), drive(
        (radius - width / 2) * np.concatenate([circle, circle[:1]]), step=0.2
    )


FEW = ("ring of 4 m", "ring of 30 m", "triangle", "octagon", "round hall")
NOT_ORTHOGONAL = {
    "ring of 4 m": ring(4.0),
    "ring of 8 m": ring(8.0),
    "ring of 30 m": ring(30.0, share=0.2),
    "triangle": corridor_about(3),
    "pentagon": corridor_about(5),
    "octagon": corridor_about(8),
    "round hall": (circular_room(8.0), drive([(4, 4), (12, 4), (12, 12), (4, 12)], step=0.2)),
}


@pytest.mark.parametrize("sensor", [SICK_LMS200, URG_04LX], ids=lambda s: s.name)
@pytest.mark.parametrize("name", [n if n in FEW else slow(n) for n in NOT_ORTHOGONAL])
def test_it_says_so_where_the_building_is_not_orthogonal(name, sensor):
    """Catches a method that bends a curved building straight and is content."""
    walls, path = NOT_ORTHOGONAL[name]
    log = simulate(walls, path, sensor=sensor, rng=np.random.default_rng(1))
    found = backbone(log)
    assert found.doubt.startswith("the assumption fails")
    assert found.doubt in repr(found)
    assert not found.used[1:].any()
    assert all(reason == found.doubt for reason in found.reasons[1:])
    np.testing.assert_allclose(found.poses, log.odometry, atol=1e-9)


def test_a_gentle_bend_is_doubted():
    """Walls of one scan look straight there: only the steady correction tells."""
    walls, path = ring(60.0, share=0.1)
    log = simulate(walls, path, sensor=SICK_LMS200, rng=np.random.default_rng(1))
    assert backbone(log).doubt.startswith("the assumption is doubtful")


# The slips of A 5.2, each made visible by one wrong odometry step in a log without other errors.

TURNED = (0.0, 0.0, np.radians(1.5))


def test_segments_are_turned_before_they_move_the_robot_and_moved_before_they_are_learned():
    """Slips: a wrong heading alone would move the robot, and be brought into the backbone."""
    log = misled(straight(), 3, TURNED)
    walk = _Backbone(log, Thresholds())
    step = [walk.step(k, scan) for k, scan in enumerate(log)][3]
    assert not step.reason
    np.testing.assert_allclose(step.pose, log.truth[3], atol=1e-3)
    tilt = np.abs(axial_difference(2 * angle(walk.walls.segments), 0)) / 2
    assert len(walk.walls.segments) == 3
    assert np.degrees(tilt.max()) < 0.1


def test_a_correction_is_carried_by_the_odometry_and_made_once():
    """Slips: lost as soon as nothing matches, or used again there."""
    log = logs.blind(misled(straight(), 3, (0.0, 0.05, np.radians(1.5))), 4)
    steps = backbone_steps(log)
    assert steps[3].rotation < -0.02
    assert steps[4].reason == "no segment longer than 1 m" and steps[4].rotation == 0.0
    np.testing.assert_array_equal(steps[4].pose, steps[4].guess)
    np.testing.assert_allclose(steps[4].pose, log.truth[4], atol=2e-3)


CORRIDOR = np.array([[(0, 0), (60, 0)], [(0, 2), (60, 2)]], float)


def test_a_corridor_does_not_fix_the_motion_along_it():
    """Without the minimum norm the shift along the walls is singular, or invented."""
    path = drive([(20.0, 0.8), (24.0, 0.8)], step=0.5)
    log = misled(straight(CORRIDOR, path), 4, (0.15, 0.1, 0.0))
    found = backbone(log)
    assert found.used[4:].all()
    np.testing.assert_allclose(found.poses[4:, 1], 0.8, atol=1e-3)
    np.testing.assert_allclose(found.poses[4:, 0], log.truth[4:, 0] + 0.15, atol=1e-3)


# The method, step by step.


def test_scans_taken_while_turning_and_near_ones_are_not_used():
    log = straight(ROOM, drive([(2, 2), (4, 2), (4, 4)], step=0.1, turn=np.radians(10)))
    found = backbone(log)
    turning = np.abs(wrap(np.diff(log.truth[:, 2], prepend=0))) > np.radians(5)
    assert turning.sum() == 9
    assert {found.reasons[k] for k in np.flatnonzero(turning)} == {"taken while turning"}
    way = np.hypot(*np.diff(found.poses[found.used, :2], axis=0).T)
    assert way.min() >= 0.25
    assert "less than 0.25 m from the last scan used" in found.reasons


def test_the_backbone_is_rebuilt_after_a_relevant_rotation_only():
    """Catches a backbone built anew at every scan, with all the drift since the last turn."""
    log = straight(ROOM, drive([(2, 2), (4, 2), (6, 2.6), (6, 5)], step=0.5))
    for threshold, headings in ((30, [0, 90]), (10, [0, 17, 90])):
        steps = backbone_steps(log, rotation=np.radians(threshold))
        found = np.degrees([step.guess[2] for step in steps if step.rebuilt])
        np.testing.assert_allclose(found, headings, atol=0.5)


def test_parallels_look_at_directions_only():
    lines = Lines(np.zeros((2, 2)), np.radians([1.0, 91.0]))
    far = np.array([[(50, 50), (60, 49.9)], [(50, 50), (50, 60)], [(0, 0), (1, 1)]], float)
    assert parallels(far, lines, np.radians(10)).tolist() == [0, 1, -1]


@pytest.mark.parametrize("apart", [2.0, 15.0])
def test_translation_of_nearly_parallel_lines_is_not_blown_up(apart):
    """Two walls 2 degrees apart would put a centimetre of noise 0.6 m along the corridor."""
    angles = np.radians([0.0, apart])
    normals = np.stack([-np.sin(angles), np.cos(angles)], -1)
    found = least_translation(normals, np.array([0.01, -0.01]), np.ones(2))
    assert np.hypot(*found) < 0.011


def test_a_new_line_takes_the_direction_of_an_older_one():
    """And keeps its own place, and a wall beyond `parallel` its own direction."""
    tilted = transform((0, 5, np.radians(3)), [[(0, 0), (4, 0)]])
    askew = transform((0, 9, np.radians(30)), [[(0, 0), (3, 0)]])
    walls = Walls(np.concatenate([tilted, askew]), np.array([4.0, 3.0]))
    lines, known = support_lines(walls, np.array([0.0]), 0.1, np.radians(5))
    np.testing.assert_allclose(np.degrees(lines.angle), [0, 30])
    np.testing.assert_allclose(np.degrees(known), [0, 30])
    np.testing.assert_allclose(lines.through, walls.segments.mean(1))


def test_a_new_line_across_takes_the_normal_of_an_older_one():
    """Catches two directions for one building: the second corridor would keep the drift."""
    across = transform((0, 5, np.radians(92)), [[(0, 0), (4, 0)]])
    lines, known = support_lines(Walls(across, np.ones(1)), np.array([0.0]), 0.1, np.radians(5))
    np.testing.assert_allclose(np.degrees(lines.angle), [90])
    assert len(known) == 1


def test_a_direction_of_its_own_needs_a_long_wall():
    """Catches a chord across a door that becomes a direction and turns the robot by ten degrees."""
    chord = transform((0, 5, np.radians(10)), [[(0, 0), (1.1, 0)]])
    for weight, count in ((1.1, 0), (3.3, 1)):
        walls = Walls(chord, np.array([weight]))
        found = support_lines(walls, np.array([0.0]), 0.1, np.radians(5), least=3.0)
        assert (len(found[0].angle), len(found[1])) == (count, 1 + count)


def test_a_chord_does_not_pull_at_the_walls_beside_it():
    """One difference out of three is eight degrees off: the mean of all would be 0.9."""
    off, sizes = np.radians([0.1, -0.1, 8.0]), np.cbrt([4.0, 4.0, 1.0])  # weights are cubes
    walls = [transform((0, 0, -t), [(0, 0), (s, 0)]) for t, s in zip(off, sizes, strict=True)]
    given = np.zeros(3), np.array(walls), Lines(np.zeros((1, 2)), np.zeros(1)), np.zeros(3, int)
    left, pulled = (turn_pose(*given, np.radians(parallel))[2] for parallel in (5, 9))
    assert abs(left) < 1e-12 and pulled > np.radians(0.8)


def test_walls_on_one_line_make_one_line():
    walls = Walls(
        np.array([[(0, 0), (2, 0)], [(5, 0.05), (9, 0.05)], [(0, 1), (1, 1)]]), np.ones(3)
    )
    lines, known = support_lines(walls, np.empty(0), 0.1, np.radians(5))
    assert len(lines.angle) == 2
    assert len(known) == 1


def test_the_direction_of_a_new_family_is_the_mean_of_its_walls():
    """Catches the direction of one wall alone: the first backbone turns all that follow."""
    walls = [transform((0, y, np.radians(t)), [(0, 0), (3, 0)]) for y, t in ((0, 1), (2, -1))]
    _, known = support_lines(Walls(np.array(walls), np.ones(2)), np.empty(0), 0.1, np.radians(5))
    assert np.degrees(axial_difference(known[0], 0)) == pytest.approx(0, abs=1e-9)


def test_pieces_of_one_wall_are_merged_and_others_are_not():
    """Two walls on one line with a door between, or side by side, stay two."""
    first = merged_into_walls(NO_WALLS, np.array([[(0, 0), (2, 0)]]), 0.1, np.radians(5))
    pieces = np.array([[(3, 0.04), (1, 0.04)], [(2.1, 0), (3.05, 0)]])
    found = merged_into_walls(first, pieces, 0.1, np.radians(5))
    assert len(found.segments) == 1
    assert length(found.segments)[0] == pytest.approx(3.05, abs=0.01)
    assert found.weight[0] == pytest.approx(4.95)
    others = np.array([[(2.5, 0), (3, 0)], [(0, 0.15), (2, 0.15)], [(0, 0), (0, 1)]])
    assert len(merged_into_walls(first, others, 0.1, np.radians(5)).segments) == 4


# Bad input.
