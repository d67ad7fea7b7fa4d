"""Parts of the workbench by themselves: its bar, its pictures and words, what a browser is told."""

import threading
from copy import deepcopy
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from driven_panels import LOG

from segmap.compiled import COMPILING
from segmap.progress import Compiling
from segmap_app.page import Workbench, _bar, _shown
from segmap_app.page._bar import Bar
from segmap_app.page._edits import Edits
from segmap_app.page._runs import COLUMNS, Runs
from segmap_app.page._source import Source


def test_each_word_of_the_bar(monkeypatch):
    """Catches a time that is told too early, of another kind of work, or after a step back."""
    bar, clock = Bar(), [5.0]
    monkeypatch.setattr(_bar.time, "monotonic", lambda: clock[0])
    for at, share, words, said in (
        (100.0, 0.0, "aligning 3 scans", "aligning 3 scans ..."),
        (101.9, 0.5, "aligning 3 scans", "aligning 3 scans ..."),
        (102.0, 0.5, "aligning 4 scans", "aligning 4 scans, 2 s left"),
        (110.0, 0.8, "aligning 4 scans", "aligning 4 scans, 2 s left"),
        (111.0, 0.7, "aligning 4 scans", "aligning 4 scans ..."),
        (113.0, 0.7, "aligning 4 scans", "aligning 4 scans, 1 s left"),
        (114.0, 0.8, "reducing <b>", "reducing &lt;b&gt; ..."),
        (200.0, 0.0, "measuring", "measuring ..."),
        (202.0, 0.049, "measuring", "measuring, 2 s so far"),
        (204.0, 0.05, "measuring", "measuring, 76 s left"),
        (300.0, 0.05, Compiling(f"{COMPILING}: 3 loops"), f"{COMPILING}: 3 loops ..."),
        (330.0, 0.50, Compiling(f"{COMPILING}: 9 loops"), f"{COMPILING}: 9 loops ..."),
        (331.0, 0.01, "measuring", "measuring ..."),
        (331.0, 0.05, "measuring", "measuring ..."),
    ):
        clock[0] = at
        bar.tell(share, words)
        assert (bar.state.value, bar.bar.value) == (said, share)
    bar.say("a < b")
    assert (bar.state.value, bar.bar.value, bar.bar.max) == ("a &lt; b", 0.05, 1)
    bar.say("done", 1.0)
    bar.tell(0.5, "measuring")
    assert (bar.state.value, bar.bar.value) == ("measuring ...", 0.5), "begun anew"
    assert "segmap-state" in bar.state._dom_classes


def test_the_last_word_is_the_last():
    """Catches a tick of a thread that has not ended yet, and one that had begun before the end."""

    class Slow(str):
        """Words in whose midst the other thread goes on."""

        def __format__(self, how):
            begun.set()
            ended.wait(0.5)  # for ever, where the last word waits for the tick
            return str(self)

    begun, ended = threading.Event(), threading.Event()
    for last in ("say", "wrong"):
        bar = Bar()
        bar.tell(0.5, "reading line 153000")
        getattr(bar, last)("done", 1.0)
        bar.tick()
        assert (bar.state.value, bar.bar.value) == ("done", 1.0)
        assert ("segmap-wrong" in bar.state._dom_classes) == (last == "wrong")

        ended.set()
        bar.tell(0.5, Slow("reading line 153000"))
        begun.clear(), ended.clear()
        late = threading.Thread(target=bar.tick)
        late.start()
        assert begun.wait(10)
        getattr(bar, last)("done", 1.0)
        ended.set()
        late.join()
        assert (bar.state.value, bar.bar.value) == ("done", 1.0)


def test_the_latest_runs_come_back():
    """Catches one fewer than the table promises, and a first one that never goes."""
    runs, row = Runs(), dict.fromkeys(COLUMNS, 1)
    for k in range(_shown.LATEST + 1):
        rows = [row | {"n_after": k}]
        runs.add(SimpleNamespace(given=LOG, rows=lambda name, rows=rows: rows))
    assert [*runs.made] == [*range(1, _shown.LATEST + 1)]


