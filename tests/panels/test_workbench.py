"""The workbench without a browser: what it runs, keeps, says and refuses."""

import contextlib
import copy
import itertools
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree as ET
from dataclasses import replace
from functools import partial
from inspect import signature

import alignment_logs as logs
import ipywidgets as W
import numpy as np
import pytest

import segmap
from segmap import LaserScan, Log, SegmentMap, alignment, exports, progress, readers, reduction
from segmap._commands import main
from segmap._display import facts
from segmap._recipe import follow
from segmap.arrays import Metres, Radians, checked
from segmap.experiments import pareto
from segmap.methods import Method
from segmap.panels import Workbench, control
from segmap.panels._base import VIEW
from segmap.panels.workbench import _bar, _job
from segmap.panels.workbench._bar import Bar
from segmap.panels.workbench._choices import Choice
from segmap.panels.workbench._job import Failed, Stopped, Worker
from segmap.panels.workbench._shown import (
    COLORS,
    left,
    runs_table,
    verdict_line,
)
from segmap.plotting import thumbnail
from segmap.progress import announce
from segmap.scans import Skipped
from segmap.simulation import URG_04LX, drive, rectangular_room, simulate

LOG = simulate(
    rectangular_room(4.0, 3.0),
    drive([(1, 1), (3, 1)], step=0.25),
    sensor=URG_04LX,
    rng=np.random.default_rng(2),
)
METHODS = {**alignment.METHODS, **reduction.METHODS}


def bench(log=LOG, **chosen):
    """A workbench that takes the true poses, which costs no time."""
    made = Workbench(log)
    made.align.value, made.method.value = "ground_truth", "fusion"
    for name, value in chosen.items():
        getattr(made, name).value = value
    return made


def done(**chosen):
    made = bench(**chosen)
    made.run()
    return made


def in_browser(made):
    """What a click on Run does, to its end."""
    made.start.click()
    made._thread.join(60)
    assert not made._thread.is_alive() and not made.start.disabled
    return made


# ------------------------------------------------------------------ what is run


@pytest.mark.parametrize("kind", ["room", "malaga", "no truth", "no odometry", "beam times"])
def test_page_and_command_make_the_same_map_of_a_log(kind, tmp_path, monkeypatch, capsys):
    """Catches another alignment, method or threshold by default behind one of the two doors."""
    monkeypatch.chdir(tmp_path)
    made = Workbench(segmap.load("room"))
    if kind in ("room", "malaga"):
        made.bundled.value = source = kind
    else:
        log = replace(LOG, truth=None) if kind != "beam times" else logs.moving_log()
        if kind == "no odometry":
            log = replace(log, scans=tuple(replace(scan, odometry=None) for scan in log))
        exports.write_arrays(tmp_path / "it.npz", log)
        made.path.value = source = "it.npz"
        made.wait()
    made.run()
    assert main(["map", source, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [len(made.outcome.map), len(made.outcome.reductions[0])] == [
        told["extracted"]["segments"],
        told["reduced"]["segments"],
    ]
    assert made.outcome.alignment.method == told["aligned"]["method"]
    assert made.outcome.recipe.deskew == ("de-skewed" in told) == (kind == "beam times")
    made.align.value = "odometry"
    made.open(segmap.load("room"))
    assert made.align.value == "odometry"  # what was chosen stays


def test_it_runs_what_is_chosen():
    """Catches a choice that is not handed on, degrees for radians, a filter that comes too late."""
    made = bench(extract="extract_clusters", least=0.3, method="hybrid", second="basic_online")
    made.extract["gap"].value = 0.5
    made.method["angle"].value = 4
    made.second["distance"].value = 0.11
    made.run()
    extract = {"extract": segmap.extract_clusters, "gap": 0.5}
    map = segmap.build_map(LOG, LOG.truth, **extract).filtered(0.3)
    first = reduction.hybrid(map, angle=np.radians(4))
    second = reduction.basic_online(map, distance=0.11)
    found = made.outcome.reductions
    assert np.array_equal(made.outcome.map.segments, map.segments)
    assert [len(first), len(second)] == [len(each) for each in found]
    assert np.array_equal(found[0].segments, first.segments)
    assert np.array_equal(found[1].segments, second.segments)
    assert made.outcome.qualities == [segmap.quality(map, first), segmap.quality(map, second)]


def test_scans_without_a_pose_of_their_own_are_left_out():
    """Catches a map that holds scans at poses which are only carried on."""
    truth = np.array(LOG.truth)
    truth[0] = np.nan
    made = bench(Log("gap", LOG.scans, truth))
    made.align["missing"].value = "drop"
    made.run()
    assert set(made.outcome.map.scan) == set(range(1, len(LOG)))


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"extract": "extract_clusters", "least": 0.2, "second": "mean_shift"},
        {"method": "hybrid", "align": "odometry"},
        {"method": "viewing_sector", "second": "weighted_line_fitting"},
    ],
)
def test_the_same_in_python_makes_the_same(settings):
    """Catches code that leaves a choice out, or rounds a threshold."""
    made = bench(**settings)
    for choice in (made.extract, made.method, made.second):
        for entry in choice.controls.values():
            if isinstance(entry, W.BoundedFloatText):
                entry.value = entry.value * 1.07
    made.run()
    names = {"log": LOG}
    exec(made.code, names)
    found = [names["reduced"], names.get("other")]
    assert np.array_equal(names["map"].segments, made.outcome.map.segments)
    for mine, theirs in zip(found, made.outcome.reductions, strict=False):
        assert np.array_equal(mine.segments, theirs.segments)
    assert ("other" in names) == (len(made.outcome.reductions) == 2)


