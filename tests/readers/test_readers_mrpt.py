"""MRPT's logs and maps: every version, every kind of nesting, what is left out, and damage."""

import gzip
import importlib.util
import struct
import tracemalloc

import mrpt_samples as mrpt
import numpy as np
import pytest
from log_samples import TIMES, TRUTH

from segmap import readers
from segmap.readers import LogError, data_file

START = TIMES[0]


@pytest.fixture
def read(tmp_path):
    def write_and_read(data, **given):
        (tmp_path / "some.rawlog").write_bytes(data)
        return readers.read(tmp_path / "some.rawlog", **given)

    return write_and_read


def test_what_is_no_scan_is_left_out_knowingly_and_counted(read):
    """A part of it (CPoint3D here) must not be taken for what follows."""
    log = read(mrpt.RAWLOG)
    assert log.skipped.lines == 1
    start = mrpt.RAWLOG.index(mrpt.BEACONS)
    assert f"byte {start}: CObservationBeaconRanges version 3" in log.skipped.reason
    one, two = mrpt.scan(START), mrpt.scan(TIMES[1])
    for data in (
        mrpt.frame(mrpt.BEACONS, one) + mrpt.frame(two),
        mrpt.BEACONS + one + two,
        one + two + mrpt.BEACONS,
        mrpt.frame(one, two, mrpt.BEACONS),
    ):
        assert read(data).times == pytest.approx(TIMES) and read(data).skipped.lines == 1
    pose = mrpt.gauss_3d(TRUTH[0])
    pairs = mrpt.pack("I", 2) + 2 * (pose + mrpt.frame(one, mrpt.BEACONS))
    log = read(mrpt.new("CSimpleMap", 1, pairs))
    assert (len(log), log.skipped.lines) == (2, 2)


def test_poses_by_the_wheels_are_taken_at_the_time_of_the_scan(read):
    moved = mrpt.wheels(START, (0, 0, 3.0)) + mrpt.wheels(START + 2, (2, 0, -3.0))
    log = read(moved + b"".join(map(mrpt.scan, (START + 0.5, START + 3))))
    heading = 3.0 + (2 * np.pi - 6) / 4  # by the short way
    assert log.odometry[0] == pytest.approx([0.5, 0, heading])
    assert log[1].odometry is None


def test_a_rawlog_may_be_one_object(read):
    parts = mrpt.frame(mrpt.scan(START)), mrpt.actions(mrpt.movement((1, 0, 0))), mrpt.scan(START)
    comment = mrpt.new("CObservationComment", 0, mrpt.text("why"), mrpt.ticks(0))
    log = read(mrpt.new("CRawlog", 1, mrpt.group(*parts), comment))
    assert log.odometry[:, 0].tolist() == [0, 1]


@pytest.mark.parametrize("version", range(8))
def test_every_version_of_an_object(read, version):
    """Of a scan and a movement, and as far as there are such of wheels, frames and poses."""
    log = read(mrpt.scan(START, version) + mrpt.scan(START + 1, version))
    assert np.isposinf(log[1].ranges).tolist() == [False, False, False, True, False]
    times = [START, START + 1] if version > 2 else [np.nan] * 2
    assert log.times == pytest.approx(times, nan_ok=True)
    for method in (0, 1):
        step = mrpt.actions(mrpt.movement((0.5, 0.1, 0.2), version, method))
        log = read(mrpt.scan(START) + step + mrpt.scan(START + 1))
        assert log.odometry[1] == pytest.approx([0.5, 0.1, 0.2])
    if version < 3:
        told = mrpt.wheels(START, (1, 2, 3), version)
        log = read(mrpt.frame(told, mrpt.scan(START), version=version))
        assert log.odometry[0] == pytest.approx([1, 2, 3])
    if version < 4:
        pdf = mrpt.new("CPose3DPDFGaussian", 1, mrpt.pose_3d(1, 2, 2.5, version), bytes(168))
        log = read(mrpt.new("CSimpleMap", 1, mrpt.pack("I", 1), pdf, mrpt.frame(mrpt.scan(START))))
        assert log.truth[0] == pytest.approx([1, 2, 2.5])


def test_several_movements_tell_of_one_way(read):
    """Adding the odometry's and the matcher's would double the way."""
    both = mrpt.actions(mrpt.movement((1, 0, 0)), mrpt.movement((1.01, 0, 0), method=1))
    assert read(both + mrpt.scan(START)).odometry[0].tolist() == [1, 0, 0]


def test_scans_from_left_to_right_and_lasers_upside_down(read):
    """Both at once are as if neither."""
    first = np.radians(90)
    assert read(mrpt.scan(START, to_left=False))[0].angles[0] == pytest.approx(first)
    hanging = {"place": (0.3, 0.1, 0.5), "roll": np.pi}
    log = read(mrpt.scan(START, **hanging))
    assert log[0].angles[0] == pytest.approx(first)
    assert log[0].sensor_pose == pytest.approx([0.3, 0.1, 0.5])
    assert read(mrpt.scan(START, to_left=False, **hanging))[0].angles[0] == pytest.approx(-first)


