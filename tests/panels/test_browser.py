"""Chapter 01 in a real browser: run all cells, move the slider by its arrow keys, see it answer.

A picture of what it showed is left at build/browser/chapter_01.png.
"""

import json
import os
import re
import shlex
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browsers import ROOT, SCREENSHOT, Browser, browser, free_port, running, wait
from makefile import lab_command

assert browser  # the fixture

CHAPTER = ROOT / "notebooks" / "01_start_here.ipynb"
TOKEN = "chapter00"
RIGHT = "\ue014"

#: The count of segments as the panel of the chapter shows them: "276 of 2842 segments left".
COUNT = """
return [...document.querySelectorAll('.widget-label')].map(e => e.textContent)
  .filter(t => / of \\d+ segments left/.test(t))[0] || null"""
PICTURE = "const p = document.querySelector('.widget-image'); return p ? p.src : null"
ENTRY = "//div[contains(@class, 'lm-{}-itemLabel') and text()='{}']"
HANDLE = "//div[contains(@class, 'widget-hslider')]//div[contains(@class, 'noUi-handle')]"
#: Idle and connected: a notebook without a kernel calls itself idle, and asks for one when it runs.
IDLE = """
const i = document.querySelector('.jp-Notebook-ExecutionIndicator');
const k = document.querySelector('.jp-KernelName');
return i !== null && i.dataset.status === 'idle' && k !== null && /Python/.test(k.textContent)"""
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
UNFINISHED = """
const cells = [...document.querySelectorAll('.jp-CodeCell:not(:has(.jp-Placeholder))')];
const p = cells.map(e => e.querySelector('.jp-InputPrompt').textContent);
return p.filter(t => !/\\[\\d+\\]/.test(t)).length + (p.length ? 0 : 1)"""


@pytest.fixture
def chapter(tmp_path: Path) -> Iterator[str]:
    """Address of a copy of chapter 01 in a running JupyterLab."""
    folder, port = tmp_path / "notebooks", free_port()
    folder.mkdir()
    notebook = json.loads(CHAPTER.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":  # so that what is seen was made here
            cell |= {"outputs": [], "execution_count": None}
    (folder / CHAPTER.name).write_text(json.dumps(notebook), encoding="utf-8")
    own = {"JUPYTER_CONFIG_DIR": "config", "JUPYTER_DATA_DIR": "data", "IPYTHONDIR": "ipython"}
    env = os.environ | {name: str(tmp_path / place) for name, place in own.items()}
    lab = lab_command(port).replace(".venv/bin/python", shlex.quote(sys.executable))
    options = f"--IdentityProvider.token={TOKEN} --LabApp.default_url=/lab --ServerApp.root_dir=."
    command = ["sh", "-c", f"{lab} {options}"]
    with running(command, tmp_path / "lab.log", cwd=folder, env=env):
        api = f"http://127.0.0.1:{port}/api/status?token={TOKEN}"
        wait("JupyterLab", lambda: urllib.request.urlopen(api, timeout=5).status == 200)
        assert "Warning" not in (said := (tmp_path / "lab.log").read_text()), said
        yield f"http://127.0.0.1:{port}/doc/tree/{CHAPTER.name}?token={TOKEN}&reset"


def run_all_cells(browser: Browser) -> None:
    wait("the kernel", lambda: browser.run(IDLE))
    browser.click(ENTRY.format("MenuBar", "Run"))
    time.sleep(0.5)  # the menu fills itself
    browser.click(ENTRY.format("Menu", "Run All Cells"))
    # On a new machine the loops are compiled now, which can take minutes.
    wait("all cells to run", lambda: browser.run(UNFINISHED) == 0 and browser.run(IDLE), 300)


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
    browser.click(ENTRY.format("MenuBar", "File"))
    time.sleep(0.5)  # the menu fills itself
    browser.click(ENTRY.format("Menu", "Save Notebook"))
    panel = wait("the file", lambda: shown_by(path, "FusionPanel("), 20)
    assert set(panel) == {"image/png", "text/plain"}
    api = address.partition("/doc/")[0] + "/api/sessions"
    with urllib.request.urlopen(f"{api}?token={TOKEN}", timeout=5) as reply:
        (session,) = json.load(reply)
    end = urllib.request.Request(f"{api}/{session['id']}?token={TOKEN}", method="DELETE")
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