def test_the_same_in_python_names_the_log(tmp_path):
    """Catches a path that Python cannot read, and damaged lines that are an error there."""
    path = tmp_path / "it's mine.log"
    exports.write_carmen(path, LOG)
    path.write_text(path.read_text() + "FLASER 3 1\n")
    made = bench(segmap.load("room"))
    assert made.bundled.value != "room"
    made.path.value = str(path)
    made.wait()
    assert made.log.skipped.lines == 1 and made.bundled.value != "room"
    made.run()
    exec(made.code, names := {})
    assert np.array_equal(names["reduced"].segments, made.outcome.reductions[0].segments)
    made.bundled.value = "room"
    made.run()
    assert "log = segmap.load('room')\n" in made.code


def test_what_is_known_is_not_done_again(monkeypatch):
    """Catches an alignment that runs again for another threshold, and one that is kept too long."""
    calls = []
    counted = alignment.METHODS["ground_truth"].function

    def ground_truth(log, *, missing="raise"):
        calls.append(log.name)
        return counted(log)

    monkeypatch.setitem(alignment.METHODS, "ground_truth", Method(ground_truth, "here"))
    made = bench()
    for tolerance in (0.04, 0.08):
        made.method["tolerance"].value = tolerance
        made.run()
    first = made.outcome.map
    made.least.value = 0.5
    made.run()
    assert calls == [LOG.name] and len(made.outcome.map) < len(first)
    (reduced,) = made.outcome.reductions
    assert len(reduced.parents) == len(made.outcome.map)
    made.open(Log("other", LOG.scans[:3], LOG.truth[:3]))
    made.run()
    assert calls == [LOG.name, "other"] and max(made.outcome.map.scan) == 2
    first = made.outcome.map
    made.align.value = "odometry"
    made.run()
    assert not np.array_equal(made.outcome.map.segments, first.segments)
    assert made.outcome.alignment.method == made.runs["alignment"].iloc[-1] == "odometry"


