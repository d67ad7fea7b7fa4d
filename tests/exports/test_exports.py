"""Exports: another program finds what was meant, and `read` takes in again what was written."""

import random
from dataclasses import replace

import numpy as np
import pytest

from segmap import Log, exports, load, read
from segmap.alignment import Alignment, odometry
from segmap.poses import compose
from segmap.scans import LaserScan
from segmap.testing import assert_poses_equal

HALF_TURN = np.radians([-90, -45, 0, 45, 90])
#: Looks ahead, and back: offsets in x, y and angle, so that a lost one shows.
AHEAD, BACK = (0.3, 0.1, 0.2), (-0.4, 0.05, np.pi - 0.1)
TRUTH = np.array([(5.0, 2.0, 0.5), (5.9, 2.5, 3.1), (6.7, 2.9, -3.1)])
WHEELS = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 2.5), (1.9, 0.3, -2.9)])
RANGES = [1.5, np.inf, 2.25, np.nan, 3.123456]


def shot(k, angles=HALF_TURN, place=AHEAD, max_range=50.0, wheels=WHEELS):
    pose = None if wheels is None else wheels[k]
    return LaserScan(RANGES, angles, 1000.25 + k / 3, pose, max_range, place)


def log_of(scans, truth=TRUTH):
    return Log("three", scans, truth)


OLD = log_of([shot(k) for k in range(3)])
NEW = log_of([shot(k, HALF_TURN * 0.75 + 0.1, max_range=4.0) for k in range(3)])
BOTH = log_of([shot(0), shot(1, place=BACK), shot(2)])
SHOTS = [shot(k % 3, HALF_TURN * 0.75, p) for k, p in enumerate((BACK, AHEAD, BACK, AHEAD))]
BOTH_NEW = log_of(SHOTS, np.vstack([TRUTH, TRUTH[1:2]]))
TURNED = log_of([shot(k, HALF_TURN - 0.1) for k in range(3)])
UNPLACED = log_of(OLD.scans, np.where([[True], [False], [True]], TRUTH, np.nan))
LOGS = {
    "old": OLD,
    "new": NEW,
    "turned": TURNED,
    "both": BOTH,
    "both new": BOTH_NEW,
    "unplaced": UNPLACED,
    "unsorted, as clocks of computers count": log_of(
        [replace(scan, time=t) for scan, t in zip(OLD, (1137838384.123456, 5.0, 5.0), strict=True)]
    ),
    "a name that is not plain ASCII, and runs over its line": Log(
        "M\u00e1laga\nFLASER 1", OLD.scans, TRUTH
    ),
}


def written(tmp_path, log, *poses, name="it.log"):
    exports.write_carmen(tmp_path / name, log, *poses)
    return read(tmp_path / name)


def assert_same_log(found, log, digits=6):
    """Ranges, beams, places, times, odometry and truth, to the digits written."""
    assert len(found) == len(log)
    for a, b in zip(found, log, strict=True):
        np.testing.assert_allclose(a.ranges, b.ranges, atol=0.6 * 10**-digits)
        np.testing.assert_array_equal(a.valid, b.valid)
        np.testing.assert_allclose(a.angles, b.angles, atol=1e-12)
        np.testing.assert_allclose(a.sensor_pose, b.sensor_pose, atol=1e-9)
    np.testing.assert_allclose(found.times, log.times, atol=0.6e-6, rtol=0)
    np.testing.assert_allclose(found.odometry, log.odometry, atol=0.6e-6)
    assert (found.truth is None) == (log.truth is None)
    if log.truth is not None:
        known = np.isfinite(log.truth).all(1)
        assert (np.isfinite(found.truth).all(1) == known).all()
        assert_poses_equal(found.truth[known], log.truth[known], atol=2e-6)


# ------------------------------------------------------------------------------ CARMEN
@pytest.mark.parametrize("name", [*LOGS, "malaga", "corridor", "room"])
def test_a_log_comes_back_as_it_was(name, tmp_path):
    """Catches the robot's pose where the laser's belongs, and front and rear exchanged.

    In bundled logs beams of 81.91 m, gaps in the truth, and a sensor of 240 degrees.
    """
    log = LOGS[name] if name in LOGS else load(name)
    found = written(tmp_path, log, name="it.log.gz")
    assert_same_log(found, log)
    for a, b in zip(found, log, strict=True):
        np.testing.assert_allclose(a.points(), b.points(), atol=1e-5 if name in LOGS else 1e-9)


