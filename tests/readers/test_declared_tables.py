"""Tables by what their columns declare, programs that many use, and what is asked for."""

import json
import os
import re
import textwrap
from pathlib import Path

import numpy as np
import pandas
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from log_samples import ENCODINGS, text
from programs import program
from table_samples import BEAMS, CLOCK, DECLARED, FAR, PROGRAMS, TURN, lines, wide

import segmap
from segmap import LogError, readers
from segmap.readers import UnknownFormat, column_choices, read_csv

main = program("segmap")
#: So many tables are drawn; `make fuzz` draws 5 000.
DRAWN = int(os.environ.get("SEGMAP_TABLES", "100"))
#: Names of a column, each with how many of its unit are a degree, a metre or a second.
ANGLES = {"angle_deg": 1, "Theta (rad)": np.pi / 180, "AngleInDegrees": 1, "bearing[deg]": 1}
RANGES = {
    "range_mm": 1e3, "dist_cm": 100, "Distance (m)": 1, "range [in]": 1 / 0.0254,
    "r.ft": 1 / 0.3048,
}  # fmt: skip
TIMES = {"time_s": 1, "t_ms": 1e3, "Timestamp[ns]": 1e9, "stamp (us)": 1e6}
SEPARATORS = {",": ".", ";": ".,", "\t": ".,", "|": ".,", " ": ".,"}


