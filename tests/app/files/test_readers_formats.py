"""CARMEN logs of the new kind, g2o, Rawseeds, Hokuyo text and CoreSLAM."""

import gzip
import re

import numpy as np
import pytest
from log_samples import (
    CARMEN_NEW,
    CORESLAM,
    GROUNDTRUTH,
    HOKUYO,
    ODOMETRY,
    ODOMETRY_CSV,
    RAWSEEDS,
    SICK,
    SINGLE_FILES,
    TIMES,
    TRUTH,
    robotlaser,
    row,
    text,
)

from segmap import poses, readers
from segmap.readers import LogError


class TestRobotLaser:
    @pytest.mark.parametrize(
        ("old", "new", "degrees"),
        [
            ("-1.570796 3.141593 0.785398", "-0.5 2.0 0.25", np.degrees([-0.5, 0.5])),
            ("0.785398", "0.0", [-90, 90]),  # without a resolution they fill the field of view
        ],
    )
    def test_beams_start_where_the_line_says(self, read, old, new, degrees):
        """The rule for half a turn does not hold for a sensor that states its angles."""
        line = robotlaser((0, 0, 0), (0, 0, 0), 1.0).replace(old, new)
        angles = np.degrees(read(text([line]))[0].angles)
        assert angles == pytest.approx(np.linspace(*degrees, 5), abs=1e-4)

    def test_a_steady_offset_is_the_lasers_place_on_the_robot(self, read):
        place = (0.2, 0.1, 0.05)
        lines = [robotlaser(poses.compose(o, place), o, 1.0) for o in (*ODOMETRY, *TRUTH)]
        log = read(text(lines))
        assert log.truth is None and log[0].sensor_pose == pytest.approx(place)

    def test_a_changing_offset_is_a_correction(self, read):
        log = read("PARAM robot_frontlaser_offset 0.3 r 0\n" + CARMEN_NEW)
        assert poses.compose(log.truth, (0.3, 0, 0)) == pytest.approx(np.array(TRUTH))
        assert log.odometry == pytest.approx(np.array(ODOMETRY))

    def test_remissions_are_no_ranges_and_the_stated_maximum_is_no_return(self, read):
        line = robotlaser((0, 0, 0), (0, 0, 0), 7.5, remissions="9 9 9 9 9")
        log = read(text([line.replace(" 50.0 ", " 2.5 ")]))
        assert len(log[0]) == 5 and log[0].time == 7.5
        assert log[0].max_range == 2.5 and log[0].valid.tolist() == [True, True, *[False] * 3]

    def test_rear_and_front_have_each_its_place(self, read):
        rear = poses.compose(ODOMETRY[1], (-0.2, 0, np.pi))
        front = robotlaser(ODOMETRY[0], ODOMETRY[0], 1.0)
        log = read(text([front, robotlaser(rear, ODOMETRY[1], 2.0, keyword="ROBOTLASER2")]))
        assert log[0].sensor_pose.tolist() == [0, 0, 0]
        assert abs(log[1].sensor_pose) == pytest.approx([0.2, 0, np.pi], abs=1e-5)


class TestG2o:
    def test_a_scan_without_a_vertex_of_its_own_has_no_truth(self, read):
        """A vertex used twice would put two scans into one place."""
        laser = robotlaser(ODOMETRY[1], ODOMETRY[1], 3.0)
        log = read(
            text([f"VERTEX2 0 {row(TRUTH[0])}", laser, laser, "FIX 0", "EDGE_PRIOR_SE2 0 0"])
        )
        assert np.isfinite(log.truth).all(axis=1).tolist() == [True, False]

    def test_poses_of_all_zero_are_no_odometry(self, read):
        laser = robotlaser((0, 0, 0), (0, 0, 0), 1.0)
        log = read(text([f"VERTEX2 0 {row(TRUTH[0])}", laser]))
        assert log[0].odometry is None and log.truth == pytest.approx(np.array(TRUTH[:1]))


