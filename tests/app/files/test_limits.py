"""Readers at their limits: what is just taken in, and what is just refused; and closed forms."""

import numpy as np
import pytest
from log_samples import CORESLAM, SICK, TIMES, robotlaser, text

from segmap import readers
from segmap.readers import LogError

ROBOT = "ROBOTLASER1 0 {} {} {} 80 0 0 2 1 2 0 0 0 0 0 0 0 0 0 0 0 0 1 h 0"
WHEELS = CORESLAM.splitlines()[0].replace("29221", "{}")
#: A line with a number in it; numbers that it may hold, and numbers that are refused.
LIMITS = {
    "place": ("FLASER 1 1 {} 0 0 0 0 0", "1e7 -1e7", "1.1e7 -1.1e7"),
    "time": ("FLASER 1 1 0 0 0 0 0 0 {} h 0", "1e12 -1e12", "1.1e12 -1.1e12"),
    "start": (ROBOT.format("{}", 0, 0.1), "9.9 -9.9", "10 -10 10.5"),
    "view": (ROBOT.format(0, "{}", 0), "0 9.9", "-0.1 10 10.5"),
    "step": (ROBOT.format(0, 1, "{}"), "0 9.9", "-0.1 10 10.5"),
    "last beam": (ROBOT.format(9, 0, "{}"), "3.5", "3.6"),
    "mounting": ("PARAM robot_frontlaser_angular_offset {}\nFLASER 1 1", "12.5 -12.5", "12.6 -90"),
    "laser": (ROBOT.format(0, 1, 1).replace("ROBOTLASER1", "ROBOTLASER{}"), "1 5", "0 6"),
    "raw": ("RAWLASER{} 0 0 1 1 80 0 0 2 1 2 0 1 h 0", "1 5", "0 6"),
    "particles": ("LASER_READING 1 1 0 0 0 1\nSM_UPDATE {} 1 2 3 0", "1 0001", "2 -1"),
    "maxrange": ("PARAM maxrange {}\nLASER_READING 1 1 0 0 0 1", "0.5", "0 -1"),
    "ticks": (WHEELS, "1e12 -1e12", "1.1e12 -1.1e12"),
    "beam": ("# urg_mm angle_rad\n1000 {}", "12.56 -12.56", "12.57 -12.57 15"),
    "offset": (SICK.splitlines()[0].replace("181, 0,", "181, {},"), "720 -720", "721 -720.5"),
    "degrees": ("angle_deg,range_mm\n{},1", "720 -720", "720.1 -720.1 800"),
    "range": ("angle_deg,range_m\n0,{}", "1e7 NaN INF Null", "1.1e7 -1.1e7"),
    "scan": ("angle_deg,range_m,scan\n0,1,{}", "1e7 -1e7", "1.1e7 -1.1e7"),
    "clock": ("angle_deg,range_m,time_s\n0,1,{}", "1e12 -1e12", "1.1e12 -1.1e12"),
}


@pytest.mark.filterwarnings("ignore:.*degrees:UserWarning")
@pytest.mark.parametrize("name", LIMITS)
def test_a_number_is_read_up_to_its_limit(name, tmp_path):
    """Catches a limit that is lost, or holds above zero only, or refuses what just fits."""
    line, fine, bad = LIMITS[name]
    path = tmp_path / "some.log"
    for said in fine.split():
        path.write_text(line.format(said) + "\n")
        assert len(readers.read(path)) == 1, said
    for said in bad.split():
        path.write_text(line.format(said) + "\n")
        with pytest.raises(LogError):
            readers.read(path)


def test_a_link_has_the_name_of_what_it_leads_to(tmp_path, monkeypatch):
    """Catches a log that is called `today`, or nothing at all."""
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "SICK_FRONT.csv").write_text(SICK)
    (tmp_path / "today").symlink_to("run")
    (tmp_path / "last.csv").symlink_to("run/SICK_FRONT.csv")
    monkeypatch.chdir(tmp_path / "run")
    for path, name in ((".", "run"), ("../today", "run"), ("../last.csv", "SICK_FRONT")):
        assert readers.read(path).name == name
    with pytest.raises(LogError, match="is no file"):
        readers.read_segments(".")