def assert_same(log, clockwise=False, times=None):
    assert len(log) == 3 and not log.skipped
    for scan in log:
        turned = np.degrees(scan.angles) * (-1 if clockwise else 1)
        order = np.argsort(turned % 359.99)
        assert np.sort(turned % 359.99) == pytest.approx(TURN, abs=0.02)
        assert scan.ranges[order] == pytest.approx(FAR, abs=2e-3)
    assert log.times == pytest.approx(np.full(3, np.nan) if times is None else times, nan_ok=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("tables")


@st.composite
def tables(draw):
    """The text of a table whose head says all."""
    mark = draw(st.sampled_from(sorted(SEPARATORS)))
    point = draw(st.sampled_from(SEPARATORS[mark]))
    angle, far, when = (draw(st.sampled_from(sorted(names))) for names in (ANGLES, RANGES, TIMES))
    order = draw(st.permutations(range(4)))
    quote = draw(st.sampled_from(["", '"'])) if mark == "," else ""
    names = [f"{quote}{name}{quote}" for name in (angle, far, when, "quality")]
    first = draw(
        st.sampled_from(["", "# in the lab\n\n", f"sep={mark}\n" if mark in ",;" else "# "])
    )
    rows = [(a * ANGLES[angle], r * RANGES[far], 0.2 * k * TIMES[when], 9) for k, a, r in BEAMS]
    body = (mark.join(f"{row[k]:.6f}" for k in order).replace(".", point) for row in rows)
    head = mark.join(names[k].replace(" ", "" if mark == " " else " ") for k in order)
    return f"{first}{head}\n" + text(body)


@given(tables(), st.sampled_from(["plain", *ENCODINGS]))
@settings(max_examples=DRAWN, deadline=None)
def test_all_ways_to_write_a_table_give_one_log(folder, table, encoding):
    """Catches a separator, a mark, a unit or an order that only one of the columns understands."""
    (folder / "it.csv").write_bytes(ENCODINGS.get(encoding, str.encode)(table))
    log = readers.read(folder / "it.csv")
    assert_same(log, times=0.2 * np.arange(3))
    assert "left out: 'quality'" in log.assumed and "beams counter-clockwise" in log.assumed


@pytest.mark.parametrize("name", PROGRAMS)
def test_what_programs_state_is_read(tmp_path, name):
    """Catches a program that is refused, mirrored, or whose reach and times are passed over."""
    content, clockwise, timed = PROGRAMS[name]
    (path := tmp_path / "it.txt").write_text(content)
    log = readers.read(path)
    assert_same(log, clockwise, CLOCK if timed else None)
    if "angle_min" in content or "ros2" in name:
        assert log[0].max_range == 12 and not log.assumed
        path.write_text(
            content.replace("2.630", "12.5").replace("2.63", "12.5").replace("2.210", "0.01")
        )
        assert np.isposinf(readers.read(path)[0].ranges).sum() == 1


@pytest.mark.parametrize("name", DECLARED)
def test_what_is_declared_is_read_by_call_and_by_a_file_beside_it(tmp_path, name):
    """Catches a way to name columns that reads them otherwise, and a pose that is passed over."""
    content, how = DECLARED[name]
    (path := tmp_path / "it.txt").write_text(content)
    log, times = read_csv(path, **how), CLOCK if name == "dates" else CLOCK - CLOCK[0]
    assert_same(log, times=times if "time" in how["columns"] else None)
    if "pose" in name:
        poses = np.column_stack([range(3), [0.5] * 3, [0.1] * 3])
        assert log.odometry == pytest.approx(poses)
    said = {key: list(v) if isinstance(v, tuple) else v for key, v in how.items()}
    path.with_name("it.txt.toml").write_text(text(f"{k} = {v!r}" for k, v in said.items()))
    assert readers.format_of(path) == "table"
    assert [scan.ranges.tolist() for scan in readers.read(path)] == [s.ranges.tolist() for s in log]


ANY_ANGLE = "angle_deg|angle_rad|angle_deg_cw|angle_rad_cw"
#: What a file says too little of, what is asked, and the answer.
ASKED = {
    "units": (
        "scan,angle,distance\n" + lines(lambda k, a, r: f"{k},{a},{100 * r:.0f}"),
        "the unit of 'angle' and 'distance' is not said",
        f"scan,{ANY_ANGLE},range_mm|range_cm|range_m", "scan,angle_deg,range_cm"),
    "nobody's": (
        "angle,distance,intensity\n" + lines(lambda k, a, r: f"{a},{1000 * r:.0f},9"),
        "the unit of 'angle' and 'distance' is not said",
        f"{ANY_ANGLE},range_mm|range_cm|range_m,-", "angle_deg,range_mm,-"),
    "two of a kind": (
        "theta,bearing,range_m\n" + lines(lambda k, a, r: f"7,{a},{r}"),
        "'theta' and 'bearing' both say that they are the angle",
        f"{ANY_ANGLE}|pose_theta_deg|pose_theta_rad|-,"
        f"{ANY_ANGLE}|pose_theta_deg|pose_theta_rad|-,range_m", "-,angle_deg,range_m"),
    "a scan a row": (
        wide(["t", "x", "y", "theta", *(f"r{k}" for k in range(12))],
             lambda k: [f"{0.2 * k:.1f}", str(k), "0.5", "7.1"]),
        "what 't', 'x', 'y', 'theta', 'ranges' hold, and in which unit, is not said and where",
        "time_s|time_ms|time_us|time_ns|-,pose_x_mm|pose_x_cm|pose_x_m|-,"
        "pose_y_mm|pose_y_cm|pose_y_m|-,pose_theta_deg|pose_theta_rad|-,ranges_mm|ranges_cm|ranges_m",
        "time_s,pose_x_m,pose_y_m,pose_theta_rad,ranges_m"),
    "a class at the end": (
        wide([], lambda k: [], end=["wall"]), "how many numbers N of a row stand before its ranges",
        "-*N,ranges_mm|ranges_cm|ranges_m|-*12,-", "-*0,ranges_m,-"),
    "other numbers before and behind the ranges": (
        wide(["uptime_ms", *(f"d{k:03}" for k in range(12)), *(f"i{k}" for k in range(12))],
             lambda k: [f"{200 * k}"], end=["9"] * 12), "what 'uptime_ms', 'd#', 'i#' hold, and in",
        "time_ms|-,ranges_mm|ranges_cm|ranges_m|-*12,ranges_mm|ranges_cm|ranges_m|-*12",
        "time_ms,ranges_m,-*12"),
    "plural": (
        "Distances,Angles\n" + lines(lambda k, a, r: f"{r},{np.radians(a):.5f}"), "'Angles' and",
        f"range_mm|range_cm|range_m,{ANY_ANGLE}", "range_m,angle_rad"),
    "a heading": (
        "heading_deg,range_m\n" + lines(lambda k, a, r: f"{a},{r}"), "column is the angle",
        "angle_deg|angle_deg_cw|pose_theta_deg|-,range_m", "angle_deg,range_m"),
    "units that the names say": (
        "Grad10;Weg [cm]\n" + lines(lambda k, a, r: f"{10 * a};{100 * r:.0f}"), "is the angle",
        f"{ANY_ANGLE}|range_mm|range_cm|range_m|-,range_cm|-", "angle_deg/10,range_cm"),
}  # fmt: skip


@pytest.mark.parametrize("name", ASKED)
def test_what_is_not_said_is_asked_for_and_the_answer_reads_the_file(tmp_path, monkeypatch, name):
    """Catches a guess, advice of other columns or that runs unchosen, and words without rows."""
    content, missing, wanted, answer = ASKED[name]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "it.csv").write_text(content)
    with pytest.raises(LogError) as caught:
        readers.read("it.csv")
    reason = caught.value.reason
    rows = [row for row in content.splitlines()[-36:] if re.search(r"\d\W", row)]
    assert missing in reason and "\n    " in reason
    assert f"--columns '{wanted}'" in reason and f"columns='{wanted}'" in reason
    assert column_choices("it.csv").columns == wanted.removeprefix("-*N,")
    assert ",".join(re.findall(r"\d[\d.:]*", rows[1]))[:40] in reason
    with pytest.raises(ValueError, match=r"choose one of|got '-\*N'"):
        read_csv("it.csv", columns=wanted)
    view = (0, 330) if "--view" in reason else None
    log = read_csv("it.csv", columns=answer, view=view)
    assert len(log) == 3 and log[1].ranges == pytest.approx(FAR, abs=1e-2)