class TestRawseeds:
    def test_odometry_and_truth_are_those_of_the_scans_times(self, read):
        """Taking the nearest row instead is wrong by what the robot moves in between."""
        half = SICK.replace(str(TIMES[1]), "1000.75")
        log = read(RAWSEEDS | {"SICK_FRONT.csv": half})
        assert log.odometry[1] == pytest.approx([0.5, 0, 0.05])
        assert log.truth[1] == pytest.approx([5.45, 2.25, 0.56])

    def test_outside_of_them_and_in_long_gaps_there_is_none(self, read):
        """The cameras that gave the truth saw the robot in some places only."""
        late, long = (
            SICK.replace(str(TIMES[1]), "2000.0"),
            GROUNDTRUTH.replace("1001.25", "1001.45"),
        )
        log = read(RAWSEEDS | {"SICK_FRONT.csv": late}, "late")
        assert log[1].odometry is None and np.isnan(log.truth[1]).all()
        log = read(RAWSEEDS | {"run-GROUNDTRUTH.csv": long}, "long")
        assert np.isfinite(log.truth).all(axis=1).tolist() == [True, False]

    def test_the_front_sick_goes_first_then_the_hokuyo(self, read):
        assert len(read(RAWSEEDS, "all")[0]) == 181
        log = read({k: v for k, v in RAWSEEDS.items() if "SICK" not in k}, "some")
        assert np.diff(log[0].angles) == pytest.approx(2 * np.pi / 1024)
        assert log[0].angles[340] == 0
        assert log[0].codes[-1] == 7 and np.isnan(log[0].ranges[-1]) and log[0].ranges[0] == 1.25

    def test_the_offset_is_in_quarter_degrees_and_rear_lasers_face_backwards(self, read):
        log = read(SICK.replace("181, 0,", "181, 2,"))
        assert np.degrees(log[0].angles[[0, -1]]) == pytest.approx([-89.5, 90.5])
        log = read({"SICK_REAR.csv": SICK}, "rear")
        assert log[0].points()[90] == pytest.approx([-2.5, 0])

    def test_ground_truth_alone_is_no_log_but_a_trajectory(self, read, tmp_path):
        with pytest.raises(LogError, match=r"holds poses and no scan.*read_trajectory"):
            read(GROUNDTRUTH, "GROUNDTRUTH.csv")
        with pytest.raises(LogError, match="holds poses and no scan"):
            read(ODOMETRY_CSV, "ODOMETRY_XYT.csv")
        times, where = readers.read_trajectory(tmp_path / "GROUNDTRUTH.csv")
        assert times == pytest.approx(TIMES) and where == pytest.approx(np.array(TRUTH))

    def test_skipped_lines_of_all_files_are_counted(self, read):
        damaged = {k: v + "1,2\n" for k, v in RAWSEEDS.items()}
        log = read(damaged, on_error="skip")
        assert log.skipped.lines == 3 and "SICK_FRONT.csv, line 3" in log.skipped.reason


#: The head of a Hokuyo text.
URG = "# urg_mm angle_rad\n"


class TestHokuyoText:
    def test_codes_are_kept_and_are_no_ranges(self, read):
        log = read(HOKUYO)
        assert log[0].codes.tolist() == [0] * 21 + [7]
        assert np.isposinf(log[0].ranges[20]) and np.isnan(log[0].ranges[21])
        assert log[0].ranges[:2] == pytest.approx([1.0, 1.001])
        assert log[0].angles[0] == pytest.approx(-0.1)

    def test_files_are_read_in_the_order_of_their_numbers(self, read):
        """By name scan10 would come before scan2."""
        files = {f"room1_scan{k}.txt": f"{URG}{100 * k} 0.0\n" for k in (10, 2, 1)}
        log = read(files | {"README": "no number"})
        assert [scan.ranges[0] for scan in log] == pytest.approx([0.1, 0.2, 1.0])
        assert np.isnan(log.times).all() and log[0].delays is None and log[0].max_range == np.inf

    def test_a_damaged_file_is_an_error_or_left_out(self, read):
        files = {"1.txt": f"{URG}1000 0.0\n", "2.txt": "what\n", "3.txt": f"{URG}9 0.0\nx 1\n"}
        log = read(files, "skip", on_error="skip")
        assert len(log) == 2 and log.skipped.lines == 2 and "2.txt" in log.skipped.reason
        with pytest.raises(LogError, match=r"2\.txt: "):
            read(files, "raise")


