"""`segmap ...`: each command on a real log, its exit code, its words, and its files read back."""

import json
import re
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import alignment_logs as logs
import bag_samples
import nbformat
import numpy as np
import pandas as pd
import pytest
from chapter_rules import links, markdown
from conftest import later
from makefile import ROOT
from programs import program

import segmap
from segmap import alignment, exports, metrics, poses, readers, reduction, simulation
from segmap.arrays import Metres, Radians, RadiansPerMetre, checked
from segmap.methods import Method
from segmap.quadtree import QuadtreeMap, extent
from segmap.scans.causes import Cause, Finding
from segmap_app import files

main = program("segmap")

plt = later("matplotlib.pyplot")

PNG = b"\x89PNG"
SCANS = 12
#: A Hokuyo scan as text, which saw nothing, and one of a wall of 1 m.
DARK, WALL = (
    "urg_mm angle_rad\n" + "".join(f"{r} {k / 100:.2f}\n" for k in range(100)) for r in (0, 1000)
)


#: Takes the poses of a log as they are.
TRUE = "--align", "ground_truth"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Pieces of the Malaga log, with a true pose for each scan, as a folder of logs."""
    place = tmp_path_factory.mktemp("logs")
    log = segmap.load("malaga")
    true = alignment.ground_truth(log, missing="drop").poses
    for name, first in (("near", 0), ("far", 60)):
        part = slice(first, first + SCANS)
        exports.write_carmen(place / f"{name}.log", log[part], true[part])
    return place


@pytest.fixture
def near(folder):
    return str(folder / "near.log")


def expected(path, method, **settings):
    log = segmap.read(path)
    return reduction.METHODS[method](segmap.build_map(log, log.truth, keep_points=True), **settings)


# ------------------------------------------------------------------------------ info
def test_info_tells_what_malaga_is(run, tmp_path):
    """Catches a path without the odometry, a view in radians, a count of beams of one scan.

    A folder of numbered scans is one log.
    """
    (tmp_path / "walk").mkdir()
    for k in range(3):
        (tmp_path / "walk" / f"scan_{k}.txt").write_text(WALL)
    code, said, beside = run("info", "malaga", ROOT / "data/malaga/malaga.log.gz", "walk")
    assert code == 0 and beside == ""
    for part in ("225 scans in 59.1 s", "361 a scan", "180 degrees, 0.5 from beam to beam",
                 "for each scan; a path of 76.4 m", "for 99 of 225 scans", "CARMEN",
                 "3 scans", "numbered scans"):  # fmt: skip
        assert part in said
    assert said.splitlines()[-1] == "3 of 3 logs done"


def test_info_counts_damaged_lines_and_the_others_refuse_them(run, near):
    """Catches a damaged log that `info` cannot tell of, and one that is mapped without a word."""
    Path("cut.log").write_text(Path(near).read_text() + "FLASER 361 1.0\n")
    code, said, _ = run("info", "cut.log")
    assert code == 0 and "damaged   1 line left out; cut.log, line" in said
    code, said, beside = run("map", "cut.log", "--method", "none", "-o", "cut.csv")
    assert code == 1 and not Path("cut.csv").exists() and said == ""
    assert re.match(r"segmap: cut.log, line \d+: .*\(--skip leaves damaged lines out\)\n", beside)
    code, said, _ = run("map", "cut.log", "--method", "none", "--skip", "-o", "cut.csv", "--json")
    found = json.loads(said)["damaged"]
    assert code == 0 and found["lines"] == 1 and "1 line left out; cut.log, line" in found["text"]


def test_info_tells_what_a_session_keeps_and_no_map_is_a_log(run):
    """Catches a session that passes for arrays, and maps in a folder that are faults there."""
    log, (one, two) = segmap.load("room")[:3], ({"filter": 0.5, "text": "x"}, {})
    files.write_session("it.segmap", files.Session(log, one, [{}, {}], two))
    segmap.build_map(log, log.truth).save("segments.npz")
    segmap.quadtree.build_map(log, log.truth).save("squares.npz")
    exports.write_arrays("log.npz", log)
    Path("walk.txt").write_text(WALL)
    code, said, beside = run("info", ".")
    assert code == 0 and said.splitlines()[-1] == "3 of 3 logs done"
    assert "left out, since no log: segments.npz, squares.npz" in beside
    code, said, _ = run("info", "it.segmap", "log.npz")
    assert "it: session, it.segmap\n" in said and "log: NPZ, log.npz\n" in said
    for line in ("settings  filter 0.5, text x", "edits     none", "runs      2 runs"):
        assert said.count(f"  {line}\n") == 1
    found = json.loads(run("info", "it.segmap", "--json")[1])
    assert found["settings"]["options"] == one and found["runs"]["runs"] == 2


def test_columns_and_poses_of_a_log_are_options(run):
    """Catches columns that Python alone can name, and a file of poses that is sought in a bag."""
    rows = [f"{0.1 * (k // 9):.1f} {20 * (k % 9)} {500 + k}" for k in range(27)]
    Path("it.txt").write_text("\n".join(rows) + "\n")
    Path("it.tum").write_text("".join(f"{k / 10} {k} 0 0 0 0 0 1\n" for k in range(3)))
    given = ("--columns", "t_s,angle_deg,range_mm", "--truth", "it.tum", "--odometry", "it.tum")
    code, said, _ = run("info", "it.txt", *given)
    assert code == 0 and "3 scans in 0.2 s" in said and said.count("a path of 2.0 m") == 2
    assert "poses of it.tum are the robot's" in said
    code, _, beside = run("info", "it.txt", "--columns", "angle,range_mm,t")
    assert code == 1 and "the unit of 'angle' is not said" in beside
    bag = bag_samples.write(Path(), "mcap")
    code, said, _ = run("info", bag, "--scan-topic", "/scan", "--truth", "/odom")
    assert code == 0 and "truth     for each scan" in said


# ------------------------------------------------------------------------------ map
def test_a_map_is_what_the_library_makes_in_every_format(run, near):
    """Catches another map than the printed one, and files of the map before the reduction."""
    figures = plt.get_fignums()
    names = [f"it.{suffix}" for suffix in ("csv", "npz", "svg", "dxf", "geojson", "wkt", "png")]
    outputs = [word for name in names for word in ("-o", name)]
    code, said, _ = run("map", near, *TRUE, "--method", "fusion:tolerance=0.06", *outputs)
    wanted = expected(near, "fusion", tolerance=0.06)
    assert code == 0 and f"by fusion: {len(wanted)} segments left" in said
    assert "by ground_truth: 12 of 12 scans" in said
    kept = segmap.quality(segmap.build_map(segmap.read(near), segmap.read(near).truth), wanted)
    assert f"quality   {100 * kept:.1f} %" in said and ", ".join(names) in said
    off = metrics.errors(segmap.build_map(segmap.read(near), segmap.read(near).truth), wanted)
    told = re.search(r"lie ([\d.]+) (mm|m) off on average, ([\d.]+) (mm|m) at most", said).groups()
    told = [float(told[k]) / {"mm": 1000, "m": 1}[told[k + 1]] for k in (0, 2)]
    assert told == pytest.approx([off.mean(), off.max()], abs=0.005)
    assert said.startswith(f"near: 12 scans, {near}\n")
    for name in ("it.csv", "it.npz"):
        assert np.array_equal(readers.read_segments(name).segments, wanted.segments)
    assert len(json.loads(Path("it.geojson").read_text())["features"]) == len(wanted)
    assert {path.name for path in Path().iterdir()} == set(names)
    # a picture holds both maps at one scale, and needs no display
    run("map", near, *TRUE, "--method", "none", "-o", "none.png")
    one, both = (plt.imread(name) for name in ("none.png", "it.png"))
    assert one.shape[:2] != both.shape[:2] and both.size > 1.5 * one.size
    assert plt.get_fignums() == figures


@pytest.mark.parametrize("command", ["map", "compare", "occupancy"])
def test_beams_with_times_are_carried_to_the_start_of_their_scan(run, command, only):
    """Catches a command that de-skews in silence, or not at all, and one that cannot leave it."""
    log = logs.moving_log()
    exports.write_arrays("moving.npz", log)
    if command == "compare":
        only("fusion")
    words = command, "moving.npz", "--align", "pose_graph"
    code, said, _ = run(*words, "--json")
    found = json.loads(said)
    assert code == 0 and found["de-skewed"]["scans"] == len(log)
    assert "by how the robot moved" in found["de-skewed"]["text"]
    assert "notes" not in found["aligned"]
    if command == "map":
        new = alignment.prepared(log)
        wanted = segmap.build_map(new, alignment.pose_graph(new).trusted)
        assert found["extracted"]["segments"] == len(wanted)
    code, said, _ = run(*words, "--no-deskew")
    assert code == 0 and "de-skewed" not in said
    assert "scans the robot moved by more than the spacing of the beams, up to" in said


def test_beams_that_see_the_robot_are_kept_where_that_is_asked_for(run):
    """Catches an option that changes nothing, and a mask that the command does not tell."""

    def blocked(k, ranges):
        ranges[20:50] = ranges[130:160] = 0.6
        return ranges

    stops = [(1, 5), (2, 5), (2, 6.5), (2, 5), (7, 5), (6, 5), (6, 6.5), (6, 5), (1, 5)]
    path = simulation.drive(stops, step=0.2, turn=np.radians(12))
    sensor, rng = simulation.SICK_LMS200, np.random.default_rng(5)
    log = simulation.simulate(logs.OFFICE, path, sensor=sensor, rng=rng)
    exports.write_arrays("blocked.npz", logs.changed(log, blocked))
    words = "map", "blocked.npz", "--method", "none"
    code, said, _ = run(*words)
    told = "beams see the robot itself: --keep-body keeps them"
    assert code == 0 and told in " ".join(said.split())
    kept = run(*words, "--keep-body")[1]
    assert told not in kept
    few, many = (int(re.findall(r"extracted (\d+)", text)[0]) for text in (said, kept))
    assert many > few + 1.5 * len(log)
    mask = ("--mask", "-71:-40,39:70.5")  # the beams that are blocked, by a person who knows them
    masked = run(*words, "--keep-body", *mask)[1]
    assert abs(int(re.findall(r"extracted (\d+)", masked)[0]) - few) < 0.2 * len(log)


def test_a_threshold_has_the_unit_of_its_annotation(run, near, monkeypatch):
    """Catches a unit that is guessed from a name: radians that the command takes in metres."""
    given = []

    @checked
    def strange(map, *, angle: Metres = 0.2, skew: Radians = np.radians(10),
                bend: RadiansPerMetre = 1.0):  # fmt: skip
        """Do something strange.

        Parameters
        ----------
        angle
            Its width.
        skew, bend
            How
            askew.
        """
        given.extend((angle, skew, bend))
        return replace(reduction.fusion(map), doubt="it is strange")

    monkeypatch.setitem(reduction.METHODS, "strange", Method(strange, "here", varies="angle"))
    code, said, _ = run("map", near, "--method", "strange:skew=20,angle=0.3,bend=30")
    assert code == 0 and "            doubt: it is strange" in said.splitlines()
    assert given == [0.3, np.radians(20), np.radians(30)]
    said = run("methods", "strange")[1]
    assert "skew: How askew. Default: 10 degrees.\n" in said
    assert "angle: Its width. Default: 0.2 metres.\n" in said and "57.3 degrees/m" in said


def test_switches_filters_and_thresholds_of_the_extraction(run, near):
    """Catches a tolerance of the extraction and of the method that are one, and a lost switch."""
    log = segmap.read(near)
    for words, made, told in (
        (
            ("--extract", "extract_polylines:tolerance=0.1"),
            segmap.build_map(log, log.truth, tolerance=0.1),
            "extract",
        ),
        (("--filter", "0.5"), segmap.build_map(log, log.truth).filtered(0.5), "of 0.5 m or more"),
        (
            ("--method", "viewing_sector:forget=no"),
            expected(near, "viewing_sector", forget=False),
            "",
        ),
    ):
        method = () if "--method" in words else ("--method", "none")
        code, said, _ = run("map", near, *TRUE, *method, *words, "-o", "it.csv")
        assert code == 0 and told in said
        assert len(readers.read_segments("it.csv")) == len(made)


def test_scans_that_were_not_matched_are_left_out_and_told(run, near):
    """Catches a wall that is drawn where the odometry believes to be, or between few true poses."""
    log = segmap.read(near)
    true = log.truth.copy()
    true[8:] = np.nan
    exports.write_carmen("few.log", log, true)
    code, said, _ = run("map", "few.log", "--align", "ground_truth", "--method", "none")
    assert code == 0 and "8 of 12 scans matched" in said
    assert "4 scans not: no ground truth at its time" in said
    assert f"extracted {len(segmap.build_map(log[:8], log.truth[:8]))} segments" in said
    assert "by pose_graph: 12 of 12 scans" in run("map", "few.log", "--method", "none")[1]


# ------------------------------------------------------------------------------ verdict
@pytest.fixture
def lost(tmp_path):
    """A log of which one scan in sixty saw anything, and that has no odometry."""
    log = segmap.load("room")
    scans = [
        replace(scan, odometry=None, ranges=scan.ranges if k == 0 else np.full(len(scan), np.inf))
        for k, scan in enumerate(log)
    ]
    exports.write_arrays(tmp_path / "lost.npz", segmap.Log("lost", scans))
    return "lost.npz"


@pytest.mark.parametrize(
    "words",
    [
        ("map", "-o", "it.csv"),
        ("map", "--method", "none", "-o", "it.csv"),
        ("occupancy", "-o", "it.npz"),
        ("convert", "--align", "pose_graph", "-o", "it.tum"),
    ],
)
def test_no_map_is_told_and_writes_nothing(run, lost, words):
    """Catches a map of one scan in sixty that replaces yesterday's, and ends with 0."""
    Path(words[-1]).write_text("yesterday's")
    code, said, beside = run(words[0], lost, *words[1:])
    last = said.splitlines()[-1]
    assert code == 3 and last == "  verdict   NOT A MAP: 1 of 61 scans placed" and beside == ""
    assert f"nothing; --force writes {words[-1]} all the same" in said
    assert Path(words[-1]).read_text() == "yesterday's"
    code, said, _ = run(words[0], lost, *words[1:], "--force")
    assert code == 3 and "nothing;" not in said and words[-1] in said
    assert Path(words[-1]).read_bytes() != b"yesterday's"