def test_beams_with_times_are_carried_to_the_start_of_their_scan():
    """Catches the map of the log as it was, a choice without effect, and code that leaves it."""
    made = bench(logs.moving_log(), deskew=True)
    made.align.value = "pose_graph"
    made.run()
    assert made.runs["align_thresholds"].iloc[-1].startswith("de-skewed")
    assert made.outcome.alignment.doubt == ""
    names = {"log": made.log}
    exec(made.code, names)
    assert np.array_equal(names["map"].segments, made.outcome.map.segments)
    first = made.outcome
    made.least.value = 0.3
    made.run()
    assert made.outcome.log is first.log and len(made.outcome.map) < len(first.map)
    made.deskew.value = False
    made.run()
    assert "deskew" not in made.code and made.outcome.log is made.log
    assert "the robot moved by more than the spacing" in made.verdict.value
    made.open(LOG)
    made.deskew.value = True
    made.run()
    assert "deskew" not in made.code and made.outcome.log is LOG


def test_a_second_method_does_not_repeat_the_first():
    """Catches a row for a run that was not made, and seconds that change by looking on."""
    made = done()
    seconds = made.runs["seconds"][0]
    made.second.value = "hybrid"
    made.run()
    assert list(made.runs["method"]) == ["fusion", "hybrid"]
    assert made.outcome.reductions[0].seconds == pytest.approx(seconds, abs=1e-6)


# ------------------------------------------------------------------ controls


#: What it was called with.
GIVEN = []


@checked
def strange(map: SegmentMap, *, angle: Metres = 0.2, skew: Radians = np.radians(10)):
    """A method that nobody knows; its names say the opposite of its units."""
    GIVEN[:] = angle, skew
    return reduction.fusion(map)


def test_a_new_method_appears_by_itself(monkeypatch):
    """Catches a list of methods beside METHODS, and a unit that is guessed from a name."""
    method = Method(strange, "here", varies="angle")
    monkeypatch.setitem(reduction.METHODS, "newest", method)
    made = bench(method="newest")
    assert "newest" in made.second.picker.options
    slider, skew = made.method["angle"], made.method["skew"]
    assert (slider.min, slider.max, slider.description) == (0.01, 2.0, "angle [m]")
    assert (skew.value, skew.description) == (10.0, "skew [degrees]")
    skew.value = 20
    made.method.value, made.method.value = "hybrid", "newest"  # settings stay meanwhile
    made.run()
    assert [0.2, np.radians(20)] == GIVEN
    exec(made.code, names := {"log": LOG})
    assert [0.2, np.radians(20)] == GIVEN and len(names["reduced"])
    assert "skew=np.radians(20)" in made.code


@pytest.mark.parametrize("name", METHODS)
def test_untouched_controls_are_the_defaults(name):
    """Catches a default that its own control rounds, and a threshold that varies without slider."""
    method = METHODS[name]
    made = Choice("method", {name: (method.function, method.varies)}, name)
    assert set(made.call().thresholds) == {*filter(None, [method.varies])}
    sliders = [key for key, c in made.controls.items() if isinstance(c, W.FloatSlider)]
    assert sliders == [*filter(None, [method.varies])] == list(made.controls)[: len(sliders)]
    usual = signature(method.function).parameters
    assert all(c.meant() == usual[key].default for key, c in made.controls.items())


def test_what_has_no_threshold_says_so():
    ways = {"none": None, "odometry": (alignment.odometry, ""), "fusion": (reduction.fusion, "")}
    shown = [Choice("way", ways, name)._box.children for name in ways]
    assert shown[0] == () and [part.value for part in shown[1]] == ["no threshold"]
    assert shown[2] and not isinstance(shown[2][0], W.Label)


@pytest.mark.parametrize(
    ("name", "first", "shown", "moved", "meant"),
    [
        ("angle", None, ("angle [degrees]", 10), 20, np.radians(20)),
        ("angle", np.radians(4), ("angle [degrees]", 4), 4, np.radians(4)),
        ("bandwidth", None, ("bandwidth [degrees/m]", 50), 7.5, np.radians(7.5)),
        ("axes", None, ("axes [degrees]", ""), " 30 ", np.radians(30)),
        ("every", 7, ("every", 7), 9, 9),
        ("origin", None, ("origin", "map"), "pair", "pair"),
        ("forget", None, ("forget", True), False, False),
    ],
)
def test_a_control_shows_and_means_what_is_declared(name, first, shown, moved, meant):
    """Catches an angle that is shown in radians, or handed on in degrees; a None that is lost."""
    found = (m.function for m in reduction.METHODS.values())
    made = control(next(f for f in found if name in signature(f).parameters), name, first)
    assert (made.description, made.value) == shown
    made.value = moved
    assert made.meant() == meant


