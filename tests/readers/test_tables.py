"""Tables of beams as people have them: separator, decimal mark, encoding, head, units and names."""

import json
import os
import pickle
import re
import warnings
import zipfile

import numpy as np
import pandas
import pytest
import scipy.io
from hypothesis import given, settings
from hypothesis import strategies as st
from log_samples import CARMEN, ENCODINGS, row, text
from programs import program
from table_samples import BEAMS, CLOCK, FAR, OTHERS, TURN, echo, ld19, lines, secs

from segmap import LogError, readers
from segmap.readers import UnknownFormat

main = program("segmap")
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
    path.write_text("Angle,Distance\n" + lines(lambda k, a, r: f"{a:.0f},{100 * r:.0f}"))
    doubt = "whole numbers, to 431 alone: they may be centimetres"
    assert any(told.endswith(doubt) for told in readers.read(path).assumed)
    path.write_text("Angle,Distance\n0.1,2.0\n0.2,2.1\n")
    with pytest.raises(LogError, match="the unit of 'Angle' is not said"):
        readers.read(path)


# --------------------------------------------------------------- as programs and people write them
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
    zero = CLOCK - CLOCK[0]
    known = {
        "clock": CLOCK,
        "zero": zero,
        "midnight": 86399.8 + zero,
        "excel": 45000 * 86400 + zero,
    }
    times = known.get(clock, np.full(3, np.nan))
    assert log.times == pytest.approx(times, nan_ok=True, abs=1e-3)


@pytest.mark.parametrize("name", OTHERS)
def test_the_columns_that_are_proposed_read_the_same(tmp_path, name):
    """Catches a choice above the first rows that mirrors the scans, or loses where they end."""
    path = tmp_path / "it.txt"
    path.write_text(OTHERS[name][0])
    names, rows = readers.first_rows(path)
    if readers.format_of(path) not in ("table", "records") or not names:
        return
    assert len(rows) == 6 and any(name.startswith(("angle", "x_m")) for name in names)
    wanted, found = readers.read(path), readers.read_csv(path, columns=names)
    assert found.times == pytest.approx(wanted.times, nan_ok=True)
    for a, b in zip(found, wanted, strict=True):
        assert a.angles == pytest.approx(b.angles) and a.ranges == pytest.approx(b.ranges)


def test_a_number_without_the_unit_of_all_others_is_damage(tmp_path):
    """Catches 1300 millimetres among `1.25 m` that are read as so many metres."""
    path = tmp_path / "it.csv"
    path.write_text("angle,range\n" + lines(lambda k, a, r: f"{a:.0f} deg,{r:.3f} m"))
    path.write_text(
        path.read_text().replace("60 deg,2.420 m", "60 deg,2420").replace("2.000 m", "0")
    )
    with pytest.raises(LogError, match="line 4: expected a unit behind '2420'"):
        readers.read(path)
    log = readers.read(path, on_error="skip")
    assert log.skipped.lines == 3 and np.flatnonzero(~log[0].valid).tolist() == [0]


def turns(kind):
    """A file for each of four scans, whose ranges grow by a centimetre from scan to scan."""
    head = {"table": "time_s,angle_deg,range_m", "no head": "", "two": "angle_deg,range_m"}.get(
        kind
    )
    for k in range(4):
        far = np.r_[FAR[6:], FAR[5::-1]] + 0.01 * k
        if kind == "json":
            yield json.dumps({"angles_deg": TURN.tolist(), "ranges_m": far.tolist()})
            continue
        begin = f"{0.2 * k:.1f}," if kind == "table" else ""
        beams = [f"{begin}{a:.0f},{r:.3f}" for a, r in zip(TURN, far, strict=True)]
        yield text([head, *beams, *beams * (kind == "two")][not head :])


@pytest.mark.parametrize("kind", ["table", "no head", "json"])
def test_numbered_tables_with_a_scan_each_are_one_log(tmp_path, kind, capsys):
    """Catches as many logs as there are scans; by folder, names and in Python."""
    (folder := tmp_path / "walk").mkdir()
    for k, content in zip((1, 2, 10, 11), turns(kind), strict=True):
        (folder / f"scan_{k}.csv").write_text(content)
    (folder / "notes.md").write_text("# a walk\n")
    names = sorted(map(str, folder.glob("*.csv")))
    assert readers.together(names) == [[str(folder / f"scan_{k}.csv") for k in (1, 2, 10, 11)]]
    for log in map(readers.read, (folder, names)):
        assert [scan.ranges[0] for scan in log] == pytest.approx(FAR[6] + 0.01 * np.arange(4))
        assert any("in the order of the numbers" in told for told in log.assumed)
        times = 0.2 * np.arange(4) if kind == "table" else np.full(4, np.nan)
        assert log.times == pytest.approx(times, nan_ok=True)
    for named in ([folder], names):
        assert main(["info", *map(str, named), "--json"]) == 0
        found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert [each["scans"]["scans"] for each in found] == [4]


def test_times_in_the_names_of_files_are_those_of_their_scans(tmp_path):
    """Catches scans without times whose files are called by them."""
    for k, content in enumerate(turns("no head")):
        (tmp_path / f"scan_{int(CLOCK[0]) + k}{200 * k:03d}000000.csv").write_text(content)
    log = readers.read(tmp_path)
    assert log.times - log.times[0] == pytest.approx(1.2 * np.arange(4), abs=1e-3)
    assert any("in the files' names" in told for told in log.assumed)


def test_numbered_tables_of_several_scans_or_columns_are_logs_of_their_own(tmp_path, capsys):
    """Catches drives and rooms that are joined since somebody numbered them."""
    (several := tmp_path / "several").mkdir()
    (mixed := tmp_path / "mixed").mkdir()
    (two := tmp_path / "rooms").mkdir()
    for k, (content, other) in enumerate(zip(turns("two"), turns("table"), strict=True)):
        (several / f"run_{k}.csv").write_text(content)
        (mixed / f"run_{k}.csv").write_text(content if k == 3 else other)
        if k < 2:
            (two / f"room_{k}.csv").write_text(other)
    for folder, count in ((several, 4), (mixed, 4), (two, 2)):
        assert main(["info", str(folder), "-q", "--json"]) == 0
        assert len(capsys.readouterr().out.splitlines()) == count