def test_each_command_says_one_verdict_on_the_same_poses(run, folder, tmp_path, only):
    """Catches a command that judges the poses alone, ends otherwise, keeps the cause for itself, or
    prints a line beside its object."""
    only("fusion", "least_cost")
    shutil.copy(folder / "far.log", tmp_path)
    found = {}
    for command, file in (("map", "csv"), ("compare", "csv"), ("convert", "tum"),
                          ("occupancy", "npz")):  # fmt: skip
        words = (command, "far.log", "--align", "backbone", "-o", f"it.{file}", "--json")
        code, said, beside = run(*words)
        told = json.loads(said)
        found[command] = told["verdict"]
        assert code == 0 and Path(f"it.{file}").exists() and told["log"] == "far"
        assert command != "compare" or set(told["methods"]) == {"fusion", "least_cost"}
        assert beside.splitlines()[-1] == f"segmap: far.log: {found[command]['words']}"
        assert run(*words, "--strict")[0] == 3
    assert found["map"]["grade"] == "doubtful" and found["map"]["doubled"] is not None
    assert found["occupancy"] == found["compare"] == found["convert"] == found["map"]


def test_json_is_an_object_a_log_with_all_that_is_printed(run, folder, lost, tmp_path):
    """Catches text between the objects, a figure that only the text has, and a log left out."""
    shutil.copy(folder / "far.log", tmp_path)
    (tmp_path / "bad.log").write_text("FLASER 3 1.0 2.0\n")
    logs, options = ("far.log", lost, "bad.log"), ("--method", "fusion", "-o", "{name}.csv")
    code, said, beside = run("map", *logs, *options, "--json", "--table", "all.csv")
    found = [json.loads(line) for line in said.splitlines()]
    assert code == 1 and [one["source"] for one in found] == list(logs)
    far, dark, bad = found
    assert far["verdict"]["grade"] == "good" and far["verdict"]["placed"] == SCANS
    assert far["written"]["files"] == ["far.csv"] and 0 < far["quality"]["quality"] < 1
    assert dark["verdict"]["words"] == "NOT A MAP: 1 of 61 scans placed"
    assert dark["aligned"]["notes"] and dark["written"]["files"] == []
    assert bad["failed"] in beside and "verdict" not in bad
    _, plain, _ = run("map", "far.log", *options)
    for line in plain.splitlines()[1:]:
        word, text = line.split(maxsplit=1)
        shown = re.sub(r"[\d.]+ m?s$", "", text)  # but for the time that it took
        assert far[word]["text"].startswith(shown)
    table = pd.read_csv("all.csv")
    assert table["source"].tolist() == list(logs)
    assert table["verdict.grade"].tolist()[:2] == ["good", "not a map"]
    assert table["reduced.segments"][0] == far["reduced"]["segments"]


