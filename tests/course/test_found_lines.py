"""Ways to find a line, a match by distributions in cells, and hints that any exercise may give."""

import numpy as np
import pytest
import segmap_course as course
from segmap_course import LINE_FINDERS, literal

from segmap.poses import between, transform
from segmap.readers import load
from segmap.segments import point_distance

WALL = np.linspace(0.02, 2.98, 60)[:, None]
NOISE = np.random.default_rng(1).normal(0, 0.005, (120, 2))
CORNER = np.concatenate([WALL * (-1, 0) + (3, 0), WALL * (0, 1)]) + NOISE


@pytest.mark.parametrize("turn", [0.0, 1.0])
@pytest.mark.parametrize("name", [name for name in LINE_FINDERS if name != "clusters"])
def test_two_walls_of_a_corner_are_found_wherever_they_lie(name, turn):
    """Catches a slope in the place of an angle, a grid that loses a wall, points used twice."""
    frame = (2.0, -1.0, turn)
    found = LINE_FINDERS[name](transform(frame, CORNER))
    walls = transform(frame, np.array([[(3.0, 0.0), (0, 0)], [(0, 0), (0, 3)]]))
    assert course.near_metres(walls, found) > 5.5
    assert point_distance(found.reshape(-1, 2)[:, None], walls).min(1).max() < 0.05


@pytest.mark.parametrize("name", LINE_FINDERS)
def test_no_points_and_few_points_are_no_line(name):
    assert LINE_FINDERS[name](np.zeros((0, 2))).shape == (0, 2, 2)
    assert len(LINE_FINDERS[name](np.array([(0.0, 0.0), (3.0, 1.0)]))) == 0


def test_cells_bring_a_scan_to_its_place_from_coarse_to_fine():
    """Catches a step the wrong way, a covariance that is not inverted, a grid that is not moved."""
    log = load("room")
    true = between(log.truth[20], log.truth[22])
    pose = true + (0.3, 0.3, 0.1)
    for side in (2.0, 1.0, 0.5):
        pose = literal.match_ndt(literal.normals_of(log[20].points(), side), log[22].points(), pose)
        pose = pose[-1]
    assert np.abs(between(true, pose)).max() < 0.003


@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("resampled", lambda right: np.asarray(right) + 1, "count from 0"),
        ("axial_mean", lambda right: -right, "the sign is the other way round"),
        ("mean_wall_error", lambda right: 1000 * right, "a thousand times"),
        ("cell_of", lambda right: np.asarray(right)[1:], "the first one is missing"),
        ("quality", lambda right: 1 - right, "1 minus the answer"),
        ("edge_error", lambda right: 2 * right, "twice the answer"),
    ],
)
def test_what_is_right_but_for_a_unit_a_sign_or_a_count_is_told(name, change, said):
    """Catches a student who reads two numbers, and not what is between them."""
    exercise = course.EXERCISES[name]
    found = exercise(lambda *given: change(exercise.solution(*given)))
    assert not found and said in found.hint