def test_numbered_tables_are_read_by_the_columns_of_the_first(tmp_path):
    """Catches a scan in metres among millimetres, since its numbers alone look like metres."""
    for k in range(3):
        far = FAR * (0.04 if k == 1 else 1)
        beams = [f"{a:.0f},{1000 * r:.0f}" for a, r in zip(TURN, far, strict=True)]
        (tmp_path / f"scan_{k}.csv").write_text(text(["angle,distance", *beams]))
    log = readers.read(tmp_path)
    assert log[1].ranges == pytest.approx(0.04 * FAR, abs=1e-3)


def test_lines_of_pairs_may_have_as_many_as_they_like(tmp_path):
    """Catches beams behind those of the first line that are lost."""
    path = tmp_path / "it.txt"
    turn = [",".join(f"{a},{2 + a / 100:.2f}" for a in range(0, 10 * n, 10)) for n in (9, 12, 7)]
    path.write_text(text(["t;angle_deg,range_m", *(f"{k / 10};{t}" for k, t in enumerate(turn))]))
    log = readers.read(path)
    assert [len(scan) for scan in log] == [9, 12, 7] and not log.skipped
    assert log[1].ranges[-1] == pytest.approx(3.1)
    assert np.degrees(log[1].angles[-1]) == pytest.approx(110)


def test_a_pose_beside_the_beams_is_the_odometry(tmp_path):
    """Catches the heading of the robot that is taken for the angle of a beam, and poses lost."""
    for name in ("pose and beam", "pose and scan"):
        (tmp_path / "it.csv").write_text(OTHERS[name][0])
        found = readers.read(tmp_path / "it.csv").odometry
        assert found == pytest.approx(np.column_stack([range(3), [0.5] * 3, [0.1] * 3]))


def test_beams_that_an_xv11_marks_are_no_walls(tmp_path):
    """Catches an error code in hexadecimal that is not known as one: a wall 16 m away."""
    content = OTHERS["xv11"][0].replace("60,2420,15,0", "60,16384,0,8035")
    (tmp_path / "it.txt").write_text(content)
    for scan in readers.read(tmp_path / "it.txt"):
        assert np.flatnonzero(~scan.valid).tolist() == [2] and scan.ranges[3] < 3


#: What a file says too little of, and what is said of it.
UNSAID = {
    "unit": (
        "angle;dist\n" + lines(lambda k, a, r: f"{a:.0f};{33.3 * r:.1f}"), "unit of 'dist' is not"),
    "few": ("angle,range\n0.1,2.0\n0.2,2.1\n", "the unit of 'angle' is not said"),
    "ticks": (
        "angle_ticks,range_mm\n" + lines(lambda k, a, r: f"{a * 128 / 45:.0f},{1000 * r:.0f}"),
        "unit of 'angle_ticks' is not"),
    "tick": (
        "t_ms,tick,range_mm\n" + lines(lambda k, a, r: (
            f"{200 * k},{a * 128 / 45:.0f},{1000 * r:.0f}")),
        "unit of 'tick' is not"),
    "names": (
        "hoek;afstand\n" + lines(lambda k, a, r: f"{a:.1f};{33.3 * r:.2f}", ","), "no known"),
    "a column to leave out first": (
        "weather;dist;angle\n" + lines(lambda k, a, r: f"rain;{33.3 * r:.1f};{a:.0f}"),
        "unit of 'dist' is not"),
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
    assert main(["info", "it.csv", "--columns", columns, "-q"]) == 0
    assert log[0].ranges.max() < 150 and np.ptp(log[0].angles) <= 2 * np.pi
    code = [line.strip() for line in reason.splitlines() if line.startswith("    ")]
    if "import segmap" in code:
        names: dict[str, object] = {}
        begin = code.index("import segmap")
        exec("\n".join(code[begin : begin + 3]), names)
        found = names["log"]
        assert all(a.ranges == pytest.approx(b.ranges) for a, b in zip(log, found, strict=True))


@pytest.mark.parametrize("head", [
    "angle_mil,distance_mm", "angle_deg,distance_yd", "angle_deg,distance [dm]", "Winkel,Weg_yd",
    "angle_deg,range_left_mm", "a,b,c", "angle_0.1deg,distance",
])  # fmt: skip
def test_a_head_of_an_unknown_unit_is_not_overruled_by_the_numbers(tmp_path, head):
    """Catches mils read as degrees and yards as metres, since the numbers look like them."""
    more = ",9" * (head.count(",") - 1)
    (tmp_path / "it.csv").write_text(
        f"{head}\n" + lines(lambda k, a, r: f"{a},{1000 * r:.0f}{more}")
    )
    if head == "a,b,c":
        assert len(readers.read(tmp_path / "it.csv")) == 3  # says nothing, so numbers may
        return
    with pytest.raises(UnknownFormat, match=r"It looks like .* columns"):
        readers.read(tmp_path / "it.csv")


def test_a_table_of_poses_is_no_log(tmp_path):
    """Catches poses that are read as end points, and advice that reads a heading as an angle."""
    path = tmp_path / "it.csv"
    path.write_text("t,x,y,theta\n" + text(f"{k},{k / 10},0.5,0.1" for k in range(20)))
    with pytest.raises(LogError, match="holds poses and no scan: --odometry or --truth"):
        readers.read(path)
    assert readers.read_trajectory(path)[1][3] == pytest.approx([0.3, 0.5, 0.1])


def test_a_file_of_numbers_is_told_with_its_first_lines(tmp_path):
    """Catches an unknown table of which nothing is said but its first word."""
    path = tmp_path / "it.dat"
    path.write_text("1;2;3\n4;5;9\n7;8;1\n2;2;2\n")
    with pytest.raises(UnknownFormat) as caught:
        readers.read(path)
    for part in (
        "3 columns between ';'",
        "    1;2;3\n    4;5;9\n    7;8;1\n",
        "segmap.readers.read_csv('it.dat'",
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


def test_lines_of_a_hokuyo_in_millimetres_are_no_recording_of_rawseeds(tmp_path):
    """Catches the first range of a line read as its time, the others as metres, codes as walls."""
    ranges = np.random.default_rng(3).integers(500, 4000, (9, 682))
    ranges[:, 5] = 7
    path = tmp_path / "it.csv"
    path.write_text(text(",".join(map(str, found)) for found in ranges))
    log = readers.read(path)
    assert len(log) == 9 and np.isnan(log.times).all()
    assert log[2].ranges[6:] == pytest.approx(ranges[2, 6:] / 1000)
    assert not log[2].valid[5]
    assert log[0].angles[[0, -1]] == pytest.approx([-340.5 * np.pi / 512, 340.5 * np.pi / 512])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + bytes(200), "scipy.io.loadmat"),
        (b"MATLAB 7.3 MAT-file, Platform: GLNXA64" + bytes(200), "-v7"),
        (b"\xed\xa1\xda\x01" + bytes(200), "lcm.EventLog"),
        (b"\xdb\x01\xf5\x5b\x7b\x1f\x1d\x7b" + bytes(200), "cartographer_pbstream_to_ros_map"),
        (b"PAR1" + bytes(200), "pandas.read_parquet"),
        (b"\x89HDF\r\n\x1a\n" + bytes(200), "h5py.File"),
        (b"\xd4\xc3\xb2\xa1\x02\x00\x04\x00" + bytes(200), "packets of a network"),
        (pickle.dumps([1.5, 2.5]), "numpy.savez"),
    ],
)
def test_a_file_of_another_program_is_named_with_what_makes_a_table_of_it(tmp_path, content, said):
    """Catches bytes that are shown, and nothing that helps."""
    (tmp_path / "it.log").write_bytes(content)
    with pytest.raises(UnknownFormat, match=f"it.log: is .*{said}") as caught:
        readers.read(tmp_path / "it.log")
    for code in re.findall(r"(?:numpy|pandas)\.\w+\(.*\)", caught.value.reason.split("\n")[0]):
        compile(code, "the advice", "eval")