def test_locate_finds_a_log_on_a_map_of_either_kind(run, folder):
    """Catches a map read as the other kind, a robot called found elsewhere, and a wrong code."""
    log = segmap.load("room")
    segmap.quadtree.build_map(log, log.truth, resolution=0.05).save("squares.npz")
    exports.write_segments("walls.csv", segmap.build_map(log, log.truth).filtered(0.3))
    exports.write_segments("walls.npz", segmap.build_map(log, log.truth).filtered(0.3))
    for map in ("squares.npz", "walls.csv", "walls.npz"):
        code, said, _ = run("locate", map, "room", "--json")
        place, verdict = json.loads(said)["place"], json.loads(said)["verdict"]
        assert code == 0 and verdict["reason"] == "", said
        assert np.hypot(place["x"] - log.truth[-1, 0], place["y"] - log.truth[-1, 1]) < 0.1
    code, said, _ = run("locate", "squares.npz", folder / "near.log")
    assert code == 3 and f"found     0 of {SCANS} scans; lost at" in said
    feet = logs.changed(log, odometry=log.odometry / (0.3048, 0.3048, 1))
    exports.write_arrays("feet.npz", feet)
    code, said, _ = run("locate", "squares.npz", "feet.npz")
    assert code == 0 and "prepared  the odometry is in feet: converted" in said
    code, _, error = run("locate", "none.npz", "room")
    assert code == 1 and "none.npz" in error


def test_a_map_for_ros_is_a_map_and_no_log(run):
    """Catches our own map that we cannot read, one that is merged, and a log in a map's place."""
    log = segmap.load("room")
    map = segmap.quadtree.build_map(log, log.truth, resolution=0.05)
    files.write_ros_map("it.yaml", map)
    code, said, _ = run("locate", "it.yaml", "room", "--json")
    found = json.loads(said)
    assert code == 0 and "the rest unknown" in found["map"]["text"]
    place = np.array([found["place"]["x"], found["place"]["y"]])
    assert np.hypot(*(place - log.truth[-1, :2])) < 0.1
    for words in (("merge", "it.yaml", "room"), ("merge", "room", "it.yaml"), ("map", "it.yaml")):
        code, said, beside = run(*words)
        assert code == 2 and said == "" and "`segmap locate it.yaml LOG` finds" in beside
    for words, told in (
        (("locate", "room", "room"), "room is no map, `segmap occupancy LOG"),
        (("locate", "it.pgm", "room"), "it.pgm is a picture: name the .yaml"),
        (("convert", "it.yaml", "-o", "it.log"), "it.yaml is a map for ROS and no log"),
    ):
        code, _, beside = run(*words)
        assert code == 2 and told in beside


