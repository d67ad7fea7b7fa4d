"""What the book makes of chapters and texts, before Sphinx sees them."""

import nbformat
import pytest
from chapter_rules import CHAPTERS, ROOT
from conftest import later
from segmap_course import FIGURE_MIME

sources, citations, api = later("book.sources"), later("book.citations"), later("book.api")
extension, commands = later("book.extension"), later("book.commands")


@pytest.mark.parametrize(
    ("text", "adapted"),
    [
        ("see chapter 17.", "see [chapter 17](/notebooks/17_fusion.ipynb)."),
        ("[chapter 17](17_fusion.ipynb)", "[chapter 17](17_fusion.ipynb)"),
        ("`chapter 17` and $chapter 17$", "`chapter 17` and $chapter 17$"),
        ("chapter 7, chapter 98 and chapter 5.2", "chapter 7, chapter 98 and chapter 5.2"),
        ("```\nchapter 17\n```", "```\nchapter 17\n```"),
        ("A 4.4.4 and B 4.2", "[A 4.4.4](#thesis-a) and [B 4.2](#thesis-b)"),
        ("a wall (Censi 2008)", "a wall ([Censi 2008](#censi-2008))"),
        ("Brenna (2007, here", "[Brenna (2007](#thesis-b), here"),
        ("Amigoni, Fontana 2006", "[Amigoni, Fontana 2006](#amigoni-2006-size)"),
        ("Intel 2009, Censi 2007", "Intel 2009, Censi 2007"),
    ],
)
def test_what_is_named_is_linked(text, adapted):
    """Catches links inside links, code and formulas, and pages that are not there."""
    assert sources.adapt(text) == adapted


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda path: path.stem.partition("_")[0])
def test_a_chapter_is_adapted(path):
    """Catches code that does not fold, and a panel that stays a still below 'move the slider'."""
    before = nbformat.read(path, as_version=4)
    chapter = sources.read_chapter(path, {})
    assert all("old" not in said for said in chapter.complaints)
    panels = str(before).count(f"'{sources.VIEW}'") - str(before).count(f"'{FIGURE_MIME}'")
    assert len(chapter.complaints) == panels
    after = chapter.notebook
    shown = [cell for cell in before.cells if "guard" not in cell.metadata.get("tags", [])]
    assert sources.VIEW not in str(after) and len(after.cells) == len(shown)
    assert FIGURE_MIME not in str(after)
    code = [cell for cell in after.cells if cell.cell_type == "code" and cell.source.strip()]
    assert all("hide-input" in cell.metadata.tags for cell in code)


def test_a_panel_becomes_a_slider_of_its_states(tmp_path):
    """Catches pictures that are older than the chapter, and a slider that begins elsewhere."""
    shown = {"text/plain": "FusionPanel(tolerance 0.04 m: 2 left)", sources.VIEW: {}}
    output = nbformat.v4.new_output("display_data", data=shown)
    cell = nbformat.v4.new_code_cell("panel", outputs=[output], execution_count=1)
    path = tmp_path / "17_fusion.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=[cell]), path)
    states = {"17_fusion-1": ["tolerance 0.01 m: 9 left", "tolerance 0.04 m: 2 left"]}
    chapter = sources.read_chapter(path, states)
    assert chapter.complaints == []
    html = chapter.notebook.cells[0].outputs[0].data["text/html"]
    assert all(said in html.partition("<figure>")[0] for said in states["17_fusion-1"])
    assert html.count("tolerance 0.04 m: 2 left") == 3  # in the list, as alt text, and below
    assert "object-position: 0 100%" in html and 'max="1" value="1"' in html
    stale = sources.read_chapter(path, {"17_fusion-1": ["tolerance 0.04 m: 3 left"]})
    assert stale.complaints == ["17_fusion: pictures of panel 1 are old: make panels"]