def test_a_limit_of_the_sensor_is_a_positive_one(read):
    """Catches a maximum of 0 below which nothing is measured, and one of 0.9 that is overlooked."""
    for stated, valid in (("0", [1, 1]), ("0.9", [0, 0]), ("1.5", [1, 0])):
        line = ROBOT.format(0, 1, 1).replace(" 80 ", f" {stated} ")
        assert read(line)[0].valid.tolist() == valid


def test_the_first_lines_decide_and_no_later_one(tmp_path):
    """Of 200 lines half are CARMEN's, which is asked first; of 201 most would be another's."""
    path = tmp_path / "it.log"
    path.write_text("FLASER 1 1\n" * 100 + "Laser 1 1\n" * 101)
    assert readers.format_of(path) == "CARMEN"
    path.write_text("FLASER 1 1\n" * 99 + "Laser 1 1\n" * 101)
    assert readers.format_of(path) == "DP-SLAM"
    path.write_text("O 1 2 3 4\n" * 3)  # a drive alone
    assert "Wean" in readers.format_of(path)


@pytest.mark.parametrize("units", ["rad m s", "deg cm ms", "deg mm us", "deg mm ns"])
def test_every_unit_of_a_table(read, units):
    factors = {"deg": 180 / np.pi, "cm": 100, "mm": 1e3, "ms": 1e3, "us": 1e6, "ns": 1e9}
    angle, range, time = (k * factors.get(unit, 1) for k, unit in enumerate(units.split(), 1))
    head = "angle_{},range_{},time_{}".format(*units.split())
    log = read(f"{head},range_std\n{angle},{range},{time},9\n")  # another word: another column
    assert (log[0].angles[0], log[0].ranges[0], log.times[0]) == pytest.approx((1, 2, 3))


@pytest.mark.parametrize(("count", "step"), [(540, 0.5), (541, 0.5), (682, 0.3515625),
                                             (683, 0.3515625), (539, 180 / 538)])  # fmt: skip
def test_beams_of_gmapping_are_centred(read, count, step):
    angles = read(f"LASER_READING {count} {'1 ' * count}0 0 0 1\nNEFF 3\n")[0].angles
    assert np.degrees(np.diff(angles)) == pytest.approx(step)
    assert angles[0] == pytest.approx(-angles[-1])


def test_places_of_a_laser_agree_to_a_millimetre(read):
    """Catches poses by hand that are taken for a mounting, and noise that is taken for truth."""
    for off, truth in ((0.0009, False), (0.0011, True), (-0.0011, True)):
        lasers = [(x - 0.1 - k * off, y, h) for k, (x, y, h) in enumerate(((0, 0, 0), (3, 1, 0)))]
        robots = [(0, 0, 0), (3, 1, 0)]
        log = read(text(map(robotlaser, lasers, robots, TIMES)))
        assert (log.truth is not None) == truth
        if not truth:
            assert log[0].sensor_pose.tolist() == [-0.1, 0, 0]
            assert not np.signbit(log[0].sensor_pose[1:]).any()  # -0.0 in a file looks odd


@pytest.mark.parametrize(("keyword", "heading"), [("ROBOTLASER1", 0), ("ROBOTLASER2", np.pi)])
def test_a_laser_of_a_g2o_whose_place_varies_is_at_the_robots_centre(read, keyword, heading):
    lines = (robotlaser((k, 0, 0), (0, k, 0), t, keyword=keyword) for k, t in enumerate(TIMES))
    log = read("VERTEX2 0 0 0 0\n" + text(lines))
    assert log[0].sensor_pose == pytest.approx([0, 0, heading])
