"""*find me* of the live panel in a real browser, on a map that stands."""

import sys

import nbformat
import pytest
from browsers import SCREENSHOT, browser, free_port, running, wait

assert browser  # the fixture
#: A robot that stands where a square room looks alike from four places, then turns to a cupboard.
CELL = """\
import time
import numpy as np
from segmap import panels, quadtree, simulation as sim

walls = np.concatenate([sim.square_room(4), sim.box(0.5, 0.8, (0.5, 3, 0.2))])
path = sim.drive([(2, 2), (3, 2), (3, 3), (1, 3), (1, 1), (2, 2)], step=0.05)
path = np.concatenate([np.repeat(path[:1], 100, axis=0), path])
log = sim.simulate(walls, path, sensor=sim.SICK_LMS200, rng=np.random.default_rng(1))
map = quadtree.build_map(log, log.truth, resolution=0.02)
panels.LivePanel(scans := (scan for scan in log if not time.sleep(0.1)), map=map)
"""
#: The same robot on no map.
EMPTY = "panels.LivePanel(scans)"
PLACE = """
return [...document.querySelectorAll('.widget-label')].map(e => e.textContent).join(' ')"""
COUNT = """
return [...document.querySelectorAll('button')].filter(e => e.innerText === 'find me').length"""
BUTTON = "//button[normalize-space()='{}']"


@pytest.mark.slow
def test_find_me_looks_for_the_robot_and_finds_it(browser, tmp_path):
    """Catches a button that only Python can press, and a place that is never shown."""
    cells, port = [nbformat.v4.new_code_cell(text) for text in (CELL, EMPTY)], free_port()
    nbformat.write(nbformat.v4.new_notebook(cells=cells), tmp_path / "live.ipynb")
    options = ("--no-browser", f"--Voila.port={port}", "--Voila.ip=127.0.0.1", "--Voila.token=it")
    command = [sys.executable, "-m", "voila", "live.ipynb", *options]
    with running(command, tmp_path / "log", cwd=tmp_path):
        wait("voila", lambda: b"is running at" in (tmp_path / "log").read_bytes(), 90)
        browser.open(f"http://127.0.0.1:{port}/?token=it")
        second = f"({BUTTON.format('find me')})[2]"
        wait("the panels", lambda: browser.run(COUNT) == 2, 120)
        browser.click(second)
        wait("why not", lambda: "holds no occupied cell" in browser.run(PLACE), 20)
        browser.click(BUTTON.format("start"))
        for words in ("looking: not yet: 4 places", "found: "):
            wait(words, lambda w=words: w in browser.run(PLACE), 60)
        browser.screenshot(SCREENSHOT.with_name("live_found.png"))
        assert [said for said in browser.errors() if "fontawesome" not in said] == []