def test_what_a_control_cannot_take_is_named():
    axes = control(reduction.fuzzy_set, "axes")
    axes.value = "long"
    with pytest.raises(ValueError, match=r"axes \[degrees\] must be a number or nothing, got 'lo"):
        axes.meant()
    with pytest.raises(ValueError, match="skew must be"):
        control(strange, "skew", -1.0, least=1, most=45, step=1)


# ------------------------------------------------------------------ in a process of its own


@pytest.fixture(scope="module")
def worker():
    """One for all tests: its start costs a second."""
    made = Worker()
    yield made
    made.stop()


def test_run_stop_and_failure_in_the_worker(worker):
    """Catches a stop that waits, a failed run that takes the good one away, a button that stays
    disabled, and work that nobody can start again."""
    made = bench()
    made._worker = worker
    in_browser(made)
    assert made.state.value == "done" and made.progress.value == made.progress.max
    first, here = made.outcome, done()
    assert np.array_equal(first.reductions[0].segments, here.outcome.reductions[0].segments)
    made.method.value = "hybrid"
    made.method["angle"].value = 0
    in_browser(made)
    assert made.outcome is first and len(made.runs) == 1
    assert made.state.value.startswith("angle must be")
    assert made.state.value.endswith("The last good run is kept.")


ENDLESS = """
from segmap.compiled import compiled
from segmap.panels.workbench._job import Worker
from segmap.progress import announce, told

@compiled
def turn(count: int) -> float:
    total = 0.0
    for k in range(count):
        total += k % 7
    return total

def endless():
    announce(0.0, str(turn(9)))  # compiled
    turn(10**13)

if __name__ == "__main__":
    import endless
    with told(lambda share, text: print(text, flush=True)):
        Worker().do(endless.endless)
"""


def test_the_worker_ends_with_its_kernel(tmp_path):
    """Catches work of many minutes that nobody waits for, and that nobody can stop."""
    (tmp_path / "endless.py").write_text(ENDLESS)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "start_new_session": True}
    kernel = subprocess.Popen([sys.executable, "endless.py"], cwd=tmp_path, **pipes)
    try:
        assert kernel.stdout.readline() == b"22.0\n"
        kernel.kill()
        assert kernel.communicate(timeout=30) == (b"", b"")  # which the worker holds open too
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(kernel.pid, signal.SIGKILL)


class Unknown:
    """Arrives nowhere, as what a notebook defines."""

    def __reduce__(self):
        return int, ("x",)


def test_a_method_of_the_notebook_is_told_to_run_here(worker):
    """Catches a worker that is out of step after what it could not take in."""
    with pytest.raises(Failed, match="only this notebook defines"):
        worker.do(lambda: 1)
    with pytest.raises(Failed, match=r"invalid literal.*only this notebook defines"):
        worker.do(facts, Unknown())
    with pytest.raises(Failed, match="positional argument"):
        worker.do(facts, LOG, LOG)


def forever():
    """Work with steps."""
    for k in itertools.count():
        announce(k % 100 / 100, f"step {k}")
        time.sleep(0.001)


@pytest.mark.parametrize(("work", "stays"), [(forever, True), (partial(time.sleep, 60), False)])
def test_a_worker_is_stopped_at_once_and_begins_anew(worker, work, stays, monkeypatch):
    """Catches a stop that waits for the work, or ends a worker that would have listened."""
    monkeypatch.setattr(_job, "PATIENCE", 20 if stays else 0.3)  # a machine with much to do
    worker.do(until, bool, 0.0)  # it has read this file now
    process, ended = worker.start(), []

    def wait():
        with contextlib.suppress(Stopped):
            worker.do(work)
        ended.append(time.monotonic())

    thread = threading.Thread(target=wait)
    thread.start()
    time.sleep(0.5)
    begun = time.monotonic()
    worker.stop()
    thread.join(20)
    assert ended[0] - begun < 5  # half a second, but for the load of the machine
    assert (worker._process is process) or not stays
    assert (worker._process is None) or stays
    assert worker.do(print) is None


