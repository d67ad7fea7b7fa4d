"""Parts of the workbench by themselves: its bar, its pictures and words, what a browser is told."""

import threading
from copy import deepcopy
from dataclasses import replace
from html import escape
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from driven_panels import LOG, WALLS
from matplotlib.figure import Figure

import segmap
from segmap import LaserScan, Log, SegmentMap, reduction
from segmap.compiled import COMPILING
from segmap.display import facts
from segmap.metrics import grade_quality, grade_reduction
from segmap.plotting import MAP, RAW, RESULT, draw_segments, figure_png, map_axes
from segmap.progress import Compiling
from segmap.scans import Skipped
from segmap_app.page import Workbench, _bar, _loops, _shown
from segmap_app.page._bar import Bar
from segmap_app.page._browser import Upload
from segmap_app.page._edits import Edits
from segmap_app.page._loops import Loops
from segmap_app.page._source import OWN, Source


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


def test_the_bar_goes_on_while_nothing_is_told(monkeypatch):
    bar, lives, ticks = Bar(), iter([True] * 5 + [False] * 2), []
    monkeypatch.setattr(bar, "tick", lambda: ticks.append("tick"))
    bar.watch(SimpleNamespace(is_alive=lambda: next(lives), join=ticks.append))
    assert ticks == [1.0, "tick", 1.0, "tick", 1.0]


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


def test_what_a_browser_must_know_is_sent_to_it():
    """Catches a picture of yesterday: a trait that is set here and never synchronised."""
    made, asked, sent = Workbench(LOG), [], []
    nothing = {"pointed": [-1, -1], "members": [], "shown": "after", "size": [1, 1], "titles": []}
    nothing |= {**dict.fromkeys(["before", "first", "second", "way"], b""), "looked_at": []}
    assert {"_esm", "drawing", *nothing} <= {*made.canvas.keys} and Edits().value() == {}
    assert not any(text.continuous_update for text in Edits().controls[1:])
    assert {name: getattr(made.canvas, name) for name in nothing} == nothing
    made.canvas.send = lambda *given: asked.append(given)
    made.canvas.save("a.csv", b"1,2")
    assert asked.pop() == ({"name": "a.csv"}, [b"1,2"])
    upload = Upload("choose", 7, lambda *given: asked.append(given) or 3)
    upload.send = sent.append
    assert {"description", "most", "_esm"} <= {*upload.keys}
    assert (upload.description, upload.most) == ("choose", 7)
    upload._handle_custom_msg({"name": "a", "size": "9", "start": "2"}, [memoryview(b"xy")])
    upload._handle_custom_msg({"name": 1, "size": 9, "start": 4}, [])
    assert asked == [("a", 9, 2, b"xy"), ("1", 9, 4, b"")] and sent == [{"next": 3}] * 2


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


def test_a_new_map_without_loops_shows_its_own_scans(monkeypatch):
    """Catches a picture that stays of the map before."""
    rows, drawn = pd.DataFrame({"first": [2], "second": 7, "residual": 1.0, "metres": 9.0}), []
    monkeypatch.setattr(_loops, "overlaid", lambda *given: str(drawn.append(given)))
    loops = Loops(Edits(), lambda way, scans: drawn.append(scans), str)
    loops.open.value = True
    for table, count in ((rows, 9), (rows[:0], 5)):
        found = SimpleNamespace(graph=rows, poses=np.zeros((9, 3)), loops=table.copy)
        made = SimpleNamespace(log=range(count), alignment=found)
        loops.show(made)
        assert drawn[-2:] == [[2, min(7, count - 1)], (made, 2, min(7, count - 1))]


# ------------------------------------------------------------------ words and pictures


@pytest.fixture
def outcome():
    """What a run of two methods leaves."""
    calls = [SimpleNamespace(name="fusion", words=lambda: "tolerance <2>")]
    calls += [SimpleNamespace(name="odd & even", words=str)]
    some = [reduction.fusion(WALLS, tolerance=0.2), reduction.fusion(WALLS, tolerance=0.001)]
    some[1] = replace(some[1], segments=2 * some[1].segments, doubt="a < b")  # beyond the map
    some = [replace(each, seconds=k + 1.0) for k, each in enumerate(some)]
    found = list(zip(calls, some, (0.9, 0.5), strict=True))
    return SimpleNamespace(
        map=WALLS,
        recipe=SimpleNamespace(align=SimpleNamespace(name="by <hand>")),
        alignment=SimpleNamespace(seconds=1.25, doubt="a & b"),
        verdict=SimpleNamespace(grade="doubtful", words="HALF <a> map"),
        reductions=some,
        results=lambda: found,
    )


