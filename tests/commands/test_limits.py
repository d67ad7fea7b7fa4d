"""Commands on results made by hand: what they say to the letter, and what they do at each limit."""

import io
import json
import os
import re
import subprocess
import sys
from argparse import Namespace
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import tqdm

import segmap
from segmap import alignment, experiments, exports, quadtree, readers, reduction
from segmap._commands import _compare, _locate, _occupancy, log_options, main
from segmap._commands._output import Report, metres, progress, seconds
from segmap._map_pipeline import cropped
from segmap.alignment import Alignment, Verdict
from segmap.matching import Belief, Uncertainty
from segmap.scans.causes import Cause, Finding

WALL = [[(0.0, 0.0), (10.0, 0.0)]]


# ------------------------------------------------------------------------------- words
def test_units_change_at_a_tenth():
    """Catches 0.0 s for 80 ms, and -250 mm for a quarter of a metre."""
    said = [metres(v) for v in (0.0994, 0.1, 0.12, -0.05, -0.25)]
    assert said == ["99.4 mm", "0.10 m", "0.12 m", "-50.0 mm", "-0.25 m"]
    assert [seconds(v) for v in (0.094, 0.1, 0.12)] == ["94 ms", "0.1 s", "0.1 s"]


def test_a_bar_of_one_step_is_none(monkeypatch):
    """Catches a bar that is there for one log alone, and one in a file that nobody looks at."""
    for screen, shown in ((io.StringIO(), []), (Terminal(), [2, 3])):
        monkeypatch.setattr(sys, "stderr", screen)
        assert [n for n in (1, 2, 3) if not progress(n, "log").disable] == shown


@pytest.mark.parametrize(
    ("words", "bars"),
    [
        (("compare", "it.log"), {"method": (2, 2, "hybrid")}),
        (("info", "it.log", "it.log"), {"log": (2, 2, "it.log: ")}),
    ],
)
def test_a_bar_grows_to_its_end(run, monkeypatch, words, bars):
    """Catches a bar that stays at nothing while the work goes on, or says no name."""
    exports.write_carmen("it.log", segmap.load("room")[:4])
    few = {name: reduction.METHODS[name] for name in ("fusion", "hybrid")}
    monkeypatch.setattr(_compare, "METHODS", few)
    found = {}

    def close(bar):
        if not bar.disable:
            found[bar.unit] = bar.n, bar.total, bar.postfix or bar.desc

    monkeypatch.setattr("tqdm.tqdm.close", close)
    monkeypatch.setattr(sys, "stderr", Terminal())
    run(*words)
    found.pop("it", None)  # the bar of what is done within a step
    assert found == bars


class Terminal(io.StringIO):
    def isatty(self):
        return True


class AtOnce(tqdm.tqdm):
    def __init__(self, *work, **given):
        super().__init__(*work, **given | {"delay": 0, "mininterval": 0})


@pytest.mark.parametrize(
    "words",
    [
        ("map", "room", "--align", "pose_graph", "-o", "it.PNG"),
        ("occupancy", "room", "--matcher", "hill-climbing"),
        ("locate", "it.npz", "room"),
        ("merge", "room", "room", "--method", "none"),
    ],
)
def test_long_work_moves_a_bar_on_a_terminal(run, monkeypatch, words):
    """Catches a bar that stands still for the whole alignment, one that stays, and two at once."""
    log = segmap.load("room")
    quadtree.build_map(log, log.truth, resolution=0.05).save("it.npz")
    monkeypatch.setattr(sys, "stderr", screen := Terminal())
    monkeypatch.setattr("tqdm.std.tqdm.monitor_interval", 0)
    monkeypatch.setattr("tqdm.tqdm", AtOnce)
    monkeypatch.setattr("segmap.progress.FIRST_ESTIMATE_S", 0.0)
    assert run(*words)[0] == 0
    scans = [int(k) for k in re.findall(r"placing scan (\d+) of 61 \|", screen.getvalue())]
    order = list(dict.fromkeys(scans))
    assert len(order) > 3 and order == sorted(order)
    shown = screen.getvalue().split("segmap: room: ")[0]  # the verdict of --matcher follows
    assert "/3" not in shown and "\n" not in shown
    assert re.search(r"\| \d+ s left", screen.getvalue())
    early = re.findall(r"placing scan [123] of 61 \|[^|\r]*\| ([^\r]*left)", screen.getvalue())
    assert early == [], "of 61 scans these are less than 5 %"
    assert screen.getvalue().endswith(" \r")