def test_arrays_of_matlab_are_a_log_by_the_advice(tmp_path, monkeypatch):
    """Catches advice that nobody has followed: arrays with an axis more than a log takes."""
    monkeypatch.chdir(tmp_path)
    held = {"ranges": np.tile(FAR, (3, 1)), "angles": np.radians(TURN), "times": CLOCK, "n": "it"}
    scipy.io.savemat("it.mat", held)
    with pytest.raises(UnknownFormat) as caught:
        readers.read("it.mat")
    (code,) = re.findall(r"numpy\.savez\(.*\)", caught.value.reason.split("\n")[0])
    exec(f"import numpy, scipy.io\npath = 'it.mat'\n{code}", {})
    log = readers.read("it.npz")
    assert log.times == pytest.approx(CLOCK) and log[2].ranges == pytest.approx(FAR)


def advice_followed(path, *modules):
    """What is told of a file of another program is done."""
    with pytest.raises(UnknownFormat) as caught:
        readers.read(path)
    found = re.search(r"(numpy|pandas)\.\w+\(.*?\)(?=,? (makes|keeps))", caught.value.reason)
    exec(f"import {', '.join(modules)}\npath = {str(path)!r}\n{found[0]}", {})


def test_parquet_is_made_a_table_by_its_advice(tmp_path, monkeypatch):
    """Catches advice that nobody has followed."""
    pytest.importorskip("pyarrow", reason="pyarrow is not installed here")
    pandas = pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    rows = [(k, a, 1000 * r) for k, a, r in BEAMS]
    pandas.DataFrame(rows, columns=["scan", "angle_deg", "range_mm"]).to_parquet("it.parquet")
    advice_followed("it.parquet", "pandas")
    assert [scan.ranges for scan in readers.read("it.csv")] == [pytest.approx(FAR)] * 3


def test_arrays_of_hdf5_are_a_log_by_the_advice(tmp_path, monkeypatch):
    """Catches advice that reads the tables of one library only."""
    h5py = pytest.importorskip("h5py", reason="h5py is not installed here")
    monkeypatch.chdir(tmp_path)
    with h5py.File("it.h5", "w") as file:
        file["ranges"], file["angles"], file["times"] = [FAR] * 3, np.radians(TURN), CLOCK
    advice_followed("it.h5", "numpy", "h5py")
    log = readers.read("it.npz")
    assert log.times == pytest.approx(CLOCK) and log[2].ranges == pytest.approx(FAR)


def test_a_workbook_is_made_a_table_by_its_advice(tmp_path):
    """Catches a list of what an Excel file holds in the place of what to do with it."""
    with zipfile.ZipFile(tmp_path / "it.xlsx", "w") as book:
        book.writestr("[Content_Types].xml", "<Types/>")
        book.writestr("xl/workbook.xml", "<workbook/>")
    with pytest.raises(UnknownFormat, match=r"it.xlsx: is a workbook: save its sheet as CSV"):
        readers.read(tmp_path / "it.xlsx")


def test_columns_of_records_are_named_by_the_caller(tmp_path):
    """Catches advice for a JSON file that is refused itself."""
    path = tmp_path / "it.json"
    path.write_text(json.dumps([{"a": a, "d": 33.3 * r} for _, a, r in BEAMS], indent=2))
    with pytest.raises(LogError, match="--columns ") as caught:
        readers.read(path)
    columns = caught.value.reason.partition("--columns ")[2].split()[0]
    log = readers.read_csv(path, columns=columns)
    assert len(log) == 3 and np.degrees(log[0].angles) == pytest.approx(TURN)
    assert readers.read_csv(path, columns="angle_deg,range_m")[1].ranges == pytest.approx(
        33.3 * FAR
    )


