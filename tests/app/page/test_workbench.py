"""The workbench without a browser: what it runs, keeps, says and refuses."""

import contextlib
import itertools
import json
import os
import re
import runpy
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import replace
from functools import partial
from inspect import signature

import alignment_logs as logs
import ipywidgets as W
import numpy as np
import pytest
from driven_panels import LOG
from emulated import wait_for
from programs import program

import segmap
from segmap import Log, alignment, exports, readers, reduction
from segmap.display import facts
from segmap.experiments import pareto
from segmap.plan import edits as plan_edits
from segmap.progress import announce
from segmap_app import files
from segmap_app.page import Workbench, _job, _shown
from segmap_app.page._choices import Choice
from segmap_app.page._job import Failed, Stopped, Worker
from segmap_app.page._page import SAVES
from segmap_app.page._source import OWN

main = program("segmap")

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


# ------------------------------------------------------------------ what is run


#: Logs that hold a true pose for each scan.
OWN_POSES = "room", "beam times"


@pytest.mark.parametrize("kind", ["room", "no truth", "no odometry", "beam times"])
def test_page_and_command_make_the_same_map_of_a_log(kind, tmp_path, monkeypatch, capsys):
    """Catches another alignment, method or threshold by default in page or command, and Python
    that cannot read the path."""
    monkeypatch.chdir(tmp_path)
    made = Workbench(segmap.load("room"))
    if kind == "room":
        made.bundled.value = source = kind
    else:
        log = replace(LOG, truth=None) if kind != "beam times" else logs.moving_log()
        if kind == "no odometry":
            log = replace(log, scans=tuple(replace(scan, odometry=None) for scan in log))
        exports.write_arrays(tmp_path / "it's.npz", log)
        made.path.value = source = "it's.npz"
        made.wait()
    made.run()
    assert main(["map", source, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert len(made.outcome.map) == told["extracted"]["segments"]
    assert len(made.outcome.reductions[0]) == told["reduced"]["segments"]
    assert made.outcome.alignment.method == told["aligned"]["method"] == "pose_graph"
    assert ("poses of its own" in made._choices.own_poses.value) == (kind in OWN_POSES)
    assert ("de-skewed" in told) == (kind == "beam times")
    assert made.outcome.recipe.prepare == {}
    exec(made.code, names := {})
    assert np.array_equal(names["reduced"].segments, made.outcome.reductions[0].segments)
    made.align.value = "odometry"
    made.open(segmap.load("room"))
    assert made.align.value == "odometry" and made.bundled.value == OWN  # what was chosen stays


def test_what_is_known_is_not_done_again(monkeypatch):
    """Catches an alignment that runs again for another threshold, one that is kept too long, a bar
    that stands still in silence, and a row for a run that was not made."""
    made, said = bench(), []
    monkeypatch.setattr(made._bar, "tell", lambda share, words: said.append(words * (share < 1)))

    def steps(choice=None, value=None):
        if choice is not None:
            choice.value = value
        said.clear()
        made.run()
        return "".join(words[0] for words in said if " by " in words or words[:1] == "m")

    assert steps() == "aerm"
    begun = [word for word in said if not word.startswith(("loading compiled", "compiling once"))]
    assert begun[0] == f"preparing {len(LOG)} scans"
    assert steps() == "m" and steps(made.method["tolerance"], 0.08) == "rm"
    first, (done,) = made.outcome.map, made.outcome.reductions
    assert steps(made.second, "hybrid") == "rm" and made.outcome.reductions[0] is done
    assert list(made.runs["method"]) == ["fusion", "fusion", "hybrid"]
    assert steps(made.least, 0.5) == "rrm" and len(made.outcome.map) < len(first)
    assert steps(made.extract["tolerance"], 0.2) == steps(made.people, 0.5) == "errm"
    made.open(Log("other", LOG.scans[:3], LOG.truth[:3]))
    assert steps() == "aerrm" and max(made.outcome.map.scan) == 2
    first = made.outcome.map
    assert steps(made.align, "odometry") == "aerrm"
    assert not np.array_equal(made.outcome.map.segments, first.segments)
    assert made.outcome.alignment.method == made.runs["alignment"].iloc[-1] == "odometry"


# ------------------------------------------------------------------ controls


@pytest.mark.parametrize("name", METHODS)
def test_untouched_controls_are_the_defaults(name):
    """Catches a default that its own control rounds, and a threshold that varies without slider."""
    method = METHODS[name]
    made = Choice("method", {name: (method.function, method.varies)}, name)
    assert set(made.call().thresholds) == {*filter(None, [method.varies])}
    sliders = [key for key, c in made.controls.items() if isinstance(c, W.FloatSlider)]
    assert sliders == [*filter(None, [method.varies])] == list(made.controls)[: len(sliders)]
    usual = {key: one.default for key, one in signature(method.function).parameters.items()}
    if name == reduction.USUAL_METHOD:
        usual |= reduction.USUAL_THRESHOLDS
    assert all(c.meant() == usual[key] for key, c in made.controls.items())


# ------------------------------------------------------------------ in a process of its own


@pytest.fixture(scope="module")
def worker():
    """One for all tests: its start costs a second."""
    made = Worker()
    yield made
    made.stop()


def test_run_stop_and_failure_in_the_worker(worker, monkeypatch):
    """Catches a stop that waits, a failed run that takes the good one away, a button that stays
    disabled, and work that nobody can start again."""
    made, watched = bench(), []
    made._worker = worker
    monkeypatch.setattr(made._bar, "watch", watched.append)

    def click():
        made.start.click()
        made.wait()
        wait_for(lambda: watched[-1:] == [made._thread])
        assert not made.start.disabled

    click()
    assert made.state.value == f"{LOG.name}: done" and made.progress.value == made.progress.max
    first, here = made.outcome, done()
    assert np.array_equal(first.reductions[0].segments, here.outcome.reductions[0].segments)
    made.method.value = "hybrid"
    made.method["angle"].value = 0
    click()
    assert made.outcome is first and len(made.runs) == 1
    assert refused(made).startswith("angle must be")
    assert made.state.value.endswith("The last good run is kept.")


ENDLESS = """
from segmap.compiled import compiled
from segmap_app.page._job import Worker
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


def test_stop_ends_a_compiled_loop_within_two_seconds(worker, tmp_path):
    """Catches *Stop* that waits for a loop which cannot be interrupted."""
    (tmp_path / "endless.py").write_text(f"{ENDLESS}\nendless()\n")
    made = bench()
    made._worker = worker
    made._begin(runpy.run_path, (str(tmp_path / "endless.py"),), print)
    wait_for(lambda: made.state.value.startswith("22.0"), 60)
    process, begun = worker.start(), time.monotonic()
    made.stop.click()
    wait_for(lambda: made.state.value == "stopped", 20)
    seconds = time.monotonic() - begun
    assert process.poll() is not None
    assert seconds < 2, "0.2 to 0.4 s, also where twenty others work"


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
    monkeypatch.setattr(_job, "STEP_PATIENCE_S", 20 if stays else 0.3)  # a machine with much to do
    worker.do(callable, forever)  # it has read this file now
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
    kept = worker.start()
    with pytest.raises(Failed, match="SystemExit: no room"):
        worker.do(sys.exit, "no room")
    assert worker.do(print) is None and worker.start() is kept
    with pytest.raises(Failed, match="ended by itself: is there memory"):
        worker.do(os._exit, 3)
    told = worker.do(facts, LOG)
    worker.end()
    assert worker.do(facts, LOG) == told  # which the new one has not got yet


@pytest.mark.skipif(sys.platform != "linux", reason="the limits are those of Linux")
def test_what_reads_strangers_files_has_limits(worker):
    """Catches a file that takes all the memory of the machine, or works for a night."""
    with pytest.raises(Failed, match="MemoryError"):
        worker.do(bytearray, 2 * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    with pytest.raises(Failed, match="it took 60 minutes"):
        worker.do(signal.raise_signal, signal.SIGALRM)
    assert worker.do(signal.getitimer, signal.ITIMER_REAL)[0] > 3000


@pytest.mark.slow
def test_a_run_that_is_stopped_keeps_what_is_placed_and_says_so(worker, tmp_path, monkeypatch):
    """Catches a stop that throws the map away, one that is taken for a whole map, a map that is
    seen only at the end, and a next run that maps the part again."""
    made, grown = bench(segmap.load("malaga"), align="pose_graph"), []
    made._worker = worker
    grow = made.canvas.grow
    monkeypatch.setattr(made.canvas, "grow", lambda *seen: grown.append(seen) or grow(*seen))
    made.start.click()
    wait_for(lambda: len(grown) > 1 or "solving" in made.state.value, 60)
    assert made.canvas.growing and made.canvas.before == b"" and len(made.canvas.points) > 99
    made.stop.click()
    made.wait()
    count = len(made.outcome.alignment)
    words = f"stopped at scan {count} of 225"
    assert 1 <= len(grown[0][0]) < count < 225 and len(grown[0][1]) > 99
    assert made.state.value == f"malaga: {words}; Run maps all of it"
    assert made.outcome.verdict.grade == "doubtful" and words in made.verdict.value
    assert not made.canvas.growing and len(made.canvas.way) == 8 * count
    assert not made.start.disabled and words in made.runs["align_thresholds"].iloc[-1]
    exec(made.code, names := {"log": made.log})
    assert np.array_equal(names["full"].segments, made.outcome.map.segments)
    made.export(tmp_path / "it.segmap")
    kept = files.read_session(tmp_path / "it.segmap").log
    assert len(kept) == count and kept.causes[-1].words == words and kept.causes[-1].doubtful
    monkeypatch.setattr(made.canvas, "save", lambda name, content: grown.append(name))
    made.files.children[0].click()
    made.wait()
    assert grown[-1] == f"malaga-fusion-{words.replace(' ', '-')}.dxf"
    made.method["tolerance"].value = 0.06
    made.edits.square.value = True  # an edit is of what is kept
    made.wait()
    assert made.outcome.stopped == words
    made.start.click()
    made.wait()
    assert len(made.outcome.alignment) == 225 and made.outcome.stopped == ""
    assert words not in made.verdict.value


# ------------------------------------------------------------------ logs


def test_an_uploaded_file_is_read(tmp_path, worker):
    """Catches a name that leaves its folder, a piece that is lost or comes twice, and a file that
    is no log taking the log away, or told with places and Python that its user does not know."""
    exports.write_carmen(tmp_path / "a.log", LOG)
    made, content = bench(), (tmp_path / "a.log").read_bytes() + b"FLASER 3 1\n"
    made._worker = worker
    upload(made, "../../etc/mine.log", content)
    assert made.log.name == "mine" and len(made.log) == len(LOG)
    assert "<b>mine</b> 5 scans" in made.about.value
    assert "1 line left out; mine.log, line 7: announces" in made.about.value
    assert made.state.value == "mine: ready to run"
    asked = upload(made, "b.log", content, stop=True)
    assert asked == [0, 700, -1] and made.log.name == "mine"
    upload(made, "\0", b"no log\n")
    assert made.log.name == "mine" and made.state.value.startswith(
        "upload.log: is of no known format: it starts with &#x27;no log&#x27;. Known formats: "
    )
    upload(made, "b.log", b"FLASER 3 1\n")
    reason = made.state.value
    assert reason.startswith("b.log: holds no scan, expected a FLASER")
    assert "damaged line 1: " in reason
    assert "segmap" not in reason and tempfile.gettempdir() not in reason
    assert reason in refused(made) and "segmap-wrong" in made.state._dom_classes
    assert made.start.disabled, "the next run would map a log that nobody asks for any more"
    upload(made, "mine.log", content)
    assert not made.start.disabled


def test_the_columns_of_a_table_are_chosen_above_its_first_rows(worker):
    """Catches a table that Python alone can read, one that is read unchosen, lost choices, a name
    of the question that no menu has, and angles whose direction is assumed without a word."""
    rows = "".join(f"{0.1 * (k // 9):.1f};{20 * (k % 9)};{500 + k}\n" for k in range(27))
    made = bench()
    made._worker = worker
    upload(made, "it.csv", b"t;angle_deg;dist\n" + rows.encode())
    table = made._source.columns
    assert "the unit of &#x27;dist&#x27; is not said" in refused(made)
    assert table.view.layout.display == "" and table.read.disabled
    assert [kind.value for kind in table.kinds] == ["", "angle_deg", ""]
    table.kinds[0].value, table.kinds[2].value = "time_s", "range_mm"
    assert not table.read.disabled and table.first.layout.display == "none"
    table.read.click()
    made.wait()
    assert len(made.log) == 3 and made.log.times == pytest.approx([0, 0.1, 0.2])
    assert made.log[0].ranges.max() == pytest.approx(0.508)
    mirrored = made._choices.mirrored
    assert "RPLidar" in mirrored.children[0].value and mirrored.layout.display is None
    names = "columns=['time_s', 'angle_deg', 'range_mm']"
    assert (
        made._source.expression == f"segmap.readers.read_csv('it.csv', {names}, on_error=\"skip\")"
    )
    upload(made, "wide.csv", "".join(f"{k},{'1.5,' * 180}2\n" for k in range(9)).encode())
    assert [kind.value for kind in table.kinds] == [""] and table.read.disabled
    table.kinds[0].value, table.first.value, table.last.value = "scan,ranges_m", "-90", "90"
    table.read.click()
    made.wait()
    assert len(made.log) == 9 and np.degrees(made.log[0].angles[[0, -1]]) == pytest.approx(
        [-90, 90]
    )
    assert len(made.log[0]) == 181, "names before the ranges are written in the same cell"
    assert {"x_cm", "y_ft", "pose_x_mm", "urg_mm", "time"} <= {*table.kinds[0].options}
    made.bundled.value = "room"
    assert table.view.layout.display == mirrored.layout.display == "none"


def refused(made):
    """What stands in red on the page."""
    assert "segmap-wrong" in made.state._dom_classes
    return made.state.value


def upload(made, name, content, piece=700, *, stop=False):
    """What upload.js does, and where it was asked to go on."""
    asked = [0]
    made.upload.send = lambda said: asked.append(said["next"])
    while asked[-1] >= 0:
        said = {"name": name, "size": len(content), "start": asked[-1]}
        part = memoryview(content[asked[-1] : asked[-1] + piece])
        made.upload._handle_custom_msg(said, [part])
        if stop:
            made.stop.click()
    made.wait()
    return asked


def test_a_row_of_all_runs_brings_that_run_back(tmp_path):
    """Catches the map of one run with the choices or the log of another, and a row of a session
    that promises what is not kept."""
    made = done()
    first = made.outcome
    made.open(segmap.load("room"))
    made.align.value, made.method.value = "odometry", "hybrid"
    made.method["angle"].value = 7
    made.run()
    made.canvas._handle_custom_msg({"run": 0, "beside": True}, [])
    assert made.canvas.titles[2:] == ["", "run 0, simulated: 4"] and made.log.name == "room"
    assert len(made.canvas.other) == 16 * len(first.reductions[0])
    made.canvas._handle_custom_msg({"run": 0, "beside": False}, [])
    made.wait()  # for what is free in it
    assert made.canvas.free != b""
    assert made.outcome is first and made.log is LOG and made.canvas.other == b""
    assert (made.align.value, made.method.value) == ("ground_truth", "fusion")
    assert made.state.value == f"{LOG.name}: done" and made.figures.value == _shown.by_method(first)
    made.bring_back(1)
    assert (made.log.name, made.method["angle"].value, len(made.runs)) == ("room", 7, 2)
    made.export(tmp_path / "it.segmap")
    made.open(tmp_path / "it.segmap")
    made.canvas._handle_custom_msg({"run": 0, "beside": False}, [])
    assert made.state.value.startswith("run 0: only its figures are kept")
    assert "segmap-run" not in made.listed.value


def test_each_edit_is_taken_back(worker):
    """Catches an undo of two edits at once, and one that is itself undone."""
    made = done()
    made._worker = worker
    assert made.undo.disabled
    for crop in ("0 0 9 9", "0 0 5 5"):
        made.edits.crop.value = crop
        made.wait()
    made.edits.square.value = True
    made.wait()
    for crop in ("0.0 0.0 5.0 5.0", "0.0 0.0 9.0 9.0", ""):
        made.undo.click()
        made.wait()
        assert (made.edits.crop.value, made.edits.square.value) == (crop, False)
        assert made.outcome.recipe.edits == made.edits.value()
    assert made.undo.disabled and len(made.outcome.map) == len(done().outcome.map)


def test_what_cannot_be_done_is_greyed_and_why_not_is_said(worker):
    """Catches a button that answers with a reproach, and a fault that stays once it is mended."""
    made = bench(method="hybrid")
    made._worker = worker
    needs = [*made.files.children, made.shown, made.tool, made.edits.drag, *made.layers.values()]
    assert all(each.disabled for each in needs) and made.stop.disabled
    assert not made.start.disabled
    made.method["angle"].value = 0
    made.start.click()
    made.wait()
    assert refused(made).startswith("angle must be")
    made.method["angle"].value, made.edits.crop.value = 5, "<b>"
    made.start.click()
    assert refused(made).startswith("crop [m] must be like") and "<b>" not in refused(made)
    seen = {made.start: [], made.stop: []}
    for button, states in seen.items():  # the work may end before anybody looks
        button.observe(lambda change, states=states: states.append(change.new), "disabled")
    made.edits.crop.value = ""  # the map that waits to be reduced runs at once: no click
    made.wait()
    assert seen == {made.start: [True, False], made.stop: [False, True]}
    assert "segmap-wrong" not in made.state._dom_classes
    assert not any(each.disabled for each in needs) and made.stop.disabled


def test_layers_and_what_is_measured(worker):
    """Catches a layer of the map before, one that is made though nobody asks, lost units, and a
    map that is seen without its path, its loops and what is free."""
    made = done()
    made._worker, canvas = worker, made.canvas
    assert canvas.layers == ["path", "loops", "free space"] and canvas.points == b""
    assert len(canvas.free) > 12 and canvas.unsaved
    made.layers["free space"].value = False
    made.run()
    assert canvas.free == b"", "nobody asked for it"
    for name in ("path", "loops"):
        made.layers[name].value = False
    assert canvas.layers == []
    assert len(canvas.way) == 8 * len(LOG) and len(canvas.sure) == 4 * len(LOG)
    for name in ("points", "grid", "free space"):
        made.layers[name].value = True
    made.wait()
    assert canvas.layers == ["points", "free space", "grid"]
    valid = sum(int(scan.valid.sum()) for scan in LOG)
    assert len(canvas.points) == 8 * valid and len(canvas.free) > 12
    x, y, side = np.frombuffer(canvas.free, np.float32).reshape(-1, 3).T
    wide, high = canvas.size
    assert min(side) >= 0.05 * (1 - 1e-6) and max(x + side) <= wide / 2 + 1
    assert max(y + side) <= high / 2 + 1
    for kind, words in (("distance", "2.500 m"), ("area", "2.500 m\u00b2")):
        canvas._handle_custom_msg({"measured": kind, "size": 2.5}, [])
        assert made.chosen.value == words
    made.second.value = "hybrid"
    made.run()
    assert canvas.points != b"", "another map has its own"


def headings(page):
    """What stands above the steps of a page."""
    texts = [getattr(each, "value", "") for each in page._view.children[1].children]
    return [re.sub("<.*?>", "", text) for text in texts if str(text).startswith("<h2")]


def test_a_plan_is_mended_and_a_session_keeps_it(worker, tmp_path, monkeypatch):
    """Catches edits that another run or a session loses, or does at turned places; a doubt that
    knows no names; a file of segments where the plan is seen, and of the plan where it is not."""
    made = bench(segmap.load("room"))
    made.run()
    made._worker, rooms = worker, made.rooms
    assert rooms.plan is None and not rooms.switch.disabled
    rooms.switch.value = True
    made.wait()
    assert rooms.editor.state["words"] == (
        "3 rooms of 46.4 m\u00b2, 2 doors; openings to where nothing was seen, windows or glass: 1"
    )
    place = tuple(rooms.plan.rooms[1].place.round(3).tolist())
    rooms.editor.do(plan_edits.Name(place, "the hall <b>$x"))
    rooms.editor.do(plan_edits.NoDoor(rooms.plan.doors[0].place))
    rooms.editor.do(plan_edits.Join((90, 90), (91, 91)))
    assert rooms.editor.state["words"].startswith("nothing is changed: no room at")
    sent = []
    monkeypatch.setattr(made.canvas, "save", lambda *given: sent.append(given))
    for shown, name in ((True, "room-plan.csv"), (False, "room-fusion.csv")):
        rooms.switch.value = shown
        made.wait()
        made.files.children[[*SAVES].index("Table (CSV)")].click()
        made.wait()
        assert sent[-1][0] == name
        assert (
            (b"hall <b>$x" in sent[-1][1]) == shown == (headings(made)[7] == "Save the floor plan")
        )
    assert headings(made)[7] == "Save the map"
    rooms.switch.value = True
    made.wait()
    for button in made.files.children:
        button.click()
        made.wait()
    ends = (".dxf", ".geojson", ".pdf", ".svg", ".png", ".csv")
    assert {f"room-plan{end}" for end in ends} <= {given[0] for given in sent if given[1]}
    made.export(tmp_path / "it.segmap")
    first, second = files.read_session(tmp_path / "it.segmap").edits["edit"]
    assert made.state.value == "handed to the browser: room-fusion.segmap"
    assert not made.canvas.unsaved
    rooms.editor.undo()
    assert made.canvas.unsaved, "an edit after a session was saved is asked about"
    rooms.editor.redo()
    assert first == f"Name {place[0]:g} {place[1]:g} the hall <b>$x" and second[:6] == "NoDoor"
    other = Workbench()
    other.open(tmp_path / "it.segmap")
    other.edits.square.value = True
    other.run()
    other._worker, other.rooms.switch.value = worker, True
    other.wait()
    turned = other.rooms.plan
    assert len(turned.doors) == 1 and "the hall <b>$x" in {room.name for room in turned.rooms}
    assert turned.edits[0].at != place and not turned.unplaced
    other.rooms.editor.undo()
    assert [*map(str, other.edits.plan)] == [first] and len(other.rooms.plan.doors) == 2
    other.run()
    assert not other.rooms.switch.value and other.rooms.plan is None
    files.write_session(tmp_path / "no.segmap", files.Session(LOG, {}, edits={"edit": ["Paint 1"]}))
    with pytest.raises(ValueError, match="edit must be like"):
        other.open(tmp_path / "no.segmap")


def test_another_log_takes_the_map_of_the_one_before_from_the_page():
    """Catches a verdict, numbers and a drawing of one log under the name of another, a file of them
    in its name, and a run that ends when its log is no longer chosen."""
    made = done()
    outcome, other = made.outcome, Log("other", LOG.scans[:3], LOG.truth[:3])
    made.loops.open.value = True
    made.open(other)

    def is_empty():
        texts = made.verdict, made.extracted, made.figures, made.listing, made.chosen
        drawn = made.canvas.before + made.canvas.first + made.canvas.way + made.canvas.points
        assert not any(text.value for text in texts) and not drawn and not made.canvas.titles
        assert not made.loops.open.value and made.code == "" and made.canvas.summary == ""
        return repr(made) == "Workbench(other: not run yet)"

    assert is_empty() and made.state.value == "other: ready to run"
    made.files.children[0].click()
    assert made.state.value == "there is no map yet: press Run (or call run()) first"
    made._grown(LOG, outcome.alignment.poses[:, :2], np.zeros((1, 2)))
    made._show(LOG, outcome)
    assert is_empty() and list(made.runs["map"]) == [LOG.name]
    made.bring_back(0)
    assert made.outcome is outcome and made.canvas.before and made.log is LOG
    made.open(other)
    made.run()
    assert made.outcome.map.scan.max() == 2


# ------------------------------------------------------------------ what is seen


@pytest.fixture(scope="module")
def both():
    """A run of two methods."""
    return done(second="basic_online")


def test_a_segment_that_is_pointed_at_shows_its_members(both):
    """Catches members of the other method, and rows of the output for rows of the map."""
    outcome = both.outcome
    for which, index in ((0, 2), (1, 1)):
        rows = outcome.reductions[which].members(index)
        scans = {*outcome.map.scan[rows]}
        both.canvas.set_state({"pointed": [which, index]})
        assert both.canvas.members == rows.tolist() and len(rows) > len(scans)
        assert np.array_equal(both.point(index, which), outcome.map.segments[rows])
        assert f"segment {index}: " in both.chosen.value
        assert f"made of {len(rows)} segments of {len(scans)} scans" in both.chosen.value
    both.canvas.set_state({"pointed": [-1, -1]})
    assert both.canvas.members == [] and both.chosen.value == ""


def test_the_page_holds_what_came_of_it(both):
    """Catches a result in the place of another, rows that experiments cannot compare, and a run
    that asks for loops where there is no graph."""
    outcome, rows, found = both.outcome, both.runs, both.outcome.reductions
    for part, reduced in zip((both.canvas.first, both.canvas.second), found, strict=True):
        assert len(part) == 16 * len(reduced)
        assert f"{len(reduced)} of {len(outcome.map)} segments left" in both.figures.value
    assert outcome.verdict.doubled is not None and outcome.verdict.words in both.verdict.value
    assert list(rows["method"]) == ["fusion", "basic_online"]
    assert list(rows["n_after"]) == [len(each) for each in found]
    assert list(rows["quality"]) == [round(kept, 9) for kept in outcome.qualities]
    gone = [round(segmap.reduction_rate(outcome.map, each), 9) for each in found]
    assert list(rows["reduction"]) == gone
    assert set(rows["verdict"]) == {"good"} and set(rows["placed"]) == {len(LOG)}
    assert set(pareto(rows)["method"]) <= {"fusion", "basic_online"}
    assert list(Workbench(LOG).runs.columns) == list(rows.columns)


@pytest.mark.parametrize(("name", "end"), SAVES.items())
def test_the_browser_gets_the_result_in_every_format(both, name, end, tmp_path, monkeypatch):
    """Catches a button of another format, and one that writes the map before."""
    sent, found = [], both.outcome.reductions
    monkeypatch.setattr(both._worker, "do", lambda function, *given: function(*given))
    monkeypatch.setattr(type(both.canvas), "save", lambda self, *given: sent.append(given))
    (button,) = (b for b in both.files.children if b.description == name)
    button.click()
    both.wait()
    both.export(tmp_path / f"simulated-fusion{end}")
    files = sorted(tmp_path.iterdir())
    assert len(files) == (2 if end == ".yaml" else 1)
    assert sent == [(path.name, path.read_bytes()) for path in files]
    both.export(tmp_path / "map.npz")
    assert len(readers.read_segments(tmp_path / "map.npz")) == len(found[0])