@pytest.mark.parametrize(
    "head",
    ["angle_mil,r_mm", "angle_deg,r_yd", "angle_deg,range_left_mm", "a,b", "angle_0.1deg,r_m"],
)
def test_words_that_are_not_known_are_asked_for(tmp_path, head):
    """Catches mils read as degrees, yards as metres, or a beam without a direction."""
    (tmp_path / "it.csv").write_text(f"{head}\n" + lines(lambda k, a, r: f"{a},{1000 * r:.0f}"))
    with pytest.raises(LogError, match="choose one"):
        readers.read(tmp_path / "it.csv")


def test_rows_of_one_scan_are_one_wherever_they_stand(tmp_path):
    """Catches 12 scans of 3 beams where a spreadsheet sorted by angle, and two runs joined."""
    path, head = tmp_path / "it.csv", "scan,time_s,angle_deg,range_mm\n"
    rows = sorted(((k, 0.2 * k, a, 1000 * r) for k, a, r in BEAMS), key=lambda row: row[2])
    path.write_text(head + text(",".join(map(str, row)) for row in rows))
    assert_same(readers.read(path), times=CLOCK - CLOCK[0])
    path.write_text(head + 2 * text(",".join(map(str, row)) for row in rows))
    with pytest.raises(LogError, match="scan numbers come back, with directions"):
        readers.read(path)
    path.write_text("time_s,angle_deg,range_mm\n" + text(",".join(map(str, r[1:])) for r in rows))
    with pytest.raises(LogError, match="times go back 11 times: sort its rows by time"):
        readers.read(path)


@pytest.mark.parametrize(
    ("angles", "lengths"),
    [
        ([350, 10, 30, 355, 5], [1, 3, 1]),
        ([0, 120, 240, 0, 120, 240], [3, 3]),
        ([240, 120, 0, 240, 120, 0], [3, 3]),
        ([-135, 0, 135, -135, 0, 135], [3, 3]),
        ([0, 60, 120, 60, 0, 60, 120], [3, 2, 2]),
        ([0, 0, 3, 3, 6, 6, 9, 9, 0], [8, 1]),
        ([0, 8, 4, 8], [4]),  # back by half of them, and no more
        ([7], [1]),
    ],
)
def test_a_scan_ends_where_the_angle_wraps_or_turns_back(tmp_path, angles, lengths):
    """Catches a cut at every step back, and sweeps to and fro that are one scan."""
    (path := tmp_path / "it.csv").write_text(text(f"{angle},1" for angle in angles))
    assert [len(scan) for scan in read_csv(path, columns="angle_deg,range_m")] == lengths


