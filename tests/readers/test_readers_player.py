"""Text logs of Player, of all its versions."""

import numpy as np
import pytest
from log_samples import ODOMETRY, PLAYER_1, PLAYER_2, text

HEAD = "1000.500 16777343 6665"
SCAN = "-1.5708 +1.5708 +1.5708"


def test_each_laser_has_its_own_place(read):
    log = read(PLAYER_2)
    assert log[0].sensor_pose == pytest.approx([0.3, 0.1, 0]) and log[0].max_range == 8.0
    scan = f"laser {{}} 001 001 0001 {SCAN} +8.0000 0003 1.0 0 1.0 0 1.0 0"
    place = f"{HEAD} laser 01 004 001 -0.200 +0.000 +3.142 0.1 0.1"
    log = read(text([place, *(f"{HEAD} {scan.format(k)}" for k in ("00", "01"))]))
    assert log[0].sensor_pose[0] == 0 and log[1].sensor_pose[0] == -0.2


def test_a_pose_within_the_laser_line_goes_first(read):
    position = f"{HEAD} position2d 00 001 001 +1 +1 +1 0 0 0 0"
    scan = f"{HEAD} laser 00 001 002 0001 +7.0 +8.0 +0.5 {SCAN} +8.0000 0003 1.0 0 2.0 0 1.0 0"
    log = read(text([position, scan]))
    assert log.odometry[0].tolist() == [7, 8, 0.5]
    assert log[0].ranges.tolist() == [1, 2, 1]
    assert read(text([position, scan.replace("+8.0000", "+0.0000")]))[0].valid.all()


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0)])
def test_odometry_is_interpolated_between_position_lines(read, order):
    """The last line before a scan is late by a tenth of a second; and lines come in any order."""
    lines = [f"position 0 {t}.0 {x} 0 0" for t, x in ((0, 0), (1, 1), (5, 2))]
    log = read(text([*(lines[k] for k in order), f"laser 0 3.0 {SCAN} 3 1 1 1"]))
    assert log.odometry[0].tolist() == [1.5, 0, 0]


def test_beyond_the_position_lines_and_without_times_the_last_one_counts(read):
    log = read(text(["position 0 1.0 1 2 0.5", f"laser 0 3.0 {SCAN} 3 1 1 1"]))
    assert log.odometry[0].tolist() == [1, 2, 0.5]
    log = read(text(["position 0 1 2 0.5", "laser 0 3 1 2 1", "position 0 2 2 0.5"]))
    assert log.odometry[0].tolist() == [1, 2, 0.5] and np.isnan(log.times).all()
    assert np.degrees(log[0].angles) == pytest.approx([-90, 0, 90])


def test_the_first_position_device_is_the_odometry(read):
    """The second is often the answer of a localiser: another frame."""
    lines = ["position 1 1.0 50 50 0", "position 0 1.0 1 2 0.5"]
    for time in (1.0, 3.0):  # at the time of a line, and beyond all
        log = read(text([*lines, f"laser 0 {time} {SCAN} 3 1 1 1"]))
        assert log.odometry[0].tolist() == [1, 2, 0.5]


def test_other_interfaces_are_skipped_knowingly_and_the_host_may_be_empty(read):
    """The first writer of Player 1 left it out: two blanks in a row."""
    lines = [f"{HEAD} gps 00 001 001 1 2 3", f"{HEAD} position2d 00 004 001 0 0 0 0.5 0.5"]
    lines += [f"{HEAD} laser 00 002 001 7", f"laser 0 1.0 {SCAN} 3 1 1 1"]
    assert len(read(text(lines))) == 1
    log = read(PLAYER_1.replace(" robot ", "  "))
    assert log.odometry == pytest.approx(np.array(ODOMETRY))


def last_beam(read, settings, count):
    line = f"laser 0 1.0 {' '.join(settings)} {count} {'1 ' * count}"
    return read(line).scans[0].angles[-1]


@pytest.mark.parametrize(
    ("first", "last", "step", "count", "true_last"),
    [
        (-90, 90, 0.5, 361, 90),
        (-90, 90, 1.0, 181, 90),
        (-90, 90, 1.0, 180, 89),
        (-90, 90, 0.5, 360, 89.5),
        (-119.53, 119.88, 360 / 1024, 682, 119.88),
    ],
)
@pytest.mark.parametrize("digits", [4, 8])
def test_a_rounded_step_does_not_add_up(read, first, last, step, count, true_last, digits):
    """0.0087 instead of 0.0087266 is half a degree after 360 beams.

    A Hokuyo's even number of beams holds both ends; four digits cannot tell, then a step is lost.
    """
    settings = [
        f"{np.radians(first):.4f}",
        f"{np.radians(last):.4f}",
        f"{np.radians(step):.{digits}f}",
    ]
    lost = 0.36 if count == 682 and digits == 4 else 0.01
    assert np.degrees(last_beam(read, settings, count)) == pytest.approx(true_last, abs=lost)


@pytest.mark.parametrize(("count", "last"), [(181, 3.14159), (182, 3.14159 * 181 / 182)])
def test_of_two_rounded_steps_an_odd_number_of_beams_takes_both_ends(read, count, last):
    step = f"{np.mean([3.14159 / count, 3.14159 / (count - 1)]):.6f}"
    assert last_beam(read, ["0", "3.14159", step], count) == pytest.approx(last)
    with pytest.raises(ValueError, match="expected angles in radians, got 10 "):
        last_beam(read, ["10", "3.14159", step], count)
