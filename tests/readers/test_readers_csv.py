"""Logs of cheap sensors: CSV, dumps of RPLidar and LD19, arrays; and folders of other things."""

import gzip

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from log_samples import CARMEN, CSV, HOKUYO, LD19, NPZ, ODOMETRY, RPLIDAR, TIMES, TRUTH, npz, text

import segmap
from segmap import readers
from segmap.readers import LogError, UnknownFormat, read_csv

quick = settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
ROWS = "0{0}1500\n90{0}0\n180{0}2000\n0{0}1600\n90{0}\n180{0}inf\n"
COLUMNS = ["angle_deg", "range_mm"]


@pytest.fixture
def written(tmp_path):
    def write(content, name="some.csv"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


class TestHeader:
    @pytest.mark.parametrize(
        ("head", "mark"),
        [
            ("angle_deg,range_mm", ","),
            ("Angle [deg], Range [mm]", ", "),
            ("theta(°);dist(mm)", ";"),
            ("# angle [degrees]\tdistance [millimeters]", "\t"),
            ('"Angle (deg)","Distance (mm)"', ","),
            ("angle [deg] range [mm]", " "),
            ("\ufeffangles.deg,ranges.mm", ","),
        ],
    )
    def test_ways_to_write_one(self, read, head, mark):
        """Catches a unit that is overlooked: 1500 m, or 90 radians."""
        rows = ROWS if mark not in " \t" else ROWS.replace("90{0}\n", "90{0}nan\n")
        log = read(f"{head}\n{rows.format(mark)}")
        assert len(log) == 2 and np.isnan(log.times).all() and not log.skipped
        assert np.degrees(log[0].angles) == pytest.approx([0, 90, 180])
        assert log[0].ranges[[0, 2]].tolist() == [1.5, 2] and np.isnan(log[0].ranges[1])
        assert log[1].valid.tolist() == [True, False, False] and np.isposinf(log[1].ranges[2])

    @pytest.mark.parametrize(
        ("head", "reason"),
        [
            (
                "angle,range_mm",
                "line 1: the unit of 'angle' is not said: .*--columns angle_deg,range_mm",
            ),
            ("angle_deg,range", "the unit of 'range' is not said: .*read_csv"),
        ],
    )
    def test_what_it_does_not_say_is_not_guessed(self, read, head, reason):
        with pytest.raises(LogError, match=reason):
            read(head + "\n0,1.5,0\n")

    def test_time_and_scan(self, read):
        """Catches a scan that is cut by its angles though it is numbered; the first time counts."""
        rows = "angle_rad,range_m,time_us,scan_id\n1,2,1500000,7\n0,2,1600000,7\n1,3,1700000,9\n"
        log = read(rows)
        assert log.times.tolist() == [1.5, 1.7] and [len(scan) for scan in log] == [2, 1]

    def test_other_formats_with_words_stay_what_they_are(self, read):
        assert len(read("# range angle in words only\n" + CARMEN)) == 2
        assert len(read(HOKUYO)[0]) == 22


class TestReadCsv:
    def test_a_packed_file(self, written):
        log = read_csv(written(gzip.compress(CSV.encode()), "run.csv.gz"))
        assert log.name == "run" and [len(scan) for scan in log] == [8, 8]

    @pytest.mark.parametrize("columns", [COLUMNS, "angle_deg, range_mm", ("angle_deg", "range_mm")])
    @pytest.mark.parametrize("head", ["", "Winkel,Abstand\n", "angle,range\n"])
    def test_columns_named_by_the_caller(self, written, columns, head):
        log = read_csv(written(head + ROWS.format(",")), columns=columns)
        assert log.name == "some" and [len(scan) for scan in log] == [3, 3]
        assert log[0].ranges[0] == 1.5 and not log.skipped

    def test_clockwise_angles_are_turned_round(self, read, written):
        """A map of a clockwise sensor that is not turned is the mirror of the room."""
        said = read_csv(written("0 1\n90 2\n"), columns="angle_deg,range_m", clockwise=True)
        for log in (
            said,
            read("quality,angle_deg_cw,weather,range_cm\n47,0,rain,100\n9,90,,200\n"),
        ):
            assert log[0].points() == pytest.approx(np.array([(0, -2), (1, 0)]))

    @pytest.mark.parametrize(
        ("content", "columns", "reason"),
        [
            (CSV, ["angle", "range_mm"], "the unit of 'angle' is not said"),
            (CSV, ["angle_deg"], "no column is the range"),
            (CSV, ["angle_deg", "theta_rad", "range_m"], "both columns of the angle"),
            (CSV, 3, "columns must be a list of names"),
            (CSV, [1, 2], "columns must be a list of names"),
            ("0,1\n", None, r"name the columns, columns=\['angle_deg'"),
        ],
    )
    def test_columns_that_do_not_say_enough(self, written, content, columns, reason):
        with pytest.raises(ValueError, match=reason):
            read_csv(written(content), columns=columns)


class TestTurns:
    @pytest.mark.parametrize(
        ("angles", "lengths"),
        [
            ([350, 10, 30, 355, 5], [1, 3, 1]),
            ([0, 120, 240, 0, 120, 240], [3, 3]),
            ([240, 120, 0, 240, 120, 0], [3, 3]),
            ([-135, 0, 135, -135, 0, 135], [3, 3]),
            ([0, 90, 89.5, 180, 270, 1, 90], [5, 2]),
            ([5, 5, 5], [3]),
            ([7], [1]),
            ([0, 90, 0], [2, 1]),  # as many steps to and fro: they go up
            ([9, 9, 6, 6, 3, 3, 0, 0, 9], [8, 1]),  # steps of nothing do not count
            ([0, 0, 3, 3, 6, 6, 9, 9, 0], [8, 1]),
            ([0, 8, 4, 8], [4]),  # back by half of them, and no more
        ],
    )
    def test_a_scan_ends_where_the_angle_wraps(self, written, angles, lengths):
        """Catches a cut at every step back, and one that a small field of view never reaches."""
        rows = text(f"{angle},1" for angle in angles)
        log = read_csv(written(rows), columns="angle_deg,range_m")
        assert [len(scan) for scan in log] == lengths

    @pytest.mark.parametrize("before", ["", "1,1\n9,1\n"])  # the second of two, too
    def test_a_file_without_an_end_of_scan_is_refused(self, written, before):
        with pytest.raises(LogError, match="at most 100000 beams in a scan"):
            read_csv(written(before + "1,1\n" * 100_001), columns="angle_deg,range_m")

    @given(
        st.lists(
            st.lists(st.floats(0.001, 1e4), min_size=2, max_size=9), min_size=1, max_size=4
        ),
        st.booleans(),
        st.sampled_from(["angle_rad,range_m", "angle_deg,range_cm,time_ms"]),
    )  # fmt: skip
    @quick
    def test_what_was_written_is_read(self, written, scans, numbered, head):
        """Every number of the file stands in the log, in metres and radians."""
        turn, far, full = (1, 1, 6.0) if "rad" in head else (np.pi / 180, 0.01, 350.0)
        angles = [np.linspace(0, full, len(scan)).tolist() for scan in scans]
        lines = [
            f"{a!r},{r!r},{k}{f',{k}' if numbered else ''}"
            for k, (turned, scan) in enumerate(zip(angles, scans, strict=True))
            for a, r in zip(turned, scan, strict=True)
        ]
        columns = head if "time" in head else head + ",other"
        path = written(text([columns + (",scan" if numbered else ""), *lines]))
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("segmap.arrays.unit_checks.check_ranges", lambda *arguments: None)
            log = readers.read(path)
        assert [s.ranges.tolist() for s in log] == [[r * far for r in scan] for scan in scans]
        assert [s.angles.tolist() for s in log] == [[a * turn for a in turned] for turned in angles]
        times = np.arange(len(scans)) * (1e-3 if "time" in head else np.nan)
        assert log.times == pytest.approx(times, nan_ok=True)


class TestDumps:
    @pytest.mark.parametrize(("sample", "times"), [(RPLIDAR, [np.nan] * 2), (LD19, [0, 8])])
    def test_clockwise_degrees_and_millimetres(self, read, sample, times):
        """Catches the mirror image, and metres out of millimetres."""
        log = read(sample)
        assert [len(scan) for scan in log] == [8, 8] and not log.skipped
        assert log.times == pytest.approx(times, nan_ok=True)
        assert np.degrees(log[0].angles) == pytest.approx(np.arange(-315, 1, 45))
        assert log[0].points()[-3] == pytest.approx([0, -0.24])  # 90 degrees are on the right

    def test_each_beam_keeps_its_time(self, read):
        """Catches delays in the order of the file, which was turned round, and a common time."""
        shaken = LD19.replace("stamp(ns):1000000000", "stamp(ns):2500000000")
        for sample, delays in ((LD19, range(8)), (shaken, [0, 2, 2.5, 3, 4, 5, 6, 7])):
            turn = read(sample)[0]
            assert sorted(turn.delays) == pytest.approx(delays) and turn.time == 0
            assert turn.delays[np.argmax(turn.angles)] == 0  # the first beam looks ahead
        alike = "angle_deg,range_mm,time_s\n0,1000,2\n90,1000,2\n180,1000,2\n"
        assert read(alike)[0].delays is read(RPLIDAR)[0].delays is None

    def test_nothing_measured(self, read):
        log = read("theta: 1.00 Dist: 00000.00 Q: 0\ntheta: 2.00 Dist: 00010.00 Q: 4\n")
        assert log[0].valid.tolist() == [True, False]

    def test_a_stamp_without_unit_is_left_out_and_centimetres_are_honoured(self, read):
        log = read(LD19.replace("(ns)", "").replace("(mm)", "(cm)"))
        assert np.isnan(log.times).all() and log[0].ranges[-1] == 1.5
        assert read(LD19.replace("(mm)", "(m)"))[0].ranges[-1] == 150
        assert len(read(text(["angle:1.5,distance(mm):200,intensity:3"] * 3))[0]) == 3

    def test_a_scan_of_slamtecs_programs(self, read):
        log = read(
            "#RPLIDAR SCAN DATA\n#COUNT=2\n#Angule\tDistance\tQuality\n0.5 250.0 47\n90 0 0\n"
        )
        assert np.degrees(log[0].angles) == pytest.approx([-90, -0.5])
        assert log[0].ranges[1] == 0.25 and np.isnan(log[0].ranges[0])


class TestNpz:
    def log(self, written, **held):
        return readers.read(written(npz(**held), "mine.npz"))

    def test_all_arrays(self, written):
        log = readers.read(written(NPZ, "mine.npz"))
        assert log.name == "mine" and log.times.tolist() == list(TIMES)
        assert log.odometry.tolist() == [list(o) for o in ODOMETRY]
        assert log.truth.tolist() == [list(t) for t in TRUTH]
        assert log[0].valid.tolist() == [True, True, False] and np.isnan(log[1].ranges[1])

    def test_delays_and_what_belongs_to_them_come_back(self, written, tmp_path):
        """Catches scans without delays that get zeros, and an order that is believed."""
        shots = [segmap.LaserScan([1, 2], [0, 1], delays=d) for d in ([0, 0.1], None)]
        track = [(0.0, 1, 2, 3), (1.0, 2, 2, 3)]
        log = segmap.Log("it", shots, track=track, order_known=False)
        segmap.exports.write_arrays(tmp_path / "it.npz", log)
        found = readers.read(tmp_path / "it.npz")
        assert found[0].delays.tolist() == [0, 0.1] and found[1].delays is None
        assert found.track.tolist() == log.track.tolist() and not found.order_known
        plain = self.log(written, ranges=[1, 2], angles=[0, 1], delays=[0.5, 0])
        assert plain[0].delays.tolist() == [0.5, 0] and plain.order_known and plain.track is None

    def test_ranges_and_angles_are_enough(self, written):
        log = self.log(written, ranges=[[1, 2], [3, 4]], angles=[[0, 1], [1, 2]])
        assert np.isnan(log.times).all() and log.truth is None
        assert log[1].odometry is None and log[1].angles.tolist() == [1, 2]
        assert len(self.log(written, ranges=[1.0, 2.0], angles=[0.0, 1.0])) == 1

    def test_the_laser_on_the_robot_and_its_reach(self, written):
        """Once for all scans, or once for each; what is missing is at the robot, without end."""
        beams = {"ranges": [[1, 9], [3, 4]], "angles": [0, 1]}
        log = self.log(written, **beams, max_range=8.0, sensor_pose=[0.1, 0.0, 1.0])
        assert [scan.max_range for scan in log] == [8.0, 8.0] and not log[0].valid[1]
        assert log[1].sensor_pose.tolist() == [0.1, 0.0, 1.0] and log[1].codes is None
        places = [[0.1, 0, 0], [0.2, 0, 0]]
        log = self.log(written, **beams, max_range=[8.0, 3.5], sensor_pose=places)
        assert [scan.max_range for scan in log] == [8.0, 3.5]
        assert [scan.sensor_pose.tolist() for scan in log] == places
        log = self.log(written, **beams)
        assert log[0].max_range == np.inf and log[0].sensor_pose.tolist() == [0, 0, 0]

    @pytest.mark.parametrize(
        ("held", "reason"),
        [
            ({"ranges": [[1.0]]}, "expected arrays ranges and angles, got ranges; no angles"),
            ({"ranges": [[1.0, 2.0]], "angles": [1.0]}, r"must have shape \(2,\) or \(1, 2\)"),
            ({"ranges": [[1.0]], "angles": [90.0]}, "this looks like degrees"),
            ({"ranges": [[1.0]], "angles": [0.0], "times": [np.nan]}, r"must be \(1,\) finite"),
            ({"ranges": [[1.0]], "angles": [0.0], "odometry": [[1.0, 2]]}, "odometry must"),
            ({"ranges": [["a"]], "angles": [0.0]}, "ranges must"),
            ({"ranges": [[1.0]], "angles": [0.0], "sensor_pose": [1, 2]}, "sensor_pose must"),
            ({"ranges": [[1.0]], "angles": [0.0], "max_range": [1, 2]}, "max_range must"),
            ({"ranges": [[1.0]], "angles": [0.0], "codes": [[1, 2]]}, "codes must"),
            ({"ranges": [[1.0]], "angles": [0.0], "delays": [-1.0]}, "delays must"),
            ({"ranges": [[1.0]], "angles": [0.0], "track": [1.0, 2.0]}, "track must"),
            ({"ranges": [[1.0]], "angles": [0.0], "order_known": [1, 0]}, "order_known must"),
            ({"ranges": np.empty((0, 3)), "angles": np.zeros(3)}, "ranges must have shape"),
            ({"ranges": np.array([None]), "angles": [0.0]}, "not a readable NPZ file"),
        ],
    )  # fmt: skip
    def test_what_is_wrong_is_said(self, written, held, reason):
        with pytest.raises(LogError, match=reason):
            self.log(written, **held)


class TestNoLogs:
    def test_the_formats_and_three_lines_that_work_are_told(self, read):
        with pytest.raises(UnknownFormat) as caught:
            read("Dear diary")
        first, known, columns, *lines = caught.value.reason.splitlines()
        assert first == "is of no known format: it starts with 'Dear diary'"
        assert all(name in known for name in ("CARMEN", "GMapping", "table", "NPZ"))
        assert all(name in columns for name in ("CSV", "LD19"))
        assert "read_csv" in columns and len(lines) == 4
        names = {"measured": [(0.5, [1.0, 2.0])], "angles": [0.0, 0.1]}
        exec("\n".join(line.strip() for line in lines[1:]), names)
        assert isinstance(names["log"], segmap.Log) and names["log"].times.tolist() == [0.5]

    @pytest.mark.parametrize("name", ["img_00{}.jpg", "x_{}.mcap", "run{}.log"])
    def test_numbered_files_of_another_kind_are_no_scans(self, tmp_path, monkeypatch, name):
        """Catches pictures that are read as a scan each, beside scans too."""
        picture = b"\xff\xd8\xff\xe0\x00\x10JFIF 1 2\n3 4\n"
        for k in range(3):
            content = CARMEN.encode() if "log" in name else picture
            (tmp_path / name.format(k)).write_bytes(content)
        told = r"holds no log(.|\n)*CARMEN(.|\n)*log = segmap.Log"
        with pytest.raises(UnknownFormat, match=told):
            readers.read(tmp_path)
        for k in range(2):
            (tmp_path / f"scan_{k}.txt").write_text(f"{100 * k + 100} 0\n")
        if "jpg" in name:
            assert [scan.ranges[0] for scan in readers.read(tmp_path)] == [0.1, 0.2]
            monkeypatch.chdir(tmp_path)
            assert readers.read(".").name == tmp_path.name