@pytest.mark.parametrize("name", ["JSON of scans in lines", "telegrams", "UrgBenri"])
def test_a_damaged_record_is_told_with_its_line_or_left_out(tmp_path, name):
    """Catches a scan of half a telegram, and all others lost for one."""
    content = OTHERS[name][0]
    path = tmp_path / "it.txt"
    number = content.splitlines().index("2012:01:01:12:00:00:000") + 3 if "Urg" in name else 2
    rows = content.splitlines()
    rows[number - 1] = rows[number - 1][:40] if "Urg" not in name else "oops"
    path.write_text(text(rows))
    with pytest.raises(LogError) as caught:
        readers.read(path)
    assert caught.value.line == number
    log = readers.read(path, on_error="skip")
    assert len(log) == 2 and log.skipped.lines == 1


@pytest.mark.parametrize("end", [', {"angle_deg"', ', {"angle_deg": 3, "range_m": 2', ","])
def test_a_list_of_records_that_was_never_closed_is_told(tmp_path, end):
    """Catches a cut list whose last beams are lost without a word: its words read as labels."""
    path = tmp_path / "it.json"
    whole = [{"angle_deg": k, "range_m": 2 + k / 10} for k in range(3)]
    path.write_text(json.dumps(whole)[:-1] + end)
    with pytest.raises(LogError, match="expected JSON") as caught:
        readers.read(path)
    assert caught.value.line == 1
    log = readers.read(path, on_error="skip")
    assert log[0].ranges == pytest.approx([2, 2.1, 2.2]) and log.skipped.lines > 0


@pytest.mark.parametrize(
    "head",
    ["Czas [ms];Kąt [stopnie];Odległość [cm]", "时间 (毫秒);角度 (度);距离 (厘米)",
     "Время (мс);Угол (град);Расстояние (см)", "Zaman (ms);Aci (whatever);Mesafe (cm)"],
)  # fmt: skip
def test_units_count_though_their_neighbours_are_not_understood(tmp_path, head):
    """Catches centimetres read as millimetres, or so advised, for a word beside them."""
    path = tmp_path / "it.csv"
    far = (180 + 30 * np.sin(np.arange(360) / 20)).astype(int)
    rows = [f"{100 * turn};{k};{far[k]}" for turn in range(3) for k in range(360)]
    path.write_text(text([head, *rows]), encoding="utf-8")
    if "whatever" in head:
        with pytest.raises(LogError, match="--columns time_ms,angle_deg,range_cm"):
            readers.read(path)
    else:
        log = readers.read(path)
        assert log.times == pytest.approx([0, 0.1, 0.2])
        assert log[1].ranges == pytest.approx(far / 100)


def test_poses_before_bare_ranges_are_no_beams(tmp_path):
    """Catches x, y and heading read as three beams, and a count as one; the advice is run."""
    path = tmp_path / "it.txt"
    ranges = np.random.default_rng(3).uniform(0.5, 5, (6, 181)).round(3)
    poses = np.column_stack([np.arange(6), np.full((6, 2), 0.25)])
    rows = [row([*pose, *found]) for pose, found in zip(poses, ranges, strict=True)]
    path.write_text(text(rows))
    with pytest.raises(LogError, match="181 of them ranges behind 3 others") as caught:
        readers.read(path)
    assert "x_m,y_m,theta_rad" in caught.value.reason
    head = ["x_m", "y_m", "theta_rad", *(f"r{k}" for k in range(181))]
    path.write_text(text([" ".join(head), *rows]))
    log = readers.read(path)
    assert log[2].ranges == pytest.approx(ranges[2]) and log.odometry == pytest.approx(poses)
    path.write_text(text(f"{k} 181 {row(found)}" for k, found in enumerate(ranges)))
    assert readers.read(path)[2].ranges == pytest.approx(ranges[2])


def test_a_scan_a_column_is_turned_by_its_advice(tmp_path, monkeypatch):
    """Catches a column of each scan that is read as a beam."""
    monkeypatch.chdir(tmp_path)
    head = ["angle_deg," + ",".join(f"scan{k}" for k in range(8))]
    rows = [f"{a:.0f}," + ",".join([f"{r:.3f}"] * 8) for a, r in zip(TURN, FAR, strict=True)]
    (tmp_path / "it.csv").write_text(text(head + rows))
    with pytest.raises(LogError, match="a column of angles and 8 of ranges") as caught:
        readers.read("it.csv")
    (code,) = re.findall(r"pandas\..*False\)", caught.value.reason)
    exec(f"import pandas\npath = 'it.csv'\n{code}", {})
    log = readers.read("turned.csv")
    assert len(log) == 8 and log[3].ranges == pytest.approx(FAR)
    assert np.degrees(log[3].angles) == pytest.approx(TURN)


@pytest.mark.parametrize("shown", ["- 1.0\n- '...'", "'<sequence type: float, length: 9>'"])
def test_ranges_that_ros2_shortened_are_told_with_the_option(tmp_path, shown):
    path = tmp_path / "it.yaml"
    path.write_text(echo(secs, [f"ranges: {shown}"]))
    with pytest.raises(LogError, match="ros2 topic echo --full-length"):
        readers.read(path)


def test_a_line_of_ros2_over_an_endless_view_is_refused(tmp_path):
    """Catches an overflow that no user reads."""
    content = OTHERS["ros2 --csv"][0]
    assert "5.759587" in content
    (tmp_path / "it.csv").write_text(content.replace("5.759587", "inf"))
    with pytest.raises(LogError):
        readers.read(tmp_path / "it.csv")


def test_a_message_in_which_the_text_ends_is_no_scan(tmp_path):
    """Catches a scan with the half of its beams: the printing was stopped."""
    path = tmp_path / "it.yaml"
    path.write_text(OTHERS["rostopic echo"][0][:-30])
    with pytest.raises(LogError, match="is cut off in it"):
        readers.read(path)
    assert len(readers.read(path, on_error="skip")) == 2


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


