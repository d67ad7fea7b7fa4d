"""`make refresh`: what it changes, and what it leaves."""

import base64
import io

import numpy as np
import pytest
from conftest import later
from PIL import Image

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


def picture(level, compression):
    target = io.BytesIO()
    Image.new("RGB", (40, 30), (level, 0, 0)).save(target, "PNG", compress_level=compression)
    return base64.b64encode(target.getvalue()).decode()


def showing(data):
    output = {"output_type": "display_data", "metadata": {}, "data": {"image/png": data}}
    return nbformat.from_dict({"cells": [{"outputs": [output]}]})


@pytest.mark.parametrize(("stored", "kept"), [(picture(7, 1), True), (picture(8, 9), False)])
def test_a_picture_with_the_same_pixels_stays(stored, kept):
    """Catches a comparison of bytes, which differ with every version of the compressor."""
    new = picture(7, 9)
    assert new != stored
    notebook = showing(new)
    refresh.keep_pictures(notebook, showing(stored))
    assert (notebook.cells[0].outputs[0].data["image/png"] == stored) is kept


def drawn(noise, shape=(300, 400)):
    """An output with a smooth picture, and noise that does not compress."""
    slope = np.add.outer(*map(np.arange, shape)) % 256 // 16 * 16
    level = slope + np.random.default_rng(1).integers(0, noise, shape)
    target = io.BytesIO()
    Image.fromarray(np.repeat(level[..., None], 3, 2).astype(np.uint8)).save(target, "PNG")
    return showing(base64.b64encode(target.getvalue()).decode()).cells[0]


def stored_picture(cell):
    return Image.open(io.BytesIO(base64.b64decode(cell.outputs[0].data["image/png"])))


def test_pictures_lose_dots_until_they_and_the_chapter_fit():
    """Catches a limit for single pictures only, and one picture that pays for all of them."""
    one, many = [drawn(99)], [drawn(60) for _ in range(9)]
    for cells in one, many:
        notebook = notebook_of(*map(str, range(len(cells))))
        for new, cell in zip(notebook.cells, cells, strict=True):
            new.outputs = cell.outputs
            new.outputs[0].metadata["image/png"] = {"width": 200, "height": 150}
        refresh.fit_pictures(notebook)
        sizes = [len(base64.b64decode(c.outputs[0].data["image/png"])) for c in notebook.cells]
        assert max(sizes) <= refresh.MOST_PICTURE_BYTES
        assert len(nbformat.writes(notebook)) <= refresh.MOST_CHAPTER_BYTES
        widths = [stored_picture(cell).width for cell in notebook.cells]
        assert min(widths) >= 200 and max(widths) < 400 and max(widths) < 1.3 * min(widths)
        shown = {c.outputs[0].metadata["image/png"]["width"] for c in notebook.cells}
        assert shown == {200}  # on the page it stays as large as it was