def test_poses_that_are_given_replace_the_truth_and_not_the_odometry(tmp_path):
    """Catches an export of the poses that the log came with, and a scan lost as it was not used."""
    moved, used = compose((1, 2, 0.3), TRUTH), np.array([True, False, True])
    found = written(tmp_path, OLD, moved)
    assert_poses_equal(found.truth, moved, atol=2e-6)
    np.testing.assert_allclose(found.odometry, WHEELS, atol=1e-6)
    alignment = Alignment(TRUTH, used, 0.0, "by hand", ("", "turning", ""))
    assert np.isfinite(written(tmp_path, OLD, alignment).truth).all()
    some = written(tmp_path, OLD, alignment.trusted)
    assert (np.isfinite(some.truth).all(1) == used).all()


def test_the_lines_by_hand(tmp_path):
    """Pose of the laser, odometry of the robot, then the time; new lines state their beams."""
    ahead = log_of([shot(0, place=(0.5, 0, 0))], [(1, 2, np.pi / 2)])
    exports.write_carmen(tmp_path / "one.log", ahead)
    lines = [x.split() for x in (tmp_path / "one.log").read_text().splitlines() if x[0] != "#"]
    assert lines[0] == ["PARAM", "robot_frontlaser_offset", "0.5"]
    assert lines[-1][:7] == ["FLASER", "5", "1.5", "81.83", "2.25", "0", "3.123456"]
    assert " ".join(lines[-1][7:]) == "1 2.5 1.570796 0 0 0 1000.250000 segmap 0.000000"
    exports.write_carmen(tmp_path / "new.log", NEW)
    fields = (tmp_path / "new.log").read_text().splitlines()[-1].split()
    start, view, step, limit = map(float, fields[2:6])
    assert fields[:2] == ["ROBOTLASER1", "0"] and fields[8:10] == ["5", "1.5"]
    assert np.degrees([start - 0.1, view, step]) == pytest.approx([-67.5, 135, 33.75])
    assert limit == 4.0 and fields[10] == "4"  # what met nothing is written as the maximum


def test_what_lies_beyond_the_maximum_is_written_as_nothing_met(tmp_path):
    """Catches an invalid beam that becomes a wall on the way."""
    far = LaserScan([9.0, 5.0, -1.0, 1.0, 8.0], HALF_TURN, 0.0, (1, 1, 1), max_range=8.0)
    for write, name in ((exports.write_carmen, "far.log"), (exports.write_arrays, "far.npz")):
        write(tmp_path / name, Log("far", [far], [(0, 0, 0)]))
        found = read(tmp_path / name)[0].ranges
        np.testing.assert_array_equal(np.isposinf(found), [1, 0, 0, 0, 1])
        np.testing.assert_array_equal(found[[1, 3]], [5, 1])


def test_arrays_hold_what_is_known_of_scans_of_any_size(tmp_path):
    """Catches a log without odometry or truth that cannot be written."""
    bare = [shot(k, wheels=None) for k in range(2)]
    exports.write_arrays(tmp_path / "bare.npz", log_of(bare, None))
    found = read(tmp_path / "bare.npz")
    assert found.truth is None and [scan.odometry for scan in found] == [None, None]
    exports.write_arrays(tmp_path / "it.npz", log_of([*bare, LaserScan([1.0], [0.0])], None))
    assert [len(scan) for scan in read(tmp_path / "it.npz")] == [5, 5, 1]
    with pytest.raises(ValueError, match="must hold a scan"):
        exports.write_arrays(tmp_path / "it.npz", log_of([], None))


@pytest.mark.parametrize("ordered", [True, False])
def test_arrays_hold_all_that_a_log_knows(ordered, tmp_path):
    """Catches times of beams or codes that are lost on the way, and an order made up."""
    codes, delays = [0, 7, 0, 16, 0], [k * np.arange(5) * 0.01 for k in (1, 2, 3)]
    delays[0] = delays[0] if ordered else None
    scans = [replace(shot(k), codes=codes, delays=delays[k]) for k in range(3)]
    log = Log("three", scans, TRUTH, order_known=ordered)
    exports.write_arrays(tmp_path / "it.npz", log)
    found = read(tmp_path / "it.npz")
    assert_same_log(found, log)
    assert found.order_known == ordered
    for scan, known in zip(found, delays, strict=True):
        assert scan.codes.tolist() == codes and scan.max_range == 50.0
        assert (scan.delays is None) == (known is None)
        assert known is None or scan.delays.tolist() == known.tolist()


