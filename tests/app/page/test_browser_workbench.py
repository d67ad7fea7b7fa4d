"""The workbench in a real browser, as `make app` serves it: a log in, a map out.

Pictures of what it showed are left at build/browser/workbench_*.png.
"""

import contextlib
import http.client
import os
import re
import time
import urllib.error
import urllib.request
from collections.abc import Iterator

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
from conftest import shared_file
from input_samples import text_samples

from segmap import exports, readers, simulation

assert browser  # the fixture
#: A file chooser cannot be driven: its input joins the page instead, where the driver finds it.
OPEN = """
HTMLInputElement.prototype.click = function () { document.body.appendChild(this); }"""
LABEL = "return document.querySelector('.segmap-canvas').getAttribute('aria-label')"
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
RING = "return getComputedStyle(document.activeElement).outline"
TOOL = "return document.querySelector('.segmap-canvas').dataset.tool"
PLAN_BUTTON = "//div[@class='segmap-plan-bar']//button[normalize-space()='{}']"
#: Whether a plan stands in the place of the map, whole in the window, its letters 7 pixels high.
SHEET = """
const sheet = document.querySelector('.segmap-sheet'), plan = sheet.querySelector('svg');
const box = plan.getBoundingClientRect();
return box.height >= 200 && sheet.scrollWidth <= sheet.clientWidth + 1
  && [...plan.querySelectorAll('text')].every(e => e.getBoundingClientRect().height >= 7)
  && !document.querySelector('.segmap-canvas').getClientRects().length"""
#: Where the name of each room of a plan is seen, and how many rooms and doors there are.
LABELS = """
return [...document.querySelectorAll('.segmap-plan text')].map(e => {
  const box = e.getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2]; })"""
PLANNED = """
return ['room', 'door'].map(kind => document.querySelectorAll(`.segmap-plan .${kind}`).length)"""
#: Left, middle, right and bottom of the first room of a plan; the middle of its first door.
ROOM = """
const box = document.querySelector('.segmap-plan .room').getBoundingClientRect();
return [box.left, box.left + box.width / 2, box.right, box.top + box.height / 2]"""
DOOR = """
const box = document.querySelector('.segmap-plan .door').getBoundingClientRect();
return [box.left + box.width / 2, box.top + box.height / 2]"""
#: The runs of wall that can be chosen, what the last door is called, places of a plan in pixels.
RUNS = """
return [...document.querySelectorAll('.segmap-plan .run')].map(e => e.getAttribute('aria-label'))"""
LAST_DOOR = """
return [...document.querySelectorAll('.segmap-plan .door')].at(-1).getAttribute('aria-label')"""
#: What a plan and its buttons stand on, and the colour of its words.
GROUND = """
const style = name => getComputedStyle(document.querySelector(`.segmap-plan ${name}`));
return [style('svg').backgroundColor, style('button[aria-pressed="false"]').backgroundColor,
  style('text').fill]"""
ON_PLAN = """
const matrix = document.querySelector('.segmap-plan svg').getScreenCTM();
return arguments[0].map(([x, y]) => {
  const place = new DOMPoint(x, -y).matrixTransform(matrix);
  return [place.x, place.y]; })"""
#: From now on: milliseconds from what a hand does to the picture of the plan that Python sends.
TIMED = """
const plan = document.querySelector('.segmap-plan'), status = plan.querySelector('[role=status]');
window.shown = [];
for (const kind of ['pointerup', 'click', 'keydown'])
  addEventListener(kind, event => { window.acted = event.timeStamp; }, true);
new MutationObserver(() => /^(\\d+ rooms|nothing is)/.test(status.textContent) &&
  requestAnimationFrame(now => window.shown.push(now - window.acted))
).observe(status, {childList: true});"""
#: Which part of the window's height the canvas has; where places about its middle are seen.
PART = """
const box = document.querySelector('.segmap-canvas').getBoundingClientRect();
return box.bottom < innerHeight ? box.height / innerHeight : -1"""
PIXELS = """
const c = document.querySelector('.segmap-canvas'), box = c.getBoundingClientRect();
const [u, v, scale] = c.dataset.view.split(' ').map(Number);
return arguments[0].map(([x, y]) => [box.left + box.width / 2 + (x - u) * scale + arguments[1],
  box.top + (box.height + 22) / 2 - (y - v) * scale + arguments[1]])"""