# ---------------------------------------------------------------------- logs, verdicts
SLIPPED = Finding(Cause.OTHER, 1, "it slipped")


def test_an_alignment_is_told_with_its_commonest_reasons_first(run, monkeypatch):
    """Catches a list of reasons as long as the log, the rare ones, and a doubt that is kept."""
    reasons = ("late", *["dark"] * 4, *["far"] * 3, *["turning"] * 2, "")
    used = np.array([not reason for reason in reasons])
    found = Alignment(np.zeros((11, 3)), used, 0.04, "odometry", reasons, causes=(SLIPPED,))
    method = replace(alignment.METHODS["odometry"], function=lambda log: found)
    monkeypatch.setitem(alignment.METHODS, "odometry", method)
    exports.write_carmen("it.log", segmap.load("room")[:11])
    code, said, _ = run("map", "it.log", "--align", "odometry", "--method", "none")
    assert code == 3 and said.splitlines() == [
        "it: 11 scans, it.log",
        "  aligned   by odometry: 1 of 11 scans matched, 40 ms",
        "            4 scans not: dark",
        "            3 scans not: far",
        "            2 scans not: turning",
        "            doubt: it slipped",
        f"  extracted {len(segmap.build_map(segmap.read('it.log'), found.trusted))} segments",
        "  assumed   the laser sits at the robot's centre",
        "  verdict   NOT A MAP: 1 of 11 scans placed",
    ]


@pytest.mark.parametrize(
    ("grade", "placed", "strict", "code"),
    [("good", 9, 0.9, 0), ("good", 8, 0.9, 3), ("doubtful", 10, 1.0, 0), ("not a map", 10, 0.0, 3)],
)
def test_strict_is_met_by_just_as_many(grade, placed, strict, code, capsys):
    """Catches 9 of 10 scans that are fewer than 0.9, and --force that is not asked."""
    verdict, report = Verdict(grade, "as said", placed, 10), Report("it")
    given, paths = Namespace(strict=strict, strict_verdict=False, force=False), [Path("it.svg")]
    assert log_options.concluded(given, verdict, report) == code
    assert ("(--strict asks" in capsys.readouterr().out) == (code == 3 and grade == "good")
    assert log_options.allowed(given, verdict, paths, report) == ([] if code else paths)
    assert (
        log_options.allowed(
            Namespace(strict=strict, strict_verdict=False, force=True), verdict, paths, report
        )
        == paths
    )


SWAPPED = ("139.7 35.7", "90.5 0", "-120 45", "180 -90")
WRONG = ("180.5 0", "120 90.5", "120 -100", "90 0 --north 400", "120 1e9 --crs EPSG:25832")


@pytest.mark.parametrize("place", SWAPPED + WRONG)
def test_a_longitude_that_comes_first_is_told(run, place):
    code, _, beside = run("map", "it.log", "--place", *place.split(), "-o", "IT.GEOJSON")
    assert code == 2 and "--place: " in beside
    assert ("; the latitude comes first" in beside) == (place in SWAPPED)


def test_a_folder_is_read_by_name_and_what_cannot_be_read_was_a_log(run, monkeypatch):
    """Catches the order of a disk, and a log that is passed over in silence since it is gone."""
    Path("logs").mkdir()
    for name in ("b.log", "a.log"):
        exports.write_carmen(Path("logs") / name, segmap.load("room")[:2])
    Path("logs/gone.log").symlink_to("nowhere.log")
    order = sorted(Path("logs").iterdir(), reverse=True)
    monkeypatch.setattr(Path, "iterdir", lambda folder: iter(order))
    code, said, beside = run("info", "logs", "--table", "IT.CSV")
    assert code == 1 and said.splitlines()[-1] == "2 of 3 logs done"
    assert said.index("a: CARMEN") < said.index("b: CARMEN") and "left out" not in beside
    table = pd.read_csv("IT.CSV")
    assert table["log"].tolist()[:2] == ["a", "b"] and "gone.log" in table["failed"][2]


