"""`make refresh`: what it changes, and what it leaves."""

import pytest
from conftest import later

nbformat, refresh = later("nbformat"), later("refresh")
TITLE = "# 99 A try\n\nHalf is $\\frac{1}{2}$, see [fusion](17_fusion.ipynb#why)."
CELLS = [
    "import ipywidgets\nimport matplotlib.pyplot as plt",
    "plt.figure(figsize=(2, 1))\nplt.plot([0, 1])\nplt.show()",
    "ipywidgets.IntSlider(3)",
    "for n in range(3):\n    print(n)",
]


def notebook_of(*cells, title=None):
    """A new notebook with these cells of code, below a title."""
    above = [nbformat.v4.new_markdown_cell(title)] if title else []
    return nbformat.v4.new_notebook(cells=above + [nbformat.v4.new_code_cell(c) for c in cells])


@pytest.fixture(scope="module")
def refreshed(tmp_path_factory):
    """A notebook as Lab would store it; what refresh said of it at once, and again."""
    path = tmp_path_factory.mktemp("chapters") / "99_a_try.ipynb"
    notebook = notebook_of(*CELLS, title=TITLE)
    notebook.metadata["widgets"] = {"state": {}}
    notebook.cells[1].metadata["execution"] = {"iopub.status.busy": "2026-11-21T10:00:00"}
    nbformat.write(notebook, path)
    return path, refresh.refresh(path), refresh.refresh(path)


def test_refresh_settles_at_once(refreshed):
    """Catches anything that differs from run to run: identifiers, times, pictures."""
    _, first, second = refreshed
    assert first and not second


def test_refresh_stores_outputs_and_nothing_of_the_run(refreshed):
    notebook = nbformat.read(refreshed[0], as_version=4)
    assert set(notebook.metadata) == {"kernelspec", "language_info"}
    assert notebook.metadata.language_info == refresh.LANGUAGE
    assert [cell.metadata for cell in notebook.cells] == [{}] * 5
    assert [c.execution_count for c in notebook.cells[1:]] == [1, 2, 3, 4]
    assert notebook.cells[3].outputs[0].data[refresh.VIEW]["model_id"] == "0" * 32
    assert [o.text for o in notebook.cells[4].outputs] == ["0\n1\n2\n"]
    assert list(refreshed[0].parent.iterdir()) == [refreshed[0]]


def test_a_failing_chapter_is_left_as_it_was(tmp_path, capsys):
    path = tmp_path / "98_broken.ipynb"
    nbformat.write(notebook_of("1 / 0"), path)
    before = path.read_bytes()
    assert refresh.main([str(path)]) == 1
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]
    assert "98_broken" in (said := capsys.readouterr().err) and "ZeroDivisionError" in said
