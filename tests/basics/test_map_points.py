"""Maps that keep the points behind their segments, and the places of the sensor."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from segmap import load
from segmap.extraction import build_map, extract_clusters, extract_polylines, fit_line
from segmap.scans import LaserScan, Log
from segmap.segments import SegmentMap, extreme_projections

PIECES = [extract_polylines, extract_clusters]


def a_map(extract=extract_polylines, **thresholds) -> SegmentMap:
    log = load("room")
    return build_map(log[:8], log.truth[:8], extract=extract, keep_points=True, **thresholds)


def behind(map: SegmentMap, i: int) -> np.ndarray:
    return map.points[map.first[i] : map.first[i + 1]]


@pytest.mark.parametrize("extract", PIECES)
@pytest.mark.parametrize("closed", [False, True])
def test_each_segment_is_the_line_through_its_points(extract, closed):
    """Catches runs that are off by one, or of a rolled scan; points left in the robot's frame."""
    map = a_map(extract, closed=closed)
    assert len(map) > 8
    for i, segment in enumerate(map.segments):
        found = extreme_projections(behind(map, i), *fit_line(behind(map, i)))
        if np.dot(found[1] - found[0], segment[1] - segment[0]) < 0:
            found = found[::-1]
        assert_allclose(found, segment, atol=1e-9)


@pytest.mark.parametrize("extract", PIECES)
@pytest.mark.parametrize("turned", [1, -1])
@pytest.mark.parametrize("first", [-np.pi, -1.0, 0.0, 1.3, 3.0])
def test_a_wall_goes_on_across_the_seam_of_a_whole_turn(extract, turned, first):
    """Catches a wall that the first beam cuts in two, clockwise and in angles that begin anew."""
    angles = first + turned * np.radians(np.arange(360))
    far = 1 / np.maximum(np.abs(np.cos(angles)) / 2, np.abs(np.sin(angles)) / 3)
    far[far > 3.4] = np.inf  # no corner, so that clusters are walls too
    for listed in (angles, angles % (2 * np.pi)):
        scan = LaserScan(far, listed, sensor_pose=(0.3, 0.2, 1.0))
        map = build_map(Log("room", [scan]), [(0, 0, 0)], extract=extract, keep_points=True)
        walls = build_map(Log("room", [scan]), [(0, 0, 0)], extract=extract)
        assert scan.whole_turn and len(map) == 4 and len(map.points) == scan.valid.sum()
        assert_array_equal(walls.segments, map.segments)
        assert_array_equal(walls.scan, map.scan)
        assert walls.points is None and walls.sensors is None
    assert not LaserScan(far[:-3], angles[:-3]).whole_turn


def test_no_point_stands_behind_two_segments():
    """Catches pieces of a polyline that share their corner."""
    map = a_map()
    assert len(np.unique(map.points, axis=0)) == len(map.points) > 5 * len(map)


def test_sensors_stand_where_the_laser_was_mounted():
    """Catches the place of the robot in the place of its laser, and a pose that is turned back."""
    scan = replace(load("room")[0], sensor_pose=(0.2, 0.1, 0.0))
    log = Log("mounted", [scan, scan])
    map = build_map(log, [(1, 2, np.pi / 2), (np.nan,) * 3], keep_points=True)
    assert_allclose(map.sensors, [(0.9, 2.2), (np.nan, np.nan)])
    assert set(map.scan) == {0}


def test_slices_and_the_filter_carry_points_and_sensors():
    """Catches points that stay where they were, so that segments get those of others."""
    map = a_map()
    keep = np.flatnonzero(np.hypot(*(map.segments[:, 1] - map.segments[:, 0]).T) >= 0.5)
    for part in (map.filtered(0.5), map[keep]):
        assert 0 < len(part) < len(map)
        assert_array_equal(part.segments, map.segments[keep])
        assert_array_equal(part.sensors, map.sensors)
        for i, k in enumerate(keep):
            assert_array_equal(behind(part, i), behind(map, k))
    assert_array_equal(map[2:5].points, map.points[map.first[2] : map.first[5]])
    assert_array_equal(map[[4, 1]].scan, map.scan[[4, 1]])
    assert len(map[:0].points) == 0 and map[:0].first.tolist() == [0]
    assert len(map[np.zeros(len(map), bool)]) == 0
    with pytest.raises(TypeError, match="take a slice, a mask or indices of segments, got 3"):
        map[3]