# ---------------------------------------------------------------------------- map, occupancy
def test_a_crop_beside_the_map_tells_how_far_that_reaches():
    """Catches x for y, and the middle of the map for its end."""
    map = segmap.SegmentMap([[(-1, 2), (3, 5)], [(0, 1), (4, 2)]])
    with pytest.raises(ValueError, match=r"from x -1\.00 to 4\.00 m, y 1\.00 to 5\.00 m$"):
        cropped(map, (8, 8, 9, 9))


def test_occupancy_tells_size_and_area(run):
    """Catches the area as a length, a size with a margin, and one of another kind of leaves."""
    code, said, _ = run("occupancy", "room", "--resolution", "0.1", "--json", "-o", "it.geojson",
                        "-o", "it.npz")  # fmt: skip
    told, map = json.loads(said)["mapped"], quadtree.QuadtreeMap.load("it.npz")
    features = json.loads(Path("it.geojson").read_text())["features"]
    rings = np.array([each["geometry"]["coordinates"][0] for each in features])
    sides = np.ptp(rings, axis=1)[:, 0]
    assert code == 0 and told["occupied"] == pytest.approx((sides**2).sum())
    leaves, (left, low, right, high) = map.leaves(), quadtree.extent(map, margin=0)
    assert (told["width"], told["height"]) == pytest.approx((right - left, high - low))
    assert told["leaves"] == len(leaves.x) and told["bytes"] == map.nbytes
    words = f"{right - left:.1f} m by {high - low:.1f} m at 0.1 m: {told['occupied']:.2f} m2 occup"
    assert told["text"].startswith(words)


def test_a_matcher_that_lost_the_robot_says_at_which_scan(run, monkeypatch):
    """Catches a good map of a lost robot, and one that is never good."""
    steps = list(segmap.matching.map_scans(
        segmap.load("room"), map=quadtree.QuadtreeMap(resolution=0.05),
        matcher=segmap.matching.MATCHERS["hill climbing"](np.random.default_rng(0)),
        score=segmap.matching.SCORES["field"], rng=np.random.default_rng(0)))  # fmt: skip
    for lost in (None, 60):
        told = [step._replace(found=k != lost) for k, step in enumerate(steps)]
        monkeypatch.setattr(_occupancy, "map_scans", lambda *given, told=told, **named: iter(told))
        _, said, _ = run("occupancy", "room", "--matcher", "hill-climbing")
        doubt = "DOUBTFUL: lost at scan 60, and what follows hangs on it; 60 of 61 scans placed"
        wanted = "GOOD: 61 of 61 scans placed" if lost is None else doubt
        assert said.splitlines()[-1].startswith(f"  verdict   {wanted}")


# ------------------------------------------------------------------------------- locate
def belief(x, reason, uncertainty=Uncertainty.NONE):
    spread = np.diag([0.0009, 0.0016, 9.0])  # of x, y and heading: the third is no length
    nothing = np.zeros((0, 3)), np.zeros(0)
    return Belief(np.array([x, -1.5, np.pi / 2]), spread, 0.875, 0.5, reason, *nothing, uncertainty)


FOUND = ["  found     2 of 61 scans, the first is scan 1; lost at 1",
         "  place     2.50 m, -1.50 m, 90.0 degrees, within 50.0 mm",
         "  assumed   the laser sits at the robot's centre",
         "  verdict   found: 87.5 % of the particles are there, scans fit to 0.50"]  # fmt: skip
LOST = ["  found     1 of 61 scans, the first is scan 0; lost at 1", "  place     unknown",
        "  assumed   the laser sits at the robot's centre",
        "  verdict   lost: 87.5 % of the particles are there, scans fit to 0.50"]  # fmt: skip


@pytest.mark.parametrize(
    ("beliefs", "code", "said"),
    [
        ([(1, "gone", Uncertainty.LOST), (2, ""), (2.5, "")], 0, FOUND),
        (
            [(1, ""), (2, "3", Uncertainty.SEVERAL_PLACES), (np.nan, "lost", Uncertainty.NO_PLACE)],
            3,
            LOST,
        ),
        ([], 3, ["  found     0 of 61 scans; lost at 0"]),
    ],
)
def test_locate_tells_the_last_belief(run, monkeypatch, beliefs, code, said):
    """Catches the first place for the last, a spread that adds radians, and an exit code of 0."""
    found = [belief(*given) for given in beliefs]
    monkeypatch.setattr(_locate, "localize", lambda map, log, rng: iter(found))
    quadtree.QuadtreeMap(resolution=0.5, size=4).save("squares.npz")
    Path("squares.npz").rename("SQUARES.NPZ")
    ended, told, _ = run("locate", "SQUARES.NPZ", "room")
    assert ended == code and told.splitlines() == ["room: 61 scans", *said]