def test_a_tilted_laser_is_left_out(read):
    tilted = mrpt.scan(START, pitch=1.0)
    log = read(tilted + mrpt.scan(START, pitch=0.01))
    assert len(log) == 1 and "tilted by 57 degrees" in log.skipped.reason
    with pytest.raises(LogError, match=r"holds no scan.*tilted"):
        read(tilted)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (mrpt.scan(START, 6).replace(b"Scan\x06", b"Scan\x08"), "Scan version 8 is not known here"),
        (mrpt.new("CPose2D", 1), "byte 0: expected CSensoryFrame or .* got CPose2D version 1"),
        (mrpt.frame(mrpt.pose_2d((0, 0, 0))), "expected CObservation, got CPose2D version 1"),
        (mrpt.new("CObservation2DRangeScan", 6), "expected 9 bytes more, but only 1 follow"),
        (mrpt.scan(START)[:-1] + b"\x87", "byte 0: .* does not end where it should"),
        (mrpt.old("CObservationImage", 3), "not known here, nor how long it is"),
        (mrpt.scan(START) + b"\x90junk", "expected 16 bytes more"),
        (mrpt.frame() + struct.pack("<I", 600) + b"C", "expected an object of MRPT"),
        (mrpt.new("CObservationGPS", 8)[:-1], "its end was not found"),
    ],
)
def test_what_is_wrong_is_named_with_its_place(read, data, reason):
    with pytest.raises(LogError, match=reason):
        read(data)


def test_damage_ends_the_reading_and_bad_values_cost_one_object(read):
    bad = mrpt.scan(START).replace(struct.pack("<f", np.pi), struct.pack("<f", 180.0))
    for middle, left in ((bad, 2), (mrpt.frame()[:-2], 1)):
        data = mrpt.scan(START) + middle + mrpt.scan(START)
        with pytest.raises(LogError, match="byte "):
            read(data)
        log = read(data, on_error="skip")
        assert (len(log), log.skipped.lines) == (left, 1)
    ranges = np.random.default_rng(1).random((300, 50))
    packed = gzip.compress(b"".join(mrpt.scan(START, ranges=row) for row in ranges))
    with pytest.raises(LogError, match="cut short"):
        read(packed[: len(packed) // 2])
    assert 100 < len(read(packed[: len(packed) // 2], on_error="skip")) < 200


def test_a_beam_that_is_flagged_is_an_error_of_the_sensor_or_met_nothing(read):
    """Nothing, where its range is the largest or beyond."""
    found = read(mrpt.scan(START, ranges=(1.5, 2.0, 80.0, 81.83, 3.0), bad=(1, 3)))[0]
    assert np.isnan(found.ranges).tolist() == [False, True, False, False, False]
    assert np.isposinf(found.ranges).tolist() == [False, False, True, True, False]
    assert found.valid.tolist() == [True, False, False, False, True]
    odd = b"\x01\x00\x80\x7f"  # a NaN that numpy warns of
    assert np.isnan(read(mrpt.scan(START).replace(struct.pack("<f", 2.5), odd))[0].ranges[2])


@pytest.mark.parametrize("count", [2**32 - 1, 2**28, 100_000])
def test_counts_allocate_nothing(read, count):
    """A count of four thousand million before five ranges."""
    n = struct.pack("<I", count)
    five, none = struct.pack("<I", 5), struct.pack("<I", 0)
    matrix = mrpt.old("CPose3D", 0, mrpt.old("CMatrix", 0, n * 2))
    tracemalloc.start()
    for data in (
        mrpt.scan(START).replace(five, n),
        mrpt.frame().replace(none, n),
        mrpt.new("CSimpleMap", 1, n),
        mrpt.old("CObservation2DRangeScan", 4, bytes(9), matrix),
    ):
        with pytest.raises(LogError, match="expected"):
            read(data)
    assert tracemalloc.get_traced_memory()[1] < 2e6
    tracemalloc.stop()


def test_malaga_is_converted_from_a_log_and_a_map(tmp_path):
    """The packages' files are not here: the same script, on a log of two scans."""
    rawlog, simple_map = tmp_path / "a.rawlog", tmp_path / "a.simplemap"
    ahead = {"place": (0.3, 0.0, 0.0)}
    step = mrpt.actions(mrpt.movement((1, 0, 0.1)))
    scans = [mrpt.frame(mrpt.scan(START + k, **ahead)) for k in range(2)]
    rawlog.write_bytes(gzip.compress(scans[0] + step + scans[1]))
    pair = mrpt.gauss_3d((5.9, 2.5, 0.0)) + scans[1]
    simple_map.write_bytes(gzip.compress(mrpt.new("CSimpleMap", 1, mrpt.pack("I", 1), pair)))
    ranges = "FLASER 5 1.50 2.00 2.50 81.83 3.00"
    assert converter().convert(rawlog, simple_map).splitlines() == [
        "PARAM robot_frontlaser_offset 0.300000",
        f"{ranges} nan nan nan 0.000000 0.000000 0.000000 1000.250000 malaga 0.000000",
        f"{ranges} 6.200000 2.500000 0.000000 1.000000 0.000000 0.100000 1001.250000 "
        "malaga 1.000000",
    ]
    other = mrpt.scan(START + 1, ranges=(1, 2, 3, 4, 5), **ahead)
    rawlog.write_bytes(mrpt.frame(other))
    with pytest.raises(ValueError, match="the same ranges"):
        converter().convert(rawlog, simple_map)


def converter():
    place = data_file("malaga/convert.py")
    spec = importlib.util.spec_from_file_location("convert_malaga", place)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
