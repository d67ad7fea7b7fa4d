"""Tables of beams as people have them: separator, decimal mark, encoding, head, units and names."""

import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from log_samples import CARMEN, ENCODINGS, row, text

from segmap import LogError, readers
from segmap.readers import UnknownFormat

#: So many tables are drawn; `make fuzz` draws 5 000.
DRAWN = int(os.environ.get("SEGMAP_TABLES", "300"))
ANGLES = np.arange(-90.0, 91, 15)
RANGES = 2 + 0.07 * np.arange(13)
#: Separators, each with the decimal marks that it allows.
SEPARATORS = {",": ".", ";": ".,", "\t": ".,", " ": ".,"}
#: Names of a column, each with how many of its unit are a degree, a metre or a second; those that
#: say no unit are told by their numbers.
NAMES = {
    "angle": {
        "angle_deg": 1, "Theta (rad)": np.pi / 180, "AngleInDegrees": 1, "bearing[deg]": 1,
        "angle": 1, "THETA": np.pi / 180,
    },
    "range": {
        "range_mm": 1000, "dist_cm": 100, "Distance (m)": 1, "r[ft]": 1 / 0.3048, "DistInMM": 1000,
        "range [in]": 1 / 0.0254, "distance": 1000, "dist": 1,
    },
    "time": {"t": 1, "time_ms": 1000, "Timestamp[ns]": 1e9, "stamp (us)": 1e6},
    "quality": {"quality": 1, "Intensity": 1, "note": 1},
    "scan": {"scan": 1, "frame_id": 1},
}  # fmt: skip
#: What stands before the head.
NOTES = ["", "# recorded in the lab\n", "# a\n\n# b\n"]


@st.composite
def tables(draw):
    """The text of a table, how many scans it has, and whether their times are told."""
    separator = draw(st.sampled_from(sorted(SEPARATORS)))
    mark = draw(st.sampled_from(SEPARATORS[separator]))
    more = draw(st.lists(st.sampled_from(["time", "quality", "scan"]), unique=True))
    roles = draw(st.permutations(["angle", "range", *more]))
    names = {role: draw(st.sampled_from(sorted(NAMES[role]))) for role in roles}
    factors = {role: NAMES[role][name] for role, name in names.items()}
    if separator == " ":
        names = {role: name.replace(" ", "") for role, name in names.items()}
    count = draw(st.integers(1, 3))
    quote = draw(st.sampled_from(["", '"'])) if separator != " " else ""
    lines = [separator.join(f"{quote}{names[role]}{quote}" for role in roles)]
    for k in range(count):
        for angle, distance in zip(ANGLES, RANGES, strict=True):
            values = {
                "angle": angle,
                "range": distance,
                "time": 100.25 + k,
                "quality": 15,
                "scan": k,
            }
            texts = []
            for role in roles:
                number = f"{values[role] * factors[role]:.9f}"
                whole = role == "scan" or names[role] == "distance"
                texts.append(f"{float(number):.0f}" if whole else number)
            lines.append(separator.join(texts).replace(".", mark))
    first = draw(st.sampled_from([*NOTES, f"sep={separator}\n" if separator in ",;" else ""]))
    head = draw(st.sampled_from(["", "# "])) if first in NOTES and not quote else ""
    return f"{first}{head}" + "\n".join(lines) + "\n", count, "time" in roles, names.get("time")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("tables")


@given(tables(), st.sampled_from(["plain", *ENCODINGS]))
@settings(max_examples=DRAWN, deadline=None)
def test_all_ways_to_write_a_table_give_one_log(folder, table, encoding):
    """Catches a separator, a mark, a unit or a name that only one of the columns understands."""
    content, count, timed, clock = table
    path = folder / "it.csv"
    path.write_bytes(ENCODINGS.get(encoding, str.encode)(content))
    log = readers.read(path)
    assert len(log) == count
    for k, scan in enumerate(log):
        order = np.argsort(scan.angles)
        np.testing.assert_allclose(np.degrees(scan.angles[order]), ANGLES, atol=1e-5)
        np.testing.assert_allclose(scan.ranges[order], RANGES, atol=1e-6)
        told = timed and (clock != "t" or count > 1)  # one time alone says no unit
        assert (scan.time == pytest.approx(100.25 + k)) if told else np.isnan(scan.time)


@pytest.mark.parametrize("head", ["", "sep=;\n", "# mine\n\nsep=;\n", "sep=;\nwinkel;abstand\n"])
def test_named_columns_begin_below_what_stands_before_the_numbers(tmp_path, head):
    """Catches the line of Excel that names the separator, taken for a beam."""
    path = tmp_path / "it.csv"
    path.write_text(f"{head}0,5;1500,5\n90;2000\n180;900\n")
    log = readers.read_csv(path, columns=["angle_deg", "range_mm"])
    assert log[0].ranges.tolist() == [1.5005, 2.0, 0.9] and not log.skipped
    assert np.degrees(log[0].angles[0]) == pytest.approx(0.5)


