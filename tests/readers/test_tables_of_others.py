"""Tables as programs and people write them, each of the same three scans of twelve beams."""

import numpy as np
import pytest
from log_samples import CARMEN, row, text

from segmap import LogError, readers
from segmap.readers import UnknownFormat

ANGLES = np.arange(0, 360.0, 30)
METRES = 2 + 0.21 * np.arange(12)
BEAMS = [(k, a, r) for k in range(3) for a, r in zip(ANGLES, METRES, strict=True)]
#: Times of the scans, where a table has them.
CLOCK = 1.6e9 + 0.2 * np.arange(3)
DAY = "2020-09-13 12:26:40.{}"


def lines(line, mark=None):
    """A line a beam, of the scan k, the angle a in degrees, r in metres."""
    found = [line(k, a, r) for k, a, r in BEAMS]
    return text(found if mark is None else [f.replace(".", mark) for f in found])


def xv11(k):
    beams = [f"{a:.0f},{1000 * r:.0f},15,0" for a, r in zip(ANGLES, METRES, strict=True)]
    return ["AngleInDegrees,DistInMM,Intensity,ErrorCodeHEX", *beams, "ROTATION_SPEED,5.01"]


def wide(names, begin=lambda k: [f"{0.2 * k:.1f}"], scale=1.0, mark=","):
    ranges = [f"{scale * r:.3f}" if scale == 1 else f"{scale * r:.0f}" for r in METRES]
    return text([mark.join(names), *(mark.join([*begin(k), *ranges]) for k in range(3))])


SINGLE = ["0.0", "5.759587", "0.523599", "0.0", "0.1", "0.05", "12.0"]
KEYS = [
    *("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time"),
    *("range_min", "range_max"),
]


def echo(stamp, ranges):
    said = [f"{key}: {value}" for key, value in zip(KEYS, SINGLE, strict=True)]
    return text(
        line
        for k in range(3)
        for line in ["header:", "  seq: 4", *stamp(k), "  frame_id: laser", *said, *ranges, "---"]
    )


def secs(k):
    return ["  stamp:", "    secs: 1600000000", f"    nsecs: {200000000 * k}"]