# ------------------------------------------------------------------------------ usage
@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("map --method fusion:sigma=1", "fusion has no sigma; it has tolerance"),
        ("map -o it.pdf", "'it.pdf' must end in one of .svg, .csv"),
        ("map --align magic", "--align: 'magic' is none of odometry, ground_truth"),
        ("map --penlty 1", "Unknown option: --penlty."),
        ("map --method hybrid:angle=400", "angle must be a number above 0 and of at most 90"),
        ("map --filter nan", "--filter: it must be"),
        ("map --seen-through 1.5", "--seen-through: it must be"),
        ("map far.log -o it.svg", "2 logs would go to it.svg: write {name} in it"),
        ("convert", "name the file to write: -o FILE"),
        ("convert -o it.g2o", "a .g2o holds a pose graph: add --align pose_graph"),
        ("compare --quality 100.5", "at most 100, in per cent, got 100.5"),
        ("map --strict 90", "90 must be from 0 to 1"),
        ("map --place 52 13 -o it.dxf", "--place is for a .geojson"),
        ("map --crop 0 0 -1 2", "wanted left < right and low < high"),
        ("map --mask 30", "--mask"),
        ("map --north 30", "north and a grid need a place"),
        ("map --place 45.46 9.19 --crs EPSG:25832 -o it.geojson", "looks like degrees"),
        ("map --workers two", "must be a number, or like tcp://"),
    ],
)
def test_what_is_not_understood_is_said_before_anything_is_done(run, near, words, said):
    """Catches usage errors that end as 1, or after a minute of work."""
    command, *options = words.split()
    code, out, beside = run(command, near, *options)
    assert code == 2 and out == "" and said in " ".join(beside.split())
    assert beside.startswith("segmap: ") and "usage" not in beside and beside.count("\n") <= 2


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("nowhere.log",), "nowhere.log: does not exist, expected a log file or a folder"),
        (("malagga",), "malagga: is neither a file nor a folder"),
        (("nowhere.log", "-o", "no/where.svg"), "cannot write no/where.svg: the folder "),
        (("nowhere.log", "-o", "folder.svg"), "folder.svg is a folder"),
        (("near.log", "--tie", "3-99"), "--tie 3-99: the log has scans 0 to 11"),
    ],
)
def test_faults_are_one_line_and_1_or_2(run, near, tmp_path, words, said):
    """Catches a traceback, and a fault that is found after the work."""
    shutil.copy(near, tmp_path)
    (tmp_path / "folder.svg").mkdir()
    code, out, beside = run("map", *words)
    assert code == (2 if "-o" in words else 1)  # a file that cannot be written is asked for
    assert beside.startswith("segmap: ") and beside.count("\n") == 1
    assert said in beside and ("written" not in out)
    assert "aligned" not in out


# ------------------------------------------------------------------------------ kept options
CHOICE = "--method", "hybrid:angle=20", "--extract", "extract_polylines:gap=0.2"
CROP = "--square", "--crop", "-2", "-30", "20.5", "30"


def test_a_session_repeats_its_map(run, near):
    """Catches an option that is lost on the way, another unit, and a log that is changed by it."""
    code, *_ = run("map", near, *CHOICE, *CROP, "-o", "it.csv", "-o", "it.segmap")
    assert code == 0
    session = files.read_session("it.segmap")
    assert session.settings == {
        "align": "pose_graph",
        "method": "hybrid",
        "angle": 20.0,
        "extract_gap": 0.2,
    }
    assert session.edits == {"square": True, "crop": [-2.0, -30.0, 20.5, 30.0]}
    code, said, _ = run("map", "it.segmap", "-o", "again.csv", "--json")
    assert code == 0 and Path("again.csv").read_bytes() == Path("it.csv").read_bytes()
    before, after = session.runs[0], json.loads(said)
    assert {k: after[k] for k in ("extracted", "cropped", "quality")} == {
        k: before[k] for k in ("extracted", "cropped", "quality")
    }
    # what is said on the command wins, and thresholds of the method before are no fault then
    code, said, _ = run("map", "it.segmap", "--method", "fusion", "--json")
    told = json.loads(said)
    assert code == 0 and told["reduced"]["method"] == "fusion"
    assert told["aligned"]["method"] == "pose_graph"
    code, said, _ = run("map", "it.segmap", "--method", "hybrid:angle=3", "--json")
    assert code == 0 and json.loads(said)["reduced"]["segments"] != before["reduced"]["segments"]
    code, said, _ = run("occupancy", "it.segmap")
    assert code == 0 and "its method, extract left out: no option" in said
    assert "turned " in said and "cropped " in said


def test_a_session_whose_options_are_damaged_leaves_the_others(run):
    """Catches a night's work that ends at one session, and empty lists that are no options."""
    log = segmap.load("room")[:4]
    for name, options in (("bad", {"filter": "wide"}), ("good", {"mask": []})):
        files.write_session(f"{name}.segmap", files.Session(log, options, edits={"veto": []}))
    code, said, beside = run("map", "bad.segmap", "good.segmap", "--method", "none")
    assert code == 1 and said.splitlines()[-1] == "1 of 2 logs done"
    assert "bad.segmap: --filter: Invalid value" in beside


def test_options_in_a_file_are_those_of_the_command(run, near):
    """Catches another unit than the option's, a file that wins, and an output in two places."""
    Path("map.toml").write_text(
        'method = "hybrid:angle=20"\nextract = "extract_polylines:gap=0.2"\nsquare = true\n'
        'crop = [-2, -30.0, 20.5, 30]\noutput = ["a.csv"]\njson = true\nskip = false\n'
    )
    run("map", near, *CHOICE, *CROP, "-o", "it.csv")
    code, said, _ = run("map", near, "--config", "map.toml")
    assert code == 0 and json.loads(said)["written"]["files"] == ["a.csv"]
    assert Path("a.csv").read_bytes() == Path("it.csv").read_bytes()
    Path("a.csv").unlink()
    code, said, _ = run("map", near, "--config", "map.toml", "--method", "fusion", "-o", "b.csv")
    assert json.loads(said)["reduced"]["segments"] != len(readers.read_segments("it.csv"))
    assert not Path("a.csv").exists() and Path("b.csv").exists()


