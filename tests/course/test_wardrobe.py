"""The three questions of the story, on the true walls, on every alignment and every reduction."""

from functools import cache

import numpy as np
import pytest
import segmap_course as course
from segmap_course import clearance, clinic_walls, measure_clinic

import segmap
from segmap import alignment, reduction
from segmap.extraction import build_map
from segmap.poses import compose, transform
from segmap.segments import point_distance
from segmap.simulation import box

LOG, WALLS = segmap.load("clinic"), clinic_walls()


@cache
def by_alignment():
    """Name of an alignment -> answers of its map, not reduced."""
    poses = {name: method(LOG).poses for name, method in alignment.METHODS.items()}
    return {n: measure_clinic(build_map(LOG, p).filtered(0.1), p) for n, p in poses.items()}


@cache
def by_reduction():
    """Name of a reduction -> answers of the map of the pose graph that it reduced."""
    poses = alignment.pose_graph(LOG).poses
    map = build_map(LOG, poses, keep_points=True).filtered(0.1)
    return {n: measure_clinic(m(map), poses) for n, m in reduction.METHODS.items()}


def test_true_walls_give_true_answers():
    """Catches a tape that ends at a desk, and widths of the corridors that are swapped."""
    answers = measure_clinic(WALLS)
    assert np.allclose([answers.wall, answers.building], [(0.1, 0.001), (9.0, 0.001)])
    assert answers.tapes["left corridor"].metres == pytest.approx(1.2)
    assert answers.tapes["upper corridor"].metres == pytest.approx(1.3)
    assert answers.clearance == pytest.approx((0.1667, 0.001), abs=1e-4)
    assert answers.clearance.sure and "goes round: 16.7" in repr(answers)


@pytest.mark.parametrize(("first", "second"), [(1.2, 1.3), (1.3, 1.2), (0.9, 1.6), (1.0, 1.05)])
def test_the_clearance_is_that_of_a_box_in_a_corner(first, second):
    """Catches a turn that is measured from the other corridor, and half a depth for a whole one."""
    inner, distances = np.array([first, -second]), []
    for turn in np.linspace(0.01, np.pi / 2 - 0.01, 400):
        heading = np.pi / 2 - turn
        middle = compose((0, -2 * np.cos(turn), heading), (1.0, -0.3, 0))
        wardrobe = box(2, 0.6, middle)
        assert wardrobe[..., 0].min() > -1e-9 and wardrobe[..., 1].max() < 1e-9  # touches walls
        side = transform(middle, np.array([[(-9, -0.3), (9, -0.3)]]))  # of which the corner is off
        beyond = np.array([np.sin(heading), -np.cos(heading)]) @ (inner - side[0, 0])
        distances.append(np.copysign(point_distance(inner, side)[0], beyond))
    room, _ = clearance(first, second)
    assert room == pytest.approx(min(distances), abs=1e-3)


def test_a_map_may_lie_anywhere():
    """Catches tapes that are stretched at fixed places, and not where the robot was."""
    place = (5.0, -3.0, 2.0)
    moved = measure_clinic(transform(place, WALLS), compose(place, LOG.truth))
    still = measure_clinic(WALLS)
    for name in ("clearance", "wall", "building"):
        assert getattr(moved, name) == pytest.approx(getattr(still, name), abs=1e-9)


def test_a_wall_that_was_not_seen_cannot_be_told():
    """Catches an answer about what nobody saw, and a wall of no thickness that has one."""
    seen = WALLS[~(WALLS[..., 0] == 0).all(1)]  # without the end wall on the left
    answers = measure_clinic(seen)
    assert not answers.clearance.sure and not answers.building.sure
    assert "wardrobe cannot be told (a wall was not seen)" in repr(answers)
    sides = ((WALLS[..., 0] > 5.3) & (WALLS[..., 0] < 5.45)).all(1) & (WALLS[..., 1] < 4.5).all(1)
    assert "wall cannot be told (0.0 ± 0.1 cm)" in repr(measure_clinic(WALLS[~sides]))


def test_it_cannot_be_told_within_two_deviations():
    """Catches a wardrobe that goes round by less than the tapes differ among themselves."""
    assert course.Measured(0.021, 0.01).sure and course.Measured(-0.021, 0.01).sure
    assert not course.Measured(0.019, 0.01).sure and not course.Measured(-0.019, 0.01).sure
    slanted = np.where((WALLS == (0, 0)).all(-1)[..., None], (-2, 0), WALLS)  # at the left
    assert measure_clinic(slanted).clearance.deviation > 0.01


@pytest.mark.slow
def test_every_alignment_answers():
    """Catches a story that all alignments tell alike, and a pose graph that is none of the best."""
    answers = by_alignment()
    assert len(answers) == 8
    for name in ("ground_truth", "pose_graph", "point_icp"):
        assert abs(answers[name].clearance.metres - 0.167) < 0.015
        assert abs(answers[name].wall.metres - 0.10) < 0.015
        assert abs(answers[name].building.metres - 9.0) < 0.02
    wheels = answers["odometry"]
    assert not wheels.clearance.sure and not wheels.building.sure
    assert sum(abs(a.building.metres - 9.0) > 0.15 for a in answers.values()) >= 3


@pytest.mark.slow
def test_every_reduction_answers():
    """Catches reductions that cannot be told apart by what they do to a thin wall."""
    answers = by_reduction()
    assert set(answers) == set(reduction.METHODS)
    lost = {name for name, a in answers.items() if not a.wall.sure}
    assert {"uncertain_parameters", "fuzzy_set"} <= lost
    for name in ("basic_offline", "basic_online"):  # of a wall of 10 cm
        assert name in lost or answers[name].wall.metres < 0.02
    for name in ("fusion", "least_cost", "one_per_wall"):
        assert abs(answers[name].wall.metres - 0.10) < 0.01 and answers[name].clearance.sure
