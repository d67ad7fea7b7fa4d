"""The pictures of the page and of a panel in README.md, taken anew by a headless Chromium.

Run it by `.venv/bin/python notebooks/tools/readme_pictures.py`. Both are served as a user is
served: the page by `segmap app`, the panel by Voila.
"""

import base64
import io
import re
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import nbformat
from nbformat import NotebookNode
from panel_pictures import shows_panel
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "notebooks" / "pictures"
#: Pixels of the page, and those in which the panel has its width.
PAGE, PANEL = (1280, 800), (1340, 900)
#: So many colours tell light blue from grey.
COLOURS = 128
#: The chapter with the panel.
CHAPTER = "59_where_am_i.ipynb"
#: The part of the window with the panel, from the left, the top, across and down.
BOX = """
const panel = document.querySelector('.widget-image').closest('.widget-vbox').parentElement;
panel.scrollIntoView();
const box = panel.getBoundingClientRect();
return [box.left, box.top, box.width, box.height]"""
#: Whether a button of this name can be pressed.
READY = """
return [...document.querySelectorAll('button')].some(
  e => e.innerText.trim() === arguments[0] && !e.disabled)"""
PICTURE = "return (document.querySelector('.widget-image') || {}).clientHeight > 100"


def main() -> None:
    """Take both pictures."""
    sys.path.insert(0, str(ROOT / "tests"))
    from browsers import Browser, free_port, running, wait

    @contextmanager
    def served(*command: str) -> Iterator[str]:
        log = Path(folder, "served.log")
        with running([sys.executable, "-m", *command], log, cwd=ROOT):
            yield wait("an address", lambda: re.findall(r"http://127\S+", log.read_text()), 90)[0]

    def button(name: str) -> str:
        return f"//button[normalize-space()='{name}']"

    with tempfile.TemporaryDirectory() as folder:
        port, chapter = free_port(), Path(folder, CHAPTER)
        nbformat.write(_up_to_its_panel(nbformat.read(FOLDER.parent / CHAPTER, 4)), chapter)
        with running(["chromedriver", f"--port={port}"], Path(folder, "driver.log")):
            browser = Browser(port)
            with served("segmap", "app", "--no-browser") as address:
                _size(browser, *PAGE)
                browser.open(address)
                wait("the page", lambda: browser.run("return !!document.querySelector('canvas')"))
                browser.click(button("Run"))
                text = "return document.body.innerText"
                wait("a verdict", lambda: "GOOD: 225 of 225" in browser.run(text), 300)
                wait("its end", lambda: browser.run(READY, "Run"))
                browser.click("//label[normalize-space()='grid']")
                time.sleep(1)  # until it is drawn
                _store(browser, "page", 0, 0, *PAGE)
            options = ("--no-browser", "--Voila.ip=127.0.0.1", f"--port={free_port()}")
            with served("voila", str(chapter), *options) as address:
                _size(browser, *PANEL)
                browser.open(address)
                wait("the panel", lambda: browser.run(PICTURE), 600)
                _store(browser, "panel", *browser.run(BOX))
            browser.close()


def _up_to_its_panel(chapter: NotebookNode) -> NotebookNode:
    """The code of a chapter as far as the cell that shows a panel."""
    end = next(k for k, cell in enumerate(chapter.cells, 1) if shows_panel(cell))
    code = [cell for cell in chapter.cells[:end] if cell.cell_type == "code"]
    return nbformat.v4.new_notebook(cells=code, metadata=chapter.metadata)


def _size(browser, width: int, height: int) -> None:
    """Make what is seen so large, whatever frame a window has."""
    shape = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    browser.devtools("Emulation.setDeviceMetricsOverride", shape)


def _store(browser, name: str, left: float, top: float, width: float, height: float) -> None:
    """A part of the window as a picture of few colours."""
    clip = {"x": left, "y": top, "width": width, "height": height, "scale": 1}
    taken = browser.devtools("Page.captureScreenshot", {"clip": clip})["data"]
    image = Image.open(io.BytesIO(base64.b64decode(taken))).convert("RGB")
    few = image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(FOLDER / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