#: Name -> the text, whether angles grow clockwise, and its times: of CLOCK, from zero, or none.
TABLES = {
    "ultra_simple": (
        lines(lambda k, a, r: (
            f"{'S' if a == 0 else ' '}  theta: {a:06.2f} Dist: {1000 * r:08.2f} Q: 47")),
        True, None),
    "record_measurments": (lines(lambda k, a, r: f"{a == 0}\t15\t{a}\t{1000 * r:.1f}"), True, None),
    "measures printed": (lines(lambda k, a, r: f"({a == 0}, 15, {a}, {1000 * r:.1f})"), True, None),
    "scans printed": (
        text(str([(15, float(a), float(1000 * r)) for _, a, r in BEAMS[:12]]) for k in range(3)),
        True, None),
    "xv11": (text(line for k in range(3) for line in xv11(k)), False, None),
    "ld19": (lines(lambda k, a, r: f"angle:{a:.2f},distance(mm):{1000 * r:.0f},intensity:200"),
        True, None),
    "ydlidar": ("angle,range,intensity\n" + lines(
        lambda k, a, r: f"{np.radians(a):.5f},{r:.3f},10"), False, None),
    "stamped text": ("Timestamp,Angle,Distance\n" + lines(
        lambda k, a, r: f"{DAY.format(2 * k)},{a:.0f},{1000 * r:.0f}"), False, "clock"),
    "iso": ("time;theta;r\n" + lines(
        lambda k, a, r: f"2020-09-13T12:26:40.{2 * k}+00:00;{a};{1000 * r:.0f}"), False, "clock"),
    "time of day": ("time angle_deg dist_m\n" + lines(
        lambda k, a, r: f"00:00:00.{2 * k} {a} {r:.3f}"), False, "zero"),
    "milliseconds": ("timestamp\tangle_deg\tdistance_cm\n" + lines(
        lambda k, a, r: f"{200 * k}\t{a}\t{100 * r:.1f}"), False, "zero"),
    "since 1970": ("stamp,angle_deg,range_m\n" + lines(
        lambda k, a, r: f"{int(CLOCK[k] * 1000)},{a},{r:.3f}"), False, "clock"),
    "newscan": ("newscan,quality,angle,distance\n" + lines(
        lambda k, a, r: f"{int(a == 0)},15,{a},{1000 * r:.2f}"), True, None),
    "x and y": ("x_value,y_value,scan\n" + lines(
        lambda k, a, r: f"{r * np.cos(np.radians(a)):.5f},{r * np.sin(np.radians(a)):.5f},{k}"),
        False, None),
    "feet": ("id,angle [deg],range [ft],weather\n" + lines(
        lambda k, a, r: f"{k},{a},{r / 0.3048:.5f},rain"), False, None),
    "decimal commas": ("sep=;\nAngle;Distance\n" + lines(
        lambda k, a, r: f"{a:.1f};{1000 * r:.0f}", ","), False, None),
    "no names": (lines(lambda k, a, r: f"{0.2 * k:.1f},{a:.2f},{1000 * r:.0f},15"), False, "zero"),
    "no names, radians": (lines(lambda k, a, r: f"{np.radians(a):.5f} {r:.3f}"), False, None),
    "notes first": ("# recorded in the lab\nModel: A1\n\nangle_deg,range_mm\n" + lines(
        lambda k, a, r: f"{a},{1000 * r:.0f}"), False, None),
    "angles as head": (wide(["time", *(f"{a:.0f}" for a in ANGLES)]), False, "zero"),
    "radians as head": (
        wide(["t_s", *(f"{a:.5f}" for a in np.radians(ANGLES))], mark=";"), False, "zero"),
    "index as head": (
        wide(["time_s", *(f"range_mm_{k}" for k in range(12))], scale=1000, mark="\t"),
        False, "zero"),
    "rostopic -p": (
        wide(["%time", *(f"field.{key}" for key in KEYS), *(f"field.ranges{k}" for k in range(12))],
             lambda k: [str(1600000000000000000 + 200000000 * k), *SINGLE]), False, "clock"),
    "ros2 --csv": (
        text(",".join(["1600000000", str(200000000 * k), "laser", *SINGLE,
                       *(f"{r:.3f}" for r in METRES), *["0.0"] * 12]) for k in range(3)),
        False, "clock"),
    "rostopic echo": (
        echo(secs, [f"ranges: {[round(float(r), 3) for r in METRES]}"]), False, "clock"),
    "ros2 topic echo": (
        echo(lambda k: ["  stamp:", "    sec: 1600000000", f"    nanosec: {200000000 * k}"],
             ["ranges:", *(f"- {r:.3f}" for r in METRES), "intensities:", *["- .nan"] * 12]),
        False, "clock"),
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
def test_each_way_to_write_it_gives_the_same_scans(tmp_path, name):
    """Catches a program whose table is refused, or read in another unit or direction."""
    content, clockwise, clock = TABLES[name]
    path = tmp_path / "it.txt"
    path.write_text(content)
    log = readers.read(path)
    assert len(log) == 3 and not log.skipped
    for scan in log:
        turned = np.degrees(scan.angles) * (-1 if clockwise else 1)
        order = np.argsort(turned % 359.99)
        assert np.sort(turned % 359.99) == pytest.approx(ANGLES, abs=0.02)
        assert scan.ranges[order] == pytest.approx(METRES, abs=2e-3)
    times = {"clock": CLOCK, "zero": CLOCK - CLOCK[0], None: np.full(3, np.nan)}[clock]
    assert log.times == pytest.approx(times, nan_ok=True, abs=1e-3)


#: What a file says too little of, and what is said of it.
UNSAID = {
    "unit": (
        "angle;dist\n" + lines(lambda k, a, r: f"{a:.0f};{33.3 * r:.1f}"), "unit of 'dist' is not"),
    "few": ("angle,range\n0.1,2.0\n0.2,2.1\n", "the unit of 'angle' is not said"),
    "names": (
        "winkel;abstand\n" + lines(lambda k, a, r: f"{a:.1f};{33.3 * r:.2f}", ","), "no known"),
    "two of a kind": (
        lines(lambda k, a, r: f"{a:.1f};{r:.3f};{r:.2f}1"), "It looks like 3 columns"),
}  # fmt: skip


@pytest.mark.parametrize("name", UNSAID)
def test_the_advice_of_an_error_reads_that_very_file(tmp_path, monkeypatch, name):
    """Catches advice that is refused itself, or reads another column as the range."""
    content, said = UNSAID[name]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "it.csv").write_text(content)
    with pytest.raises(LogError, match=said) as caught:
        readers.read("it.csv")
    reason = caught.value.reason
    columns = reason.partition("--columns ")[2].split()[0]
    log = readers.read_csv("it.csv", columns=columns)
    assert log[0].ranges.max() < 150 and np.ptp(log[0].angles) <= 2 * np.pi
    code = [line.strip() for line in reason.splitlines() if line.startswith("    ")]
    if "pandas" in reason:
        names: dict[str, object] = {}
        begin = next(k for k, line in enumerate(code) if line.startswith("import numpy"))
        exec("\n".join(code[begin : begin + 3]), names)
        found = names["log"]
        assert np.concatenate([s.ranges for s in log]) == pytest.approx(found[0].ranges)