def test_what_is_said_of_a_run_letter_by_letter(outcome):
    """Catches a mark of HTML that works, a line that is lost, and a colour of another verdict."""
    lines = '<div style="line-height: 1.45; overflow-x: auto; max-width: 100%">'
    assert _shown.heading("1 <Log>") == (
        '<h2 style="font-size: 15px; margin: 6px 0 2px">1 &lt;Log&gt;</h2>'
    )
    many = [len(each) for each in outcome.reductions]
    assert _shown.titles(outcome) == [
        "before: 5 segments",
        f"fusion: {many[0]}",
        f"odd & even: {many[1]}",
    ]
    assert _shown.verdict_html(outcome) == (
        '<div style="border-left: 12px solid #c47f00; padding: 3px 9px; line-height: 1.45">'
        f"<b>HALF &lt;a&gt; map</b></div>{lines}a &amp; b<br>by &lt;hand&gt;, 1.2 s</div>"
    )
    said = []
    for k, (name, kept) in enumerate([("fusion (tolerance <2>)", 0.9), ("odd & even ()", 0.5)]):
        rate = segmap.reduction_rate(WALLS, outcome.reductions[k])
        graded = f"reduction {rate:.1%}, {grade_reduction(rate)}; quality {kept:.1%}, "
        graded += f"{grade_quality(kept)}; {1 + k}.000 s"
        said.append(f"{name}: {many[k]} of 5 segments left, {graded}")
    assert _shown.left(outcome) == f"{lines}{'<br>'.join(map(escape, [*said, 'a < b']))}</div>"
    told = [f"<b>{LOG.name if k == 'scans' else k}</b> {escape(v)}" for k, v in facts(LOG)]
    assert _shown.about_html(LOG) == f"{lines}{'<br>'.join(told)}</div>"
    code = _shown.code("a < b")
    assert code.startswith("<pre style=") and ">a &lt; b</pre>" in code
    assert code.endswith('</pre><button class="jupyter-button segmap-copy">Copy</button>')


def test_numbers_and_bars_of_the_table():
    for share, full in ((0.256, 25.6), (-0.5, 0.0), (1.5, 100.0), (np.nan, 0.0), (0.0, 0.0)):
        assert _shown._bar(share) == (
            '<td style="text-align: right; min-width: 90px; color: black; background: '
            f'linear-gradient(90deg, #bfdcec {full:.1f}%, #f0f0f0 {full:.1f}%)">{share:.1%}</td>'
        )
    row = {"map": "m", "method": "f", "thresholds": "<t>", "alignment": "a", "quality": 1.0}
    row |= {"n_before": 9, "n_after": 4, "seconds": 0.5, "reduction": 0.5}
    words = ("reduction", "quality", "run", "method", "thresholds", "left", "of", "seconds")
    head, *found = _shown.runs_table([row] * 10).removesuffix("</table></div>").split("<tr>")[1:]
    assert head == "".join(f"<th>{word}</th>" for word in (*words, "log", "alignment")) + "</tr>"
    right = '<td style="text-align: right">'
    said = f"<td>f</td><td>&lt;t&gt;</td>{right}4</td>{right}9</td>{right}0.500</td>"
    said += "<td>m</td><td>a</td></tr>"
    bars = _shown._bar(0.5) + _shown._bar(1.0)
    assert found == [f"{bars}{right}{k}</td>{said}" for k in range(9, 1, -1)]


def test_the_still_picture_is_that_of_the_library(outcome):
    """Catches a map that is lost, one that is drawn in another colour, and another size."""
    figure = Figure((648 / 72, 320 / 72), dpi=72, layout="constrained")
    axes = figure.subplots(1, 3, sharex=True, sharey=True)
    draw_segments(WALLS, ax=axes[0], color=MAP, width=0.7)
    for ax, reduced in zip(axes[1:], outcome.reductions, strict=True):
        draw_segments(SegmentMap(WALLS.segments), ax=ax, color=RAW, width=0.7)
        draw_segments(reduced, ax=ax, color=RESULT, width=1.5)
    for ax, title in zip(axes, _shown.titles(outcome), strict=True):
        map_axes(ax).set_title(title, fontsize="medium")
        ax.label_outer()
    assert _shown.still(outcome) == figure_png(figure)


