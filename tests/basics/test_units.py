"""Slips of units, millimetres for metres, degrees for radians, are told; what is right is not."""

import numpy as np
import pytest

from segmap import SegmentMap, load, readers
from segmap.alignment import METHODS as ALIGNMENTS
from segmap.extraction import extract_polylines
from segmap.reduction import METHODS
from segmap.scans import LaserScan

WALLS = SegmentMap([[(0, 0), (2, 0)], [(1.5, 0.03), (3, 0.03)], [(5, 0), (6, 0)]])
POINTS = np.column_stack([np.linspace(0, 1, 21), np.ones(21)])
ANGLES = np.radians(np.arange(-90, 91))


# ------------------------------------------------------------------ beams


@pytest.mark.parametrize("max_range", [np.inf, 5.6])
def test_ranges_in_millimetres_are_told(max_range):
    """Catches a map of four kilometres; with a largest range in metres there is no valid beam."""
    with pytest.warns(UserWarning, match="look like millimetres, ranges / 1000"):
        LaserScan(np.linspace(900, 4000, 181), ANGLES, max_range=max_range)
    with pytest.warns(UserWarning, match="look like millimetres"):
        LaserScan([2000.0, 2000.0, 2000.0, np.inf, np.nan, 0], np.arange(6))


@pytest.mark.parametrize(
    "ranges", [[65535.0] * 9, [1e6, np.inf], [65535.0] * 7 + [1.0, 2.0], [999.0] * 5 + [5000.0] * 4]
)
def test_a_number_that_stands_for_nothing_is_no_range(ranges):
    most = 5.6 if ranges[0] > 1e4 else np.inf
    assert LaserScan(ranges, np.zeros(len(ranges)), max_range=most).ranges.tolist() == ranges


# ------------------------------------------------------------------ thresholds
WIDE = WALLS.segments * 40  # 240 m
#: What takes lengths, what it is given, and lengths in millimetres, or just beyond their bound.
IN_MILLIMETRES = [
    *((METHODS[n], WALLS, {"distance": 200}) for n in METHODS if n[:5] in ("basic", "hybri")),
    *((METHODS[n], WALLS, {"tolerance": 40}) for n in ("fusion", "hybrid_fusion")),
    (METHODS["mean_shift"], WALLS, {"sigma": 200.0, "bandwidth": 1e-3}),
    (METHODS["basic_offline"], WALLS, {"distance": 10.1}),
    (METHODS["basic_offline"], WIDE, {"distance": 12.1}),
    *((extract_polylines, POINTS, {"gap": gap}) for gap in (300, 101)),
    *((extract_polylines, POINTS, slip) for slip in ({"tolerance": 30}, {"min_length": 100})),
    (ALIGNMENTS["segment_icp"], load("room")[:2], {"distance": 500}),
    *((ALIGNMENTS[n], load("room")[:2], {"reach": 500}) for n in ("point_icp", "global_segments")),
]


@pytest.mark.parametrize(("of", "given", "slip"), IN_MILLIMETRES)
def test_lengths_in_millimetres_are_told(of, given, slip):
    """Catches `fusion(tolerance=40)`: everything in one strip; and bounds of half as much again."""
    with pytest.warns(UserWarning, match=r"this looks like millimetres, [a-z_]+ / 1000"):
        of(given, **slip)


def test_a_map_in_millimetres_by_intent_is_left_alone():
    """Catches a bound that knows no scale: every length of a map may be scaled."""
    METHODS["basic_offline"](WIDE, distance=11.9)
    big = WALLS.segments * 1000
    for name, threshold, left in (("fusion", "tolerance", 2), ("basic_offline", "distance", 3)):
        assert len(METHODS[name](big, **{threshold: 40.0})) == left
    assert len(extract_polylines(POINTS * 10_000, tolerance=30.0, gap=600.0, min_length=100.0)) == 1


def test_delays_in_milliseconds_are_refused(tmp_path):
    """Catches beams that are carried by a thousand times the motion of their turn."""
    delays = np.linspace(0, 100, 9)  # of a turn of 0.1 s
    with pytest.raises(ValueError, match=r"at most 10 s after time, got 100: are they millisec"):
        LaserScan(np.ones(9), np.linspace(-1, 1, 9), delays=delays)
    assert LaserScan(np.ones(9), np.linspace(-1, 1, 9), delays=delays / 1000).delays is not None
    path = tmp_path / "it.csv"
    rows = [f"{k},{time},{0.1 * time},2.0" for k in range(3) for time in range(0, 90, 10)]
    path.write_text("\n".join(["scan,time_s,angle_deg_ccw,range_m", *rows]))
    with pytest.raises(ValueError, match=r"it.csv: the beams of a scan take 80 s.*millisec"):
        readers.read(path)
