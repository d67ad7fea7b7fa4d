"""The page's step *Live* in a real browser: an emulated LD19 from Start to a floor plan.

Pictures of what it showed are left at build/browser/live_*.png.
"""

import contextlib
import re
import time
from dataclasses import replace

import numpy as np
import pytest
from browsers import (
    BUTTON,
    ENTRY,
    FITS,
    PALE,
    PICKED,
    READY,
    SCREENSHOT,
    STATE,
    TEXT,
    WIDE,
    browser,
    served,
    wait,
)
from emulated import needs_terminals

from segmap import simulation
from segmap.readers import read
from segmap.sensors.emulator import SpinningEmulator

assert browser  # the fixture
pytest.importorskip("lds2d")
ADVICE = "return (document.querySelector('.segmap-advice') || {}).innerText || ''"
SCANS = r"live: (\d+) scans, (\d+\.\d+) m"
#: Each text of the state from now on, and the number of pictures of the canvas.
WATCH = """
window.pictures = 0;
const c = document.querySelector('.segmap-canvas');
new MutationObserver(() => { window.pictures++; }).observe(c, {attributeFilter: ['data-view']});"""
ROOMS = "return document.querySelectorAll('.segmap-plan .room').length"


def carried():
    """Two rooms seen by an LD19 that is carried through them, ten turns a second, then covered."""
    walls = np.concatenate(
        [
            simulation.rectangular_room(7.0, 5.0),
            [[(4.0, 0.0), (4.0, 2.0)], [(4.0, 3.0), (4.0, 5.0)]],
        ]
    )
    path = simulation.drive([(1.0, 1.0), (2.5, 2.5), (5.5, 2.5), (5.5, 4.0)], step=0.06)
    sensor = simulation.Sensor("it", 450, 0.0, 2 * np.pi / 450, max_range=12.0, sigma=0.005)
    log = simulation.simulate(walls, path, sensor=sensor, rng=np.random.default_rng(0), moving=True)
    fast = 0.1 / float(np.median(np.diff(log.times)))  # of a turn that lasts 0.1 s
    seen = [  # mirrored, for an LD19 turns clockwise
        replace(
            scan, time=fast * scan.time, delays=fast * scan.delays[::-1], ranges=scan.ranges[::-1],
            angles=-scan.angles[::-1], odometry=None,
        )
        for scan in log
    ]  # fmt: skip
    covered = replace(seen[-1], ranges=np.full(450, 0.05))
    dark = [replace(covered, time=0.1 * (len(seen) + k)) for k in range(60)]
    return [*seen, *dark, *[replace(seen[-1], time=0.1 * (len(seen) + 60 + k)) for k in range(600)]]


@pytest.mark.slow
@needs_terminals
def test_a_laser_is_followed_until_its_floor_plan_is_seen(browser, tmp_path):
    """Catches a page that shows nothing until the end, hides *lost*, or loses the log with Stop."""
    with contextlib.ExitStack() as stack:
        address = stack.enter_context(served(tmp_path, HOME=str(tmp_path)))
        browser.errors()
        browser.size(1366, 768)
        browser.open(address)
        wait("the page", lambda: browser.run(READY, "Start"))
        emulator = stack.enter_context(SpinningEmulator(carried()))  # it sends from now on
        browser.click(BUTTON.format("Start"))
        wait("what is missing", lambda: "choose the port of the LD" in browser.run(STATE))
        browser.click(f"{PICKED.format('laser')}/option[normalize-space()='LD19']")
        browser.type(browser.find(ENTRY.format("port")), emulator.port + "\ue007")
        browser.click(BUTTON.format("Start"))
        wait("scans", lambda: re.search(SCANS, browser.run(STATE)), 60)
        browser.run(WATCH)
        begun = time.monotonic()
        time.sleep(3)
        pictures = browser.run("return window.pictures") / (time.monotonic() - begun)
        browser.screenshot(SCREENSHOT.with_name("live_grows.png"))
        wait("lost", lambda: "go back to where the map is" in browser.run(ADVICE), 30)
        browser.screenshot(SCREENSHOT.with_name("live_lost.png"))
        assert browser.run(WIDE) and browser.run(FITS) and browser.run(PALE) == []
        wait("the map again", lambda: browser.run(ADVICE) == "", 30)
        browser.click(BUTTON.format("Stop"))
        wait("its map", lambda: browser.run(STATE).endswith(": done"), 90)
        (log,) = tmp_path.glob("live-*.csv")
        assert len(read(log)) > 30 and log.stem in browser.run(TEXT)
        browser.screenshot(SCREENSHOT.with_name("live_mapped.png"))
        browser.click(BUTTON.format("plan"))
        wait("its rooms", lambda: browser.run(ROOMS), 60)
        browser.screenshot(SCREENSHOT.with_name("live_plan.png"))
        assert pictures >= 5
