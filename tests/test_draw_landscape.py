"""Pictures of matching: profiles, fields, trials."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from segmap.course import Trial, draw_field, draw_profile, draw_trials
from segmap.matching import DistanceField
from segmap.plotting import ERROR, RESULT
from segmap.quadtree import QuadtreeMap


@pytest.fixture
def ax():
    return Figure().subplots()


def test_a_profile_is_in_degrees_and_its_peaks_are_red(ax):
    """Catches radians on an axis of degrees, and dots that are not on the line."""
    draw_profile(np.radians([-90, 0, 90, 180]), [1, 3, 0, 2], ax=ax)
    line, dots = ax.lines
    np.testing.assert_allclose(line.get_xydata(), [(-90, 1), (0, 3), (90, 0), (180, 2)])
    np.testing.assert_allclose(dots.get_xydata(), [(0, 3), (180, 2)])
    assert line.get_color() == RESULT and dots.get_color() == ERROR


def test_a_profile_without_its_peaks(ax):
    assert len(draw_profile([0, 1], [0, 1], ax=ax, tops=False).lines) == 1


def test_a_field_lies_where_its_window_is(ax):
    """Catches rows upside down, x for y, and a bar without its unit."""
    map = QuadtreeMap(resolution=0.5, size=8)
    map.insert_scan((1, 1), [(3.25, 1.25)])
    field = DistanceField(map, (2, 1, 4, 2))
    draw_field(field, ax=ax)
    (image,), (_, bar) = ax.images, ax.figure.axes
    left, right, low, high = image.get_extent()
    assert (left, low, right, high) == field.bounds and image.origin == "lower"
    assert image.get_array()[0, 2] == 0 and (image.get_array() == field.distance).all()
    assert bar.get_ylabel() == "distance [m]"


def test_trials_have_a_mark_a_matcher_and_the_thesis_is_red(ax):
    one = Trial("it", "hill climbing", "field", 0, 0.013, 0.03, 0.01, 900, 800, 0.1)
    two, lost = replace(one, median=0.02), replace(one, matcher="hill climbing, thesis")
    draw_trials([one, lost, two], ax=ax)
    assert [line.get_label() for line in ax.lines] == ["hill climbing", "hill climbing, thesis"]
    assert [line.get_color() for line in ax.lines] == [RESULT, ERROR]
    assert ax.lines[0].get_marker() != ax.lines[1].get_marker()
    np.testing.assert_allclose(ax.lines[0].get_xydata(), [(900, 13), (900, 20)])
