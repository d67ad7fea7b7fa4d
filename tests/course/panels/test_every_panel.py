"""One browser session for all chapters: panels in Lab on a small screen, and figures to drag there
and in the book, opened from its files.

Pictures of what it showed are left at build/browser/panels/*.png.
"""

import json
import re
import sys
import time
from typing import Any, NamedTuple

import pytest
from browsers import LAB_TOKEN, SCREENSHOT, browser, lab, run_all_cells, running, wait
from chapter_rules import CHAPTERS, ROOT
from shown_panels import panels

assert browser  # the fixture
pytestmark = pytest.mark.slow
PICTURES = SCREENSHOT.parent / "panels"
#: Cells far off the screen are drawn too, so that all are measured at once.
SETTINGS = "config/lab/user-settings/@jupyterlab/notebook-extension/tracker.jupyterlab-settings"
#: What Python knows of the figure above.
TOLD = """
import ipywidgets
told = ipywidgets.Label(repr(shown))
def follow(change, of=shown, told=told): told.value = f"{of!r} after {change.name}"
shown.observe(follow)
told"""
BUILD = """
import sys
from pathlib import Path
from book import build
build(Path(sys.argv[1]), chapters=[Path(p) for p in sys.argv[2:]], packages=())
"""
KEYS = "\ue014\ue014\ue013"  # right, right, up

#: Of each cell: what its last output is.
MEASURED = """
const high = document.querySelector('.jp-WindowedPanel-outer').clientHeight;
return [...document.querySelectorAll('.jp-CodeCell')].map(cell => {
  const own = [...cell.querySelectorAll('.jp-OutputArea-output')].at(-1);
  const all = own.getBoundingClientRect(), image = own.querySelector('img');
  const right = [...own.querySelectorAll('*:not(svg *)')]
    .map(e => e.getBoundingClientRect().right);
  const picture = own.querySelector('img, svg, canvas')?.getBoundingClientRect();
  const controls = image && own.querySelector('.widget-vbox').getBoundingClientRect();
  const words = [...own.querySelectorAll('label, button, .widget-label, .widget-readout')];
  return {
    left_over: high - all.height, width: all.width, sticks_out: Math.max(0, ...right) - all.right,
    picture: picture ? [picture.width, picture.height] : [0, 0],
    stretch: image ? image.naturalWidth / image.naturalHeight * picture.height / picture.width : 1,
    beside: !image || controls.right <= picture.left + 1,
    cut: words.filter(e => e.scrollWidth > e.clientWidth + 1 || e.scrollHeight > e.clientHeight + 2)
      .map(e => e.textContent),
    text: own.querySelector('output, .widget-label')?.textContent,
  };
})"""
LOADED = "return [...document.querySelectorAll('img')].every(e => e.naturalWidth > 0)"
FOLDED = "return document.querySelector('#jp-left-stack').getClientRects().length === 0"
TO_OUTPUT = """
document.querySelectorAll('.jp-CodeCell')[arguments[0]].querySelector('.jp-OutputArea')
  .scrollIntoView({block: 'end'})"""
HANDLE = "(//div[contains(@class, 'jp-CodeCell')])[{}]//*[local-name()='circle'][@tabindex]"

#: Of a page of the book: its figure as text, and the places of its handles in the window.
DRAWN = """
const figure = document.querySelector('.drag-figure'), svg = figure.querySelector('svg');
if (!svg) return null;
svg.scrollIntoView({block: 'center', behavior: 'instant'});
const middle = ({x, y, width, height}) => [x + width / 2, y + height / 2];
const [place] = [...svg.querySelectorAll('circle[tabindex]')]
  .map(e => middle(e.getBoundingClientRect()));
return {text: figure.querySelector('output').textContent, place, drawn: svg.innerHTML};"""
BACK = """
[...document.querySelectorAll('.drag-figure button')]
  .find(e => e.textContent === 'back to the start').click()"""
FOREIGN = """
return performance.getEntriesByType('resource').map(e => e.name)
  .filter(name => !/^(file|blob|data):/.test(name))"""


class Seen(NamedTuple):
    """The panels, what is measured of each in Lab, and the text of each figure that was dragged."""

    panels: list[Any]
    wide: list[dict[str, Any]]
    narrow: list[dict[str, Any]]
    dragged: dict[str, str]
    errors: list[str]
    folded: bool
    book: Any