def test_a_log_in_words():
    scans = [LaserScan([1.0, 2.0], [0.0, 0.5]), LaserScan([1.0], [0.0])]
    assert facts(Log("<b>", scans, skipped=Skipped(2, "line 7: no number"))) == [
        ("scans", "2 scans, without times"),
        ("beams", "1 to 2 a scan, 100.0 % of them valid"),
        ("view", "28.65 degrees, 28.6 from beam to beam"),
        ("ranges", "1.00 to 2.00 m, half of them below 1.00 m"),
        ("odometry", "none"),
        ("truth", "none"),
        ("damaged", "2 lines left out; line 7: no number"),
    ]


# ------------------------------------------------------------------ where a log comes from


@pytest.fixture
def source():
    """A source of logs, what it took, what it said, and what it asked of the worker."""
    took, begun, bar = [], [], Bar()
    made = Source(LOG, lambda *given: took.append(given), bar, lambda *given: begun.append(given))
    return made, took, bar, begun


def test_a_log_is_taken_by_its_name_its_path_or_itself(source, tmp_path, monkeypatch):
    """Catches Python that gives another log, and a list that names a log of one's own."""
    made, took, _, begun = source
    bundled, path, upload = made.controls
    assert took == [(LOG, None)] and bundled.value == OWN == bundled.options[0]
    assert made.expression == f"log  # {LOG.name!r}, the one given to Workbench"
    assert list(bundled.options[1:]) == sorted(made.names) and "malaga" in made.names
    assert [each.description for each in made.controls] == [
        *("bundled log", "or its path", "or upload it")
    ]
    assert not path.continuous_update and upload.most == 100_000_000
    bundled.value = "room"
    assert made.expression == "segmap.load('room')" and made.log.name == "room"
    assert len(took) == 2 and made.about.value == _shown.about_html(made.log)
    bundled.value = OWN
    assert len(took) == 2 and begun == []
    bundled.value = "room"
    assert len(took) == 2, "it is there already"
    monkeypatch.chdir(tmp_path)
    path.value = "x.log"
    ((function, given, then, failed),) = begun
    assert given == (str(tmp_path), "x.log") and function.__name__ == "_read_in_folder"
    failed("x.log: <is> none")
    assert (made.ready, made.about.value) == (False, "no log: choose one")
    assert made.wrong.value == "x.log: &lt;is&gt; none" and made.log.name == "room"
    bundled.value = "room"  # the same one, chosen anew
    assert made.ready and made.wrong.value == ""
    then(LOG)
    assert made.expression == "segmap.read('x.log', on_error=\"skip\")" and bundled.value == OWN
    path.value = ""
    assert len(begun) == 1
    with pytest.raises(ValueError, match="must hold one scan at least, got none"):
        made.open(LOG[:0])
    assert made.log is LOG


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
    assert made.take("one.log", 1, 0, b"x") == -1 and bar.bar.value == 1
    made.stop()
    made.stop()
    assert made.take("b.log", 9, 4, b"x") == -1 and len(begun) == 3 and made.log is LOG
    assert made.take("b.log", 100_000_000, 0, b"x") == 1
    assert made.take("a\0/b.log", 100_000_001, 1, b"x") == -1
    larger = "larger ones by their path"
    assert made.wrong.value == f"b.log has 100.0 MB: only a file up to 100 MB; {larger}"
    assert bar.state.value == "refused: the reason stands in red beside its cause"


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


@pytest.mark.parametrize("left_out", ["veto", "tie", "square", "crop", "place", "north", "crs"])
def test_edits_are_those_of_the_last_session_alone(left_out):
    """Catches an edit of the map before that stays, and entries that change their places."""
    held = {"veto": ["1-9"], "tie": ["2-8"], "square": True, "crop": [0.0, -1.0, 4.5, 3.0],
            "place": [36.7, -4.4], "north": [60.0], "crs": "EPSG:25832"}  # fmt: skip
    edits = Edits()
    edits.restore(held)
    assert edits.value() == held and edits.place.value == "36.7 -4.4"
    assert [entry.description for entry in (edits.crop, edits.place, edits.north)] == [
        "crop [m]", "place of (0, 0)", "north [degrees]",
    ]  # fmt: skip
    edits.restore({k: v for k, v in held.items() if k != left_out})
    assert edits.value() == {k: v for k, v in held.items() if k != left_out}
    edits.restore({})
    assert edits.value() == {}