def test_maps_go_to_the_browser_about_their_middle():
    """Catches a building far from the origin that single floats would crumble, swapped maps."""
    canvas = Workbench(LOG).canvas
    walls = np.array([[(1.0, 5.0), (3.0, 5.0)], [(1.0, 6.0), (2.0, 9.0)]]) + 1e8
    canvas.pointed, canvas.members = [0, 1], [2]
    canvas.show(walls, [walls[:1], walls[1:]], ["x", "y", "z"])
    found = [
        np.frombuffer(part, np.float32) for part in (canvas.before, canvas.first, canvas.second)
    ]
    assert found[0].tolist() == [-1, -2, 1, -2, -1, -1, 0, 2]
    assert [part.tolist() for part in found[1:]] == [[-1, -2, 1, -2], [-1, -1, 0, 2]]
    assert (canvas.size, canvas.titles) == ([2, 4], ["x", "y", "z"])
    assert (canvas.pointed, canvas.members) == ([-1, -1], [])
    canvas.show(walls, [walls], ["x", "y"])
    assert canvas.second == b"" and len(canvas.first) == 32


# ------------------------------------------------------------------ words and pictures


# ------------------------------------------------------------------ where a log comes from


@pytest.fixture
def source():
    """A source of logs, what it took, what it said, and what it asked of the worker."""
    took, begun, bar = [], [], Bar()
    made = Source(
        LOG, lambda *given: took.append(given), bar, lambda *given, words="": begun.append(given)
    )
    return made, took, bar, begun


def test_pieces_of_a_file_are_put_together(source):
    """Catches a piece that is lost or taken twice, and a file that stays when it is stopped."""
    made, _, bar, begun = source
    assert made.take("a/b.log", 4_000_000, 0, b"x" * 2_000_000) == 2_000_000
    assert (bar.state.value, bar.bar.value) == ("uploading b.log, 2 of 4 MB ...", 0.5)
    assert made.take("b.log", 4_000_000, 1_000_000, b"x" * 9) == 2_000_000, "go on from here"
    assert made.take("b.log", 4_000_000, 2_000_000, b"y" * 2_000_000) == -1
    ((_, (folder, name), *_),) = begun
    kept = made._folder
    assert (folder, name) == (kept, "b.log")
    assert (Path(kept) / "b.log").read_bytes() == b"x" * 2_000_000 + b"y" * 2_000_000
    assert made.take("", 0, 0, b"") == -1 and begun[1][1][1] == "upload.log"
    assert made.take("one.log", 1, 0, b"x") == -1 and bar.state.value == "reading one.log ..."
    made.stop()
    made.stop()
    assert made.take("b.log", 9, 4, b"x") == -1 and len(begun) == 3 and made.log is LOG
    assert made.take("b.log", 100_000_000, 0, b"x") == 1
    assert made.take("a\0/b.log", 100_000_001, 1, b"x") == -1
    larger = "larger ones by their path"
    assert bar.state.value == f"b.log has 100.0 MB: only a file up to 100 MB; {larger}"


def test_edits_share_no_list_with_a_session():
    """In neither direction: neither what is restored, nor what is handed out.

    Catches loops that are left out on the page and change the session that it was opened from.
    """
    held = {"veto": ["1-9"], "tie": ["2-8"], "crop": [0, -1, 4.5, 3], "north": 60, "square": True}
    before, edits = deepcopy(held), Edits()
    edits.restore(held)
    value, kept = edits.value(), edits.value()
    assert value == before | {"north": [60.0]}
    for loops in (edits.veto, edits.tie):
        loops.append("3-7")
    assert held == before and value == kept
    assert edits.value()["veto"] == ["1-9", "3-7"]
    for name in ("veto", "tie", "crop"):
        edits.value()[name].clear()
    assert edits.value() == value | {"veto": ["1-9", "3-7"], "tie": ["2-8", "3-7"]}
