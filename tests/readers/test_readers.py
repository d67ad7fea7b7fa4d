"""CARMEN logs of the old kind, and what all readers share: beams, no-return values, arguments."""

import gzip
import pickle
import re
import sys
import zipfile

import numpy as np
import pytest
from log_samples import CARMEN, ODOMETRY, TIMES, TRUTH, flaser, robotlaser, row, text

from segmap import poses, readers
from segmap.readers import LogError


def beams(log):
    return np.degrees(log[0].angles)


@pytest.mark.parametrize(
    ("count", "first", "last", "step"),
    [(180, -90, 89, 1), (181, -90, 90, 1), (360, -90, 89.5, 0.5), (361, -90, 90, 0.5)],
)
def test_even_numbers_of_beams_leave_the_end_out(read, count, first, last, step):
    """Spreading 180 beams over both ends turns walls by up to a degree."""
    log = read(text([flaser(TRUTH[0], ODOMETRY[0], ranges=" ".join(["2.5"] * count))]))
    assert beams(log)[[0, -1]] == pytest.approx([first, last])
    assert np.diff(beams(log)) == pytest.approx(step)


@pytest.mark.parametrize(
    ("ranges", "limit", "valid"),
    [
        ("1 7.99 8.18 8.19", 8.18, [1, 1, 0, 0]),
        ("8.17 8.2", 8.18, [1, 0]),
        ("8.18 8.21", np.inf, [1, 1]),
        ("32.75 32.77", 32.76, [1, 0]),
        ("32.76 32.78", np.inf, [1, 1]),
        ("1 8.18 32.76 32.5", 32.76, [1, 1, 0, 1]),
        ("1 8.18 81.83 81.91 50 51.16 49.9", 50, [1, 1, 0, 0, 0, 0, 1]),
    ],
)
def test_no_return_depends_on_the_measuring_mode(read, ranges, limit, valid):
    """A fixed list of sentinels would drop real walls at 8.18 m, or keep false ones.

    Where no beam shows the mode's word for nothing, nobody knows how far the sensor sees.
    """
    log = read(text([flaser(TRUTH[0], ODOMETRY[0], ranges=ranges)]))
    assert log[0].max_range == limit
    assert log[0].valid.tolist() == [bool(v) for v in valid]
    assert np.isposinf(log[0].ranges[~log[0].valid]).all()


def test_the_mode_is_that_of_the_whole_log_and_odd_values_are_errors(read):
    """Deciding scan by scan would call a wall at 8.18 m in a narrow place no return."""
    near, far = (flaser(TRUTH[0], ODOMETRY[0], ranges=r) for r in ("1 8.18", "1 81.83"))
    assert read(text([near, far]))[0].valid.tolist() == [True, True]
    log = read(text([flaser(TRUTH[0], ODOMETRY[0], ranges="1 -5 nan 0 inf -inf")]))
    assert log[0].valid.tolist() == [True, False, False, False, False, False]
    assert np.isnan(log[0].ranges).tolist() == [False, True, True, True, False, True]


def test_parameters_of_a_recorder_that_are_no_places(read):
    """Catches a device's name that is read as a number."""
    said = ["PARAM laser_front_dev /dev/ttyS0", "PARAM robot_max_t_vel 0.5", "PARAM"]
    assert len(read(text([*said, *CARMEN.splitlines()]))) == len(TIMES)


@pytest.mark.parametrize(
    ("stated", "heading"),
    [
        (None, np.pi),
        ("0.0", np.pi),
        ("0.3", 0.3 + np.pi),
        ("3.0", 3.0),
        ("3.141592653589793", np.pi),
    ],
)
def test_offsets_are_honoured_and_rear_lasers_face_backwards(read, stated, heading):
    """A rear scan drawn forwards is a building turned inside out, and so is one turned twice."""
    lines = ["PARAM robot_frontlaser_side_offset -0.2", "PARAM robot_frontlaser_angular_offset 0.4"]
    lines += ["PARAM robot_rearlaser_offset -0.25 robot 0"]
    lines += [] if stated is None else [f"PARAM robot_rearlaser_angular_offset {stated}"]
    rear = flaser(TRUTH[0], ODOMETRY[0], keyword="RLASER", ranges="1 2 1")
    log = read(text([*lines, flaser(TRUTH[0], ODOMETRY[0]), rear]))
    assert log[0].sensor_pose.tolist() == [0, -0.2, 0.4]
    np.testing.assert_allclose(log[1].sensor_pose, (-0.25, 0, heading), atol=1e-9)