def test_a_worker_that_dies_is_told_and_replaced(worker, monkeypatch):
    """Catches a run that waits for ever for a process that the system has ended."""
    process = worker.start()
    process.kill(), process.wait()
    with monkeypatch.context() as patch, pytest.raises(Failed, match="ended by itself"):
        patch.setattr(worker, "start", lambda: process)  # it died only after it was asked for
        worker.do(print)
    assert worker.do(print) is None
    assert worker._process is not process and process.stdin.closed and process.stdout.closed


def test_a_run_that_is_stopped_says_so(worker):
    """Catches a stop that is taken for a failure, and a bar that stays where it was."""
    made = bench(segmap.load("malaga"), align="pose_graph")
    made._worker = worker
    made.start.click()
    until(lambda: "of 225" in made.state.value)
    made.stop.click()
    made.wait()
    assert (made.state.value, made.progress.value) == ("stopped", 0.0) and made.outcome is None
    assert not made.start.disabled


def until(true, seconds=60):
    end = time.monotonic() + seconds
    while not true() and seconds:
        assert time.monotonic() < end
        time.sleep(0.01)


def test_the_bar_moves_and_tells_the_time_that_is_left(monkeypatch):
    """Catches a bar that stands still for a minute, and a time that is left of another work."""
    bar, now = Bar(), iter([0, 0, 1, 10, 10, 40, 41])
    monkeypatch.setattr(_bar.time, "monotonic", lambda: next(now))
    for share, words, said in (
        (0.0, "a < b", "a &lt; b ..."),
        (0.1, "a", "a ..."),
        (0.25, "a", "a, 30 s left"),
        (0.0, "b", "b, 30 s so far"),
    ):
        bar.tell(share, words)
        assert (bar.state.value, bar.bar.value) == (said, share)


# ------------------------------------------------------------------ logs


def test_an_uploaded_file_is_read(tmp_path, worker):
    """Catches a name that leaves its folder, a piece that is lost or comes twice, and a file that
    is no log taking the log away, or told with places and Python that its user does not know."""
    exports.write_carmen(tmp_path / "a.log", LOG)
    made, content = bench(), (tmp_path / "a.log").read_bytes() + b"FLASER 3 1\n"
    made._worker = worker
    upload(made, "../../etc/mine.log", content)
    assert made.log.name == "mine" and len(made.log) == len(LOG)
    assert "<b>mine</b> 9 scans" in made.about.value
    assert "1 line left out; mine.log, line 11: announces" in made.about.value
    assert made.state.value == "mine: ready to run"
    upload(made, "\0", b"no log\n")
    assert made.log.name == "mine" and made.state.value.startswith(
        "upload.log: is of no known format: it starts with &#x27;no log&#x27;. Known formats: "
    )
    upload(made, "b.log", b"FLASER 3 1\n")
    assert made.state.value.startswith("b.log: holds no scan, expected a FLASER")
    assert "damaged line 1: " in made.state.value
    assert "segmap" not in made.state.value and tempfile.gettempdir() not in made.state.value


def upload(made, name, content, piece=700):
    """What upload.js does."""
    asked = [0]
    made.upload.send = lambda said: asked.append(said["next"])
    while asked[-1] >= 0:
        said = {"name": name, "size": len(content), "start": asked[-1]}
        part = memoryview(content[asked[-1] : asked[-1] + piece])
        made.upload._handle_custom_msg(said, [part])
    made.wait()