@pytest.mark.parametrize(
    "word", ["-Infinity", "1.#INF", "#NUM!", "OL", "out of range", "-0.0", "-1"]
)
def test_words_for_nothing_measured_are_no_damage(tmp_path, word):
    """Catches a word of Excel, of a compiler or of a person that ends the reading."""
    (tmp_path / "it.csv").write_text(f"angle_deg,range_m\n0,1.5\n10,{word}\n20,1.7\n")
    (scan,) = readers.read(tmp_path / "it.csv")
    assert scan.valid.tolist() == [True, False, True]


#: Whose first beam is at 324.27 degrees and 0.224 m, and whose last at 334.7.
PACKET_OF_THE_DATA_SHEET = (
    "54 2C 68 08 AB 7E E0 00 E4 DC 00 E2 D9 00 E5 D5 00 E3 D3 00 E4 D0 00 E9 CD 00 E4 CA 00 E2 "
    "C7 00 E9 C5 00 E5 C2 00 E5 C0 00 E5 BE 82 3A 1A 50"
)


def test_packets_that_are_damaged_are_told_or_left_out(tmp_path):
    """Catches a wrong range that is believed, a clock that begins anew, and a cut begin or end."""
    packets = [ld19(k) for k in (148, 149, 150, 151)]
    path = tmp_path / "it.bin"
    path.write_bytes(packets[0][30:] + b"".join(packets) + packets[0][:30])
    log = readers.read(path)
    assert log.times == pytest.approx(29.6 + 0.2 * np.arange(4)) and not log.skipped
    assert log[0].delays is None and log[3].ranges == pytest.approx(FAR[::-1], abs=5e-4)
    path.write_text(PACKET_OF_THE_DATA_SHEET)
    assert readers.read(path)[0].ranges[[-1, -2]] == pytest.approx([0.224, 0.220])
    assert np.degrees(-readers.read(path)[0].angles[[-1, 0]]) == pytest.approx([324.27, 334.7])
    packets[1] = packets[1][:10] + b"\xff" + packets[1][11:]
    path.write_bytes(b"".join(packets))
    with pytest.raises(LogError, match="bytes 47 to 94 are no whole packets of an LD19"):
        readers.read(path)
    log = readers.read(path, on_error="skip")
    assert log.times == pytest.approx([29.6, 30.0, 30.2]) and log.skipped.lines == 1


@pytest.mark.parametrize("content", [
    text(f"{k} {np.sin(k / 10):.4f}" for k in range(360)),
    "sensor:\n  ranges: [0.1, 30.0]\n  rate: 10\n",
    "angle_min: -1.57\nangle_max: 1.57\nrange_max: 30.0\nframe_id: laser\n",
    text(",".join(f"{h:02}:{m:02}" for h, m in enumerate(range(12))) for _ in "123"),
    text(bytes(range(40 + k, 72 + k)).hex(" ") for k in range(40)),
], ids=["waves", "limits", "settings", "clock", "bytes"])  # fmt: skip
def test_what_only_looks_like_beams_is_no_log(tmp_path, content):
    """Catches a wave that is a Hokuyo's scan, limits of a sensor that are two beams."""
    (tmp_path / "it.txt").write_text(content)
    with pytest.raises(LogError):
        readers.read(tmp_path / "it.txt")


def test_units_of_a_file_come_before_those_of_the_program(tmp_path):
    """Catches radians that are read as the degrees of a program whose names they have."""
    (tmp_path / "it.csv").write_text(
        "angle(rad),distance(mm),intensity\n"
        + lines(lambda k, a, r: f"{np.radians(a):.5f},{1000 * r:.0f},9")
    )
    log = readers.read(tmp_path / "it.csv")
    assert len(log) == 3 and np.sort(-np.degrees(log[0].angles)) == pytest.approx(TURN, abs=1e-3)


def test_decimals_after_commas_are_no_pairs_of_a_radar(tmp_path):
    """Catches ranges in metres that become angles and centimetres, each of two neighbours."""
    ranges = np.linspace(0.101, 0.281, 181)
    (tmp_path / "it.csv").write_text(
        "".join(f"{t}," + ",".join(f"{r:.3f}" for r in ranges) + "\n" for t in range(3))
    )
    assert not any("radar" in said for said in _assumed(tmp_path / "it.csv"))


# ----------------------------------------------- who measured, where a scan ends, what is no range
@pytest.mark.parametrize(("name", "values"), [
    ("sensor", ("front", "rear")), ("robot_id", "12"), ("frame_id", ("laser_a", "laser_b")),
    ("Lidar-No", "01"), ("topic", ("/scan_front", "/scan_rear")), ("is_front", ("False", "True")),
    ("layer", "0123"), ("Gerät", ("hinten", "vorne")),
])  # fmt: skip
@pytest.mark.parametrize("mark", [",", ";"])
def test_two_sensors_in_a_table_are_parted_by_the_advice(tmp_path, monkeypatch, name, values, mark):
    """Catches two lasers or robots whose scans become one, and advice that does not run."""
    monkeypatch.chdir(tmp_path)
    rows = (
        [f"{who}", f"{0.2 * k:.1f}", f"{a:.1f}", f"{r + n:.3f}"]
        for k in range(3)
        for n, who in enumerate(values)
        for a, r in zip(TURN, FAR, strict=True)
    )
    table = [[name, "time_s", "angle_deg", "range_m"], *rows]
    (tmp_path / "it.csv").write_text(text(["# note", *map(mark.join, table)]))
    with pytest.raises(LogError, match=f"'{name}' holds {values[0]}, {values[1]}") as caught:
        readers.read("it.csv")
    advice = caught.value.reason.partition("; ")[2].removesuffix(" parts them")
    exec(advice, {"pandas": pandas, "path": "it.csv"})
    assert len([*tmp_path.iterdir()]) == 1 + len(values)
    for n in range(len(values)):
        log = readers.read(f"part{n + 1}.csv")
        assert log.times == pytest.approx([0, 0.2, 0.4])
        assert all(scan.ranges == pytest.approx(FAR + n) for scan in log)


