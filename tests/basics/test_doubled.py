"""Doubled walls: what is drawn twice at wrong poses, and what only lies near something else."""

import numpy as np
import pytest

from segmap import load
from segmap.extraction import build_map
from segmap.metrics import doubled_walls
from segmap.poses import transform
from segmap.segments import SegmentMap
from segmap.simulation import rectangular_room

SEEN_FROM = [(2.0, 1.5)] * 8


def rooms(*shifts):
    """A room of 4 m by 3 m, drawn twice as seen from two places in it; all moved each time."""
    walls = [rectangular_room(4, 3) + shift for shift in shifts for _ in range(4)]
    return SegmentMap(np.concatenate(walls), np.repeat(np.arange(4 * len(shifts)), 4))


@pytest.mark.parametrize(
    ("shift", "least", "most"),
    [
        ((0, 0), 0, 0),
        ((0.1, 0.0), 0, 0),
        ((0.3, 0), 0.5, 0.65),
        ((0.3, 0.3), 0.8, 1),
        ((0.8, 0), 0, 0),
    ],
)
def test_a_room_drawn_at_two_places(shift, least, most):
    """Its two short walls of four where it moves along one axis, none by what may be noise."""
    assert least <= doubled_walls(rooms((0, 0), shift), SEEN_FROM) <= most


@pytest.mark.parametrize("turn", [0.3, 0.7, 2.0])
def test_turning_the_world_changes_little(turn):
    """Catches directions compared across the seam, or along the axes only."""
    map, world = rooms((0, 0), (0.3, 0)), (5.0, -3.0, turn)
    turned = transform(world, map.segments.reshape(-1, 2)).reshape(-1, 2, 2)
    there = transform(world, np.array(SEEN_FROM))
    share = doubled_walls(SegmentMap(turned, map.scan), there)
    assert share == pytest.approx(doubled_walls(map, SEEN_FROM), abs=0.1)


def test_the_two_faces_of_a_thin_wall_are_not_doubled():
    """Catches a wall of 20 cm between two rooms, which is not one wall at two poses."""
    walls = (
        np.array([[[(0, 0), (4, 0)]], [[(0, 0.2), (4, 0.2)]]]).repeat(3, axis=0).reshape(-1, 2, 2)
    )
    map = SegmentMap(walls, range(6))
    sides = [(2.0, -1.0)] * 3 + [(2.0, 1.0)] * 3
    assert doubled_walls(map, sides) == 0
    assert doubled_walls(map, [(2.0, -1.0)] * 6) == 1


def test_people_and_the_order_of_ends_do_not_count():
    once = rooms((0, 0))
    seen = np.concatenate([once.segments, [[(1, 0.3), (3, 0.3)]]])
    map = SegmentMap(seen, [*once.scan, 3])
    assert doubled_walls(map, SEEN_FROM) == 0
    both = rooms((0, 0), (0.3, 0.3))
    swapped = np.where(
        np.arange(len(both))[:, None, None] % 2, both.segments[:, ::-1], both.segments
    )
    share = doubled_walls(SegmentMap(swapped, both.scan), SEEN_FROM)
    assert share == pytest.approx(doubled_walls(both, SEEN_FROM), abs=0.05)


def test_no_wall_is_no_number_and_no_sensor_is_refused():
    assert np.isnan(doubled_walls(SegmentMap(np.empty((0, 2, 2))), np.empty((0, 2))))
    assert np.isnan(doubled_walls(rooms((0, 0))[:4], SEEN_FROM))
    with pytest.raises(ValueError, match="sensors must say where each scan"):
        doubled_walls(rooms((0, 0)))
    with pytest.raises(ValueError, match="sensors"):
        doubled_walls(rooms((0, 0)), [(0, 0)])


def test_what_was_measured():
    """The figures of the docstring: Malaga by its wheels and by poses that were corrected."""
    log = load("malaga")
    by_wheels = doubled_walls(build_map(log, log.odometry, keep_points=True))
    corrected = doubled_walls(build_map(log, log.truth, keep_points=True))
    assert by_wheels > 0.5 > 0.15 > corrected