#: Two places of the way on the canvas: the first and the last that are green.
GREEN = """
const c = document.querySelector('.segmap-canvas');
c.scrollIntoView({block: 'center'});
const box = c.getBoundingClientRect(), dots = c.width / box.width, found = [];
const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
for (let i = 0; i < d.length; i += 4) if (d[i] < 30 && d[i + 1] > 140 && d[i + 2] < 130)
  found.push([box.left + (i / 4) % c.width / dots, box.top + Math.floor(i / 4 / c.width) / dots]);
return [found[0], found[found.length - 1]]"""
#: The two scans that are looked at.
SCANS = "return [...document.querySelectorAll('input[type=number]')].slice(-2).map(e => +e.value)"
#: Tools of a plan, where a hand clicks or draws on Intel's, metres, and what it types.
TEN_EDITS = [
    ("Join", [(-9.3, 11.8), (-5.0, 12.8)], ""),
    ("Split", [(-7.3, 0.55), (-2.6, -2.2)], ""),
    ("No door", [(-1.17, 12.93)], ""),
    ("Door", [(12.1, 10.95), (12.9, 11.3)], ""),
    ("Wall", [(6.4, 18.1)], ""),
    ("Furniture", [(13.3, 1.6)], ""),
    ("Name", [(-1.5, 15.0)], "seminar"),
    ("Undo", [], ""),
    ("Redo", [], ""),
    ("Split", [(-12.3, 1.6), (-8.7, 3.2)], ""),
]
ENTER, SPACE = "\ue007", "\ue00d"
#: Voila's page asks the net for a font of icons, which its policy refuses: an error of its own.
ICONS = "fontawesome"


@pytest.fixture(scope="module")
def app(tmp_path_factory) -> Iterator[str]:
    """One for all tests but one: its start costs seconds."""
    with served(tmp_path_factory.mktemp("app")) as address:
        yield address


def test_the_app_is_served_to_who_has_the_token(app):
    """Catches an app that anybody on the machine, or any page in the browser, can open."""
    (address,) = re.fullmatch(r"(http://127\.0\.0\.1:\d+/)\?token=\w{20,}", app).groups()
    for path in ("", "?token=wrong", "api/kernels", "voila/files/app.ipynb"):
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.build_opener(NoRedirect).open(address + path, timeout=20)
        assert refused.value.code in (302, 403, 404)
        assert "login" in refused.value.headers.get("Location", "login")
        refused.value.close()


def test_the_page_answers_to_its_own_host_and_says_what_it_may_load(app):
    """Catches a strange page whose name leads here, and files that go out without the policy."""
    (port,) = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=\w+", app).groups()

    def asked(host, path):
        connection = http.client.HTTPConnection("127.0.0.1", int(port), timeout=60)
        connection.request("GET", path, headers={"Host": host})
        with contextlib.closing(connection), connection.getresponse() as reply:
            policy = reply.headers["Content-Security-Policy"]
            assert reply.headers["X-Content-Type-Options"] == "nosniff", path
            assert "default-src 'none'" in policy and "unsafe-eval" not in policy, path
            assert "'unsafe-inline'" not in policy.partition("script-src ")[2].partition(";")[0]
            return reply.status, re.findall(r"'nonce-(\w+)'", policy), reply.read().decode()

    seen = set()
    for path in ("/login", "/voila/static/voila.js", "/nowhere", "/api/kernels"):
        for host in ("evil.example", "127.0.0.1.evil.example", f"localhost.example:{port}"):
            status, _, said = asked(host, path)
            assert status == 404 and "voila" not in said.lower(), (host, path)
        for host in (f"127.0.0.1:{port}", f"localhost:{port}"):
            status, marks, said = asked(host, path)
            assert status == (200 if path in ("/login", "/voila/static/voila.js") else 302), path
            assert len(marks) == 1 and (said.count("<script") > 0) == (path == "/login")
            assert said.count("<script") == said.count(f"<script nonce={marks[0]}")
            seen |= {*marks}
    assert len(seen) == 8