def test_an_upload_can_be_stopped_and_what_is_too_large_is_not_sent():
    """Catches a page that loses its kernel over a log of 200 MB, and one that takes it all."""
    made, asked = bench(), []
    made.upload.send = lambda said: asked.append(said["next"])
    assert made.upload.most == 100_000_000
    made.upload._handle_custom_msg({"name": "a\0/long.log", "size": 100_100_000, "start": 0}, [])
    assert made.state.value == (
        "long.log has 100.1 MB: only a file up to 100 MB; larger ones by their path"
    )
    for start in (0, 7, 2):  # one does not go on where the other ends
        said = {"name": "it.log", "size": 50_000_000, "start": start}
        made.upload._handle_custom_msg(said, [memoryview(b"xx")])
    assert made.state.value.startswith("uploading it.log, 0 of 50 MB")
    made.stop.click()
    made.upload._handle_custom_msg(said | {"start": 4}, [memoryview(b"xx")])
    assert asked == [-1, 2, 2, 4, -1] and made.log is LOG


def test_a_path_that_is_none_is_told_and_the_log_kept():
    made = bench()
    made.path.value = "/nowhere/at.log"
    made.wait()
    assert "does not exist" in made.state.value and made.log is LOG
    with pytest.raises(ValueError, match="source must be the path"):
        made.open(3)
    with pytest.raises(ValueError, match="must hold one scan at least"):
        made.open(Log("empty", []))
    with pytest.raises(ValueError, match="log must be a Log, got 'malaga'"):
        Workbench("malaga")
    made.files.children[1].click()
    assert made.state.value == "there is no result yet: run() makes one"


def test_another_log_while_one_is_worked_on():
    """Catches the map of one log shown as that of another, or kept for its next run."""
    made = bench()
    outcome = done().outcome
    other = Log("other", LOG.scans[:3], LOG.truth[:3])
    made.open(other)
    made._show(LOG, outcome)
    assert list(made.runs["map"]) == [LOG.name] and repr(made).startswith(f"Workbench({LOG.name}:")
    made.run()
    assert made.outcome.map.scan.max() == 2


def test_a_log_in_words():
    scans = [LaserScan([1.0, 2.0], [0.0, 0.5]), LaserScan([1.0], [0.0])]
    log = Log("<b>", scans, skipped=Skipped(2, "line 7: no number"))
    assert facts(log) == [
        ("scans", "2 scans, without times"),
        ("beams", "1 to 2 a scan, 100.0 % of them valid"),
        ("view", "28.65 degrees, 28.6 from beam to beam"),
        ("ranges", "1.00 to 2.00 m, half of them below 1.00 m"),
        ("odometry", "none"),
        ("truth", "none"),
        ("damaged", "2 lines left out; line 7: no number"),
    ]
    assert "<b>&lt;b&gt;</b> 2 scans" in Workbench(log).about.value


# ------------------------------------------------------------------ what is seen


@pytest.fixture(scope="module")
def both():
    """A run of two methods."""
    return done(second="basic_online")


def test_a_segment_that_is_pointed_at_shows_its_members(both):
    """Catches members of the other method, and rows of the output for rows of the map."""
    outcome = both.outcome
    for which, index in ((0, 1), (1, 2)):
        rows = outcome.reductions[which].members(index)
        both.canvas.set_state({"pointed": [which, index]})
        assert both.canvas.members == rows.tolist() and len(rows) > 1
        assert np.array_equal(both.point(index, which), outcome.map.segments[rows])
        assert f"segment {index}: " in both.chosen.value
        assert f"made of {len(rows)} segments of" in both.chosen.value
    both.canvas.set_state({"pointed": [-1, -1]})
    assert both.canvas.members == [] and both.chosen.value == ""


def test_what_cannot_be_pointed_at_is_told(both):
    """Catches an exception that nobody sees: a message that comes after another run."""
    both.canvas.set_state({"pointed": [0, 9999]})
    assert "index must be" in both.state.value
    with pytest.raises(ValueError, match="which must be"):
        both.point(0, 2)
    with pytest.raises(ValueError, match="no result yet"):
        bench().point(0)