def test_each_beam_keeps_its_time_and_clockwise_beams_are_turned_round(tmp_path):
    """Catches the mirror image of a room, and delays in the order of the file."""
    path = tmp_path / "it.csv"
    path.write_text("time_ms,angle_deg_cw,range_m\n5,0,1\n6,90,2\n7,180,3\n")
    (scan,) = readers.read(path)
    assert scan.points()[1] == pytest.approx([0, -2]) and scan.time == pytest.approx(0.005)
    assert scan.delays == pytest.approx([0.002, 0.001, 0])
    clockwise = read_csv(path.with_name("it.csv"), columns="-,ranges_m", view=(90, -90))
    assert np.degrees(clockwise[0].angles) == pytest.approx([90, -90])
    assert clockwise[2].ranges.tolist() == [180, 3]


def test_a_clock_goes_on_at_midnight_and_one_without_a_unit_is_left_out(tmp_path):
    """Catches scans a day apart, and a column that nobody needs and that ends the reading."""
    path = tmp_path / "it.csv"
    clocks = ("23:59:59.8", "00:00:00.0", "00:00:00.2")
    path.write_text("time,angle_deg,range_m\n" + lines(lambda k, a, r: f"{clocks[k]},{a},{r:.3f}"))
    assert_same(readers.read(path), times=86399.8 + CLOCK - CLOCK[0])
    for clock in ("7", "13/09/2020"):
        path.write_text(
            "t,angle_deg,dist_mm\n" + lines(lambda k, a, r, c=clock: f"{c},{a},{1000 * r}")
        )
        log = readers.read(path)
        assert_same(log)
        assert "'t' says no unit of time and is left out" in log.assumed


def test_what_is_not_used_is_told(tmp_path):
    """Catches end points, or half a pose, beside the beams that are passed over without a word."""
    path = tmp_path / "it.csv"
    path.write_text("x_m,y_m,angle_deg,range_m,pose_x_m\n0,1,90,1,7\n")
    (scan,) = (log := readers.read(path))
    assert scan.points() == pytest.approx(np.array([[0, 1]])) and scan.odometry is None
    assert "left out: 'x_m', 'y_m', 'pose_x_m'" in log.assumed


def test_damage_is_told_with_its_line_or_left_out(tmp_path):
    """Catches words that become walls, nothing measured that ends the reading, and a lost line."""
    (path := tmp_path / "it.csv").write_text(
        "# lab\nangle_deg,range_mm,error\n0,1500,0\n10,,0\n20,-,0\n30,oops,0\n40,0,0\n50,900,8035\n"
        "60,inf,0\n70,#NUM!,0\n80,1\n"
    )
    with pytest.raises(LogError, match="line 11: expected 3 fields, got 2"):
        readers.read(path)
    path.write_text(path.read_text().removesuffix("80,1\n"))
    with pytest.raises(LogError, match="line 6: expected a number for the range, got 'oops'"):
        readers.read(path)
    log = readers.read(path, on_error="skip")
    assert log.skipped.lines == 1 and len(log[0]) == 7
    assert log[0].valid.tolist() == [True] + [False] * 6 and np.isposinf(log[0].ranges[-2])
    path.write_text("a,b\n" + lines(lambda k, a, r: f"{250 * r:.0f},{a}"))
    with pytest.raises(LogError, match="of 36 lines are no angle_deg,range_mm"):
        read_csv(path, columns="angle_deg,range_mm", on_error="skip")


