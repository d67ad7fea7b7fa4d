"""Hostile names, words and values through every field of the page: shown, they do nothing."""

import json
from dataclasses import replace
from html.parser import HTMLParser

import ipywidgets as W
import pytest
from driven_panels import LOG
from input_samples import text_samples, value_samples
from segmap_course.exercises import Check

from segmap.methods import Method
from segmap.panels import LivePanel, ScanPanel
from segmap.reduction import Methods, fusion
from segmap.scans import Skipped
from segmap.scans.causes import Cause, Finding
from segmap_app.files import Session, write_session
from segmap_app.page import Workbench, _job, _shown

TAGS = {"b", "br", "button", "div", "h1", "h2", "img", "pre"}
TAGS |= {"table", "thead", "tbody", "tr", "th", "td"}
TEXTS = text_samples()
#: Marks of HTML and another folder in one name; what moves the cursor of a terminal.
TOGETHER = TEXTS[2] + TEXTS[3] + TEXTS[8], TEXTS[7]
ROW = {
    **{"map": "m", "alignment": "a", "align_thresholds": "", "align_seconds": 1.0},
    **{"extraction": "e", "extract_thresholds": "", "filtered": 0, "verdict": "good"},
    **{"placed": 1.0, "method": "f", "thresholds": "", "n_before": 9, "n_after": 4},
    **{"reduction": 0.5, "quality": 1, "seconds": 1},
}


class Seen(HTMLParser):
    """What a browser makes of HTML: its text; a tag or an attribute that is not ours fails."""

    def __init__(self, text):
        super().__init__()
        self.text = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        assert tag in TAGS, f"<{tag}> is none of ours"
        for name, value in attrs:
            ours = name in ("style", "alt", "class", "border") or tag == "button"
            assert ours or value.startswith("data:image/png;base64,"), (tag, name, value)
            assert "window.hit" not in value

    def handle_data(self, data):
        self.text += data


def widgets(part):
    """A part of the page and all that lie in it."""
    return [part, *(each for child in getattr(part, "children", ()) for each in widgets(child))]


def said(panel):
    """All text that a browser shows, after a look at all that it is sent."""
    texts = []
    for part in widgets(panel._view):
        sent = {k: v for k, v in part.get_state().items() if isinstance(v, str | list | tuple)}
        json.dumps(sent, ensure_ascii=False, default=str, allow_nan=False).encode("utf-8")
        assert not getattr(part, "description_allow_html", False)
        texts.append(Seen(part.value).text if isinstance(part, W.HTML | W.HTMLMath) else "")
    repr(panel).encode("utf-8")
    assert repr(panel).isprintable()
    return "\n".join(texts)


def escaped(text):
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


@pytest.fixture
def page(monkeypatch):
    """A workbench that works in this process: it is what it shows that counts."""
    made = Workbench(LOG)
    monkeypatch.setattr(made._worker, "do", lambda function, *given: function(*given))
    made.align.value, made.method.value = "ground_truth", "fusion"
    return made


@pytest.mark.parametrize("text", [*TOGETHER, "\udcff half a letter \ud800"])
def test_the_name_of_a_log_is_only_a_name(text, page, monkeypatch):
    """Catches a name that is shown raw, and one that leads a download to another folder."""
    page.open(replace(LOG, name=text))
    assert f"{escaped(text)}: ready to run" in said(page)
    page.run()
    shown = said(page)
    assert shown.count(escaped(text)) >= 2, "about the log, and in the table of the runs"
    files = []
    monkeypatch.setattr(page.canvas, "save", lambda name, content: files.append(name))
    for button in page.files.children:
        button.click()
        page.wait()
    assert len(files) == len(page.files.children) + 1, page.state.value  # a ROS map has two
    for name in files:
        assert not {*"/\\"} & {*name} and name.isprintable()
    for panel in (LivePanel(page.log), ScanPanel(page.log)):
        said(panel)


