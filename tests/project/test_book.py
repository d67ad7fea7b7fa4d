"""The book: a small one built as `make book` builds the whole, and read in a real browser."""

import json
import re
import subprocess
import sys
import time
import urllib.parse

import pytest
from browsers import browser, wait
from chapter_rules import CHAPTERS, ROOT

assert browser  # the fixture
BUILD = """
import json, sys
from pathlib import Path
from book import build
made = build(Path(sys.argv[1]), chapters=[Path(p) for p in sys.argv[3:]], packages=(sys.argv[2],))
print(json.dumps(made.complaints))
"""
#: Move the slider of a panel to its end: whether both texts are the last, and what is shown.
MOVED = """
const panel = document.querySelector('.panel-states'), slider = panel.querySelector('input');
slider.value = slider.max;
slider.dispatchEvent(new Event('input'));
const picture = panel.querySelector('img'), last = JSON.parse(panel.dataset.said).at(-1);
const told = [picture.alt, panel.querySelector('figcaption').textContent];
return [told.every((words) => words === last), picture.style.objectPosition];
"""
#: What a browser fetches by itself while it shows a page: tags, and styles.
FETCHED = re.compile(
    r"<(?:script|img|iframe|source|video|embed|object)\b[^>]*?(?:src|srcset|data)=\"([^\"]*)\""
    r"|<link\b(?![^>]*rel=\"(?:next|prev|index|search|canonical)\")[^>]*?href=\"([^\"]*)\""
)
IN_STYLES = re.compile(r"@import[^;]*|url\(\s*['\"]?(?!data:|#|['\"]?data:)([^)'\"]*)")
#: The width of a page, and that of the window.
WIDTHS = "return [document.documentElement.scrollWidth, window.innerWidth]"
RESULTS = """
return document.querySelector('#search-results h2') && /finished/.test(document.body.innerText)
  && [...document.querySelectorAll('#search-results li > a')].map(a => a.textContent)"""


def chapter(folder, name, source, png=""):
    """A chapter with one cell of code, and a picture as its output."""
    shown = {"output_type": "display_data", "metadata": {}, "data": {"image/png": png}}
    code = {"cell_type": "code", "metadata": {}, "source": "1", "id": "a", "execution_count": 1}
    text = {"cell_type": "markdown", "metadata": {}, "source": source, "id": "b"}
    cells = [text, code | {"outputs": [shown] if png else []}]
    chapter = {"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}
    (folder / name).write_text(json.dumps(chapter))
    return folder / name


def made(*words):
    """A process that makes a book."""
    env = {"PATH": "/usr/bin:/bin", "PYTHONPATH": f"{ROOT}:{ROOT / 'notebooks/tools'}"}
    options = {"cwd": ROOT, "env": env, "capture_output": True, "text": True, "timeout": 580}
    return subprocess.run([sys.executable, *words], **options)


@pytest.fixture(scope="module")
def book(tmp_path_factory):
    """Folder of a book with two chapters that are sound and two that are not; its complaints."""
    folder = tmp_path_factory.mktemp("book")
    unreadable = folder / "97_unreadable.ipynb"
    unreadable.write_text('{"cells": [')
    spoiled = chapter(folder, "98_spoiled.ipynb", "# 98 Spoiled\n\nText.", png="a")
    sound = [path for path in CHAPTERS if path.stem[:2] in ("16", "17")]
    run = made("-c", BUILD, folder / "pages", "reduction", *sound, unreadable, spoiled)
    assert run.returncode == 0, run.stderr
    return folder / "pages", json.loads(run.stdout.splitlines()[-1])


def read(folder, page):
    return (folder / page).read_text(encoding="utf-8")


def test_a_broken_chapter_does_not_lose_the_rest(book):
    """Catches a book that ends at the first file that it cannot read, or that Sphinx fails on."""
    folder, complaints = book
    said = "\n".join(complaints)
    assert "97_unreadable.ipynb" in said and "98_spoiled" in said
    for name in ("97_unreadable", "98_spoiled"):
        assert "could not be made" in read(folder, f"notebooks/{name}.html")
    assert "16.2 The idea" in read(folder, "notebooks/16_mean_shift.html")


def fetched(folder):
    """Everything that pages and styles make a browser fetch."""
    for page in folder.rglob("*.html"):
        yield from (a or b for a, b in FETCHED.findall(page.read_text(encoding="utf-8")))
    for style in folder.rglob("*.css"):
        yield from IN_STYLES.findall(style.read_text(encoding="utf-8"))


def test_the_book_in_a_browser(book, browser):
    """Catches what no parser sees: a search that finds nothing, a page wider than a phone."""
    home = (book[0] / "index.html").as_uri()
    browser.size(1440, 1000)
    browser.open(urllib.parse.urljoin(home, "search.html?q=mean+shift"))
    found = wait("the search", lambda: browser.run(RESULTS), 60)
    assert found[0] == "16 Mean shift" and "segmap.reduction.mean_shift" in found
    claim = "return document.querySelector('#search-results li > p').textContent"
    assert browser.run(claim).startswith("Pieces of walls climb")

    browser.open(urllib.parse.urljoin(home, "notebooks/16_mean_shift.html"))
    browser.run("document.querySelector('a.next-page').click()")
    wait("the next page", lambda: "/17_fusion.html" in browser.run("return location.href"), 20)
    browser.run("document.querySelector('button.fold-all').click()")
    assert browser.run("return document.querySelectorAll('details.code-fold[open]').length") == 0
    browser.run("document.querySelector('a.prev-page').click()")
    wait("the page before", lambda: "/16_mean" in browser.run("return location.href"), 20)
    assert browser.run(MOVED) == [True, "0px 100%"]

    pages = ["index", "genindex", "api/reduction", "README"]
    pages += [f"notebooks/{name}" for name in ("16_mean_shift", "17_fusion")]
    assert [page for page in pages if not fits(browser, home, f"{page}.html")] == []
    browser.run("console.error('planted, to prove that errors are seen')")
    errors = browser.errors()
    assert len(errors) == 1 and "planted" in errors[0], errors


def fits(browser, home, page):
    """Whether a page has no horizontal scroll on a phone of 400 px."""
    phone = {"width": 400, "height": 800, "deviceScaleFactor": 2, "mobile": True}
    browser.devtools("Emulation.setDeviceMetricsOverride", phone)
    browser.open(urllib.parse.urljoin(home, page))
    time.sleep(0.2)
    return browser.run(WIDTHS) == [400, 400]


@pytest.mark.slow
def test_the_whole_book(browser):
    """Catches a chapter, a link, a docstring or a panel that is not as it should be."""
    run = made("-m", "book")
    assert (run.returncode, run.stderr) == (0, "")
    folder = ROOT / "build" / "book"
    pages = [str(p.relative_to(folder)) for p in folder.rglob("*.html") if "_static" not in p.parts]
    assert {f"notebooks/{path.stem}.html" for path in CHAPTERS} < set(pages)
    assert [place for place in fetched(folder) if re.match(r"(?:https?:)?//", place)] == []
    home = (folder / "index.html").as_uri()
    assert [page for page in sorted(pages) if not fits(browser, home, page)] == []