def test_a_file_of_numbers_is_told_with_its_first_lines(tmp_path):
    """Catches an unknown table of which nothing is said but its first word."""
    path = tmp_path / "it.dat"
    path.write_text("1;2;3\n4;5;9\n7;8;1\n2;2;2\n")
    with pytest.raises(UnknownFormat) as caught:
        readers.read(path)
    for part in (
        "3 columns between ';'",
        "    1;2;3\n    4;5;9\n    7;8;1\n",
        "pandas.read_csv('it.dat'",
    ):
        assert part in caught.value.reason


def test_lines_of_numbers_are_scans_of_a_usual_laser(tmp_path):
    """Catches scans a line without a head that are taken for Rawseeds, and an assumption untold."""
    rng = np.random.default_rng(3)
    ranges = rng.uniform(0.5, 5, (9, 181)).round(3)
    path = tmp_path / "it.txt"
    for begin in (False, True):
        rows = [row([0.1 * k] * begin + r.tolist()) for k, r in enumerate(ranges)]
        path.write_text(text(rows))
        log = readers.read(path)
        assert len(log) == 9 and log[2].ranges == pytest.approx(ranges[2])
        assert np.degrees(log[0].angles[[0, -1]]) == pytest.approx([-90, 90])
        assert any("181 beams look over 180 degrees" in said for said in log.assumed)
        assert log.times == pytest.approx(
            0.1 * np.arange(9) if begin else np.full(9, np.nan), nan_ok=True
        )


def test_ranges_that_ros2_shortened_are_told_with_the_option(tmp_path):
    path = tmp_path / "it.yaml"
    path.write_text(echo(secs, ["ranges:", "- 1.0", "- 2.0", "- '...'"]))
    with pytest.raises(LogError, match="ros2 topic echo --full-length"):
        readers.read(path)


def test_a_log_of_words_stays_one_whatever_its_head(tmp_path):
    """Catches a comment with the names of columns that makes a table of a CARMEN log."""
    path = tmp_path / "it.log"
    path.write_text("# angle_deg range_mm\n" + CARMEN)
    assert readers.format_of(path) == "CARMEN"