@pytest.mark.parametrize("text", TOGETHER)
def test_what_is_typed_or_uploaded_is_only_text(text, page, tmp_path, monkeypatch):
    """Catches a refusal that hands on what it refuses."""
    monkeypatch.chdir(tmp_path)
    page.run()
    for typed in (True, False):
        if typed:
            page.path.value = text
        else:
            page._source.take(text, 3, 0, b"abc")
        page.wait()
        assert page.state.value and "done" not in said(page)
        page._bar.say("done")
    for name in ("crop", "place", "north", "crs"):
        getattr(page.edits, name).value = text
        page.wait()
        assert "got" in said(page) or "need a place" in said(page), name
        getattr(page.edits, name).value = ""
        page.wait()
    page._bar.tell(0.5, f"reading {text}")
    assert escaped(text) in said(page)

    def fail(*given):
        raise _job.Failed(text)

    monkeypatch.setattr(page._worker, "do", fail)
    page.start.click()
    page.wait()
    assert escaped(text) in said(page)


@pytest.mark.parametrize("text", TOGETHER)
def test_all_words_of_a_session_are_only_words(text, page, tmp_path):
    """Catches a doubt, a damage, a choice, a loop or a cell of the table that is shown raw."""
    log = replace(
        LOG, name=text, skipped=Skipped(2, text), causes=[Finding(Cause.OTHER, 1, text, text, True)]
    )
    runs = [{k: text if isinstance(v, str) else v for k, v in ROW.items()}]
    edits = {"veto": [text], "tie": [text], "crop": [text], "crs": text, "place": {text: text}}
    write_session(tmp_path / "it.segmap", Session(log, {"align": "ground_truth"}, runs, edits))
    page.open(tmp_path / "it.segmap")
    shown = said(page)
    assert f"left out; {escaped(text)}" in shown and f"{escaped(text)}: ready" in shown
    assert len(page.runs) == 1 and shown.count(escaped(text)) >= 6
    page.start.click()
    page.wait()
    said(page)  # refused, with what was refused
    page.edits.restore({})
    page.run()
    assert f"{escaped(text)}: {escaped(text)}" in said(page), "the doubt, below the verdict"
    for wrong in ({"method": text}, {text: text}, {"align": "ground_truth", "tolerance": text}):
        session = Session(LOG, wrong)
        write_session(tmp_path / "it.segmap", session)
        page.path.value = ""
        page.path.value = str(tmp_path / "it.segmap")
        page.wait()
        said(page)


def test_a_row_that_lacks_a_column_is_left_out_and_told(page, tmp_path):
    """Catches the figures of a command, which are no row, and a cell that is shown raw."""
    for value in value_samples():
        row = {name: value for name, cell in ROW.items() if isinstance(cell, str)}
        Seen(_shown.runs_table([ROW | row]))
    write_session(tmp_path / "it.segmap", Session(LOG, {}, [ROW | {"more": [TEXTS[0]]}]))
    page.open(tmp_path / "it.segmap")
    assert page.runs.to_dict("records") == [ROW], "what is no column is not kept"
    assert "left out" not in page.state.value
    lacking = [{k: v for k, v in ROW.items() if k != left} for left in ROW]
    write_session(tmp_path / "it.segmap", Session(LOG, {}, [ROW, *lacking]))
    page.open(tmp_path / "it.segmap")
    assert f"; {len(ROW)} of its {len(ROW) + 1} runs left out: no row of a run" in said(page)
    assert page.runs.to_dict("records") == [ROW]


@pytest.mark.parametrize("value", value_samples()[::3])
def test_a_choice_of_another_type_is_refused_and_the_log_is_kept(value, page, tmp_path):
    """Catches a session that ends the page in another error, or of which a half is taken."""
    names = ("align", "method", "second", "filter", "seen_through", "no_deskew", "mount")
    names += ("mount_auto", "keep_body", "mask", "tolerance", "align_step", "extract_gap")
    held = [({name: value}, {}) for name in names]
    held += [({}, {name: value}) for name in ("veto", "tie", "square", "crop", "place", "north")]
    for settings, edits in held:
        session = Session(replace(LOG, name="other"), settings, (), edits)
        write_session(tmp_path / "it.segmap", session)
        before = page.log
        try:
            page.open(tmp_path / "it.segmap")
        except ValueError as fault:
            assert page.log is before, fault
        else:
            assert page.log.name == "other"
            page.open(LOG)
        said(page)


@pytest.mark.parametrize("text", TEXTS)
def test_tables_and_answers_in_a_notebook_are_only_text(text):
    """Catches a `_repr_html_` that hands on what it was given."""
    assert text in Seen(Check("it", False, text)._repr_html_()).text
    method = Method(fusion, text, merges=text, keeps=text)
    assert Seen(Methods(it=method)._repr_html_()).text.count("window.hit") in (0, 3)