def test_a_program_that_was_cut_off_is_damaged_where_it_is(tmp_path):
    """Catches a line of a known program with half a beam, which is passed over."""
    content = PROGRAMS["ultra_simple"][0].splitlines()
    content[4] = content[4][:20]
    (path := tmp_path / "it.txt").write_text(text(content))
    with pytest.raises(LogError, match="line 5: expected a beam"):
        readers.read(path)
    assert len(readers.read(path, on_error="skip")[0]) == 11


def test_beams_that_an_xv11_marks_are_no_walls(tmp_path):
    """Catches an error code in hexadecimal that is not known as one: a wall 16 m away."""
    content = PROGRAMS["xv11"][0].replace("60,2210,15,0", "60,16384,0,80A5")
    (tmp_path / "it.txt").write_text(content)
    for scan in readers.read(tmp_path / "it.txt"):
        assert np.flatnonzero(~scan.valid).tolist() == [2]


@pytest.mark.parametrize("name", ["sensor", "robot_id", "Lidar-No", "topic"])
def test_several_sensors_that_a_column_names_are_parted_by_the_advice(tmp_path, monkeypatch, name):
    """Catches two lasers whose scans become one, and advice that does not run."""
    monkeypatch.chdir(tmp_path)
    rows = (f"{who},{a},{r + who}" for _ in range(3) for who in (0, 1)
            for a, r in zip(TURN, FAR, strict=True))  # fmt: skip
    (tmp_path / "it.csv").write_text(text([f"{name},angle_deg,range_m", *rows]))
    with pytest.raises(LogError, match=f"'{name}' holds 0, 1") as caught:
        readers.read("it.csv")
    exec(textwrap.dedent("\n".join(caught.value.reason.split("\n")[1:])), {"pandas": pandas})
    assert readers.read(f"{name}_1.csv")[2].ranges == pytest.approx(FAR + 1)


def test_what_ros_shortened_is_told_with_the_option(tmp_path):
    """Catches a scan of the first beams alone."""
    content = PROGRAMS["ros2 --csv"][0].replace(",2.210,", ",'...',", 1)
    (tmp_path / "it.csv").write_text(content.replace("'...'", "..."))
    with pytest.raises(LogError, match="ros2 topic echo --full-length"):
        readers.read(tmp_path / "it.csv")


#: Beams that met something, and one that did not, as UrgBenri, SICK and ROS write them.
MET = [*FAR[:11].tolist(), np.inf]
STAMP = "header:\n  stamp:\n    secs: 1600000000\n    nsecs: 200000000\n"
#: What is no table, and what the lines that open it give.
OTHERS = {
    "JSON": (json.dumps([{"angle": a, "range": r} for _, a, r in BEAMS], indent=1), "records"),
    "JSON a line": (lines(lambda k, a, r: json.dumps({"angle": a, "range": r})), "records"),
    "lists of Python": (
        text(str([(15, float(a), float(r)) for _, a, r in BEAMS]) for _ in "123"), "scans"),
    "dictionaries of Python": (
        lines(lambda k, a, r: str({"angle": float(a), "range": float(r)})), "records"),
    "lists of numbers": (text(f"{k}.5 {MET}" for k in range(3)), "records"),
    "numbers between words": (
        lines(lambda k, a, r: f"12:34:0{k}.5 -> [Angle: {a:.0f}], {r:.2f} m"), "records"),
    "YAML of many numbers": ("ranges:\n" + lines(lambda k, a, r: f"- {r}"), "records"),
    "ros2 topic echo": (3 * f"{STAMP}ranges:\n- 1.5\n- .inf\n---\n", "records"),
}  # fmt: skip


@pytest.mark.parametrize("name", OTHERS)
def test_what_is_no_table_is_opened_by_the_lines_that_are_told(tmp_path, monkeypatch, name):
    """Catches advice that nobody has run."""
    monkeypatch.chdir(tmp_path)
    content, variable = OTHERS[name]
    (tmp_path / "it.txt").write_text(content)
    with pytest.raises(UnknownFormat, match="which these lines open") as caught:
        readers.read("it.txt")
    reason, held = caught.value.reason, dict[str, object]()
    told = reason[: reason.index("Known formats")]
    exec("\n".join(line[4:] for line in told.splitlines() if line.startswith("    ")), held)
    assert len(held[variable]) in (1, 3, 36)