@pytest.mark.parametrize("largest", [8.179, 8.15, 32.7, 49.9])
def test_a_far_wall_stays_beside_beams_that_met_nothing(largest, tmp_path):
    """Catches an answer for nothing met that makes the reader guess another mode."""
    for angles in (HALF_TURN, HALF_TURN / 2):
        scan = LaserScan([largest, np.inf, 1, 1, 1], angles, 0.0, (1, 1, 1))
        found = written(tmp_path, Log("far", [scan] * 2, [(0, 0, 0), (1, 0, 0)]))
        assert found[0].valid.tolist() == [True, False, True, True, True]


def test_what_is_not_known_stays_so(tmp_path):
    """Catches zeros for a scan without odometry, `1 nan 0` for half of it, poses made up."""
    partly = shot(2, wheels=[*WHEELS[:2], (1, np.nan, 0)])
    found = written(tmp_path, log_of([shot(0), shot(1, wheels=None), partly]))
    assert [scan.odometry is None for scan in found] == [False, True, True]
    for log in (OLD, NEW):
        assert written(tmp_path, log_of(log.scans, None)).truth is None


def test_a_baseline_of_odometry_is_truth_only_where_the_format_can_tell(tmp_path):
    """Pins what the docstring says of poses that repeat the odometry."""
    plain = log_of([shot(k, place=(0, 0, 0)) for k in range(3)], None)
    assert_poses_equal(written(tmp_path, plain, odometry(plain)).truth, WHEELS, atol=1e-5)
    for log in (OLD, NEW):
        found = written(tmp_path, log, odometry(log))
        assert found.truth is None
        np.testing.assert_allclose(found[0].sensor_pose, AHEAD, atol=1e-5)