def test_lines_without_times_have_none_and_nan_poses_are_no_truth(read):
    log = read(text(map(flaser, TRUTH, ODOMETRY)))
    assert np.isnan(log.times).all()
    assert log.truth == pytest.approx(np.array(TRUTH))
    log = read(text([flaser([np.nan] * 3, ODOMETRY[0], 1.0), flaser(TRUTH[1], ODOMETRY[1], 2.0)]))
    assert np.isnan(log.truth[0]).all() and log.truth[1] == pytest.approx(TRUTH[1])
    assert "truth for 1" in repr(log)


def test_lines_without_poses_take_the_odometry_from_odom_lines(read):
    lines = [f"ODOM {k} 0 0 0 0 0 {10.0 + k} robot 0" for k in range(2)]
    log = read(
        text([*lines, "RAWLASER1 0 -1.57 3.14 1.57 80 0 0 2 1 2 0 10.5 robot 0", "FLASER 1 2"])
    )
    assert log[0].odometry.tolist() == [0.5, 0, 0]
    assert log[1].odometry is None and log.truth is None


def test_a_clock_that_is_set_back_goes_on_in_scans_too(read):
    """Catches scans of the clock before, beside poses that were put right."""
    lines = []
    for k in range(20):
        time = f"{10.0 + k - 5 * (k > 9)} robot 0"
        lines += [
            f"ODOM {k} 0 0 0 0 0 {time}",
            f"RAWLASER1 0 -1.57 3.14 1.57 80 0 0 2 1 2 0 {time}",
        ]
    log = read(text(lines))
    assert np.diff(log.times).tolist() == [1.0] * 19
    assert log.odometry[:, 0].tolist() == [*range(20)]


AHEAD = [flaser(poses.compose(o, (0.3, 0, 0)), o, 1.0) for o in ODOMETRY]


@pytest.mark.parametrize(
    "lines",
    [
        [flaser(t, t) for t in TRUTH],
        *(
            [line, *(flaser(t, t, 1.0) for t in TRUTH)]
            for line in ("ODOM 0 0 0 0 0 0 1 r 0", "PARAM robot_length 0.6", "SYNC x")
        ),
        ["PARAM robot_frontlaser_offset 0.3", *AHEAD],  # the laser's offset is no correction
    ],
)
def test_poses_that_repeat_the_odometry_are_no_truth(read, lines):
    """A map drawn with them as truth would be the raw one."""
    assert read(text(lines)).truth is None


def test_poses_of_a_mapper_and_corrected_ones_are_truth(read):
    """A mapper writes its poses twice; one corrected line makes the log a corrected one."""
    log = read(text(flaser(t, t, time) for t, time in zip(TRUTH, TIMES, strict=True)))
    assert log.truth == pytest.approx(np.array(TRUTH)) and np.isnan(log.odometry).all()
    for times in ((), TIMES):
        lines = [(ODOMETRY[0], ODOMETRY[0], *times[:1]), (TRUTH[1], ODOMETRY[1], *times[1:2])]
        log = read(text(flaser(*line) for line in lines))
        assert log.truth == pytest.approx(np.array([ODOMETRY[0], TRUTH[1]]))
        assert log.odometry == pytest.approx(np.array(ODOMETRY))


def test_what_gmapping_wrote_is_truth_and_no_odometry(read):
    """Catches a corrected log that is refused for its NEFF lines, or taken for perfect odometry."""
    scans = [flaser(t, t, time) for t, time in zip(TRUTH, TIMES, strict=True)]
    where = zip(TRUTH, TIMES, strict=True)
    odom = [f"ODOM {x + 0.0003} {y} {h} 0 0 0 {time} h {time}" for (x, y, h), time in where]
    lines = [f"{line}\nNEFF 29.3" for line in scans]
    log = read(text([*odom, *lines]))
    assert log.truth == pytest.approx(np.array(TRUTH))
    assert np.isnan(log.odometry).all() and not log.skipped
    strange = read(text([*lines, "SPREAD 3"]))
    assert strange.skipped == (1, "lines of no known meaning, SPREAD first")
    with pytest.raises(LogError, match="expected a line of a CARMEN log, got 'SPREAD'"):
        read(text([*lines, "SPREAD 3 4"]))
    with pytest.raises(LogError, match="got 'FLAS'"):
        read(text([*lines, "FLAS"]))


