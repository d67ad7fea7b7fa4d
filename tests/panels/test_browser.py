"""Chapter 01 in a real browser: run all cells, move the slider by its arrow keys, see it answer.

A picture of what it showed is left at build/browser/chapter_01.png.
"""

import json
import re
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browsers import (
    LAB_TOKEN,
    MENU,
    ROOT,
    SCREENSHOT,
    Browser,
    browser,
    lab,
    run_all_cells,
    wait,
)

assert browser  # the fixture

CHAPTER = ROOT / "notebooks" / "01_start_here.ipynb"
RIGHT = "\ue014"

#: The count of segments as the panel of the chapter shows them: "276 of 2842 segments left".
COUNT = """
return [...document.querySelectorAll('.widget-label')].map(e => e.textContent)
  .filter(t => / of \\d+ segments left/.test(t))[0] || null"""
PICTURE = "const p = document.querySelector('.widget-image'); return p ? p.src : null"
HANDLE = "//div[contains(@class, 'widget-hslider')]//div[contains(@class, 'noUi-handle')]"
#: What Lab says in its corner: within a second of the start it asks whether it may fetch news.
NOTES = """
return [...document.querySelectorAll('.Toastify__toast')].map(e => e.textContent).join()"""
#: Whether a picture is seen, somewhere down the page: what is far off is not drawn at all.
SEEN = """
const all = document.querySelector('.jp-WindowedPanel-outer');
const [found] = [...document.querySelectorAll('img')].filter(e => e.src.endsWith(arguments[0]));
if (found) found.scrollIntoView({block: 'center'});
else if (all) all.scrollTop = (all.scrollTop + 800) % all.scrollHeight;
return found !== undefined && found.clientHeight > 100"""
LOST = "return /model not found/i.test(document.body.innerText)"


@pytest.fixture
def chapter(tmp_path: Path) -> Iterator[str]:
    """Address of a copy of chapter 01 in a running JupyterLab."""
    folder = tmp_path / "notebooks"
    folder.mkdir()
    notebook = json.loads(CHAPTER.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":  # so that what is seen was made here
            cell |= {"outputs": [], "execution_count": None}
    (folder / CHAPTER.name).write_text(json.dumps(notebook), encoding="utf-8")
    with lab(folder, tmp_path / "lab.log") as at:
        yield f"{at}/doc/tree/{CHAPTER.name}?token={LAB_TOKEN}&reset"


def test_the_slider_of_chapter_01_answers(browser, chapter, tmp_path):
    """Catches what no kernel sees: a panel that is not drawn, a slider that does nothing, and a
    panel that is lost when its notebook is opened again without its kernel."""
    browser.open(chapter)
    run_all_cells(browser)
    count = wait("the count", lambda: browser.run(COUNT))
    picture = wait("the picture", lambda: browser.run(PICTURE))
    handle = browser.find(HANDLE)
    browser.run("document.querySelector('.widget-hslider').scrollIntoView({block: 'center'})")
    browser.type(handle, RIGHT * 2)
    wait("another count", lambda: browser.run(COUNT) != count, 20)
    wait("another picture", lambda: browser.run(PICTURE) != picture, 20)
    time.sleep(0.5)  # the second key's picture
    browser.screenshot(SCREENSHOT)
    assert int(browser.run(COUNT).split()[0]) < int(count.split()[0])
    assert not re.search("news", browser.run(NOTES)), "Lab asks about news: see the Makefile"
    assert browser.run("return document.querySelectorAll('[data-mime-type*=stderr]').length") == 0
    browser.run("console.error('planted, to prove that errors are seen')")
    found = browser.errors()
    assert len(found) == 1 and "planted" in found[0], found
    picture = save_and_end_the_kernel(browser, chapter, tmp_path / "notebooks" / CHAPTER.name)
    browser.open(chapter)
    wait("the picture of the panel", lambda: browser.run(SEEN, picture), 30)
    time.sleep(0.5)  # a lost panel would say so now
    browser.screenshot(SCREENSHOT.with_name("chapter_01_reopened.png"))
    assert not browser.run(LOST)


def save_and_end_the_kernel(browser: Browser, address: str, path: Path) -> str:
    """Save by the menu, as a student does; the end of the panel's picture, in base64."""
    browser.click(MENU.format("MenuBar", "File"))
    time.sleep(0.5)  # the menu fills itself
    browser.click(MENU.format("Menu", "Save Notebook"))
    panel = wait("the file", lambda: shown_by(path, "FusionPanel("), 20)
    assert set(panel) == {"image/png", "text/plain"}
    api = address.partition("/doc/")[0] + "/api/sessions"
    with urllib.request.urlopen(f"{api}?token={LAB_TOKEN}", timeout=5) as reply:
        (session,) = json.load(reply)
    end = urllib.request.Request(f"{api}/{session['id']}?token={LAB_TOKEN}", method="DELETE")
    urllib.request.urlopen(end, timeout=20).close()
    return str(panel["image/png"].strip()[-200:].replace("\n", ""))


def shown_by(path: Path, name: str) -> dict[str, Any] | None:
    """What a saved notebook holds of the output whose text begins so."""
    try:
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    except ValueError:  # it is written now
        return None
    outputs = (o.get("data", {}) for cell in cells for o in cell.get("outputs", ()))
    return next((o for o in outputs if "".join(o.get("text/plain", "")).startswith(name)), None)
