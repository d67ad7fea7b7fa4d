"""Formats of mapping programs: GMapping's runs, DP-SLAM, Wean Hall, both layouts of CoreSLAM."""

import numpy as np
import pytest
from conftest import shared_file
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from log_samples import CORESLAM, CORESLAM_13, DPSLAM, GMAPPING, ODOMETRY, TIMES, TRUTH, WEAN, text

from segmap import readers
from segmap.angles import wrap
from segmap.readers import LogError

METRES = st.floats(-1e4, 1e4)
RANGE = st.floats(0.01, 8.0)
POSE = st.tuples(METRES, METRES, st.floats(-3.1, 3.1))
#: Of one log: scans of as many beams each, a pose and a time for each.
SCANS = st.integers(1, 6).flatmap(
    lambda n: st.lists(
        st.tuples(st.lists(RANGE, min_size=n, max_size=n), POSE, st.floats(0, 1e9)), min_size=1
    )
)
quick = settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])


def words(values):
    return " ".join(map(repr, values))


def ranges_of(log):
    return [scan.ranges.tolist() for scan in log]


class TestGMapping:
    def test_the_heaviest_particle_of_a_scan_is_its_truth(self, read):
        """Catches the first particle, the last one, and the pose of the scan after."""
        log = read(GMAPPING)
        assert log.truth == pytest.approx(np.array(TRUTH))
        assert log.odometry == pytest.approx(np.array(ODOMETRY))
        assert log.times == pytest.approx(TIMES) and log[0].max_range == 50
        assert log[0].valid.tolist() == [True, True, True, False, True]

    def test_the_last_update_counts_and_one_before_all_scans_has_none_to_go_with(self, read):
        lines = [
            "SM_UPDATE 1 9 9 1 0",
            "LASER_READING 1 2.5 0 0 0 1",
            "SM_UPDATE 1 1 1 1 5",
            "LASER_READING 1 2.5 0 0 0 2",
            "SM_UPDATE 1 8 8 1 5",
            "SM_UPDATE 1 3 4 0.5 -9",
        ]
        found = read(text(lines))
        assert found.truth.tolist() == [[1, 1, 1], [3, 4, 0.5]]

    def test_a_scan_without_update_has_no_truth_and_far_ranges_are_none(self, read):
        log = read("PARAM maxrange 4\nLASER_READING 3 2.5 4 5 0 0 0 1\nNEFF 3\n")
        assert log.truth is None and log[0].valid.tolist() == [True, False, False]
        assert log[0].max_range == 4

    @pytest.mark.parametrize(("count", "degrees"), [(361, 180), (541, 270), (682, 239.4)])
    def test_beams_are_those_that_gmapping_takes_them_for(self, read, count, degrees):
        """Catches the 270 degrees of a S300 squeezed into half a turn."""
        log = read(f"LASER_READING {count} {'1 ' * count}0 0 0 1\nNEFF 3\n")
        assert np.degrees(np.ptp(log[0].angles)) == pytest.approx(degrees, abs=0.05)

    @given(SCANS)
    @quick
    def test_what_was_written_is_read(self, read, scans):
        lines = [
            f"LASER_READING {len(r)} {words(r)} {words(p)} {t!r}\n"
            f"SM_UPDATE 2 0 0 0 -1 {words(p[::-1][1:])} {p[2]!r} 3"
            for r, p, t in scans
        ]
        log = read(text(lines))
        assert ranges_of(log) == [r for r, _, _ in scans]
        assert log.odometry.tolist() == [list(p) for _, p, _ in scans]
        assert log.times.tolist() == [t for _, _, t in scans]
        assert log.truth == pytest.approx(np.array([(p[1], p[0], p[2]) for _, p, _ in scans]))


class TestDpSlam:
    def test_odometry_goes_with_the_scan_after_it(self, read):
        log = read(DPSLAM)
        assert log.odometry == pytest.approx(np.array(ODOMETRY))
        assert log.truth is None and log.times.tolist() == [0, 1] and log[0].max_range == 8.18
        assert log[0].valid.tolist() == [True, True, True, False, True]

    def test_a_line_of_odometry_is_used_once(self, read):
        """Catches two scans in one place; the second of two lines counts."""
        log = read("Odometry 1 1 1\nOdometry 2 2 2\nLaser 1 5\nLaser 1 5\n")
        assert log[0].odometry.tolist() == [2, 2, 2] and log[1].odometry is None

    def test_a_damaged_line_of_odometry_leaves_none(self, read):
        log = read("Odometry 1 1 1\nOdometry 2 x 2\nLaser 1 5\n", on_error="skip")
        assert log[0].odometry is None and log.skipped.lines == 1

    @given(SCANS)
    @quick
    def test_what_was_written_is_read(self, read, scans):
        log = read(text(f"Odometry {words(p)}\nLaser {len(r)} {words(r)}" for r, p, _ in scans))
        assert ranges_of(log) == [r for r, _, _ in scans]
        assert log.odometry.tolist() == [list(p) for _, p, _ in scans]