# ------------------------------------------------------------------------------- compare
def test_a_method_is_sought_by_doubling_and_then_between(monkeypatch):
    """Catches a search that ends beside the quality, or never, or that waits for a slow method."""
    default = _compare.thresholds(reduction.fusion)["tolerance"].default

    def tried(limit, slow_at=np.inf, seconds=20.0):
        """Thresholds that are run, of the default, where all up to a limit are good."""
        found = []

        def sweep(maps, methods, settings):
            value = settings["fusion"]["tolerance"][0] / default
            found.append(round(value, 6))
            took = seconds if value >= slow_at else 0.1
            return pd.DataFrame({"quality": [0.9 if value <= limit else 0.5], "seconds": [took]})

        monkeypatch.setattr("segmap.experiments.sweep", sweep)
        assert len(_compare.searched({}, "fusion", 0.9)) == len(found)
        return found

    root, doubled = 2**0.5, [1, 2, 4, 8, 16, 32]
    assert tried(3.0) == pytest.approx([1, 2, 4, 2 * root, 2 * root * root**0.5], abs=1e-5)
    assert tried(0.3) == pytest.approx([1, 0.5, 0.25, 0.25 * root, 0.25 * root**0.5], abs=1e-5)
    assert tried(1e9) == doubled and len(tried(0)) == 6
    assert tried(31)[:6] == doubled and len(tried(31)) == 8
    assert tried(1e9, slow_at=4) == doubled and tried(1e9, slow_at=4, seconds=20.1) == [1, 2, 4]
    assert tried(1e9, slow_at=0, seconds=99.0) == [1]


def test_a_map_is_thinned_scan_by_scan_beyond_2000_segments():
    """Catches a map of just so many that loses half, one scan that loses itself, and hours."""
    for scans, count, step in ((2, 2000, 1), (2, 2001, 2), (1, 2001, 1), (100, 9000, 5)):
        scan = np.arange(count) % scans
        part = _compare.thinned(segmap.SegmentMap(np.tile(WALL, (count, 1, 1)), scan))
        assert part.scan.tolist() == scan[scan % step == 0].tolist()


@pytest.mark.parametrize(
    ("beside", "large", "fine"),
    [(1.01, 1, True), (0.99, 1, False), (10, 50, True), (10, 50.1, False), (10, 0.1, True)],
)
def test_a_plan_is_of_another_place_beyond_its_limits(beside, large, fine, capsys):
    """Catches a plan of a few walls that is refused, and one in millimetres that is not.

    A tenth of the map lies beside a wall, or the plan is fifty times as large.
    """
    map = segmap.SegmentMap([[(0, 0), (beside, 0)], [(beside, 3), (10, 3)], [(0, 0.0), (0, 0.0)]])
    plan = np.array([[(0, 0), (beside, 0)], [(0, -4), (0, 10 * large - 4)]])[: 1 + (large > 1)]
    given, report = Namespace(plan=segmap.SegmentMap(plan), walls="p.csv"), Report("it")
    with nullcontext() if fine else pytest.raises(ValueError, match="A plan must be in metres"):
        _compare.check_plan(given, map, report)
        assert report.found["plan"]["walls"] == len(plan)
        assert report.found["plan"]["beside"] == pytest.approx(beside / 10, abs=0.01)