# ----------------------------------------------------------------------------- refused
UNEVEN, ASKEW = np.array([-1.0, -0.5, 0.1, 0.5, 1.0]), np.array([0, 0, 1e-6, 0, 0])
ENDLESS = [(0, 0, 0), (np.inf, 0, 0), (0, 0, 0)]
TIMELESS = Log("x", [*OLD.scans[:2], LaserScan([1.0], [0.0], time=np.nan)], TRUTH)
LATE = Log("late", [LaserScan([1.0], [0.0], time=1e13)])
AHEAD_TWICE = log_of([shot(0), shot(1, place=(0, 0, 0)), shot(2)])
THREE_PLACES = log_of([shot(0), shot(1, place=BACK), shot(2, place=(0, 0, 0))])
REFUSED = {
    "no scan": (Log("none", []), None, "log 'none' holds no scan"),
    "an endless pose": (OLD, ENDLESS, "poses must be finite"),
    "no time": (TIMELESS, None, "the time of scan 2 must"),
    "uneven": (log_of([shot(0), shot(1, UNEVEN), shot(2)]), None, "beams of scan 1 must be evenly"),
    "barely uneven": (
        log_of([shot(k, HALF_TURN / 2 + 1.2 * ASKEW) for k in range(3)]),
        None,
        "must",
    ),
    "clockwise": (log_of([shot(k, -HALF_TURN) for k in range(3)]), None, "counter-clockwise"),
    "no beam": (Log("x", [LaserScan([], [])], [(0, 0, 0)]), None, "scan 0 has no beam"),
    "two that look ahead": (AHEAD_TWICE, None, "of which one looks back, got 2: "),
    "three places": (THREE_PLACES, None, "got 3: "),
    "one pose a laser": (log_of(SHOTS[:3]), None, "read as the laser's place on the robot"),
    "late": (LATE, None, "expected seconds for the time"),
    "1.2 mm beside": (Log("x", NEW.scans[:1], [(0.0012, 0, 0)]), None, "as the laser's place"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_written_is_refused_and_leaves_no_file(name, tmp_path):
    """Catches a file that reads as another log, and half a file."""
    log, poses, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        exports.write_carmen(tmp_path / "it.log", log, poses)
    assert list(tmp_path.iterdir()) == []


def test_one_pose_elsewhere_is_fine_in_old_lines_and_without_odometry(tmp_path):
    """Catches a refusal where nothing is ambiguous, or by less than a millimetre."""
    written(tmp_path, Log("x", [replace(NEW[0], sensor_pose=(0, 0, 0))], [(0.001, 0, 0)]))
    written(tmp_path, log_of([shot(k, HALF_TURN / 2 + 0.8 * ASKEW) for k in range(3)]))
    bare = log_of([shot(0, HALF_TURN / 2, wheels=None)], TRUTH[:1])
    two = Log("two", [LaserScan([1.0, 2.0], [0.1, 0.4], 5.0)], [(1, 2, 1)])
    for log in (OLD[:1], bare, two):
        assert_same_log(written(tmp_path, log), log)


# -------------------------------------------------------------------------------- TUM
def read_tum(path):
    """Written from the format alone: times, x y z, and the axes that the quaternion turns to."""
    rows = np.loadtxt(path, comments="#", ndmin=2).reshape(-1, 8)
    qx, qy, qz, qw = rows[:, 4:].T
    ahead = np.stack([1 - 2 * (qy**2 + qz**2), 2 * (qx * qy + qz * qw), 2 * (qx * qz - qy * qw)], 1)
    up = np.stack([2 * (qx * qz + qy * qw), 2 * (qy * qz - qx * qw), 1 - 2 * (qx**2 + qy**2)], 1)
    return rows[:, 0], rows[:, 1:4], ahead, up


def test_another_reader_finds_the_trajectory(tmp_path):
    """Catches w first, half angles left out, a turn the wrong way round, and rows of nan."""
    partly = TRUTH.copy()
    partly[1, 2] = np.nan
    for poses, rows in ((TRUTH, [0, 1, 2]), (UNPLACED.truth, [0, 2]), (partly, [0, 2])):
        exports.write_tum(tmp_path / "t.tum", OLD, poses)
        times, places, ahead, up = read_tum(tmp_path / "t.tum")
        x, y, heading = TRUTH[rows].T
        np.testing.assert_allclose(times, OLD.times[rows], atol=1e-6, rtol=0)
        np.testing.assert_allclose(places, np.column_stack([x, y, 0 * x]), atol=1e-6)
        way = np.stack([np.cos(heading), np.sin(heading), 0 * x], 1)
        np.testing.assert_allclose(ahead, way, atol=1e-8)
        np.testing.assert_allclose(up, [(0, 0, 1)] * len(rows), atol=1e-8)
    done = Alignment(TRUTH, np.full(3, True), 0.0)
    exports.write_tum(tmp_path / "alike.tum", OLD, done)
    exports.write_tum(tmp_path / "t.tum", OLD, TRUTH)
    assert (tmp_path / "alike.tum").read_bytes() == (tmp_path / "t.tum").read_bytes()


# ------------------------------------------------------------- nothing that `read` refuses
ODD = [0.0, 1e-9, 1e-6, 0.5, 1.0, 8.19, 81.83, 1e3, 9.9e6, 1e7, 1e13, 1e300, -1.0, np.inf, np.nan]


def odd_scan(chance, angles):
    """A scan with some odd values; those that LaserScan itself refuses are left out."""

    def odd(usual):
        return chance.choice(ODD) if chance.random() < 0.02 else usual

    ranges = [odd(chance.uniform(0.1, 9)) for _ in angles]
    wheels = [odd(chance.uniform(-3, 3)) for _ in range(3)]
    place = chance.choice([(0, 0, 0), AHEAD, AHEAD, (9e6, 0, 0), (0, 0, 3.0)])
    try:
        return LaserScan(ranges, angles, odd(1.5), wheels, odd(30.0), place)
    except ValueError:
        return LaserScan(ranges, angles)


def odd_log(chance):
    step, count = chance.choice([0.0, 0.01, 0.1, 9.0]), chance.choice([1, 2, 5, 5, 9])
    angles = chance.choice([0.0, -0.3, 0.0, 6.2]) + step * np.arange(count)
    angles = angles if abs(angles).max() < 12.5 else angles % 12.5
    angles = HALF_TURN if chance.random() < 0.4 else angles
    scans = [odd_scan(chance, angles) for _ in range(chance.randint(1, 4))]
    poses = [[chance.choice([0.0, 1.0, 2.5, 9.9e6, np.nan]) for _ in range(3)] for _ in scans]
    return Log(chance.choice(["x", "é\n", "FLASER 1", "#"]), scans, poses)


def test_what_is_written_can_be_read(tmp_path):
    """Catches a log that its own reader refuses: 300 odd logs come back, or are not written."""
    chance, path, done = random.Random(3), tmp_path / "it.log", 0
    for number in range(300):
        log = odd_log(chance)
        try:
            exports.write_carmen(path, log)
        except ValueError:
            assert not path.exists()
            continue
        found = read(path)
        assert len(found) == len(log), number
        for a, b in zip(found, log, strict=True):
            shown = b.valid & (b.ranges > 1e-5) & (b.ranges < 8.18)
            np.testing.assert_allclose(a.ranges[shown], b.ranges[shown], atol=1e-6)
            np.testing.assert_allclose(a.angles, b.angles, atol=2e-6)
        path.unlink()
        done += 1
    assert 50 < done < 250
    assert list(tmp_path.iterdir()) == []