def test_units_that_the_numbers_tell_are_used_and_told(tmp_path):
    """Catches a unit guessed in silence, and a column nobody needs that stops the reading."""
    path = tmp_path / "it.csv"
    rows = [f"4,{a:.0f},{1000 * r:.0f}" for a, r in zip(ANGLES, RANGES, strict=True)]
    path.write_text("\n".join(["t,Angle,Distance", *rows]) + "\n")
    log = readers.read(path)
    np.testing.assert_allclose(log[0].ranges, RANGES)
    assert "'Angle' is in degrees, since it spans more than 2 pi" in log.assumed
    assert "'Distance' is in millimetres, since it holds whole numbers" in log.assumed
    assert "the column 't' says no unit: left out" in log.assumed
    path.write_text("Angle,Distance\n0.1,2.0\n0.2,2.1\n")
    with pytest.raises(LogError, match="the unit of 'Angle' is not said"):
        readers.read(path)


# --------------------------------------------------------------- as programs and people write them
#: Three scans of twelve beams.
TURN = np.arange(0, 360.0, 30)
FAR = 2 + 0.21 * np.arange(12)
BEAMS = [(k, a, r) for k in range(3) for a, r in zip(TURN, FAR, strict=True)]
#: Times of the scans, where a table has them.
CLOCK = 1.6e9 + 0.2 * np.arange(3)
DAY = "2020-09-13 12:26:40.{}"


def lines(line, mark=None):
    """A line a beam, of the scan k, the angle a in degrees, r in metres."""
    found = [line(k, a, r) for k, a, r in BEAMS]
    return text(found if mark is None else [f.replace(".", mark) for f in found])


def xv11(k):
    beams = [f"{a:.0f},{1000 * r:.0f},15,0" for a, r in zip(TURN, FAR, strict=True)]
    return ["AngleInDegrees,DistInMM,Intensity,ErrorCodeHEX", *beams, "ROTATION_SPEED,5.01"]


def wide(names, begin=lambda k: [f"{0.2 * k:.1f}"], scale=1.0, mark=","):
    ranges = [f"{scale * r:.3f}" if scale == 1 else f"{scale * r:.0f}" for r in FAR]
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
OTHERS = {
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
    "angles as head": (wide(["time", *(f"{a:.0f}" for a in TURN)]), False, "zero"),
    "radians as head": (
        wide(["t_s", *(f"{a:.5f}" for a in np.radians(TURN))], mark=";"), False, "zero"),
    "index as head": (
        wide(["time_s", *(f"range_mm_{k}" for k in range(12))], scale=1000, mark="\t"),
        False, "zero"),
    "rostopic -p": (
        wide(["%time", *(f"field.{key}" for key in KEYS), *(f"field.ranges{k}" for k in range(12))],
             lambda k: [str(1600000000000000000 + 200000000 * k), *SINGLE]), False, "clock"),
    "ros2 --csv": (
        text(",".join(["1600000000", str(200000000 * k), "laser", *SINGLE,
                       *(f"{r:.3f}" for r in FAR), *["0.0"] * 12]) for k in range(3)),
        False, "clock"),
    "rostopic -p without its head": (
        text(",".join([str(1600000000000000000 + 200000000 * k)] * 1 + [
            "7", str(1600000000000000000 + 200000000 * k), "laser", *SINGLE,
            *(f"{r:.3f}" for r in FAR)]) for k in range(3)),
        False, "clock"),
    "rostopic echo": (
        echo(secs, [f"ranges: {[round(float(r), 3) for r in FAR]}"]), False, "clock"),
    "ros2 topic echo": (
        echo(lambda k: ["  stamp:", "    sec: 1600000000", f"    nanosec: {200000000 * k}"],
             ["ranges:", *(f"- {r:.3f}" for r in FAR), "intensities:", *["- .nan"] * 12]),
        False, "clock"),
}  # fmt: skip


@pytest.mark.parametrize("name", OTHERS)
def test_each_way_to_write_it_gives_the_same_scans(tmp_path, name):
    """Catches a program whose table is refused, or read in another unit or direction."""
    content, clockwise, clock = OTHERS[name]
    path = tmp_path / "it.txt"
    path.write_text(content)
    log = readers.read(path)
    assert len(log) == 3 and not log.skipped
    for scan in log:
        turned = np.degrees(scan.angles) * (-1 if clockwise else 1)
        order = np.argsort(turned % 359.99)
        assert np.sort(turned % 359.99) == pytest.approx(TURN, abs=0.02)
        assert scan.ranges[order] == pytest.approx(FAR, abs=2e-3)
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


def test_arrays_alone_are_tables(tmp_path):
    """Catches scans of rplidar kept by numpy.save, and a pickle that is opened."""
    shots = np.array([np.stack([np.full(12, 15.0), TURN, 1000 * FAR], 1)] * 3)
    np.save(tmp_path / "it.npy", shots)
    log = readers.read(tmp_path / "it.npy")
    assert len(log) == 3 and np.sort(log[2].ranges) == pytest.approx(np.sort(FAR))
    assert np.sort(-np.degrees(log[0].angles)) == pytest.approx(TURN)
    np.save(tmp_path / "it.npy", np.full((4, 361), 2.5))
    assert [len(scan) for scan in readers.read(tmp_path / "it.npy")] == [361] * 4
    np.save(tmp_path / "it.npy", np.array([[1], [1, 2]], object), allow_pickle=True)
    with pytest.raises(LogError, match="is no array of numbers alone"):
        readers.read(tmp_path / "it.npy")