class TestCoreSlam:
    def test_units_and_place_of_the_laser(self, read):
        log = read(CORESLAM)
        assert log.times == pytest.approx([212.387282, 212.485282, 212.583282])
        assert log[0].ranges[0] == 1.5 and len(log[0]) == 683
        assert log[0].points()[341] == pytest.approx([1.645, 0])
        assert np.degrees(np.ptp(log[0].angles)) == pytest.approx(239.77, abs=0.01)
        np.testing.assert_allclose(log[0].delays, np.arange(683) * 0.1 / 1024, atol=1e-15)

    def test_faster_right_wheels_turn_left(self, read):
        """With the wheels swapped the map is that of a mirrored building."""
        log = read(CORESLAM)
        turn = 2 * 10 * 2 * np.pi * 0.077 / 2000 / 0.330
        assert log.odometry[2, 2] == pytest.approx(turn) and log.odometry[2, 1] > 0
        assert log.odometry[0].tolist() == [0, 0, 0]

    def test_arcs_are_exact(self, read):
        """Straight steps, or ones as long as the arc, do not close a circle of unequal parts."""
        ticks = 2000 / (2 * np.pi * 0.077)
        whole = 2 * np.pi * 0.330 * ticks
        beams = " 0" * 20 + " 1500" * 683

        def end(*driven):  # by the left and the right wheel, in all
            lines = (f"{k} 0 {round(a)} {round(b)}{beams}" for k, (a, b) in enumerate(driven, 1))
            return read(text(lines)).odometry[-1]

        circle = [(0, whole * share) for share in (0, 0.1, 0.6, 0.75, 1)]
        x, y, turn = end(*circle)
        assert (x, y, np.sin(turn)) == pytest.approx((0, 0, 0), abs=1e-3)
        ahead = [(0, 0), (0, whole / 4), (ticks, whole / 4 + ticks)]  # a quarter turn, then 1 m
        assert end(*ahead) == pytest.approx([0.165, 1.165, np.pi / 2], abs=1e-3)


HALF = [-90, -45, 0, 45, 90]
NEAR = [0, 0, 0]
#: Of each sample: whether it tells times, odometry and truth; the laser's place, its reach.
ROOM = {
    "carmen": ("times odometry truth", [0.3, 0, 0], 50),
    "g2o": ("times odometry truth", NEAR, 50),
    "gmapping": ("times odometry truth", NEAR, 50),
    "dpslam": ("odometry", NEAR, 8.18),
}


@pytest.mark.parametrize("name", ROOM)
def test_every_format_tells_of_the_same_room(name, tmp_path):
    """Catches fields shifted by one, a laser's pose taken for the robot's, units and beams lost.

    A name says nothing: every file here is called `run`.
    """
    told, place, reach = ROOM[name]
    content = SINGLE_FILES[name].encode()
    for data in (content, gzip.compress(content)):
        (tmp_path / "run").write_bytes(data)
        log = readers.read(tmp_path / "run")
        times = TIMES if "times" in told else [np.nan] * 2
        assert log.times == pytest.approx(times, nan_ok=True)
        wheels = np.array(ODOMETRY) if "odometry" in told else np.full((2, 3), np.nan)
        assert log.odometry == pytest.approx(wheels, nan_ok=True)
        seen = poses.compose(log.truth, (0.3, 0, 0)) if name == "carmen" else log.truth
        assert (seen is None) == ("truth" not in told)
        assert seen is None or seen == pytest.approx(np.array(TRUTH), abs=1e-6)
        assert log[0].sensor_pose == pytest.approx(place) and log[0].max_range == reach
        assert log[0].ranges == pytest.approx([1.5, 2.0, 2.5, np.inf, 3.0])
        assert np.degrees(log[0].angles) == pytest.approx(HALF, abs=1e-3)


def test_every_format_is_asked_and_has_a_sample(tmp_path):
    """Catches a reader that nobody registered, and one that no test of damaged files meets."""
    path, found = tmp_path / "it", set()
    for content in SINGLE_FILES.values():
        path.write_text(content)
        found.add(readers.format_of(path))
    path.write_text("nothing\n")
    with pytest.raises(LogError) as unknown:
        readers.read(path)
    names = re.search(r"^Known formats: (.*)\.$", str(unknown.value), re.MULTILINE)[1].split(", ")
    assert {*names} - found == {"ROS bag", "NPZ"}  # of bytes: they have tests of their own
    assert found <= {*names} and len(found) == 9