@pytest.mark.parametrize("order", ["beams", "scans", "sensors", "half a turn apart"])
@pytest.mark.parametrize("timed", [True, False])
def test_two_sensors_are_refused_in_any_order(tmp_path, order, timed):
    """Catches beams of two lasers, in turn or one after the other, that are read as one's."""
    late = 0.1 * (order == "half a turn apart")
    rows = [
        (k, 0.2 * k + late * n, i, n, a, r + n + 0.02 * k)
        for k in range(4)
        for n in (0, 1)
        for i, (a, r) in enumerate(zip(TURN, FAR, strict=True))
    ]
    if order == "beams":
        rows.sort(key=lambda each: (each[0], each[2]))
    if order == "sensors":
        rows.sort(key=lambda each: each[3])
    table = (f"{n},{t if timed else k},{a:.1f},{r:.3f}" for k, t, _, n, a, r in rows)
    head = f"channel,{'time_s' if timed else 'scan'},angle_deg,range_m"
    (tmp_path / "it.csv").write_text(text([head, *table]))
    with pytest.raises(LogError, match="'channel' holds 0, 1: expected one sensor a log"):
        readers.read(tmp_path / "it.csv")


@pytest.mark.parametrize(("name", "value"), [
    ("source", lambda k, i, r: ["measured", "interpolated"][i % 3 == 0]),
    ("source", lambda k, i, r: f"scan_{k}.txt"), ("source", lambda k, i, r: f"log_{k // 4}.txt"),
    ("sensor", lambda k, i, r: ["warm", "ready"][k > 2]), ("laser", lambda k, i, r: i % 2),
    ("device", lambda k, i, r: ["Lidar", "lidar "][k % 2]), ("robot", lambda k, i, r: k % 2),
    ("sensor", lambda k, i, r: "far" if r > 3 else "near"),
    ("lidar", lambda k, i, r: (i + k) % 2),
])  # fmt: skip
def test_one_sensor_is_read_whatever_a_column_is_called(tmp_path, name, value):
    """Catches a log that is refused as that of two sensors, by a name, though none look twice."""
    rows = (
        f"{value(k, i, r)},{0.2 * k:.1f},{a:.1f},{r + 0.02 * k:.3f}"
        for k in range(8)
        for i, (a, r) in enumerate(zip(TURN, FAR, strict=True))
    )
    (tmp_path / "it.csv").write_text(text([f"{name},time_s,angle_deg,range_m", *rows]))
    log = readers.read(tmp_path / "it.csv")
    assert log.times == pytest.approx(0.2 * np.arange(8))
    assert all(scan.ranges == pytest.approx(FAR + 0.02 * k) for k, scan in enumerate(log))


def test_words_that_change_between_scans_are_told(tmp_path):
    """Catches a column of words that may say who measured and is left out without a word."""
    path = tmp_path / "it.csv"
    for words, said in (("ab", True), ("aa", False)):
        path.write_text(
            "side,angle_deg,range_m,note\n"
            + lines(lambda k, a, r, words=words: f"{words[k % 2]},{a},{r},{'xy'[int(a) % 60 > 0]}")
        )
        assert (
            any("'side' holds a, b and is left out" in t for t in readers.read(path).assumed)
            == said
        )
        assert not any("'note'" in told for told in readers.read(path).assumed)


def test_words_without_a_head_are_parted_by_the_advice(tmp_path, monkeypatch):
    """Catches advice that groups by a name where there is none."""
    monkeypatch.chdir(tmp_path)
    rows = (
        f"{w} {0.2 * k:.1f} {a:.1f} {r:.3f}" for k, a, r in BEAMS for w in (["old", "new"][k % 2],)
    )
    (tmp_path / "it.txt").write_text(text(rows))
    (told,) = [said for said in readers.read("it.txt").assumed if "holds old, new" in said]
    advice = told.partition("; ")[2].removesuffix(" parts them")
    exec(advice, {"pandas": pandas, "path": "it.txt"})
    assert len(readers.read("part2.csv")) == 2 and readers.read("part2.csv")[
        1
    ].ranges == pytest.approx(FAR)


def test_a_sweep_to_and_fro_is_a_scan_each_way(tmp_path):
    """Catches a servo whose sweeps are all one scan, and a beam that trembles taken for a turn."""
    path = tmp_path / "it.csv"
    sweep = np.arange(0, 181.0, 3)
    rng = np.random.default_rng(2)
    for tremble in (0, 2):
        turns = [sweep if k % 2 == 0 else sweep[::-1] for k in range(5)]
        turns = [turn + rng.uniform(-tremble, tremble, len(turn)) for turn in turns]
        rows = (f"{a:.2f},{200 + k + a / 10:.1f}" for k, turn in enumerate(turns) for a in turn)
        path.write_text("angle_deg,distance_cm\n" + text(rows))
        log = readers.read(path)
        assert [len(scan) for scan in log] == pytest.approx([61] * 5, abs=2 * bool(tremble))
        assert "a scan ends where the angle turns back" in log.assumed
        assert log[3].ranges[20] == pytest.approx(
            2.03 + log[3].angles[20] * 18 / np.pi / 100, abs=5e-3
        )