def test_a_log_of_words_stays_one_whatever_its_head(tmp_path):
    """Catches a comment with the names of columns that makes a table of a CARMEN log."""
    from log_samples import CARMEN

    (tmp_path / "it.log").write_text("# angle_deg range_mm\n" + CARMEN)
    assert readers.format_of(tmp_path / "it.log") == "CARMEN"


@pytest.mark.parametrize("kind", ["csv", "npz"])
def test_numbered_files_with_a_scan_each_are_one_log(tmp_path, kind):
    """Catches as many logs as there are scans, 10 before 2, and times that are all equal."""
    (folder := tmp_path / "walk").mkdir()
    for k in (1, 2, 10):
        far = FAR + 0.01 * k
        if kind == "npz":
            np.savez(folder / f"scan_{k}.npz", ranges=far, angles=np.radians(TURN))
        else:
            beams = (f"7.5,{a},{r:.3f}" for a, r in zip(TURN, far, strict=True))
            (folder / f"scan_{k}.csv").write_text(text(["time_s,angle_deg,range_m", *beams]))
    log = readers.read(folder)
    assert [scan.ranges[0] for scan in log] == pytest.approx(FAR[0] + 0.01 * np.array([1, 2, 10]))
    assert any("in the order of the numbers" in told for told in log.assumed)
    assert np.isnan(log.times).all()


def test_arrays_that_are_not_known_are_told(tmp_path):
    """Catches poses beside the scans that are passed over without a word."""
    np.savez(tmp_path / "it.npz", ranges=[FAR], angles=np.radians(TURN), poses=[[1, 2, 3]])
    assert "left out: poses" in segmap.read(tmp_path / "it.npz").assumed


@pytest.mark.parametrize(
    "head",
    [
        "room 3;;\n;;\nscan;angle_deg;range_m\n", "scan;angle;range\n-;deg;m\n",
    ],
)  # fmt: skip
def test_a_head_is_found_below_a_title_and_above_its_units(tmp_path, head):
    """Catches an empty line of a spreadsheet taken for a row, and units taken for a damaged one."""
    (tmp_path / "it.csv").write_text(head + lines(lambda k, a, r: f"{k};{a};{r}"))
    assert_same(readers.read(tmp_path / "it.csv"))


#: Numbers whose thousands a mark may part: rows, and the line that is told for those where it does.
PARTED = [
    (";", "0;3.978 30;1.234 60;2.978", 1),
    (";", "0;3,978 30;1,234 60;2,978", 0),
    ("\t", "0\t3,978 30\t1,234 60\t2,978", 0),
    (";", "0;3.978 30,0;1.234 60;2.978", 1),
    (";", "0;3.978,0 30,0;1.234,0 60;2.978", 1),
    ("|", "0|3,978 30|1,234 60.0|2,978", 0),
    ("\t", "0\t3'978 30\t1'234.0 60\t2'978", 0),
    (";", "0;3\u202f978,0 30;1\u202f234,0 60;2\u202f978", 1),
]


@pytest.mark.parametrize(("mark", "rows", "line"), PARTED)
@pytest.mark.parametrize("unit", ["mm", "m"])
def test_a_mark_that_may_part_thousands_is_asked_about(
    tmp_path, monkeypatch, mark, rows, line, unit
):
    """Catches 3,978 mm read as 4 mm, 3,978 m as 4 km, and advice that does not open the file."""
    monkeypatch.chdir(tmp_path)
    Path("it.csv").write_text(text([f"angle_deg{mark}range_{unit}", *rows.split(" ")]), "utf-8")
    with pytest.raises(LogError, match=r"parts thousands in .*, or is its decimal mark") as raised:
        readers.read("it.csv")
    first, *ways, last = str(raised.value).splitlines()[1:]
    if unit == "mm" or len(re.findall("[.,]", rows)) == 3:
        exec(textwrap.dedent(f"{first}\n{ways[line if unit == 'mm' else 1 - line]}\n{last}"))
        (scan,) = readers.read("it_numbers.csv")
        assert scan.ranges == pytest.approx([3.978, 1.234, 2.978])