def test_the_canvas_gets_the_maps_about_their_middle(both):
    """Catches a building far from the origin that single floats would crumble, swapped maps."""
    outcome, canvas = both.outcome, both.canvas
    ends = outcome.map.segments.reshape(-1, 2)
    middle = (ends.min(0) + ends.max(0)) / 2
    shown = [canvas.before, canvas.first, canvas.second]
    for bytes_, segments in zip(shown, [outcome.map, *outcome.reductions], strict=True):
        unpacked = np.frombuffer(bytes_, np.float32).reshape(-1, 2, 2)
        assert np.allclose(unpacked, segments.segments - middle, atol=1e-6)
    assert canvas.size == pytest.approx(np.ptp(ends, axis=0))
    assert canvas.titles[0] == f"before: {len(outcome.map)} segments"
    far = SegmentMap(outcome.map.segments + 1e6)
    canvas.show(far.segments, [], [])
    assert np.allclose(np.frombuffer(canvas.before, np.float32), unpacked_of(shown[0]), atol=1e-6)
    assert canvas.second == b""


def unpacked_of(content):
    return np.frombuffer(content, np.float32)


def test_what_is_repeated_is_said(both):
    """Catches a bar that stands still in silence, and an alignment that is made twice."""
    outcome, told, again = both.outcome, [], []
    with progress.told(lambda share, words: told.append(words)):
        follow(outcome.recipe, LOG, None)
    with progress.told(lambda share, words: again.append(words)):
        follow(outcome.recipe, LOG, outcome)
    assert told[0] == f"aligning {len(LOG)} scans by ground_truth" and told[0] not in again


def test_every_run_is_kept(both):
    """Catches rows that experiments cannot compare, and figures of the other method."""
    rows, outcome = both.runs, both.outcome
    assert list(rows["method"]) == ["fusion", "basic_online"]
    assert list(rows["n_after"]) == [len(each) for each in outcome.reductions]
    assert list(rows["quality"]) == pytest.approx(outcome.qualities)
    assert set(pareto(rows)["method"]) <= {"fusion", "basic_online"}
    assert list(Workbench(LOG).runs.columns) == list(rows.columns)


def test_runs_are_rows_with_bars():
    """Catches a bar of another share, numbers at the left, names that are no text."""
    row = {"map": "<&>", "method": "fusion", "thresholds": "tolerance 0.04", "alignment": "it",
           "n_before": 10, "n_after": 4, "seconds": 0.5}  # fmt: skip
    rows = [row | {"quality": q, "reduction": r} for q, r in ((0.9, 0.6), (np.nan, -0.1))]
    head, last, first = ET.fromstring(runs_table(rows)).iter("tr")
    assert [cell.text for cell in head][:4] == ["reduction", "quality", "run", "method"]
    assert [cell.text for cell in first] == [
        *("60.0%", "90.0%", "0", "fusion", "tolerance 0.04", "4", "10", "0.500", "<&>", "it")
    ]
    assert last[2].text == "1"
    right = ["text-align: right" in cell.get("style", "") for cell in first]
    assert right == [True, True, True, False, False, True, True, True, False, False]
    for cell in first[:2]:
        assert f"#bfdcec {cell.text}, #f0f0f0 {cell.text}" in cell.get("style")
    assert all("#bfdcec 0.0%" in cell.get("style") for cell in last[:2])
    assert runs_table(rows * 10).count("<tr>") == 9


def test_each_step_holds_what_came_of_it(both):
    """Catches figures of the other method, and a doubt that nobody reads."""
    told, outcome = both.figures.value, both.outcome
    for reduced, kept in zip(outcome.reductions, outcome.qualities, strict=True):
        rate = segmap.reduction_rate(outcome.map, reduced)
        assert f"reduction {rate:.1%}, {segmap.metrics.grade_reduction(rate)}" in told
        assert f"quality {kept:.1%}, {segmap.metrics.grade_quality(kept)}" in told
    assert both.extracted.value == f"{len(outcome.map)} segments of {len(LOG)} scans"
    doubted = [
        reduction.Reduction(r.segments, r.parents, 0.5, doubt="a < b") for r in outcome.reductions
    ]
    other = copy.copy(outcome)
    other.reductions = doubted
    told = left(other)
    assert told.count("<br>a &lt; b") == 2 and "; 0.500 s" in told


