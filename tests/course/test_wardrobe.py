"""The three questions of the story, on the true walls, on every alignment and every reduction."""

import numpy as np
import pytest
import segmap_course as course
from segmap_course import clearance, clinic_walls, measure_clinic

import segmap
from segmap.poses import compose, transform
from segmap.segments import point_distance
from segmap.simulation import box

LOG, WALLS = segmap.load("clinic"), clinic_walls()


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
