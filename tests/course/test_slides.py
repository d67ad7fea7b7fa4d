"""Slides of a lab: all of its figures and formulas, whole sentences, nothing from elsewhere."""

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


@pytest.fixture(scope="module")
def made():
    """Chapter -> its notebook and its slides."""
    books = {path.name: nbformat.read(path, as_version=4) for path in CHAPTERS}
    return {name: (book, list(slides.slides(book))) for name, book in books.items()}


def test_a_task_of_work_has_no_stub_and_no_answer_on_a_slide(made):
    """Catches a stub, or the points of a rubric, taken for a method or a table."""
    for name, (_, found) in made.items():
        assert not any("def my_" in slide.shown for slide in found), name
        asked = [slide for slide in found if slide.heading in ("Exercise", "Decide")]
        assert all("<img " in slide.shown for slide in asked), name