class TestWeanHall:
    def test_centimetres_become_metres_and_the_laser_sits_ahead(self, read):
        """A laser taken for the robot's centre moves every wall by 25 cm."""
        log = read(WEAN)
        assert log.odometry == pytest.approx(np.array(ODOMETRY)) and log.truth is None
        assert log[0].sensor_pose == pytest.approx([0.25, 0, 0])
        assert log[0].ranges[0] == 1.51 and np.isposinf(log[0].ranges[-1])
        assert np.degrees(log[0].angles[[0, -1]]) == pytest.approx([-90, 89])
        assert log.times == pytest.approx(TIMES)

    def test_poses_of_the_laser_that_were_corrected_are_truth(self, read):
        lines = WEAN.splitlines()
        lines[3] = lines[3].replace("L 100.0 0.0 0.1", "L 50.0 10.0 0.3")
        log = read(text(lines))
        assert log.truth[0] == pytest.approx([0, 0, 0]) and log.odometry[1, 0] == 0.5
        assert log.truth[1] == pytest.approx([1, 0, 0.1])

    @given(st.lists(st.tuples(RANGE, POSE, st.floats(0, 1e9)), min_size=1, max_size=4))
    @quick
    def test_what_was_written_is_read(self, read, scans):
        lines = [f"L {words(p)} {words(p)} {f'{r!r} ' * 180}{t!r}" for r, p, t in scans]
        log = read(text(lines))
        assert ranges_of(log) == [[r / 100] * 180 for r, _, _ in scans]
        assert log.odometry.tolist() == [[p[0] * 0.01, p[1] * 0.01, p[2]] for _, p, _ in scans]
        assert log.times.tolist() == [t for _, _, t in scans]


class TestCoreSlam:
    def test_the_shorter_layout(self, read):
        """Catches encoders at the places of the longer one; there the right wheel counts on."""
        log = read(CORESLAM_13)
        assert len(log[0]) == 682 and log[0].ranges.tolist() == [1.5] * 682
        assert log.odometry == pytest.approx(read(CORESLAM).odometry)
        assert log[0].angles.sum() == pytest.approx(0, abs=1e-9)

    @pytest.mark.parametrize("sample", [CORESLAM, CORESLAM_13])
    def test_most_lines_decide_and_a_line_of_the_other_layout_is_damage(self, read, sample):
        """A line cut to the other length would be a scan of ranges that are header, or turned."""
        other = CORESLAM if sample is CORESLAM_13 else CORESLAM_13
        mixed = other.splitlines()[0] + "\n" + sample
        with pytest.raises(LogError, match=r"line 1: expected \d+ fields and \d+ ranges, got \d+"):
            read(mixed)
        log = read(mixed, on_error="skip")
        assert len(log) == 3 and log.skipped.lines == 1
        assert ranges_of(log) == ranges_of(read(sample))

    @pytest.mark.parametrize(
        ("head", "beams"), [("14710 0 0 " + "0 " * 20, 683), ("0 0 14710 " + "0 " * 9, 682)]
    )
    def test_wheels_at_zero_are_no_odometry(self, read, head, beams):
        """Catches a log whose robot seems to stand at the origin."""
        log = read(text(f"{k} {head}{'1500 ' * beams}" for k in (1, 2)))
        assert np.isnan(log.odometry).all() and len(log) == 2

    def test_a_robot_that_stands_has_odometry(self, read):
        stands = text(
            line.replace("29261 25228", "29221 25178") for line in CORESLAM.splitlines()[:2]
        )
        assert read(stands).odometry.tolist() == [[0, 0, 0]] * 2

    @given(st.sampled_from([(24, 683), (13, 682)]), st.integers(0, 2**32))
    @quick
    def test_what_was_written_is_read(self, read, layout, time):
        ranges = np.random.default_rng(time).integers(20, 5600, layout[1]).tolist()
        log = read(text([f"{time} {'0 ' * (layout[0] - 1)}{words(ranges)}"]))
        assert ranges_of(log) == [[r / 1000 for r in ranges]] and log.times == [time * 1e-6]


class TestShared:
    """Real files: a format that was understood wrongly agrees with its own writer only."""

    def path(self, name):
        return shared_file(f"data/formats/{name}")

    def test_gmapping_run(self):
        log = readers.read(self.path("gmapping-sample.gfs"))
        assert len(log) == 12 and {len(scan) for scan in log} == {361}
        assert length(log.odometry) == pytest.approx(7.10, abs=0.01)
        assert length(log.truth) == pytest.approx(7.39, abs=0.01) and not log.skipped
        turned = np.diff(log.truth[:, 2]) - np.diff(log.odometry[:, 2])
        assert np.abs(wrap(turned)).max() < 0.4 < np.abs(np.diff(log.odometry[:, 2])).max()

    def test_dpslam(self):
        log = readers.read(self.path("dpslam-first-40-lines.log"))
        assert len(log) == 20 and {len(scan) for scan in log} == {181}
        assert log[0].max_range == 8.18 and log.truth is None
        assert sum(int(np.isposinf(scan.ranges).sum()) for scan in log) == 203
        assert length(log.odometry) == pytest.approx(0.004, abs=1e-3)

    def test_wean_hall(self):
        log = readers.read(self.path("wean-robotdata4.log.gz"))
        assert len(log) == 600 and {len(scan) for scan in log} == {180}
        assert length(log.odometry) == pytest.approx(21.50, abs=0.01) and log.truth is None
        assert all(scan.sensor_pose.tolist() == [0.25, 0, 0] for scan in log)

    def test_coreslam_with_a_cut_line(self):
        """Its wheels stand for the first 53 scans only: the odometry is real."""
        path = self.path("coreslam-test_lab2.dat.gz")
        with pytest.raises(LogError, match=r"line 405: expected 24 fields and 683 ranges, got 640"):
            readers.read(path)
        log = readers.read(path, on_error="skip")
        assert len(log) == 404 and log.skipped.lines == 1 and log.truth is None
        assert length(log.odometry) == pytest.approx(24.62, abs=0.01)
        assert not log.odometry[:53].any()


def length(path):
    return np.hypot(*np.diff(path[:, :2], axis=0).T).sum()
