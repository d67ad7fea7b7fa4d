"""What a scan and a log promise."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from segmap.poses import transform
from segmap.scans import LaserScan, Log, Skipped
from segmap.scans.causes import Cause, Finding
from segmap.segments import SegmentMap

RIGHT_ANGLES = np.radians([-90, 0, 90])


def scan(time=0.0, odometry=None):
    return LaserScan([1.0, 2.0, 3.0], RIGHT_ANGLES, time=time, odometry=odometry)


def log(count=4, **options):
    scans = [scan(time=0.1 * k, odometry=(k, 0, 0)) for k in range(count)]
    return Log("walk", scans, **{"truth": np.arange(3.0 * count).reshape(-1, 3), **options})


# ------------------------------------------------------------------------ scans
@pytest.mark.parametrize(
    ("reading", "valid"),
    [(np.nan, False), (np.inf, False), (-np.inf, False), (-1, False), (0, False)]
    + [(1e-3, True), (3.999, True), (4.0, False), (4.1, False)],
)
def test_a_beam_is_valid_between_zero_and_the_maximum_both_left_out(reading, valid):
    """Catches a maximum-range reading taken for a wall, and NaN compared as small."""
    one = LaserScan([reading], [0.0], max_range=4.0)
    assert one.valid.tolist() == [valid]
    assert one.points().shape == (int(valid), 2)


@pytest.mark.parametrize("kind", [float, np.float32, int])
def test_a_masked_range_is_no_measurement(kind):
    """Catches a mask that is forgotten: the beam becomes a wall."""
    read = np.ma.masked_greater(np.array([1, 65, 2], kind), 60)
    scan = LaserScan(read, np.radians([0, 90, 180]))
    assert scan.valid.tolist() == [True, False, True]
    assert repr(scan).startswith("LaserScan(3 beams, 2 valid, ")
    np.testing.assert_allclose(scan.points(), [(1, 0), (-2, 0)], atol=1e-12)
    assert LaserScan(np.ma.array([1.0, 2.0]), [0, 1]).valid.all()


@given(
    st.lists(st.floats(0.1, 30) | st.just(np.nan) | st.just(np.inf), min_size=1, max_size=20),
    st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-4, 4)),
)
def test_points_are_the_valid_beams_in_order_moved_by_the_sensor_pose(ranges, place):
    """Catches invalid beams kept, and the sensor's pose applied the wrong way round."""
    angles = np.linspace(-2, 2, len(ranges))
    expected = [
        transform(place, (r * np.cos(a), r * np.sin(a)))
        for r, a in zip(ranges, angles, strict=True)
        if np.isfinite(r)
    ]
    found = LaserScan(ranges, angles, sensor_pose=place).points()
    np.testing.assert_allclose(found, np.reshape(expected, (-1, 2)), atol=1e-9)


# -------------------------------------------------------------------------- logs
def test_a_log_counts_indexes_and_iterates_over_its_scans():
    """Catches `truth` and scans cut differently, and an index from the end that is off by one."""
    walk = log()
    assert len(walk) == 4 and [s.time for s in walk] == walk.times.tolist()
    assert walk[np.int64(1)] is walk.scans[1] and walk[-1] is walk.scans[3]
    with pytest.raises(IndexError):
        walk[4]


def test_a_part_of_a_log_keeps_what_belongs_to_the_whole():
    """Catches a slice whose beams are believed to come in the order that the file states."""
    causes = [Finding(Cause.CLOCK, 1.0, "odd")]
    part = Log("it", [scan()] * 3, order_known=False, causes=causes)[1:]
    assert (part.order_known, part.doubt) == (False, "odd")


def test_odometry_is_nan_where_a_scan_has_none():
    """Catches zeros, which would be a pose."""
    walk = Log("walk", [scan(odometry=(1, 2, 3)), scan()])
    np.testing.assert_array_equal(walk.odometry, [(1, 2, 3), (np.nan, np.nan, np.nan)])
    empty = Log("nothing", [], truth=np.empty((0, 3)))
    assert len(empty) == 0 and empty.times.shape == (0,) and empty.odometry.shape == (0, 3)


def test_a_log_tells_what_it_knows():
    """Catches poses of NaN that are counted as known."""
    some = np.vstack([np.zeros((1, 3)), np.full((3, 3), np.nan)])
    assert repr(log()) == "Log('walk', 4 scans, odometry, truth)"
    assert repr(log(truth=some)) == "Log('walk', 4 scans, odometry, truth for 1)"
    assert repr(Log("w", [scan()])) == "Log('w', 1 scan, no odometry, no truth)"


SECOND = np.array([False, True, False, True, False])


@pytest.mark.parametrize("cut", [slice(1, None, 2), slice(3, 0, -2), SECOND, [1, 3], [1, -2]])
def test_a_log_is_cut_by_slices_masks_and_indices_alike(cut):
    """Catches a truth that does not follow its scans, and a mask taken for indices 0 and 1."""
    walk = log(5, skipped=Skipped(2, "torn"))
    part, rows = walk[cut], np.arange(5)[cut]
    assert isinstance(part, Log) and sorted(rows) == [1, 3]
    assert part.scans == tuple(walk.scans[k] for k in rows)
    np.testing.assert_array_equal(part.truth, walk.truth[rows])
    assert (part.name, part.skipped) == ("walk", (2, "torn"))


@pytest.mark.parametrize(
    "make",
    [
        lambda rows: (LaserScan(rows[0], RIGHT_ANGLES), "ranges"),
        lambda rows: (Log("it", [scan()] * 2, rows), "truth"),
        lambda rows: (SegmentMap([rows[:, :2]]), "segments"),
    ],
)
def test_what_is_made_of_an_array_cannot_be_changed_nor_through_it(make):
    """Catches an array that is shared with the caller."""
    rows = np.ones((2, 3))
    made, name = make(rows)
    rows[:] = 9
    assert (getattr(made, name) == 1).all()
    with pytest.raises(ValueError, match="read-only"):
        getattr(made, name)[0] = 9
    if name == "ranges":
        with pytest.raises(AttributeError):
            made.time = 1.0