def html_runs_nothing(browser):
    """Catches a policy that lets a mistake of the page run a stranger's code."""
    for text in (text for text in text_samples() if "window.hit" in text):
        browser.run("document.body.insertAdjacentHTML('afterbegin', arguments[0])", text)
        browser.run("document.querySelectorAll('body > a, body > button').forEach(e => e.click())")
    time.sleep(0.3)
    assert browser.run("return window.hit") is None
    assert any("inline event handler violates" in line for line in browser.errors())


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
    opened(browser, app, 1280)
    chosen(browser, tmp_path / "mine.log")
    wait("the log", lambda: "mine: ready to run" in browser.run(TEXT))
    assert f"mine {len(log)} scans" in browser.run(TEXT)

    browser.click(f"{PICKED.format('method')}/option[normalize-space()='fusion']")
    browser.click(BUTTON.format("Run"))
    wait("a run", lambda: "fusion (tolerance 0.04)" in browser.run(TEXT), 120)
    wait("its end", lambda: browser.run(READY, "Run"))
    browser.click(f"{PICKED.format('second method')}/option[normalize-space()='basic_online']")
    browser.click(BUTTON.format("Run"))
    wait("a second method", lambda: "basic_online (distance 0.2)" in browser.run(TEXT), 60)
    browser.click(BUTTON.format("plan"))
    rooms = "return document.querySelectorAll('.segmap-plan .room').length"
    wait("a plan that the page's policy lets be seen", lambda: browser.run(rooms), 60)
    fits_each_window(browser, "workbench_plan", shown=SHEET)
    browser.size(1280, 1250)
    browser.click(BUTTON.format("plan"))
    wait("the map again", lambda: browser.run("return !document.querySelector('.segmap-plan')"))
    assert "fusion: " in browser.run(LABEL) and "Arrow keys move it" in browser.run(LABEL)
    browser.run("navigator.clipboard.writeText = text => { window.copied = text; }")
    browser.click(BUTTON.format("Copy"))
    wait(
        "the code", lambda: "segmap.read('mine.log'" in (browser.run("return window.copied") or "")
    )
    browser.click(BUTTON.format("both"))
    time.sleep(1)  # until it is drawn

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
    browser.type(browser.find("//canvas"), "\ue014\ue013-")  # arrows to the right and up
    keyed = wait("the keys", lambda: changed(browser.run(PANES, 3)[3:], nearer[3:]))
    (x, y, scale), (x2, y2, scale2) = (map(float, each.split()) for each in (nearer[3], keyed[0]))
    assert x2 > x and y2 > y and scale2 == pytest.approx(0.8 * scale, rel=1e-3)

    browser.click(BUTTON.format("before"))
    wait("all of it", lambda: browser.run(PANES, 1)[1].startswith("0.0000 0.0000 "))
    assert browser.run(PART) > 0.8, "the map is as high as the window"
    corners = [(-3, -2), (3, -2), (3, 2), (-3, 2)]
    for tool, places, size in (("distance", corners[:2], 6), ("area", corners, 24)):
        browser.click(BUTTON.format(tool))
        wait("the tool", lambda: browser.run(TOOL) == tool)  # noqa: B023
        for x, y in browser.run(PIXELS, places, 2):  # beside the corners, to which they snap
            clicked(browser, x, y)
        wait("the size", lambda: abs(measured(browser) / size - 1) < 0.02, 20)  # noqa: B023
    browser.click(BUTTON.format("look"))
    browser.mouse("mouseMoved", *browser.run(PIXELS, [(0, 0)], 0)[0], buttons=0, button="none")
    wait("coordinates", lambda: re.search(r"x -?\d\.\d\d, y -?\d\.\d\d m", browser.run(TEXT)), 20)
    browser.click(BUTTON.format("Table (CSV)"))
    saved = tmp_path / "mine-fusion.csv"
    wait("the file", lambda: saved.exists() and saved.stat().st_size, 20)
    found = readers.read_segments(saved)
    left = re.search(r"fusion \(tolerance 0\.04\): (\d+) of", browser.run(TEXT))
    assert len(found) == int(left.group(1)) > 3
    fits_each_window(browser, "workbench")
    browser.run("console.error('planted, to prove that errors are seen')")
    errors = [line for line in browser.errors() if ICONS not in line]
    assert len(errors) == 1 and "planted" in errors[0], errors


