"""Polylines: which segments are a chain, the corners of its line, and its place in the map."""

from itertools import pairwise

import numpy as np
import pytest
from conftest import slow
from reduction_maps import assert_literal, malaga, redundant_map
from segmap_course import literal
from segmap_course.literal.reduction.polyline import apart as distance

from segmap.reduction import polyline
from segmap.segments import SegmentMap, length
from segmap.testing import assert_segments_equal

BEND = [[(0, 0), (1, 0)], [(0.9, 0.02), (2, 0.3)], [(1.8, 0.3), (3, 0.3)]]


def test_two_segments_of_a_scan_meet_through_a_wall_of_the_map():
    """Catches a chain that holds what one segment matches, and no more."""
    wall = [[(0, 0), (3, 0)], [(0.2, 0.01), (1, 0.01)], [(2, 0.01), (2.8, 0.01)]]
    found = polyline(SegmentMap(wall, [0, 1, 1]))
    assert found.parents.tolist() == [0, 0, 0]


def test_a_segment_is_put_in_by_the_shorter_links():
    """Catches a segment that is put in as it was drawn: the line would run there and back."""
    bend = [[(0, 0), (1, 0)], [(2, 0.5), (0.9, 0.02)], [(1.8, 0.5), (3, 0.5)]]
    assert_literal("polyline", SegmentMap(bend, [0, 1, 0]))
    found = polyline(SegmentMap(bend, [0, 1, 0]))
    assert length(found.segments).sum() < 3.4


@pytest.mark.parametrize(
    ("tolerance", "corners"),
    [(0.10, [(0, 0), (0.9, 0.02), (1.8, 0.3), (3, 0.3)]), (0.40, [(0, 0), (3, 0.3)])],
)
def test_the_corners_of_a_chain(tolerance, corners):
    """Catches corners that run back, (2, 0.3) to (1.8, 0.3), where nothing is left out."""
    found = literal.polyline_through(np.array(BEND).tolist(), tolerance)
    np.testing.assert_allclose(found, corners)
    both = SegmentMap(BEND, [0, 1, 0])  # the third meets the first through the second
    pieces = list(pairwise(corners))
    assert_segments_equal(polyline(both, tolerance=tolerance), pieces, ordered=True)


def test_every_segment_of_a_chain_stays_within_tolerance_of_a_piece():
    """Catches corners that are left out although somebody needs them."""
    map = malaga()[:600]
    for stop in (2, 5, 9):
        part = SegmentMap(map.segments[map.scan <= stop], map.scan[map.scan <= stop])
        found = polyline(part, tolerance=0.05)
        pieces = found.segments.tolist()
        off = [min(distance(s, p) for p in pieces) for s in part.segments.tolist()]
        assert (
            np.mean(np.array(off) < 0.10) > 0.97
        )  # a piece of a piece may drift from scan to scan


def test_two_walls_of_the_map_meet_through_a_segment_of_the_scan():
    wall = [[(0, 0), (1, 0)], [(2, 0), (3, 0)], [(0.5, 0.01), (2.5, 0.01)]]
    found = polyline(SegmentMap(wall, [0, 0, 1]))
    assert_segments_equal(found, [[(0, 0), (3, 0)]])
    assert found.parents.tolist() == [0, 0, 0] and found.scan_live.tolist() == [2, 1]


@pytest.mark.parametrize(("bridge", "left"), [(0.30, 2), (0.60, 3), (np.inf, 3)])
def test_a_link_that_nobody_saw_is_left_out(bridge, left):
    """A draws it: a wall across a step of 0.5 m."""
    step = [[(0, 0), (2, 0)], [(2, 0.5), (4, 0.5)], [(1, 0.25), (3, 0.25)]]
    map = SegmentMap(step, [0, 0, 1])
    found = polyline(map, far=0.3, bridge=bridge)
    seen = np.isin(np.arange(len(found)), found.parents)
    assert len(found) >= left or bridge == 0.30
    assert (length(found.segments)[~seen] <= bridge).all()


def test_pieces_stand_in_the_place_of_the_first_of_their_chain():
    """Catches a map in the order of the last change: the third wall stays the last."""
    walls = [[(0, 0), (2, 0)], [(0, 1), (2, 1)], [(0, 2), (2, 2)], [(1, 1.01), (3, 1.01)]]
    found = polyline(SegmentMap(walls, [0, 0, 0, 1]))
    assert found.segments[:, 0, 1].round(1).tolist() == [0, 1, 2]
    assert found.parents.tolist() == [0, 1, 2, 1]


@pytest.mark.parametrize("way", [range(60, 79), slow(range(78, 59, -1))])
def test_a_line_that_bends_at_every_scan_keeps_its_place(way):
    """Catches labels between two walls that have become too narrow: halved 80 times.

    At the end a scan sees all bends again: the chain is long, and its pieces must come in the order
    of the map.
    """
    x = np.arange(82.0)
    ends = np.stack([x, 5 + 0.3 * (x % 2)], -1)
    bends = np.stack([ends[:-1], ends[1:]], 1)
    bends[:, 1] += 0.02 * (bends[:, 1] - bends[:, 0])
    walls = [[(0, 0), (9, 0)], bends[0], [(0, -2), (9, -2)], *bends[1:]]
    again = [(bends[k, 0] + bends[k, 1]) / 2 + [(0, 0.02), (1, 0.02)] for k in way]
    scans = [*np.maximum(np.arange(len(walls)) - 2, 0), *[99] * len(again)]
    assert_literal("polyline", SegmentMap([*walls, *again], scans), far=0.3)


@pytest.mark.parametrize("count", [100, slow(200)])
def test_more_pieces_than_the_room_that_was_made(count):
    """Catches a map that ends where its arrays do: few long walls and many short scans."""
    map = redundant_map(np.random.default_rng(1), count)
    assert_literal("polyline", SegmentMap(map, np.arange(count) // 2), tolerance=0.005, bridge=5.0)