def test_times_that_last_for_several_turns_or_for_parts_of_one_end_no_scan(tmp_path):
    """Catches a clock in whole seconds, or one a packet, that is taken for the number of a scan."""
    path = tmp_path / "it.csv"
    for clock in (lambda k, a: k // 2, lambda k, a: round(0.3 * k + 0.1 * (a // 120), 1)):
        rows = (f"{clock(k, a)},{a},{2 + k / 10 + a / 1000:.3f}" for k in range(6) for a in TURN)
        path.write_text("time_s,angle_deg,range_m\n" + text(rows))
        log = readers.read(path)
        assert [len(scan) for scan in log] == [12] * 6


@pytest.mark.parametrize("period_s", [0.7, 1.02, 1.3])
def test_a_clock_whose_step_is_no_turn_ends_no_scan(tmp_path, period_s):
    """Catches whole seconds taken for stamps of turns: d02..d06, e07.., f05..f09 of round 4."""
    path, angles = tmp_path / "it.csv", np.arange(0, 360, 10)
    rows = (
        f"{int(period_s * (k + a / 360))},{a},{2 + k / 10 + a / 1000:.3f}"
        for k in range(12)
        for a in angles
    )
    path.write_text("time_s,angle_deg,range_m\n" + text(rows))
    log = readers.read(path)
    assert [len(scan) for scan in log] == [36] * 12
    assert log[7].ranges == pytest.approx(2.7 + angles / 1000)


@pytest.mark.parametrize("way", [1, -1])
def test_a_stamp_of_each_turn_ends_it_wherever_it_begins(tmp_path, way):
    """Catches turns from 200 without some beams, or sweeps, that are cut elsewhere: b2, b3, b9."""
    path, rng = tmp_path / "it.csv", np.random.default_rng(4)
    turn = (np.arange(200, 560, 5) + 180) % 360 - 180
    kept = [turn[np.sort(rng.choice(72, 60, replace=False))] for _ in range(9)]
    for scans in (kept, [np.arange(0, 181, 5)[:: (-1) ** k] for k in range(9)]):
        rows = (f"{0.1 * k:.1f},{way * a},{2 + k}" for k, beams in enumerate(scans) for a in beams)
        path.write_text("time_s,angle_deg,range_m\n" + text(rows))
        log = readers.read(path)
        assert [len(scan) for scan in log] == [len(beams) for beams in scans]
        assert "a scan ends where its time does" in log.assumed


def test_few_beams_on_the_way_back_are_no_scan(tmp_path):
    """Catches scans of the three beams that a servo measures on its way back: c15 of round 4."""
    path, sweep = tmp_path / "it.csv", [*range(0, 181, 3), 140, 94, 44]
    for begin in (0, 61):  # with a sweep, or on a way back
        beams = [(k, a) for k in range(5) for a in sweep][begin:]
        path.write_text("angle_deg,distance_cm\n" + text(f"{a},{200 + k}" for k, a in beams))
        log = readers.read(path)
        assert [len(scan) for scan in log[-4:]] == [64] * 4
        assert len(log) == 5 and any("its way back included" in told for told in log.assumed)
        assert np.ptp(log[-1].ranges) < 0.02


@pytest.mark.parametrize(("count", "unit"), [(181, 1000), (361, 1), (682, 1000), (60, 1000)])
def test_a_first_beam_whose_range_rises_is_no_clock(tmp_path, count, unit):
    """Catches a wall that recedes ahead taken for times: e01, e01b, b24, d18 and d19 of round 4."""
    path, steps = tmp_path / "it.txt", np.random.default_rng(3).integers(20, 40, 12)
    ranges = np.tile(np.linspace(1500, 4000, count), (12, 1))
    ranges[:, : count if count == 60 else 1] += np.cumsum(steps)[:, None]
    path.write_text(text(row((found.round() * unit / 1000).tolist()) for found in ranges))
    log = readers.read(path)
    assert np.isnan(log.times).all() and len(log) == 12
    assert log[3].ranges == pytest.approx(ranges[3].round() / 1000)


def test_a_clock_before_half_a_turn_of_ranges_is_none_of_them(tmp_path):
    """Catches 181 numbers that are all ranges since a laser has as many, though time is first."""
    path, ranges = tmp_path / "it.txt", np.linspace(500, 4000, 180).round()
    path.write_text(text(row([3000 + 100 * k, *ranges]) for k in range(12)))
    log = readers.read(path)
    assert log[3].ranges == pytest.approx(ranges / 1000) and np.ptp(log.times) > 1


def test_numbers_before_the_ranges_are_no_beams(tmp_path):
    """Catches wheels, poses and zeros of a line that become beams, and advice that is refused."""
    rng, path = np.random.default_rng(5), tmp_path / "it.txt"
    ranges = rng.integers(500, 4000, (9, 360))
    path.write_text(text(
        row([1e6 + 1e5 * k, 0, 50 * k, 51 * k, *[0] * 20, *r, 0]) for k, r in enumerate(ranges)
    ))  # fmt: skip
    log = readers.read(path)
    assert log[4].ranges == pytest.approx(ranges[4] / 1000) and log.times[1] == pytest.approx(1.1)
    assert np.degrees(log[0].angles[[0, -1]]) == pytest.approx([-180, 179])
    assert any("wheels are left out" in said for said in log.assumed)
    for mark in (" ", ",", ";"):
        for head in ([0.1, -0.2, 0.3], [0.1, -0.2, 0.3, 0.4, 7]):
            rows = (
                [0.1 * k, *(np.array(head) * (k + 1)).round(3), *(r / 1000)]
                for k, r in enumerate(ranges)
            )
            path.write_text(text(mark.join(f"{v:.3f}" for v in found) for found in rows))
            with pytest.raises(LogError, match=f"{len(head) + 1} others") as caught:
                readers.read(path)
            path.write_text(caught.value.reason.rpartition(": ")[2] + "\n" + path.read_text())
            log = readers.read(path)
            assert log[4].ranges == pytest.approx(ranges[4] / 1000)
            if len(head) == 3:
                assert log.odometry[1] == pytest.approx([0.2, -0.4, 0.6])


@pytest.mark.parametrize("first", ["", "0"])
@pytest.mark.parametrize("unit", [1.0, np.pi / 180])
def test_a_first_line_of_angles_is_no_scan(tmp_path, first, unit):
    """Catches directions above the ranges of a matrix that become a scan of -90 to 90 m."""
    angles, path = np.arange(-90.0, 91), tmp_path / "it.csv"
    ranges = np.random.default_rng(1).uniform(1, 5, (6, 181)).round(3)
    rows = [
        [first] * bool(first) + [f"{a * unit:.5g}" for a in angles],
        *([f"{0.1 * k:.1f}"] * bool(first) + [*map(str, r)] for k, r in enumerate(ranges)),
    ]
    path.write_text(text(map(",".join, rows)))
    log = readers.read(path)
    assert len(log) == 6 and log[5].ranges == pytest.approx(ranges[5])
    assert np.degrees(log[0].angles) == pytest.approx(angles, abs=0.01)
    assert log.times == pytest.approx(
        0.1 * np.arange(6) if first else np.full(6, np.nan), nan_ok=True
    )


def test_rows_of_odometry_between_those_of_scans_are_their_poses(tmp_path):
    """Catches a table of two topics with empty cells that `holds poses and no scan`."""
    names = "__time,/odom/pose/position/x,/odom/pose/position/y,/odom/pose/yaw"
    rows = [names + "".join(f",/scan/ranges[{k}]" for k in range(360))]
    for k in range(4):
        rows += [f"{10 + k}.1,{k}.5,0.5,0.1" + "," * 360, f"{10 + k}.2,,," + ",1.234" * 360]
    (tmp_path / "it.csv").write_text(text(rows))
    log = readers.read(tmp_path / "it.csv")
    assert len(log) == 4 and log.times == pytest.approx([10.2, 11.2, 12.2, 13.2])
    assert log.odometry[3] == pytest.approx([3.5, 0.5, 0.1])


def test_points_beside_a_pose_are_beams(tmp_path):
    """Catches x and y of points that are taken for those of the robot, and odometry lost."""
    (tmp_path / "it.csv").write_text(
        "scan,x,y,robot_x,robot_y,robot_theta\n"
        + lines(lambda k, a, r: (
            f"{k},{r * np.cos(np.radians(a)):.4f},{r * np.sin(np.radians(a)):.4f},{k}.5,0.5,0.1"))
    )  # fmt: skip
    log = readers.read(tmp_path / "it.csv")
    assert len(log) == 3 and log[1].ranges == pytest.approx(FAR, abs=1e-3)
    assert log.odometry == pytest.approx(np.column_stack([[0.5, 1.5, 2.5], [0.5] * 3, [0.1] * 3]))
    assert "the laser sits at the robot's centre" in log.assumed


def test_a_line_above_each_scan_tells_its_time_and_is_told(tmp_path):
    """Catches the words above blocks of beams that make poses of the file, or are lost untold."""
    rows = (
        f"{a} {r:.3f}" if n else f"Scan {k} t={0.2 * k:.1f} s x=0.1 y=0.2 theta=0.3\n{a} {r:.3f}"
        for k in range(3)
        for n, (a, r) in enumerate(zip(np.arange(0, 360, 5), np.linspace(1, 4, 72), strict=True))
    )
    (tmp_path / "it.txt").write_text(text(rows))
    log = readers.read(tmp_path / "it.txt")
    assert [len(scan) for scan in log] == [72] * 3 and log.times == pytest.approx([0, 0.2, 0.4])
    assert any("lines between scans are left out, such as 'Scan 1" in said for said in log.assumed)


def test_x_and_y_without_names_are_no_range_and_angle(tmp_path, monkeypatch):
    """Catches advice that reads points as negative ranges."""
    monkeypatch.chdir(tmp_path)
    rows = (
        f"{far * np.cos(a):.3f} {far * np.sin(a):.3f}"
        for k in range(3)
        for a, far in zip(
            np.radians(np.arange(-90, 91, 2)), 2 + np.sin(np.arange(91) / 4), strict=True
        )
    )
    (tmp_path / "it.dat").write_text(text(rows))
    with pytest.raises(UnknownFormat, match="--columns x_m,y_m reads it"):
        readers.read("it.dat")
    log = readers.read_csv("it.dat", columns="x_m,y_m")
    assert len(log) == 3 and log[0].ranges == pytest.approx(2 + np.sin(np.arange(91) / 4), abs=2e-3)


def test_an_unknown_unit_is_named_and_the_known_ones_are_kept(tmp_path):
    """Catches advice by the places of columns that overrules what their head says."""
    (tmp_path / "it.csv").write_text(
        "range_cm,weg_yd,angle_furlong\n" + lines(lambda k, a, r: f"{100 * r:.1f},7,{a}")
    )
    with pytest.raises(
        UnknownFormat, match=r"'angle_furlong'\. If it is so, --columns range_cm,-,ang"
    ):
        readers.read(tmp_path / "it.csv")


def test_four_hundred_grad_are_a_turn(tmp_path):
    """Catches gon that a program calls grad, as German calls degrees."""
    for most, name in ((400, "angle_grad"), (360, "Winkel [Grad]")):
        (tmp_path / "it.csv").write_text(
            f"{name},range_m\n" + text(f"{a / 36 * most:.4f},2.5" for a in range(36))
        )
        log = readers.read(tmp_path / "it.csv")
        assert np.degrees(log[0].angles[[1, -1]]) == pytest.approx([10, 350])


def test_columns_that_fit_hardly_a_line_are_refused(tmp_path, capsys):
    """Catches angle and range in the wrong order that leave out most lines and end well."""
    path = tmp_path / "it.csv"
    path.write_text("a,b\n" + lines(lambda k, a, r: f"{250 * r:.0f},{a}"))
    assert main(["info", str(path), "--columns", "angle_deg,range_mm"]) != 0
    assert "of 36 lines are no angle_deg,range_mm" in capsys.readouterr().err
    assert main(["info", str(path), "--columns", "range_mm,angle_deg"]) == 0


def test_a_pdf_is_called_one(tmp_path):
    """Catches a document of which only its first word is said."""
    (tmp_path / "it.pdf").write_bytes(b"%PDF-1.4\n%\xe2\xe3\n1 0 obj\n")
    with pytest.raises(UnknownFormat, match="of PDF, a document"):
        readers.read(tmp_path / "it.pdf")


def test_lists_with_beams_that_met_nothing_warn_of_nothing(tmp_path):
    """Catches differences of infinities, of which numpy warns."""
    turn = ["inf"] * 90 + ["2.5"] * 270
    (tmp_path / "it.dat").write_text(text(f"[{', '.join(turn)}]" for _ in range(8)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isinf(readers.read(tmp_path / "it.dat")[3].ranges).sum() == 90


def _assumed(path) -> tuple[str, ...]:
    """What is assumed of a file, if it is read."""
    try:
        return readers.read(path).assumed
    except LogError:
        return ()
