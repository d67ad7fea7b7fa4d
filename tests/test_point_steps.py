"""The steps of point ICP that chapter 34 shows are those that the matcher makes."""

from itertools import pairwise

import numpy as np
import pytest

from segmap import load
from segmap.alignment import match_points, point_steps
from segmap.poses import transform

LOG = load("malaga")
BEFORE, NOW = LOG[20].points(), LOG[23].points()


@pytest.mark.parametrize("start", [(0, 0, 0), (0.4, -0.3, 0.1), (1.0, 0.2, -0.3), (3, 3, 1)])
@pytest.mark.parametrize("reach", [0.3, 0.6, 2.0])
def test_the_steps_end_where_the_match_does(start, reach):
    """Catches steps that drift away from the compiled loop: another stride, reach or end."""
    steps = point_steps(BEFORE, NOW, start, reach=reach)
    found = match_points(BEFORE, NOW, start, reach=reach)
    np.testing.assert_allclose(steps[0].pose, start, atol=1e-15)
    if found.matched:
        np.testing.assert_allclose(steps[-1].pose, found.pose, atol=1e-12)
        assert len(steps) > 2 and steps[-1].reach == pytest.approx(0.12)
    assert steps[0].reach == reach
    assert all(a.reach >= b.reach for a, b in pairwise(steps))


def test_points_are_those_of_the_scan_and_feet_lie_across_the_wall():
    """Catches points of another row, feet on the far side of a point, and offsets of partners."""
    wall = np.array([(0.05 * k, 1.0) for k in range(60)])
    pose = np.array([0.02, 0.3, 0.0])
    step = point_steps(wall, wall + (0.0, 0.0), pose)[0]
    placed = transform(pose, wall)
    assert all(np.hypot(*(placed - p).T).min() < 1e-12 for p in step.points)
    np.testing.assert_allclose(step.feet[:, 1], 1.0, atol=1e-12)
    np.testing.assert_allclose(step.feet[:, 0], step.points[:, 0], atol=1e-12)
    np.testing.assert_allclose(step.offsets, 0.3, atol=1e-12)


def test_a_point_far_off_the_others_weighs_little():
    """Catches weights of another order than the points."""
    wall = np.array([(0.05 * k, 0.0) for k in range(100)])
    now = wall + (0, 0.01)
    now[[20, 60], 1] = 0.5
    step = point_steps(wall, now)[0]
    far = step.offsets > 0.4
    assert far.sum() == 2 and step.weights[far].max() < 0.1 < step.weights[~far].min()


def test_nothing_near_is_one_step_and_too_few_points_are_none():
    wall = np.array([(0.05 * k, 0.0) for k in range(100)])
    (only,) = point_steps(wall, wall, (50, 50, 0))
    assert len(only.points) == len(only.feet) == len(only.weights) == len(only.offsets) == 0
    assert point_steps(wall[:5], wall) == point_steps(wall, wall[:5]) == []


def test_a_step_shows_itself_in_one_line():
    """Catches the default repr of a tuple of arrays, which fills a page."""
    text = repr(point_steps(BEFORE, NOW)[0])
    assert text.startswith("PointStep(0 m, 0 m, 0 deg, ") and "\n" not in text


def test_bad_points_are_refused_as_by_the_matcher():
    with pytest.raises(ValueError, match="current must be finite"):
        point_steps(BEFORE, [(np.nan, 0)] * 9)
