"""The workbench in a real browser, as `make app` serves it: a log in, a map out.

Pictures of what it showed are left at build/browser/workbench_*.png.
"""

import re
import shlex
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator

import numpy as np
import pytest
from browsers import ROOT, SCREENSHOT, browser, free_port, running, wait
from makefile import app_command

from segmap import exports, readers, simulation

assert browser  # the fixture
#: A file chooser cannot be driven: its input joins the page instead, where the driver finds it.
OPEN = """
HTMLInputElement.prototype.click = function () { document.body.appendChild(this); }"""
TEXT = "return document.body.innerText"
#: Digests of the panes of the canvas, halves or thirds of its width, and the view that they share.
PANES = """
const c = document.querySelector('.segmap-canvas'), w = Math.floor(c.width / arguments[0]);
return Array.from({length: arguments[0]}, (_, k) => {
  const d = c.getContext('2d').getImageData(k * w + 4, 40, w - 8, c.height - 90).data;
  let h = 0;
  for (let i = 0; i < d.length; i += 4) h = (h * 31 + d[i] + 3 * d[i + 1] + 7 * d[i + 2]) >>> 0;
  return h;
}).concat(c.dataset.view)"""
CORNER = """
const c = document.querySelector('.segmap-canvas');
c.scrollIntoView({block: 'center'});
return [c.getBoundingClientRect().left, c.getBoundingClientRect().top]"""
#: Where the second pane of three shows a line of a result, away from titles and scales.
BLUE = """
const c = document.querySelector('.segmap-canvas'), w = Math.floor(c.width / 3);
const box = c.getBoundingClientRect(), dots = c.width / box.width;
const d = c.getContext('2d').getImageData(w, 30, w, c.height - 80).data;
for (let i = 0; i < d.length; i += 4) if (d[i] === 0 && d[i + 1] === 114 && d[i + 2] === 178)
  return [box.left + (w + (i / 4) % w) / dots, box.top + (30 + Math.floor(i / 4 / w)) / dots];
return null"""
#: Voila's page asks the net for a font of icons: see `ICONS` in the errors of a machine without.
ICONS = "fontawesome"
BUTTON = "//button[normalize-space()='{}']"
TAB = "//*[contains(@class, 'lm-TabBar-tabLabel') and normalize-space()='{}']"
PICKED = "//label[normalize-space()='{}']/following-sibling::select"


@pytest.fixture(scope="module")
def app(tmp_path_factory) -> Iterator[str]:
    """The address with its token, as the page's own server prints it."""
    folder, port = tmp_path_factory.mktemp("app"), free_port()
    command = app_command(port).replace(".venv/bin/python", shlex.quote(sys.executable))
    assert command.startswith(shlex.quote(sys.executable))

    def printed():
        found = re.search(rb"http://\S+token=\w+", (folder / "log").read_bytes())
        return found and found.group().decode()

    with running(["sh", "-c", command], folder / "log", cwd=ROOT):
        yield wait("voila", printed, 90)


def test_the_app_is_served_to_who_has_the_token(app):
    """Catches an app that anybody on the machine, or any page in the browser, can open."""
    (address,) = re.fullmatch(r"(http://127\.0\.0\.1:\d+/)\?token=\w{20,}", app).groups()
    for path in ("", "?token=wrong", "api/kernels", "voila/files/app.ipynb"):
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.build_opener(NoRedirect).open(address + path, timeout=20)
        assert refused.value.code in (302, 403, 404)
        assert "login" in refused.value.headers.get("Location", "login")
        refused.value.close()


class NoRedirect(urllib.request.HTTPRedirectHandler):
    """Tells of a redirection instead of following it."""

    def redirect_request(self, *given):
        return None