def in_the_new_form(path):
    """A chapter with a prediction, its answer and a figure to drag, twice; as the book has it."""
    new = nbformat.v4
    figure = {"text/plain": "DragScan(<3)", "image/png": "a", sources.VIEW: {}}
    figure[FIGURE_MIME] = {"module": "scan_on_scan", "state": '{"pose":[1,2]}'}
    shown = [new.new_output("display_data", data=data) for data in (figure, {"text/plain": "4"})]
    cells = [
        new.new_markdown_cell("# 97 A try\n\n**How many?**"),
        new.new_code_cell("predicted = None  # steps", metadata={"tags": ["predict"]}),
        *(new.new_code_cell("figure", outputs=shown[:1]) for _ in range(2)),
        new.new_code_cell("answer", outputs=shown[1:], metadata={"tags": ["reveal"]}),
        new.new_markdown_cell("## Summary\n\nIt is\n`few`.\n\nNext: nothing."),
    ]
    for number, cell in enumerate(cells[1:-1]):
        cell.execution_count = number + 1
    nbformat.write(new.new_notebook(cells=cells), path)
    return sources.read_chapter(path, {})


def test_a_chapter_in_the_new_form_asks_and_folds(tmp_path):
    """Catches an answer that is seen at once, a module twice on a page, a state that is lost."""
    (tmp_path / "notebooks").mkdir()
    (tmp_path / "_static").mkdir()
    chapter = in_the_new_form(tmp_path / "notebooks" / "97_a_try.ipynb")
    _, asked, first, second, answer, _ = chapter.notebook.cells
    assert chapter.complaints == [] and asked.cell_type == "markdown"
    assert '<input type="number"' in asked.source and "> steps</label>" in asked.source
    assert {"hide-output", "hide-input"} <= set(answer.metadata.tags)
    first, second = (cell.outputs[0].data["text/html"] for cell in (first, second))
    assert 'id="figure-scan_on_scan">' in first and "<script" not in second
    assert "function measure" in first and "DragScan(&lt;3)" in second
    assert 'data-state="{&quot;pose&quot;:[1,2]}"' in second
    sources.write_summaries(tmp_path)  # what the search shows is the claim, and not the question
    assert '"It is few."' in (tmp_path / "_static" / "summaries.js").read_text()


# ------------------------------------------------------------------ formulas


def test_every_formula_of_the_chapters_can_be_shown():
    """Catches a command that the converter does not know and would print as it stands."""
    from markdown_it import MarkdownIt
    from mdit_py_plugins.amsmath import amsmath_plugin
    from mdit_py_plugins.dollarmath import dollarmath_plugin

    reader = MarkdownIt().use(dollarmath_plugin).use(amsmath_plugin)
    texts = [
        cell.source
        for path in CHAPTERS
        for cell in nbformat.read(path, as_version=4).cells
        if cell.cell_type == "markdown" and "$" in cell.source
    ]
    tokens = [t for text in texts for t in reader.parse(text)]
    tokens += [child for token in tokens for child in token.children or []]
    formulas = {t.content for t in tokens if t.type in ("math_inline", "math_block", "amsmath")}
    assert len(formulas) > 100
    assert [body for body in formulas if "\\" in extension.formula(body)] == []


# ------------------------------------------------------------------ names and citations


#: A year behind a word that names no author.
NO_AUTHORS = {"Intel", "ICRA", "DARS"}


def test_everything_that_is_cited_is_in_the_references():
    """Catches a paper that the reader cannot look up."""
    folders = (
        "segmap/**/*.py",
        "notebooks/segmap_course/**/*.py",
        "notebooks/*.ipynb",
        "README.md",
    )
    files = [path for folder in folders for path in ROOT.glob(folder)]
    missing = {
        match.group()
        for path in files
        for match in citations.CITED.finditer(prose(path))
        if citations.label_of(match) is None and match["names"] not in NO_AUTHORS
    }
    assert missing == set(), f"add to {citations.PAGE}"


def prose(path):
    """The words of a file without outputs and without the text of cells of code."""
    if path.suffix != ".ipynb":
        return path.read_text(encoding="utf-8")
    cells = nbformat.read(path, as_version=4).cells
    return "\n\n".join(cell.source for cell in cells if cell.cell_type == "markdown")
