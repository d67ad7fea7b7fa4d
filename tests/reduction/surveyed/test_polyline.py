"""Polylines: the corners of a chain, and its place in the map."""

from itertools import pairwise

import numpy as np
import pytest
from conftest import slow
from segmap_course import literal

from segmap.reduction import polyline
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal

BEND = [[(0, 0), (1, 0)], [(0.9, 0.02), (2, 0.3)], [(1.8, 0.3), (3, 0.3)]]


@pytest.mark.parametrize(
    ("tolerance", "corners"),
    [(0.10, [(0, 0), (0.9, 0.02), (1.8, 0.3), (3, 0.3)]), (0.40, [(0, 0), (3, 0.3)])],
)
def test_the_corners_of_a_chain(tolerance, corners):
    """Catches corners that run back, (2, 0.3) to (1.8, 0.3), where nothing is left out."""
    found = literal.polyline_through(np.array(BEND, float), tolerance)
    np.testing.assert_allclose(found, corners)
    both = SegmentMap(BEND, [0, 1, 0])  # the third meets the first through the second
    pieces = list(pairwise(corners))
    assert_segments_equal(polyline(both, tolerance=tolerance), pieces, ordered=True)


@pytest.mark.parametrize("way", [range(60, 79), slow(range(78, 59, -1))])
def test_a_line_that_bends_at_every_scan_keeps_its_place(way):
    """Catches a chain that is not put where its first segment was, or whose pieces are mixed.

    At the end a scan sees many bends again: the chain is long, and its pieces must come in the
    order of the line, between the walls that were seen before and after its first segment.
    """
    x = np.arange(82.0)
    ends = np.stack([x, 5 + 0.3 * (x % 2)], -1)
    bends = np.stack([ends[:-1], ends[1:]], 1)
    bends[:, 1] += 0.02 * (bends[:, 1] - bends[:, 0])
    walls = [[(0, 0), (9, 0)], bends[0], [(0, -2), (9, -2)], *bends[1:]]
    again = [(bends[k, 0] + bends[k, 1]) / 2 + [(0, 0.02), (1, 0.02)] for k in way]
    scans = [*np.maximum(np.arange(len(walls)) - 2, 0), *[99] * len(again)]
    found = polyline(SegmentMap([*walls, *again], scans), far=0.3)
    first, *line, last = found.segments
    assert_segments_equal([first, last], [walls[0], walls[2]], ordered=True)
    assert_segments_equal([line[0], line[-1]], [bends[0], bends[-1]], ordered=True, atol=0.03)
    assert (np.diff([piece[0, 0] for piece in line]) > 0).all()
    pieces = found.parents[[1, *range(3, len(walls))]]
    assert (np.diff(pieces) > 0).all() and found.parents[2] == len(found) - 1
