"""Headings wrap at a full turn, lines at half a turn."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from segmap.angles import axial_difference, axial_mean, axial_mean_of_two, wrap

ANGLE = st.floats(-50, 50)
WEIGHT = st.floats(0.01, 100)
LINES = st.lists(st.tuples(ANGLE, WEIGHT), min_size=1, max_size=8)


def apart(a, b, period):
    """How far apart two angles are where `period` is nothing."""
    return np.abs(np.angle(np.exp(2j * np.pi * (np.asarray(a) - b) / period))) * period / 2 / np.pi


# ------------------------------------------------------------------------- wrap
@given(ANGLE)
def test_wrap_adds_whole_turns_until_the_angle_is_in_range(angle):
    """Catches the range [0, 2 pi), and half turns taken off."""
    literal = angle
    while literal >= np.pi:
        literal -= 2 * np.pi
    while literal < -np.pi:
        literal += 2 * np.pi
    assert apart(wrap(angle), literal, 2 * np.pi) < 1e-12
    assert -np.pi - 1e-12 <= wrap(angle) <= np.pi + 1e-12


def test_wrap_at_the_seam_keeps_the_lower_end():
    """Catches a range that is open below and closed above; a shape or a NaN that gets lost."""
    found = wrap([[np.pi, -np.pi], [0.0, np.nan], [7.0, -7.0]])
    assert found[0].tolist() == [-np.pi, -np.pi]
    assert found.shape == (3, 2) and np.isnan(found[1, 1])


# ------------------------------------------------------------- axial difference
@given(ANGLE, ANGLE)
def test_axial_difference_is_the_shorter_of_all_turns_that_carry_b_onto_a(a, b):
    """Catches a difference of headings (period of a whole turn), and the wrong sign.

    So half a turn counts for nothing: a segment and its reverse are one line.
    """
    turns = a - b + np.pi * np.arange(-40, 41)
    literal = turns[np.argmin(np.abs(turns))]
    found = axial_difference(a, b)
    assert abs(found) <= np.pi / 2 + 1e-12
    assert abs(found) == pytest.approx(abs(literal), abs=1e-11)
    assert apart(b + found, a, np.pi) < 1e-11


# ------------------------------------------------------------------------ means
@given(st.lists(LINES, min_size=1, max_size=3), st.booleans())
def test_the_mean_is_half_the_angle_of_the_sum_of_the_doubled(rows, weighted):
    """By complex numbers: it turns with its lines, and knows neither order nor directions.

    Catches a plain mean, vectors averaged without doubling, weights that are squared, left out or
    applied to the wrong sum, and a mean along the wrong axis.
    """
    count = min(map(len, rows))
    lines = np.array([row[:count] for row in rows])
    angles, weights = np.moveaxis(lines, -1, 0)
    weights = weights if weighted else np.ones_like(weights)
    sums = np.sum(weights * np.exp(2j * angles), axis=-1)
    assume((np.abs(sums) > 1e-3 * weights.sum(-1)).all())
    found = axial_mean(angles, weights) if weighted else axial_mean(angles)
    assert found.shape == (len(rows),) and (found >= 0).all() and (found < np.pi).all()
    assert apart(found, np.angle(sums) / 2, np.pi).max() < 1e-9


@given(st.floats(-1, 1), st.floats(-0.7, 0.7), WEIGHT, WEIGHT)
def test_the_mean_of_two_lies_at_the_second_ones_share_of_the_way(a, step, weight_a, weight_b):
    """Catches weights exchanged."""
    found = axial_mean_of_two(a, a + step, weight_a, weight_b)
    assert found == pytest.approx((weight_a * a + weight_b * (a + step)) / (weight_a + weight_b))


@pytest.mark.parametrize("angles", [[-1e-20], [np.pi], [-1e-17, 1e-18], [np.pi - 1e-16]])
def test_axial_mean_never_reaches_a_half_turn(angles):
    """A remainder of a tiny negative angle rounds up to pi, which is no angle of `[0, pi)`."""
    assert 0 <= axial_mean(angles) < np.pi