def test_every_line_of_gmapping_is_known_and_its_robotlaser_lines_are_truth(read):
    """Catches a log of gfs2log that is refused, or whose only poses are taken for odometry."""
    lines = [
        f"WEIGHT {k}\n{robotlaser(TRUTH[k], TRUTH[k], TIMES[k])}\n"
        f"ODOM {row(TRUTH[k])} 0 0 0 0 p 0\nNEFF 0.9 0 pippo 0\nENTROPY 1 2 3 0 pippo 0\nMARKER x"
        for k in range(2)
    ]
    log = read(text(lines))
    assert log.truth == pytest.approx(np.array(TRUTH)) and not log.skipped
    assert np.isnan(log.odometry).all()


def test_raw_odometry_beside_gmappings_poses_is_odometry(read):
    """gfs2log -odom: the ODOM lines are the wheels', and were dropped with the mapper's."""
    odom = [f"ODOM {row(o)} 0 0 0 {t} p {t}" for o, t in zip(ODOMETRY, TIMES, strict=True)]
    scans = [flaser(t, t, time) + "\nNEFF 3" for t, time in zip(TRUTH, TIMES, strict=True)]
    log = read(text([*odom, *scans]))
    assert log.odometry == pytest.approx(np.array(ODOMETRY), abs=1e-6)
    assert log.truth == pytest.approx(np.array(TRUTH))


def test_the_name_is_the_files(read, tmp_path):
    """Ends of lines of other systems, blank lines and comments change nothing."""
    assert read(CARMEN, "b.25.log").name == "b.25"
    odd = "\r\n# x\r\n   # y\n\n" + CARMEN.replace("\n", "\r\n\r\n")
    (tmp_path / "run.log.gz").write_bytes(gzip.compress(odd.encode()))
    log = readers.read(str(tmp_path / "run.log.gz"))
    assert log.name == "run" and log.truth.tolist() == read(CARMEN).truth.tolist()


def test_errors_survive_the_way_from_another_process(read):
    """Exceptions with arguments of their own break process pools unless they pickle."""
    with pytest.raises(LogError) as caught:
        read("FLASER 2 1 2\nFLASER 3 1 2\n")
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value) and again.line == 2


def test_a_log_is_bundled_or_lies_in_another_package_or_those_that_are_bundled_are_told(
    monkeypatch, tmp_path
):
    """Catches names in the order of a disk, and an archive that is not found in its package."""
    with pytest.raises(ValueError, match="got 'malga'") as caught:
        readers.load("malga")
    known = re.findall(r"'(\w+)'", str(caught.value))[:-1]
    assert known == sorted(known) and "malaga" in known
    (folder := tmp_path / "rtbdata" / "data").mkdir(parents=True)
    (folder.parent / "__init__.py").touch()
    with zipfile.ZipFile(folder / "killian.g2o.zip", "w") as packed:
        packed.writestr("killian.g2o", text([robotlaser((0, 0, 0), (0, 0, 0), 1.0)]))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "rtbdata", raising=False)
    assert len(readers.load("killian")) == 1


def test_what_is_no_log_is_told_apart_from_a_damaged_one(read, tmp_path):
    """Catches a folder of logs whose README counts as a log that failed."""
    (tmp_path / "README.md").write_text("# Logs\n")
    (tmp_path / "cut.log").write_text("FLASER 3 1.0 2.0\n")
    (tmp_path / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n\x00\xff\xfe")
    for name in ("README.md", "picture.png", "."):
        with pytest.raises(readers.UnknownFormat):
            readers.format_of(tmp_path / name)
    assert readers.format_of(tmp_path / "cut.log") == "CARMEN"
    with pytest.raises(readers.LogError, match="does not exist") as fault:
        readers.format_of(tmp_path / "none.log")
    assert not isinstance(fault.value, readers.UnknownFormat)