def test_the_verdict_on_the_map_comes_in_words_and_in_a_colour(both):
    """Catches a map that nobody judges."""
    assert both.outcome.verdict.words in both.verdict.value and COLORS["good"] in both.verdict.value
    assert both.outcome.verdict.doubled is not None
    assert set(both.runs["verdict"]) == {"good"} and set(both.runs["placed"]) == {len(LOG)}
    bad = replace(both.outcome.verdict, grade="not a map", words="NOT A MAP: a < b")
    assert "a &lt; b" in verdict_line(bad) and len(set(COLORS.values())) == len(COLORS) == 3


def test_thresholds_are_shown_where_they_are_asked_for():
    made = bench(second="none")
    shown = [choice._box.layout for choice in (made.align, made.method)]
    assert [layout.display for layout in shown] == ["none", "none"]
    made.align.settings.value = True
    assert [layout.display for layout in shown] == ["flex", "none"]
    assert made.second.settings.layout.visibility == "hidden"
    made.second.value = "hybrid"
    assert made.second.settings.layout.visibility == "visible"


def test_a_map_without_a_wall_is_refused_with_its_verdict():
    """Catches a run that ends with a hint about the extraction where no scan was placed."""
    bench = Workbench(Log("dark", [replace(s, ranges=np.full(len(s), np.inf)) for s in LOG]))
    bench.align.value = "odometry"
    with (
        pytest.warns(UserWarning, match="is empty"),
        pytest.raises(ValueError, match=r"NOT A MAP: .* no wall found; no segment is left"),
    ):
        bench.run()
    assert bench.verdict.value == ""


def test_it_is_shown_without_a_kernel(both):
    """Catches an empty page of a chapter that was exported, or that nobody trusts yet."""
    bundle = both._repr_mimebundle_()
    assert bundle["image/png"].startswith(b"\x89PNG") and bundle["text/plain"] == repr(both)
    assert bundle[VIEW]["model_id"] == both._view.model_id
    fresh = Workbench(LOG)
    assert fresh._repr_mimebundle_()["image/png"] == thumbnail(LOG)
    assert repr(fresh) == f"Workbench({LOG.name}: not run yet)"
    assert "fusion leaves" in repr(both) and "basic_online leaves" in repr(both)


def test_without_anywidget_there_is_a_picture(monkeypatch):
    """Catches a workbench that needs the canvas to run at all."""
    monkeypatch.setitem(__import__("sys").modules, "segmap.panels.workbench._canvas", None)
    made = done()
    assert made.canvas is None and bytes(made.picture.value).startswith(b"\x89PNG")
    assert len(made.point(0)) and made.picture in made._view.children[0].children[1].children


@pytest.mark.parametrize("end", [".csv", ".npz", ".svg", ".geojson", ".wkt", ".dxf"])
def test_the_browser_gets_the_result_in_every_format(both, end, tmp_path, monkeypatch):
    """Catches a button of another format, and one that writes the map before."""
    sent, found = [], both.outcome.reductions
    monkeypatch.setattr(type(both.canvas), "save", lambda self, *given: sent.append(given))
    (button,) = (b for b in both.files.children[1:] if b.description == end)
    button.click()
    both.export(tmp_path / f"map{end}")
    assert sent == [(f"simulated-fusion{end}", (tmp_path / f"map{end}").read_bytes())]
    if end in (".csv", ".npz"):
        both.export(tmp_path / f"other{end}", which=1)
        for name, reduced in zip(("map", "other"), found, strict=True):
            read = readers.read_segments(tmp_path / f"{name}{end}")
            assert np.array_equal(read.segments, reduced.segments)


def test_nothing_left_is_told():
    """Catches a picture of nothing, and an error of numpy about it."""
    made = bench(least=50.0)
    with pytest.raises(ValueError, match="no segment is left"):
        made.run()
    assert made.outcome is None and len(made.runs) == 0