def test_thousands_that_begin_late_or_stand_between_quotes_are_no_numbers(tmp_path):
    """Catches a mark that the first lines do not have, and a quoted number that is passed over."""
    (path := tmp_path / "it.csv").write_text(
        "angle_deg;range_mm\n" + text(f"{a};978" for a in range(99)) + "99;1.234\n"
    )
    with pytest.raises(LogError, match=r"parts thousands in 1\.234,"):
        readers.read(path)
    path.write_text(path.read_text() + "99,5;978\n")
    with pytest.raises(LogError, match=r"line 101: .* its decimal mark a comma, got '1\.234'"):
        readers.read(path)
    path.write_text('angle_deg,range_mm\n0,"1,234.5"\n30,978\n')
    with pytest.raises(LogError, match=r"line 2: expected a number for the range, got '1,234\.5'"):
        readers.read(path)
    path.write_text("angle_deg,range_m\n" + text(f"{a},5,4,2{a:02}" for a in range(60)))
    with pytest.raises(LogError, match="head names 2 columns, and its rows have 4 fields"):
        readers.read(path)


def test_what_lines_of_words_say_is_asked_for_or_told(tmp_path):
    """Catches a mirrored room, a count that is a damaged row, and a clock that nobody hears of."""
    path, beams = tmp_path / "it.csv", lines(lambda k, a, r: f"{k} {a} {r}")
    for way in ("im Uhrzeigersinn", "sens horaire", "angle_cw", "positive to the right"):
        path.write_text(f"# {way}\nscan angle_deg range_m\n{beams}")
        with pytest.raises(LogError, match=f"which way angles grow, as '# {way}"):
            readers.read(path)
    path.write_text("angle_cw,angle_deg,range_m\n" + lines(lambda k, a, r: f"{-a},{a},{r}"))
    with pytest.raises(LogError, match="which way angles grow, as 'angle_cw'"):
        readers.read(path)
    path.write_text(f"# Angles grow clockwise.\n# scan angle_deg range_m\n{beams}")
    with pytest.raises(LogError, match="which way angles grow, as '# Angles grow clock") as caught:
        readers.read(path)
    assert "columns='scan,angle_deg|angle_deg_cw,range_m'" in caught.value.reason
    for head in ("# scan angle_deg_cw range_m", "# scan angle_deg_ccw range_m"):
        path.write_text(f"# clockwise?\n{head}\n36\n{beams}")
        assert_same(log := readers.read(path), "_cw" in head)
        assert "not read: '# clockwise?', '36'" in log.assumed
    path.write_text(f"scan angle_deg range_m\n{beams * 2}// counter-clockwise\n".replace(" ", ","))
    with pytest.raises(LogError, match="which way angles grow, as '//,counter"):
        readers.read(path)
    path.write_text("angle_deg,,range_m\n" + lines(lambda k, a, r: f"{a},12:34:0{k},{r}"))
    assert "left out: 'column 2'" in readers.read(path).assumed


def test_numbers_in_names_of_columns_are_their_order(tmp_path):
    """Catches beams that stand as a program sorted their names, as words: 0, 1, 10, 2."""
    path = tmp_path / "it.csv"
    names = sorted(f"/scan/ranges[{k}]" for k in range(12))
    head = ",".join(("__time", "/scan/angle_increment", "/scan/angle_min", *names))
    values = [name.split("[")[1].rstrip("]") + ".5" for name in names]
    path.write_text("\n".join((head, *(f"{t},0.1,0.0,{','.join(values)}" for t in (1.5, 1.6)))))
    assert segmap.read(path)[1].ranges.tolist() == [k + 0.5 for k in range(12)]
    head = ",".join(("time_s", *(name.replace("/scan/ranges", "r_mm") for name in names)))
    path.write_text("\n".join((head, *(f"{t},{','.join(values)}" for t in (1, 2)))))
    with pytest.raises(ValueError, match="do not stand in the order of their numbers"):
        segmap.read(path)