def test_a_job_takes_no_workers_from_the_file_that_gave_them(run, near, monkeypatch):
    """Catches jobs that start workers of their own, and these again, without an end."""
    Path("all.toml").write_text('workers = "2"\ntable = "all.csv"\noutput = ["it.csv"]\n')
    jobs = []

    def start(command, env, **_):
        jobs.append((command[3:], env))
        return subprocess.CompletedProcess(command, 0, "{}", "")

    with monkeypatch.context() as patch:
        patch.setattr(subprocess, "run", start)
        assert run("map", near, "--config", "all.toml")[0] == 0
        ((words, env),) = jobs
        for name, value in env.items():
            patch.setenv(name, value)
        Path("all.csv").unlink()
        assert run(*words)[0] == 0 and len(jobs) == 1
    assert Path("it.csv").exists() and not Path("all.csv").exists()


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        ("tolerence = 0.05", 2, 'Unknown option: "[tolerence]" from map.toml'),
        (
            'filter = "wide"',
            2,
            "--filter: Invalid value for [filter]: could not convert string",
        ),
        ("crop = [1, 2]", 2, "--crop: Incorrect number of arguments: expected 4 but got 2"),
        ("method = fusion", 1, "map.toml: Invalid value (at line 1, column 10)"),
        (None, 1, "map.toml: does not exist, expected a file"),
    ],
)
def test_a_file_of_options_that_is_not_understood(run, near, text, code, said):
    """Catches a slip in a file that changes nothing and is not told."""
    if text is not None:
        Path("map.toml").write_text(text)
    found, out, beside = run("map", near, "--config", "map.toml")
    assert found == code and out == "" and said in beside and beside.count("\n") <= 2


# ------------------------------------------------------------------------------ several logs
def test_a_failed_log_is_told_at_the_end_and_the_others_are_done(run, folder, tmp_path):
    """Catches a bad log that stops the night's work, or that nobody hears of."""
    for path in folder.iterdir():
        shutil.copy(path, tmp_path)
    (tmp_path / "bad.log").write_text("FLASER 3 1.0 2.0\n")
    (tmp_path / "README.md").write_text("FLASER 3 1.0 2.0\n")
    (tmp_path / ".hidden.log").write_text("FLASER 3 1.0 2.0\n")
    (tmp_path / "deep" / "down").mkdir(parents=True)
    (tmp_path / "far.log").rename(tmp_path / "deep" / "down" / "far.log")
    (tmp_path / "deep" / "back").symlink_to(tmp_path)
    (tmp_path / "maps").mkdir()
    code, said, beside = run("map", ".", *TRUE, "--method", "fusion", "-o", "maps/{name}.csv")
    assert code == 1 and said.splitlines()[-1] == "2 of 3 logs done"
    assert {path.name for path in Path("maps").iterdir()} == {"near.csv", "far.csv"}
    first, near, last = beside.splitlines()
    assert first == "segmap: .: left out, since no log: README.md, deep/back"
    assert near.startswith("segmap: near.log: NOT CHECKED: one look; nothing confirms it")
    assert last.startswith("segmap: bad.log, line 1: ")
    wanted = expected("deep/down/far.log", "fusion")
    assert np.array_equal(readers.read_segments("maps/far.csv").segments, wanted.segments)


def test_a_name_from_outside_moves_no_cursor(run, near, tmp_path):
    """Catches names of files that clear the screen, or that pass for lines of their own."""
    (tmp_path / "logs").mkdir()
    good = "good\x1b[2J\n2 of 2 logs done\udc80.log"
    for name in (good, "bad\x1b]0;it\x07\n.log", "no\x9b2J\n"):
        text = Path(near).read_text() if name == good else "FLASER 3 1.0\x1b[2J 2.0\n"
        (tmp_path / "logs" / name).write_text(text[: 20 if name == "no\x9b2J\n" else None])
    for words in (
        ("map", "logs", "--method", "fusion", "-o", "{name}.csv"),
        ("info", "logs"),
        ("info", "logs/bad\x1b]0;it\x07\n.log", "logs/no\x9b2J\n/\x1b"),
        ("map", "logs", "-o", "no\x1b/\n/{name}.csv"),
        ("info", "--no\x1b[2J\n"),
    ):
        code, *said = run(*words)
        assert code in (1, 2) and all(c.isprintable() or c == "\n" for c in "".join(said))
        assert "\n2 of 2" not in "".join(said)
    with pytest.raises(readers.LogError, match=r"^no\\x1b\\n: does not exist"):
        readers.read("no\x1b\n")


def test_logs_do_not_replace_each_other(run, near, tmp_path):
    """Catches a second run.log whose map overwrites the first, and a log gone by a slip of -o."""
    for name, log in (("a", near), ("b", Path(near).with_name("far.log"))):
        (tmp_path / name).mkdir()
        shutil.copy(log, f"{name}/run.log")
    words = ("a/run.log", "b/run.log", "--method", "fusion", "-o", "{name}.csv")
    code, said, beside = run("map", *TRUE, *words)
    assert code == 1 and "1 of 2 logs done" in said
    assert "b/run.log: run.csv was written for a/run.log" in beside
    assert len(readers.read_segments("run.csv")) == len(expected(near, "fusion"))
    before = Path("a/run.log").read_bytes()
    code, _, beside = run("convert", "a/run.log", "-o", "./a/{name}.log")
    assert code == 1 and "it is the log itself" in beside
    assert Path("a/run.log").read_bytes() == before


def test_control_c_ends_with_130_and_leaves_nothing_half_written(run, near, monkeypatch):
    """Catches a traceback, an exit code of 1, and the rest of the logs that goes on."""
    calls = []

    def stop(*given, **named):
        calls.append(given)
        raise KeyboardInterrupt

    monkeypatch.setattr(exports, "write_segments", stop)
    code, said, beside = run("map", near, near, "--method", "fusion", "-o", "{name}.csv")
    assert code == 130 and beside == "segmap: stopped\n" and len(calls) == 1
    assert list(Path().iterdir()) == [] and "written" not in said


#: A method that does not hear of Control-C for hours.
LOOP = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
from importlib import import_module
from hashlib import pbkdf2_hmac
from segmap import reduction
def forever(map):
    print("begun", flush=True)
    pbkdf2_hmac("sha256", b"", b"", 2**31 - 1)
