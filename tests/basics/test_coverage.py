"""Metres invented and missed: what quality does not see."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reduction_maps import MAPS

from segmap.metrics import invented, missed, quality
from segmap.poses import transform
from segmap.segments import length

WALL = np.array([[(0.0, 0.0), (2.0, 0.0)], [(2.5, 0.0), (4.0, 0.0)]])


def alone(map, other, distance: float, angle: float, samples: int = 400) -> float:
    """Points of a map whose normal meets no segment of the other within the distance."""
    metres = 0.0
    for u in map:
        size = float(length(u[None])[0])
        if size < 1e-9:
            continue
        dx, dy = (u[1] - u[0]) / size
        found = np.zeros(samples, bool)
        t = (np.arange(samples) + 0.5) / samples * size
        for v in other:
            vx, vy = v[1] - v[0]
            if np.hypot(vx, vy) < 1e-9:
                continue
            if abs(dx * vy - dy * vx) > np.sin(angle) * np.hypot(vx, vy):
                continue
            p = (v - u[0]) @ np.array([(dx, -dy), (dy, dx)])  # along and across
            share = (t - p[0, 0]) / (p[1, 0] - p[0, 0])
            off = p[0, 1] + share * (p[1, 1] - p[0, 1])
            found |= (share >= 0) & (share <= 1) & (np.abs(off) <= distance)
        metres += size * np.count_nonzero(~found) / samples
    return metres


@given(st.integers(0, 10_000), st.sampled_from([(0.05, 0.1), (0.2, 0.5), (0.01, 1.5)]))
@settings(max_examples=30, deadline=None)
def test_equals_what_points_along_the_segments_see(seed, limits):
    """Another strip, an angle that wraps, spans that are not joined, a neighbour left out."""
    rng = np.random.default_rng(seed)
    before, after = (MAPS[(seed + k) % 4](rng, 20) for k in (0, seed % 2))
    distance, angle = limits
    room = 2.0 * len(before) * len(after) / 400 * 0.05 + 0.02
    for found, expected in (
        (missed(before, after, distance=distance, angle=angle), alone(before, after, *limits)),
        (invented(before, after, distance=distance, angle=angle), alone(after, before, *limits)),
    ):
        assert found == pytest.approx(expected, abs=room)


def test_a_door_that_is_closed_is_invented_and_hardly_costs_quality():
    """Why both stand beside quality: half a metre of wall that nobody saw."""
    closed = [[(0, 0), (4, 0)]]
    assert invented(WALL, closed) == pytest.approx(0.5)
    assert missed(WALL, closed) == 0.0
    assert quality(WALL, closed) == 1.0


def test_beside_is_five_centimetres_and_five_degrees_where_nothing_is_said():
    """Catches other thresholds by default."""
    wall = np.array([[(0.0, 0.0), (2.0, 0.0)]])
    for off, alone in ((0.049, 0.0), (0.051, 2.0)):
        assert invented(wall, wall + (0, off)) == missed(wall, wall + (0, off)) == alone
    for degrees, alone in ((4.9, 0.0), (5.1, 0.2)):
        turned = transform((1, 0, np.radians(degrees)), np.array([[(0.0, 0.0), (0.2, 0.0)]]))
        found = (invented(wall, turned), missed(turned, wall))
        assert found == pytest.approx((alone, alone), abs=1e-9)


def test_nothing_is_beside_an_empty_map():
    assert missed(WALL, []) == pytest.approx(3.5) and invented(WALL, []) == 0.0
    assert missed([], WALL) == 0.0 and invented([], WALL) == pytest.approx(3.5)


@pytest.mark.parametrize("pose", [(0, 0, 1.0), (-70, 40, 0), (3, -8, np.pi)])
def test_moving_both_maps_changes_nothing(pose):
    rng = np.random.default_rng(4)
    before, after = MAPS[1](rng), MAPS[1](np.random.default_rng(4)) + 0.02
    there = [transform(pose, map) for map in (before, after[:, ::-1])]
    for measure in (invented, missed):
        assert measure(*there) == pytest.approx(measure(before, after), abs=1e-9)


@pytest.mark.parametrize("wrong", [{"distance": 0}, {"angle": 90.0}, {"angle": -0.1}])
def test_bad_thresholds_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        invented(WALL, WALL, **wrong)
