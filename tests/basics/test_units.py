"""Slips of units, millimetres for metres, degrees for radians, are told; what is right is not."""

import inspect
import pickle
import pydoc

import numpy as np
import pytest

from segmap import SegmentMap, load, quadtree, readers
from segmap.alignment import METHODS as ALIGNMENTS
from segmap.arrays import Metres, Radians, RadiansPerMetre, checked
from segmap.extraction import build_map, extract_polylines
from segmap.reduction import METHODS
from segmap.scans import LaserScan, Log

WALLS = SegmentMap([[(0, 0), (2, 0)], [(1.5, 0.03), (3, 0.03)], [(5, 0), (6, 0)]])
POINTS = np.column_stack([np.linspace(0, 1, 21), np.ones(21)])
ANGLES = np.radians(np.arange(-90, 91))


def turned(headings) -> np.ndarray:
    """Poses in one place, with these headings."""
    return np.column_stack([np.zeros((len(headings), 2)), headings])


def log_of(count: int, *, odometry=None, truth=None) -> Log:
    rows = [None] * count if odometry is None else odometry
    ranges = np.full(len(ANGLES), 2.0)
    return Log("test", [LaserScan(ranges, ANGLES, odometry=row) for row in rows], truth)


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


# ------------------------------------------------------------------ headings
@pytest.mark.parametrize("name", ["malaga", "room", "corridor"])
def test_headings_in_degrees_are_told_wherever_they_come_in(name):
    """Catches 157 wrong segments without a word."""
    log, degrees = load(name), np.array([1, 1, 180 / np.pi])
    poses = log.truth * degrees
    with pytest.warns(UserWarning, match="headings of the truth look like degrees: np.radians"):
        Log(name, log.scans, poses)
    for make in (build_map, quadtree.build_map):
        with pytest.warns(UserWarning, match="headings of the poses look like degrees") as caught:
            make(log, poses)
        assert caught[0].filename == __file__
    scans = [
        LaserScan(s.ranges, s.angles, s.time, s.odometry * degrees, s.max_range) for s in log.scans
    ]
    with pytest.warns(UserWarning, match="headings of the odometry look like degrees"):
        Log(name, scans)


@pytest.mark.parametrize(
    "headings", [[6.28, 0, 6.28, 0], [-100.3], [np.nan, 50.1, 49.9], [0, 65535, 0]]
)
def test_headings_in_radians_are_not(headings):
    rows = turned(headings)
    rows[np.isnan(headings)] = np.nan
    np.testing.assert_array_equal(log_of(len(rows), odometry=rows, truth=rows).odometry, rows)


def test_headings_may_wind_up():
    """Catches magnitude alone: a robot that turned ten times, and a part of its log."""
    wound = turned(np.linspace(0, 62, 300))
    log = log_of(300, odometry=wound, truth=wound)
    for part in (log, log[::40], log[np.arange(300) % 60 == 0]):
        build_map(part, part.truth)
        build_map(part, part.odometry)
    wound[150:, 2] -= 30  # the gyroscope is set back
    assert log_of(300, truth=wound).truth[-1, 2] == 32


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


def test_help_shows_an_angle_in_degrees_and_the_value_stays_a_float():
    """Catches a default that nobody can read, and one that is no number where a sweep sends it."""

    @checked
    def bent(*, angle: Radians = np.radians(10), bend: RadiansPerMetre = 1.0, step: Metres = 0.2):
        return angle, bend, step

    known = inspect.signature(bent).parameters
    shown = [repr(known[name].default) for name in ("angle", "bend", "step")]
    assert shown == ["10 degrees", "57.2958 degrees/m", "0.2"]
    assert " = 10 degrees, " in pydoc.render_doc(bent, renderer=pydoc.plaintext)
    assert bent() == (np.radians(10), 1.0, 0.2)
    sent = pickle.loads(pickle.dumps(known["angle"].default))
    assert type(sent) is float and sent == np.radians(10) == known["angle"].default


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
