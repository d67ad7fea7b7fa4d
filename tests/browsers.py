"""A real browser, driven over W3C WebDriver with the standard library."""

import base64
import json
import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from makefile import app_command, lab_command

ROOT = Path(__file__).resolve().parents[1]
SCREENSHOT = ROOT / "build" / "browser" / "chapter_01.png"
FLAGS = [
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-sync", "--disable-background-networking", "--disable-component-update"),
    *("--disable-dev-shm-usage", "--window-size=1200,1600"),
]

TEXT = "return document.body.innerText"
STATE = "return (document.querySelector('.segmap-state') || {}).innerText"
#: Whether the page fits its window, where only its steps scroll.
FITS = (
    "const e = document.getElementById('rendered_cells'); return e.scrollHeight <= e.clientHeight"
)
WIDE = "return document.documentElement.scrollWidth <= window.innerWidth"
#: Letters with a contrast below 4.5 to 1 against what is behind them (WCAG 2, AA).
PALE = """
const light = color => {
  const [r, g, b] = color.match(/[\\d.]+/g).map(v => v / 255)
    .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const clear = e => /^rgba\\(.*, 0\\)$/.test(getComputedStyle(e).backgroundColor);
const pale = [], walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (walk.nextNode()) {
  const text = walk.currentNode, own = text.parentElement;
  if (!text.data.trim() || !own.getClientRects().length) continue;
  let behind = own;
  while (behind.parentElement && clear(behind)) behind = behind.parentElement;
  const ground = clear(behind) ? 1 : light(getComputedStyle(behind).backgroundColor);
  const [low, high] = [light(getComputedStyle(own).color), ground].sort((a, b) => a - b);
  if ((high + 0.05) / (low + 0.05) < 4.5) pale.push(text.data.trim());
}
return pale"""
#: Whether a button of this name can be pressed.
READY = """
return [...document.querySelectorAll('button')].some(
  e => e.innerText.trim() === arguments[0] && !e.disabled)"""
#: An entry of a menu of Lab, and the token of its address.
MENU = "//div[contains(@class, 'lm-{}-itemLabel') and text()='{}']"
LAB_TOKEN = "chapter01"
#: Idle and connected: a notebook without a kernel calls itself idle, and asks for one when it runs.
IDLE = """
const i = document.querySelector('.jp-Notebook-ExecutionIndicator');
const k = document.querySelector('.jp-KernelName');
return i !== null && i.dataset.status === 'idle' && k !== null && /Python/.test(k.textContent)"""
UNFINISHED = """
const cells = [...document.querySelectorAll('.jp-CodeCell:not(:has(.jp-Placeholder))')];
const p = cells.map(e => e.querySelector('.jp-InputPrompt').textContent);
return p.filter(t => !/\\[\\d+\\]/.test(t)).length + (p.length ? 0 : 1)"""
BUTTON = "//button[normalize-space()='{}']"
ENTRY = "//label[normalize-space()='{}']/following-sibling::input"
PICKED = "//label[normalize-space()='{}']/following-sibling::select"


def free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


@contextmanager
def running(command: list[str], log: Path, **options: Any) -> Iterator[subprocess.Popen]:
    """A program and all its children, ended whatever happens."""
    with log.open("wb") as out:
        process = subprocess.Popen(
            command, stdout=out, stderr=out, start_new_session=True, **options
        )
        try:
            yield process
        finally:
            for kind in (signal.SIGTERM, signal.SIGKILL):
                try:
                    os.killpg(process.pid, kind)
                    process.wait(5)
                except (ProcessLookupError, subprocess.TimeoutExpired):
                    continue