object.__setattr__(reduction.METHODS["hybrid"], "function", forever)
sys.exit(import_module("segmap.__main__").main(["map", "room", "--method", "hybrid"]))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Control-C goes to all of a console there")
def test_control_c_ends_a_loop_that_does_not_hear_it():
    command = [sys.executable, "-c", LOOP]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, **pipes) as process:
        assert "begun\n" in iter(process.stdout.readline, "")
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=60)[1] == "segmap: stopped\n"
    assert process.returncode == 130


def test_a_log_without_anything(run, tmp_path):
    """Catches statistics of no number, and a warning with the path and a line of a source file."""
    (tmp_path / "dark.txt").write_text(DARK)
    code, said, beside = run("info", "dark.txt")
    assert code == 0 and beside == ""
    assert "none is valid" in said and "1 scan, without times" in said
    assert said.count("none\n") == 2
    code, said, beside = run("map", "dark.txt", "--align", "odometry", "--method", "fusion")
    assert code == 3 and "extracted 0 segments" in said and ".py" not in beside
    assert beside.startswith("warning: the map of log 'dark' is empty")


# ------------------------------------------------------------------------------ occupancy
def test_occupancy_is_written_for_everybody(run, near):
    """Catches a quadtree of another resolution, and a YAML without its picture."""
    names = [f"it.{suffix}" for suffix in ("yaml", "npz", "svg", "geojson", "png")]
    outputs = [word for name in names for word in ("-o", name)]
    code, said, _ = run("occupancy", near, "--resolution", "0.2", "--json", *outputs)
    map, told = QuadtreeMap.load("it.npz"), json.loads(said)
    assert code == 0 and told["written"]["files"][:3] == ["it.yaml", "it.pgm", "it.npz"]
    assert map.scans == SCANS and map.resolution == 0.2
    features = json.loads(Path("it.geojson").read_text())["features"]
    rings = np.array([each["geometry"]["coordinates"][0] for each in features])
    area, (left, low, right, high) = (np.ptp(rings, axis=1)[:, 0] ** 2).sum(), extent(map, margin=0)
    assert told["mapped"]["occupied"] == pytest.approx(area)
    assert told["mapped"]["width"] == pytest.approx(right - left)
    assert f"by {high - low:.1f} m at 0.2 m: {area:.2f} m2 occupied" in told["mapped"]["text"]
    assert 'image: "it.pgm"' in Path("it.yaml").read_text()
    assert Path("it.pgm").read_bytes()[:2] == b"P5" and Path("it.png").read_bytes()[:4] == PNG
    assert np.ptp(plt.imread("it.png")[..., :3], axis=-1).max() == 0  # grey: no blue outlines


# ------------------------------------------------------------------------------ where it lies
def test_a_map_is_turned_rid_of_people_cropped_filtered_and_placed_in_that_order(run, near):
    """Catches a turn to the other side, one that only one of two maps has, people who stay, a crop
    of the filtered map, space that stays free outside, north in radians, an empty map in silence.
    """
    log, world = segmap.read(near), files.Earth(36.7, -4.4, np.radians(60))
    turn = -segmap.segments.main_direction(segmap.build_map(log, log.truth))
    at = poses.compose((0.0, 0.0, turn), log.truth)
    seen = segmap.quadtree.without_passers(log, at, seen_through=0.3)
    whole = segmap.build_map(seen, at)
    corners = np.quantile(whole.segments.reshape(-1, 2), (0.2, 0.8), axis=0).round(1).ravel()
    options = *TRUE, "--square", "--place", "36.7", "-4.4", "--north", "60", "--json", "--crop"
    words = *options, *corners, "--method", "none", "--filter", "0.3", "--seen-through", "0.3"
    code, said, _ = run("map", near, *words, "-o", "it.csv", "-o", "it.geojson")
    assert code == 0 and json.loads(said)["turned"]["degrees"] == pytest.approx(np.degrees(turn))
    wanted = whole.cropped(*corners).filtered(0.3)
    assert 0 < len(wanted) < len(whole.cropped(*corners)) < len(whole)
    with_people = segmap.build_map(log, at).cropped(*corners).filtered(0.3)
    assert not np.array_equal(wanted.segments, with_people.segments)
    read = readers.read_segments("it.csv").segments
    np.testing.assert_allclose(read, wanted.segments, atol=1e-9)
    exports.write_segments("wanted.geojson", wanted, world=world)
    assert Path("it.geojson").read_bytes() == Path("wanted.geojson").read_bytes()

    words = *options, *corners, "--resolution", "0.2", "-o", "it.npz", "-o", "it.geojson"
    code, said, _ = run("occupancy", near, *words)
    squares = segmap.quadtree.build_map(log, at, resolution=0.2).cropped(*corners)
    hits = int((squares.leaves().occ > 0).sum())
    assert code == 0 and json.loads(said)["cropped"]["squares"] == hits > 0
    for one, other in zip(QuadtreeMap.load("it.npz").leaves(), squares.leaves(), strict=True):
        np.testing.assert_array_equal(one, other)
    exports.write_geojson("wanted.geojson", squares, world=world)
    assert Path("it.geojson").read_bytes() == Path("wanted.geojson").read_bytes()
    for command, what in (("map", "segment"), ("occupancy", "square")):
        code, _, beside = run(command, near, *TRUE, "--crop", 900, 0, 901, 1)
        assert code == 1 and f"crop: no {what} lies in that rectangle; the map reaches" in beside