def test_a_log_goes_in_and_a_map_comes_out(app, browser, tmp_path):
    """Catches what no kernel sees: a canvas that is not drawn, does not move or does not point."""
    walls = simulation.rectangular_room(6.0, 4.0)
    path = simulation.drive([(1, 1), (5, 1), (5, 3)], step=0.5)
    log = simulation.simulate(
        walls, path, sensor=simulation.SICK_LMS200, rng=np.random.default_rng(3)
    )
    exports.write_carmen(tmp_path / "mine.log", log)
    downloads = {"behavior": "allow", "downloadPath": str(tmp_path)}
    browser.devtools("Browser.setDownloadBehavior", downloads)
    browser.size(1280, 1250)
    browser.open(app)
    wait("the workbench", lambda: browser.run("return !!document.querySelector('.segmap-canvas')"))
    browser.run(OPEN)
    browser.click("//button[contains(., 'upload it')]")
    (tmp_path / "long.log").write_bytes(bytes(12_000_000))
    browser.type(browser.find("//input[@type='file']"), str(tmp_path / "long.log"))
    wait("what is too large", lambda: "long.log has 12.0 MB" in browser.run(TEXT))
    browser.click("//button[contains(., 'upload it')]")
    browser.type(browser.find("//input[@type='file']"), str(tmp_path / "mine.log"))
    wait("the log", lambda: "mine: ready to run" in browser.run(TEXT))
    assert f"mine {len(log)} scans" in browser.run(TEXT)

    browser.click(BUTTON.format("Run"))
    wait("a run", lambda: "fusion (tolerance 0.04)" in browser.run(TEXT), 120)
    browser.click(TAB.format("Second"))
    browser.click(f"{PICKED.format('second method')}/option[normalize-space()='basic_online']")
    browser.click(BUTTON.format("Run"))
    wait("a second method", lambda: "basic_online (distance 0.2)" in browser.run(TEXT), 60)
    time.sleep(0.5)  # until it is drawn

    before = browser.run(PANES, 3)
    assert len(set(before[:3])) == 3
    left, top = browser.run(CORNER)
    browser.mouse("mouseMoved", *browser.run(BLUE), buttons=0, button="none")
    wait("the members", lambda: re.search(r"made of \d+ segments of", browser.run(TEXT)), 20)
    browser.mouse("mouseMoved", left + 20, top + 20, buttons=0, button="none")
    wait("nothing", lambda: "made of" not in browser.run(TEXT), 20)
    before = browser.run(PANES, 3)
    for kind, dx, dy in (("Pressed", 0, 0), ("Moved", 60, 30), ("Released", 60, 30)):
        browser.mouse(f"mouse{kind}", left + 200 + dx, top + 200 + dy)
    after = wait("the drag", lambda: changed(browser.run(PANES, 3), before))
    assert all(a != b for a, b in zip(before, after, strict=True))
    (x, y, scale), (x2, y2, scale2) = (map(float, each[3].split()) for each in (before, after))
    assert [(x - x2) * scale, (y2 - y) * scale] == pytest.approx([60, 30], abs=2)
    assert scale2 == scale
    browser.mouse("mouseWheel", left + 200, top + 200, deltaX=0, deltaY=-200, buttons=0)
    nearer = wait("the wheel", lambda: changed(browser.run(PANES, 3), after))
    assert float(nearer[3].split()[2]) > 1.2 * scale

    browser.click(BUTTON.format(".csv"))
    saved = tmp_path / "mine-fusion.csv"
    wait("the file", lambda: saved.exists() and saved.stat().st_size, 20)
    found = readers.read_segments(saved)
    left = re.search(r"fusion \(tolerance 0\.04\)\s+\d+ to (\d+)", browser.run(TEXT))
    assert len(found) == int(left.group(1)) > 3
    browser.screenshot(SCREENSHOT.with_name("workbench_1280.png"))
    browser.size(700, 1400)
    time.sleep(0.5)
    browser.screenshot(SCREENSHOT.with_name("workbench_700.png"))
    wide = "return document.documentElement.scrollWidth <= window.innerWidth"
    assert browser.run(wide), "something is cut off at 700 px"
    browser.run("console.error('planted, to prove that errors are seen')")
    errors = [line for line in browser.errors() if ICONS not in line]
    assert len(errors) == 1 and "planted" in errors[0], errors


def changed(now, before):
    """What is seen now, once all of it is something else."""
    return now if all(a != b for a, b in zip(now, before, strict=True)) else None