def wait(what: str, answer: Callable[[], Any], seconds: float = 120) -> Any:
    """The first answer that is not empty; a failure that says what never came."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        with suppress(urllib.error.URLError, ConnectionError):
            if found := answer():
                return found
        time.sleep(0.1)
    pytest.fail(f"waited {seconds} s for {what}")


class Browser:
    """The few WebDriver commands that the test needs."""

    def __init__(self, port: int) -> None:
        self.at = f"http://127.0.0.1:{port}"
        wait("the driver", lambda: self._call("GET", "/status")["ready"], 20)
        options = {"args": FLAGS, "binary": shutil.which("chromium")}
        wanted = {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        opened = self._call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
        self.at += f"/session/{opened['sessionId']}"

    def _call(self, method: str, path: str, body: Any = None) -> Any:
        data = None if body is None else json.dumps(body).encode()
        headers = {"Content-Type": "application/json"}
        request = urllib.request.Request(self.at + path, data, headers, method=method)
        with urllib.request.urlopen(request, timeout=180) as reply:
            return json.load(reply)["value"]

    def open(self, address: str) -> None:
        self._call("POST", "/url", {"url": address})

    def run(self, script: str, *given: Any) -> Any:
        return self._call("POST", "/execute/sync", {"script": script, "args": given})

    def find(self, path: str) -> str:
        place = {"using": "xpath", "value": path}
        return str(next(iter(self._call("POST", "/element", place).values())))

    def click(self, path: str) -> None:
        """A click on what is greyed is lost, and no error tells so: wait until it is not."""
        wait(path, lambda: self._call("GET", f"/element/{self.find(path)}/enabled"), 20)
        self._do(lambda: f"/element/{self.find(path)}/click", {})

    def type(self, element: str, keys: str) -> None:
        self._do(lambda: f"/element/{element}/value", {"text": keys})

    def _do(self, path: Callable[[], str], body: Any) -> None:
        """As a person does: what is covered at this moment is tried again."""
        end = time.monotonic() + 20
        while True:
            try:
                return self._call("POST", path(), body)
            except urllib.error.HTTPError as error:
                if error.code != 400 or time.monotonic() > end:
                    raise AssertionError(error.read().decode()[:300]) from error
            time.sleep(0.1)

    def size(self, width: int, height: int) -> None:
        self._call("POST", "/window/rect", {"width": width, "height": height})

    def devtools(self, command: str, settings: dict[str, Any]) -> Any:
        return self._call("POST", "/goog/cdp/execute", {"cmd": command, "params": settings})

    def finger(self, kind: str, *places: tuple[float, float]) -> None:
        points = [{"x": x, "y": y} for x, y in places]
        self.devtools("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        place = {"type": kind, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1}
        self.devtools("Input.dispatchMouseEvent", place | more)

    def errors(self) -> list[str]:
        lines = self._call("POST", "/se/log", {"type": "browser"})
        return [line["message"] for line in lines if line["level"] == "SEVERE"]

    def screenshot(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(base64.b64decode(self._call("GET", "/screenshot")))

    def close(self) -> None:
        self._call("DELETE", "")


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """One for all tests of a file: its start costs seconds."""
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        missing = "chromium and chromedriver are not both installed (see environment.md)"
        pytest.fail(missing) if os.environ.get("CI") else pytest.skip(missing)
    port = free_port()
    log = tmp_path_factory.mktemp("browser") / "driver.log"
    with running(["chromedriver", f"--port={port}"], log):
        opened = Browser(port)
        try:
            yield opened
        finally:
            opened.close()


@contextmanager
def served(folder: Path, **environment: str) -> Iterator[str]:
    """The address with its token, as the page's own server prints it."""
    port = free_port()
    command = app_command(port).replace(".venv/bin/python", shlex.quote(sys.executable))
    assert shlex.quote(sys.executable) in command

    def printed():
        found = re.search(rb"http://\S+token=\w+", (folder / "log").read_bytes())
        return found and found.group().decode()

    environ = os.environ | environment
    with running(["sh", "-c", command], folder / "log", cwd=ROOT, env=environ):
        yield wait("voila", printed, 90)


@contextmanager
def lab(folder: Path, log: Path) -> Iterator[str]:
    """The address of JupyterLab as `make lab` starts it, in a folder, with its own settings."""
    port = free_port()
    names = {"JUPYTER_CONFIG_DIR": "config", "JUPYTER_DATA_DIR": "data", "IPYTHONDIR": "ipython"}
    own = {name: str(log.parent / place) for name, place in names.items()}
    started = lab_command(port).replace(".venv/bin/python", shlex.quote(sys.executable))
    command = ["sh", "-c", f"{started} --IdentityProvider.token={LAB_TOKEN} --ServerApp.root_dir=."]
    with running(command, log, cwd=folder, env=os.environ | own):
        at = f"http://127.0.0.1:{port}"
        api = f"{at}/api/status?token={LAB_TOKEN}"
        wait("JupyterLab", lambda: urllib.request.urlopen(api, timeout=5).status == 200)
        assert "Warning" not in (said := log.read_text()), said
        yield at


def run_all_cells(browser: Browser) -> None:
    wait("the kernel", lambda: browser.run(IDLE))
    browser.click(MENU.format("MenuBar", "Run"))
    time.sleep(0.5)  # the menu fills itself
    browser.click(MENU.format("Menu", "Run All Cells"))
    # On a new machine the loops are compiled now, which can take minutes.
    wait("all cells to run", lambda: browser.run(UNFINISHED) == 0 and browser.run(IDLE), 300)