def test_map_lists_its_loops_and_leaves_out_those_that_a_file_vetoes(run):
    """Catches a loop taken by its row in another list, and a veto that changes nothing."""
    code, out, _ = run("map", "corridor", "--loops", "loops.csv")
    whole = pd.read_csv("loops.csv")
    assert code == 0 and "written to loops.csv" in out
    pd.testing.assert_frame_equal(
        whole, alignment.pose_graph(segmap.load("corridor")).loops().reset_index()
    )
    worst = whole.sort_values("residual").tail(2)
    worst.to_csv("bad.csv", index=False)
    run("map", "corridor", "--veto", "bad.csv", "--loops", "rest.csv")
    rest = pd.read_csv("rest.csv")
    ends = ["first", "second"]
    assert rest[ends].values.tolist() == whole.drop(worst.index)[ends].values.tolist()
    # A session keeps what was vetoed; one loop has no file
    one = "-".join(map(str, worst[ends].values[0]))
    run("map", "corridor", "--veto", one, "--loops", "one.csv", "-o", "it.segmap")
    run("map", "it.segmap", "--loops", "again.csv")
    assert len(pd.read_csv("again.csv")) == len(whole) - 1
    # A loop is forced, and kept as well
    code, out, _ = run(
        "map", "corridor", "--tie", "5-151", "--loops", "tied.csv", "-o", "it.segmap"
    )
    assert code == 0 and "5 loops closed" in out
    assert [5, 151] in pd.read_csv("tied.csv")[ends].values.tolist()
    assert files.read_session("it.segmap").edits == {"tie": ["5-151"]}
    code, _, beside = run("map", "corridor", "--tie", "0-54")
    assert code == 1 and "tie: scan 54 is not placed by 0: the two places look different" in beside
    for text, wrong, words in (
        ("first,second\n0,3\n", 1, "veto: no loop was closed between scans 0-3"),
        ("first\n0\n", 2, "bad.csv must be a table with columns first and second"),
    ):
        Path("bad.csv").write_text(text)
        code, _, beside = run("map", "corridor", "--veto", "bad.csv")
        assert code == wrong and words in beside


# ------------------------------------------------------------------------------ merge
def test_sessions_of_one_building_are_merged_and_the_next_comes_to_them(run, near):
    """Catches a map in the frame of the second, a session of another map, and a last one."""
    log, world = segmap.load("room"), (30.0, -20.0, 2.0)
    parts = {"one": log[:30], "two": log[20:50], "three": log[35:]}
    for name, part in parts.items():
        scans = [replace(s, odometry=poses.compose(world, s.odometry)) for s in part]
        exports.write_arrays(
            f"{name}.npz", segmap.Log(name, part.scans if name == "one" else scans)
        )
    words = "--method", "none", "--square", "--json", "-o"
    code, said, _ = run("merge", "one.npz", "two.npz", *words, "it.csv", "-o", "it.segmap",
                        "--loops", "loops.csv")  # fmt: skip
    one, two = segmap.read("one.npz"), segmap.read("two.npz")
    found, told = segmap.matching.merge(one, two), json.loads(said)
    turn = np.radians(told["turned"]["degrees"])
    at = poses.compose((0, 0, turn), found.trusted)
    both = segmap.Log("both", [*one, *two])
    assert code == 0 and told["aligned"]["matched"] == 60 == told["verdict"]["placed"]
    walls = segmap.build_map(both, at).segments
    assert np.array_equal(readers.read_segments("it.csv").segments, walls)
    assert len(pd.read_csv("loops.csv")) == told["aligned"]["loops"] > 5
    assert run("map", "it.segmap", "-o", "again.csv")[0] == 0
    assert Path("again.csv").read_bytes() == Path("it.csv").read_bytes()
    code, said, _ = run("merge", "it.segmap", "three.npz", "--method", "none", "-o", "all.segmap")
    whole = files.read_session("all.segmap")
    true = np.vstack([part.truth for part in parts.values()])
    off = poses.between(whole.log.truth[0], whole.log.truth) - poses.between(true[0], true)
    assert code == 0 and "86 of 86 scans matched" in said and np.abs(off[:, :2]).max() < 0.1
    code, said, _ = run("merge", "one.npz", near, "--method", "none", "-o", "no.csv", "--force")
    assert code == 3 and not Path("no.csv").exists()
    assert "  verdict   NOT A MAP: the sessions are not merged: only 0 places" in said
    for first, words in (
        ("none.npz", "none.npz: does not exist"),
        ("it.segmap", "cannot write it.segmap: it is the first log itself"),
    ):
        code, _, beside = run("merge", first, near, "-o", "it.segmap")
        assert code == 1 and words in beside


def test_each_of_the_two_is_prepared_once_and_nothing_that_is_known_of_it_is_lost(run):
    """Logs of a laser that hangs upside down, one of them with a scan that saw nothing.

    Catches scans that are merged or kept as they were before, or put right twice; findings and
    what was assumed of one of the two that nobody tells; a place for a scan that has none.
    """
    log = segmap.load("room")
    for name, part in (("one", log[:16]), ("two", log[8:24])):
        scans = [replace(scan, angles=-scan.angles) for scan in part]
        if name == "two":
            scans[-1] = replace(scans[-1], ranges=np.full(len(scans[-1]), np.inf))
        told = Finding(Cause.OTHER, 1.0, f"the floor of {name} was wet", "", True)
        sayings = {"causes": [told], "assumed": [f"{name} is dry"]}
        held = segmap.Log(name, scans, **sayings)
        files.write_session(f"{name}.segmap", files.Session(held, {}))
    code, said, _ = run("merge", "one.segmap", "two.segmap", "--clockwise", "--method", "none",
                        "-o", "it.segmap", "-o", "it.csv", "--force")  # fmt: skip
    assert code in (0, 3), said
    for name in ("one", "two"):
        assert f"the floor of {name} was wet" in said
    found = files.read_session("it.segmap")
    upright = [*log[:16], *log[8:24]]
    for k, (scan, true) in enumerate(zip(found.log, upright, strict=True)):
        assert k == 31 or np.allclose(scan.points(), true.points(), atol=1e-6), k
    placed = np.isfinite(found.log.truth).all(1)
    assert np.flatnonzero(~placed).tolist() == [31]
    assert "clockwise" not in found.settings
    assert set(found.log.assumed) == {"one is dry", "two is dry"}
    code, _, beside = run("merge", str(Path("one.segmap").resolve()), "two.segmap",
                          "-o", "./one.segmap")  # fmt: skip
    assert code == 1 and "it is the first log itself" in beside


# ------------------------------------------------------------------------------ compare
def test_methods_are_compared_at_one_quality(run, near, only):
    """Catches a method that is missing, a column that is not that of the quality asked for."""
    only(*(methods := ("fuzzy_set", "hybrid", "fusion")))
    exports.write_carmen("short.log", segmap.read(near)[:3])
    code, said, _ = run("compare", "short.log", "--quality", "90", "-o", "it.png", "-o", "it.csv")
    assert code == 0 and "at quality 90.0 %" in said and "(--all" not in said
    assert "  written   it.png, it.csv\n" in said
    runs = segmap.experiments.read_records("it.csv")
    assert set(runs["method"]) == set(methods) and Path("it.png").read_bytes()[:4] == PNG
    table = said[said.index("at quality") :]
    shown = re.findall(r"^  (\w+) +(?:(\d+\.\d) %|not reached) +(\d+|-) ", table, re.MULTILINE)
    assert {name for name, *_ in shown} == set(methods)
    gone = [float(share) for _, share, _ in shown if share]
    assert gone == sorted(gone, reverse=True) and len(gone) >= 2
    at = segmap.experiments.equal_quality(runs, 0.9).iloc[0]
    best, share, left = shown[0]
    assert float(share) == round(100 * at[best], 1)
    assert int(left) == round((1 - at[best]) * runs["n_before"].iloc[0])