@pytest.fixture(scope="module")
def seen(browser, tmp_path_factory):
    """All panels in one notebook, run in Lab, while the pages of the book are made."""
    folder = tmp_path_factory.mktemp("panels")
    shown, cells, place = list(panels()), [], {}
    for number, panel in enumerate(shown):
        place[number] = len(cells)
        cells.append(panel.code)
        cells += [TOLD] if panel.to_drag else []
    (folder / "notebooks").mkdir()
    (folder / "notebooks" / "panels.ipynb").write_text(json.dumps(notebook(cells)))
    (settings := folder / SETTINGS).parent.mkdir(parents=True)
    settings.write_text('{"windowingMode": "none"}')
    pages = [p for p in CHAPTERS if any(s.to_drag and s.chapter == p.stem[:2] for s in shown)]
    env = {"PATH": "/usr/bin:/bin", "PYTHONPATH": f"{ROOT}:{ROOT / 'notebooks/tools'}"}
    build = [sys.executable, "-c", BUILD, str(folder / "book"), *map(str, pages)]
    browser.errors()
    browser.size(1366, 768)
    with (
        running(build, folder / "book.log", env=env) as making,
        lab(folder / "notebooks", folder / "lab.log") as at,
    ):
        browser.open(f"{at}/lab/tree/panels.ipynb?token={LAB_TOKEN}")
        run_all_cells(browser)
        wait("the pictures", lambda: browser.run(LOADED))
        folded, measured = browser.run(FOLDED), browser.run(MEASURED)
        dragged = {}
        for number, panel in enumerate(shown):
            browser.run(TO_OUTPUT, place[number])
            if panel.to_drag:
                browser.type(browser.find(HANDLE.format(place[number] + 1)), KEYS)
                dragged[panel.chapter] = followed(browser, place[number], measured)
            browser.screenshot(PICTURES / f"{panel.chapter}_{number:02}.png")
        browser.size(1366 - round(measured[0]["width"]) + 801, 768)
        time.sleep(0.5)
        narrow = browser.run(MEASURED)
        errors = browser.errors()
        browser.open("about:blank")  # a page of Lab would miss Lab when it ends
        assert making.wait(120) == 0, (folder / "book.log").read_text()
    own = [[m[place[n]] for n in range(len(shown))] for m in (measured, narrow)]
    return Seen(shown, *own, dragged, errors, folded, folder / "book")


def notebook(sources):
    """A notebook of cells that were not run."""
    bare = {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None}
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    cells = [bare | {"id": f"c{n}", "source": source} for n, source in enumerate(sources)]
    metadata = {"kernelspec": kernel}
    return {"cells": cells, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}


def numbers(text):
    return set(re.findall(r"\d+(?:\.\d+)?", text))


def followed(browser, place, measured):
    """The text of a figure, once Python was told of a change and says the same numbers."""

    def same():
        figure, told = (one["text"] for one in browser.run(MEASURED)[place : place + 2])
        changed = told != measured[place + 1]["text"]
        return changed and numbers(told) <= numbers(figure) and figure

    return wait("Python", same, 20)


def test_every_panel_with_its_picture_fits_a_small_screen(seen):
    """Catches controls above a picture that is then below the window, letters that are cut, a
    stretched picture, and a file browser that takes the room of the panel."""
    assert seen.folded
    assert len(seen.panels) > 50 and {p.chapter for p in seen.panels} == {
        path.stem[:2] for path in CHAPTERS
    }
    wrong = [
        f"{panel.chapter} {panel.words}: {one}"
        for panel, one in zip(seen.panels, seen.wide, strict=True)
        if one["left_over"] < 0
        or one["sticks_out"] > 1
        or abs(one["stretch"] - 1) > 0.02
        or min(one["picture"]) < 200
        or not one["beside"]
        or one["cut"]
    ]
    assert wrong == []
    narrow = zip(seen.panels, seen.narrow, strict=True)
    assert [panel.words for panel, one in narrow if not one["beside"]] == []


def test_figures_are_dragged_in_lab_and_python_follows(seen):
    """Catches a figure whose state stays in the browser."""
    assert set(seen.dragged) == {panel.chapter for panel in seen.panels if panel.to_drag}
    assert len(seen.dragged) >= 6
    assert seen.errors == []


def test_figures_are_dragged_in_the_book_without_a_kernel(seen, browser):
    """Catches a page that is dead from a file, by mouse, finger or keyboard, or that fetches."""
    browser.size(1366, 768)
    browser.devtools("Emulation.setTouchEmulationEnabled", {"enabled": True})
    for page in sorted((seen.book / "notebooks").glob("[0-9]*.html")):
        browser.open(page.as_uri())
        first = wait(f"the figure of {page.stem}", lambda: browser.run(DRAWN), 20)
        browser.type(browser.find("//*[local-name()='circle'][@tabindex]"), KEYS)
        by_keys = browser.run(DRAWN)
        assert by_keys["text"] == seen.dragged[page.stem[:2]], page.stem
        browser.run(BACK)
        assert browser.run(DRAWN)["text"] == first["text"], page.stem
        for drag in (by_mouse, by_finger):
            before = browser.run(DRAWN)
            drag(browser, *before["place"])
            assert browser.run(DRAWN)["drawn"] != before["drawn"], (page.stem, drag)
        browser.screenshot(PICTURES / f"book_{page.stem}.png")
        assert browser.run(FOREIGN) == []
    assert browser.errors() == []


def by_mouse(browser, x, y):
    browser.mouse("mousePressed", x, y)
    browser.mouse("mouseMoved", x + 12, y - 9)
    browser.mouse("mouseReleased", x + 12, y - 9, buttons=0)


def by_finger(browser, x, y):
    browser.finger("touchStart", (x, y))
    browser.finger("touchMove", (x - 8, y + 6))
    browser.finger("touchEnd")
