"""Formats of mapping programs: GMapping's runs, DP-SLAM, Wean Hall, both layouts of CoreSLAM."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from log_samples import CORESLAM, CORESLAM_13, ODOMETRY, TIMES, WEAN, text

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


def gmapping(r, p, t):
    return (
        f"LASER_READING {len(r)} {words(r)} {words(p)} {t!r}\n"
        f"SM_UPDATE 2 0 0 0 -1 {words(p[::-1][1:])} {p[2]!r} 3"
    )


def dpslam(r, p, t):
    return f"Odometry {words(p)}\nLaser {len(r)} {words(r)}"


def wean(r, p, t):
    return f"L {words(p)} {words(p)} {words(np.resize(r, 180).tolist())} {t!r}"


@pytest.mark.parametrize("line", [gmapping, dpslam, wean])
@given(SCANS)
@quick
def test_what_was_written_is_read(line, read, scans):
    """Every digit of ranges, poses and times, and the truth where there is one."""
    log, unit = read(text(line(*scan) for scan in scans)), 0.01 if line is wean else 1
    ranges = [np.resize(r, 180).tolist() if line is wean else r for r, _, _ in scans]
    assert [s.ranges.tolist() for s in log] == [[r / (1 / unit) for r in row] for row in ranges]
    assert log.odometry.tolist() == [[x * unit, y * unit, h] for _, (x, y, h), _ in scans]
    if line is not dpslam:
        assert log.times.tolist() == [t for _, _, t in scans]
    if line is gmapping:
        assert log.truth == pytest.approx(np.array([(y, x, h) for _, (x, y, h), _ in scans]))


class TestGMapping:
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


class TestDpSlam:
    def test_a_line_of_odometry_is_used_once(self, read):
        """Catches two scans in one place; the second of two lines counts."""
        log = read("Odometry 1 1 1\nOdometry 2 2 2\nLaser 1 5\nLaser 1 5\n")
        assert log[0].odometry.tolist() == [2, 2, 2] and log[1].odometry is None

    def test_a_damaged_line_of_odometry_leaves_none(self, read):
        log = read("Odometry 1 1 1\nOdometry 2 x 2\nLaser 1 5\n", on_error="skip")
        assert log[0].odometry is None and log.skipped.lines == 1


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