def test_no_field_is_passed_over_in_silence_and_a_date_is_asked_for_as_one(tmp_path):
    """Catches a scan on one line that is read as one beam, and a menu of names that all fail."""
    path = tmp_path / "it.csv"
    path.write_text("0,271.1,270.2,271.3\n0,271.1,270.2,271.3\n")
    with pytest.raises(ValueError, match="2 columns are named, but its rows have 4 fields; - na"):
        read_csv(path, columns="angle_deg,range_cm")
    assert len(read_csv(path, columns="angle_deg,range_cm,-*2")[0]) == 2
    path.write_text(
        "time,angle_deg,range\n2026-11-29 10:00:01,0,1500\n2026-11-29 10:00:02,9,1500\n"
    )
    assert column_choices(path).columns == "time,angle_deg,range_mm|range_cm|range_m"


@pytest.mark.parametrize("beams", [[45, 46, 47, 48], [0, 2, 4, 6], [0, 1, 3, 4]])
def test_a_message_whose_ranges_are_not_those_of_all_beams_is_refused(tmp_path, beams):
    """Catches a beam at 45 steps that is read as the first one, and one that was left out."""
    names = ",".join(f"/scan/ranges[{beam}]" for beam in beams)
    row = f"0.0,0.03,-1.5,{','.join('2.5' for _ in beams)}"
    (tmp_path / "it.csv").write_text(
        f"__time,/scan/angle_increment,/scan/angle_min,{names}\n{row}\n"
    )
    with pytest.raises(LogError, match="expected a column of each beam, from 0"):
        readers.read(tmp_path / "it.csv")


@pytest.mark.parametrize("head", [True, False])
def test_messages_of_two_sensors_are_refused(tmp_path, head):
    """Catches the scans of a front and a rear laser read as those of one."""
    names = (
        "sec,nanosec,header.frame_id,angle_min,angle_max,angle_increment,time_increment,scan_time"
    )
    names += ",range_min,range_max,ranges_0,ranges_1,ranges_2\n"
    rows = [f"{k},0,{who},-0.1,0.1,0.1,0,0.1,0.1,10,2,2,2" for k, who in enumerate("ababa")]
    (tmp_path / "it.csv").write_text(text([names.strip(), *rows] if head else rows))
    with pytest.raises(LogError, match="'frame_id' holds a, b: expected one sensor a log"):
        readers.read(tmp_path / "it.csv")
    one = [row for row in rows if ",a," in row]
    (tmp_path / "it.csv").write_text(text([names.strip(), *one] if head else one))
    assert len(readers.read(tmp_path / "it.csv")) == 3


def test_a_column_that_says_which_way_each_beam_turned_is_asked_about(tmp_path):
    """Catches a mirrored room whose direction is told as left out."""
    path = tmp_path / "it.csv"
    path.write_text("angle_deg,range_m,direction\n" + lines(lambda k, a, r: f"{a},{r},CW"))
    with pytest.raises(LogError, match=r"which way angles grow, as '[^']*CW' does"):
        readers.read(path)
    assert_same(read_csv(path, columns="angle_deg_cw,range_m,-"), clockwise=True)


def test_a_message_that_ends_before_its_frame_is_no_crash(tmp_path):
    """Catches a line cut short that ends the reading with an error of lists, or is read."""
    path = tmp_path / "it.csv"
    row = '0.0,-0.1,0.1,0.1,"(2.0, 2.0, 2.0)"'
    path.write_text(
        f"time_s,angle_min,angle_max,angle_increment,ranges,frame_id\n{row},a\n{row},a\n{row}\n"
    )
    with pytest.raises(LogError, match="line 4: expected 6 fields, got 5"):
        readers.read(path)
    assert len(readers.read(path, on_error="skip")) == 2