# ------------------------------------------------------------------------------ convert
def test_convert_keeps_what_the_log_holds(run, near):
    """Catches poses that are lost on the way, a path with other poses, a graph as a log."""
    code, said, _ = run("convert", near, "-o", "it.log.gz", "-o", "it.tum")
    assert code == 0 and "12 with a corrected pose" in said and "12 poses by ground truth" in said
    before, after = segmap.read(near), segmap.read("it.log.gz")
    assert np.allclose(after.truth, before.truth, atol=1e-5)
    assert np.allclose(after[3].ranges, before[3].ranges, atol=1e-6)
    assert np.allclose(np.loadtxt("it.tum")[:, 1:3], before.truth[:, :2], atol=1e-5)
    far = str(Path(near).with_name("far.log"))
    outputs = "-o", "it.tum", "-o", "it.g2o", "-o", "it.npz"
    code, said, _ = run("convert", far, "--align", "pose_graph", *outputs)
    graph = files.read_graph("it.g2o")
    assert np.allclose(segmap.read("it.npz").truth, graph.poses, atol=1e-5)
    assert code == 0 and "12 poses by pose_graph" in said and f"{len(graph.edges)} edges" in said
    assert np.allclose(np.loadtxt("it.tum")[:, 1:3], graph.poses[:, :2], atol=1e-5)


# ------------------------------------------------------------------------------ notebooks
def broken_links(folder):
    texts = {path: json.loads(path.read_bytes()) for path in folder.glob("*.ipynb")}
    wanted = [(path, link) for path, text in texts.items() for link in links(markdown(text))]
    return [link for path, link in wanted if not (path.parent / link).exists()]


@pytest.fixture
def clone(tmp_path, monkeypatch):
    """A clone with two chapters, a picture and the data that one of them links to."""
    for name in ("notebooks/pictures/b", "data"):
        (tmp_path / "clone" / name).mkdir(parents=True)
    source = tmp_path / "clone" / "notebooks"
    (source / "pictures" / "b" / "a.png").write_bytes(PNG)
    said = "[data](../data/README.md), [next](11_next.ipynb#top), ![a](pictures/b/a.png) \U0001f600"
    cells = [{"cell_type": "markdown", "source": [said]}]
    for name in ("01_start_here", "11_next"):
        (source / f"{name}.ipynb").write_text(json.dumps({"cells": cells}), encoding="utf-8")
    (tmp_path / "clone" / "data" / "README.md").write_text("data")
    monkeypatch.setattr("segmap.files.__file__", str(source.parent / "segmap" / "files.py"))
    monkeypatch.setenv("JUPYTER_DATA_DIR", str(tmp_path / "jupyter"))
    return source


def as_jupyter_saves(path):
    """A chapter that was opened, run to its end and saved."""
    notebook = json.loads(path.read_bytes())
    notebook["metadata"] = {"language_info": {"version": "3.99"}}
    empty = {"cell_type": "code", "metadata": {}, "outputs": [], "source": []}
    notebook["cells"] = [c | {"id": f"{k}"} for k, c in enumerate(notebook["cells"])] + [empty]
    path.write_text(json.dumps(notebook, indent=3))


def test_a_chapter_that_was_only_opened_is_not_a_changed_one(run, clone):
    """Catches outputs that are lost by each `make lab`, and a newer original that is not told."""
    work, chapter = clone.parent / "new" / "work", clone / "01_start_here.ipynb"
    _, said, _ = run("notebooks", work)
    assert Path(re.search(r"jupyter lab (\S+)", said)[1]) == work / chapter.name
    assert broken_links(work) == []
    as_jupyter_saves(copy := work / chapter.name)
    opened = copy.read_bytes()
    _, said, _ = run("notebooks", work)
    assert "2 chapters there already" in said and "differ" not in said
    chapter.write_text(chapter.read_text().replace("next", "onward"))
    _, said, _ = run("notebooks", work)
    assert f"since yours differ: {chapter.name}\n" in said and copy.read_bytes() == opened
    copy.unlink()
    (work / "11_next.ipynb").write_text("my answers")
    _, said, _ = run("notebooks", work)
    assert "1 chapter copied" in said and "onward" in copy.read_text()
    assert (work / "11_next.ipynb").read_text() == "my answers"


def test_jupyter_trusts_what_is_ours_and_nothing_else(run, clone):
    """Catches panels that stay hidden until a student trusts them, and trust for what came in."""
    sign, work = pytest.importorskip("nbformat.sign"), clone.parent / "new" / "work"

    def trusted():
        notary = sign.NotebookNotary()
        read = (nbformat.read(path, as_version=4) for path in sorted(work.glob("*.ipynb")))
        return [notary.check_signature(notebook) for notebook in read]

    for path in clone.glob("*.ipynb"):
        shutil.copy(ROOT / "notebooks" / "17_fusion.ipynb", path)
    run("notebooks", work)
    assert trusted() == [True, True]
    first = work / "01_start_here.ipynb"
    # without its kernel Lab shows the picture of a panel only where no widget is stored
    assert "widget-view" not in (text := first.read_text()) and text.count('"image/png"') > 8
    run("notebooks", clone)
    assert "widget-view" in (clone / first.name).read_text()
    first.write_text(first.read_text().replace("</", "<script></"))
    run("notebooks", work)
    assert trusted() == [False, True]


# ------------------------------------------------------------------------------ the program


def test_the_program_is_light_and_ends_with_the_code_of_the_command(near, tmp_path):
    """Catches numba that is loaded to say what a log is, and a script that overlooks a fault."""
    command = [sys.executable, "-X", "importtime", "-m", "segmap", "info", near, "gone.log"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1 and "12 scans" in done.stdout
    assert done.stdout.endswith("1 of 2 logs done\n")
    assert "segmap: gone.log: does not exist" in done.stderr and "Traceback" not in done.stderr
    loaded = set(re.findall(r"\| +([\w.]+)$", done.stderr, re.MULTILINE))
    assert "segmap.readers" in loaded
    assert loaded & {"numba", "matplotlib", "pandas", "ipywidgets"} == set()