def test_a_long_log_is_taken_in_pieces_stopped_and_gone_after_a_reload(app, browser, tmp_path):
    """Catches a page that says nothing for a minute, and work that goes on when nobody waits."""
    scan = exports_of_one_scan(tmp_path / "one.log")
    (tmp_path / "long.log").write_bytes(scan * (60_000_000 // len(scan)))
    (tmp_path / "huge.log").write_bytes(b"")
    os.truncate(tmp_path / "huge.log", 100_000_001)
    opened(browser, app, 1280)
    chosen(browser, tmp_path / "huge.log")
    wait("what is too large", lambda: "huge.log has 100.0 MB: only a file" in browser.run(TEXT))
    chosen(browser, tmp_path / "long.log")
    wait("pieces", lambda: "uploading long.log, " in browser.run(STATE), 20)
    wait("the reading", lambda: "reading line" in browser.run(STATE))
    begun = time.monotonic()
    browser.click(BUTTON.format("Stop"))
    wait("the stop", lambda: browser.run(STATE) == "stopped", 20)
    assert time.monotonic() - begun < 5  # half a second, but for the load of the machine
    assert "no log: choose one" in browser.run(TEXT)
    assert not browser.run(READY, "Run"), "the next run would map the log before"
    browser.click(f"{PICKED.format('bundled log')}/option[normalize-space()='malaga']")
    wait("the log", lambda: "malaga 225 scans" in browser.run(TEXT))
    browser.click(BUTTON.format("Run"))
    wait("the scans", lambda: " of 225" in browser.run(STATE))
    ways = "[...document.querySelectorAll('h2, canvas')].map(e => e.getBoundingClientRect().x)"
    log, *_ = found = browser.run(f"return {ways}")
    assert found[:10] == [log] * 10 and found[10] > log + 300  # the map stands beside the steps
    browser.open(app)
    wait("the page", lambda: browser.run(STATE) == "malaga: ready to run")
    assert browser.run("return [...document.querySelectorAll('h1, h2')].map(e => e.innerText)") == [
        "From a log of a laser to a map", *("1 Log", "or Live", "2 Poses", "3 Segments", "4 Map"),
        *("Mend the map", "Floor plan", "Save the map", "All runs", "In Python"),
    ]  # fmt: skip
    html_runs_nothing(browser)


def test_a_loop_is_left_out_by_keys_alone_and_two_places_are_clicked(app, browser):
    """Catches a control without a name or that only a mouse reaches, a toggle without a state, a
    picture without words, a click that is lost.

    What a screen reader is told comes from Chromium's accessibility tree.
    """
    opened(browser, app, 400)
    browser.click(f"{PICKED.format('bundled log')}/option[normalize-space()='corridor']")
    wait("the log", lambda: browser.run(STATE) == "corridor: ready to run")
    for kind, name in (("alignment", "pose_graph"), ("method", "fusion")):
        browser.click(f"{PICKED.format(kind)}/option[normalize-space()='{name}']")
    pressed(browser, "Run", ENTER)
    wait("a run", lambda: "loops (4)" in browser.run(TEXT), 180)
    off = ["before", "both", "distance", "area"]
    off += ["loops (4)", "crop and place", "laser", "settings", "plan"]
    assert toggles(browser) == dict.fromkeys(off, False) | {"after": True, "look": True}
    ticked = dict.fromkeys(("path", "loops", "free space"), True)
    ticked |= dict.fromkeys(("points", "grid"), False)
    assert ticked.items() <= toggles(browser, "checked").items()
    parts = [node["name"]["value"] for node in nodes(browser) if node["role"]["value"] == "region"]
    assert parts == ["run", "steps", "map"]
    pressed(browser, "loops (4)", SPACE)
    shown = r"4-151: 0.\d\d sd off, 76 m round"
    wait("the loops", lambda: re.match(shown, "".join(listed(browser))))
    assert toggles(browser)["loops (4)"]
    assert all(node["name"]["value"] for node in nodes(browser) if "focusable" in properties(node))
    time.sleep(1)  # until the way is drawn
    numbers = [browser.run(SCANS)]
    for x, y in browser.run(GREEN):
        clicked(browser, x, y)
        before = numbers[-1]
        wait("a place", lambda: (now := browser.run(SCANS))[0] == before[1] != now[1], 20)  # noqa: B023
        numbers.append(browser.run(SCANS))
    pressed(browser, "Leave it out", ENTER)
    wait("the veto", lambda: listed(browser)[0] == "4-151: left out", 120)
    wait("its reduction", lambda: "veto=[(4, 151)]" in browser.run(TEXT))
    for place, scan in (("scan", "152"), ("and", "5")):
        browser.type(browser.find(ENTRY.format(place)), f"\ue009a\ue000{scan}\ue004")
    pressed(browser, "Close a loop here", ENTER)
    wait("the tie", lambda: any("5-151 (by you)" in each for each in listed(browser)), 60)
    browser.type(browser.find("//select[@size]"), "\ue011")  # the first one
    pressed(browser, "Take it back", SPACE)
    wait("the loop", lambda: "veto=[], tie=[(5, 151)]" in browser.run(TEXT), 60)
    pressed(browser, "crop and place", SPACE)
    wait("the fold", lambda: "north [degrees]" in browser.run(TEXT))
    browser.type(browser.find(ENTRY.format("crop [m]")), "-30 -5 5 30" + ENTER)
    wait("the crop", lambda: ".cropped(-30, -5, 5, 30)" in browser.run(TEXT), 60)
    wait("its end", lambda: browser.run(READY, "Run"))
    browser.type(browser.find("(//button[normalize-space()='settings'])[3]"), SPACE)
    wait("the thresholds", lambda: "tolerance [m]" in browser.run(TEXT))
    spoken = {node["role"]["value"]: node for node in nodes(browser)}
    said = r": .* fusion leaves \d+ of \d+ segments, quality .* m wide, [\d.]+ m high"
    assert re.search(said, spoken["application"]["description"]["value"])
    assert spoken["slider"]["name"]["value"] == "tolerance [m]"
    met = [node for node in nodes(browser) if "focusable" in properties(node)]
    assert len(met) > 30
    browser.run("document.querySelector('.segmap-bar button').focus()")
    assert browser.run(RING) == "rgb(11, 87, 208) solid 3px", "3 to 1 against white"
    assert [node["role"]["value"] for node in met if not node["name"]["value"]] == []
    fits_each_window(browser, "workbench_loops")


def measured(browser):
    """The size that the page says, in metres or square metres."""
    found = re.search(r"(?:^|\n)(\d+\.\d{3}) m", browser.run(TEXT))
    return float(found.group(1)) if found else 0.0


def pressed(browser, name, key):
    """A button, by the keyboard."""
    wait("the button", lambda: browser.run(READY, name), 60)
    browser.type(browser.find(BUTTON.format(name)), key)


def clicked(browser, x, y):
    for kind in ("Pressed", "Released"):
        browser.mouse(f"mouse{kind}", x, y)


def listed(browser):
    """The list of loops, whose spaces do not break."""
    texts = browser.run(
        "return [...document.querySelectorAll('select[size] option')].map(e => e.text)"
    )
    return [text.replace("\xa0", " ") for text in texts]


def toggles(browser, kind="pressed"):
    """What a screen reader is told of each button or tick that has a state."""
    found = [(properties(node).get(kind), node["name"]["value"]) for node in nodes(browser)]
    return {name: state in (True, "true") for state, name in found if state is not None and name}


def nodes(browser):
    """What a screen reader is told."""
    found = browser.devtools("Accessibility.getFullAXTree", {})["nodes"]
    return [node for node in found if not node["ignored"]]


def properties(node):
    return {each["name"]: each["value"].get("value") for each in node.get("properties", [])}


def exports_of_one_scan(path):
    """A line of a log."""
    exports.write_carmen(path, readers.load("corridor")[:1])
    return path.read_bytes().splitlines(keepends=True)[-1]


def opened(browser, address, width):
    """The page, once it can be used; errors of the page before are forgotten."""
    browser.errors()
    browser.size(width, 1250)
    browser.open(address)
    wait("the workbench", lambda: browser.run("return !!document.querySelector('.segmap-canvas')"))
    browser.run(OPEN)


def chosen(browser, path):
    """A file, as a user chooses it."""
    browser.run("document.querySelectorAll('body > input').forEach(e => e.remove())")
    browser.type(browser.find("//button[contains(., 'upload it')]"), ENTER)
    browser.type(browser.find("/html/body/input[@type='file']"), str(path))


def fits_each_window(browser, name, shown="return true"):
    """Catches what is cut off or pale on a phone, a tablet or a desk."""
    for width in (1280, 700, 400):
        browser.size(width, 3000 - width)
        time.sleep(0.5)
        browser.screenshot(SCREENSHOT.with_name(f"{name}_{width}.png"))
        assert browser.run(WIDE), f"something is cut off at {width} px"
        assert browser.run(FITS), f"two bars to scroll the same at {width} px"
        assert browser.run(PALE) == [], f"letters too pale at {width} px"
        assert browser.run(shown), f"not readable at {width} px"


def changed(now, before):
    """What is seen now, once all of it is something else."""
    return now if all(a != b for a, b in zip(now, before, strict=True)) else None


def planned(browser, app):
    """The plan of a bundled log with three rooms and two doors."""
    opened(browser, app, 1366)
    browser.click(f"{PICKED.format('bundled log')}/option[normalize-space()='room']")
    wait("the log", lambda: browser.run(STATE) == "room: ready to run")
    browser.click(BUTTON.format("Run"))
    wait("a run", lambda: browser.run(STATE) == "room: done")
    browser.click(BUTTON.format("plan"))
    wait("a plan", lambda: browser.run(PLANNED) == [3, 2])


def test_a_plan_is_mended_by_mouse_finger_and_keys(app, browser):
    """Catches a run of wall that cannot be met, a click that reaches no room, a door or a cut at
    another place than it is drawn, edits that need a mouse, and a white plan in a dark page."""
    planned(browser, app)
    browser.size(1366, 768)
    browser.click(PLAN_BUTTON.format("Furniture"))
    runs = len(browser.run(RUNS))

    def undone():
        browser.click(PLAN_BUTTON.format("Undo"))
        wait("what was before", lambda: browser.run(PLANNED) == [3, 2])

    ((x, y),) = browser.run(ON_PLAN, [(0.8, 6.1)])
    browser.mouse("mouseMoved", x, y, buttons=0, button="none")
    browser.screenshot(SCREENSHOT.with_name("workbench_furniture.png"))
    clicked(browser, x, y)
    wait("two rooms in one", lambda: browser.run(PLANNED) == [2, 1])
    assert len(browser.run(RUNS)) < runs
    undone()
    browser.click(PLAN_BUTTON.format("Furniture"))
    ((x, y),) = browser.run(ON_PLAN, [(4.445, 1.5)])  # the front of a desk
    for kind, points in (("Start", [{"x": x, "y": y}]), ("End", [])):
        browser.devtools(
            "Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": points}
        )
    wait("fewer walls", lambda: len(browser.run(RUNS)) < runs)
    undone()
    browser.click(PLAN_BUTTON.format("Door"))
    start, end = browser.run(ON_PLAN, [(0.0, 4.5), (0.0, 5.4)])
    browser.mouse("mousePressed", *start)
    browser.mouse("mouseMoved", end[0] + 2, (start[1] + end[1]) / 2)
    browser.mouse("mouseMoved", *end)
    browser.screenshot(SCREENSHOT.with_name("workbench_door.png"))
    browser.mouse("mouseReleased", *end)
    wait("a door", lambda: browser.run(PLANNED) == [3, 3])
    assert float(browser.run(LAST_DOOR).split()[1]) == pytest.approx(0.9, abs=0.03)
    undone()
    browser.click(PLAN_BUTTON.format("Door"))
    run = "//*[local-name()='g'][@class='run']"
    browser.run("document.querySelector('.segmap-plan .run').focus()")
    for keys in (ENTER, "\ue014\ue013", ENTER):  # the arrows to the right and up
        browser.type(browser.find(run), keys)
    wait("a door by keys", lambda: browser.run(PLANNED) == [3, 3])
    assert browser.run(LAST_DOOR) == "door, 1.00 metres"
    undone()
    browser.click(PLAN_BUTTON.format("Wall"))
    assert len(browser.run(RUNS)) > runs, "clutter can be a wall"
    browser.click(PLAN_BUTTON.format("Join"))
    for x, y in browser.run(LABELS)[:2]:
        clicked(browser, x, y)
    wait("a join", lambda: browser.run(PLANNED) == [2, 1])
    undone()
    browser.click(PLAN_BUTTON.format("Redo"))
    wait("it again", lambda: browser.run(PLANNED) == [2, 1])
    undone()
    browser.click(PLAN_BUTTON.format("No door"))
    clicked(browser, *browser.run(DOOR))
    wait("one door", lambda: browser.run(PLANNED) == [3, 1])
    undone()
    browser.click(PLAN_BUTTON.format("Split"))
    left, middle, right, low = browser.run(ROOM)
    for kind, x in (("Pressed", left - 2), ("Moved", middle), ("Moved", right + 2)):
        browser.mouse(f"mouse{kind}", x, low)
    browser.screenshot(SCREENSHOT.with_name("workbench_split.png"))
    browser.mouse("mouseReleased", right + 2, low)
    wait("a split", lambda: browser.run(PLANNED)[0] == 4)
    undone()
    room = "//*[local-name()='path'][@class='room']"
    browser.run("document.querySelector('.segmap-plan .room').focus()")
    for keys in (ENTER, "\ue012\ue013", ENTER):  # the arrows to the left and up
        browser.type(browser.find(room), keys)
    wait("a split by keys", lambda: browser.run(PLANNED)[0] == 4)
    undone()
    assert browser.run(PALE) == [] and browser.run(WIDE) and browser.run(FITS)
    features = [{"name": "prefers-color-scheme", "value": "dark"}]
    browser.devtools("Emulation.setEmulatedMedia", {"features": features})
    browser.screenshot(SCREENSHOT.with_name("workbench_plan_dark.png"))
    assert browser.run(GROUND) == [*["rgb(22, 22, 22)"] * 2, "rgb(232, 232, 232)"]
    browser.devtools("Emulation.setEmulatedMedia", {"features": []})
    assert browser.run(GROUND)[:2] == ["rgb(255, 255, 255)"] * 2
    errors = [line for line in browser.errors() if ICONS not in line]
    assert not errors, errors


@pytest.mark.slow
def test_ten_edits_by_mouse_on_a_building_of_many_rooms(app, browser):
    """Catches an edit that does nothing, or takes seconds, where a building has many rooms.

    It prints when each is seen: 0.3 s are asked, of a machine that does nothing else.
    """
    opened(browser, app, 1366)
    chosen(browser, shared_file("data/intel.log.gz"))
    wait("the log", lambda: browser.run(STATE) == "intel: ready to run")
    browser.run("document.querySelectorAll('body > input').forEach(e => e.remove())")
    browser.click(f"{PICKED.format('method')}/option[normalize-space()='fusion']")
    browser.click(BUTTON.format("Run"))
    wait("a run", lambda: browser.run(STATE) == "intel: done", 300)
    browser.click(BUTTON.format("plan"))
    wait("a plan", lambda: all(browser.run(PLANNED)), 120)
    rooms, doors = browser.run(PLANNED)
    browser.run(TIMED)
    begun = time.monotonic()
    for count, (tool, places, text) in enumerate(TEN_EDITS, 1):
        browser.click(PLAN_BUTTON.format(tool))
        places = browser.run(ON_PLAN, places)
        if tool in ("Split", "Door"):
            kinds = ("Pressed", "Moved", "Moved", "Released")
            drawn = zip(kinds, places[:1] + 3 * places[1:], strict=True)
        else:
            drawn = ((kind, place) for place in places for kind in ("Pressed", "Released"))
        for kind, place in drawn:
            browser.mouse(f"mouse{kind}", *place)
        if text:
            browser.type(browser.find("//div[@class='segmap-plan-bar']/input"), text + ENTER)
        wait(tool, lambda: len(browser.run("return window.shown")) == count, 20)  # noqa: B023
        words = browser.run("return document.querySelector('.segmap-plan-status').innerText")
        print(f"{tool:9} {browser.run('return window.shown')[-1]:4.0f} ms, {words.split(';')[0]}")
        assert not words.startswith("nothing"), words
    assert time.monotonic() - begun < 60
    assert browser.run(PLANNED) == [rooms + 1, doors - 1]
    browser.screenshot(SCREENSHOT.with_name("workbench_intel.png"))
