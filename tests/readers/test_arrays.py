"""Arrays, and what is no log: refusals with what to do."""

import numpy as np
import pytest
from log_samples import CARMEN, NPZ, ODOMETRY, TIMES, TRUTH, npz

import segmap
from segmap import readers
from segmap.readers import LogError, UnknownFormat


@pytest.fixture
def written(tmp_path):
    def write(content, name="some.csv"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


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
        log = segmap.Log("it", shots, order_known=False)
        segmap.exports.write_arrays(tmp_path / "it.npz", log)
        found = readers.read(tmp_path / "it.npz")
        assert found[0].delays.tolist() == [0, 0.1] and found[1].delays is None
        assert not found.order_known
        plain = self.log(written, ranges=[1, 2], angles=[0, 1], delays=[0.5, 0])
        assert plain[0].delays.tolist() == [0.5, 0] and plain.order_known

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
            ({"ranges": [[1.0]], "angles": [0.0], "times": [-1e13]}, "times must"),
            ({"ranges": [[1.0]], "angles": [0.0], "odometry": [[1.0, 2]]}, "odometry must"),
            ({"ranges": [["a"]], "angles": [0.0]}, "ranges must"),
            ({"ranges": [[1.0]], "angles": [0.0], "sensor_pose": [1, 2]}, "sensor_pose must"),
            ({"ranges": [[1.0]], "angles": [0.0], "max_range": [1, 2]}, "max_range must"),
            ({"ranges": [[1.0]], "angles": [0.0], "codes": [[1, 2]]}, "codes must"),
            ({"ranges": [[1.0]], "angles": [0.0], "delays": [-1.0]}, "delays must"),
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
        assert "read_csv" in columns and "--columns" in columns and len(lines) == 4
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
            (tmp_path / f"scan_{k}.txt").write_text(f"urg_mm angle_rad\n{100 * k + 100} 0\n")
        if "jpg" in name:
            assert [scan.ranges[0] for scan in readers.read(tmp_path)] == [0.1, 0.2]
            monkeypatch.chdir(tmp_path)
            assert readers.read(".").name == tmp_path.name
