"""Slides of a lab: all of its figures, whole sentences, no code, nothing from elsewhere."""

import re
import sys

import nbformat
import pytest
from chapter_rules import CHAPTERS
from makefile import ROOT

sys.path.insert(0, str(ROOT / "notebooks" / "tools"))
pytest.importorskip("sphinx")
slides = pytest.importorskip("slides")


def chapter(number):
    (path,) = (path for path in CHAPTERS if path.name.startswith(number))
    return path, nbformat.read(path, as_version=4)


def test_a_lab_becomes_slides():
    """Catches a figure that is lost or that nobody tells, code, and a link that needs a network."""
    path, notebook = chapter("07")
    page = slides.page(path)
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    drawn = sum("image/png" in output.get("data", {}) for output in outputs)
    assert page.count('src="data:image/png') == page.count("<img ") == drawn > 3
    assert len(re.findall(r'<img alt="[^"]+"', page)) == drawn
    assert "<h1>07 ICP</h1><p><strong>The robot comes back to a door" in page
    assert not re.search(r"plt\.|import |href=|https?:(?!//www.w3.org)", page)
    assert page.count("<section") == page.count("</section>") == len(list(slides.slides(notebook)))


def test_each_section_says_a_whole_sentence():
    """Catches what stands above a heading and is taken for its idea, and a sentence cut in bold."""
    _, notebook = chapter("57")
    said = {slide.heading: slide.sentences[0] for slide in slides.slides(notebook)}
    assert said["A wrong pair"].startswith("A wall has two sides")
    assert all(sentence.count("**") % 2 == 0 for sentence in said.values())
    assert not any(sentence.endswith("?") for sentence in said.values())


def test_the_last_slide_holds_the_points_of_the_summary():
    """Catches one that says where to go back to, and nothing of the chapter."""
    _, notebook = chapter("91")
    *_, last = slides.slides(notebook)
    assert last.heading == "Summary" and len(last.sentences) > 2
    assert all(f"- {point}" in notebook.cells[-1].source for point in last.sentences)


def test_a_printed_method_is_shown():
    path, _ = chapter("91")
    assert "<pre>def polyline_through(" in slides.page(path)