def test_the_table_has_the_best_first_and_the_run_that_is_nearest(monkeypatch, capsys):
    """Catches the worst first, a run without quality that is nearest, and gone taken for left."""
    rows = [("hybrid", np.nan, 0.3, 70), ("hybrid", 0.7, 0.4, 40), ("fusion", 0.8, 0.5, 50),
            ("fusion", 0.86, 0.6, 35), ("least_cost", 0.2, 0.9, 10)]  # fmt: skip
    runs = pd.DataFrame([{"method": method, "quality": quality, "n_before": 100, "n_after": left,
                          reduction.METHODS[method].varies: value, "seconds": 0.5}
                         for method, quality, value, left in rows])  # fmt: skip
    at = pd.DataFrame([{"hybrid": 0.52, "fusion": 0.61, "least_cost": np.nan}])
    monkeypatch.setattr("segmap.experiments.equal_quality", lambda runs, quality: at)
    report = Report("it")
    nearest = _compare.print_table(runs, 0.9, report)
    lines = capsys.readouterr().out.splitlines()
    assert [" ".join(line.split()) for line in lines[1:3]] == [
        "at quality 90.0 % gone left nearest run",
        "fusion 61.0 % 39 --tolerance 0.6: quality 86.0 %, 35 left, 0.5 s",
    ]
    assert lines[4].split()[:4] == ["least_cost", "not", "reached", "-"]
    assert (lines[0], lines[-1]) == ("", "") and len(lines) == 6
    assert nearest["hybrid"]["n_after"] == 40 and next(iter(nearest)) == "fusion"
    assert report.found["methods"]["least_cost"]["gone"] is None


# ---------------------------------------------------------------------------- streams
NAMED = "caf\u00e9 \u2192 \u0416.log"
#: What a terminal of another language, an old Windows and a machine without a language have.
TERMINALS = (
    {"PYTHONIOENCODING": "cp1252"},
    {"PYTHONIOENCODING": "ascii"},
    {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
)


@pytest.mark.parametrize("terminal", TERMINALS)
def test_a_name_that_a_terminal_cannot_say_never_ends_the_work(terminal, tmp_path):
    """Catches "'charmap' codec can't encode", and work that is lost for it."""
    exports.write_carmen(tmp_path / NAMED, segmap.load("room")[:3])
    words = [NAMED, "nowhere \u0416.log", "--method", "none", "--force", "-o", "{name}.csv"]
    found = subprocess.run(
        [sys.executable, "-m", "segmap", "map", *words],
        cwd=tmp_path, env=os.environ | terminal, capture_output=True, check=False,
    )  # fmt: skip
    said, beside = found.stdout.decode("latin-1"), found.stderr.decode("latin-1")
    assert "codec" not in beside and "Traceback" not in beside and found.returncode == 1
    assert "3 scans" in said
    assert "\\u0416.log" in beside or "\\udcd0\\udc96.log" in beside
    assert len(list(tmp_path.glob("*.csv"))) == 1


def test_a_name_that_is_no_text_is_written_out(tmp_path, capsys, monkeypatch):
    """Catches a session, a table of runs or a ROS map that a name ends after all the work."""
    monkeypatch.chdir(tmp_path)
    name = os.fsdecode(b"no\xfftext")
    exports.write_carmen(f"{name}.log", segmap.load("room")[:3])
    words = (f"{name}.log", "--force", "-o")
    for command, ends in (("map", ".segmap"), ("compare", ".csv"), ("occupancy", ".yaml")):
        assert main([command, *words, f"{name}{ends}"]) == 0, capsys.readouterr().err
    (run,) = readers.read_session(f"{name}.segmap").runs
    assert (run["log"], run["source"]) == ("no\\udcfftext", "no\\udcfftext.log")
    assert set(experiments.read_records(f"{name}.csv")["map"]) == {"no\\udcfftext"}
    assert b'image: "no\xfftext.pgm"' in Path(f"{name}.yaml").read_bytes()
    assert Path(f"{name}.pgm").exists()


def test_a_closed_output_is_silent_and_a_file_without_a_size_is_told():
    """Catches `>&-` and a file of the system, whose size is 0, that end in another error."""
    command = f"{sys.executable} -m segmap info"
    for ends, code in (("room >&-", 0), ("room 2>&-", 0), ("room >&- 2>&- <&-", 0),
                       ("nowhere 2>&-", 1), ("/proc/self/maps", 1)):  # fmt: skip
        found = subprocess.run(
            ["sh", "-c", f"{command} {ends}"], capture_output=True, text=True, check=False
        )
        assert found.returncode == code, found.stderr
        assert "Traceback" not in found.stderr and "ZeroDivision" not in found.stderr
    lines = Path("/proc/self/maps")
    if lines.exists():
        with pytest.raises(readers.LogError):
            readers.read(lines)
